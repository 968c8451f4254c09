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


def hello(question):
    return {"protocol": 2}


def reset(rollout):
    if rollout["task"] != "double_triangle":
        return {"refuse": f"{rollout['task']} is not a task that this policy knows"}
    return {}


def decide(step):
    refused = [grips for refusal in step["refusals"] for grips in refusal["grips"]]
    for pair in farthest_first(step):
        if grip(pair) not in refused:
            return {"grips": [grip(pair)]}
    return {"refuse": "every offered pair was refused"}


answers = {"hello": hello, "reset": reset, "decide": decide}
for line in sys.stdin:
    question = json.loads(line)
    print(json.dumps(answers[question["do"]](question)), flush=True)
