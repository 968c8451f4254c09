#!/bin/sh
# Runs `cargo test ARGUMENTS...` and ends with one line: N passed, N failed, N skipped.
#
# The numbers are sums over all test binaries and doctests; the exit code is cargo's. A Rust test cannot report
# "skipped". A test that lacks recorded data or a program by others appends its name as a line to the file that
# FABC_SKIPPED_FILE names, and returns. It counts as skipped, not as passed. FABC_LEFT_OUT is the number of tests that
# the caller did not start; they count as skipped too. FABC_EARLIER is `PASSED FAILED SKIPPED` of an earlier run,
# which is added.
set -u

work=$(mktemp -d) || exit
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

FABC_SKIPPED_FILE=$work/skipped
: >"$FABC_SKIPPED_FILE"
export FABC_SKIPPED_FILE

# Test binaries run in their own crate's folder, where a relative path would be wrong.
if [ -n "${FABC_REFERENCE_DATA:-}" ]; then
    if ! data=$(CDPATH='' cd -- "$FABC_REFERENCE_DATA" 2>/dev/null && pwd); then
        echo "FABC_REFERENCE_DATA names no folder: $FABC_REFERENCE_DATA" >&2
        exit 2
    fi
    FABC_REFERENCE_DATA=$data
    export FABC_REFERENCE_DATA
fi

# A pipe has the exit code of its last command, so cargo's own goes through a file.
{
    cargo test "$@"
    echo $? >"$work/code"
} | tee "$work/log"
code=$(cat "$work/code")

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
' "$work/log")
# shellcheck disable=SC2086  # three numbers
set -- $counts
passed=$1 failed=$2 ignored=$3

skipped=$(sort -u "$FABC_SKIPPED_FILE" | grep -c .)
passed=$((passed - skipped))
# A binary that crashed may have recorded skips without reporting passes.
[ "$passed" -ge 0 ] || passed=0
skipped=$((skipped + ${FABC_LEFT_OUT:-0}))

echo
# A build error or a crashed test binary prints no result line, but is a failure.
if [ "$code" -ne 0 ] && [ "$failed" -eq 0 ]; then
    echo "cargo test itself ended with $code (no build, or a test binary that crashed): counted as one failure"
    failed=1
fi
# shellcheck disable=SC2086  # three numbers or none
set -- ${FABC_EARLIER:-0 0 0}
passed=$((passed + $1)) failed=$((failed + $2)) skipped=$((skipped + $3))
[ "$2" -eq 0 ] || [ "$code" -ne 0 ] || code=1

if [ "$ignored" -gt 0 ]; then
    echo "left out: $ignored tests that take long or need large foreign parts (make test-peers)"
fi
if [ -z "${FABC_REFERENCE_DATA:-}" ]; then
    echo "hint: tests on recorded data are skipped; to run them, set FABC_REFERENCE_DATA to the data's folder"
fi
echo "$passed passed, $failed failed, $skipped skipped"
exit "$code"
