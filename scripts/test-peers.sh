#!/bin/sh
# Runs the tests that `make test` leaves out, and ends with: N passed, N failed, N skipped.
#
# By convention these tests are #[ignore]d and named after the reason: peer_ compares with a program by others, long_
# takes long. The peers are in a Python environment under the target folder (peers-requirements.txt); tests find it
# through FABC_PEER_PYTHON. Without Python this script runs nothing, prints what is missing, and fails. cargo-insta,
# which reads and writes the same snapshots, is installed beside it; tests find it through FABC_PEER_CARGO_INSTA.
# book.sh installs mdBook, which builds the book.
#
# If WebAssembly cannot be built or run (wasm-parts.sh), or cargo-insta or mdBook cannot be installed, only the
# peer_node_, peer_cargo_insta_ or peer_mdbook_ tests are left out. They count as skipped, and the reason is printed.
# The same holds for ROS (ros-parts.sh). Its tests are a separate run, because they need another build of fabc.
set -u
here=$(dirname "$0")

target=${CARGO_TARGET_DIR:-target}
mkdir -p "$target" || exit
environment=$(CDPATH='' cd -- "$target" && pwd)/peers
requirements=$here/peers-requirements.txt
missing=

# Builds the environment, or sets `missing` to the reason why it cannot.
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
if [ -n "$missing" ]; then
    echo "the peer_ tests cannot run: $missing" >&2
    echo "0 passed, 1 failed, 0 skipped"
    exit 1
fi
without_wasm=$(sh "$here/wasm-parts.sh")

# The version of insta in Cargo.lock; the tests compare with its files.
insta_version=$(sed -n '/^name = "insta"$/{n;s/^version = "\(.*\)"$/\1/p;}' Cargo.lock)
insta_root=$(CDPATH='' cd -- "$target" && pwd)/peers-cargo
FABC_PEER_CARGO_INSTA=$insta_root/bin/cargo-insta
export FABC_PEER_CARGO_INSTA
without_insta=
if [ "$("$FABC_PEER_CARGO_INSTA" --version 2>/dev/null)" != "cargo-insta $insta_version" ]; then
    echo "installing cargo-insta $insta_version, which takes some minutes" >&2
    cargo install --quiet --locked --root "$insta_root" cargo-insta --version "$insta_version" ||
        without_insta="cargo could not install cargo-insta $insta_version"
fi
without_mdbook=
# A book that cannot be built fails its test; only a missing mdBook leaves the test out.
sh "$here/book.sh" >/dev/null || [ -x "$insta_root/bin/mdbook" ] || without_mdbook="cargo could not install mdBook"
# Doctests and examples cannot have these names, so only these kinds of target are built.
set -- --workspace --locked --no-fail-fast --lib --bins --tests

# Counts the tests that are left out: leave_out CARGO_ARGUMENTS NAME_PART REASON
leave_out() {
    # shellcheck disable=SC2086  # words without spaces
    list=$(cargo test $1 -- --ignored --list "$2") || exit
    count=$(printf '%s\n' "$list" | grep -c ': test$')
    echo "left out: $count $2 tests: $3"
    FABC_LEFT_OUT=$((${FABC_LEFT_OUT:-0} + count))
    export FABC_LEFT_OUT
}

arguments="$*"
FABC_PEER_PYTHON=$environment/bin/python
export FABC_PEER_PYTHON
skipped=
if [ -n "$without_wasm" ]; then
    leave_out "$arguments" peer_node_ "$without_wasm"
    skipped="--skip peer_node_"
fi
if [ -n "$without_insta" ]; then
    leave_out "$arguments" peer_cargo_insta_ "$without_insta"
    skipped="$skipped --skip peer_cargo_insta_"
fi
if [ -n "$without_mdbook" ]; then
    leave_out "$arguments" peer_mdbook_ "$without_mdbook"
    skipped="$skipped --skip peer_mdbook_"
fi

# The ROS tests: those that need no other program, and the peer_ros_ tests. Their sums are added to the last line.
without_ros=$(sh "$here/ros-parts.sh")
if [ -z "$without_ros" ]; then
    cargo build --locked --package fab-arm --example arm_engine || exit
    log=$(mktemp) || exit
    # Nodes must find each other on this machine whatever its name; ROS_HOSTNAME would override ROS_IP.
    env -u ROS_HOSTNAME ROS_IP=127.0.0.1 FABC_PEER_ARM_ENGINE="$(dirname "$environment")/debug/examples/arm_engine" \
        sh "$here/test.sh" --package fabc --package fab-arm-ros --features fabc/ros --locked --no-fail-fast --lib --test ros \
        -- --include-ignored | tee "$log" | sed 's/^[0-9]* passed, .* skipped$/over ROS: &/'
    FABC_EARLIER=$(tail -n 1 "$log" | tr -dc '0-9 ')
    export FABC_EARLIER
    rm -f "$log"
else
    count=$(cat tests/ros/*.rs | grep -c '^fn peer_ros_')
    echo "left out: $count peer_ros_ tests: $without_ros"
    FABC_LEFT_OUT=$((${FABC_LEFT_OUT:-0} + count))
    export FABC_LEFT_OUT
fi
# shellcheck disable=SC2086  # words without blanks
exec sh "$here/test.sh" "$@" -- --ignored $skipped peer_ long_
