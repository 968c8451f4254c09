"""Holds fabc's wire formats against the providers' own clients; nothing is sent.

`requests FOLDER` reads FOLDER/WIRE/CASE.json, bodies that fabc would send, and validates each with the types of the
provider's client, in which a field that the client does not know is an error. The Gemini client also writes each
request anew from what it understood, and must come to the same JSON.

`replies FOLDER` writes FOLDER/WIRE/CASE.json, replies made of the clients' own classes, and beside each
CASE.expected.json: the answer and its tokens, or the fault that fabc is to name.
"""

import json
import pkgutil
import sys
from importlib import import_module
from pathlib import Path

from pydantic import BaseModel, TypeAdapter
from typing_extensions import is_typeddict


def forbid_unknown_fields(package):
    """Typed dictionaries ignore what they do not know, and classes keep it, unless each is told otherwise."""
    classes = {}
    for info in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
        if ".beta" in info.name:
            continue
        for value in vars(import_module(info.name)).values():
            if is_typeddict(value):
                value.__pydantic_config__ = {"extra": "forbid", "arbitrary_types_allowed": True}
            elif isinstance(value, type) and issubclass(value, BaseModel) and value.__module__ == info.name:
                classes[value] = None
    # A turn may also hold blocks of an earlier reply, which are classes.
    for value in classes:
        value.model_config["extra"] = "forbid"
        value.model_rebuild(force=True)


def walk(value):
    """Iterables are validated while they are walked."""
    if isinstance(value, dict):
        for item in value.values():
            walk(item)
    elif hasattr(value, "__iter__") and not isinstance(value, (str, bytes)):
        for item in value:
            walk(item)


USUAL_NAMES = {
    "mime_type": "mimeType",
    "thinking_level": "thinkingLevel",
    "thinking_budget": "thinkingBudget",
}


def usual_form(value):
    """Google's JSON takes either case of a field and either alphabet of base64; the client mixes them."""
    if isinstance(value, list):
        return [usual_form(item) for item in value]
    if not isinstance(value, dict):
        return value
    value = {USUAL_NAMES.get(name, name): usual_form(item) for name, item in value.items()}
    if "mimeType" in value:
        value["data"] = value["data"].replace("-", "+").replace("_", "/")
    return value


def validators():
    import anthropic.types
    import openai.types
    from anthropic.types.message_create_params import MessageCreateParamsNonStreaming
    from google import genai
    from google.genai import _common, models, types
    from openai.types.chat.completion_create_params import CompletionCreateParamsNonStreaming
    from openai.types.responses.response_create_params import ResponseCreateParamsNonStreaming

    forbid_unknown_fields(openai.types)
    forbid_unknown_fields(anthropic.types)

    def typed(params):
        adapter = TypeAdapter(params)
        return lambda body: walk(adapter.validate_python(body))

    client = genai.Client(api_key="none")._api_client

    def gemini(body):
        config = dict(body["generationConfig"])
        if "systemInstruction" in body:
            config["systemInstruction"] = body["systemInstruction"]
        understood = types._GenerateContentParameters(
            model="a-model",
            contents=[types.Content.model_validate(content) for content in body["contents"]],
            config=types.GenerateContentConfig.model_validate(config),
        )
        written = models._GenerateContentParameters_to_mldev(client, understood)
        written.pop("_url")
        written = usual_form(_common.encode_unserializable_types(_common.convert_to_dict(written)))
        assert written == body, f"the client writes {json.dumps(written)}"

    messages = typed(MessageCreateParamsNonStreaming)

    def older_messages(body):
        sampling = {name: body.pop(name) for name in ("temperature", "top_p") if name in body}
        assert sampling, "a body without sampling belongs to the present version"
        messages(body)

    return {
        "openai_chat": typed(CompletionCreateParamsNonStreaming),
        "openai_responses": typed(ResponseCreateParamsNonStreaming),
        "anthropic-2026-10-21": messages,
        "anthropic-2023-06-01": older_messages,
        "gemini": gemini,
    }


def check_requests(folder):
    count = 0
    for wire, validate in validators().items():
        for path in sorted((folder / wire).glob("*.json")):
            body = json.loads(path.read_text())
            try:
                validate(body)
            except Exception as error:
                sys.exit(f"{wire}, {path.stem}: {error}\n{path.read_text()[:2000]}")
            count += 1
        # A validator that takes anything would prove nothing.
        spoilt = {**json.loads(path.read_text()), "unknown_field": 1}
        try:
            validate(spoilt)
        except Exception:
            continue
        sys.exit(f"{wire}: the client's types take an unknown field")
    print(count)


def answer(text, input_tokens, cached, output_tokens, reasoning_tokens):
    return {
        "text": text,
        "input_tokens": input_tokens,
        "cached_input_tokens": cached,
        "output_tokens": output_tokens,
        "reasoning_tokens": reasoning_tokens,
    }


def fault(name):
    return {"fault": name}


def chat_replies():
    from openai.types.chat import ChatCompletion

    def reply(finish_reason, **message):
        return ChatCompletion.model_validate(
            {
                "id": "chatcmpl-1",
                "object": "chat.completion",
                "created": 1,
                "model": "a-model",
                "choices": [
                    {"index": 0, "finish_reason": finish_reason, "message": {"role": "assistant", **message}}
                ],
                "usage": {
                    "prompt_tokens": 30,
                    "completion_tokens": 12,
                    "total_tokens": 42,
                    "prompt_tokens_details": {"cached_tokens": 10},
                    "completion_tokens_details": {"reasoning_tokens": 5},
                },
            }
        )

    yield "answer", reply("stop", content="fold it"), answer("fold it", 30, 10, 12, 5)
    yield "refusal", reply("stop", refusal="no"), fault("refused")
    yield "truncated", reply("length", content="fol"), fault("truncated")
    yield "filtered", reply("content_filter", content=""), fault("content_filtered")
    yield "hidden_alone", reply("stop", content=""), fault("truncated")


