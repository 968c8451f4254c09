//! The person beside the arm, in a terminal and by signals: asked before motion, obeyed during motion, told only what
//! is verified. The same holds if the program itself panics.

#![cfg(target_os = "linux")]

use super::pty::{Mode, Session};
use super::support::{Captured, Fabc, fabc, root, simulated_arm, task, world};
use fab_agent::examples::Examples;
use fab_agent::journal::RunFolder;
use fab_agent::outcome::Outcome;
use fab_agent::policy::Prompted;
use fab_agent::rollout;
use fab_agent::rollout::Job;
use fab_agent::subgoals::SubgoalSet;
use fab_arm::journal::{ARM_FILE, run_state};
use fab_arm::phase::Phase;
use fab_arm::supervisor::{MotionRequest, Supervisor};
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_model::Models;
use fab_model::calls::Budget;
use fab_standins::Geometric;
use fab_world::start::Start;
use fab_world::{World, WorldError};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// The normal mode of a terminal, without waiting for keys.
const USUAL: Mode = Mode {
    is_by_lines: true,
    is_echoed: true,
};

/// A fold by the simulated arm, recorded in the folder `run`.
fn fold(folder: &Path, more: &[&str]) -> Fabc {
    let project = |path: &str| root().join(path);
    let mut command = fabc(folder);
    command
        .arg("run")
        .arg(project("tasks/real/double_triangle.fab"))
        .args(["--world", "jaco", "--robot"])
        .arg(project("tasks/real/simulated.toml"))
        .args(["--out", "run"])
        .args(more);
    command
}

fn watched(folder: &Path, more: &[&str]) -> Session {
    Session::in_window(&fold(folder, more).process())
}

/// The report in the run folder, from the last line of the journal.
fn report(folder: &Path) -> Value {
    let text = fs::read_to_string(folder.join("run/rollout.jsonl")).unwrap();
    let end: Value = serde_json::from_str(text.lines().last().unwrap()).unwrap();
    assert_eq!(end["type"], "end", "{end}");
    end["report"].clone()
}

/// Returns how many lines of a kind the arm's journal has.
fn n_lines(folder: &Path, kind: &str) -> usize {
    let text = fs::read_to_string(folder.join("run").join(ARM_FILE)).unwrap_or_default();
    text.matches(&format!("\"type\":\"{kind}\"")).count()
}

/// Waits until the arm has begun its `n`th motion.
fn until_begun(folder: &Path, n: usize) {
    let begun = Instant::now();
    while n_lines(folder, "begin") < n {
        assert!(begun.elapsed() < super::pty::PATIENCE, "nothing moves");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
#[ignore = "long"]
fn each_pick_and_place_is_asked_for_and_a_no_ends_the_rollout() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = watched(folder.path(), &["--confirm", "each"]);
    // Confirmation applies only to the question that was asked, not in advance.
    session.send("y\ny\n");
    let shown = session.until("Move? y or n:");
    assert!(shown.contains("action 1: pick at "), "{shown}");
    assert!(shown.contains("  grasp: fingers closed\n"), "{shown}");
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(n_lines(folder.path(), "begin"), 0);
    session.send("y\n");
    let shown = session.until("Move? y or n:");
    assert!(shown.contains("step 1/2: pick "), "{shown}");
    assert!(shown.contains("action 2: pick at "), "{shown}");
    let moved = n_lines(folder.path(), "begin");
    session.send("n\n");
    let (code, shown, mode) = session.ended();
    assert_eq!((code, mode), (Some(130), USUAL), "{shown}");
    let words = "not confirmed; no motion of this action is verified";
    assert!(
        shown.contains(&format!("step 2/2: ended: {words}\n")),
        "{shown}"
    );
    assert!(
        shown.contains(&format!("outcome: interrupted\nstopped: {words}\n")),
        "{shown}"
    );
    assert_eq!(n_lines(folder.path(), "begin"), moved);
    assert!(run_state(&folder.path().join("run")).unwrap().is_clear());
    let report = report(folder.path());
    assert_eq!(report["outcome"], "interrupted");
    assert_eq!(report["stopped"], words);
    assert_eq!(report["steps"], 1);
}

#[test]
#[ignore = "long"]
fn each_segment_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = watched(folder.path(), &["--confirm", "segment"]);
    for segment in ["rise: to ", "open: fingers open\n", "over_pick: to "] {
        let shown = session.until("Move? y or n:");
        assert!(shown.contains(segment), "{shown}");
        session.send("y\n");
    }
    let shown = session.until("Move? y or n:");
    assert!(shown.contains("pre_pick: to "), "{shown}");
    session.send("n\n");
    let (code, shown, mode) = session.ended();
    assert_eq!((code, mode), (Some(130), USUAL), "{shown}");
    let words = "in `pre_pick`: not confirmed; verified up to `over_pick`";
    assert_eq!(report(folder.path())["stopped"], words);
    assert!(shown.contains(words), "{shown}");
    assert_eq!(n_lines(folder.path(), "begin"), 3);
}

