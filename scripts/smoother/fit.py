#!/usr/bin/env python3
"""Fits the network of `--policy smoother` to pulls that rollouts stored.

    fabc bench smoothing --policy random:1 --out pulls
    scripts/smoother/fit.py pulls smoother.onnx
    fabc run tasks/smoothing.fab --policy onnx:smoother.onnx

Reads run folders at any depth below a folder. Each executed action is a pull: the picture before it, and the true coverage that it
gained. Pulls that a network chose are left out. The shipped file says what is measured of a pull: its tensors `features` and
`windows` are what the fitted part gets (docs/decisions/0112-smoothing-is-a-policy-that-plays-a-network.md). The result is a copy
of that file with other weights. Its metadata says which policies made the pulls, in which tasks and from how many starts, and how
well it does on starts that were kept apart.

A run folder stores no mask of the cloth, so the cloth is found by its colour here, where the policy gets the task's mask: of 13
pictures it has 0.2 to 0.6 % more pixels. If it differs by more than 5 %, as on a coloured table or for a grey cloth, the fit stops.

Needs numpy, pillow, onnx, onnxruntime, jax and optax.
"""

import collections
import json
import pathlib
import sys

import jax
import jax.numpy as jnp
import numpy as np
import onnx
import onnxruntime
import optax
from PIL import Image

SHIPPED = pathlib.Path(__file__).resolve().parents[2] / "runtime/agent/src/policy/smoother.onnx"
EPOCHS, BATCH, RATE, DECAY, DROPPED = 30, 64, 2e-3, 1e-2, 0.25
# The file clips features at this many deviations from their mean, and values a pull that does not lead outward at -1.
LIMIT, INWARD = 4, -1
# Gains are of the order of a tenth; parts of the starts for the cross-validation.
SCALE, PARTS = 10, 3


def shapes_of(shipped):
    """Returns for each network the shapes of its weights, by name."""
    shapes = collections.defaultdict(dict)
    for tensor in shipped.graph.initializer:
        network, _, name = tensor.name.partition(".")
        if name:
            shapes[network][name] = tuple(tensor.dims)
    return shapes


def begin(key, shapes):
    """Draws the weights of a network."""
    weights = {}
    for name, shape in shapes.items():
        key, own = jax.random.split(key)
        spread = {"kernels": 2 / np.prod(shape[1:]), "matrix": 1 / shape[0], "bias": 0}[name.rpartition(".")[2]]
        weights[name] = np.sqrt(spread) * jax.random.normal(own, shape)
    return weights


