#!/bin/sh
# Runs a command with the pinned Rust release: with-env.sh COMMAND [ARGUMENT...]
#
# toolchain-env.sh says when that needs a variable.
set -eu
toolchain=$(sh "$(dirname "$0")/toolchain-env.sh")
eval "$toolchain"
# Incremental files would make a first build a fifth longer. Cargo still writes them for
# a package that is built again.
[ -d "${CARGO_TARGET_DIR:-target}/debug" ] || export CARGO_INCREMENTAL="${CARGO_INCREMENTAL:-0}"
exec "$@"
