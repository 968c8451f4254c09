#!/bin/sh
# Runs the tests that `make test` leaves out, and ends with: N passed, N failed, N skipped. With --with-fast it runs
# those of `make test` first, and counts them too.
#
# It begins with mission.sh, a test of each promise of this project, while the only fabc is that of `make run`. Then it
# tests the feature `opencv`: the tests of fab-vision, also those that compare OpenCV with our own detectors, and a fold.
# All others test what is shipped, which has `tags` and not `opencv`.
#
# Tests that take long are `#[ignore = "long"]`; those that compare with a program by others are `#[ignore = "needs ..."]`
# and named peer_. The peers are in a Python environment under the target folder (peers-requirements.txt); tests find it
# through FABC_PEER_PYTHON. Without Python no peer_ test runs but those over ROS, and the run fails. cargo-insta, which
# reads and writes the same snapshots, is installed beside it; tests find it through FABC_PEER_CARGO_INSTA. book.sh
# installs mdBook, which builds the book.
#
# If WebAssembly cannot be built or run (wasm-parts.sh), or cargo-insta, mdBook or the descriptions of arms cannot be
# fetched, only the peer_node_, peer_cargo_insta_, peer_mdbook_ or peer_robots_ tests are left out. They count as
# skipped, and the reason is printed. The same holds for ROS 1 (ros-parts.sh). ROS 2 needs no more than the Python
# environment. The tests of both work in real time and leave a core free, so all others run beside them at the lowest
# priority.
set -u
here=$(dirname "$0")

target=${CARGO_TARGET_DIR:-target}
mkdir -p "$target" || exit
environment=$(CDPATH='' cd -- "$target" && pwd)/peers
requirements=$here/peers-requirements.txt
missing=

# Descriptions of robots by other makers: every URDF, and of the 430 MB of meshes those of two arms. BSD-3-Clause.
robots=example-robot-data==6.0.0
robots_folder=$environment/robots

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
    # Compiling every module to bytecode would take most of the time, and few of them are used.
    if ! "$environment/bin/python" -m pip install --quiet --disable-pip-version-check --no-compile \
        --only-binary :all: -r "$requirements"; then
        missing="pip could not install $requirements"
        return
    fi
    cp "$requirements" "$environment/installed.txt"
}

# Fetches the descriptions of arms, or says on stdout why it cannot.
fetch_robots() {
    if [ "$(cat "$robots_folder/fetched.txt" 2>/dev/null)" = "$robots, every URDF" ]; then return; fi
    rm -rf "$robots_folder"
    "$environment/bin/python" -m pip download --quiet --disable-pip-version-check --no-deps --only-binary :all: \
        --dest "$work/robots" "$robots" >&2 && "$environment/bin/python" - "$work/robots" "$robots_folder" <<'PYTHON' || {
import pathlib, sys, zipfile

source, target = map(pathlib.Path, sys.argv[1:])
(wheel,) = source.glob("*.whl")
share = "cmeel.prefix/share/"
with zipfile.ZipFile(wheel) as archive:
    for name in archive.namelist():
        is_whole = "/ur_description/" in name or "/panda_description/" in name
        if name.startswith(share) and (name.endswith(".urdf") or is_whole and "/visual/" not in name):
            path = target / name.removeprefix(share)
            path.parent.mkdir(parents=True, exist_ok=True)
            if not name.endswith("/"):
                path.write_bytes(archive.read(name))
PYTHON
        echo "pip could not download $robots"
        return
    }
    echo "$robots, every URDF" >"$robots_folder/fetched.txt"
}

work=$(mktemp -d) || exit
trap 'rm -rf "$work"' EXIT
# Background jobs ignore Ctrl-C.
trap 'trap "" TERM; kill 0; exit 130' INT
trap 'exit 143' TERM

# Runs a script that ends with its sums, such as test.sh, and keeps them: run WORDS SCRIPT ARGUMENT...
run() {
    words=$1 script=$2
    shift 2
    log=$(mktemp "$work/XXXXXX") || exit
    sh "$here/$script" "$@" | tee "$log" | sed "s/^[0-9]* passed, .* skipped\$/$words: &/"
    tail -n 1 "$log" | grep -E '^[0-9]+ passed, [0-9]+ failed, [0-9]+ skipped$' >>"$work/sums" || {
        echo "$words: the run ended without its sums"
        echo "0 passed, 1 failed, 0 skipped" >>"$work/sums"
    }
}

# Counts the tests that are left out: leave_out NAME_PART REASON
leave_out() {
    count=$(git grep -h "fn $1" -- '*.rs' | grep -c .)
    echo "left out: $count $1 tests: $2"
    echo "0 passed, 0 failed, $count skipped" >>"$work/sums"
    skipped="$skipped --skip $1"
}

# The ROS tests have a run of their own.
skipped="--skip peer_ros_ --skip peer_ros2_"
[ "${1:-}" != --with-fast ] || run "the fast tests" test.sh
run "the mission" mission.sh
# With fabc, fab-vision alone would build serde and much else in another form. The command's own tests are run elsewhere.
with_opencv="--package fabc --package fab-vision --features fabc/opencv,fabc/tags --locked"
# shellcheck disable=SC2086  # words without spaces
run "fab-vision with OpenCV" test.sh $with_opencv --lib -- --include-ignored --skip snapshots:: --skip verbs::
# shellcheck disable=SC2086  # words without spaces
run "peers with OpenCV" test.sh $with_opencv --test suite -- --include-ignored suite::peer_opencv::
# No other test is running yet that uses this fabc.
if FABC_FEATURES=opencv,tags sh "$here/run.sh" tasks/double_straight.fab --out "$work/fold"; then
    fold="1 passed, 0 failed"
