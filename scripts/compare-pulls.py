#!/usr/bin/env python3
"""Compares pulls that were tried in the simulator: their kinds, what they grasped, and the starts.

    cargo run --release -p fab-agent --example collect_pulls -- each 620 10 5 kinds
    scripts/compare-pulls.py kinds

Prints three tables about one or more folders; a start, or a pull, that is in several of them counts once. For each kind, the mean gain of the better of the stand-in's own pull and the pulls
of that kind, and the mean difference from the stand-in's own pull. For what was grasped, the mean gain of the stand-in's own pulls,
and of the offered corners that were drawn. For the starts, how they lie, and the mean gain of each kind's pulls. Gains are in percent
of the flat cloth; means have 95 % intervals: percentile bootstrap over starts, 10 000 draws. Needs numpy.
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


# What of the cloth was grasped: within how many particles of a side or corner counts as there.
NEAR = 2

GRASPS = [
    ("all", lambda pull: True),
    ("one layer at the pick", lambda pull: pull["layers"] == 1),
    ("several layers", lambda pull: pull["layers"] > 1),
    ("the outline's last pixel, beside every layer", lambda pull: pull["layers"] == 0),
    ("a corner of the cloth taken", lambda pull: pull["corner"] <= NEAR),
    ("its rim, one layer or none at the pick", lambda pull: is_rim(pull) and pull["layers"] < 2),
    ("its rim, several layers", lambda pull: is_rim(pull) and pull["layers"] > 1),
    ("its inside", lambda pull: pull["side"] > NEAR),
]

LIE = ["true coverage", "offered corners", "layers", "underside up", "rim uppermost", "corners uppermost", "creases, sides", "height, mm"]


def main(folders):
    # Folders number their starts alike, so a start is known by how it lies.
    first = {(folder, start): lie for folder, start, step, *lie in rows(folders, "states.csv") if step == "1"}
    lies = {(start, *lie): lie for (_, start), lie in first.items()}
    # Each search tries the stand-in's own pulls again.
    tried = dict.fromkeys(((start, *first[folder, start]), *pull) for folder, start, *pull in rows(folders, "pulls.csv"))
    states = collections.defaultdict(lambda: collections.defaultdict(list))
    pulls = []
    for start, step, covered, gain, *_, layers, taken, side, corner, kind in tried:
        gain, state = 100 * float(gain), (start, int(step), covered)
        states[state][kind].append(gain)
        # A missed grasp took nothing.
        inside = [int(part) if part else None for part in (side, corner)]
        pull = dict(zip(("layers", "taken", "side", "corner"), [int(layers), int(taken), *inside]))
        pulls.append(pull | {"of": state, "kind": kind, "gain": gain})
    compare_kinds(states)
    compare_grasps(pulls)
    compare_starts(states, lies)


def rows(folders, name):
    for folder in folders:
        with open(os.path.join(folder, name), encoding="utf-8") as file:
            for row in csv.reader(file):
                yield (folder, *row)


def compare_kinds(states):
    # The last kinds are tried in every second state only; rows are comparable where all are.
    whole = {key: state for key, state in states.items() if "elsewhere" in state and "inward" in state}
    for about, chosen in (("all states", states), ("states in which everything was tried", whole)):
        starts = sorted({start for start, *_ in chosen})
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
    starts = sorted({start for start, *_ in whole})
    for kind in ("elsewhere", "inward") if starts else ():
        more = {key: added(state, kind) - added(state, "offered") for key, state in whole.items()}
        print(f"{EQUAL} of `{kind}` less {EQUAL} of `offered`: {interval(more, starts)}")


def compare_grasps(pulls):
    held = [pull for pull in pulls if pull["side"] is not None]
    for kind in ("own", "offered"):
        n_pulls, such = (sum(pull["kind"] == kind for pull in some) for some in (pulls, held))
        layers = [pull["taken"] for pull in held if pull["kind"] == kind and pull["layers"] > 0]
        deeper = sum(taken != 1 for taken in layers)
        print(f"{n_pulls} of `{kind}`: {n_pulls - such} missed; {deeper} of {len(layers)} took another layer than the uppermost")
    print("| grasped | pulls, own | gain | pulls, drawn | gain |")
    for name, is_such in GRASPS:
        cells = []
        for kind in ("own", "offered"):
            such = [pull for pull in held if pull["kind"] == kind and is_such(pull)]
            cells += [str(len(such)), mean_gain(such)]
        print(f"| {name} | {' | '.join(cells)} |")


def is_rim(pull):
    return pull["side"] <= NEAR < pull["corner"]


def mean_gain(pulls):
    gains = {(*pull["of"], index): pull["gain"] for index, pull in enumerate(pulls)}
    return interval(gains, sorted({key[0] for key in gains})) if gains else ""


def compare_starts(states, lies):
    starts = sorted(lies)
    print(f"{len(starts)} starts")
    for column, name in enumerate(LIE):
        print(f"| {name} | {interval({(start,): float(lies[start][column]) for start in starts}, starts, 2)} |")
    for kind in ("own", "pick", "next", "offered", "elsewhere", "inward"):
        gains = {(start, index): gain for start in starts for index, gain in enumerate(states[start, 1, lies[start][0]][kind])}
        print(f"| gain of `{kind}` | {interval(gains, sorted({key[0] for key in gains})) if gains else ''} |")


def added(state, kind):
    """What up to EQUAL pulls of a kind add to the stand-in's own, over all choices of them."""
    own = max(state["own"])
    choices = list(itertools.combinations(state[kind], min(EQUAL, len(state[kind]))))
    return np.mean([max((own, *choice)) - own for choice in choices])


def interval(values, starts, digits=1):
    of_start = [np.array([value for key, value in values.items() if key[0] == start]) for start in starts]
    sums, counts = np.array([part.sum() for part in of_start]), np.array([len(part) for part in of_start])
    drawn = np.random.RandomState(0).randint(len(starts), size=(10_000, len(starts)))
    low, high = np.percentile(sums[drawn].sum(1) / counts[drawn].sum(1), [2.5, 97.5])
    return f"{sums.sum() / counts.sum():.{digits}f} [{low:.{digits}f}, {high:.{digits}f}]"


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1:])
