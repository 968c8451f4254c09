#!/bin/sh
# Runs a command with the pinned Rust release: with-env.sh COMMAND [ARGUMENT...]
#
# rustup looks for a toolchain named after the release. If the same release is installed only under another name
# ("stable"), another download would be wasteful, and fails without a network.
set -eu
pinned=$(sed -n 's/^channel *= *"\(.*\)"/\1/p' "$(dirname "$0")/../rust-toolchain.toml")
toolchains=${RUSTUP_HOME:-${HOME:-}/.rustup}/toolchains
if [ -z "${RUSTUP_TOOLCHAIN:-}" ] && [ -z "$(ls -d "$toolchains/$pinned"* 2>/dev/null)" ]; then
    for folder in "$toolchains"/*; do
        case $("$folder/bin/rustc" --version 2>/dev/null) in
        "rustc $pinned "*) export RUSTUP_TOOLCHAIN="${folder##*/}" ;;
        esac
    done
fi
# Debian's packages of OpenCV's two modules have no opencv4.pc, so a build with the feature `opencv` is told their places.
multiarch=$(cc -print-multiarch 2>/dev/null) || multiarch=
if [ -z "${OPENCV_LINK_LIBS:-}" ] && [ -e "/usr/lib/$multiarch/libopencv_imgproc.so" ] && ! pkg-config --exists opencv4 2>/dev/null; then
    export OPENCV_LINK_LIBS=opencv_imgproc,opencv_core OPENCV_LINK_PATHS="/usr/lib/$multiarch"
    export OPENCV_INCLUDE_PATHS="/usr/include/opencv4,/usr/include/$multiarch/opencv4"
fi
exec "$@"
