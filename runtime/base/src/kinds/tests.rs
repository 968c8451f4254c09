//! Tests of what files are, and of the readers that say so.

use super::*;
use crate::files;
use crate::jsonl::Reader;
use serde_json::Value;
use std::fs;

#[test]
fn files_are_named_by_how_they_begin() {
    let rows: [(&[u8], &str); 11] = [
        (b"", "it is empty; write or fetch it again"),
        (b"\x89PNG\r\n\x1a\n..", "it is a PNG picture"),
        (b"\xff\xd8\xff\xe1..", "it is a JPEG picture"),
        (b"RIFF....WEBPVP8L", "it is a WebP picture"),
        (b"\0\0\0\x18ftypheic", "it is a HEIC picture"),
        (
            b"version https://git-lfs.github.com/spec/v1\noid",
            "`git lfs pull` fetches it",
        ),
        (b"\r\n <!DOCTYPE HTML><title>404", "it is a web page"),
        (b"\xef\xbb\xbf<html>", "it is a web page"),
        (
            b"PK\x03\x04",
            "it is a zip archive, such as `.npz` or `.xlsx`",
        ),
        (b"\x80\x04\x95", "it is a Python pickle"),
        (b"\xff\xfeu\0,\0", "it is text in UTF-16; save it as UTF-8"),
    ];
    for (bytes, told) in rows {
        let sentence = Kind::of(bytes).map(|kind| kind.sentence());
        assert!(
            sentence.as_ref().is_some_and(|it| it.contains(told)),
            "{sentence:?}, not {told}"
        );
    }
    for bytes in [
        &b"task t {}"[..],
        b"u,v,x,y,z",
        b"{}",
        b"RIFF....WAVE",
        b"\0",
    ] {
        assert_eq!(Kind::of(bytes), None, "{bytes:?}");
    }
}

#[test]
fn a_text_is_read_without_its_mark_or_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a");
    let read = |bytes: &[u8]| {
        fs::write(&path, bytes).expect("a file");
        files::read_text(&path, 100)
    };
    assert_eq!(read(b"\xef\xbb\xbfa,b"), Ok("a,b".to_owned()));
    // This begins as a GIF picture does, and is a text.
    assert_eq!(read(b"GIF8"), Ok("GIF8".to_owned()));
    let rows: [(&[u8], &str); 5] = [
        (b"a\0b\0", "it is text in UTF-16; save it as UTF-8"),
        (b"\xff\xfea\0", "it is text in UTF-16; save it as UTF-8"),
        (
            b"version https://git-lfs.github.com/spec/v1\n",
            "it is a Git LFS pointer",
        ),
        (b"\x89PNG\r\n\x1a\n", "it is a PNG picture"),
        (
            b"caf\xe9",
            "it is not UTF-8 text: byte 3, in line 1, is 0xe9; save it as UTF-8",
        ),
    ];
    for (bytes, told) in rows {
        let why = read(bytes).expect_err(told);
        assert!(why.starts_with(told), "{why}");
    }
    fs::write(&path, b"\xef\xbb\xbf[1, 2]\n").expect("a file");
    assert_eq!(files::read_json(&path, 100), Ok([1, 2]));
}

#[test]
fn lines_of_json_may_have_a_mark_and_blank_lines() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.jsonl");
    let read = |bytes: &[u8]| {
        fs::write(&path, bytes).expect("a file");
        let mut reader = Reader::open(&path, 1000).expect("a journal");
        let mut values = Vec::new();
        while let Some(value) = reader.read::<Value>()? {
            values.push(value);
        }
        assert_eq!(reader.whole_bytes(), bytes.len() as u64);
        Ok::<_, String>(values)
    };
    let wanted = [Value::from(1), Value::from(2)];
    for bytes in [
        &b"1\n2\n"[..],
        b"\xef\xbb\xbf1\n2\n",
        b"\xef\xbb\xbf\n1\r\n \r\n2\n\n\n",
    ] {
        assert_eq!(read(bytes).as_deref(), Ok(&wanted[..]), "{bytes:?}");
    }
    let why = read(b"\xff\xfe1\0\n\0").expect_err("UTF-16");
    assert_eq!(why, "it is text in UTF-16; save it as UTF-8");
    assert_eq!(
        read(b"1\nx\n").expect_err("no JSON"),
        "line 2 is damaged: expected value at line 1 column 1"
    );
}
