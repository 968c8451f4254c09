//! `fabc robot recover`: in what state a run left the arm, and that a person has looked after it.
//!
//! In: the run's journal of the arm, and words. Out: a line of that journal. The arm itself is not asked and not moved.

use crate::cli::robot::RecoverArguments;
use crate::exit::{Exit, Failure};
use crate::output;
use runtime::arm::log::{ArmLog, Entry, Left, left};
use serde_json::{Value, json};
use std::io::{BufRead, Read};

/// The longest answer that is read, bytes.
const MAX_LINE: u64 = 4096;

const BY_HAND: &str = "nothing is moved by this command: bring the arm to rest by hand, and take the cloth out of its fingers; \
`home` of the vendor's driver opens the hand";

/// Says what was left, and notes what was done.
pub fn run(arguments: &RecoverArguments) -> Result<Exit, Failure> {
    let folder = &arguments.run;
    if !folder.is_dir() {
        return Err(Failure::environment(format!(
            "there is no run folder `{}`",
            folder.display()
        )));
    }
    let before = left(folder).map_err(Failure::environment)?;
    if before == Left::Clear {
        match arguments.json {
            true => output::json(&as_json(&before, None)),
            false => output::data("clear: no motion is open, and the hand holds nothing"),
        }
        return Ok(Exit::Done);
    }
    let said = in_words(&before);
    output::talk(&said);
    output::talk(&format!("note: {BY_HAND}"));
    let how = match &arguments.how {
        Some(how) => how.trim().to_owned(),
        None => {
            output::talk("what was done, in a few words; nothing to leave it as it is:");
            line(&mut std::io::stdin().lock())
        }
    };
    if how.is_empty() {
        return Err(Failure::environment(format!(
            "nobody said what was done, so that the arm counts as left in the middle: {said}"
        )));
    }
    let mut log = ArmLog::open(folder).map_err(Failure::environment)?;
    let entry = Entry::Recovered { how: how.clone() };
    log.write(&entry).map_err(Failure::environment)?;
    match arguments.json {
        true => output::json(&as_json(&before, Some(&how))),
        false => output::data(&format!("noted: {how}")),
    }
    Ok(Exit::Done)
}

/// Reads a line; empty at the end.
fn line(lines: &mut dyn BufRead) -> String {
    let mut bytes = Vec::new();
    let _ = lines.take(MAX_LINE).read_until(b'\n', &mut bytes);
    String::from_utf8_lossy(&bytes).trim().to_owned()
}

fn in_words(left: &Left) -> String {
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
