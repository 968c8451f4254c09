#!/usr/bin/env python3
"""Fits the estimate of the stand-in `geometric` to pulls that were tried in the simulator.

    cargo run --release -p fab-agent --example collect_pulls -- fit 1000 300 6 tried
    cargo run --release -p fab-agent --example describe_pulls -- tried described
    scripts/fit-pulls.py described runtime/standins/src/geometric/smooth/estimate.json "seeds 1000 to 1299"

Needs numpy, jax and optax. On two cores the first takes 45 minutes for 200 starts, the last 5 minutes. Prints how well the estimate does on starts that it was not fitted to: the correlation of
estimate and gain, and the gain of the tried pull with the best estimate. Without a second and third argument
it does only that.
"""

import csv
import json
import pathlib
import sys

import jax
import jax.numpy as jnp
import numpy as np
import optax

CHANNELS, CELLS = 3, 24
# Output channels and sizes of the kernels of the convolutions, units of the hidden layer, and how many networks.
CONVOLUTIONS, HIDDEN, NETWORKS = [(8, 5), (16, 3), (16, 3)], 32, 3
EPOCHS, BATCH, RATE, DECAY, DROPPED = 30, 64, 2e-3, 1e-2, 0.25
# Features are clipped at this many deviations from their mean.
LIMIT = 4
# Gains are of the order of a tenth.
SCALE = 10
# Folds of the cross-validation over starts.
PARTS = 3


def begin(key, features):
    """Draws the weights of a network."""
    weights, channels, side = {"convolutions": [], "layers": []}, CHANNELS, CELLS
    for out, size in CONVOLUTIONS:
        key, own = jax.random.split(key)
        spread = np.sqrt(2 / (channels * size * size))
        weights["convolutions"].append((spread * jax.random.normal(own, (out, channels, size, size)), jnp.zeros(out)))
        channels, side = out, (side + 1) // 2
    inputs = channels * side * side + features
    for units in (HIDDEN, 1):
        key, own = jax.random.split(key)
        weights["layers"].append((jax.random.normal(own, (inputs, units)) / np.sqrt(inputs), jnp.zeros(units)))
        inputs = units
    return weights


def network(weights, windows, features, key=None):
    """Returns scaled gains; with a key, some units are dropped."""
    image = windows
    for kernels, bias in weights["convolutions"]:
        border = kernels.shape[-1] // 2
        image = jax.lax.conv_general_dilated(
            image, kernels, (2, 2), [(border, border)] * 2, dimension_numbers=("NCHW", "OIHW", "NCHW")
        )
        image = jax.nn.relu(image + bias[None, :, None, None])
    values = image.reshape(len(image), -1)
    for depth, (matrix, bias) in enumerate(weights["layers"]):
        if key is not None:
            key, own = jax.random.split(key)
            values = values * jax.random.bernoulli(own, 1 - DROPPED, values.shape) / (1 - DROPPED)
        if depth == 0:
            values = jnp.concatenate([values, features], 1)
        else:
            values = jax.nn.relu(values)
        values = values @ matrix + bias
    return values[:, 0]


