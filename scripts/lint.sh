#!/bin/sh
# Judges form: layout, clippy, the authoring tool without system libraries, documentation.
set -eu

# Shows each step before it runs, as make would.
step() {
    echo "+ $*"
    "$@"
}

step cargo fmt --all --check
step cargo clippy --workspace --all-targets --locked -- -D warnings

# The authoring tool has to build alone, and without what a build script needs to find a system
# library. (A C compiler is used: the grammar's stack guard has a page of assembler.)
step cargo clippy --package fabc --no-default-features --locked -- -D warnings
tree=$(cargo tree --package fabc --no-default-features --edges normal,build --prefix none --locked)
if printf '%s\n' "$tree" | grep -E '^(fabc-runtime|opencv|bindgen|clang-sys|cmake|pkg-config|vcpkg) v'; then
    echo "fabc without default features depends on the crates named above" >&2
    exit 1
fi

RUSTDOCFLAGS="-D warnings"
export RUSTDOCFLAGS
step cargo doc --workspace --no-deps --locked
