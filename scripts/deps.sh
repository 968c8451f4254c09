#!/bin/sh
# Checks that a build has what it needs, and installs missing parts if it may.
#
# In: the machine; FABC_NO_INSTALL=1 to install nothing; in FABC_FEATURES the features to build besides the
# defaults (`ros` needs OpenSSL's development files). Out: exit 0 and no output if nothing is missing. Otherwise it
# installs (on Debian and Ubuntu as root or with sudo, on macOS with Homebrew, a Rust release with rustup). If it
# cannot, it exits with 2 and one line that names each missing part and its command. The user installs rustup, git
# and make.
#
# deps.sh --for-bindings       only lists what the build of OpenCV's bindings lacks; runtime/needs/build.rs asks it
# deps.sh --command-for THING  prints the command that installs a part
set -u
here=$(dirname "$0")

# --- Package managers -------------------------------------------------------

if [ "$(uname -s)" = Darwin ]; then
    installer=brew
elif [ -f /etc/debian_version ] && command -v apt-get >/dev/null; then
    installer=apt
elif command -v dnf >/dev/null; then
    installer=dnf
elif command -v pacman >/dev/null; then
    installer=pacman
else
    installer=none
fi

sudo="sudo "
[ "$(id -u)" != 0 ] || sudo=

# Prints this system's packages for a part: package_of THING
package_of() {
    case $installer-$1 in
    apt-linker) echo "gcc libc6-dev" ;;
    apt-cxx) echo g++ ;;
    apt-clang) echo clang ;;
    apt-libclang) echo libclang1 ;;
    apt-opencv) echo "libopencv-core-dev libopencv-imgproc-dev" ;;
    apt-openssl) echo "libssl-dev pkg-config" ;;
    apt-pkg-config) echo pkg-config ;;
    brew-opencv) echo opencv ;;
    brew-pkg-config) echo pkgconf ;;
    dnf-openssl) echo "openssl-devel pkgconf-pkg-config" ;;
    dnf-pkg-config) echo pkgconf-pkg-config ;;
    dnf-linker) echo gcc ;;
    dnf-cxx) echo gcc-c++ ;;
    dnf-clang) echo clang ;;
    dnf-libclang) echo clang-libs ;;
    dnf-opencv) echo opencv-devel ;;
    pacman-linker | pacman-cxx) echo gcc ;;
    pacman-clang | pacman-libclang) echo clang ;;
    pacman-opencv) echo opencv ;;
    pacman-openssl) echo "openssl pkgconf" ;;
    pacman-pkg-config) echo pkgconf ;;
    esac
}

# Prints the command with which a user installs a part: command_for THING
command_for() {
    case $installer-$1 in
    apt-*) echo "${sudo}apt-get install -y --no-install-recommends $(package_of "$1")" ;;
    brew-linker | brew-cxx | brew-clang | brew-libclang) echo "xcode-select --install" ;;
    brew-*) echo "brew install $(package_of "$1")" ;;
    dnf-*) echo "${sudo}dnf install $(package_of "$1")" ;;
    pacman-*) echo "${sudo}pacman -S $(package_of "$1")" ;;
    *) echo "install it with this system's package manager" ;;
    esac
}

# --- What is missing ---------------------------------------------------------------------

missing_line=  # "thing: command; thing: command"
packages=      # what `installer` is to install
rust_release=  # what rustup is to install
user_must_act= # something that no installer here provides

# Records a missing part: note NAME COMMAND
note() {
    missing_line="$missing_line${missing_line:+; }$1: $2"
}

# Records a missing part that a package provides: note_package THING NAME
note_package() {
    note "$2" "$(command_for "$1")"
    package=$(package_of "$1")
    packages="$packages${packages:+ }$package"
    [ -n "$package" ] || user_must_act=yes
}

has() {
    command -v "$1" >/dev/null
}

