//! Changes of snapshots, and the file steps that each one takes.

use super::format::{self, Contents, MAX_PICTURE_BYTES, Snapshot};
use super::journal::Step;
use super::name::{Name, Side};
use super::{Folder, SnapshotError};
use std::collections::BTreeSet;

/// One part of a change; a change names each snapshot at most once.
#[derive(Clone, Debug)]
pub enum Operation {
    /// Makes a snapshot pending and replaces the one pending under its name. Fails if it is too large.
    Propose(Name, Snapshot),
    /// Removes the pending snapshot of this name, if there is one.
    Withdraw(Name),
    /// Accepts the pending snapshot. Fails if it is no longer this one, which the user looked at.
    Accept(Name, Snapshot),
    /// Removes the accepted snapshot, if there is one.
    Remove(Name),
}

/// Returns the new files and the steps of a change.
///
/// Steps run in order. A picture is placed before the file that names it and removed after it, so that a reader who
/// ignores changes under way never finds a file without its picture.
pub(super) fn steps(
    folder: &Folder,
    operations: &[Operation],
) -> Result<(Vec<Vec<u8>>, Vec<Step>), SnapshotError> {
    let mut named = BTreeSet::new();
    let mut new_files = Vec::new();
    let mut steps = Vec::new();
    for operation in operations {
        let (Operation::Propose(name, _)
        | Operation::Withdraw(name)
        | Operation::Accept(name, _)
        | Operation::Remove(name)) = operation;
        if !named.insert(name) {
            return Err(SnapshotError::Twice {
                name: name.to_string(),
            });
        }
        match operation {
            Operation::Propose(name, snapshot) => {
                propose(folder, name, snapshot, &mut new_files, &mut steps)?;
            }
            Operation::Withdraw(name) => remove(name, Side::Pending, &mut steps),
            Operation::Accept(name, seen) => accept(folder, name, seen, &mut steps)?,
            Operation::Remove(name) => remove(name, Side::Accepted, &mut steps),
        }
    }
    Ok((new_files, steps))
}

fn propose(
    folder: &Folder,
    name: &Name,
    snapshot: &Snapshot,
    new_files: &mut Vec<Vec<u8>>,
    steps: &mut Vec<Step>,
) -> Result<(), SnapshotError> {
    let path = folder.pending_path(name);
    let file = format::write(snapshot).map_err(|why| SnapshotError::Format {
        path: path.clone(),
        why,
    })?;
    let mut place = |bytes: Vec<u8>, file: String| {
        // More than `u32::MAX` files would not fit into memory.
        let aside = u32::try_from(new_files.len()).unwrap_or(u32::MAX);
        new_files.push(bytes);
        Step::Place { aside, file }
    };
    match &snapshot.contents {
        Contents::Text(_) => {
            steps.push(place(file, name.file(Side::Pending)));
            steps.push(Step::Remove {
                file: name.picture(Side::Pending),
            });
        }
        Contents::Picture(bytes) if bytes.len() as u64 > MAX_PICTURE_BYTES => {
            return Err(SnapshotError::TooLarge {
                path,
                most: MAX_PICTURE_BYTES,
            });
        }
        Contents::Picture(bytes) => {
            steps.push(place(bytes.clone(), name.picture(Side::Pending)));
            steps.push(place(file, name.file(Side::Pending)));
        }
    }
    Ok(())
}

fn accept(
    folder: &Folder,
    name: &Name,
    seen: &Snapshot,
    steps: &mut Vec<Step>,
) -> Result<(), SnapshotError> {
    if folder.read(name, Side::Pending)?.as_ref() != Some(seen) {
        return Err(SnapshotError::Changed {
            path: folder.pending_path(name),
        });
    }
    let file = Step::Move {
        from: name.file(Side::Pending),
        to: name.file(Side::Accepted),
    };
    match seen.contents {
        Contents::Text(_) => {
            steps.push(file);
            steps.push(Step::Remove {
                file: name.picture(Side::Accepted),
            });
        }
        Contents::Picture(_) => {
            steps.push(Step::Move {
                from: name.picture(Side::Pending),
                to: name.picture(Side::Accepted),
            });
            steps.push(file);
        }
    }
    Ok(())
}

fn remove(name: &Name, side: Side, steps: &mut Vec<Step>) {
    for file in [name.file(side), name.picture(side)] {
        steps.push(Step::Remove { file });
    }
}
