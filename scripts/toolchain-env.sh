#!/bin/sh
# Prints the export that selects the pinned Rust release, if rust-toolchain.toml alone cannot.
#
# rustup looks for a toolchain named after the release. If the same release is installed only
# under another name ("stable"), another download would be wasteful, and fails without a
# network. Prints nothing if the pinned name is installed, if the user chose a toolchain, or
# if no installed toolchain is the pinned release.
set -eu
here=$(dirname "$0")

[ -z "${RUSTUP_TOOLCHAIN:-}" ] || exit 0
pinned=$(sed -n 's/^channel *= *"\(.*\)"/\1/p' "$here/../rust-toolchain.toml")
toolchains=${RUSTUP_HOME:-${HOME:-}/.rustup}/toolchains

for directory in "$toolchains/$pinned" "$toolchains/$pinned"-*; do
    [ ! -x "$directory/bin/rustc" ] || exit 0
done
for directory in "$toolchains"/*; do
    [ -x "$directory/bin/rustc" ] || continue
    case $("$directory/bin/rustc" --version) in
    "rustc $pinned "*)
        echo "export RUSTUP_TOOLCHAIN='${directory##*/}'"
        exit 0
        ;;
    esac
done
