//! Tests of `watchdog`.

#![allow(clippy::unwrap_used)]

use super::*;
use std::io::{Write, pipe};

/// Long enough that a loaded machine does not time out.
const LONG: Duration = Duration::from_secs(600);
const SHORT: Duration = Duration::from_millis(60);

/// Watches these lines, then end of input; returns how it ended, what it acknowledged, and how often the arm was
/// stopped.
fn watch_lines(typed: &'static str) -> (Option<Result<(), String>>, String, u32) {
    let (mut n_stops, mut acknowledged) = (0, Vec::new());
    let ended = keep_watch(
        &lines_of(typed.as_bytes()),
        LONG,
        &mut |line| acknowledged.push(line.to_owned()),
        &mut || {
            n_stops += 1;
            Ok(())
        },
    );
    (ended, acknowledged.join(" "), n_stops)
}

#[test]
fn lines_that_end_while_it_watches_stop_the_arm_and_each_is_acknowledged() {
    for (typed, acknowledged) in [
        ("beat\n", "beat"),
        ("beat\nbeat\nbeat", "beat beat beat"),
        ("rest\nbeat\nhello\n", "rest beat"),
        ("stop\nbeat\n", ""),
        ("beat\nstop\nrest\n", "beat"),
    ] {
        let expected = (Some(Ok(())), acknowledged.to_owned(), 1);
        assert_eq!(watch_lines(typed), expected, "{typed:?}");
    }
    for (typed, acknowledged) in [
        ("", ""),
        ("rest\n", "rest"),
        ("beat\nbeat\nrest\n", "beat beat rest"),
    ] {
        let expected = (None, acknowledged.to_owned(), 0);
        assert_eq!(watch_lines(typed), expected, "{typed:?}");
    }
}

#[test]
fn silence_while_it_watches_stops_the_arm() {
    for typed in ["beat\n", "beat\nbeat\nnoise\n"] {
        let (reader, mut writer) = pipe().unwrap();
        writer.write_all(typed.as_bytes()).unwrap();
        let begun = Instant::now();
        let ended = keep_watch(&lines_of(reader), SHORT, &mut |_| {}, &mut || Ok(()));
        assert_eq!(ended, Some(Ok(())), "{typed:?}");
        assert!(begun.elapsed() >= SHORT);
        drop(writer);
    }
}

#[test]
fn stopping_is_tried_again() {
    let mut n_tries = 0;
    let ended = keep_watch(&lines_of("beat".as_bytes()), LONG, &mut |_| {}, &mut || {
        n_tries += 1;
        match n_tries {
            3 => Ok(()),
            _ => Err("no answer".to_owned()),
        }
    });
    assert_eq!((ended, n_tries), (Some(Ok(())), 3));
    let ended = keep_watch(&lines_of("beat".as_bytes()), LONG, &mut |_| {}, &mut || {
        Err("no answer".to_owned())
    });
    assert_eq!(ended, Some(Err("no answer".to_owned())));
}
