//! A server for tests, and plain HTTP to talk to it.

use fab_base::interrupt::Interrupt;
use fab_model::Model;
use serde_json::Value;
use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::{Arc, mpsc};
use std::thread::JoinHandle;

/// A server that stops with the test.
pub struct Server {
    pub address: SocketAddr,
    interrupt: Interrupt,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    pub fn of(model: Arc<dyn Model>) -> Server {
        let interrupt = Interrupt::default();
        let (ready, address) = mpsc::channel();
        let raised = interrupt.clone();
        let thread = std::thread::spawn(move || {
            let mut ready = |address| ready.send(address).unwrap();
            fab_providers::serve::serve(model, 0, &raised, &mut ready).unwrap();
        });
        Server {
            address: address.recv().unwrap(),
            interrupt,
            thread: Some(thread),
        }
    }

    pub fn post(&self, path: &str, body: &Value) -> (u16, Value) {
        send(self.address, "POST", path, &body.to_string())
    }

    pub fn get(&self, path: &str) -> (u16, Value) {
        send(self.address, "GET", path, "")
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.interrupt.raise();
        self.thread.take().unwrap().join().unwrap();
    }
}

/// Sends one request on its own connection; returns status and body.
pub fn send(address: SocketAddr, method: &str, path: &str, body: &str) -> (u16, Value) {
    let length = body.len();
    let head = format!(
        "{method} {path} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\nContent-Type: application/json\r\nContent-Length: {length}\r\n\r\n"
    );
    exchange(address, (head + body).as_bytes())
}

/// Sends raw bytes; returns status and body.
pub fn exchange(address: SocketAddr, bytes: &[u8]) -> (u16, Value) {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.write_all(bytes).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    let (head, body) = answer.split_once("\r\n\r\n").unwrap();
    let status = head.split(' ').nth(1).unwrap().parse().unwrap();
    (status, serde_json::from_str(body).unwrap())
}

/// Asks for a stream; returns the head of the answer and its lines.
pub fn stream(address: SocketAddr, path: &str, body: &Value) -> (String, Vec<String>) {
    stream_with(address, path, "", body)
}

/// Asks for a stream with further header lines.
pub fn stream_with(
    address: SocketAddr,
    path: &str,
    more: &str,
    body: &Value,
) -> (String, Vec<String>) {
    let body = body.to_string();
    let length = body.len();
    // Under HTTP/1.0 the events come as they are, without the lengths of chunks.
    let head = format!(
        "POST {path} HTTP/1.0\r\nHost: {address}\r\n{more}Content-Type: application/json\r\nContent-Length: {length}\r\n\r\n"
    );
    let mut stream = TcpStream::connect(address).unwrap();
    stream.write_all((head + &body).as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    let (head, body) = answer.split_once("\r\n\r\n").unwrap();
    (
        head.to_owned(),
        body.split('\n').map(str::to_owned).collect(),
    )
}
