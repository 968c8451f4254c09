#!/usr/bin/env python3
"""Fits the network of `--policy smoother` to pulls that rollouts stored, or builds its file anew from its weights.

    fabc bench smoothing --policy random:1 --out pulls
    scripts/smoother/fit.py fit pulls smoother.onnx
    scripts/smoother/fit.py rebuild runtime/agent/src/policy/smoother.onnx smoother.onnx
    fabc run tasks/smoothing.fab --policy onnx:smoother.onnx

`fit` reads run folders at any depth below a folder. Each executed action is a pull: the picture before it, and the true coverage
that it gained. The file's metadata says how many pulls of which tasks and starts it was fitted to, and how well it does on starts
that were kept apart. `rebuild` keeps weights and metadata, and builds the rest as `network.py` says. Needs numpy and onnx; `fit` also
needs pillow, onnxruntime, jax and optax.
"""

import collections
import json
import pathlib
import sys

import numpy as np
import onnx
from network import CELLS, CONVOLUTIONS, HIDDEN, LIMIT, NAMES, NETWORKS, model, weights_of

EPOCHS, BATCH, RATE, DECAY, DROPPED = 30, 64, 2e-3, 1e-2, 0.25
# Gains are of the order of a tenth; parts of the starts for the cross-validation.
SCALE, PARTS = 10, 3


def begin(key, features):
    """Draws the weights of a network."""
    weights, channels, side = {}, 3, CELLS
    for depth, (out, size) in enumerate(CONVOLUTIONS):
        key, own = jax.random.split(key)
        spread = np.sqrt(2 / (channels * size * size))
        weights[f"convolution.{depth}.kernels"] = spread * jax.random.normal(own, (out, channels, size, size))
        weights[f"convolution.{depth}.bias"] = jnp.zeros(out)
        channels, side = out, (side + 1) // 2
    inputs = channels * side * side + features
    for depth, units in enumerate((HIDDEN, 1)):
        key, own = jax.random.split(key)
        weights[f"layer.{depth}.matrix"] = jax.random.normal(own, (inputs, units)) / np.sqrt(inputs)
        weights[f"layer.{depth}.bias"] = jnp.zeros(units)
        inputs = units
    return weights


