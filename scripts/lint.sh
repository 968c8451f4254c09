#!/bin/sh
# Checks formatting, clippy, that no system library is needed, packages, and documentation.
set -eu
here=$(dirname "$0")

# Prints each step before it runs, like make.
step() {
    echo "+ $*"
    "$@"
}

# One set of features for clippy and documentation, so that nothing is checked twice.
selected="--workspace --features fabc/tags,fabc/ros2"
if sh "$here/deps.sh" opencv 2>/dev/null; then
    selected="$selected,fabc/opencv"
else
    echo "left out: the feature opencv, which needs OpenCV and clang"
fi
if sh "$here/deps.sh" ros 2>/dev/null; then
    selected="$selected,fabc/ros"
else
    selected="$selected --exclude fab-arm-ros"
    echo "left out: fab-arm-ros, which needs OpenSSL's development files"
fi

step cargo fmt --all --check
# shellcheck disable=SC2086  # words without spaces
step cargo clippy $selected --all-targets --locked -- -D warnings
# Nothing else looks at what these features leave out.
step cargo clippy --workspace --exclude fab-arm-ros --exclude fab-arm-ros2 --lib --bins --locked -- -D warnings

# Fails if a package's build needs a crate that finds or binds a system library: no_system_library PACKAGE [ARGUMENT...]
#
# psm and ring are allowed: they compile their own C and assembler, with a C compiler alone. linux-raw-sys and
# netlink-sys are allowed: they declare kernel calls and link nothing. So is dirs-sys, which asks the C library for the
# user's home.
no_system_library() {
    tree=$(cargo tree --edges normal,build --prefix none --locked --package "$@")
    if printf '%s\n' "$tree" | grep -v -E '^(dirs|linux-raw|netlink)-sys v' | grep -E '^(opencv|bindgen|clang-sys|cmake|pkg-config|vcpkg|[^ ]*-sys) v'; then
        echo "$1 depends on the crates named above, which need a system library" >&2
        exit 1
    fi
}

# Fails if a package of ours uses one of the others: uses_no PACKAGE CRATE...
uses_no() {
    package=$1
    shift
    tree=$(cargo tree --prefix none --locked --package "$package")
    for other; do
        if printf '%s\n' "$tree" | grep "^$other v"; then
            echo "$package depends on $other, which is for the crates above it" >&2
            exit 1
        fi
    done
}

# Fails if a lock file no longer fits its manifest. Every step reads the workspace's own; these two are separate
# workspaces, which only slow tests and fuzzing build.
lock_file_fits() {
    cargo metadata --locked --format-version 1 --manifest-path "$1/Cargo.toml" >/dev/null
}

step lock_file_fits tests/wasm
step lock_file_fits fuzz

# The compiler and the authoring tool must build alone.
step cargo clippy --package fabc --no-default-features --locked -- -D warnings
# All that plain `cargo build` builds, and ROS 2.
step no_system_library fabc --features ros2
step uses_no fabc opencv apriltag
for room in vision world; do
    step uses_no "fab-$room" reqwest axum hyper
done
step uses_no fab-sim reqwest axum hyper
step no_system_library fab-compiler --target wasm32-unknown-unknown

# Packs every crate in seconds, and builds none. A manifest that cannot be published, or a dependency without a
# version, fails here. scripts/package.sh checks that each package builds alone, which is slow.
step cargo package --workspace --locked --offline --no-verify --allow-dirty --quiet

RUSTDOCFLAGS="-D warnings"
export RUSTDOCFLAGS
# shellcheck disable=SC2086  # words without spaces
step cargo doc $selected --no-deps --locked
