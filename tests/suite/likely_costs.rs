//! The likely value of `--estimate`, held against a scripted server that bills with its own tokenizer and has answers of
//! its own length.

use super::provider_commands::command;
use super::support::{finish, project};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use fab_standins::Geometric;
use fab_test_provider::{Provider, Question, Response};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::thread;

/// The price of the facts below, USD per token.
const PRICE: [f64; 2] = [2e-6, 10e-6];

const FACTS: &str = "\
[[model]]
provider = \"compatible\"
id = \"geometric\"
vision = true
price = [{ input = 2, output = 10 }]
image_tokens = { patches = { side_px = 28 } }
as_of = \"2026-11-24\"
source = \"a test\"
";

/// How a model answers.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Manner {
    Short,
    WithReasons,
}

/// What the server has billed so far.
#[derive(Clone, Copy, Debug, Default)]
struct Bill {
    calls: u64,
    input: u64,
    output: u64,
}

impl Bill {
    fn cost(self) -> f64 {
        self.input as f64 * PRICE[0] + self.output as f64 * PRICE[1]
    }
}

struct Biller {
    provider: Provider,
    bill: Arc<Mutex<Bill>>,
}

impl Biller {
    fn start(manner: Manner) -> Biller {
        let bill = Arc::new(Mutex::new(Bill::default()));
        let shared = Arc::clone(&bill);
        let provider = Provider::start(move |_, question| billed(question, manner, &shared));
        Biller { provider, bill }
    }

    fn bill(&self) -> Bill {
        *self.bill.lock().unwrap()
    }
}

/// Counts as byte-pair tokenizers roughly do, but by its own rules: spaces join the word after them, long words fall
/// apart after five letters, digits come in pairs, and runs of one sign are one token.
fn tokens(text: &str) -> u64 {
    let (mut count, mut last, mut run) = (0, ' ', 0_u64);
    for c in text.chars() {
        let same = match c {
            c if c.is_alphabetic() => last.is_alphabetic(),
            c if c.is_ascii_digit() => last.is_ascii_digit(),
            c => c == last,
        };
        run = if same { run + 1 } else { 0 };
        count += match c {
            ' ' => 0,
            c if c.is_alphabetic() => u64::from(run == 0 || run > 4 && run % 4 == 0),
            c if c.is_ascii_digit() => u64::from(run % 2 == 0),
            _ => u64::from(run == 0),
        };
        last = c;
    }
    count
}

/// Bills a picture by squares of 32 pixels, a fifth more than their number.
fn picture_tokens(url: &str) -> u64 {
    let png = STANDARD.decode(url.split_once(',').unwrap().1).unwrap();
    let [width, height] = fab_picture::png::size(&png).unwrap();
    let squares = u64::from(width.div_ceil(32)) * u64::from(height.div_ceil(32));
    (squares * 6).div_ceil(5)
}

/// Bills all texts and pictures of a request.
fn input_tokens(value: &Value) -> u64 {
    match value {
        Value::String(text) if text.starts_with("data:") => picture_tokens(text),
        Value::String(text) => tokens(text),
        Value::Array(values) => values.iter().map(input_tokens).sum(),
        Value::Object(fields) => fields
            .iter()
            .filter(|(name, _)| {
                ["messages", "content", "text", "image_url", "url"].contains(&name.as_str())
            })
            .map(|(_, value)| input_tokens(value))
            .sum(),
        _ => 0,
    }
}

const REASONS: &str = "The picture shows the cloth from above, and its corners can be told apart. The fold has to bring \
    one of them over the middle. A short way keeps the rest of the cloth where it lies. With this in mind, and after a \
    look at every one of the offered choices, the answer is as follows.";

