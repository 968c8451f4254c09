#!/bin/sh
# Builds the book to TARGET/book: book.sh
#
# Installs mdBook once under the target folder, with search and without the serve and watch features.
set -eu
here=$(CDPATH='' cd -- "$(dirname "$0")" && pwd)
version=0.5.2

target=${CARGO_TARGET_DIR:-$here/../target}
mkdir -p "$target"
target=$(CDPATH='' cd -- "$target" && pwd)
mdbook=$target/peers-cargo/bin/mdbook

if [ "$("$mdbook" --version 2>/dev/null || true)" != "mdbook v$version" ]; then
    if [ -n "${FABC_NO_INSTALL:-}" ]; then
        echo "mdBook $version is missing: cargo install --locked mdbook@$version --no-default-features --features search" >&2
        exit 2
    fi
    # An unoptimised build takes half the time, and still writes the book in a second or two. Its objects are deleted.
    CARGO_PROFILE_DEV_DEBUG=false cargo install --locked --quiet --debug --root "$target/peers-cargo" \
        --target-dir "$target/peers-cargo/build" \
        --no-default-features --features search "mdbook@$version"
    rm -rf "$target/peers-cargo/build"
fi
"$mdbook" build "$here/../docs" --dest-dir "$target/book"
echo "$target/book/index.html"
