#!/bin/sh
# Builds the Debian 12 package; scripts/dist.sh calls it and sets its variables.
#
# The package holds the command, its manual pages and completions, and the shipped tasks under /usr/share/fabc. It
# depends on the C library alone, of the version that is here or newer.
# DEBFULLNAME and DEBEMAIL name the maintainer.
set -eu

for tool in dpkg-deb dpkg-shlibdeps; do
    if ! command -v $tool >/dev/null; then
        echo "$tool is missing (Debian: apt-get install dpkg-dev)" >&2
        exit 2
    fi
done

triple=x86_64-unknown-linux-gnu
cargo build --profile dist --locked --package fabc --bin fabc --features tags --target $triple --target-dir "$FABC_DIST/build"

stage=$FABC_DIST/build/deb
share=$FABC_DIST/build/share
package=$stage/root
documentation=$package/usr/share/doc/fabc
rm -rf "$stage"
umask 022
mkdir -p "$package/DEBIAN" "$package/usr/bin" "$package/usr/share/fabc" "$documentation" "$stage/debian"

fabc=$package/usr/bin/fabc
cp "$FABC_DIST/build/$triple/dist/fabc" "$fabc"
cp -r "$share/tasks" "$package/usr/share/fabc/tasks"

bash=$package/usr/share/bash-completion/completions
zsh=$package/usr/share/zsh/vendor-completions
fish=$package/usr/share/fish/vendor_completions.d
mkdir -p "$bash" "$zsh" "$fish"
"$fabc" completions bash >"$bash/fabc"
"$fabc" completions zsh >"$zsh/_fabc"
"$fabc" completions fish >"$fish/fabc.fish"

mkdir -p "$package/usr/share/man/man1"
"$fabc" manual "$package/usr/share/man/man1"
gzip -9n "$package"/usr/share/man/man1/*.1

# Debian has the text of Apache-2.0 in /usr/share/common-licenses.
cat >"$documentation/copyright" <<COPYRIGHT
Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: fabc
Comment: The crates compiled into the command have licences of their own, listed with
 their texts in rust-crates.txt.gz. Those of Rust's standard library are in
 rust-standard-library.html.gz.

Files: *
Copyright: the fabc authors
License: MIT or Apache-2.0

License: MIT
$(sed -e 's/^$/./' -e 's/^/ /' LICENSE-MIT)

License: Apache-2.0
 On Debian systems, the text of this licence is in
 /usr/share/common-licenses/Apache-2.0.
COPYRIGHT
gzip -9nc CHANGELOG.md >"$documentation/changelog.gz"
for file in "$share"/licences/rust-*; do
    gzip -9nc "$file" >"$documentation/${file##*/}.gz"
done

# dpkg-shlibdeps reads debian/control of the folder it runs in.
printf 'Source: fabc\n\nPackage: fabc\nArchitecture: amd64\n' >"$stage/debian/control"
(cd "$stage" && dpkg-shlibdeps -O --warnings=0 -e"$fabc" >shlibs)
libraries=$(sed -n 's/^shlibs:Depends=//p' "$stage/shlibs")
cat >"$package/DEBIAN/control" <<CONTROL
Package: fabc
Version: $FABC_VERSION-1
Architecture: amd64
Maintainer: ${DEBFULLNAME:-The fabc authors} <${DEBEMAIL:-fabc@localhost.invalid}>
Installed-Size: $(du -k -s --apparent-size "$package/usr" | cut -f1)
Depends: $libraries
Recommends: ca-certificates
Section: science
Priority: optional
Description: language and compiler for cloth-folding prompts
 A cloth-folding task is declared in a .fab file. fabc compiles the prompts for a
 vision-language model from it, checks the model's answers, and executes them on a
 simulated cloth. A built-in stand-in answers without a model, key or network.
 .
 The shipped tasks and their pictures are in /usr/share/fabc/tasks.
CONTROL
(cd "$package" && find usr -type f -print0 | sort -z | xargs -0 md5sum >DEBIAN/md5sums)

rm -f "$FABC_DIST"/fabc_*_amd64.deb
dpkg-deb --root-owner-group -Zxz --build "$package" "$FABC_DIST/fabc_$FABC_VERSION-1_amd64.deb" >/dev/null
rm -rf "$stage"