class Estimate:
    """The mean of small convolutional networks, over each window and its mirror image."""

    def __init__(self, windows, features, gains):
        self.mean, self.deviation = features.mean(0), features.std(0) + 1e-9
        self.networks = [self.fitted(windows, self.scaled(features), SCALE * gains, seed) for seed in range(NETWORKS)]

    def scaled(self, features):
        return np.clip((features - self.mean) / self.deviation, -LIMIT, LIMIT).astype(np.float32)

    @staticmethod
    def fitted(windows, features, gains, seed):
        chance, key = np.random.RandomState(seed), jax.random.PRNGKey(seed)
        weights = begin(key, features.shape[1])
        steps = EPOCHS * (len(gains) // BATCH)
        optimiser = optax.adamw(optax.warmup_cosine_decay_schedule(0, RATE, steps // 20, steps), weight_decay=DECAY)
        state = optimiser.init(weights)

        @jax.jit
        def advance(weights, state, windows, features, gains, key):
            def loss(weights):
                return jnp.mean((network(weights, windows, features, key) - gains) ** 2)

            change, state = optimiser.update(jax.grad(loss)(weights), state, weights)
            return optax.apply_updates(weights, change), state

        for _ in range(EPOCHS):
            order = chance.permutation(len(gains))
            for first in range(0, len(gains) - BATCH + 1, BATCH):
                batch = order[first : first + BATCH]
                seen = windows[batch].astype(np.float32) / 255
                mirrored = chance.rand(BATCH) < 0.5
                seen = np.where(mirrored[:, None, None, None], seen[:, :, ::-1], seen)
                key, own = jax.random.split(key)
                weights, state = advance(weights, state, seen, features[batch], gains[batch].astype(np.float32), own)
        return weights

    def __call__(self, windows, features):
        scaled, answers = self.scaled(features), jax.jit(network)
        both = lambda weights, seen, own: answers(weights, seen, own) + answers(weights, seen[:, :, ::-1], own)
        parts = [
            np.mean([both(weights, windows[first : first + 512].astype(np.float32) / 255, scaled[first : first + 512])
                     for weights in self.networks], 0)
            for first in range(0, len(windows), 512)
        ]
        return np.concatenate(parts) / 2 / SCALE

    def weights(self, names, about):
        rounded = np.vectorize(lambda value: float(f"{value:.3g}"), otypes=[float])
        short = lambda values: rounded(np.asarray(values)).tolist()
        networks = []
        for weights in self.networks:
            layers = []
            for depth, (matrix, bias) in enumerate(weights["layers"]):
                is_last = depth + 1 == len(weights["layers"])
                scale = 1 / SCALE if is_last else 1
                units = zip(np.asarray(matrix).T * scale, np.asarray(bias) * scale)
                layers.append([{"weights": short(unit), "bias": short(offset)} for unit, offset in units])
            kernels = [{"kernels": short(kernels), "bias": short(bias)} for kernels, bias in weights["convolutions"]]
            networks.append({"convolutions": kernels, "layers": layers})
        return {
            "about": about,
            "features": names,
            "mean": short(self.mean),
            "deviation": short(self.deviation),
            "limit": LIMIT,
            "networks": networks,
        }


def load(folder):
    with open(folder / "pulls.csv", encoding="utf-8") as file:
        names, *rows = csv.reader(file)
    table = np.array(rows, dtype=float)
    windows = np.fromfile(folder / "windows.u8", np.uint8).reshape(len(table), CHANNELS, CELLS, CELLS)
    return names[4:], table, windows


def main(source, target=None, origin="not fitted"):
    names, table, windows = load(pathlib.Path(source))
    starts, steps, gains, features = table[:, 0], table[:, 1], table[:, 3], table[:, 4:]
    if len(np.unique(starts)) < PARTS:
        sys.exit(f"{source} holds pulls of {len(np.unique(starts))} starts, and {PARTS} are needed to keep some apart")
    if len(gains) < 2 * BATCH:
        sys.exit(f"{source} holds {len(gains)} pulls, and at least {2 * BATCH} are needed")
    parts = np.random.RandomState(0).permutation(len(np.unique(starts))) % PARTS
    part = parts[np.unique(starts, return_inverse=True)[1]]
    apart = np.zeros_like(gains)
    for kept in range(PARTS):
        fitted = Estimate(windows[part != kept], features[part != kept], gains[part != kept])
        apart[part == kept] = fitted(windows[part == kept], features[part == kept])
    states = np.unique(np.stack([starts, steps], 1), axis=0, return_inverse=True)[1].ravel()
    of_states = [np.flatnonzero(states == state) for state in range(states.max() + 1)]
    centered = lambda values: np.concatenate([values[tried] - values[tried].mean() for tried in of_states])
    within = np.corrcoef(centered(apart), centered(gains))[0, 1]
    first = [gains[tried[np.argmax(apart[tried])]] for tried in of_states]
    best = np.mean([gains[tried].max() for tried in of_states])
    about = (
        f"{len(gains)} pulls from {len(of_states)} states of {len(np.unique(starts))} crumpled starts ({origin}). On starts kept "
        f"apart, estimate and gain correlate by {np.corrcoef(apart, gains)[0, 1]:.2f}, and by {within:.2f} within a state; of the "
        f"pulls tried in a state the one put first gains {100 * np.mean(first):.1f} % of the flat cloth, the best {100 * best:.1f} %."
    )
    print(about, f"Standard error of the first: {100 * np.std(first) / len(first) ** 0.5:.2f} %.")
    if target is None:
        return
    fitted = Estimate(windows, features, gains)
    weights = fitted.weights(names, about)
    # Lets a reader of the weights check that it reads them correctly.
    weights["example"] = {
        "window": (windows[0] / 255).round(4).tolist(),
        "features": features[0].tolist(),
        "gain": float(fitted(windows[:1], features[:1])[0]),
    }
    with open(target, "w", encoding="utf-8") as file:
        json.dump(weights, file, separators=(",", ":"))
        file.write("\n")


if __name__ == "__main__":
    if len(sys.argv) not in (2, 4):
        sys.exit(__doc__)
    main(*sys.argv[1:])