else
    fold="0 passed, 1 failed"
fi
echo "a fold with OpenCV: $fold, 0 skipped"
echo "$fold, 0 skipped" >>"$work/sums"

prepare
if [ -n "$missing" ]; then
    echo "the peer_ tests cannot run: $missing" >&2
    echo "0 passed, 1 failed, 0 skipped" >>"$work/sums"
    skipped="$skipped --skip peer_"
fi
without_robots=
[ -n "$missing" ] || without_robots=$(fetch_robots)
FABC_PEER_PYTHON=$environment/bin/python
export FABC_PEER_PYTHON

over_ros() {
    # shellcheck disable=SC2086  # words without spaces
    run "over ROS" test.sh $ros --package fabc $ros_features --locked --no-fail-fast --lib $ros_tests -- --include-ignored \
        --skip snapshots:: --skip verbs:: $without_python
}
without_ros=$(sh "$here/ros-parts.sh")
without_python=
[ -z "$missing" ] || without_python="--skip peer_ros2_"
# ROS 2 itself, as wheels; they exist for some versions of Python only.
rclpy=$(CDPATH='' cd -- "$target" && pwd)/peers-rclpy
if [ -z "$missing" ] && ! cmp -s "$here/rclpy-requirements.txt" "$rclpy/installed.txt"; then
    python3 -m venv --clear "$rclpy" && "$rclpy/bin/python" -m pip install --quiet --disable-pip-version-check --no-compile \
        --only-binary :all: --no-binary empy -r "$here/rclpy-requirements.txt" && cp "$here/rclpy-requirements.txt" "$rclpy/installed.txt"
fi
FABC_PEER_RCLPY=$rclpy/bin/python
export FABC_PEER_RCLPY
if [ -z "$missing" ] && [ ! -e "$rclpy/installed.txt" ]; then
    leave_out peer_ros2_a_distribution "pip could not install $here/rclpy-requirements.txt"
    without_python="--skip peer_ros2_a_distribution"
fi
if [ -z "$without_ros" ]; then
    selected="--workspace --features fabc/tags,fabc/ros,fabc/ros2"
    ros="--package fab-arm-ros --package fab-arm-ros2"
    ros_features="--features fabc/tags,fabc/ros,fabc/ros2"
    ros_tests="--test ros --test ros2"
else
    selected="--workspace --exclude fab-arm-ros --features fabc/tags,fabc/ros2"
    ros="--package fab-arm-ros2"
    ros_features="--features fabc/tags,fabc/ros2"
    ros_tests="--test ros2"
    leave_out peer_ros_ "$without_ros"
fi
# All tests here use one fabc, so that none replaces the one that others are running.
# shellcheck disable=SC2086  # words without spaces
cargo build --locked $selected --lib --bins --tests --example arm_engine || exit
FABC_PEER_ARM_ENGINE=$(cd "$target" && pwd)/debug/examples/arm_engine
export FABC_PEER_ARM_ENGINE
# Nodes must find each other on this machine whatever its name; ROS_HOSTNAME would override ROS_IP.
unset ROS_HOSTNAME
ROS_IP=127.0.0.1
export ROS_IP
over_ros >"$work/ros" 2>&1 &
beside=$!
renice -n 19 $$ >/dev/null

without_wasm=$(sh "$here/wasm-parts.sh")

# The version of insta in Cargo.lock; the tests compare with its files.
insta_version=$(sed -n '/^name = "insta"$/{n;s/^version = "\(.*\)"$/\1/p;}' Cargo.lock)
insta_root=$(CDPATH='' cd -- "$target" && pwd)/peers-cargo
FABC_PEER_CARGO_INSTA=$insta_root/bin/cargo-insta
export FABC_PEER_CARGO_INSTA
without_insta=
if [ "$("$FABC_PEER_CARGO_INSTA" --version 2>/dev/null)" != "cargo-insta $insta_version" ]; then
    echo "installing cargo-insta $insta_version, which takes some minutes" >&2
    # An unoptimised build takes half the time, and still reads a snapshot in no time.
    CARGO_PROFILE_DEV_DEBUG=false cargo install --locked --quiet --debug --root "$insta_root" --target-dir "$insta_root/build" \
        "cargo-insta@$insta_version" ||
        without_insta="cargo could not install cargo-insta $insta_version"
fi
without_mdbook=
# A book that cannot be built fails its test; only a missing mdBook leaves the test out.
sh "$here/book.sh" >/dev/null || [ -x "$insta_root/bin/mdbook" ] || without_mdbook="cargo could not install mdBook"

FABC_PEER_ROBOTS=$robots_folder
export FABC_PEER_ROBOTS
[ -z "$without_robots" ] || leave_out peer_robots_ "$without_robots"
[ -z "$without_wasm" ] || leave_out peer_node_ "$without_wasm"
[ -z "$without_insta" ] || leave_out peer_cargo_insta_ "$without_insta"
[ -z "$without_mdbook" ] || leave_out peer_mdbook_ "$without_mdbook"

# shellcheck disable=SC2086  # words without spaces
run "with documentation" test.sh $selected --locked --doc
# shellcheck disable=SC2086  # words without spaces
run "long and peers" test.sh $selected --locked --no-fail-fast --lib --bins --tests -- --ignored $skipped
wait "$beside"
cat "$work/ros"

awk '{ passed += $1; failed += $3; skipped += $5 }
    END { printf "%d passed, %d failed, %d skipped\n", passed, failed, skipped; exit failed > 0 }' "$work/sums"
