//! Tests of `watchdog`.

#![allow(clippy::unwrap_used)]

use super::*;
use std::io::pipe;

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

/// Longer than a loaded machine takes for an answer.
const TIMEOUT: Duration = Duration::from_secs(2);

/// Another program in the watchdog's place.
fn played(script: &str) -> Result<Process, String> {
    let mut command = Command::new("sh");
    command.args(["-c", script]);
    Process::spawn(command, Duration::from_secs(2), TIMEOUT)
}

#[test]
#[ignore = "long"]
fn one_that_is_never_ready_is_no_watchdog() {
    for (script, words) in [
        ("exit 2", "the watchdog cannot stop this arm"),
        ("echo cannot; cat", "the watchdog cannot stop this arm"),
        ("exec sleep 600", "the watchdog was not ready after 2 s"),
    ] {
        let begun = Instant::now();
        let why = played(script).map(drop).unwrap_err();
        assert!(
            why.starts_with(words) && why.ends_with("nothing is moved"),
            "{why}"
        );
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "it waited for `{script}`"
        );
    }
}

#[test]
fn it_hears_each_line_and_that_they_end() {
    let folder = tempfile::tempdir().unwrap();
    let heard = folder.path().join("heard");
    let script = format!("echo ready; tee '{}'; echo end >> '{0}'", heard.display());
    let mut process = played(&script).unwrap();
    process.watch().unwrap();
    process.beat().unwrap();
    process.rest();
    drop(process);
    // The client waits until the child exits, which is after the end of its input.
    let heard = std::fs::read_to_string(heard).unwrap();
    assert_eq!(heard, "beat\nbeat\nrest\nend\n");
}

#[test]
#[ignore = "long"]
fn one_that_goes_on_with_stopping_the_arm_is_left_to_it() {
    let process = played("echo ready; exec sleep 60").unwrap();
    let begun = Instant::now();
    drop(process);
    assert!(begun.elapsed() < Duration::from_secs(50));
}

#[test]
fn one_that_is_gone_or_has_stopped_the_arm_ends_the_motion() {
    let ended = |script: &str| {
        let mut process = played(script).unwrap();
        let begun = Instant::now();
        loop {
            match process.beat() {
                Err(why) => return why,
                Ok(()) if begun.elapsed() > Duration::from_secs(60) => {
                    panic!("`{script}` is heard")
                }
                Ok(()) => thread::sleep(Duration::from_millis(5)),
            }
        }
    };
    assert!(ended("echo ready; exec 0<&-; exit 0").starts_with("the watchdog is gone"));
    let why = ended("echo ready; read line; echo 'stopped: it woke up'; cat");
    assert_eq!(why, "the watchdog says: stopped: it woke up");
    // It says more than it was asked, and something else.
    for script in [
        "echo ready; echo beat; cat",
        "echo ready; while read line; do echo rest; done",
    ] {
        let why = ended(script);
        assert!(why.starts_with("the watchdog says: "), "{why}");
    }
}

/// Neither a program that reads and does not answer, nor one that does not read, delays a heartbeat.
#[test]
#[ignore = "long"]
fn one_that_hangs_is_noticed_and_blocks_nothing() {
    for script in ["echo ready; cat > /dev/null", "echo ready; exec sleep 60"] {
        let mut process = played(script).unwrap();
        let why = process.watch().unwrap_err();
        assert!(
            why.starts_with("the watchdog has not acknowledged `beat` within 2s"),
            "{why}"
        );
        let mut process =
            played(&script.replace("ready;", "ready; read line; echo $line;")).unwrap();
        process.watch().unwrap();
        let (begun, mut longest) = (Instant::now(), Duration::ZERO);
        let why = loop {
            let sent = Instant::now();
            let beat = process.beat();
            longest = longest.max(sent.elapsed());
            match beat {
                Err(why) => break why,
                Ok(()) => thread::sleep(Duration::from_millis(150)),
            }
        };
        assert_eq!(why, "the watchdog has not acknowledged `beat` within 2s");
        assert!(longest < TIMEOUT, "a heartbeat took {longest:?}");
        assert!(begun.elapsed() >= TIMEOUT);
    }
}

#[test]
fn a_stop_is_acknowledged_or_told_as_not() {
    for (script, expected) in [
        (
            format!("echo ready; read line; echo beat; read line; echo '{STOPPED}'"),
            Ok(()),
        ),
        (
            "echo ready; read line; echo beat; read line; echo 'not stopped: no answer'".to_owned(),
            Err("not stopped: no answer".to_owned()),
        ),
        (
            "echo ready; read line; echo beat".to_owned(),
            Err("it is gone".to_owned()),
        ),
    ] {
        let mut process = played(&script).unwrap();
        process.watch().unwrap();
        assert_eq!(process.stop(), expected, "{script}");
    }
    // It stopped the arm by itself, and said so before it was asked.
    let mut process = played(&format!("echo ready; read line; echo '{STOPPED}'")).unwrap();
    assert_eq!(
        process.watch(),
        Err(format!("the watchdog says: {STOPPED}"))
    );
    assert_eq!(process.stop(), Ok(()));
}
