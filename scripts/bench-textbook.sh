#!/bin/sh
# Times the fold of `fabc sim time` and the same scene in a textbook XPBD in Taichi, one after the other on one core.
#
# bench-textbook.sh FABC      FABC: the command, built with optimisation
#
# Taichi is installed under the target folder. Prints the CPU time of a step of both, and their ratio.
set -eu
fabc=$(CDPATH='' cd -- "$(dirname "$1")" && pwd)/$(basename "$1")
cd "$(dirname "$0")/.."
environment=${CARGO_TARGET_DIR:-target}/taichi
taichi=taichi==1.7.4

if [ "$(cat "$environment/installed.txt" 2>/dev/null)" != "$taichi" ]; then
    python3 -m venv --clear "$environment"
    "$environment/bin/python" -m pip install --quiet --disable-pip-version-check --only-binary :all: "$taichi" numpy
    echo "$taichi" >"$environment/installed.txt"
fi
"$environment/bin/python" - "$fabc" <<'PYTHON'
import json
import os
import subprocess
import sys

# Taichi's one worker takes longer if it may change the core.
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
ours = json.loads(subprocess.run([sys.argv[1], "sim", "time", "--json"], check=True, capture_output=True).stdout)
told = subprocess.run([sys.executable, "tests/peers/textbook_xpbd.py"], check=True, capture_output=True, text=True).stdout
theirs = json.loads(told.splitlines()[-1])
# What exploded, or was never folded, is no peer.
if not theirs["finite"] or theirs["corner_from_opposite_mm"] > 60:
    sys.exit(f"the textbook XPBD did not fold the cloth: {theirs}")
ours_ms, theirs_ms = ours["cpu_ms_per_step"], theirs["cpu_ms_per_step"]
print(
    f"a step of the diagonal fold of 50 x 50 particles: {ours_ms:.2f} ms of CPU time; textbook XPBD in Taichi: "
    f"{theirs_ms:.2f} ms, {theirs_ms / ours_ms:.0f} times as much"
)
PYTHON
