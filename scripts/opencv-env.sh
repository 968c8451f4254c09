#!/bin/sh
# Prints the exports that tell the `opencv` crate where OpenCV is, if pkg-config cannot.
#
# Debian splits OpenCV into one package per module. Its core and imgproc packages contain no opencv4.pc, so the crate
# must be told headers, folder and libraries. Homebrew's OpenCV has one, but pkg-config itself may be missing there.
# Prints nothing if pkg-config knows OpenCV, or if no OpenCV is found. Variables that are already set stay unchanged.
set -eu

# Prints one export, unless the user has set the variable: offer NAME VALUE
offer() {
    eval "given=\${$1:-}"
    [ -n "$given" ] || printf "export %s='%s'\n" "$1" "$2"
}

# Prints all three exports if both modules exist: offer_opencv INCLUDES LIBRARIES SUFFIX
# (INCLUDES is comma-separated and starts with the folder that holds opencv2/).
offer_opencv() {
    for module in core imgproc; do
        [ -f "${1%%,*}/opencv2/$module.hpp" ] || return 0
        [ -e "$2/libopencv_$module.$3" ] || return 0
    done
    offer OPENCV_LINK_LIBS opencv_imgproc,opencv_core
    offer OPENCV_LINK_PATHS "$2"
    offer OPENCV_INCLUDE_PATHS "$1"
}

if [ "$(uname -s)" = Darwin ]; then
    # The build does not search the folder of Homebrew's own clang for libclang.
    for llvm in /opt/homebrew/opt/llvm /usr/local/opt/llvm; do
        [ ! -e /Library/Developer/CommandLineTools/usr/lib/libclang.dylib ] || break
        [ -e "$llvm/lib/libclang.dylib" ] || continue
        offer LIBCLANG_PATH "$llvm/lib"
        break
    done
fi

# A user points the crate at a CMake build with `OpenCV_DIR`.
[ -z "${OpenCV_DIR:-}" ] || exit 0
if command -v pkg-config >/dev/null && pkg-config --exists opencv4; then
    exit 0
fi

if [ "$(uname -s)" = Darwin ]; then
    for prefix in /opt/homebrew/opt/opencv /usr/local/opt/opencv; do
        [ -d "$prefix/include/opencv4" ] || continue
        offer_opencv "$prefix/include/opencv4" "$prefix/lib" dylib
        break
    done
    exit 0
fi

# The header that differs between architectures is in a folder named after the architecture.
# A compiler knows that name. Without a compiler, the only such folder is the right one.
multiarch=$(cc -print-multiarch 2>/dev/null || clang -print-multiarch 2>/dev/null || true)
if [ -z "$multiarch" ] || [ ! -d "/usr/include/$multiarch/opencv4" ]; then
    multiarch=
    for directory in /usr/include/*/opencv4; do
        [ -d "$directory/opencv2" ] || continue
        multiarch=${directory#/usr/include/}
        multiarch=${multiarch%/opencv4}
        break
    done
fi
[ -n "$multiarch" ] || exit 0
offer_opencv "/usr/include/opencv4,/usr/include/$multiarch/opencv4" "/usr/lib/$multiarch" so
