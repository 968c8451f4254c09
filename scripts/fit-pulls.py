#!/usr/bin/env python3
"""Fits the estimate of the stand-in `geometric` to pulls that were tried in the simulator.

    cargo run -p fab-agent --example collect_pulls -- fit 300 100 10 pulls
    cargo run -p fab-agent --example describe_pulls -- pulls > pulls.csv
    scripts/fit-pulls.py pulls.csv runtime/standins/src/geometric/smooth/estimate.json "seeds 300 to 399"

Needs numpy and scikit-learn. Prints how well the estimate does on starts that it was not fitted to: the correlation of
estimate and gain, and the gain of the tried pull with the best estimate.
"""

import csv
import json
import sys
import warnings

import numpy as np
from sklearn.exceptions import ConvergenceWarning
from sklearn.neural_network import MLPRegressor

HIDDEN, NETWORKS, DECAY, EPOCHS = 24, 6, 1.0, 80
# Features are clipped at this many deviations from their mean.
LIMIT = 4
# Gains are of the order of a tenth.
SCALE = 10
# Folds of the cross-validation over starts.
PARTS = 6


class Estimate:
    """The mean of small networks with one hidden layer each."""

    def __init__(self, features, gains):
        self.mean, self.deviation = features.mean(0), features.std(0) + 1e-9
        scaled = self.scaled(features)
        self.networks = [
            MLPRegressor(
                hidden_layer_sizes=(HIDDEN,), alpha=DECAY, learning_rate_init=3e-3, max_iter=EPOCHS, random_state=seed
            ).fit(
                scaled, SCALE * gains
            )
            for seed in range(NETWORKS)
        ]

    def scaled(self, features):
        return np.clip((features - self.mean) / self.deviation, -LIMIT, LIMIT)

    def __call__(self, features):
        scaled = self.scaled(features)
        return np.mean([network.predict(scaled) for network in self.networks], 0) / SCALE

    def weights(self, names, about):
        short = lambda value: float(f"{value:.4g}")
        networks = []
        for network in self.networks:
            (into, out), (bias, last) = network.coefs_, network.intercepts_
            hidden = [
                {
                    "weights": [short(weight) for weight in into[:, unit]],
                    "bias": short(bias[unit]),
                    "counts": short(out[unit, 0] / SCALE),
                }
                for unit in range(HIDDEN)
                # Decay leaves some units with no weight.
                if np.abs(into[:, unit]).max() > 1e-6 and abs(out[unit, 0]) > 1e-6
            ]
            networks.append({"hidden": hidden, "bias": short(last[0] / SCALE)})
        return {
            "about": about,
            "features": names,
            "mean": [short(value) for value in self.mean],
            "deviation": [short(value) for value in self.deviation],
            "limit": LIMIT,
            "networks": networks,
        }


def main(source, target, origin):
    # A network that has not converged after the last pass is good enough.
    warnings.simplefilter("ignore", ConvergenceWarning)
    with open(source, encoding="utf-8") as file:
        names, *rows = csv.reader(file)
    table = np.array(rows, dtype=float)
    starts, steps, gains, features = table[:, 0], table[:, 1], table[:, 3], table[:, 4:]
    if len(np.unique(starts)) < PARTS:
        sys.exit(f"{source} holds pulls of {len(np.unique(starts))} starts, and {PARTS} are needed to keep some apart")
    parts = np.random.RandomState(0).permutation(len(np.unique(starts))) % PARTS
    part = parts[np.unique(starts, return_inverse=True)[1]]
    apart = np.zeros_like(gains)
    for kept in range(PARTS):
        fitted = Estimate(features[part != kept], gains[part != kept])
        apart[part == kept] = fitted(features[part == kept])
    states = np.unique(np.stack([starts, steps], 1), axis=0, return_inverse=True)[1].ravel()
    of_states = [np.flatnonzero(states == state) for state in range(states.max() + 1)]
    first = np.mean([gains[tried[np.argmax(apart[tried])]] for tried in of_states])
    best = np.mean([gains[tried].max() for tried in of_states])
    about = (
        f"{len(gains)} pulls from {len(of_states)} states of {len(np.unique(starts))} crumpled starts ({origin}). On starts kept "
        f"apart, estimate and gain correlate by {np.corrcoef(apart, gains)[0, 1]:.2f}; of the pulls tried in a state "
        f"the one put first gains {100 * first:.1f} % of the flat cloth, the best {100 * best:.1f} %."
    )
    print(about)
    fitted = Estimate(features, gains)
    weights = fitted.weights(names[4:], about)
    # Lets a reader of the weights check that it reads them correctly.
    weights["example"] = {"features": [float(value) for value in features[0]], "gain": float(fitted(features[:1])[0])}
    with open(target, "w", encoding="utf-8") as file:
        json.dump(weights, file)
        file.write("\n")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