# Searches where the build searches: LIBCLANG_PATH, then the system's folders.
has_libclang() {
    # Nobody names a configuration without a reason.
    [ -z "${LLVM_CONFIG_PATH:-}" ] || return 0
    xcode=$(xcode-select --print-path 2>/dev/null)
    # Lists of folders, one a line. Cargo sets the first for every build script.
    lists=$(printf '%s\n%s' "${LD_LIBRARY_PATH:-}" "${LIBRARY_PATH:-}" | tr : '\n' | sed -n 's|^/.*|&/libclang[.-]*|p')
    # shellcheck disable=SC2086  # patterns
    for file in $lists ${LIBCLANG_PATH:+"$LIBCLANG_PATH" "$LIBCLANG_PATH"/libclang*} \
        ${xcode:+"$xcode"/Toolchains/XcodeDefault.xctoolchain/usr/lib/libclang[.-]*} \
        /usr/lib*/libclang[.-]* /usr/lib*/*/libclang[.-]* /usr/lib*/*/*/libclang[.-]* \
        /usr/local/lib*/libclang[.-]* /usr/local/lib*/*/libclang[.-]* \
        /usr/local/llvm*/lib*/libclang[.-]* /usr/local/opt/llvm*/lib/libclang[.-]* \
        /Library/Developer/CommandLineTools/usr/lib/libclang[.-]* \
        /Applications/Xcode.app/Contents/Developer/Toolchains/XcodeDefault.xctoolchain/usr/lib/libclang[.-]*; do
        # The static library and the C++ interface do not count, and neither does LIBCLANG_PATH as a bare folder.
        case $file in
        *libclang-cpp* | *.a) continue ;;
        esac
        [ ! -f "$file" ] || return 0
    done
    has llvm-config && [ -n "$(ls "$(llvm-config --prefix)"/lib*/libclang[.-]* 2>/dev/null)" ]
}

# Whether the `opencv` crate will find OpenCV, through variables, pkg-config or CMake.
has_opencv() {
    # A user who says where OpenCV is, or how to look for it, is believed.
    for variable in OpenCV_DIR CMAKE_PREFIX_PATH VCPKG_ROOT OPENCV_INCLUDE_PATHS OPENCV_PACKAGE_NAME \
        OPENCV_PKGCONFIG_NAME OPENCV_CMAKE_NAME OPENCV_CMAKE_BIN OPENCV_CMAKE_TOOLCHAIN_FILE; do
        eval "[ -z \"\${$variable:-}\" ]" || return 0
    done
    pkg_config=${PKG_CONFIG:-$here/pkg-config}
    for package in opencv5 opencv4 opencv; do
        if "$pkg_config" --exists "$package" 2>/dev/null; then return 0; fi
    done
    has cmake && [ -n "$(ls -d /usr/lib*/cmake/opencv4 /usr/lib/*/cmake/opencv4 \
        /usr/local/lib*/cmake/opencv4 2>/dev/null)" ]
}

# Whether the `openssl` crate will find its library; on macOS nothing needs it.
has_openssl() {
    [ "$installer" != brew ] || return 0
    if [ -n "${OPENSSL_DIR:-}" ]; then return 0; fi
    has pkg-config && pkg-config --exists openssl
}

# What the build script of the `opencv` crate needs.
find_missing_for_bindings() {
    CXX=${CXX:-c++}
    if ! has_libclang; then
        note_package clang libclang
    elif ! has "${CXX%% *}"; then
        note_package cxx "a C++ compiler (c++)"
    fi
    has_opencv || note_package opencv "OpenCV's core and imgproc development files"
}

