#!/bin/sh
# Fails if a package's tests build a third-party crate with other features than `cargo build` does, and names both.
#
# Cargo joins the features that the selected packages ask for. A crate whose features differ is built again whenever
# somebody goes from one package to another, with everything that uses it. tests/features/Cargo.toml asks for all
# features at once.
#
# A crate may have two sets of features in one build: one for linking, one for derives and build scripts. A package's
# tests may use either set of `cargo build`, because Cargo.toml builds both parts alike.
#
# A build with ROS adds crates, and must build no other one anew.
set -eu

# Prints "COMMAND|CRATE FEATURES" for each third-party crate: crates COMMAND EDGES [ARGUMENT...]
crates() {
    command=$1
    edges=$2
    shift 2
    tree=$(cargo tree --locked --quiet --prefix none --edges "$edges" --format '{p} {f}' "$@")
    printf '%s\n' "$tree" | grep -v ' (/' | sed -e 's/ (proc-macro)//' -e 's/ (\*)$//' -e "s/^/$command|/" | sort -u
}

every_command() {
    crates "cargo build" normal,build
    for member in $members; do
        crates "cargo test -p $member" normal,build,dev --package "$member"
    done
    crates "cargo test -p fabc --features ros" normal,build,dev --package fabc --features fabc/ros
    crates "cargo test -p fabc --features ros2" normal,build,dev --package fabc --features fabc/ros2
}

members=$(cargo tree --locked --quiet --workspace --depth 0 --prefix none --format '{p}')
members=$(printf '%s\n' "$members" | sed -n -e '/^fab-features /d' -e 's/ v.*//p')
lines=$(every_command)

# The first command that builds a crate determines its features.
if ! printf '%s\n' "$lines" | awk -F '|' '
    {
        split($2, word, " ")
        crate = word[1] " " word[2]
        form = "\n    " $1 ": " word[3]
        if (!(crate in first)) first[crate] = $1
        if (first[crate] == $1) {
            known[crate, word[3]]
            forms[crate] = forms[crate] form
        } else if (!((crate, word[3]) in known)) {
            print crate forms[crate] form
            known[crate, word[3]] # report it once
            failed = 1
        }
    }
    END { exit failed }
'; then
    echo "features differ: ask for all of them in tests/features/Cargo.toml" >&2
    exit 1
fi
