//! Which requests are answered, which clients are disconnected, and how a server ends.

#![allow(clippy::unwrap_used)]

use axum::Router;
use axum::body::Bytes;
use axum::routing::{get, post};
use fab_base::interrupt::Interrupt;
use fab_local_server::{Limits, ServeError, serve};
use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::mpsc;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// A server that ends with the test.
struct Server {
    address: SocketAddr,
    interrupt: Interrupt,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    /// Serves a page at `/`, a long one at `/long`, and the length of what is posted to `/length`.
    fn start(limits: Limits) -> Server {
        let router = Router::new()
            .route("/", get(async || "a page"))
            .route("/long", get(async || "a".repeat(64 << 20)))
            .route("/length", post(async |body: Bytes| body.len().to_string()));
        let interrupt = Interrupt::default();
        let (ready, address) = mpsc::channel();
        let raised = interrupt.clone();
        let thread = thread::spawn(move || {
            let mut ready = |address| ready.send(address).unwrap();
            serve(router, 0, &limits, &raised, &mut ready).unwrap();
        });
        Server {
            address: address.recv().unwrap(),
            interrupt,
            thread: Some(thread),
        }
    }

    /// Sends raw bytes; returns what comes until the connection ends.
    fn exchange(&self, request: &str) -> String {
        let mut stream = TcpStream::connect(self.address).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer
    }

    /// Asks for the page with these lines of a head.
    fn ask(&self, lines: &[&str]) -> String {
        let lines = lines.join("\r\n");
        self.exchange(&format!(
            "GET / HTTP/1.1\r\nConnection: close\r\n{lines}\r\n\r\n"
        ))
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.interrupt.raise();
        self.thread.take().unwrap().join().unwrap();
    }
}

/// Limits that a test can wait for.
fn short() -> Limits {
    Limits {
        head: Duration::from_millis(300),
        stall: Duration::from_millis(300),
        last: Duration::from_millis(300),
        ..Limits::default()
    }
}

#[test]
fn requests_of_this_machine_are_answered() {
    let server = Server::start(Limits::default());
    for lines in [
        ["Host: 127.0.0.1", "Accept: */*"],
        ["Host: LocalHost:8642", "Origin: http://localhost:3000"],
        ["Host: [::1]:1", "Origin: https://127.0.0.1"],
        ["host: localhost", "origin: http://[::1]:80"],
    ] {
        let answer = server.ask(&lines);
        assert!(answer.starts_with("HTTP/1.1 200 OK"), "{lines:?}: {answer}");
        assert!(answer.ends_with("a page"), "{lines:?}: {answer}");
    }
    let body = "POST /length HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nContent-Length: 5\r\n\r\n12345";
    assert!(server.exchange(body).ends_with("\r\n\r\n5"));
}

#[test]
fn a_host_that_is_not_this_machine_is_refused_although_its_name_resolves_to_it() {
    let server = Server::start(Limits::default());
    for host in [
        "example.org",
        "example.org:8642",
        "localhost.example.org",
        "127.0.0.1.example.org",
        "localhost@example.org",
        "0.0.0.0",
        "",
    ] {
        let answer = server.ask(&[&format!("Host: {host}")]);
        assert!(answer.starts_with("HTTP/1.1 403"), "{host}: {answer}");
        assert!(answer.contains("`Host`"), "{host}: {answer}");
    }
    for lines in [&[][..], &["Host: 127.0.0.1", "Host: example.org"]] {
        let answer = server.ask(lines);
        assert!(answer.starts_with("HTTP/1.1 403"), "{lines:?}: {answer}");
    }
}

#[test]
fn a_page_of_another_site_is_refused() {
    let server = Server::start(Limits::default());
    for origin in [
        "https://example.org",
        "http://localhost.example.org",
        "null",
        "file://",
        "chrome-extension://localhost",
        "localhost",
        "",
    ] {
        let answer = server.ask(&["Host: localhost", &format!("Origin: {origin}")]);
        assert!(answer.starts_with("HTTP/1.1 403"), "{origin}: {answer}");
        assert!(answer.contains("`Origin`"), "{origin}: {answer}");
    }
}

#[test]
fn clients_that_stall_are_disconnected() {
    let server = Server::start(short());
    let head = "POST /length HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9\r\n\r\n";
    for (sent, expected) in [
        (String::new(), ""),
        ("GET / HTTP/1.1\r\nHost: ".to_owned(), ""),
        (format!("{head}{{"), "HTTP/1.1 400"),
    ] {
        let begun = Instant::now();
        let answer = server.exchange(&sent);
        assert!(answer.starts_with(expected), "{sent:?}: {answer}");
        assert_eq!(answer.is_empty(), expected.is_empty(), "{sent:?}: {answer}");
        assert!(begun.elapsed() < Duration::from_secs(20), "{sent:?}");
    }
    // It asks for a long page, and reads nothing of it for a while.
    let mut deaf = TcpStream::connect(server.address).unwrap();
    deaf.write_all(b"GET /long HTTP/1.1\r\nHost: localhost\r\n\r\n")
        .unwrap();
    thread::sleep(Duration::from_secs(1));
    let mut page = Vec::new();
    // It may end in an error, since the server gave it up.
    let _ = deaf.read_to_end(&mut page);
    assert!(page.len() < 64 << 20, "{}", page.len());
}

#[test]
fn clients_that_hang_give_their_places_to_others() {
    let server = Server::start(Limits {
        connections: 4,
        ..short()
    });
    let connect = |_| TcpStream::connect(server.address).unwrap();
    let hanging: Vec<TcpStream> = (0..8).map(connect).collect();
    assert!(server.ask(&["Host: localhost"]).ends_with("a page"));
    drop(hanging);
}

#[test]
fn a_server_ends_although_a_client_hangs_and_its_port_is_free_again() {
    let server = Server::start(short());
    let address = server.address;
    let mut hanging = TcpStream::connect(address).unwrap();
    hanging.write_all(b"GET / HTTP/1.1\r\n").unwrap();
    let taken = serve(
        Router::new(),
        address.port(),
        &short(),
        &Interrupt::default(),
        &mut |_| {},
    );
    assert!(matches!(taken, Err(ServeError::NoPort { .. })), "{taken:?}");
    drop(server);
    assert!(
        TcpStream::connect(address).is_err(),
        "nobody listens any more"
    );
}
