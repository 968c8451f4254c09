//! A change that is stopped after any of its file operations, and concurrent changes of one folder.

use super::super::disk::{Disk, System};
use super::super::journal::{self, Lock};
use super::super::{Folder, Operation, SnapshotError};
use super::{name, picture, text};
use std::cell::Cell;
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;

/// A disk that completes some operations, half of the next, and then nothing: as if the process had been killed.
struct Stopping {
    left: Cell<u32>,
}

impl Stopping {
    fn after(operations: u32) -> Stopping {
        Stopping {
            left: Cell::new(operations),
        }
    }

    fn run(&self, whole: impl FnOnce() -> io::Result<()>, half: impl FnOnce()) -> io::Result<()> {
        match self.left.get().checked_sub(1) {
            Some(0) => half(),
            Some(left) => {
                self.left.set(left);
                return whole();
            }
            None => {}
        }
        self.left.set(0);
        Err(io::Error::other("stopped"))
    }
}

impl Disk for Stopping {
    fn make_folder(&self, path: &Path) -> io::Result<()> {
        self.run(|| System.make_folder(path), || {})
    }

    fn write(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        let half = || System.write(path, &bytes[..bytes.len() / 2]).unwrap();
        self.run(|| System.write(path, bytes), half)
    }

    fn sync(&self, path: &Path) -> io::Result<()> {
        self.run(|| System.sync(path), || {})
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.run(|| System.rename(from, to), || {})
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        self.run(|| System.remove(path), || {})
    }

    fn remove_folder(&self, path: &Path) -> io::Result<()> {
        let half = || {
            let first = fs::read_dir(path).ok().and_then(|mut files| files.next());
            if let Some(Ok(first)) = first {
                fs::remove_file(first.path()).unwrap();
            }
        };
        self.run(|| System.remove_folder(path), half)
    }
}

/// A folder with a snapshot of each kind, and a change of everything in it.
fn prepared(folder: &Path) -> Vec<Operation> {
    let mut opened = Folder::open(folder).unwrap();
    let accepted = [
        "text",
        "drawing",
        "orphan",
        "to_text",
        "to_picture",
        "quiet",
    ];
    let propose = |name: &str, snapshot| Operation::Propose(super::name(name), snapshot);
    let first: Vec<Operation> = accepted
        .iter()
        .map(|kind| propose(kind, old(kind)))
        .collect();
    opened.apply(&first).unwrap();
    let accept: Vec<Operation> = accepted
        .iter()
        .map(|kind| Operation::Accept(name(kind), old(kind)))
        .collect();
    opened.apply(&accept).unwrap();
    let pending = [
        propose("text", text("new")),
        propose("drawing", picture(b"new")),
        propose("to_text", text("new")),
        propose("to_picture", picture(b"new")),
        propose("rejected", picture(b"no")),
        propose("replaced", picture(b"before")),
    ];
    opened.apply(&pending).unwrap();
    vec![
        Operation::Accept(name("text"), text("new")),
        Operation::Accept(name("drawing"), picture(b"new")),
        Operation::Accept(name("to_text"), text("new")),
        Operation::Accept(name("to_picture"), picture(b"new")),
        Operation::Withdraw(name("rejected")),
        propose("replaced", text("after")),
        propose("quiet", picture(b"proposed")),
        Operation::Remove(name("orphan")),
    ]
}

fn old(kind: &str) -> super::super::Snapshot {
    match kind {
        "drawing" | "to_text" | "orphan" => picture(kind.as_bytes()),
        _ => text(kind),
    }
}

fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    entries
        .map(|entry| {
            let name = entry.file_name().into_string().unwrap();
            let bytes = fs::read(entry.path()).unwrap_or_default();
            (name, bytes)
        })
        .collect()
}

