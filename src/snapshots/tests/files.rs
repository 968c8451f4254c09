//! Reading and writing snapshots in insta's format, and rejecting invalid files.

use super::super::format::{self, MAX_TEXT_BYTES};
use super::super::{Contents, Folder, Name, Operation, SnapshotError};
use super::{name, picture, text};
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

#[test]
fn insta_reads_what_is_written_and_we_read_what_insta_writes() {
    let folder = tempfile::tempdir().unwrap();
    let mut snapshots = TEXTS.map(text).to_vec();
    snapshots.push(picture(b"\x89PNG\r\n\x1a\n\x00"));
    let mut kept = text("with keys of others");
    kept.metadata
        .others
        .insert("expression".to_owned(), "a + b".into());
    kept.metadata.info.as_mut().unwrap().others = serde_json::from_str(
        r#"{"nested": {"list": [1, 2.5, null, true, "yes", "0x1f", ""]}, "n": -3}"#,
    )
    .unwrap();
    snapshots.push(kept);
    for (number, snapshot) in snapshots.iter().enumerate() {
        let ours = name(&format!("ours_{number}"));
        let mut opened = Folder::open(folder.path()).unwrap();
        let change = [Operation::Propose(ours.clone(), snapshot.clone())];
        opened.apply(&change).unwrap();
        assert_eq!(opened.pending(&ours).unwrap().as_ref(), Some(snapshot));
        let theirs = insta::Snapshot::from_file(&opened.pending_path(&ours)).unwrap();
        assert_eq!(theirs.metadata().source(), Some("half.fab"));
        if let Contents::Text(text) = &snapshot.contents {
            assert_eq!(theirs.as_text().unwrap().to_string(), *text);
        }
        let rewritten = name(&format!("theirs_{number}"));
        theirs.save(&opened.accepted_path(&rewritten)).unwrap();
        let read = opened.accepted(&rewritten).unwrap().unwrap();
        assert_eq!(read.metadata, snapshot.metadata);
        assert_eq!(read.contents, snapshot.contents);
    }
}

#[test]
fn a_file_looks_as_insta_writes_it() {
    let file = format::write(&text("Fold.\n\n")).unwrap();
    insta::assert_snapshot!(String::from_utf8(file).unwrap(), @r#"
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
    let read = |file: &str| format::parse(file.as_bytes()).unwrap().text.unwrap();
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
        ("---", "the line `---` after the metadata is missing"),
        (
            "---\nsource: a\nFold.\n",
            "the line `---` after the metadata is missing",
        ),
        ("---\nsource: [a\n---\n", "its metadata is not a YAML map: "),
        ("---\n- a\n---\n", "its metadata is not a YAML map: "),
        (
            "---\na: &a [x]\nb: *a\n---\n",
            "its metadata is not a YAML map: ",
        ),
        (
            "---\nsource: 3\n---\n",
            "`source` is to be text, and is `3`",
        ),
        (
            "---\ninfo: {task: half, tokens: many}\n---\n",
            "`info`: invalid type",
        ),
        (
            "---\ninfo: {task: half, origin: [6-3 frame]}\n---\n",
            "`info`: `6-3 frame` is not an origin; one is `FROM-TO COMPONENT FILE:LINE`",
        ),
        (
            "---\nsnapshot_kind: binary\nextension: ../x\n---\n",
            "of binary snapshots `extension: png` alone is known, and it says `\"../x\"`",
        ),
        (
            "---\nsnapshot_kind: binary\n---\n",
            "of binary snapshots `extension: png` alone is known, and it says nothing",
        ),
    ];
    for (file, why) in cases {
        let found = format::parse(file.as_bytes()).unwrap_err();
        assert!(found.starts_with(why), "{file:?}: {found}");
        assert!(!found.contains('\n'), "{file:?}: {found}");
    }
    let deep = format!("---\na: {}\n---\n", "[".repeat(10_000));
    assert!(format::parse(deep.as_bytes()).is_err());
    let found = format::parse(b"---\n---\nab\xff").unwrap_err();
    assert_eq!(found, "it is not UTF-8 from byte 11 on");
}

#[test]
fn snapshots_of_others_are_read_without_what_fabc_says() {
    for info in ["text", "{a: 1}", "[1]", "{task: 3}", "~"] {
        let file = format!("---\nsource: a.rs\ninfo: {info}\nassertion_line: 3\n---\nx\n");
        let parsed = format::parse(file.as_bytes()).unwrap();
        assert_eq!(parsed.metadata.info, None, "{info}");
        assert_eq!(parsed.metadata.others["assertion_line"], 3);
    }
}

