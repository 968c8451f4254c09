#!/bin/sh
# Installs what `make dist` built into clean roots, runs it, and removes it: check.sh [deb] [wheel] [static]
#
# Without arguments it tests all three, and ends with: N passed, N failed, N skipped. A root of Debian 12 is made by
# mmdebstrap from packages of its mirror, which takes a minute, and is deleted with everything in it. Needs root, or user
# namespaces (Debian: apt-get install mmdebstrap uidmap). Exit code 1 if a step failed.
set -u
here=$(CDPATH='' cd -- "$(dirname "$0")" && pwd)
cd "$here/../.." || exit
dist=$(CDPATH='' cd -- "${CARGO_TARGET_DIR:-target}/dist" && pwd) || exit

work=$(mktemp -d) || exit
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
# In a user namespace, root of the new root is another user outside.
chmod 755 "$work"
# shellcheck source=scripts/dist/check/steps.sh
. "$here/check/steps.sh"
results=$work/results
: >"$results"

# Succeeds if a file has at most that many bytes: at_most BYTES FILE
at_most() {
    size=$(stat -c %s "$2") || return
    echo "$size bytes of at most $1"
    [ "$size" -le "$1" ]
}

# Runs check/NAME.sh in a new root of Debian 12: in_clean_root NAME ARTEFACT MMDEBSTRAP_ARGUMENT...
in_clean_root() {
    name=$1
    artefact=$2
    shift 2
    if ! command -v mmdebstrap >/dev/null; then
        skip "$name in a clean root" "mmdebstrap is missing (Debian: apt-get install mmdebstrap)"
        return
    fi
    mkdir "$work/$name"
    cp "$artefact" "$here/check/$name.sh" "$here/check/steps.sh" "$work/$name/"
    # The format `null` makes no archive: the hooks are the test, and the root is deleted after them.
    # shellcheck disable=SC2016  # mmdebstrap's shell expands "$1", the root
    mmdebstrap --quiet --format=null "$@" \
        --customize-hook='mkdir "$1/tmp/check"' \
        --customize-hook="sync-in '$work/$name' /tmp/check" \
        --customize-hook='chroot "$1" sh /tmp/check/'"$name.sh" \
        --customize-hook="download /tmp/check/results '$work/$name.results'" \
        bookworm - "${FABC_DEBIAN_MIRROR:-http://deb.debian.org/debian}" >"$work/$name.log" 2>&1
    cat "$work/$name.log"
    if [ -s "$work/$name.results" ]; then
        cat "$work/$name.results" >>"$results"
    else
        step "$name in a clean root" false
    fi
}

check_deb() {
    step "the package is whole" dpkg-deb --contents "$dist"/fabc_*_amd64.deb
    in_clean_root deb "$dist"/fabc_*_amd64.deb --variant=apt
}

check_wheel() {
    step "the wheel has at most 20 MB" at_most 20000000 "$dist"/fabc-*.whl
    in_clean_root wheel "$dist"/fabc-*.whl --variant=essential --include=python3-venv
}

# Runs the authoring tool in a root that holds only it and the tasks: in_empty_root ARGUMENT...
in_empty_root() {
    if [ "$(id -u)" = 0 ]; then
        chroot --userspec=65534:65534 "$work/empty" /fabc "$@"
    else
        unshare --map-root-user chroot "$work/empty" /fabc "$@"
    fi
}

prints_prompts() {
    in_empty_root render /tasks/double_straight.fab >"$work/prompts" && grep -q 'fold' "$work/prompts"
}

check_static() {
    mkdir "$work/empty"
    cp "$dist"/fabc-authoring-*-x86_64-linux "$work/empty/fabc"
    cp -r "$dist/build/share/tasks" "$work/empty/tasks"
    step "the authoring tool has at most 8 MB" at_most 8000000 "$work/empty/fabc"
    step "fabc check in an empty root" in_empty_root check /tasks/double_straight.fab
    step "fabc render in an empty root" prints_prompts
    step "fabc test in an empty root" in_empty_root test /tasks/double_straight.fab
}

[ $# -gt 0 ] || set -- deb wheel static
for artefact; do
    echo "== $artefact"
    "check_$artefact"
done

echo
count() { grep -c "^$1 " "$results"; }
echo "$(count passed) passed, $(count failed) failed, $(count skipped) skipped"
[ "$(count failed)" -eq 0 ]
