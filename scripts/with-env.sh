#!/bin/sh
# Runs a command with the pinned Rust release: with-env.sh COMMAND [ARGUMENT...]
#
# toolchain-env.sh says when that needs a variable.
set -eu
toolchain=$(sh "$(dirname "$0")/toolchain-env.sh")
eval "$toolchain"
exec "$@"