#[test]
#[ignore = "long"]
fn an_end_that_is_asked_for_at_a_question_is_no_leave() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = watched(folder.path(), &["--confirm", "each"]);
    session.until("Move? y or n:");
    session.send("\u{3}");
    let (code, shown, mode) = session.ended();
    assert_eq!((code, mode), (Some(130), USUAL), "{shown}");
    assert_eq!(report(folder.path())["outcome"], "interrupted");
    assert_eq!(n_lines(folder.path(), "begin"), 0);
}

#[test]
#[ignore = "long"]
fn the_arm_moves_while_the_key_is_held_and_ctrl_c_ends_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = watched(folder.path(), &["--hold-to-run"]);
    session.until("hold the space bar to move");
    std::thread::sleep(Duration::from_millis(700));
    assert_eq!(n_lines(folder.path(), "begin"), 0, "it moved by itself");
    press_until_begun(&mut session, folder.path(), 1);
    // The key is released 0.75 s later, which pauses a motion; a fast machine has reached the next action by then.
    session.until("hold the space bar to ");
    let moved = n_lines(folder.path(), "begin");
    assert!(moved > 0);
    std::thread::sleep(Duration::from_millis(700));
    assert_eq!(
        n_lines(folder.path(), "begin"),
        moved,
        "it went on by itself"
    );
    press_until_begun(&mut session, folder.path(), moved + 1);
    session.send("\u{3}");
    let (code, shown, mode) = session.ended();
    assert_eq!((code, mode), (Some(130), USUAL), "{shown}");
    assert_eq!(report(folder.path())["outcome"], "interrupted");
}

/// Presses the key afresh until the arm has begun its `n`th motion: a machine that stalls misses a press.
fn press_until_begun(session: &mut Session, folder: &Path, n: usize) {
    let begun = Instant::now();
    while n_lines(folder, "begin") < n {
        assert!(begun.elapsed() < super::pty::PATIENCE, "it does not move");
        session.press(" ");
        let pressed = Instant::now();
        while n_lines(folder, "begin") < n && pressed.elapsed() < Duration::from_millis(1500) {
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

#[test]
#[ignore = "long"]
fn repeats_that_waited_through_a_stall_and_those_after_it_move_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = watched(folder.path(), &["--hold-to-run"]);
    session.until("hold the space bar to move");
    std::thread::sleep(Duration::from_millis(700));
    press_until_begun(&mut session, folder.path(), 1);
    session.signal("STOP");
    session.send(&" ".repeat(40));
    std::thread::sleep(Duration::from_millis(500));
    let done = n_lines(folder.path(), "done");
    session.signal("CONT");
    session.until("if you hold it, release it first");
    for _ in 0..40 {
        session.send(" ");
        std::thread::sleep(Duration::from_millis(50));
    }
    // It may have been about to write that it had arrived.
    assert!(n_lines(folder.path(), "done") <= done + 1, "it went on");
    std::thread::sleep(Duration::from_millis(700));
    press_until_begun(&mut session, folder.path(), done + 2);
    session.send("\u{3}");
    let (code, shown, _) = session.ended();
    assert_eq!(code, Some(130), "{shown}");
}

#[test]
#[ignore = "long"]
fn a_key_that_was_typed_before_it_was_asked_for_moves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = watched(folder.path(), &["--hold-to-run"]);
    session.send(&" ".repeat(40));
    session.until("hold the space bar to move");
    std::thread::sleep(Duration::from_millis(700));
    assert_eq!(n_lines(folder.path(), "begin"), 0, "it moved");
    session.press("\u{3}");
    let (code, shown, mode) = session.ended();
    assert_eq!((code, mode), (Some(130), USUAL), "{shown}");
}

#[test]
#[ignore = "long"]
fn ctrl_c_while_the_key_is_waited_for_leaves_the_terminal_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = watched(folder.path(), &["--hold-to-run"]);
    session.until("hold the space bar to move");
    session.press("\u{3}");
    let (code, shown, mode) = session.ended();
    assert_eq!((code, mode), (Some(130), USUAL), "{shown}");
    assert_eq!(n_lines(folder.path(), "begin"), 0);
}

