"""Recomputes a rollout's error from the files that its journal names.

Shares no code with fabc. Usage: recompute_error.py RUN_FOLDER
Prints the mean particle distance to the nearest expert result in millimetres.
"""

import json
import pathlib
import sys

import numpy

run = pathlib.Path(sys.argv[1])
lines = [json.loads(line) for line in (run / "rollout.jsonl").read_text().splitlines()]
header, end = lines[0], lines[-1]
assert header["type"] == "header" and header["schema"] == 4, header
assert end["type"] == "end", "the rollout did not end by itself"
grid = header["start"]["grid"]
last = numpy.load(run / end["final"])
assert last.shape == (grid["dimx"] * grid["dimy"], 3), last.shape
distances = {}
for expert in end["experts"]:
    result = numpy.load(run / expert["file"])
    difference = last.astype(numpy.float64) - result.astype(numpy.float64)
    distances[expert["sequence"]] = numpy.linalg.norm(difference, axis=1).mean() * 1000.0
    assert abs(distances[expert["sequence"]] - expert["distance_mm"]) < 1e-6, expert
nearest = min(distances, key=distances.get)
assert nearest == end["nearest_expert"], (nearest, end["nearest_expert"])
assert abs(distances[nearest] - end["report"]["mean_particle_distance_mm"]) < 1e-6
print(f"{distances[nearest]:.6f}")
