//! Tests of `process`.

#![allow(clippy::unwrap_used)]

use super::*;
use std::thread;

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
            why.starts_with("the watchdog does not acknowledge within 2s"),
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
fn a_full_pipe_is_an_error_and_blocks_nothing() {
    let mut command = Command::new("sh");
    command.args(["-c", "echo ready; exec sleep 5"]);
    let mut process = Process::spawn(command, TIMEOUT, Duration::from_secs(600)).unwrap();
    // More than any pipe holds.
    let full = (0..1 << 20).find_map(|_| process.beat().err());
    assert_eq!(
        full.as_deref(),
        Some("the watchdog is gone: its reader does not read")
    );
    let _ = process.child.kill();
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
