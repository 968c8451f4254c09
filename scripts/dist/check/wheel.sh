#!/bin/sh
# Runs in a clean root that holds Python alone: installs the wheel into a virtual environment, uses it, and removes it.
set -u
cd /tmp/check || exit
results=/tmp/check/results
: >"$results"
# shellcheck source=scripts/dist/check/steps.sh
. ./steps.sh

environment=/srv/tester/environment

list() {
    find $environment -name __pycache__ -prune -o -print | sort
}

has_licences() {
    folder=$(echo $environment/lib/python3*/site-packages/fabc-*.dist-info/licenses)
    find "$folder" -type f
    for text in LICENSE-MIT LICENSE-APACHE rust-crates.txt; do
        find "$folder" -name "$text" -size +0 | grep -q . || return
    done
}

names_its_task() {
    as_user $environment/bin/fabc check double_straight 2>&1 |
        grep -F "double_straight, shipped with fabc ("
}

make_user_home
step "the user makes a virtual environment" as_user python3 -m venv $environment
list >before
step "pip installs the wheel without a network" as_user $environment/bin/pip install --no-index /tmp/check/fabc-*.whl
step "fabc run double_straight" folds $environment/bin/fabc double_straight
step "the name means the task in the program" names_its_task
step "fabc test on a shipped task" as_user $environment/bin/fabc test double_straight
step "the licences are in the wheel" has_licences
step "pip removes the wheel" as_user $environment/bin/pip uninstall -y fabc
list >after
step "the environment is as before" same before after
