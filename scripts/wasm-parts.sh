#!/bin/sh
# Prints in one line what the WebAssembly test lacks, or nothing if it can run.
#
# The standard library of wasm32-unknown-unknown belongs to one release of Rust. rustup has it for the pinned
# release. If rustup cannot download it, name a compiler that has it in RUSTC, and its linker in
# CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER.
set -u
target=wasm32-unknown-unknown

has_library() {
    folder=$("${RUSTC:-rustc}" --print target-libdir --target "$target" 2>/dev/null) || return 1
    for file in "$folder"/libstd-*.rlib; do
        [ ! -e "$file" ] || return 0
    done
    return 1
}

if ! command -v node >/dev/null; then
    echo "node is missing (Debian: apt-get install nodejs)"
elif ! has_library; then
    echo "Rust's standard library for $target is missing (rustup target add $target)"
fi
