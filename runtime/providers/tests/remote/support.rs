//! A listener that breaks rules, and a test double that records reports.

use fab_base::interrupt::Interrupt;
use fab_model::calls::{Billing, Call, CallEnd, CallRefused, Calls, FailedCall, Fault, Usd};
use fab_model::{Message, ModelRole, Request, Speaker};
use fab_providers::catalogue::Price;
use fab_providers::remote::{Answers, BaseUrl, Gate, Key, Remote, Retry, Settings, Shared, Wire};
pub use fab_test_provider::{Provider, Question, Response};
use std::io::Write;
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

/// The key that must never appear again.
pub const CANARY: &str = "sk-canary_0123456789.abc";

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
                if Question::read(&mut stream).is_some() {
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
    Response::status(status)
}

/// Ten nano-dollars a token.
const PRICE: Price = Price {
    input: 0.01,
    output: 0.01,
    ..Price::FREE
};

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
            return Err(CallRefused::Budget("no more calls".to_owned()));
        }
        self.told.push(Told::Begin {
            model: call.model.to_owned(),
            key: call.key.to_owned(),
            number: call.number,
            at_most: call.at_most,
        });
        Ok(())
    }

    fn end(&mut self, end: CallEnd<'_>) -> Result<(), CallRefused> {
        self.told.push(match end {
            Ok(reply) => Told::Answered {
                text: reply.text.clone(),
                cost: reply.cost,
            },
            Err(failed) => Told::Failed(failed.clone()),
        });
        Ok(())
    }
}

/// A model under test, which is asked again at once.
pub struct Trial {
    pub settings: Settings,
    pub shared: Shared,
}

impl Trial {
    pub fn of(url: &str) -> Trial {
        let base = BaseUrl::parse(url.trim_end_matches("/v1")).unwrap();
        let settings = Settings {
            key: Some(Key::new("A_KEY", CANARY).unwrap()),
            timeout: Duration::from_secs(20),
            retry: Retry {
                first_wait: Duration::ZERO,
                longest_wait: Duration::ZERO,
                ..Retry::default()
            },
            price: Some(PRICE),
            ..Settings::new("provider", "a-model", Wire::OpenaiChat, base)
        };
        let shared = Shared {
            tell: Arc::new(|_| {}),
            gate: Arc::new(Gate::new(4)),
            answers: Arc::new(Answers::none()),
            interrupt: Interrupt::default(),
            hidden: Vec::new(),
        };
        Trial { settings, shared }
    }

    pub fn model(&self) -> Remote {
        Remote::new(self.settings.clone(), self.shared.clone()).unwrap()
    }
}

/// Estimated at two tokens, so ten are the most that it takes, for 100 nano-dollars.
pub fn request() -> Request {
    let messages = vec![Message::text(Speaker::User, "fold it")];
    Request {
        max_tokens: Some(4),
        ..Request::new(ModelRole::Text, messages)
    }
}
