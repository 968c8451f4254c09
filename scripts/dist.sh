#!/bin/sh
# Builds what is shipped for Linux x86-64: dist.sh [deb] [wheel] [static]
#
# Out, in TARGET/dist: a Debian 12 package, a Python wheel, and the authoring tool as one static binary. Without
# arguments it builds all three, and one by one otherwise. Prints the size and the build time of each.
#
# Everything is built under TARGET/dist/build, which may be deleted. A first build of all three takes about ten minutes
# on two cores. scripts/dist/check.sh tests the results.
set -eu
here=$(CDPATH='' cd -- "$(dirname "$0")" && pwd)
root=$(dirname "$here")
cd "$root"

if [ "$(uname -s)-$(uname -m)" != Linux-x86_64 ]; then
    echo "make dist builds for Linux x86-64 only; on this machine: cargo install --path ." >&2
    exit 2
fi

FABC_DIST=${CARGO_TARGET_DIR:-target}/dist
mkdir -p "$FABC_DIST"
FABC_DIST=$(CDPATH='' cd -- "$FABC_DIST" && pwd)
FABC_VERSION=$(sed -n '/^\[workspace.package\]/,/^$/s/^version = "\(.*\)"/\1/p' Cargo.toml)
# Archives carry the time of the commit, so equal sources give equal archives.
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || date +%s)}
# Panics and assertions name source files; the folders of this machine are no part of that.
RUSTFLAGS="${RUSTFLAGS:-} --remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}=cargo --remap-path-prefix=$root=fabc"
export FABC_DIST FABC_VERSION SOURCE_DATE_EPOCH RUSTFLAGS

# Files that several artefacts carry.
share=$FABC_DIST/build/share
rm -rf "$share"
mkdir -p "$share/tasks" "$share/licences"
# Snapshots test the tasks; who runs a task needs none.
tar -C tasks --exclude snapshots --exclude '*.snap*' --exclude runs -cf - . | tar -C "$share/tasks" -xf -
cp LICENSE-MIT LICENSE-APACHE "$share/licences/"
python3 scripts/dist/licences.py >"$share/licences/rust-crates.txt"
standard_library=$(rustc --print sysroot)/share/doc/rust/COPYRIGHT-library.html
if [ -e "$standard_library" ]; then
    cp "$standard_library" "$share/licences/rust-standard-library.html"
else
    echo "left out: the licences of Rust's standard library, which this toolchain does not carry" >&2
fi
chmod -R u=rwX,go=rX "$share"

[ $# -gt 0 ] || set -- deb wheel static
for part; do
    echo "+ scripts/dist/$part.sh"
    begun=$(date +%s)
    sh "$here/dist/$part.sh"
    echo "  built in $(($(date +%s) - begun)) s"
done
echo
(cd "$FABC_DIST" && find . -maxdepth 1 -type f -printf '%f  %s bytes\n' | sort)
