#!/bin/sh
# Packs every crate of the workspace for publishing, and builds each from its archive alone.
#
# Catches what an ordinary build cannot: a file that a crate includes and its package lacks, or a dependency between
# members without a version. It is not part of lint.sh, which packs without building. The workspace's profiles do not
# apply to a package, so it reuses no earlier build. cargo refuses to pack
# uncommitted files; `sh scripts/package.sh --allow-dirty` packs them anyway.
set -eu

# These archives are built only once.
CARGO_INCREMENTAL=0
export CARGO_INCREMENTAL

echo "+ cargo package --workspace --locked --offline $*"
cargo package --workspace --locked --offline "$@"
