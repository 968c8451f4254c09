#!/bin/sh
# Times runs with and without a film.
#
# bench-films.sh FABC      FABC: the command, built in any profile
#
# Prints the CPU time of a run in seconds, user and system, the least of five, and its ratio to that of the run without a
# film. A film should at most double it. Expert results are cached by a run that is not counted.
set -eu
fabc=$(CDPATH='' cd -- "$(dirname "$1")" && pwd)/$(basename "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
cd "$work"
export FABC_CACHE_DIR="$work/cache"

# Prints the least CPU time of five runs: least ARGUMENT...
least() {
    for _ in 1 2 3 4 5; do
        (
            "$fabc" run "$@" --out "$work/run" >said 2>&1 || {
                cat said >&2
                exit 2
            }
            # The second line is that of the programs that ran. In a pipe, `times` would tell of another shell.
            times >used
            awk 'NR == 2 { split($1 "m" $2, t, /[ms]+/); printf "%.3f\n", 60 * (t[1] + t[3]) + t[2] + t[4] }' used
        )
        rm -rf "$work/run"
    done | sort -n | head -n 1
}

for task in double_straight all_corners_inward hem; do
    # The stand-in picks corners only.
    set -- "$task"
    [ "$task" != hem ] || set -- "$task" --policy expert
    "$fabc" run "$@" --out "$work/run" >said 2>&1
    rm -rf "$work/run"
    plain=$(least "$@")
    echo "$task: $plain s"
    filmed=$(least "$@" --video "$work/film.gif")
    echo "$filmed $plain" | awk '{ printf "  filmed: %.3f s, %.2f times\n", $1, $1 / $2 }'
done
