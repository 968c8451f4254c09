#!/bin/sh
# Names what a build lacks, each part with the command that installs it: deps.sh [--install] [FEATURE...]
#
# A plain build needs cargo, and a C compiler for its linker and for two crates. FEATURE is `opencv` or `ros`; no other
# feature needs more. `peers` means what the long tests compare with: ROS 1, which only Debian has, node, Python's venv and
# Rust's library for WebAssembly. Nothing is installed unless --install asks for it; the pinned Rust release is rustup's to fetch. Exit 0 if
# nothing is missing, otherwise 2 and one line.
set -u
here=$(dirname "$0")
install=
[ "${1:-}" != --install ] || { install=yes && shift; }

sudo="sudo "
[ "$(id -u)" != 0 ] || sudo=
if [ "$(uname -s)" = Darwin ]; then
    installer=brew how="brew install"
elif command -v apt-get >/dev/null; then
    installer=apt how="${sudo}apt-get install -y --no-install-recommends"
elif command -v dnf >/dev/null; then
    installer=dnf how="${sudo}dnf install"
else
    installer=pacman how="${sudo}pacman -S" # or a name to look for
fi

# Prints this system's packages for a part: package_of compiler|opencv|ros|peers
package_of() {
    case $installer-$1 in
    apt-compiler) echo gcc libc6-dev ;;
    apt-opencv) echo clang libopencv-core-dev libopencv-imgproc-dev ;;
    apt-ros) echo libssl-dev pkg-config ;;
    apt-peers)
        echo "libssl-dev pkg-config nodejs python3-venv python3-rosmaster python3-rospy python3-actionlib python3-genpy" \
            "python3-sensor-msgs python3-trajectory-msgs ros-std-msgs ros-geometry-msgs ros-actionlib-msgs ros-trajectory-msgs"
        ;;
    dnf-opencv) echo clang opencv-devel pkgconf-pkg-config ;;
    dnf-ros) echo openssl-devel pkgconf-pkg-config ;;
    brew-opencv) echo llvm opencv pkgconf ;;
    *-compiler) echo gcc ;;
    *-opencv) echo clang opencv pkgconf ;;
    *-ros) echo openssl pkgconf ;;
    esac
}

has() {
    command -v "$1" >/dev/null
}

# What the build scripts of the crates look for.
has_part() {
    case $1 in
    # Without the C library's start files a compiler exists but cannot link.
    compiler) has cc && { [ $installer = brew ] || [ -e "$(cc -print-file-name=Scrt1.o)" ]; } ;;
    opencv) has clang && { [ -n "${OPENCV_LINK_LIBS:-}${OpenCV_DIR:-}" ] || pkg-config --exists opencv4 2>/dev/null; } ;;
    ros) [ $installer = brew ] || [ -n "${OPENSSL_DIR:-}" ] || pkg-config --exists openssl 2>/dev/null ;;
    peers) [ $installer != apt ] || { has node && python3 -c "import ensurepip" 2>/dev/null && [ -z "$(sh "$here/ros-parts.sh")" ]; } ;;
    *) true ;;
    esac
}

if ! has cargo; then
    echo "fabc: missing: cargo: curl --proto '=https' --tlsv1.2 -sSf https://sh.rustup.rs | sh, then . \"\$HOME/.cargo/env\"" >&2
    exit 2
fi
case "$install $* " in
"yes "*" peers "*) rustup target add wasm32-unknown-unknown >&2 || true ;; # without it, a test is left out
esac
missing= packages=
for part in compiler "$@"; do
    has_part "$part" || {
        missing="$missing${missing:+ and }$part"
        packages="$packages $(package_of "$part")"
    }
done
[ -n "$missing" ] || exit 0
if [ -z "$install" ]; then
    missing=$(echo "$missing" | sed -e 's/compiler/a C compiler/' -e 's/opencv/OpenCV and clang/' -e "s/ros/OpenSSL's development files/" -e 's/peers/ROS 1, node or venv/')
    echo "fabc: missing: $missing: $how$packages (make deps${1:+ FEATURES=\"$*\"} does it)" >&2
    exit 2
fi
# A fresh image has no list of packages, and an old list names packages that are gone.
[ $installer != apt ] || ${sudo}apt-get update >&2 || exit 2
# shellcheck disable=SC2086  # lists of words
$how $packages >&2 || exit 2
# As the crates will find it, now that it is there.
sh "$here/with-env.sh" sh "$0" "$@" && exit
echo "fabc: installed$packages, and still not found" >&2
exit 2
