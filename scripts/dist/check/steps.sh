# Functions of the checks; check.sh and the scripts in the clean roots read this file. `results` names their file.
# shellcheck shell=sh disable=SC2154

# Runs a command and records whether it succeeded; prints its output only if it failed: step NAME COMMAND...
step() {
    what=$1
    shift
    if "$@" >"$results.step" 2>&1; then
        echo "passed: $what"
        echo "passed $what" >>"$results"
    else
        echo "FAILED: $what ($*)"
        tail -n 40 "$results.step" | sed 's/^/    /'
        echo "failed $what" >>"$results"
    fi
}

# Records a step that cannot run here: skip NAME REASON
skip() {
    echo "skipped: $1: $2"
    echo "skipped $1" >>"$results"
}

# Runs a command as a user without a name, who can write to his home and to nothing else: as_user COMMAND...
as_user() {
    setpriv --reuid=1000 --regid=1000 --clear-groups --no-new-privs \
        env HOME=/srv/tester sh -c 'cd && exec "$@"' sh "$@"
}

make_user_home() {
    mkdir -p /srv/tester
    chown 1000:1000 /srv/tester
}

# Runs fabc on a shipped task and looks at what it wrote: folds FABC TASK
folds() {
    as_user "$1" run "$2" >/tmp/check/run.log 2>&1 || {
        cat /tmp/check/run.log
        return 1
    }
    cat /tmp/check/run.log
    grep -q '^outcome: goal_reached' /tmp/check/run.log || return
    [ -s /srv/tester/runs/double_straight-0001/sheet.png ] || return
    rm -r /srv/tester/runs
}

# Succeeds if two listings are equal, and prints what differs: same BEFORE AFTER
same() {
    diff "$1" "$2"
}
