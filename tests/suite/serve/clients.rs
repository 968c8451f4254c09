//! Many clients at once: each is answered, and none that hangs keeps the others waiting.

use super::server::{Server, stream};
use super::{CHAT, RESPONSES, changed};
use crate::suite::support::Scripted;
use fab_model::calls::Calls;
use fab_model::{Model, ModelError, ModelKind, Reply, Request};
use serde_json::json;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::{Arc, Condvar, Mutex};
use std::time::{Duration, Instant};

/// Answers as soon as sixteen questions wait for it.
#[derive(Default)]
struct Together {
    waiting: Mutex<usize>,
    all_there: Condvar,
}

impl Model for Together {
    fn name(&self) -> &str {
        "scripted"
    }

    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }

    fn ask(&self, _: &Request, _: &mut dyn Calls) -> Result<Reply, ModelError> {
        let mut waiting = self.waiting.lock().unwrap();
        *waiting += 1;
        self.all_there.notify_all();
        let limit = Duration::from_secs(20);
        let (_waiting, waited) = self
            .all_there
            .wait_timeout_while(waiting, limit, |waiting| *waiting < 16)
            .unwrap();
        assert!(!waited.timed_out());
        Ok(Reply::text("together"))
    }
}

#[test]
fn sixteen_clients_are_answered_at_once_whole_or_streamed() {
    let server = Server::of(Arc::new(Together::default()));
    std::thread::scope(|scope| {
        for client in 0..16 {
            let path = if client % 2 == 0 { CHAT } else { RESPONSES };
            let server = &server;
            scope.spawn(move || match client % 4 {
                0 | 1 => {
                    let (_, lines) =
                        stream(server.address, path, &changed(path, "stream", json!(true)));
                    assert!(lines.join("").contains("together"), "{lines:?}");
                }
                _ => assert_eq!(
                    server.post(path, &changed(path, "user", json!("me"))).0,
                    200
                ),
            });
        }
    });
}

#[test]
fn clients_that_hang_in_any_part_of_a_request_or_a_stream_keep_nobody_waiting() {
    let long = "a".repeat(8 << 20);
    let server = Server::of(Arc::new(Scripted::new(&[long.as_str(), "kept", "kept"])));
    let head = |length: usize| {
        format!(
            "POST {CHAT} HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: {length}\r\n\r\n"
        )
    };
    let body = changed(CHAT, "stream", json!(true)).to_string();
    // It asks for a long stream, and reads only its beginning.
    let mut deaf = TcpStream::connect(server.address).unwrap();
    deaf.write_all((head(body.len()) + &body).as_bytes())
        .unwrap();
    deaf.read_exact(&mut [0; 15]).unwrap();
    let beginnings = [
        String::new(),
        "POST /v1/".to_owned(),
        head(32 << 20),
        head(9) + "{",
        head(32 << 20) + &"[".repeat(5 << 20),
    ];
    let hanging: Vec<TcpStream> = (0..50)
        .map(|client| {
            let mut hanging = TcpStream::connect(server.address).unwrap();
            hanging
                .set_write_timeout(Some(Duration::from_millis(100)))
                .unwrap();
            // Only some of the long bodies find a place; the others are not read to their end.
            let _ = hanging.write_all(beginnings[client % beginnings.len()].as_bytes());
            hanging
        })
        .collect();
    let begun = Instant::now();
    for path in [CHAT, RESPONSES] {
        let (status, answer) = server.post(path, &changed(path, "user", json!("me")));
        assert_eq!(status, 200, "{answer}");
    }
    assert!(
        begun.elapsed() < Duration::from_secs(5),
        "{:?}",
        begun.elapsed()
    );
    drop((deaf, hanging));
}

#[test]
#[ignore = "long"]
fn connections_that_stall_are_closed_in_time() {
    let long = "a".repeat(8 << 20);
    let server = Server::of(Arc::new(Scripted::new(&[long.as_str()])));
    let body = changed(CHAT, "stream", json!(true)).to_string();
    let head = |length: usize| {
        format!(
            "POST {CHAT} HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: {length}\r\n\r\n"
        )
    };
    // What is sent, how long nothing is read, and a part of what came.
    let rows = [
        (String::new(), 0, None),
        ("GET /v1/models HTTP/1.1\r\nHost: ".to_owned(), 0, None),
        (
            head(9) + "{",
            0,
            Some("its next piece has to arrive within 10 s"),
        ),
        (head(body.len()) + &body, 23, Some("text/event-stream")),
    ];
    // Several times what the server waits, so a busy machine does not matter.
    let limit = Duration::from_secs(90);
    std::thread::scope(|scope| {
        for (sent, deaf_s, part) in rows {
            let mut client = TcpStream::connect(server.address).unwrap();
            scope.spawn(move || {
                client.write_all(sent.as_bytes()).unwrap();
                std::thread::sleep(Duration::from_secs(deaf_s));
                client.set_read_timeout(Some(limit)).unwrap();
                let (begun, mut answer) = (Instant::now(), Vec::new());
                // It may end in an error: the server gave up a stream that nobody read.
                let _ = client.read_to_end(&mut answer);
                assert!(begun.elapsed() < limit, "{sent}");
                let answer = String::from_utf8_lossy(&answer);
                match part {
                    Some(part) => assert!(answer.contains(part), "{sent}: {answer:.300}"),
                    None => assert_eq!(answer, "", "{sent}"),
                }
                assert!(!answer.contains("[DONE]"), "{sent}");
            });
        }
    });
}