#[test]
fn names_are_file_names_everywhere() {
    for good in ["half@start", "half.v.describe@flat_2", "a", "é-1"] {
        assert_eq!(Name::new(good).unwrap().as_str(), good);
    }
    let long = "a".repeat(201);
    for bad in [
        "",
        "a b",
        "a/b",
        "..",
        ".a",
        "a.",
        "a.snap",
        "a.snap.b",
        "a\\b",
        "a:b",
        "a\n",
        long.as_str(),
    ] {
        assert!(
            matches!(Name::new(bad), Err(SnapshotError::Name { .. })),
            "{bad}"
        );
    }
}

#[test]
fn other_files_of_the_folder_are_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let others = [
        "notes.md",
        "a b.snap",
        ".hidden.snap",
        "x.snap.old",
        "x.snap.new.png",
        "half@start.snapshot",
    ];
    for other in others {
        fs::write(folder.path().join(other), "mine").unwrap();
    }
    let mut opened = Folder::open(folder.path()).unwrap();
    assert_eq!(opened.names().count(), 0);
    let (half, gone) = (name("half@start"), name("half@gone"));
    opened
        .apply(&[
            Operation::Propose(half.clone(), text("one")),
            Operation::Propose(gone.clone(), picture(b"two")),
        ])
        .unwrap();
    opened
        .apply(&[
            Operation::Accept(half.clone(), text("one")),
            Operation::Withdraw(gone),
        ])
        .unwrap();
    assert_eq!(opened.names().collect::<Vec<_>>(), [&half]);
    assert_eq!(opened.accepted_names().collect::<Vec<_>>(), [&half]);
    opened.apply(&[Operation::Remove(half)]).unwrap();
    for other in others {
        assert_eq!(
            fs::read_to_string(folder.path().join(other)).unwrap(),
            "mine"
        );
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), others.len());
}

#[test]
fn a_pending_snapshot_that_was_not_seen_is_not_accepted() {
    let folder = tempfile::tempdir().unwrap();
    let mut opened = Folder::open(folder.path().join("snapshots")).unwrap();
    let half = name("half@start");
    opened
        .apply(&[Operation::Propose(half.clone(), text("newer"))])
        .unwrap();
    let refused = opened.apply(&[Operation::Accept(half.clone(), text("seen"))]);
    assert!(matches!(refused, Err(SnapshotError::Changed { .. })));
    let missing = opened.apply(&[Operation::Accept(name("none"), text("seen"))]);
    assert!(matches!(missing, Err(SnapshotError::Changed { .. })));
    let twice = [
        Operation::Withdraw(half.clone()),
        Operation::Accept(half.clone(), text("newer")),
    ];
    assert!(matches!(
        opened.apply(&twice),
        Err(SnapshotError::Twice { .. })
    ));
    assert_eq!(opened.pending(&half).unwrap(), Some(text("newer")));
    assert_eq!(opened.accepted(&half).unwrap(), None);
}

#[test]
fn files_that_cannot_be_taken_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = |file: &str| folder.path().join(file);
    let opened = || Folder::open(folder.path()).unwrap();
    let binary = "---\nextension: png\nsnapshot_kind: binary\n---\n";
    fs::write(path("picture.snap"), binary).unwrap();
    let found = opened().accepted(&name("picture")).unwrap_err();
    assert!(matches!(found, SnapshotError::PictureMissing { .. }));
    let huge = fs::File::create(path("huge.snap")).unwrap();
    huge.set_len(MAX_TEXT_BYTES + 1).unwrap();
    let found = opened().accepted(&name("huge")).unwrap_err();
    assert!(matches!(found, SnapshotError::TooLarge { .. }));
    fs::create_dir(path("folder.snap")).unwrap();
    let found = opened().accepted(&name("folder")).unwrap_err();
    assert!(found.to_string().ends_with("it is not a file"), "{found}");
    let large = text(&"a".repeat(5 << 20));
    let found = opened().apply(&[Operation::Propose(name("large"), large)]);
    assert!(matches!(found, Err(SnapshotError::Format { .. })));
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("huge.snap", path("link.snap")).unwrap();
        let found = opened().accepted(&name("link")).unwrap_err();
        assert!(found.to_string().contains("it is a link"), "{found}");
    }
    fs::write(path("file"), "").unwrap();
    let found = Folder::open(path("file")).unwrap_err();
    assert!(matches!(found, SnapshotError::Unreadable { .. }));
}
