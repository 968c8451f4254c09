#!/bin/sh
# Counts the instructions of the simulator's steps, and compares them with pinned numbers.
#
# count-instructions.sh        counts, prints, compares; exits with 1 if a count exceeds its pinned number by over 5 %
# count-instructions.sh --pin  counts, and pins the counts
#
# Valgrind's callgrind runs examples/fold.rs of the crate `fab-sim`. Counts do not depend on the load of the machine, so
# they reveal a slower step anywhere. Without valgrind nothing is counted, and the exit code is 0. Two builds are
# counted: `narrow`, for the baseline instruction set, and `wide`, if this machine has AVX2. For each build, the script
# counts one whole fold of 50 x 50 particles, in total and by function, and the first 15 steps of several sizes; for the last
# build also the fold of each material, with its ratio to that of the recorded scene's cloth.
# sim/benches/instructions.txt holds the numbers. A new compiler or other simulator parameters may need a new --pin.
set -eu
cd "$(dirname "$0")/.."

pins=sim/benches/instructions.txt
sizes='25 50 100 200'
materials='cotton denim silk towel'
steps=15
machine=$(uname -m)
target=${CARGO_TARGET_DIR:-target}

if ! command -v valgrind >/dev/null || ! command -v callgrind_annotate >/dev/null; then
    echo "instructions are not counted: valgrind is missing (Debian: apt-get install valgrind)"
    exit 0
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

# Prints the instruction count of a run: count FILE ARGUMENT...
count() {
    out=$1
    shift
    valgrind --tool=callgrind --callgrind-out-file="$out" "$work/fold" "$@" >"$work/steps" 2>"$work/log" || {
        cat "$work/log" >&2
        exit 2
    }
    awk '/^(summary|totals):/ { print $2; exit }' "$out"
}

# Prints "FUNCTION INSTRUCTIONS" for the ten heaviest functions of a callgrind file. Spaces in a name become `_`. Code
# inlined from another file counts for the function that contains it.
functions() {
    callgrind_annotate --threshold=100 --auto=no "$1" 2>/dev/null | awk '
        /^ *[0-9,]+ +\([ 0-9.]+%\) +[^ ]/ && !/PROGRAM TOTALS/ {
            count = $1
            gsub(",", "", count)
            sub(/^ *[0-9,]+ +\([ 0-9.]+%\) +[^:]*:/, "")
            sub(/ \[[^][]*\]$/, "")
            gsub(" ", "_")
            sum[$0] += count
        }
        END { for (name in sum) printf "%s %.0f\n", name, sum[name] }
    ' | sort -k 2,2nr -k 1,1 | head -n 10
}

# Appends "MACHINE BUILD RUN WHAT INSTRUCTIONS" to the results: the instructions of a step, without the setup.
measure() {
    build=$1
    base=$(count "$work/base" 50 0)
    all=$(count "$work/fold.out" 50)
    taken=$(cat "$work/steps")
    echo "$machine $build fold_50 total $(((all - base) / taken))" >>"$work/results"
    functions "$work/fold.out" | while read -r name n; do
        echo "$machine $build fold_50 $name $((n / taken))" >>"$work/results"
    done
    for size in $sizes; do
        base=$(count "$work/base" "$size" 0)
        all=$(count "$work/begin" "$size" "$steps")
        echo "$machine $build begin_$size total $(((all - base) / steps))" >>"$work/results"
    done
}

builds=narrow
if grep -qs '^flags.* avx2' /proc/cpuinfo; then builds='narrow wide'; fi
for build in $builds; do
    features=
    [ "$build" = wide ] || features='--features narrow'
    last=$build
    # shellcheck disable=SC2086  # none or two words
    cargo build --release --locked --quiet -p fab-sim --example fold $features
    cp "$target/release/examples/fold" "$work/fold"
    measure "$build"
done
for cloth in $materials; do
    base=$(count "$work/base" 50 0 "$cloth")
    all=$(count "$work/cloth" 50 all "$cloth")
    taken=$(cat "$work/steps")
    echo "$machine $last fold_50_$cloth total $(((all - base) / taken))" >>"$work/results"
done

if [ "${1:-}" = --pin ]; then
    {
        grep '^#' "$pins"
        grep -v '^#' "$pins" | grep -v "^$machine " || true
        cat "$work/results"
    } >"$work/pins"
    cp "$work/pins" "$pins"
fi

awk -v pins="$pins" -v machine="$machine" -v steps="$steps" '
    FILENAME == pins {
        if ($0 !~ /^#/ && $1 == machine) pinned[$2, $3, $4] = $5
        next
    }
    {
        key = $2 SUBSEP $3 SUBSEP $4
        if ($2 != build) {
            build = $2
            print "\ninstructions per step, " build " build, one whole fold of 50 x 50 particles"
        }
        if ($3 != run && $3 == "begin_25") {
            print "\ninstructions per step, " build " build, the first " steps " steps"
        }
        if ($3 ~ /^fold_50_/ && run ~ /^begin_/) {
            print "\ninstructions per step, " build " build, one whole fold of 50 x 50 particles of a material"
        }
        run = $3
        if ($4 == "total") whole = $5
        if (run == "fold_50" && $4 == "total") recorded[build] = $5
        note = "not pinned"
        if (key in pinned) {
            change = 100 * ($5 / pinned[key] - 1)
            note = sprintf("%+.1f %% of the pinned", change)
            # Small functions vary for small reasons; the total includes them.
            if (change > 5 && $5 > 0.05 * whole) { note = note "  MORE THAN 5 %"; failed = 1 }
            if (change < -5 && $4 == "total") note = note "; pin anew to keep the gain"
        }
        name = $4
        if (run ~ /^fold_50_/) {
            name = substr(run, 9)
            note = sprintf("%.2f times the recorded scene'"'"'s cloth;  %s", $5 / recorded[build], note)
        }
        if (run ~ /^begin_/) {
            dim = substr(run, 7)
            name = dim " x " dim
            each = $5 / dim / dim
            note = sprintf("%6.0f a particle;  %s", each, note)
            if (!(build in least) || each < least[build]) least[build] = each
            if (each > most[build]) most[build] = each
        }
        printf "%12d  %-42s %s\n", $5, name, note
    }
    END {
        print ""
        for (build in most) {
            # At first only the part around the corner moves, which is a larger share of a small cloth.
            spread = 100 * (most[build] / least[build] - 1)
            printf "%s build: the largest and the smallest cost of a particle differ by %.0f %% over the sizes\n", build, spread
        }
        if (failed) print "the simulator takes more than its pinned numbers; scripts/count-instructions.sh says how to pin anew"
        exit failed
    }
' "$pins" "$work/results"
