#!/bin/sh
# Builds the book to TARGET/book: book.sh
#
# mdBook is installed once under the target folder, with its search and without what serves or watches.
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
    # Unoptimised it is built in half the time, and writes the book in a second or two. Its objects are not kept.
    cargo install --locked --quiet --debug --root "$target/peers-cargo" --target-dir "$target/peers-cargo/build" \
        --no-default-features --features search "mdbook@$version"
    rm -rf "$target/peers-cargo/build"
fi
"$mdbook" build "$here/../docs" --dest-dir "$target/book"
echo "$target/book/index.html"
