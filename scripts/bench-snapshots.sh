#!/bin/sh
# Times the snapshots of a hundred tasks: taking them for the first time, and checking them.
#
# bench-snapshots.sh FABC      FABC: the command, built with optimisation
#
# The tasks are folds of the shipped library on a hundred cloth sizes, each with its five ablations, in two stages.
# Nothing is cached. Prints seconds.
set -eu
fabc=$(CDPATH='' cd -- "$(dirname "$1")" && pwd)/$(basename "$1")
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

cp -r tasks/lib "$work/lib"
number=1
while [ "$number" -le 100 ]; do
    cat >"$work/fold_$number.fab" <<TASK
use "lib/folding.fab"

task fold_$number extends folding {
    cloth grid($((25 + number % 30)), $((20 + number / 4)))
    subgoals { demonstrate { fold corner(back_left) -> corner(front_right) at 0.$((number % 50 + 40)) } }
}
TASK
    number=$((number + 1))
done
cd "$work"
export FABC_CACHE_DIR="$work/cache"

# Prints how many seconds a command takes: seconds COMMAND...
seconds() {
    begun=$(date +%s%N)
    "$@" >said 2>&1 || {
        cat said >&2
        exit 2
    }
    echo "$(($(date +%s%N) - begun))" | awk '{ printf "%.2f", $1 / 1e9 }'
}

take=$(seconds "$fabc" snap fold_*.fab)
count=$(find snapshots -name '*.snap.new' | wc -l)
accept=$(seconds "$fabc" review --accept-all)
check=$(seconds "$fabc" snap --check fold_*.fab)
echo "snapshots of 100 tasks: $count; taken in $take s, accepted in $accept s, checked in $check s"
