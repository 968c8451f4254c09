//! Reading and writing snapshots in insta's format, changing a folder of them, and rejecting invalid files.
#![allow(clippy::unwrap_used)]

use super::*;
use std::fs;

/// Texts that a careless writer of YAML or lines would change.
const TEXTS: [&str; 6] = [
    "Fold the cloth.\n\nAnswer with:\n---\npick: [u, v]",
    "",
    "  indented\n\ttabbed",
    "---",
    "é ° “quoted” 折",
    "one\u{2028}line\rwith an old end",
];

fn name(name: &str) -> Name {
    name.to_owned()
}

fn info() -> Info {
    Info {
        task: "half".to_owned(),
        variant: Some("without_layers".to_owned()),
        stage: Some("describe".to_owned()),
        scene: Some("start".to_owned()),
        tokens: Some(812),
        origin: vec![
            origin(1, 2, "describe.say", Some(("half.fab", 12))),
            origin(3, 3, "frame", None),
            origin(4, 6, "check.near", Some(("my lib/folding: all.fab", 28))),
        ],
        ..Info::default()
    }
}

fn snapshot(info: Info, contents: Contents) -> Snapshot {
    let description = "what `half` asks: first, with a colon".to_owned();
    Snapshot::of("half.fab", description, info, contents)
}

fn text(contents: &str) -> Snapshot {
    snapshot(info(), Contents::Text(contents.to_owned()))
}

fn picture(bytes: &[u8]) -> Snapshot {
    let info = Info {
        picture: Some("subgoal 1 with arrow".to_owned()),
        // YAML reads digits with one `e` as a number unless they are quoted.
        drawn_from: Some("12345e67".to_owned()),
        ..info()
    };
    snapshot(info, Contents::Picture(bytes.to_vec()))
}

fn origin(from: u32, to: u32, component: &str, place: Option<(&str, u32)>) -> Origin {
    Origin {
        from,
        to,
        component: component.to_owned(),
        place: place.map(|(file, line)| (file.to_owned(), line)),
    }
}

#[test]
fn insta_reads_what_is_written_and_we_read_what_insta_writes() {
    let root = tempfile::tempdir().unwrap();
    let folder = Folder::open(root.path()).unwrap();
    let mut snapshots = TEXTS.map(text).to_vec();
    snapshots.push(picture(b"\x89PNG\r\n\x1a\n\x00"));
    for (number, snapshot) in snapshots.iter().enumerate() {
        let ours = name(&format!("ours_{number}"));
        folder.propose(&ours, snapshot).unwrap();
        let read = folder.read(&ours, Side::Pending).unwrap();
        assert_eq!(read.as_ref(), Some(snapshot));
        let theirs = insta::Snapshot::from_file(&folder.file(&ours, Side::Pending)).unwrap();
        assert_eq!(theirs.metadata().source(), Some("half.fab"));
        if let Contents::Text(text) = &snapshot.contents {
            assert_eq!(theirs.as_text().unwrap().to_string(), *text);
        }
        let rewritten = name(&format!("theirs_{number}"));
        theirs
            .save(&folder.file(&rewritten, Side::Accepted))
            .unwrap();
        let read = folder.read(&rewritten, Side::Accepted).unwrap();
        assert_eq!(read.as_ref(), Some(snapshot));
    }
}

