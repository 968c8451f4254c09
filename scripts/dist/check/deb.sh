#!/bin/sh
# Runs in a clean root, as its root user: installs the package, uses it as another user, and removes it.
set -u
cd /tmp/check || exit
results=/tmp/check/results
: >"$results"
# shellcheck source=scripts/dist/check/steps.sh
. ./steps.sh

# Lists every file with its size, except what any installation changes: caches, logs, and the package manager's lists.
list() {
    find / -xdev \( -path /proc -o -path /sys -o -path /dev -o -path /run -o -path /tmp -o -path /var/cache \
        -o -path /var/log -o -path /var/lib/apt -o -path '/var/lib/dpkg/*-old' -o -path /var/lib/dpkg/status \
        -o -path /etc/ld.so.cache \) -prune -o -type f -printf '%p %s\n' -o -type l -printf '%p -> %l\n' \
        -o -printf '%p\n' | sort
}

cannot_write_usr() {
    ! as_user touch /usr/share/fabc/tasks/mine
}

no_file_changed() {
    [ -z "$(find /usr -newer /tmp/check/installed -print -quit)" ]
}

nothing_named_fabc() {
    [ -z "$(find / -xdev -path /tmp -prune -o -path /proc -prune -o -name '*fabc*' -not -path '/var/log/*' -print | tee /dev/stderr)" ]
}

names_its_task() {
    as_user fabc check double_straight 2>&1 |
        grep -F "shipped with fabc (/usr/share/fabc/tasks/double_straight.fab)"
}

export DEBIAN_FRONTEND=noninteractive
list >before
make_user_home
step "apt-get installs the package with what it depends on" \
    apt-get install -y --no-install-recommends ./fabc_*_amd64.deb
touch installed
step "dpkg finds every installed file whole" dpkg --verify fabc
step "the user cannot write to /usr" cannot_write_usr
step "fabc run on a shipped task" folds fabc /usr/share/fabc/tasks/double_straight.fab
step "fabc run double_straight" folds fabc double_straight
step "the name means the installed task" names_its_task
step "fabc test on the shipped tasks" as_user sh -c 'fabc test /usr/share/fabc/tasks/*.fab'
step "fabc doctor" as_user fabc doctor
step "the manual pages are whole" gzip -t /usr/share/man/man1/fabc.1.gz /usr/share/man/man1/fabc-run.1.gz
step "bash reads the completions" bash -n /usr/share/bash-completion/completions/fabc
step "zsh's and fish's completions are there" \
    test -s /usr/share/zsh/vendor-completions/_fabc -a -s /usr/share/fish/vendor_completions.d/fabc.fish
step "using fabc changed nothing in /usr" no_file_changed
step "apt-get removes the package" apt-get purge -y fabc
rm -rf /srv/tester # his caches and run folders, which no package manager removes
step "no file named fabc is left" nothing_named_fabc
step "apt-get removes what the package depended on" apt-get autoremove --purge -y
list >after
step "every other file is as before" same before after
