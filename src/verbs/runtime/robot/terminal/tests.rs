//! Tests of `terminal`.

use super::*;
use std::io::Write;
use std::sync::mpsc::{Receiver, channel};

/// A stderr that takes nothing until it is released.
struct Halted(Receiver<()>);

impl Write for Halted {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let _ = self.0.recv();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_terminal_that_takes_nothing_holds_up_no_motion() {
    let (release, halted) = channel();
    let io = Io::in_memory().with_stderr(Halted(halted));
    let supervisor = TerminalSupervisor::new(Confirm::None, false, &io);
    let Ok(mut supervisor) = supervisor else {
        panic!("it asks nobody");
    };
    let (sender, done) = channel();
    std::thread::spawn(move || {
        for _ in 0..100 {
            supervisor.note("paused: hold the space bar to go on");
        }
        sender.send(())
    });
    assert_eq!(done.recv_timeout(Duration::from_secs(60)), Ok(()));
    drop(release);
}

#[test]
fn only_a_yes_confirms() {
    for (typed, expected) in [
        ("y\n", true),
        (" YES \n", true),
        ("what\n\nyes", true),
        ("n\ny\n", false),
        ("", false),
        ("perhaps\n", false),
    ] {
        let mut said = Vec::new();
        let mut say = |text: &str| said.push(text.to_owned());
        let mut lines = typed.as_bytes();
        let answer = choose(&mut || line_of(&mut lines), &mut say, "Move?", yes_or_no);
        assert_eq!(answer == Some(true), expected, "{typed:?}");
        assert_eq!(said[0], "Move?");
    }
    let many = "x\n".repeat(ATTEMPTS as usize) + "y\n";
    let mut lines = many.as_bytes();
    let next = &mut || line_of(&mut lines);
    assert_eq!(choose(next, &mut |_| {}, "Move?", yes_or_no), None);
}