#[test]
fn a_file_looks_as_insta_writes_it() {
    insta::assert_snapshot!(format::write(&text("Fold.\n\n")).unwrap(), @r#"
    ---
    source: half.fab
    description: "what `half` asks: first, with a colon"
    info:
      task: half
      variant: without_layers
      stage: describe
      scene: start
      tokens: 812
      origin:
      - 1-2 describe.say half.fab:12
      - 3-3 frame
      - "4-6 check.near my lib/folding: all.fab:28"
    ---
    Fold.
    "#);
}

#[test]
fn line_ends_and_blanks_at_the_end_do_not_count() {
    let read = |file: &str| format::parse(file).unwrap().1.unwrap();
    assert_eq!(
        read("---\nsource: a\n---\none\ntwo\n"),
        read("---\r\nsource: a\r\n---\r\none\r\ntwo")
    );
    let same = |one: &str, other: &str| {
        Contents::Text(one.to_owned()).is_same(&Contents::Text(other.to_owned()))
    };
    assert!(same("one\r\ntwo", "one\ntwo  \n\n"));
    assert!(!same("one\ntwo", "one\n two"));
    assert!(!same("one \ntwo", "one\ntwo"));
    assert!(!Contents::Text(String::new()).is_same(&Contents::Picture(Vec::new())));
}

#[test]
fn files_that_are_no_snapshots_say_why() {
    let cases = [
        ("Fold.\n", "it does not begin with a line `---`"),
        ("", "it does not begin with a line `---`"),
        (
            "---\nsource: a\nFold.\n",
            "the line `---` after the metadata is missing",
        ),
        ("---\nsource: [a\n---\n", "its metadata cannot be read: "),
        ("---\n- a\n---\n", "its metadata cannot be read: "),
        (
            "---\ninfo: {task: half, tokens: many}\n---\n",
            "its metadata cannot be read: `info`: invalid type",
        ),
        (
            "---\ninfo: {task: half, origin: [6 frame]}\n---\n",
            "its metadata cannot be read: `info`: `6 frame` is not an origin; one is `FROM-TO COMPONENT FILE:LINE`",
        ),
        (
            "---\nsnapshot_kind: binary\nextension: ../x\n---\n",
            "of binary snapshots `extension: png` alone is known",
        ),
        (
            "---\nsource: a\n---\none\n<<<<<<< ours\ntwo\n",
            "line 5 begins a merge conflict",
        ),
    ];
    for (file, why) in cases {
        let found = format::parse(file).unwrap_err();
        assert!(found.starts_with(why), "{file:?}: {found}");
        assert!(!found.contains('\n'), "{file:?}: {found}");
    }
    let deep = format!("---\na: {}\n---\n", "[".repeat(10_000));
    assert!(format::parse(&deep).is_err());
}

#[test]
fn snapshots_of_others_are_read_without_what_fabc_says() {
    for info in ["text", "{a: 1}", "[1]", "{task: 3}", "~"] {
        let file = format!("---\nsource: a.rs\ninfo: {info}\nassertion_line: 3\n---\nx\n");
        let (metadata, text) = format::parse(&file).unwrap();
        assert_eq!(metadata.info, None, "{info}");
        assert_eq!(text.as_deref(), Some("x"));
    }
}

#[test]
fn a_picture_and_a_text_take_each_others_place_and_other_files_stay() {
    let root = tempfile::tempdir().unwrap();
    let files = || {
        let files = fs::read_dir(root.path()).unwrap();
        let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    };
    fs::write(root.path().join("notes.md"), "mine").unwrap();
    let half = name("half@start");
    let folder = Folder::open(root.path()).unwrap();
    for snapshot in [text("one"), picture(b"two"), text("three")] {
        folder.propose(&half, &snapshot).unwrap();
        assert_eq!(Folder::open(root.path()).unwrap().pending.len(), 1);
        folder.accept(&half, &snapshot).unwrap();
        let read = folder.read(&half, Side::Accepted).unwrap();
        assert_eq!(read.as_ref(), Some(&snapshot));
    }
    let opened = Folder::open(root.path()).unwrap();
    assert_eq!((opened.accepted.len(), opened.pending.len()), (1, 0));
    assert_eq!(files(), ["half@start.snap", "notes.md"]);
    folder.propose(&half, &picture(b"four")).unwrap();
    folder.remove(&half, Side::Pending).unwrap();
    folder.remove(&half, Side::Accepted).unwrap();
    folder.remove(&half, Side::Accepted).unwrap();
    assert_eq!(files(), ["notes.md"]);
}

#[test]
fn a_pending_snapshot_that_was_not_seen_is_not_accepted() {
    let root = tempfile::tempdir().unwrap();
    let folder = Folder::open(root.path().join("snapshots")).unwrap();
    let half = name("half@start");
    folder.propose(&half, &text("newer")).unwrap();
    for name in [&half, &name("none")] {
        let refused = folder.accept(name, &text("seen")).unwrap_err().to_string();
        assert!(
            refused.contains("has changed since it was shown"),
            "{refused}"
        );
    }
    let read = |side| folder.read(&half, side).unwrap();
    assert_eq!(read(Side::Pending), Some(text("newer")));
    assert_eq!(read(Side::Accepted), None);
}

#[test]
fn files_that_cannot_be_taken_are_named() {
    let root = tempfile::tempdir().unwrap();
    let path = |file: &str| root.path().join(file);
    let binary = "---\nextension: png\nsnapshot_kind: binary\n---\n";
    fs::write(path("picture.snap"), binary).unwrap();
    let huge = fs::File::create(path("huge.snap")).unwrap();
    huge.set_len(1 << 30).unwrap();
    fs::create_dir(path("folder.snap")).unwrap();
    let folder = Folder::open(root.path()).unwrap();
    for (wrong, file, why) in [
        ("picture", "picture.snap.png", "No such file"),
        ("huge", "huge.snap", "it is longer than the limit"),
        ("folder", "folder.snap", "it is a directory"),
    ] {
        let found = folder.read(&name(wrong), Side::Accepted).unwrap_err();
        let found = found.to_string();
        assert!(found.contains(&format!("{file}`: {why}")), "{found}");
    }
    fs::write(path("file"), "").unwrap();
    let found = Folder::open(path("file")).unwrap_err().to_string();
    assert!(found.starts_with("cannot read `"), "{found}");
}

#[cfg(unix)]
#[test]
fn a_folder_that_cannot_be_written_can_be_read() {
    use std::os::unix::fs::PermissionsExt;
    let root = tempfile::tempdir().unwrap();
    let half = name("half@start");
    let folder = Folder::open(root.path()).unwrap();
    folder.propose(&half, &text("one")).unwrap();
    let modes = |mode| fs::set_permissions(root.path(), fs::Permissions::from_mode(mode));
    modes(0o555).unwrap();
    let read = Folder::open(root.path()).and_then(|opened| opened.read(&half, Side::Pending));
    modes(0o755).unwrap();
    assert_eq!(read.unwrap(), Some(text("one")));
}
