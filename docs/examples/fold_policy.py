"""Folds Double Triangle: carries one corner to the corner farthest from it, twice. Standard library only.

fabc run tasks/double_triangle.fab --policy exec:"python3 docs/examples/fold_policy.py"
"""
import itertools
import json
import math
import sys


def farthest_first(step):
    """Lists what is offered: pick and place, the pair with the longest way first."""
    picks, places = step["offered"]["pick"], step["offered"]["place"]
    pairs = itertools.product(picks, places)
    return sorted(pairs, key=lambda pair: -math.dist(*pair))


def grip(pair):
    return {"pick": pair[0], "place": pair[1]}


def answer(step):
    if step["task"] != "double_triangle":
        return {"refuse": f"{step['task']} is not a task that this policy knows"}
    refused = [grips for refusal in step["refusals"] for grips in refusal["grips"]]
    for pair in farthest_first(step):
        if grip(pair) not in refused:
            return {"grips": [grip(pair)]}
    return {"refuse": "every offered pair was refused"}


for line in sys.stdin:
    print(json.dumps(answer(json.loads(line))), flush=True)
