#!/bin/sh
# Builds the authoring tool as one static binary; scripts/dist.sh calls it and sets its variables.
#
# It is `fabc` without simulator, vision and models, and runs on any Linux x86-64 without any file beside it. It is
# linked with musl if rustup has that target, otherwise with glibc.
set -eu

has_library() {
    folder=$(rustc --print target-libdir --target "$1" 2>/dev/null) || return 1
    [ -n "$(ls "$folder"/libstd-*.rlib 2>/dev/null)" ]
}

triple=x86_64-unknown-linux-gnu
# The grammar's stack guard has a page of assembler, for which `cc` wants a compiler of the target.
if has_library x86_64-unknown-linux-musl && command -v musl-gcc >/dev/null; then
    triple=x86_64-unknown-linux-musl
fi
RUSTFLAGS="$RUSTFLAGS -C target-feature=+crt-static"
export RUSTFLAGS
case $triple in
*-gnu) libc_licence=/usr/share/doc/libc6-dev/copyright ;;
*-musl) libc_licence=/usr/share/doc/musl-dev/copyright ;;
esac
if [ ! -e "$libc_licence" ]; then
    echo "the C library's licence is missing: $libc_licence (Debian's packages libc6-dev and musl-dev have it)" >&2
    exit 2
fi
# Optimised for size: it only compiles and renders.
cargo build --profile dist --config 'profile.dist.opt-level="s"' --config 'profile.dist.lto="fat"' \
    --config 'profile.dist.codegen-units=1' --locked --package fabc --bin fabc --no-default-features \
    --target $triple --target-dir "$FABC_DIST/build"
rm -f "$FABC_DIST"/fabc-authoring-*
cp "$FABC_DIST/build/$triple/dist/fabc" "$FABC_DIST/fabc-authoring-$FABC_VERSION-x86_64-linux"

# The texts that go with the binary. glibc's licence asks for them where it is linked statically.
share=$FABC_DIST/build/share/licences
licences=$FABC_DIST/fabc-authoring-$FABC_VERSION-x86_64-linux.licences.txt
cat "$share/LICENSE-MIT" "$share/LICENSE-APACHE" "$share/rust-crates.txt" "$libc_licence" >"$licences"
