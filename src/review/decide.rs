//! Does what was decided: accepts and rejects snapshots.
//!
//! In: which snapshots, and what is to become of each. Out: changed folders. The snapshots of one folder change all
//! together or not at all; before the first of several folders changes, all are looked at.

use super::find::{Found, Pending};
use super::groups::Group;
use crate::exit::Failure;
use crate::snapshots::{Operation, SnapshotError};
use std::fs;
use std::path::Path;

/// What becomes of a pending snapshot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decision {
    /// It is the accepted one from now on.
    Accept,
    /// It goes; what was accepted stays.
    Reject,
}

/// Does what was decided of some pending snapshots, by their numbers.
pub fn apply(found: &mut Found, decided: &[(usize, Decision)]) -> Result<(), Failure> {
    for (number, decision) in decided {
        let one = &found.pending[*number];
        if *decision == Decision::Accept {
            let now = found.folders[one.folder].pending(&one.name);
            if now.map_err(Failure::environment)?.as_ref() != Some(&one.proposed) {
                return Err(Failure::environment(SnapshotError::Changed {
                    path: one.path.clone(),
                }));
            }
        }
    }
    for (number, folder) in found.folders.iter_mut().enumerate() {
        let operations: Vec<Operation> = decided
            .iter()
            .map(|(at, decision)| (&found.pending[*at], *decision))
            .filter(|(one, _)| one.folder == number)
            .map(|(one, decision)| match decision {
                Decision::Accept => Operation::Accept(one.name.clone(), one.proposed.clone()),
                Decision::Reject => Operation::Withdraw(one.name.clone()),
            })
            .collect();
        folder.apply(&operations).map_err(Failure::environment)?;
    }
    Ok(())
}

/// Returns the snapshots that an id names: of a group, or one; fails where it names none, or several by one name.
pub fn named(id: &str, pending: &[Pending], groups: &[Group]) -> Result<Vec<usize>, Failure> {
    if let Some(group) = groups.iter().find(|group| group.id == id) {
        return Ok(group.members.clone());
    }
    let by_name = |one: &Pending| one.name.as_str() == id;
    let place = fs::canonicalize(id).ok();
    let by_path = |one: &Pending| {
        one.path == Path::new(id) || (place.is_some() && fs::canonicalize(&one.path).ok() == place)
    };
    let numbers: Vec<usize> = (0..pending.len())
        .filter(|at| by_name(&pending[*at]) || by_path(&pending[*at]))
        .collect();
    match numbers.as_slice() {
        [] => Err(Failure::usage(format!(
            "nothing that is pending has the id `{id}`; `fabc review --json` lists them; nothing was done"
        ))),
        [_] => Ok(numbers),
        several => {
            let paths: Vec<String> = several
                .iter()
                .map(|at| format!("`{}`", pending[*at].path.display()))
                .collect();
            Err(Failure::usage(format!(
                "`{id}` names several snapshots: {}; name one by its path; nothing was done",
                paths.join(", ")
            )))
        }
    }
}

/// Returns whether an id fits a pattern: has it in it, or fits it as a whole where it has `*` (any letters) or `?` (one).
pub fn fits(pattern: &str, id: &str) -> bool {
    if !pattern.contains(['*', '?']) {
        return id.contains(pattern);
    }
    let pattern: Vec<char> = pattern.chars().collect();
    let id: Vec<char> = id.chars().collect();
    // The last `*` seen, and where in the id what it stands for ends for now.
    let (mut at, mut star, mut next) = (0, None, 0);
    while next < id.len() {
        match pattern.get(at) {
            Some('*') => {
                star = Some((at, next));
                at += 1;
            }
            Some(letter) if *letter == '?' || *letter == id[next] => {
                at += 1;
                next += 1;
            }
            _ => match star {
                Some((starred, end)) => {
                    star = Some((starred, end + 1));
                    at = starred + 1;
                    next = end + 1;
                }
                None => return false,
            },
        }
    }
    pattern[at..].iter().all(|letter| *letter == '*')
}
