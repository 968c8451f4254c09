//! Unit tests of `child`.

use super::*;
use serde_json::{Value, json};

const SOON: Duration = Duration::from_secs(20);

fn shell(script: &str) -> CommandLine {
    CommandLine::parse(&format!(
        "sh -c {}",
        shlex::try_quote(script).expect("no NUL")
    ))
    .expect("a command line")
}

fn asked(script: &str, limit: Duration) -> Result<Value, ChildError> {
    let mut child = Child::start(&shell(script), None)?;
    child.ask(&json!({ "do": "hello" }), limit, &Interrupt::default())
}

#[test]
fn command_lines_are_split_as_a_shell_does() {
    let command = CommandLine::parse("python3 'my policy.py' --rate=0.5").expect("words");
    assert_eq!(command.words, ["python3", "my policy.py", "--rate=0.5"]);
    assert!(CommandLine::parse("python3 'x").is_err());
    assert!(CommandLine::parse("  ").is_err());
}

#[test]
fn questions_are_answered_one_by_one() {
    let mut child = Child::start(&shell("cat"), None).expect("a child");
    for number in 0..3 {
        let answer: Value = child
            .ask(&json!([number]), SOON, &Interrupt::default())
            .expect("an answer");
        assert_eq!(answer, json!([number]));
    }
}

#[test]
fn whatever_a_program_does_is_named() {
    for (script, words) in [
        (
            "echo oh dear >&2; exit 3",
            "ended before it answered (exit status: 3); its stderr ends with: oh dear",
        ),
        ("kill -9 $$", "ended before it answered (signal: 9"),
        (
            "printf '{\"pick\": '",
            "ended in the middle of the line `{\"pick\":`",
        ),
        (
            "echo hello",
            "wrote `hello`, which is not a valid answer: expected value",
        ),
        ("exec 1>&-; sleep 60", "it closed its stdout and went on"),
        (
            "yes x | tr -d '\\n'",
            "wrote 1048576 bytes without a newline",
        ),
    ] {
        // A line before the question would be another fault.
        let script = format!("read _; {script}");
        let error = asked(&script, SOON).expect_err(&script).to_string();
        assert!(error.contains(words), "{script}: {error}");
    }
    let absent = CommandLine::parse("/nowhere/at/all").expect("a word");
    let error = Child::start(&absent, None).expect_err("no such program");
    assert!(error.to_string().contains("cannot be started"), "{error}");
}

#[test]
fn a_second_line_is_refused_when_the_next_question_comes() {
    let mut child =
        Child::start(&shell("read a; echo 1; echo 2; read b; echo 3"), None).expect("a child");
    let quiet = Interrupt::default();
    assert_eq!(child.ask::<u32>(&1, SOON, &quiet), Ok(1));
    thread::sleep(Duration::from_millis(300));
    let error = child
        .ask::<u32>(&2, SOON, &quiet)
        .expect_err("an unexpected line");
    assert!(error.to_string().contains("unexpected line"), "{error}");
}

#[test]
fn what_hangs_is_ended_with_all_that_it_started() {
    let folder = tempfile::tempdir().expect("a folder");
    let pid = folder.path().join("pid");
    let script = format!("sleep 600 & echo $! > {}; wait", pid.display());
    let error = asked(&script, Duration::from_secs(1)).expect_err("silence");
    assert!(
        error.to_string().contains("did not answer within 1 s"),
        "{error}"
    );
    let pid = std::fs::read_to_string(pid).expect("a process");
    let raw: u32 = pid.trim().parse().expect("a number");
    thread::sleep(Duration::from_millis(200));
    let stat = std::fs::read_to_string(format!("/proc/{raw}/stat")).unwrap_or_default();
    assert!(
        stat.is_empty() || stat.contains(") Z "),
        "it still runs: {stat}"
    );
}

#[test]
fn an_interrupt_ends_the_wait() {
    let interrupt = Interrupt::default();
    interrupt.raise();
    let mut child = Child::start(&shell("sleep 600"), None).expect("a child");
    let error = child
        .ask::<Value>(&1, SOON, &interrupt)
        .expect_err("an interrupt");
    assert_eq!(error, ChildError::Interrupted);
}

#[test]
fn stderr_is_kept_up_to_its_limit() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("stderr.txt");
    let script = shell("head -c 3000000 /dev/zero | tr '\\0' x >&2; read a; echo 1");
    let mut child = Child::start(&script, Some(&path)).expect("a child");
    assert_eq!(child.ask::<u32>(&1, SOON, &Interrupt::default()), Ok(1));
    drop(child);
    assert_eq!(
        path.metadata().expect("the file").len(),
        MAX_STDERR_BYTES as u64
    );
}
