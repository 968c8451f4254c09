//! A scripted provider, and test doubles that record reports and waits.

use axum::body::{Body, Bytes};
use axum::http::{self, HeaderMap, Method, Uri};
use fab_base::interrupt::Interrupt;
use fab_model::calls::{
    Billing, Call, CallEnd, CallRefused, Calls, CapReached, FailedCall, Fault, Usage, Usd,
};
use fab_model::{Message, ModelRole, Request, Speaker};
use fab_providers::remote::{
    Answers, BaseUrl, Gate, Key, Pause, Pricing, Remote, Retry, Settings, Shared, Wire,
};
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

/// The key that must never appear again.
pub const CANARY: &str = "sk-canary/0123456789+abc";

/// A provider that plays replies in order, repeating the last one. It ends when it is dropped.
pub struct Provider {
    url: String,
    received: Arc<Mutex<Vec<Received>>>,
    _runtime: tokio::runtime::Runtime,
}

/// A request as it arrived.
#[derive(Clone)]
pub struct Received {
    pub path: String,
    pub headers: HeaderMap,
    pub body: Bytes,
}

/// A response to play.
#[derive(Clone, Debug)]
pub struct Response {
    status: u16,
    headers: Vec<(&'static str, String)>,
    body: String,
    delay: Duration,
}

impl Response {
    pub fn json(mut self, body: impl ToString) -> Response {
        self.body = body.to_string();
        self.header("content-type", "application/json")
    }

    pub fn header(mut self, name: &'static str, value: impl Into<String>) -> Response {
        self.headers.push((name, value.into()));
        self
    }

