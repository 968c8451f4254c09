#!/bin/sh
# Builds OpenCV's core and imgproc as static libraries: opencv.sh FOLDER
#
# In: the source of Debian 12's OpenCV, downloaded and compared with a pinned hash. It is the version that the Debian
# package links, so wheel and package compute alike. Needs cmake, ninja, a C++ compiler and zlib's development files.
# Out: FOLDER/installed (headers and libraries) and FOLDER/licences. Takes ten minutes on two cores; does nothing if
# FOLDER already holds what this script builds.
#
# Debian's own static libraries do not serve: they need LAPACK, TBB and GLX.
set -eu
here=$(CDPATH='' cd -- "$(dirname "$0")" && pwd)
mkdir -p "$1"
folder=$(CDPATH='' cd -- "$1" && pwd)

version=4.6.0
archive=opencv_$version+dfsg.orig.tar.xz
hash=40a59ba7e5c18a43652de0a08733c9843a39bba619b1f3e26a5fac4a6f041423
mirror=${FABC_DEBIAN_MIRROR:-http://deb.debian.org/debian}

if cmp -s "$here/opencv.sh" "$folder/built-by.sh"; then exit 0; fi
rm -rf "$folder/source" "$folder/build" "$folder/installed" "$folder/licences"
mkdir -p "$folder/source" "$folder/licences"

if ! echo "$hash  $folder/$archive" | sha256sum --check --status 2>/dev/null; then
    /usr/lib/apt/apt-helper -o APT::Sandbox::User="$(id -un)" download-file "$mirror/pool/main/o/opencv/$archive" "$folder/$archive" "SHA256:$hash" >&2
fi
tar -xf "$folder/$archive" -C "$folder/source" --strip-components 1 --exclude '*/samples' --exclude '*/testdata'

# zlib reads compressed files of OpenCV's own formats. fabc has none, but core refers to it.
zlib=$(cc -print-file-name=libz.a)
if [ ! -e "$zlib" ]; then
    echo "zlib's static library is missing (Debian: apt-get install zlib1g-dev)" >&2
    exit 2
fi

# The instruction sets are those of Debian's build: SSE2, and more where the processor has it.
set -- -DCPU_BASELINE=SSE2 -DCPU_BASELINE_DISABLE=SSE3
for part in 1394 ADE CUDA EIGEN FFMPEG GSTREAMER GTK IPP ITT JASPER JPEG LAPACK OPENCL OPENEXR OPENGL OPENJPEG PNG \
    PROTOBUF QT QUIRC TBB TIFF V4L VA VA_INTEL VTK WEBP; do
    set -- "$@" "-DWITH_$part=OFF"
done
for part in EXAMPLES JAVA PERF_TESTS SHARED_LIBS TESTS ZLIB opencv_apps; do
    set -- "$@" "-DBUILD_$part=OFF"
done
prefix_map="-ffile-prefix-map=$folder/source=opencv -ffile-prefix-map=$folder/build=opencv"
cmake -G Ninja -S "$folder/source" -B "$folder/build" -Wno-dev -DBUILD_LIST=core,imgproc "$@" \
    -DZLIB_LIBRARY="$zlib" -DCV_TRACE=OFF -DBUILD_INFO_SKIP_TIMESTAMP=ON \
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_FLAGS="$prefix_map" -DCMAKE_CXX_FLAGS="$prefix_map" \
    -DCMAKE_INSTALL_PREFIX="$folder/installed" -DCMAKE_INSTALL_LIBDIR=lib >"$folder/configure.log" 2>&1 || {
    tail -n 40 "$folder/configure.log" >&2
    exit 2
}
ninja -C "$folder/build" install >"$folder/build.log" 2>&1 || {
    tail -n 40 "$folder/build.log" >&2
    exit 2
}

cp "$zlib" "$folder/installed/lib/libz.a"
cp "$folder/source/LICENSE" "$folder/licences/opencv-LICENSE"
cp "$folder/source/COPYRIGHT" "$folder/licences/opencv-COPYRIGHT"
# OpenCV installs the texts of what it carries along.
for text in "$folder"/installed/share/licenses/opencv4/*; do
    cp "$text" "$folder/licences/opencv-${text##*/}"
done
cp /usr/share/doc/zlib1g-dev/copyright "$folder/licences/zlib-copyright"
rm -rf "$folder/source" "$folder/build"
cp "$here/opencv.sh" "$folder/built-by.sh"
