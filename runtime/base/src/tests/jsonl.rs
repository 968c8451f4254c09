//! Unit tests of `jsonl`.

use super::*;
use serde_json::{Value, json};
use std::fs;

fn values(path: &Path) -> (Vec<Value>, u64) {
    let mut reader = Reader::open(path, u64::MAX).expect("a journal");
    let mut values = Vec::new();
    while let Some(value) = reader.read().expect("a line of JSON") {
        values.push(value);
    }
    (values, reader.whole_bytes())
}

#[test]
fn a_line_that_was_cut_off_is_left_aside_and_then_replaced() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("journal.jsonl");
    let whole = [json!({ "step": 1 }), json!({ "words": "é\n" })];
    let mut appender = Appender::open(&path).expect("a new file");
    for line in &whole {
        appender.append(line).expect("a line");
    }
    let bytes = fs::read(&path).expect("the file");
    // Cut anywhere, even inside a character: whole lines stay, and the next one follows them.
    for cut in 0..=bytes.len() {
        fs::write(&path, &bytes[..cut]).expect("a cut file");
        let (read, whole_bytes) = values(&path);
        assert_eq!(read, whole[..read.len()], "cut at {cut}");
        let mut appender = Appender::open(&path).expect("the file");
        appender.keep(whole_bytes);
        assert_eq!(fs::read(&path).expect("the file"), bytes[..cut]);
        appender.append(&json!(cut)).expect("a line");
        let mut expected = whole[..read.len()].to_vec();
        expected.push(json!(cut));
        assert_eq!(values(&path).0, expected, "cut at {cut}");
    }
}

#[test]
fn damage_endless_lines_and_what_is_no_file_are_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("journal.jsonl");
    fs::write(&path, "1\n{]\n3\n").expect("a file");
    let mut reader = Reader::open(&path, 100).expect("a journal");
    assert_eq!(reader.read::<u32>(), Ok(Some(1)));
    let damage = reader.read::<u32>().expect_err("damage");
    assert!(damage.starts_with("line 2 is damaged: "), "{damage}");

    fs::write(&path, vec![b' '; MAX_LINE_BYTES + 1]).expect("a file");
    let mut reader = Reader::open(&path, u64::MAX).expect("a journal");
    let endless = reader.next_line().expect_err("an endless line");
    assert_eq!(endless, "line 1 is longer than 16777216 bytes");

    let long = Reader::open(&path, 100).expect_err("a long file");
    assert_eq!(long, "it is longer than the limit of 100 bytes");
    let no_file = Reader::open(folder.path(), 100).expect_err("a folder");
    assert_eq!(no_file, "it is a directory, not a file");
}

#[test]
fn one_writer_has_the_journal() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("journal.jsonl");
    let [first, second] = [(); 2].map(|()| Appender::open(&path).expect("a file"));
    assert!(first.lock());
    assert!(!second.lock());
    drop(first);
    assert!(second.lock());
}