/// Sends a signal to a running fold during its `n`th motion.
fn signalled(folder: &Path, signal: &str, n: usize) -> Captured {
    let child = fold(folder, &["--json"])
        .process()
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    until_begun(folder, n);
    let pid = child.id().to_string();
    let sent = Command::new("kill").args([signal, &pid]).status().unwrap();
    assert!(sent.success());
    let output = child.wait_with_output().unwrap();
    Captured {
        code: output.status.code().unwrap_or(-1),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

#[test]
#[ignore = "long"]
fn a_signal_stops_the_arm_and_what_is_verified_is_told() {
    for (signal, n) in [("-INT", 2), ("-TERM", 8)] {
        let folder = tempfile::tempdir().unwrap();
        let said = signalled(folder.path(), signal, n);
        assert_eq!(said.code, 130, "{}", said.stderr);
        let told: Value = serde_json::from_str(&said.stdout).unwrap();
        assert_eq!(told["outcome"], "interrupted");
        let words = told["stopped"].as_str().unwrap();
        assert!(words.contains(": interrupted; verified up to `"), "{words}");
        assert!(
            words.ends_with("`; the arm is verified to be stopped"),
            "{words}"
        );
        assert!(
            said.stderr.contains(&format!("ended: {words}\n")),
            "{}",
            said.stderr
        );
        assert_eq!(report(folder.path())["stopped"], words);
        // The motion reported as last verified is that of the journal.
        let done = n_lines(folder.path(), "done");
        assert_eq!(n_lines(folder.path(), "begin"), done + 1);
        assert_eq!(n_lines(folder.path(), "halted"), 1);
        let state = run_state(&folder.path().join("run")).unwrap();
        assert_eq!(state.phase, Phase::Stopped);
        let segment = state.last.unwrap().segment.name();
        assert!(words.starts_with(&format!("in `{segment}`: ")), "{words}");
    }
}

/// A program with a bug that appears at this reading of the arm.
struct Mistaken(u32);

impl Supervisor for Mistaken {
    fn confirm_cloth(&mut self, _: &Start) -> bool {
        true
    }

    fn confirm(&mut self, _: MotionRequest<'_>) -> bool {
        true
    }

    fn motion_allowed(&mut self) -> bool {
        self.0 = self.0.checked_sub(1).expect("a mistake of the test's");
        true
    }
}

#[test]
#[ignore = "long"]
fn a_panic_while_the_arm_moves_is_told_with_what_is_verified() {
    let folder = tempfile::tempdir().unwrap();
    let run = RunFolder::create(&folder.path().join("run")).unwrap();
    let program = task("real/double_triangle");
    let make_world = || -> Result<Box<dyn World>, WorldError> {
        let robot = root().join("tasks/real/simulated.toml");
        let folder = folder.path().join("run");
        let supervisor = Box::new(Mistaken(200));
        let arm = simulated_arm(&robot, program.camera.image_px, supervisor, Some(&folder));
        Ok(Box::new(arm))
    };
    let interrupt = Interrupt::default();
    let mut drawn = world(&program).unwrap();
    let beside = root().join("tasks/real");
    let report = rollout::run(
        &Job {
            program: &program,
            start: &Start::flat(&program.cloth),
            subgoals: &SubgoalSet::obtain(&program, &beside, drawn.as_mut(), &interrupt).unwrap(),
            examples: &Examples::load(&program, &beside).unwrap(),
            make_policy: &Prompted::new(Models {
                vision: &Geometric,
                text: &Geometric,
            }),
            budget: &Budget::default(),
            make_world: &make_world,
            make_expert_world: &|| world(&program),
            cache: &Cache::none(),
            interrupt: &interrupt,
            horizon: None,
            early_stop: true,
            operator: None,
            repetition: 0,
            start_number: None,
        },
        run,
        &mut |_| {},
    );
    let report = report.unwrap();
    assert_eq!(report.outcome, Outcome::WorldFailed);
    let told = report.report.stopped.unwrap();
    for words in [
        "this program panicked while the arm moved, which is a bug: a mistake of the test's",
        "; verified up to `",
        "; the arm is verified to be stopped",
    ] {
        assert!(told.contains(words), "{words}: {told}");
    }
    assert_eq!(self::report(folder.path())["stopped"], told.as_str());
    assert_eq!(n_lines(folder.path(), "halted"), 1);
}