fn billed(question: &Question, manner: Manner, bill: &Mutex<Bill>) -> Response {
    let input = input_tokens(&question.json()) + 8;
    question.answer_of(&Geometric).edit(|reply| {
        let content = &mut reply["choices"][0]["message"]["content"];
        if manner == Manner::WithReasons {
            *content = json!(format!("{REASONS}\n\n{}", content.as_str().unwrap()));
        }
        let visible = tokens(content.as_str().unwrap());
        let mut bill = bill.lock().unwrap();
        bill.calls += 1;
        bill.input += input;
        bill.output += visible;
        let usage = json!({ "prompt_tokens": input, "completion_tokens": visible });
        reply["usage"] = usage;
    })
}

/// Plays or estimates a suite; returns what it prints.
fn bench(folder: &Path, suite: &str, biller: &Biller, more: &[&str]) -> String {
    let arguments = [
        "bench",
        suite,
        "--model",
        "compatible:geometric",
        "--models",
        "facts.toml",
        "--base-url",
        biller.provider.base_url(),
        "--no-cache",
        "--json",
    ];
    let said = finish(&mut command(folder, &[&arguments, more].concat()));
    assert_eq!(said.code, 0, "{suite}: {}{}", said.stdout, said.stderr);
    said.stdout
}

fn likely(folder: &Path, suite: &str, biller: &Biller) -> [f64; 4] {
    let estimate = bench(folder, suite, biller, &["--estimate"]);
    let estimate: Value = serde_json::from_str(&estimate).unwrap();
    let of = |part: &str| estimate["likely"][part].as_f64().unwrap();
    [
        of("calls"),
        of("input_tokens"),
        of("output_tokens"),
        of("cost_nano_usd") / 1e9,
    ]
}

/// Six suites: the task, its variant, and its starts.
const SUITES: [(&str, &str, &str); 6] = [
    ("double_straight", "", FLAT),
    ("double_straight", "variant = \"in_context\"", FLAT),
    ("double_triangle", "", FLAT),
    ("double_triangle", "variant = \"in_context\"", FLAT),
    ("smoothing", "", CRUMPLED),
    ("smoothing", "variant = \"paper_text\"", CRUMPLED),
];

const FLAT: &str = "[starts]\nlie = \"flat\"\nsides = [28, 30]\nturns_deg = [0]";
const CRUMPLED: &str =
    "horizons = [3]\n[starts]\nlie = \"crumpled\"\nsides = [25]\ncount = 2\nfirst_seed = 1";

#[test]
#[ignore = "long"]
fn the_likely_value_is_within_a_factor_of_two_of_what_a_server_billed() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("facts.toml"), FACTS).unwrap();
    // The cache of starts and subgoals serves all of them.
    thread::scope(|scope| {
        for manner in [Manner::Short, Manner::WithReasons] {
            scope.spawn(move || {
                for number in 0..SUITES.len() {
                    bill_and_compare(folder, manner, number);
                }
            });
        }
    });
}

fn bill_and_compare(folder: &Path, manner: Manner, number: usize) {
    let (task, variant, starts) = SUITES[number];
    let text = format!(
        "about = \"Billed.\"\nstatistic = \"mean\"\nmetrics = [\"picks_refused\"]\nrepeats = 1\n\
         tasks = [{:?}]\n{starts}\n[[method]]\nname = \"asked\"\n{variant}\n",
        project(&format!("tasks/{task}.fab"))
    );
    let out = format!("{manner:?}_{number}");
    let suite = folder.join(format!("{out}.toml"));
    fs::write(&suite, text).unwrap();
    let suite = suite.display().to_string();
    let biller = Biller::start(manner);
    let likely = likely(folder, &suite, &biller);
    assert_eq!(biller.bill().calls, 0, "an estimate sends nothing");
    bench(folder, &suite, &biller, &["--out", &out]);
    let bill = biller.bill();
    let billed = [
        bill.calls as f64,
        bill.input as f64,
        bill.output as f64,
        bill.cost(),
    ];
    let about = format!("{out} {task} {variant}: {likely:?} {billed:?}");
    let ratio = likely[3] / billed[3];
    assert!((0.5..=2.0).contains(&ratio), "{about}");
    println!("{about}");
}