#[test]
fn a_change_that_is_stopped_anywhere_is_whole_or_did_not_happen() {
    let folder = tempfile::tempdir().unwrap();
    let change = prepared(folder.path());
    let before = files(folder.path());
    assert!(!before.contains_key(".change"));
    Folder::open(folder.path()).unwrap().apply(&change).unwrap();
    let after = files(folder.path());
    assert_eq!(before.len(), 19);
    assert_eq!(
        after.keys().collect::<Vec<_>>(),
        [
            "drawing.snap",
            "drawing.snap.png",
            "quiet.snap",
            "quiet.snap.new",
            "quiet.snap.new.png",
            "replaced.snap.new",
            "text.snap",
            "to_picture.snap",
            "to_picture.snap.png",
            "to_text.snap",
        ]
    );
    let (mut undone, mut done) = (0, 0);
    for stop in 1.. {
        let folder = tempfile::tempdir().unwrap();
        for (name, bytes) in &before {
            fs::write(folder.path().join(name), bytes).unwrap();
        }
        let mut opened = Folder::open(folder.path()).unwrap();
        let outcome = opened.apply_on(&Stopping::after(stop), &change);
        if outcome.is_ok() {
            break;
        }
        // Recovery may be stopped as well, any number of times.
        for again in 1..8 {
            let _ = journal::recover(&Stopping::after(again), folder.path());
        }
        Folder::open(folder.path()).unwrap();
        let found = files(folder.path());
        match (found == before, found == after) {
            (true, false) if done == 0 => undone += 1,
            (false, true) => done += 1,
            _ => panic!("stopped at operation {stop}: {:?}", found.keys()),
        }
    }
    assert!(undone > 10 && done > 15, "{undone} {done}");
}

#[test]
fn what_an_interrupted_change_could_not_have_left_is_not_touched() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let inside = root.join("snapshots");
    fs::create_dir_all(inside.join(".change")).unwrap();
    fs::write(root.join("half.fab"), "mine").unwrap();
    fs::write(inside.join("readme.md"), "mine").unwrap();
    let journals = [
        r#"[{"remove": {"file": "../half.fab"}}]"#,
        r#"[{"remove": {"file": "readme.md"}}]"#,
        r#"[{"move": {"from": "a.snap.new", "to": "../half.snap"}}]"#,
        r#"[{"place": {"aside": 0, "file": "/half.snap"}}]"#,
        r#"[{"place": {"aside": "../../half.fab", "file": "half.snap"}}]"#,
        "[",
    ];
    for text in journals {
        fs::write(inside.join(".change/journal.json"), text).unwrap();
        let found = Folder::open(&inside).unwrap_err();
        assert!(matches!(found, SnapshotError::Foreign { .. }), "{text}");
    }
    fs::remove_dir_all(inside.join(".change")).unwrap();
    fs::write(inside.join(".change"), "mine").unwrap();
    let found = Folder::open(&inside).unwrap_err();
    assert!(matches!(found, SnapshotError::Foreign { .. }), "{found}");
    assert_eq!(fs::read_to_string(inside.join(".change")).unwrap(), "mine");
}

#[test]
#[ignore = "long"]
fn two_cannot_change_a_folder_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let change = prepared(folder.path());
    let mut opened = Folder::open(folder.path()).unwrap();
    let before = files(folder.path());
    let lock = Lock::take(folder.path()).unwrap();
    let refused = opened.apply(&change).unwrap_err();
    assert!(matches!(refused, SnapshotError::InUse { .. }), "{refused}");
    // Reading does not wait for the lock.
    Folder::open(folder.path()).unwrap();
    assert_eq!(files(folder.path()), before);
    drop(lock);
    opened.apply(&change).unwrap();
    assert_ne!(files(folder.path()), before);
}

#[cfg(unix)]
#[test]
fn a_folder_that_cannot_be_written_can_be_read() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let half = name("half@start");
    let mut opened = Folder::open(folder.path()).unwrap();
    opened
        .apply(&[Operation::Propose(half.clone(), text("one"))])
        .unwrap();
    let modes = |mode| fs::set_permissions(folder.path(), fs::Permissions::from_mode(mode));
    modes(0o555).unwrap();
    let read = Folder::open(folder.path()).and_then(|opened| opened.pending(&half));
    modes(0o755).unwrap();
    assert_eq!(read.unwrap(), Some(text("one")));
}