def responses_replies():
    from openai.types.responses import Response

    def reply(status, output, **more):
        return Response.model_validate(
            {
                "id": "resp_1",
                "object": "response",
                "created_at": 1,
                "model": "a-model",
                "status": status,
                "output": output,
                "parallel_tool_calls": True,
                "tool_choice": "auto",
                "tools": [],
                "usage": {
                    "input_tokens": 30,
                    "input_tokens_details": {"cached_tokens": 10, "cache_write_tokens": 0},
                    "output_tokens": 12,
                    "output_tokens_details": {"reasoning_tokens": 5},
                    "total_tokens": 42,
                },
                **more,
            }
        )

    def message(*content):
        return {"type": "message", "id": "m", "role": "assistant", "status": "completed", "content": list(content)}

    text = {"type": "output_text", "text": "fold it", "annotations": []}
    thought = {"type": "reasoning", "id": "r", "summary": []}
    cut = {"incomplete_details": {"reason": "max_output_tokens"}}
    filtered = {"incomplete_details": {"reason": "content_filter"}}
    failed = {"error": {"code": "server_error", "message": "oops"}}
    limited = {"error": {"code": "rate_limit_exceeded", "message": "slow"}}
    yield "answer", reply("completed", [thought, message(text)]), answer("fold it", 30, 10, 12, 5)
    yield "refusal", reply("completed", [message({"type": "refusal", "refusal": "no"})]), fault("refused")
    yield "truncated", reply("incomplete", [thought], **cut), fault("truncated")
    yield "filtered", reply("incomplete", [], **filtered), fault("content_filtered")
    yield "failed", reply("failed", [], **failed), fault("server_failed")
    yield "limited", reply("failed", [], **limited), fault("rate_limited")
    yield "hidden_alone", reply("completed", []), fault("truncated")


def anthropic_replies():
    from anthropic.types import Message

    def reply(stop_reason, *content, **more):
        return Message.model_validate(
            {
                "id": "msg_1",
                "type": "message",
                "role": "assistant",
                "model": "a-model",
                "content": list(content),
                "stop_reason": stop_reason,
                "usage": {
                    "input_tokens": 15,
                    "cache_creation_input_tokens": 5,
                    "cache_read_input_tokens": 10,
                    "output_tokens": 12,
                    "output_tokens_details": {"thinking_tokens": 5},
                },
                **more,
            }
        )

    text = {"type": "text", "text": "fold it"}
    thought = {"type": "thinking", "thinking": "hm", "signature": "s"}
    refused = {"stop_details": {"type": "refusal", "explanation": "no"}}
    yield "answer", reply("end_turn", thought, text), answer("fold it", 30, 10, 12, 5)
    yield "refusal", reply("refusal", **refused), fault("refused")
    yield "truncated", reply("max_tokens", text), fault("truncated")
    yield "full", reply("model_context_window_exceeded", text), fault("truncated")
    yield "paused", reply("pause_turn", text), answer("fold it", 30, 10, 12, 5)
    yield "hidden_alone", reply("end_turn"), fault("truncated")


def gemini_replies():
    from google.genai.types import GenerateContentResponse

    def reply(**fields):
        usage = {
            "promptTokenCount": 30,
            "cachedContentTokenCount": 10,
            "candidatesTokenCount": 7,
            "thoughtsTokenCount": 5,
            "totalTokenCount": 42,
        }
        return GenerateContentResponse.model_validate({"usageMetadata": usage, **fields})

    def candidate(reason, *parts):
        return {"candidates": [{"content": {"role": "model", "parts": list(parts)}, "finishReason": reason}]}

    thought = {"text": "hm", "thought": True}
    blocked = {"promptFeedback": {"blockReason": "SAFETY"}}
    yield "answer", reply(**candidate("STOP", thought, {"text": "fold it"})), answer("fold it", 30, 10, 12, 5)
    yield "truncated", reply(**candidate("MAX_TOKENS", {"text": "fol"})), fault("truncated")
    yield "filtered", reply(**candidate("SAFETY")), fault("content_filtered")
    yield "blocked", reply(**blocked), fault("content_filtered")
    yield "hidden_alone", reply(**candidate("STOP")), fault("truncated")


def write_replies(folder):
    count = 0
    for wire, replies in (
        ("openai_chat", chat_replies()),
        ("openai_responses", responses_replies()),
        ("anthropic", anthropic_replies()),
        ("gemini", gemini_replies()),
    ):
        place = folder / wire
        place.mkdir(parents=True)
        for name, reply, expected in replies:
            is_gemini = wire == "gemini"
            text = reply.model_dump_json(by_alias=is_gemini, exclude_none=is_gemini)
            (place / f"{name}.json").write_text(text)
            (place / f"{name}.expected.json").write_text(json.dumps(expected))
            count += 1
    print(count)


if __name__ == "__main__":
    verb, folder = sys.argv[1], Path(sys.argv[2])
    {"requests": check_requests, "replies": write_replies}[verb](folder)
