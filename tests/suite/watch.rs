//! `--watch`: a verb runs again after each change of a file that it used, and Ctrl-C ends it.
#![cfg(unix)]

use super::support::{bring_library, fabc, finish, interrupt, root};
use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// How long a test waits for expected output; only a failing test takes that long.
const PATIENCE: Duration = Duration::from_secs(60);

/// A watching command and its output so far.
struct Watching {
    child: Child,
    said: Arc<Mutex<String>>,
}

impl Watching {
    fn begin(folder: &Path, arguments: &[&str]) -> Watching {
        let mut command = fabc(folder);
        command.args(arguments);
        let mut child = command
            .process()
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let said = Arc::new(Mutex::new(String::new()));
        let outputs: [Box<dyn Read + Send>; 2] = [
            Box::new(child.stdout.take().unwrap()),
            Box::new(child.stderr.take().unwrap()),
        ];
        for mut output in outputs {
            let said = Arc::clone(&said);
            std::thread::spawn(move || {
                let mut bytes = [0; 4096];
                while let Ok(count @ 1..) = output.read(&mut bytes) {
                    let text = String::from_utf8_lossy(&bytes[..count]);
                    said.lock().unwrap().push_str(&text);
                }
            });
        }
        Watching { child, said }
    }

    /// Waits until the output contains a text a number of times.
    fn until(&self, words: &str, times: usize) {
        let begun = Instant::now();
        while self.said.lock().unwrap().matches(words).count() < times {
            let said = self.said.lock().unwrap().clone();
            assert!(
                begun.elapsed() < PATIENCE,
                "no {times} of `{words}` in:\n{said}"
            );
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    fn count(&self, words: &str) -> usize {
        self.said.lock().unwrap().matches(words).count()
    }

    /// Presses Ctrl-C and returns the exit code.
    fn interrupt(mut self) -> Option<i32> {
        interrupt(self.child.id());
        self.child.wait().unwrap().code()
    }
}

impl Drop for Watching {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn bring_task(folder: &Path) {
    bring_library(folder);
    let text = fs::read_to_string(root().join("tasks/house.fab")).unwrap();
    fs::write(folder.join("house.fab"), text).unwrap();
}

#[test]
fn check_runs_again_after_each_change_of_the_task_and_of_what_it_uses() {
    let folder = tempfile::tempdir().unwrap();
    bring_task(folder.path());
    let watching = Watching::begin(folder.path(), &["check", "house.fab", "--watch"]);
    watching.until("watching 2 files; Ctrl-C ends", 1);
    // The two lines come from two streams.
    watching.until("`house` has no errors", 1);

    let task = folder.path().join("house.fab");
    let text = fs::read_to_string(&task).unwrap();
    fs::write(&task, text.replace("10mm", "10deg")).unwrap();
    watching.until("error[F0203]", 1);
    watching.until("Ctrl-C ends", 2);

    // Editors do this: a new file replaces the old one.
    let other = folder.path().join("house.fab~");
    fs::write(&other, &text).unwrap();
    fs::rename(&other, &task).unwrap();
    watching.until("`house` has no errors", 2);
    watching.until("Ctrl-C ends", 3);

    let library = folder.path().join("lib/folding.fab");
    fs::write(&library, "task folding { }\n").unwrap();
    watching.until("Ctrl-C ends", 4);
    assert_eq!(watching.count("`house` has no errors"), 2);
    assert_eq!(watching.interrupt(), Some(130));
}

#[test]
fn a_file_that_is_not_there_yet_is_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let watching = Watching::begin(folder.path(), &["test", "house.fab", "--watch"]);
    watching.until("watching 0 files; Ctrl-C ends", 1);
    bring_task(folder.path());
    watching.until("0 passed, 0 failed", 2);
    assert_eq!(watching.interrupt(), Some(130));
}

#[test]
fn watching_does_not_go_with_one_json_document() {
    let folder = tempfile::tempdir().unwrap();
    for verb in ["check", "test", "render"] {
        let said = finish(fabc(folder.path()).args([verb, "a.fab", "--watch", "--json"]));
        assert_eq!(said.code, 64, "{}", said.stderr);
    }
}