def network(weights, windows, features, key=None):
    """Returns scaled gains; with a key, some units are dropped."""
    image = windows
    for depth in range(sum(name.endswith("kernels") for name in weights)):
        kernels, bias = (weights[f"convolution.{depth}.{part}"] for part in ("kernels", "bias"))
        borders, order = [(kernels.shape[2] // 2,) * 2] * 2, ("NCHW", "OIHW", "NCHW")
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


def fitted(shapes, windows, features, gains, seed):
    """Returns the weights of one network."""
    chance, key = np.random.RandomState(seed), jax.random.PRNGKey(seed)
    weights, batch = begin(key, shapes), min(BATCH, len(gains))
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
            shown = np.where(mirrored, windows[chosen][:, :, ::-1], windows[chosen])
            key, own = jax.random.split(key)
            weights, state = advance(weights, state, shown, features[chosen], SCALE * gains[chosen], own)
    return weights


def fit(networks, windows, features, gains):
    """Returns the weights of all networks, by their names in the file."""
    mean, deviation = features.mean(0, keepdims=True), features.std(0, keepdims=True) + 1e-9
    weights = {"mean": mean, "deviation": deviation}
    scaled = np.clip((features - mean) / deviation, -LIMIT, LIMIT)
    for seed, (number, shapes) in enumerate(networks.items()):
        for name, value in fitted(shapes, windows, scaled, gains, seed).items():
            is_last = name.startswith("layer.1")
            weights[f"{number}.{name}"] = np.asarray(value, np.float32) / (SCALE if is_last else 1)
    return weights


def estimates(networks, weights, windows, features):
    """Returns the gains as the file computes them: the mean over all networks, the windows and their mirror images."""
    scaled = np.clip((features - weights["mean"]) / weights["deviation"], -LIMIT, LIMIT)
    of = lambda number: {name: weights[f"{number}.{name}"] for name in networks[number]}
    return np.mean([network(of(it), w, scaled) for it in networks for w in (windows, windows[:, :, ::-1])], 0)


def stored(folder):
    """Yields the executed pulls of run folders: header, inputs of the network, and the gain of true coverage."""
    for journal in sorted(pathlib.Path(folder).rglob("rollout.jsonl")):
        header, *lines = map(json.loads, journal.read_text(encoding="utf-8").splitlines())
        if header["policy"]["kind"] == "network":
            continue
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
            # The first pull's improvement tells the coverage at the start.
            before = (after - improved) / (1 - improved) if before is None else before
            color = np.asarray(Image.open(journal.parent / line["files"]["before"]).convert("RGB")) / 255
            mask, area_px = color.max(2) - color.min(2) > 40 / 255, line["scene"]["cloth"]["area_px"]
            if abs(mask.sum() - area_px) > 0.05 * area_px:
                sys.exit(f"{journal}, step {line['step']}: by colour the cloth has {mask.sum()} px, and the task saw {area_px}")
            given |= {"color": color, "cloth": mask}
            [grip] = line["action"]
            given |= {f"{end}s": [np.array(grip[f"{end}_px"]) + 0.5] for end in ("pick", "place")}
            yield header, {name: np.asarray(value, np.float32) for name, value in given.items()}, after - before
            before = after


def session(model):
    return onnxruntime.InferenceSession(model.SerializeToString())


def fit_to(folder, target):
    shipped = onnx.load(SHIPPED)
    networks, inputs = shapes_of(shipped), [it.name for it in shipped.graph.input]
    typed = onnx.shape_inference.infer_shapes(shipped)
    measuring = session(onnx.utils.Extractor(typed).extract_model(inputs, ["features", "windows"]))
    tasks, policies, starts, features, windows, gains = set(), collections.Counter(), [], [], [], []
    for header, pull, gain in stored(folder):
        measured = measuring.run(["features", "windows"], pull)
        tasks.add(header["task"])
        policies[header["policy"]["name"]] += 1
        starts.append(header["start"]["digest"]), gains.append(gain)
        features.append(measured[0][0]), windows.append(measured[1][0])
    of_start = np.unique(starts, return_inverse=True)[1]
    n_starts = len(set(starts))
    if n_starts < PARTS:
        sys.exit(f"`{folder}` holds pulls of {n_starts} starts, and {PARTS} are needed to keep some apart")
    features, windows, gains = np.array(features), np.array(windows), np.array(gains, np.float32)
    part, apart = (np.random.RandomState(0).permutation(n_starts) % PARTS)[of_start], np.zeros_like(gains)
    for number in range(PARTS):
        other = part == number
        weights = fit(networks, windows[~other], features[~other], gains[~other])
        apart[other] = estimates(networks, weights, windows[other], features[other])
    made_by = ", ".join(f"{count} by {name}" for name, count in sorted(policies.items()))
    about = (
        f"fitted to {len(gains)} pulls ({made_by}) from {n_starts} starts of {', '.join(sorted(tasks))}; on starts kept apart, "
        f"estimate and gain correlate by {np.corrcoef(apart, gains)[0, 1]:.2f}"
    )
    print(about)
    weights = fit(networks, windows, features, gains)
    for tensor in shipped.graph.initializer:
        if tensor.name in weights:
            tensor.CopyFrom(onnx.numpy_helper.from_array(np.asarray(weights[tensor.name], np.float32), tensor.name))
    onnx.helper.set_model_props(shipped, {"about": about})
    # The file must compute what was fitted; `pull` is the last one.
    [value], [estimate] = session(shipped).run(["values"], pull)[0], estimates(networks, weights, windows[-1:], features[-1:])
    assert value == INWARD or abs(value - estimate) < 1e-4, f"the file computes {value}, and {estimate} was fitted"
    onnx.save(shipped, target)


if __name__ == "__main__":
    match sys.argv[1:]:
        case [folder, target]:
            fit_to(folder, target)
        case _:
            sys.exit(__doc__)
