//! A provider of models for tests: an OpenAI-compatible server on this machine that counts its questions and fails on request.
//!
//! In: a function from each question to a response, a list of responses, or a model. Out: the address for `--base-url`,
//! and the questions as they arrived. A connection carries one question. Nothing here checks what a client sends.

#![allow(clippy::unwrap_used)]

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use fab_model::calls::{Budget, Ledger};
use fab_model::{Message, Model, ModelRole, Part, Png, Request};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{self, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

/// A running provider; it ends when it is dropped.
pub struct Provider {
    address: SocketAddr,
    base_url: String,
    state: Arc<State>,
}

#[derive(Default)]
struct State {
    questions: Mutex<Vec<Question>>,
    answered: AtomicUsize,
    is_over: AtomicBool,
}

type Script = dyn Fn(usize, &Question) -> Response + Send + Sync;

impl Provider {
    /// Starts a provider on a free port.
    ///
    /// - `script`: makes the response to a question and its number, from 0. Requests with GET are no questions: they get a
    ///   list of one model, `geometric`.
    pub fn start(
        script: impl Fn(usize, &Question) -> Response + Send + Sync + 'static,
    ) -> Provider {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let state: Arc<State> = Arc::default();
        let (script, shared): (Arc<Script>, _) = (Arc::new(script), Arc::clone(&state));
        thread::spawn(move || {
            for stream in listener.incoming().map_while(Result::ok) {
                if shared.is_over.load(Ordering::SeqCst) {
                    return;
                }
                let (script, state) = (Arc::clone(&script), Arc::clone(&shared));
                // An error means that the client left.
                thread::spawn(move || respond(stream, &*script, &state).ok());
            }
        });
        Provider {
            address,
            base_url: format!("http://{address}/v1"),
            state,
        }
    }

    /// Starts one that plays responses in order and repeats the last one.
    pub fn playing(responses: Vec<Response>) -> Provider {
        Provider::start(move |number, _| responses[number.min(responses.len() - 1)].clone())
    }

    /// Starts one whose questions a model answers.
    pub fn of(model: impl Model + 'static) -> Provider {
        Provider::start(move |_, question| question.answer_of(&model))
    }

    /// Returns the address for `--base-url`, which ends in `/v1`.
    pub fn base_url(&self) -> &str {
        &self.base_url
    }

    /// Returns the questions so far, oldest first.
    pub fn questions(&self) -> Vec<Question> {
        self.state.questions.lock().unwrap().clone()
    }

    /// Returns how many questions there were so far.
    pub fn calls(&self) -> usize {
        self.state.questions.lock().unwrap().len()
    }

    /// Returns how many responses were made so far.
    pub fn answered(&self) -> usize {
        self.state.answered.load(Ordering::SeqCst)
    }

    /// Returns how often each body arrived.
    pub fn counts(&self) -> BTreeMap<Vec<u8>, usize> {
        let mut counts = BTreeMap::new();
        for question in self.questions() {
            *counts.entry(question.body).or_default() += 1;
        }
        counts
    }
}

impl Drop for Provider {
    fn drop(&mut self) {
        self.state.is_over.store(true, Ordering::SeqCst);
        // Wakes the thread that accepts connections.
        let _ = TcpStream::connect(self.address);
    }
}

fn respond(mut stream: TcpStream, script: &Script, state: &State) -> io::Result<()> {
    let Some(question) = Question::read(&mut stream) else {
        return Ok(());
    };
    if question.method == "GET" {
        let models = json!({ "data": [{ "id": "geometric" }] });
        return Response::status(200).json(models).write(&mut stream);
    }
    let mut questions = state.questions.lock().unwrap();
    let number = questions.len();
    questions.push(question.clone());
    drop(questions);
    let response = script(number, &question);
    state.answered.fetch_add(1, Ordering::SeqCst);
    response.write(&mut stream)
}

/// A request as it arrived.
#[derive(Clone, Debug)]
pub struct Question {
    /// The method, such as `POST`.
    pub method: String,
    /// The path, such as `/v1/chat/completions`.
    pub path: String,
    /// The headers, by their names in lower case.
    pub headers: BTreeMap<String, String>,
    /// The body.
    pub body: Vec<u8>,
}

impl Question {
    /// Reads a request; `None` if the connection ends first, or carries something else.
    pub fn read(stream: &mut impl Read) -> Option<Question> {
        let (mut bytes, mut piece) = (Vec::new(), [0; 16 << 10]);
        loop {
            let count = stream.read(&mut piece).ok().filter(|count| *count > 0)?;
            bytes.extend_from_slice(&piece[..count]);
            let mut headers = [httparse::EMPTY_HEADER; 64];
            let mut head = httparse::Request::new(&mut headers);
            let httparse::Status::Complete(start) = head.parse(&bytes).ok()? else {
                continue;
            };
            let text = |header: &httparse::Header<'_>| {
                let value = String::from_utf8_lossy(header.value).into_owned();
                (header.name.to_lowercase(), value)
            };
            let mut question = Question {
                method: head.method?.to_owned(),
                path: head.path?.to_owned(),
                headers: head.headers.iter().map(text).collect(),
                body: Vec::new(),
            };
            let length = question.headers.get("content-length");
            let end = start + length.map_or(Ok(0), |length| length.parse()).ok()?;
            if bytes.len() >= end {
                question.body = bytes[start..end].to_vec();
                return Some(question);
            }
        }
    }

    /// Parses the body.
    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap()
    }

    /// Lets a model answer a question of Chat Completions from its messages and schema; four letters count a token, and
    /// a picture 59. A failure is an error with status 400.
    pub fn answer_of(&self, model: &dyn Model) -> Response {
        let body = self.json();
        let messages = body["messages"].as_array().unwrap();
        let messages: Vec<Message> = messages.iter().map(message).collect();
        let (mut role, mut input) = (ModelRole::Text, 0);
        for part in messages.iter().flat_map(|message| &message.parts) {
            match part {
                Part::Text(text) => input += text.len().div_ceil(4),
                Part::Image(_) => (role, input) = (ModelRole::Vision, input + 59),
            }
        }
        let mut request = Request::new(role, messages);
        request.schema = body.pointer("/response_format/json_schema/schema").cloned();
        match model.ask(&request, &mut Ledger::unwritten(&Budget::default())) {
            Ok(reply) => Response::answer(&reply.text, input, reply.text.len().div_ceil(4)),
            Err(error) => Response::error(400, "invalid_request_error", &error.to_string()),
        }
    }
}

