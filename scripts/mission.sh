#!/bin/sh
# Tests what this project promises, a line per point, and ends with: N passed, N failed, N skipped.
#
# mission.sh       `make test-long` begins with it; alone: sh scripts/with-env.sh sh scripts/mission.sh
#
# It is never red: a change that breaks a point is not merged, and a check is weakened only if its promise is given up.
# `make run` comes first and builds the fabc of the later points. A point that fails prints its commands and their output.
set -u
cd "$(dirname "$0")/.." || exit
target=${CARGO_TARGET_DIR:-target}
mkdir -p "$target" || exit
fabc=$(CDPATH='' cd -- "$target" && pwd)/debug/fabc
work=$(mktemp -d) || exit
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
# As for a newcomer, no expert result is cached.
FABC_CACHE_DIR=$work/cache
export FABC_CACHE_DIR

# Succeeds if a command exits with this code: exits_with CODE COMMAND...
exits_with() {
    expected=$1
    shift
    code=0
    "$@" || code=$?
    [ "$code" -eq "$expected" ]
}

# The README has two commands: `make run`, which folds a cloth, and `make test`, which CI runs before this script.
the_two_commands() {
    make run ARGS="--out $work/run"
    [ -s "$work/run/rollout.jsonl" ]
    [ -s "$work/run/sheet.png" ]
    # shellcheck disable=SC2016  # a fence of Markdown, no command
    sed -n '/^## Start$/,/^## /{/^```sh$/,/^```$/s/ *#.*//p;}' README.md >"$work/commands"
    printf '%s\n' 'make run' 'make test' | diff - "$work/commands"
    make -n test | grep -x '.*sh scripts/with-env.sh sh scripts/test.sh'
    grep -x 'parts=(.* test test-long)' .ci/run
    make -n run | grep -F 'sh scripts/run.sh tasks/double_straight.fab'
}

# A simulated Kinova Jaco: the plan moves nothing, the fold makes the planned motions and reaches its goal.
jaco_from_plan_to_fold() {
    set -- run tasks/real/double_triangle.fab --world jaco --robot tasks/real/simulated.toml
    "$fabc" "$@" --plan-only --out "$work/plan" >"$work/planned"
    grep -x 'outcome: planned; nothing moved' "$work/planned"
    [ -s "$work/plan/plan.png" ]
    [ ! -e "$work/plan/arm.jsonl" ]
    "$fabc" "$@" --out "$work/fold" >"$work/folded"
    grep -x 'outcome: goal_reached' "$work/folded"
    sed -n '/"after_missed_grasp"/q;s/^ *"name": "\(.*\)",$/\1/p' "$work/plan/plan.json" >"$work/planned_motions"
    sed -n 's/.*"type":"begin","action":1,"segment":"\([a-z_]*\)".*/\1/p' "$work/fold/arm.jsonl" >"$work/motions"
    grep -x grasp "$work/motions"
    diff "$work/planned_motions" "$work/motions"
}

# Prints points as Rust writes them, in brackets: in_rust POINTS
in_rust() {
    printf '%s' "$1" | tr '()' '[]'
}

# A fold between two corners, one that moves nothing and one to a point that was not offered: fabc and both emitted
# verifiers accept the first, and refuse the others for the same reason.
emitted_verifiers() {
    task=tasks/double_straight.fab
    "$fabc" render "$task" >"$work/prompts"
    corners=$(sed -n 's/^- Cloth corners: //p' "$work/prompts")
    center=$(sed -n 's/^- Cloth center: //p' "$work/prompts")
    others=${corners#*), }
    pick=${corners%%)*}\) place=${others%%)*}\)
    # shellcheck disable=SC2016  # quotes of a message, no command
    for at in "$place" "$pick" "(1, 1)"; do
        "$fabc" render "$task" --reply "Instructions: fold." --reply "Pick Point = $pick
Place Point = $at" 2>&1 >"$work/answered" | sed -n 's/^`plan`, answer 1: //p' | tr -d '`' >>"$work/verdicts"
    done
    printf '%s\n' accepted 'refused by moves' 'refused by offered' | diff - "$work/verdicts"

    "$fabc" build "$task" --emit rust,python -o "$work/built"
    built=$work/built/double_straight
    cat >"$built/main.py" <<PYTHON
from verifier import Action, verify
class Scene:
    def points(self, keypoint): return {"corners": [$corners], "center": [$center]}.get(keypoint)
    def distance_px(self, region, point): return 0.0
    def area_px(self, mask): return None
