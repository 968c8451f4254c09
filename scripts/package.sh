#!/bin/sh
# Packs every crate of the workspace as it would be published, and builds each from its archive alone.
#
# Catches what an ordinary build cannot: a file that a crate includes and its package lacks, a dependency between
# members without a version. It is not part of lint.sh, which packs without building: a package has no part in
# the workspace's profiles, so nothing that was built before can be reused, and OpenCV's bindings are built again.
# cargo refuses to pack files that are not committed; `sh scripts/package.sh --allow-dirty` packs them anyway.
set -eu

# Nothing is built a second time from these archives.
CARGO_INCREMENTAL=0
export CARGO_INCREMENTAL

# fab-features is not published.
echo "+ cargo package --workspace --exclude fab-features --locked --offline $*"
cargo package --workspace --exclude fab-features --locked --offline "$@"
