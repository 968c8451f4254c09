#!/usr/bin/env python3
"""Compares the kinds of pulls that were tried in the simulator from the same states.

    cargo run --release -p fab-agent --example collect_pulls -- each 620 10 5 kinds
    scripts/compare-pulls.py kinds

Prints, for each kind, the mean gain of the better of the stand-in's own pull and the pulls of that kind, in percent of the flat
cloth, with a 95 % interval, and the mean difference from the stand-in's own pull with its interval: percentile bootstrap over
starts, 10 000 draws. Needs numpy.
"""

import collections
import csv
import itertools
import os
import sys

import numpy as np

# Pulls of each kind in the last comparison.
EQUAL = 3

ROWS = [
    ("the stand-in's own pull", ()),
    ("other directions and distances of its pick", ("pick",)),
    ("the next ones by its estimate", ("next",)),
    ("offered corners, drawn", ("offered",)),
    ("all of these", ("pick", "next", "offered")),
    ("picks that are not offered", ("elsewhere",)),
    ("offered corners, inward too", ("inward",)),
    ("everything", ("pick", "next", "offered", "elsewhere", "inward")),
]


def main(folder):
    states = collections.defaultdict(lambda: collections.defaultdict(list))
    with open(os.path.join(folder, "pulls.csv"), encoding="utf-8") as file:
        for start, step, _, gain, *_, kind in csv.reader(file):
            states[int(start), int(step)][kind].append(100 * float(gain))
    # The last kinds are tried in every second state only; rows are comparable where all are.
    whole = {key: state for key, state in states.items() if "elsewhere" in state and "inward" in state}
    for about, chosen in (("all states", states), ("states in which everything was tried", whole)):
        starts = sorted({start for start, _ in chosen})
        if not starts:
            continue
        print(f"{about}: {len(chosen)} of {len(starts)} starts")
        for name, kinds in ROWS:
            if chosen is states and not set(kinds) <= {"pick", "next", "offered"}:
                continue
            tried = [sum(len(state[kind]) for kind in kinds) for state in chosen.values()]
            best = {key: max(sum((state[kind] for kind in ("own", *kinds)), [])) for key, state in chosen.items()}
            more = {key: gain - max(chosen[key]["own"]) for key, gain in best.items()}
            print(f"| {name} | {np.mean(tried):.1f} | {interval(best, starts)} | {interval(more, starts)} |")
    starts = sorted({start for start, _ in whole})
    for kind in ("elsewhere", "inward") if starts else ():
        more = {key: added(state, kind) - added(state, "offered") for key, state in whole.items()}
        print(f"{EQUAL} of `{kind}` less {EQUAL} of `offered`: {interval(more, starts)}")


def added(state, kind):
    """What up to EQUAL pulls of a kind add to the stand-in's own, over all choices of them."""
    own = max(state["own"])
    choices = list(itertools.combinations(state[kind], min(EQUAL, len(state[kind]))))
    return np.mean([max((own, *choice)) - own for choice in choices])


def interval(values, starts):
    of_start = [np.array([value for key, value in values.items() if key[0] == start]) for start in starts]
    sums, counts = np.array([part.sum() for part in of_start]), np.array([len(part) for part in of_start])
    drawn = np.random.RandomState(0).randint(len(starts), size=(10_000, len(starts)))
    low, high = np.percentile(sums[drawn].sum(1) / counts[drawn].sum(1), [2.5, 97.5])
    return f"{sums.sum() / counts.sum():.1f} [{low:.1f}, {high:.1f}]"


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