for place in [$place, $pick, (1, 1)]:
    refusal = verify(Scene(), 1, None, Action(pick=$pick, place=place))
    print(f"refused by {refusal}" if refusal else "accepted")
PYTHON
    python3 -B "$built/main.py" >"$work/in_python"
    diff "$work/verdicts" "$work/in_python"
    cat >"$built/main.rs" <<RUST
mod verifier;
use verifier::{Action, Refusal, verify};
struct Scene;
impl verifier::Scene for Scene {
    fn points(&self, keypoint: &str) -> Option<&[[i32; 2]]> {
        match keypoint {
            "corners" => Some(&[$(in_rust "$corners")]),
            "center" => Some(&[$(in_rust "$center")]),
            _ => None,
        }
    }
    fn distance_px(&self, _region: &str, _point: [i32; 2]) -> Option<f64> { Some(0.0) }
    fn area_px(&self, _mask: &str) -> Option<f64> { None }
}
fn main() {
    for place in [$(in_rust "$place, $pick"), [1, 1]] {
        match verify(&Scene, 1, None, &Action { pick: $(in_rust "$pick"), place }) {
            Err(Refusal::Check(name)) => println!("refused by {name}"),
            other => println!("{}", if other.is_ok() { "accepted" } else { "a keypoint is missing" }),
        }
    }
}
RUST
    "${RUSTC:-rustc}" --edition 2021 -o "$built/main" "$built/main.rs"
    "$built/main" >"$work/in_rust"
    diff "$work/verdicts" "$work/in_rust"
}

# One line of a shared component changes: the check fails, the review names the edit, and once it is accepted the check
# passes and the prompt has the new line.
a_prompt_changed_reviewed_accepted() {
    mkdir -p "$work/tasks/snapshots" "$work/tasks/demos"
    cp -R tasks/lib tasks/double_straight.fab tasks/double_straight.subgoals "$work/tasks"
    cp tasks/demos/double_straight.jsonl "$work/tasks/demos"
    cp tasks/snapshots/double_straight* "$work/tasks/snapshots"
    cd "$work/tasks"
    "$fabc" snap double_straight.fab --check
    sed 's/Answer in two lines:/Reply in two lines:/' lib/folding.fab >"$work/edited"
    mv "$work/edited" lib/folding.fab
    exits_with 1 "$fabc" snap double_straight.fab --check
    "$fabc" snap double_straight.fab
    "$fabc" review --json >"$work/review"
    for shown in '"component": "output_format"' '"Answer in two lines:"' '"Reply in two lines:"'; do
        grep -F "$shown" "$work/review"
    done
    exits_with 1 "$fabc" snap double_straight.fab --check
    "$fabc" review --accept-all
    "$fabc" snap double_straight.fab --check
    grep -x 'Reply in two lines:' snapshots/double_straight.describe@start.snap
    "$fabc" render double_straight.fab --stage describe >"$work/changed"
    grep -x 'Reply in two lines:' "$work/changed"
}

# Our packages name these crates themselves. OpenCV is there with its feature.
the_crates() {
    cargo tree --locked --workspace --features fabc/opencv --depth 1 --no-dedupe --prefix none >"$work/tree"
    for crate in pest serde minijinja nalgebra reqwest opencv insta clap; do
        grep "^$crate v" "$work/tree"
    done
}

the_folders() {
    for file in grammar/src/lib.rs compiler/src/lib.rs runtime/*/src/lib.rs sim/src/lib.rs tasks/*.fab tests/main.rs; do
        [ -s "$file" ]
    done
}

passed=0
failed=0
# Runs a check, prints the line of its point, and counts it: point CHECK WORDS
point() {
    # `set -e` would mean nothing in a condition.
    (
        set -ex
        "$1"
    ) >"$work/log" 2>&1 </dev/null
    code=$?
    if [ "$code" -eq 0 ]; then
        passed=$((passed + 1))
        echo "mission: ok      $2"
    else
        failed=$((failed + 1))
        cat "$work/log"
        echo "mission: FAILED  $2"
    fi
}

point the_two_commands "the README's two commands: make run, make test"
point jaco_from_plan_to_fold "a simulated Jaco, from plan to fold"
point emitted_verifiers "verifiers in Rust and Python: emitted, compiled, run, and of one mind with fabc"
point a_prompt_changed_reviewed_accepted "a prompt changed, reviewed, accepted"
point the_crates "pest, serde, minijinja, nalgebra, reqwest, opencv (feature), insta and clap in the tree"
point the_folders "the folders grammar, compiler, runtime, tasks, sim and tests"
echo "$passed passed, $failed failed, 0 skipped"
[ "$failed" -eq 0 ]
