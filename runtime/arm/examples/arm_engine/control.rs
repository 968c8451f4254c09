//! The socket through which a test talks to the engine, bypassing the node.
//!
//! In: lines of JSON, a request each. Out: a line of JSON each. Connections are served in parallel.

use super::Asked;
use serde_json::{Value, json};
use std::io::{self, BufRead, BufReader, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::Path;
use std::sync::mpsc::{Sender, channel};
use std::thread;

/// Starts listening.
pub fn listen(path: &Path, requests: Sender<Asked>) -> io::Result<()> {
    let listener = UnixListener::bind(path)?;
    thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            let requests = requests.clone();
            // A broken connection means that the test has ended.
            thread::spawn(move || serve(stream, &requests));
        }
    });
    Ok(())
}

fn serve(stream: UnixStream, requests: &Sender<Asked>) -> io::Result<()> {
    let mut answers = stream.try_clone()?;
    for line in BufReader::new(stream).lines() {
        let (sender, replies) = channel();
        let answer: Value = match serde_json::from_str(&line?) {
            Ok(request) => {
                let asked = requests.send(Asked::Test(request, sender));
                asked.map_err(|_| io::ErrorKind::BrokenPipe)?;
                replies.recv().map_err(io::Error::other)?
            }
            Err(error) => json!({ "error": error.to_string() }),
        };
        writeln!(answers, "{answer}")?;
    }
    Ok(())
}
