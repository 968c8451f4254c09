//! `fabc robot recover`: in what state a run left the arm, and that a person has looked after it.
//!
//! In: the run's journal of the arm, or the arm's settings beside which its last run is named, and words. Out: a line of that
//! journal; where that is gone, of the note beside the settings. The arm itself is not asked and not moved.

use crate::cli::robot::RecoverArguments;
use crate::exit::{Exit, Failure};
use crate::output;
use fab_arm::last;
use fab_arm::last::Standing;
use fab_arm::log::{ARM_FILE, ArmLog, Entry, Left, left};
use serde_json::{Value, json};
use std::io::{BufRead, Read};
use std::path::Path;

/// The longest answer that is read, bytes.
const MAX_LINE: u64 = 4096;

const BY_HAND: &str = "nothing is moved by this command: bring the arm to rest by hand, and take the cloth out of its fingers; \
`home` of the vendor's driver opens the hand";

/// What is said where nobody said anything.
pub(super) const BY_NOBODY: &str = "nobody said what was done";

/// Says what was left, and notes what was done.
pub fn run(arguments: &RecoverArguments) -> Result<Exit, Failure> {
    match (&arguments.run, &arguments.robot) {
        (Some(run), _) => of_run(run, arguments),
        (None, Some(robot)) => of_arm(robot, arguments),
        (None, None) => Err(Failure::usage(
            "name the run folder, or the arm's settings with `--robot FILE`",
        )),
    }
}

fn of_run(folder: &Path, arguments: &RecoverArguments) -> Result<Exit, Failure> {
    if !folder.is_dir() {
        return Err(Failure::environment(format!(
            "there is no run folder `{}`",
            folder.display()
        )));
    }
    if !folder.join(ARM_FILE).is_file() {
        return Err(Failure::environment(format!(
            "in `{}` is no journal of an arm (`{ARM_FILE}`), so that nothing is known of what it left: name the folder of a run with `--world jaco`, or the arm's settings with `--robot FILE`",
            folder.display()
        )));
    }
    let before = left(folder).map_err(Failure::environment)?;
    if before == Left::Clear {
        return Ok(clear(arguments));
    }
    let how = asked(&in_words(&before), arguments)?;
    let mut log = ArmLog::open(folder).map_err(Failure::environment)?;
    let entry = Entry::Recovered { how: how.clone() };
    log.write(&entry).map_err(Failure::environment)?;
    Ok(noted(&as_json(&before, Some(&how)), &how, arguments))
}

/// Finds the last run with an arm; where its journal is gone, what was done is noted beside the settings.
fn of_arm(robot: &Path, arguments: &RecoverArguments) -> Result<Exit, Failure> {
    if !robot.is_file() {
        return Err(Failure::environment(format!(
            "there are no settings `{}`",
            robot.display()
        )));
    }
    let why = match last::standing(robot).map_err(Failure::environment)? {
        Standing::Clear => return Ok(clear(arguments)),
        Standing::Unclear { run, .. } => {
            output::talk(&format!("the last run is `{}`", run.display()));
            return of_run(&run, arguments);
        }
        Standing::Unknown { why, .. } => why,
    };
    let how = asked(
        &format!("what the last run left is not known: {why}"),
        arguments,
    )?;
    last::recover(robot, &how).map_err(Failure::environment)?;
    let read = json!({ "left": "unknown", "why": why, "recovered": how });
    Ok(noted(&read, &how, arguments))
}

fn clear(arguments: &RecoverArguments) -> Exit {
    match arguments.json {
        true => output::json(&as_json(&Left::Clear, None)),
        false => output::data("clear: no motion is open, and the hand holds nothing"),
    }
    Exit::Done
}

fn noted(read: &Value, how: &str, arguments: &RecoverArguments) -> Exit {
    match arguments.json {
        true => output::json(read),
        false => output::data(&format!("noted: {how}")),
    }
    Exit::Done
}

/// Says what was left, and returns what was done about it; fails where nobody says so.
fn asked(said: &str, arguments: &RecoverArguments) -> Result<String, Failure> {
    output::talk(said);
    output::talk(&format!("note: {BY_HAND}"));
    let question = "what was done, in a few words; nothing to leave it as it is:";
    let how = words(arguments.how.as_ref(), question);
    match how.is_empty() {
        true => Err(Failure::environment(format!(
            "{BY_NOBODY}, so that the arm counts as left in the middle: {said}"
        ))),
        false => Ok(how),
    }
}

/// Returns words that were given, or are typed as an answer; empty for none.
pub(super) fn words(given: Option<&String>, question: &str) -> String {
    match given {
        Some(words) => words.trim().to_owned(),
        None => {
            output::talk(question);
            line(&mut std::io::stdin().lock())
        }
    }
}

/// Reads a line; empty at the end.
fn line(lines: &mut dyn BufRead) -> String {
    let mut bytes = Vec::new();
    let _ = lines.take(MAX_LINE).read_until(b'\n', &mut bytes);
    String::from_utf8_lossy(&bytes).trim().to_owned()
}

/// Says in what state an arm was left.
pub(super) fn in_words(left: &Left) -> String {
    let Left::Unclear {
        segment,
        action,
        to_m,
        may_hold,
        is_verified,
        why,
    } = left
    else {
        return "clear".to_owned();
    };
    let segment = segment.text();
    let state = match is_verified {
        true => "was verified and is the last there is",
        false => "was begun and not verified",
    };
    let mut text = format!("`{segment}` of action {action} {state}");
    if let Some([x, y, z]) = to_m {
        text += &format!("; the tool was to go to {x:.3}, {y:.3}, {z:.3} m");
    }
    text += match may_hold {
        true => "; the hand may hold cloth",
        false => "; the hand holds nothing",
    };
    if let Some(why) = why {
        text += &format!("; halted: {why}");
    }
    text
}

fn as_json(left: &Left, how: Option<&str>) -> Value {
    match left {
        Left::Clear => json!({ "left": "clear", "recovered": how }),
        Left::Unclear {
            segment,
            action,
            to_m,
            may_hold,
            is_verified,
            why,
        } => json!({
            "left": "unclear",
            "segment": segment.text(),
            "action": action,
            "to_m": to_m,
            "may_hold": may_hold,
            "is_verified": is_verified,
            "why": why,
            "recovered": how,
        }),
    }
}
