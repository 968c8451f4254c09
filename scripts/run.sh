#!/bin/sh
# Builds fabc and runs one task with it: run.sh FILE [ARGUMENT...]
#
# This is the build that `make test` starts from. Its simulator is optimised, so a run takes about as long as with a
# release build, which takes twice as long to make.
#
# FABC_FEATURES names features besides the defaults, such as `ros`.
# Exits with fabc's own exit code and prints its meaning, because make turns every
# failure into its own 2. A failed build exits with cargo's 101.
set -u

cargo build --locked --features "${FABC_FEATURES:-}" || exit
cargo run --locked --features "${FABC_FEATURES:-}" --quiet -- run "$@"
code=$?

case $code in
0) exit 0 ;;
1) meaning="the .fab file is wrong" ;;
2) meaning="the environment failed: a file, the network, a model or a robot" ;;
3) meaning="the run ended without reaching its goal, or a cap stopped it" ;;
64) meaning="wrong usage" ;;
130) meaning="interrupted" ;;
*) meaning="not one of fabc's own codes" ;;
esac
echo "fabc exit code: $code ($meaning)" >&2
exit "$code"