find_missing() {
    eval "$(sh "$here/toolchain-env.sh")"

    pinned=$(sed -n 's/^channel *= *"\(.*\)"/\1/p' "$here/../rust-toolchain.toml")
    if has rustup; then
        # `rustup which` would install the release, so look for its folder.
        if [ -z "${RUSTUP_TOOLCHAIN:-}" ] \
            && [ -z "$(ls -d "${RUSTUP_HOME:-${HOME:-}/.rustup}/toolchains/$pinned"* 2>/dev/null)" ]; then
            rust_release=$pinned
            note "Rust $pinned" "rustup toolchain install $pinned --profile minimal --component rustfmt --component clippy"
        fi
    elif has cargo; then
        : # A cargo without rustup: Cargo.toml's rust-version decides whether it will do.
    elif [ -x "${CARGO_HOME:-${HOME:-}/.cargo}/bin/cargo" ]; then
        note "cargo on PATH" ". \"\$HOME/.cargo/env\""
        user_must_act=yes
    else
        note rustup "curl --proto '=https' --tlsv1.2 -sSf https://sh.rustup.rs | sh"
        user_must_act=yes
    fi

    # Without the C library's start files a compiler exists but cannot link.
    if ! has cc || { [ "$installer" != brew ] && [ ! -e "$(cc -print-file-name=Scrt1.o)" ]; }; then
        note_package linker "a C compiler and linker (cc)"
    fi
    if ! has clang; then
        note_package clang clang
    else
        CXX=${CXX:-c++}
        # Debian's clang includes libclang and is a C++ compiler, so ask only if clang exists.
        has "${CXX%% *}" || note_package cxx "a C++ compiler (c++)"
        has_libclang || note_package libclang libclang
    fi
    has_opencv || note_package opencv "OpenCV's core and imgproc development files"
    case " ${FABC_FEATURES:-} " in
    *[\ ,]ros[\ ,]*) has_openssl || note_package openssl "OpenSSL's development files and pkg-config" ;;
    esac
}

# --- Installing --------------------------------------------------------------------------

# Prints the missing parts in one line, and exits.
give_up() {
    echo "fabc: missing: $missing_line" >&2
    exit 2
}

# Installs `packages` with apt; the first argument is empty for root, or `sudo`.
install_by_apt() {
    # The package list may be absent (fresh images) or older than the mirror.
    if ! ls /var/lib/apt/lists/*Packages* >/dev/null 2>&1; then
        $1 apt-get update || return
    fi
    # shellcheck disable=SC2086  # `packages` is a list, `$1` may be nothing
    $1 env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $packages && return
    $1 apt-get update || return
    # shellcheck disable=SC2086
    $1 env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $packages
}

# Whether this script can install `packages`, perhaps after asking for a password.
may_install() {
    case $installer in
    apt) [ -z "$sudo" ] || { has sudo && { sudo -n true 2>/dev/null || [ -t 0 ]; }; } ;;
    brew) has brew ;;
    *) false ;;
    esac
}

install_packages() {
    # shellcheck disable=SC2086
    case $installer in
    apt) install_by_apt "${sudo% }" ;;
    brew) brew install $packages ;;
    esac
}

case ${1:-} in
--command-for)
    command_for "$2"
    exit
    ;;
--for-bindings)
    find_missing_for_bindings
    [ -z "$missing_line" ] || give_up
    exit 0
    ;;
esac
find_missing
[ -n "$missing_line" ] || exit 0
case ${FABC_NO_INSTALL:-0} in
0) ;;
*) give_up ;;
esac
# Report first what only the user can install: do not change a system for a build that cannot start.
[ -z "$user_must_act" ] || give_up
[ -z "$packages" ] || may_install || give_up

echo "fabc: installing ${packages}${rust_release:+ Rust $rust_release} (FABC_NO_INSTALL=1 only names what is missing)" >&2
{
    if [ -n "$packages" ]; then install_packages || give_up; fi
    if [ -n "$rust_release" ]; then
        rustup toolchain install "$rust_release" --profile minimal \
            --component rustfmt --component clippy --no-self-update || give_up
    fi
} >&2 # stdout belongs to the command that called this script

# Check again, in a shell without the results of the first check.
FABC_NO_INSTALL=1 exec sh "$0"