    pub fn delay(self, delay: Duration) -> Response {
        Response { delay, ..self }
    }
}

impl Provider {
    pub fn playing(responses: Vec<Response>) -> Provider {
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(1)
            .enable_all()
            .build()
            .unwrap();
        let received: Arc<Mutex<Vec<Received>>> = Arc::default();
        let record = received.clone();
        let answer = move |method: Method, uri: Uri, headers: HeaderMap, body: Bytes| async move {
            // Failures are explained with the list of models, which no answer depends on.
            if method == Method::GET {
                return http::Response::new(Body::from(r#"{"data":[{"id":"a-model"}]}"#));
            }
            let number = {
                let mut record = record.lock().unwrap();
                record.push(Received {
                    path: uri.path().to_owned(),
                    headers,
                    body,
                });
                record.len() - 1
            };
            let response = responses[number.min(responses.len() - 1)].clone();
            tokio::time::sleep(response.delay).await;
            let mut built = http::Response::builder().status(response.status);
            for (name, value) in response.headers {
                built = built.header(name, value);
            }
            built.body(Body::from(response.body)).unwrap()
        };
        let listener = runtime
            .block_on(tokio::net::TcpListener::bind("127.0.0.1:0"))
            .unwrap();
        let url = format!("http://{}", listener.local_addr().unwrap());
        let app = axum::Router::new().fallback(answer);
        runtime.spawn(async { axum::serve(listener, app).await });
        Provider {
            url,
            received,
            _runtime: runtime,
        }
    }

    pub fn url(&self) -> String {
        self.url.clone()
    }

    /// Returns every question received, oldest first.
    pub fn received(&self) -> Vec<Received> {
        self.received.lock().unwrap().clone()
    }
}

/// A listener that runs `act` on each connection after reading its request.
pub struct Rude {
    address: String,
    count: Arc<AtomicUsize>,
}

impl Rude {
    pub fn acting(act: impl Fn(&mut TcpStream) + Send + 'static) -> Rude {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = format!("http://{}", listener.local_addr().unwrap());
        let count = Arc::new(AtomicUsize::new(0));
        let counted = count.clone();
        thread::spawn(move || {
            for stream in listener.incoming() {
                let Ok(mut stream) = stream else { return };
                if read_request(&mut stream) {
                    counted.fetch_add(1, Ordering::SeqCst);
                    act(&mut stream);
                }
            }
        });
        Rude { address, count }
    }

    pub fn url(&self) -> String {
        self.address.clone()
    }

    pub fn count(&self) -> usize {
        self.count.load(Ordering::SeqCst)
    }
}

/// Reads head and body; false if the connection ends earlier.
fn read_request(stream: &mut TcpStream) -> bool {
    let mut bytes = Vec::new();
    let mut chunk = [0; 4096];
    loop {
        let text = String::from_utf8_lossy(&bytes).to_lowercase();
        if let Some(head) = text.find("\r\n\r\n") {
            let length = text[..head].split("content-length: ").nth(1);
            let length = length.and_then(|rest| rest.lines().next()?.trim().parse().ok());
            if bytes.len() >= head + 4 + length.unwrap_or(0) {
                return true;
            }
        }
        match stream.read(&mut chunk) {
            Ok(0) | Err(_) => return false,
            Ok(count) => bytes.extend_from_slice(&chunk[..count]),
        }
    }
}

/// Writes part of a response.
pub fn say(stream: &mut TcpStream, text: &str) {
    // The other side may have disconnected.
    let _ = stream.write_all(text.as_bytes());
}

/// A valid Chat Completions reply.
pub fn good(text: &str) -> Response {
    status(200).json(good_body(text))
}

pub fn good_body(text: &str) -> serde_json::Value {
    serde_json::json!({
        "choices": [{ "finish_reason": "stop", "message": { "role": "assistant", "content": text } }],
        "usage": { "prompt_tokens": 10, "completion_tokens": 5 },
    })
}

pub fn status(status: u16) -> Response {
    Response {
        status,
        headers: Vec::new(),
        body: String::new(),
        delay: Duration::ZERO,
    }
}

/// Skips waits and records them.
#[derive(Debug, Default)]
pub struct Noted(pub Mutex<Vec<Duration>>);

impl Pause for Noted {
    fn pause(&self, wait: Duration, _: &Interrupt) {
        self.0.lock().unwrap().push(wait);
    }
}

/// Ten nano-dollars a token, and a hundred at most.
#[derive(Debug)]
pub struct Prices;

impl Pricing for Prices {
    fn at_most(&self, _: &Request) -> Option<Usd> {
        Some(Usd::from_nano(100))
    }

    fn cost(&self, usage: Usage) -> Option<Usd> {
        Some(Usd::from_nano(
            10 * (usage.input_tokens + usage.output_tokens),
        ))
    }
}

/// A model's report about one message.
#[derive(Clone, Debug, PartialEq)]
pub enum Told {
    Begin {
        model: String,
        key: String,
        number: u32,
        at_most: Option<Usd>,
    },
    Answered {
        text: String,
        cost: Option<Usd>,
    },
    Failed(FailedCall),
}

/// Records reports, and refuses calls after `allowed` ones.
pub struct Notes {
    pub told: Vec<Told>,
    pub allowed: usize,
}

impl Notes {
    pub fn new() -> Notes {
        Notes {
            told: Vec::new(),
            allowed: usize::MAX,
        }
    }

    /// Returns the ends; fails if beginnings and ends do not alternate, or numbers do not count up.
    pub fn ends(&self) -> Vec<Told> {
        let mut ends = Vec::new();
        for (at, pair) in self.told.chunks(2).enumerate() {
            let Told::Begin { number, .. } = &pair[0] else {
                panic!("an end without a beginning: {:?}", self.told);
            };
            assert_eq!(*number as usize, at + 1);
            assert!(
                pair.len() == 2 && !matches!(pair[1], Told::Begin { .. }),
                "{:?}",
                self.told
            );
            ends.push(pair[1].clone());
        }
        ends
    }

    /// Returns faults and billing of the calls that failed.
    pub fn faults(&self) -> Vec<(Fault, Billing)> {
        let ends = self.ends();
        let failed = ends.iter().filter_map(|end| match end {
            Told::Failed(failed) => Some((failed.fault, failed.billing)),
            _ => None,
        });
        failed.collect()
    }
}

impl Calls for Notes {
    fn begin(&mut self, call: &Call<'_>) -> Result<(), CallRefused> {
        if self.ends().len() >= self.allowed {
            return Err(CallRefused::Budget(CapReached {
                why: "no more calls".to_owned(),
                raise: None,
            }));
        }
        self.told.push(Told::Begin {
            model: call.model.to_owned(),
            key: call.key.to_owned(),
            number: call.number,
            at_most: call.at_most,
        });
        Ok(())
    }

    fn end(&mut self, end: &CallEnd<'_>) -> Result<(), CallRefused> {
        self.told.push(match *end {
            CallEnd::Answered(reply) => Told::Answered {
                text: reply.text.clone(),
                cost: reply.cost,
            },
            CallEnd::Failed(failed) => Told::Failed(failed.clone()),
        });
        Ok(())
    }
}

/// A model under test, and its waits.
pub struct Trial {
    pub settings: Settings,
    pub shared: Shared,
    pub waits: Arc<Noted>,
}

impl Trial {
    pub fn of(url: &str) -> Trial {
        let waits = Arc::new(Noted::default());
        let base = BaseUrl::parse(url).unwrap();
        let settings = Settings {
            key: Some(Key::new("A_KEY", CANARY).unwrap()),
            timeout: Duration::from_secs(20),
            retry: Retry {
                seed: Some(5),
                pause: waits.clone(),
                ..Retry::default()
            },
            pricing: Arc::new(Prices),
            ..Settings::new("provider", "a-model", Wire::OpenaiChat, base)
        };
        let shared = Shared {
            tell: Arc::new(|_| {}),
            gate: Arc::new(Gate::new(4)),
            answers: Arc::new(Answers::none()),
            interrupt: Interrupt::default(),
            hidden: Vec::new(),
        };
        Trial {
            settings,
            shared,
            waits,
        }
    }

    pub fn model(&self) -> Remote {
        Remote::new(self.settings.clone(), self.shared.clone()).unwrap()
    }
}

pub fn request() -> Request {
    let messages = vec![Message::text(Speaker::User, "fold it")];
    Request::new(ModelRole::Text, messages)
}
