"""llama.cpp's own server with tiny models of random weights.

`write FOLDER` writes MODEL.gguf, a language model, and MMPROJ.gguf, an encoder of pictures for it.
`serve OPTIONS` takes options of llama-server, prints its address, and serves until stdin closes.
"""

import argparse
import sys
from pathlib import Path

import gguf
import numpy as np
import xllamacpp

EMBEDDING, FEED_FORWARD, BLOCKS, HEADS, CONTEXT = 64, 128, 1, 4, 2048
VISION, VISION_FEED_FORWARD, VISION_BLOCKS, IMAGE, PATCH = 32, 64, 2, 56, 14


def write_model(path):
    """Writes a model of llama's architecture: byte tokens, one block, random weights."""
    random = np.random.default_rng(7)
    writer = gguf.GGUFWriter(path, "llama")
    writer.add_context_length(CONTEXT)
    writer.add_embedding_length(EMBEDDING)
    writer.add_block_count(BLOCKS)
    writer.add_feed_forward_length(FEED_FORWARD)
    writer.add_head_count(HEADS)
    writer.add_head_count_kv(HEADS)
    writer.add_layer_norm_rms_eps(1e-5)
    writer.add_rope_dimension_count(EMBEDDING // HEADS)
    kinds = gguf.TokenType
    tokens = [("<unk>", kinds.UNKNOWN), ("<s>", kinds.CONTROL), ("</s>", kinds.CONTROL)]
    # No grammar lets unused tokens through. Random bytes from 0x80 on are no UTF-8, and the server answers 500 to such a text.
    # A random escape such as \uD800 is no character, so there is no backslash either.
    written = [byte < 0x80 and byte != ord("\\") for byte in range(256)]
    tokens += [(f"<0x{byte:02X}>", kinds.BYTE if written[byte] else kinds.UNUSED) for byte in range(256)]
    tokens += [(chr(letter), kinds.NORMAL) for letter in range(33, 127) if written[letter]]
    writer.add_tokenizer_model("llama")
    writer.add_token_list([token for token, _ in tokens])
    writer.add_token_scores([0.0] * len(tokens))
    writer.add_token_types([kind for _, kind in tokens])
    writer.add_bos_token_id(1)
    writer.add_eos_token_id(2)
    writer.add_unk_token_id(0)
    writer.add_chat_template(
        "{% for message in messages %}{{ message['role'] }}: {{ message['content'] }}\n{% endfor %}assistant: "
    )

    def weights(name, *shape):
        writer.add_tensor(name, random.normal(0, 0.1, shape).astype(np.float32))

    def ones(name, length):
        writer.add_tensor(name, np.ones(length, np.float32))

    weights("token_embd.weight", len(tokens), EMBEDDING)
    weights("output.weight", len(tokens), EMBEDDING)
    ones("output_norm.weight", EMBEDDING)
    for block in range(BLOCKS):
        ones(f"blk.{block}.attn_norm.weight", EMBEDDING)
        ones(f"blk.{block}.ffn_norm.weight", EMBEDDING)
        for part in ("attn_q", "attn_k", "attn_v", "attn_output"):
            weights(f"blk.{block}.{part}.weight", EMBEDDING, EMBEDDING)
        weights(f"blk.{block}.ffn_gate.weight", FEED_FORWARD, EMBEDDING)
        weights(f"blk.{block}.ffn_up.weight", FEED_FORWARD, EMBEDDING)
        weights(f"blk.{block}.ffn_down.weight", EMBEDDING, FEED_FORWARD)
    writer.write_header_to_file()
    writer.write_kv_data_to_file()
    writer.write_tensors_to_file()
    writer.close()


def write_projector(path):
    """Writes a CLIP encoder of one block with LLaVA's projector, with random weights."""
    random = np.random.default_rng(8)
    writer = gguf.GGUFWriter(path, "clip")
    writer.add_bool("clip.has_vision_encoder", True)
    writer.add_string("clip.projector_type", "mlp")
    writer.add_bool("clip.use_gelu", True)
    for key, value in {
        "image_size": IMAGE,
        "patch_size": PATCH,
        "embedding_length": VISION,
        "feed_forward_length": VISION_FEED_FORWARD,
        "projection_dim": EMBEDDING,
        "block_count": VISION_BLOCKS,
        "attention.head_count": 2,
    }.items():
        writer.add_uint32(f"clip.vision.{key}", value)
    writer.add_float32("clip.vision.attention.layer_norm_epsilon", 1e-5)
    writer.add_array("clip.vision.image_mean", [0.5, 0.5, 0.5])
    writer.add_array("clip.vision.image_std", [0.5, 0.5, 0.5])

    def weights(name, *shape):
        writer.add_tensor(name, random.normal(0, 0.1, shape).astype(np.float32))

    def linear(name, outputs, inputs):
        weights(f"{name}.weight", outputs, inputs)
        weights(f"{name}.bias", outputs)

    def norm(name):
        weights(f"{name}.weight", VISION)
        weights(f"{name}.bias", VISION)

    weights("v.class_embd", VISION)
    weights("v.patch_embd.weight", VISION, 3, PATCH, PATCH)
    weights("v.position_embd.weight", (IMAGE // PATCH) ** 2 + 1, VISION)
    norm("v.pre_ln")
    for block in range(VISION_BLOCKS):
        for part in ("attn_q", "attn_k", "attn_v", "attn_out"):
            linear(f"v.blk.{block}.{part}", VISION, VISION)
        norm(f"v.blk.{block}.ln1")
        norm(f"v.blk.{block}.ln2")
        linear(f"v.blk.{block}.ffn_up", VISION_FEED_FORWARD, VISION)
        linear(f"v.blk.{block}.ffn_down", VISION, VISION_FEED_FORWARD)
    linear("mm.0", EMBEDDING, VISION)
    linear("mm.2", EMBEDDING, EMBEDDING)
    writer.write_header_to_file()
    writer.write_kv_data_to_file()
    writer.write_tensors_to_file()
    writer.close()


def serve(options):
    parser = argparse.ArgumentParser()
    parser.add_argument("--model", required=True)
    parser.add_argument("--mmproj")
    parser.add_argument("--api-key")
    parser.add_argument("--port", type=int, default=8080)
    options = parser.parse_args(options)
    parameters = xllamacpp.CommonParams()
    parameters.model.path = options.model
    if options.mmproj:
        parameters.mmproj.path = options.mmproj
    if options.api_key:
        parameters.api_keys = [options.api_key]
    parameters.hostnames = ["127.0.0.1"]
    parameters.port = options.port
    parameters.n_ctx = CONTEXT
    parameters.n_parallel = 1
    parameters.warmup = False
    parameters.cpuparams.n_threads = 1
    server = xllamacpp.Server(parameters)
    print(server.listening_address, flush=True)
    sys.stdin.read()


if sys.argv[1] == "write":
    write_model(Path(sys.argv[2]) / "MODEL.gguf")
    write_projector(Path(sys.argv[2]) / "MMPROJ.gguf")
else:
    serve(sys.argv[2:])
