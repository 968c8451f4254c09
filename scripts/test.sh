#!/bin/sh
# Builds and runs tests, all packages side by side: test.sh [CARGO-ARGUMENT... [-- TEST-ARGUMENT...]]
#
# Without arguments it runs the fast tests.
#
# Prints a line per test binary with its time, all that a failed one printed, and at last the sums:
# N passed, N failed, N skipped. A Rust test cannot report "skipped". A test that lacks recorded data or a program by
# others appends its name as a line to the file that FABC_SKIPPED_FILE names, and returns. It counts as skipped, not as
# passed.
set -u

# Runs one test binary, whose package's folder and path follow: test.sh --one WORK FOLDER BINARY
if [ "${1:-}" = --one ]; then
    work=$2 folder=$3 binary=$4
    name=$(basename "$folder")/$(basename "$binary" | sed 's/-[0-9a-f]*$//')
    log=$work/log.$(basename "$binary")
    # One argument a line; none has a line end in it.
    IFS='
'
    # shellcheck disable=SC2046  # one word for each line
    set -- $(cat "$work/arguments")
    cd "$folder" || {
        echo "$name" >>"$work/failed"
        exit 0
    }
    CARGO_MANIFEST_DIR=$folder "$binary" "$@" >"$log" 2>&1 </dev/null
    code=$?
    if [ "$code" = 0 ] && grep -q '^test result: ok' "$log"; then
        sed -n "s#^test result: ok\. \(.*\); [0-9]* measured.*finished in \(.*\)#$name: \1; \2#p" "$log" |
            grep -v ': 0 passed' || true
    else
        echo "$name: failed with $code"
        cat "$log"
        echo "$name" >>"$work/failed"
    fi
    exit 0
fi

if [ $# -eq 0 ]; then
    set -- --workspace --exclude fab-arm-ros --exclude fab-arm-ros2 --locked --lib --bins --tests
fi
# Many tests wait for a process or a connection; others run meanwhile.
RUST_TEST_THREADS=${RUST_TEST_THREADS:-$((2 * $(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)))}
export RUST_TEST_THREADS
work=$(mktemp -d) || exit
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

FABC_SKIPPED_FILE=$work/skipped
: >"$FABC_SKIPPED_FILE"
: >"$work/failed"
export FABC_SKIPPED_FILE

# Test binaries run in their own package's folder, where a relative path would be wrong.
if [ -n "${FABC_REFERENCE_DATA:-}" ]; then
    if ! data=$(CDPATH='' cd -- "$FABC_REFERENCE_DATA" 2>/dev/null && pwd); then
        echo "FABC_REFERENCE_DATA names no folder: $FABC_REFERENCE_DATA" >&2
        exit 2
    fi
    FABC_REFERENCE_DATA=$data
    export FABC_REFERENCE_DATA
fi

# What stands before `--` is cargo's, the rest the test binaries'.
n_cargo=0
for argument; do
    [ "$argument" != -- ] || break
    n_cargo=$((n_cargo + 1))
done
: >"$work/arguments"
index=0
for argument; do
    shift
    index=$((index + 1))
    if [ "$index" -le "$n_cargo" ]; then
        set -- "$@" "$argument"
    elif [ "$index" -gt $((n_cargo + 1)) ]; then
        printf '%s\n' "$argument" >>"$work/arguments"
    fi
done

code=0
case " $* " in
*" --doc "*)
    # Documentation tests are built as they are run.
    cargo test "$@" >"$work/log.doc" 2>&1 || {
        code=$?
        cat "$work/log.doc"
    }
    : >"$work/built"
    ;;
*)
    cargo test --no-run --message-format=json-render-diagnostics "$@" >"$work/built" || code=$?
    ;;
esac
# The suite takes longest, so it begins first; then the largest binaries.
tab=$(printf '\t')
grep '"test":true},"features"' "$work/built" |
    sed -n "s/.*\"manifest_path\":\"\([^\"]*\)\/Cargo.toml\".*\"executable\":\"\([^\"]*\)\".*/\1$tab\2/p" |
    while IFS=$tab read -r folder binary; do
        printf '%d\t%s\t%s\n' "$(wc -c <"$binary")" "$folder" "$binary"
    done | sort -rn | cut -f2- >"$work/binaries"
if [ "$code" = 0 ]; then
    if [ -s "$work/binaries" ]; then
        # Two at once keep two cores busy while one of them ends with a single slow test.
        tr '\t\n' '\0\0' <"$work/binaries" | xargs -0 -n 2 -P 2 sh "$0" --one "$work" || code=1
        [ ! -s "$work/failed" ] || code=1
    elif [ ! -e "$work/log.doc" ]; then
        echo "cargo built no test binary that this script recognises"
        code=1
    fi
fi
cat "$work"/log.* >"$work/logs" 2>/dev/null

# "test result: ok. 5 passed; 0 failed; 1 ignored; 0 measured; 2 filtered out; finished in 0.01s"
counts=$(awk '
    /^test result: .*; finished in [0-9.]+s$/ {
        for (i = 2; i <= NF; i++) {
            if ($i == "passed;") passed += $(i - 1)
            if ($i == "failed;") failed += $(i - 1)
            if ($i == "ignored;") ignored += $(i - 1)
        }
    }
    END { print passed + 0, failed + 0, ignored + 0 }
' "$work/logs")
# shellcheck disable=SC2086  # three numbers
set -- $counts
passed=$1 failed=$2 ignored=$3

skipped=$(sort -u "$FABC_SKIPPED_FILE" | grep -c .)
passed=$((passed - skipped))
# A binary that crashed may have recorded skips without reporting passes.
[ "$passed" -ge 0 ] || passed=0

echo
# A build error or a crashed test binary prints no result line, but is a failure.
if [ "$code" -ne 0 ] && [ "$failed" -eq 0 ]; then
    echo "no build, or a test binary that crashed: counted as one failure"
    failed=1
fi
if [ "$ignored" -gt 0 ]; then
    echo "left out: $ignored tests that take long or need programs by others (make test-all)"
fi
if [ -z "${FABC_REFERENCE_DATA:-}" ]; then
    echo "hint: tests on recorded data are skipped; to run them, set FABC_REFERENCE_DATA to the data's folder"
fi
echo "$passed passed, $failed failed, $skipped skipped"
exit "$code"