fn message(turn: &Value) -> Message {
    let part = |part: &Value| match part["image_url"]["url"].as_str() {
        Some(url) => Part::Image(Png::new(
            STANDARD.decode(url.split_once(',').unwrap().1).unwrap(),
        )),
        None => Part::Text(part["text"].as_str().unwrap().to_owned()),
    };
    Message {
        speaker: serde_json::from_value(turn["role"].clone()).unwrap(),
        parts: match &turn["content"] {
            Value::Array(parts) => parts.iter().map(part).collect(),
            text => vec![Part::Text(text.as_str().unwrap().to_owned())],
        },
    }
}

/// What a question gets.
#[derive(Clone, Debug)]
pub struct Response {
    status: u16,
    headers: Vec<(&'static str, String)>,
    body: String,
    delay: Duration,
    is_cut: bool,
}

impl Response {
    /// Makes a response without a body.
    pub fn status(status: u16) -> Response {
        Response {
            status,
            headers: Vec::new(),
            body: String::new(),
            delay: Duration::ZERO,
            is_cut: false,
        }
    }

    /// Makes an answer in the form of Chat Completions, with the tokens that it counts in and out.
    pub fn answer(text: &str, input: usize, output: usize) -> Response {
        let message = json!({ "role": "assistant", "content": text });
        Response::status(200).json(json!({
            "id": "chatcmpl-1", "object": "chat.completion", "created": 0, "model": "geometric",
            "choices": [{ "index": 0, "finish_reason": "stop", "message": message }],
            "usage": { "prompt_tokens": input, "completion_tokens": output, "total_tokens": input + output },
        }))
    }

    /// Makes an error as OpenAI words it.
    pub fn error(status: u16, kind: &str, message: &str) -> Response {
        let error = json!({ "type": kind, "code": kind, "message": message });
        Response::status(status).json(json!({ "error": error }))
    }

    /// Sets the body, and declares it as JSON.
    pub fn json(mut self, body: impl ToString) -> Response {
        self.body = body.to_string();
        self.header("content-type", "application/json")
    }

    /// Adds a header.
    pub fn header(mut self, name: &'static str, value: impl Into<String>) -> Response {
        self.headers.push((name, value.into()));
        self
    }

    /// Waits before anything is sent.
    pub fn delay(self, delay: Duration) -> Response {
        Response { delay, ..self }
    }

    /// Ends the connection in the middle of the body.
    pub fn cut(self) -> Response {
        Response {
            is_cut: true,
            ..self
        }
    }

    /// Edits the body's JSON.
    pub fn edit(mut self, edit: impl FnOnce(&mut Value)) -> Response {
        let mut body = serde_json::from_str(&self.body).unwrap();
        edit(&mut body);
        self.body = body.to_string();
        self
    }

    fn write(&self, stream: &mut TcpStream) -> io::Result<()> {
        thread::sleep(self.delay);
        let mut head = format!("HTTP/1.1 {} Played\r\nconnection: close\r\n", self.status);
        for (name, value) in &self.headers {
            head += &format!("{name}: {value}\r\n");
        }
        let length = self.body.len();
        let sent = if self.is_cut { length / 2 } else { length };
        stream.write_all(format!("{head}content-length: {length}\r\n\r\n").as_bytes())?;
        stream.write_all(&self.body.as_bytes()[..sent])
    }
}