def network(weights, windows, features, key=None):
    """Returns scaled gains; with a key, some units are dropped."""
    image = windows
    for depth, (_, size) in enumerate(CONVOLUTIONS):
        kernels, bias = (weights[f"convolution.{depth}.{part}"] for part in ("kernels", "bias"))
        borders, order = [(size // 2, size // 2)] * 2, ("NCHW", "OIHW", "NCHW")
        image = jax.lax.conv_general_dilated(image, kernels, (2, 2), borders, dimension_numbers=order)
        image = jax.nn.relu(image + bias[None, :, None, None])
    values = image.reshape(len(image), -1)
    for depth in range(2):
        if key is not None:
            key, own = jax.random.split(key)
            values = values * jax.random.bernoulli(own, 1 - DROPPED, values.shape) / (1 - DROPPED)
        values = jax.nn.relu(values) if depth else jnp.concatenate([values, features], 1)
        values = values @ weights[f"layer.{depth}.matrix"] + weights[f"layer.{depth}.bias"]
    return values[:, 0]


def fitted(windows, features, gains, seed):
    chance, key = np.random.RandomState(seed), jax.random.PRNGKey(seed)
    weights, batch = begin(key, features.shape[1]), min(BATCH, len(gains))
    steps = EPOCHS * (len(gains) // batch)
    rate = optax.warmup_cosine_decay_schedule(0, RATE, steps // 20, steps)
    optimiser = optax.adamw(rate, weight_decay=DECAY)
    state = optimiser.init(weights)

    @jax.jit
    def advance(weights, state, windows, features, gains, key):
        loss = lambda weights: jnp.mean((network(weights, windows, features, key) - gains) ** 2)
        change, state = optimiser.update(jax.grad(loss)(weights), state, weights)
        return optax.apply_updates(weights, change), state

    for _ in range(EPOCHS):
        order = chance.permutation(len(gains))
        for first in range(0, len(gains) - batch + 1, batch):
            chosen = order[first : first + batch]
            mirrored = chance.rand(batch)[:, None, None, None] < 0.5
            seen = np.where(mirrored, windows[chosen][:, :, ::-1], windows[chosen])
            key, own = jax.random.split(key)
            weights, state = advance(weights, state, seen, features[chosen], SCALE * gains[chosen], own)
    return weights


def fit(windows, features, gains):
    """Returns the weights of all networks."""
    mean, deviation = features.mean(0), features.std(0) + 1e-9
    scaled = np.clip((features - mean) / deviation, -LIMIT, LIMIT).astype(np.float32)
    weights = {"mean": mean[None], "deviation": deviation[None]}
    for number in range(NETWORKS):
        for name, value in fitted(windows, scaled, gains, number).items():
            is_last = name.startswith("layer.1")
            weights[f"{number}.{name}"] = np.asarray(value, np.float32) / (SCALE if is_last else 1)
    return weights


def stored(folder):
    """Yields the executed pulls of run folders: task, start, what the network gets, and the gain of true coverage."""
    for journal in sorted(pathlib.Path(folder).rglob("rollout.jsonl")):
        header, *lines = map(json.loads, journal.read_text(encoding="utf-8").splitlines())
        program = json.loads((journal.parent / header["program_file"]).read_text(encoding="utf-8"))
        cloth, camera = program["cloth"], program["camera"]
        px_per_m = camera["image_px"] / (2 * np.tan(camera["fov_rad"] / 2) * camera["height_m"])
        material = cloth.get("material") or {"upper": {"rgb": [255, 113, 0]}, "under": {"rgb": [248, 145, 201]}}
        given = {
            "faces": np.array([material[face]["rgb"] for face in ("upper", "under")]) / 255,
            "edge": (max(cloth["dimx"], cloth["dimy"]) - 1) * cloth["spacing_m"] * px_per_m,
        }
        before = None
        for line in lines:
            if line["type"] != "step" or not line.get("action") or line.get("coverage_true") is None:
                continue
            after, improved = line["coverage_true"], line["normalized_improvement_true"]
            # The first step's improvement tells the coverage at the start.
            before = (after - improved) / (1 - improved) if before is None else before
            color = np.asarray(Image.open(journal.parent / line["files"]["before"]).convert("RGB")) / 255
            # The simulated table is grey.
            given |= {"color": color, "cloth": color.max(2) - color.min(2) > 40 / 255}
            given |= {f"{end}s": [np.array(line["action"][f"{end}_px"]) + 0.5] for end in ("pick", "place")}
            inputs = {name: np.asarray(value, np.float32) for name, value in given.items()}
            yield header["task"], header["start"]["digest"], inputs, after - before
            before = after


def fit_to(folder, target):
    measuring = onnxruntime.InferenceSession(model(None, "").SerializeToString())
    tasks, starts, features, windows, gains = collections.Counter(), [], [], [], []
    for task, start, inputs, gain in stored(folder):
        seen = measuring.run(["features", "windows"], inputs)
        tasks[task] += 1
        starts.append(start), gains.append(gain), features.append(seen[0][0]), windows.append(seen[1][0])
    of_start = np.unique(starts, return_inverse=True)[1]
    n_starts = len(set(starts))
    if n_starts < PARTS:
        sys.exit(f"`{folder}` holds pulls of {n_starts} starts, and {PARTS} are needed to keep some apart")
    features, windows, gains = np.array(features), np.array(windows), np.array(gains, np.float32)
    part, apart = (np.random.RandomState(0).permutation(n_starts) % PARTS)[of_start], np.zeros_like(gains)
    for number in range(PARTS):
        weights, other = fit(windows[part != number], features[part != number], gains[part != number]), part == number
        scaled = np.clip((features[other] - weights["mean"]) / weights["deviation"], -LIMIT, LIMIT)
        of_network = lambda at: {name[2:]: value for name, value in weights.items() if name.startswith(f"{at}.")}
        apart[other] = np.mean([network(of_network(at), windows[other], scaled) for at in range(NETWORKS)], 0)
    about = (
        f"fitted to {len(gains)} pulls from {n_starts} starts, stored by rollouts of {', '.join(sorted(tasks))}; on "
        f"starts kept apart, estimate and gain correlate by {np.corrcoef(apart, gains)[0, 1]:.2f}"
    )
    print(about)
    onnx.save(model(fit(windows, features, gains), about), target)


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["fit", folder, target]:
            import jax
            import jax.numpy as jnp
            import onnxruntime
            import optax
            from PIL import Image

            fit_to(folder, target)
        case ["rebuild", source, target]:
            old = onnx.load(source)
            about = {entry.key: entry.value for entry in old.metadata_props}["about"]
            onnx.save(model(weights_of(old), about), target)
        case _:
            sys.exit(__doc__)
