#!/bin/sh
# Runs the tests that `make test` leaves out, and ends with: N passed, N failed, N skipped.
#
# By convention these tests are #[ignore]d and named after the reason: peer_ compares with
# a program by others, long_ takes long. The peers live in a Python environment under the
# target folder (peers-requirements.txt); tests find it through FABC_PEER_PYTHON. Without
# Python the peer_ tests are left out, counted as skipped, and the reason is printed.
set -u
here=$(dirname "$0")

target=${CARGO_TARGET_DIR:-target}
mkdir -p "$target" || exit
environment=$(CDPATH='' cd -- "$target" && pwd)/peers
requirements=$here/peers-requirements.txt
missing=

# Builds the environment, or says in `missing` why there is none.
prepare() {
    if cmp -s "$requirements" "$environment/installed.txt"; then return; fi
    if ! command -v python3 >/dev/null; then
        missing="python3 is missing (Debian: apt-get install python3 python3-venv)"
        return
    fi
    if ! python3 -m venv --clear "$environment"; then
        missing="python3 has no working venv (Debian: apt-get install python3-venv)"
        return
    fi
    if ! "$environment/bin/python" -m pip install --quiet --disable-pip-version-check \
        --only-binary :all: -r "$requirements"; then
        missing="pip could not install $requirements"
        return
    fi
    cp "$requirements" "$environment/installed.txt"
}

prepare
# Doctests and examples cannot carry the names, so only these kinds of target are built.
set -- --workspace --locked --no-fail-fast --lib --bins --tests
if [ -z "$missing" ]; then
    FABC_PEER_PYTHON=$environment/bin/python
    export FABC_PEER_PYTHON
    exec sh "$here/test.sh" "$@" -- --ignored peer_ long_
fi

list=$(cargo test "$@" -- --ignored --list peer_) || exit
FABC_LEFT_OUT=$(printf '%s\n' "$list" | grep -c ': test$')
export FABC_LEFT_OUT
echo "left out: $FABC_LEFT_OUT peer_ tests: $missing"
exec sh "$here/test.sh" "$@" -- --ignored --skip peer_ long_
