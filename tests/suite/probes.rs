//! `fabc probe` against a scripted server of a certain character, and what its entry is worth when pasted.

use super::provider_commands::command;
use super::support::{finish, project};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use fab_test_provider::{Provider, Question, Response};
use image::RgbImage;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

const DOTS: [(&str, [u8; 3]); 6] = [
    ("red", [220, 30, 30]),
    ("green", [20, 150, 40]),
    ("blue", [30, 60, 220]),
    ("yellow", [235, 205, 20]),
    ("black", [15, 15, 15]),
    ("magenta", [215, 40, 200]),
];

fn refusal(message: &str) -> Response {
    Response::error(400, "invalid_request_error", message)
}

/// Returns the words and the pictures of the question.
fn asked(request: &Value) -> (String, Vec<RgbImage>) {
    let content = &request["messages"][0]["content"];
    let Some(parts) = content.as_array() else {
        return (content.as_str().unwrap().to_owned(), Vec::new());
    };
    let words = parts
        .iter()
        .filter_map(|part| part["text"].as_str())
        .collect();
    let urls = parts
        .iter()
        .filter_map(|part| part["image_url"]["url"].as_str());
    let pictures = urls.map(|url| {
        let png = STANDARD.decode(url.split_once(',').unwrap().1).unwrap();
        image::load_from_memory(&png).unwrap().to_rgb8()
    });
    (words, pictures.collect())
}

/// Returns the middle of each dot, in parts of the picture's sides.
fn middles(picture: &RgbImage) -> impl Iterator<Item = (&'static str, [f64; 2])> {
    let size = [f64::from(picture.width()), f64::from(picture.height())];
    DOTS.into_iter().map(move |(name, colour)| {
        let (mut sum, mut count) = ([0.5, 0.5], 0.0);
        for (x, y, _) in picture
            .enumerate_pixels()
            .filter(|(.., pixel)| pixel.0 == colour)
        {
            sum = [sum[0] + f64::from(x), sum[1] + f64::from(y)];
            count += 1.0;
        }
        (
            name,
            [0, 1].map(|axis| sum[axis] / f64::max(count, 1.0) / size[axis]),
        )
    })
}

/// Thinks in its answer, points as `[y, x]` in thousandths, fixes its temperature, knows the newer limit and no schema.
fn peculiar(_: usize, question: &Question) -> Response {
    let request = question.json();
    if !request["max_tokens"].is_null() {
        return refusal("'max_tokens' is not supported; use 'max_completion_tokens'");
    }
    if request["temperature"]
        .as_f64()
        .is_some_and(|value| value != 1.0)
    {
        return refusal("'temperature' does not support this value");
    }
    if !request["top_p"].is_null() {
        return refusal("'top_p' is not supported");
    }
    let (words, pictures) = asked(&request);
    let text = match pictures.first() {
        Some(picture) => {
            let lines = middles(picture)
                .map(|(name, [x, y])| format!("{name}: [{:.0}, {:.0}]", y * 1000.0, x * 1000.0));
            let lines: Vec<String> = lines.collect();
            format!(
                "<think>red: (3, 4), or (5, 6)?</think>\n{}",
                lines.join("\n")
            )
        }
        None if words.contains("tree") => "Oak".to_owned(),
        None => "yes".to_owned(),
    };
    Response::answer(&text, 50, 40)
}

/// Answers in words only, and refuses pictures.
fn blind(_: usize, question: &Question) -> Response {
    if asked(&question.json()).1.is_empty() {
        Response::answer("yes", 50, 2)
    } else {
        refusal("this model does not take images")
    }
}

fn probe(folder: &Path, address: &str, more: &[&str]) -> (i32, String, String) {
    let arguments = [
        "probe",
        "compatible:peculiar",
        "--base-url",
        address,
        "--allow-unknown-price",
    ];
    let said = finish(&mut command(folder, &[&arguments, more].concat()));
    (said.code, said.stdout, said.stderr)
}

#[test]
fn what_a_probe_prints_is_used_when_it_is_pasted() {
    let folder = tempfile::tempdir().unwrap();
    let provider = Provider::start(peculiar);
    let address = provider.base_url();
    let (code, text, told) = probe(folder.path(), address, &[]);
    assert_eq!(
        code, 3,
        "pixels were asked for, and thousandths came: {text}{told}"
    );
    assert!(told.contains("at most 9 questions"), "{told}");
    let (_, entry) = text.split_once("[[model]]").unwrap();
    let entry = format!("[[model]]{entry}");
    for line in [
        "id = \"peculiar\"",
        "coordinates = { order = \"yx\", unit = \"per_mille\" }",
        "vision = true",
        "structured_output = false",
        "temperature = { only = [1.0] }",
        "top_p = \"refused\"",
        "max_tokens_field = \"max_completion_tokens\"",
        "source = \"fabc probe\"",
    ] {
        assert!(entry.lines().any(|it| it == line), "{line}\n{entry}");
    }
    let ignored = "# the server takes a schema and ignores it: to `Name a tree. Answer with one word and nothing else.` it answers `";
    assert!(entry.contains(ignored), "{entry}");
    fs::write(folder.path().join("pasted.toml"), &entry).unwrap();
    let pasted = ["--models", "pasted.toml"];
    let (code, text, told) = probe(folder.path(), address, &[&pasted[..], &["--json"]].concat());
    assert_eq!(code, 0, "{text}{told}");
    let found: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(found["agrees"], json!(true));
    assert_eq!(
        found["facts"]["coordinates"],
        json!({ "order": "yx", "unit": "per_mille" })
    );
    assert_eq!(found["toml"].as_str().unwrap(), entry.trim_end());
    // The task states a temperature that the pasted facts rule out.
    let task = project("tasks/double_straight.fab");
    let run = [
        "run",
        &task,
        "--model",
        "compatible:peculiar",
        "--base-url",
        address,
        "--estimate",
    ];
    let refused = finish(&mut command(folder.path(), &[&run[..], &pasted].concat()));
    assert_eq!(refused.code, 2, "{}", refused.stdout);
    assert!(
        refused.stderr.contains("`temperature`"),
        "{}",
        refused.stderr
    );
}

#[test]
fn a_model_without_sight_is_told_so_and_asked_no_further() {
    let folder = tempfile::tempdir().unwrap();
    let provider = Provider::start(blind);
    let address = provider.base_url();
    let (code, text, told) = probe(folder.path(), address, &["--json"]);
    assert_eq!(code, 3, "{text}{told}");
    let found: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(found["facts"]["vision"], json!(false));
    assert!(found["toml"].as_str().unwrap().contains("vision = false"));
}

#[test]
fn a_probe_stops_at_its_cap_and_at_a_server_that_takes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let provider = Provider::start(peculiar);
    let address = provider.base_url();
    let (code, _, told) = probe(folder.path(), address, &["--max-calls", "4"]);
    assert_eq!(code, 3, "{told}");
    assert!(
        told.contains("the cap of 4 calls is reached; a higher `--max-calls` allows more"),
        "{told}"
    );
    let provider = Provider::playing(vec![refusal("no")]);
    let address = provider.base_url();
    let (code, text, told) = probe(folder.path(), address, &[]);
    assert_eq!(code, 2, "{text}{told}");
    assert!(told.contains("HTTP 400 Bad Request: no"), "{told}");
}

#[test]
fn a_probe_says_why_a_call_gave_no_answer_before_its_cap_ends_it() {
    let folder = tempfile::tempdir().unwrap();
    let odd = Response::status(200).json(json!({ "choices": 7 }));
    let provider = Provider::playing(vec![odd]);
    let address = provider.base_url();
    let (code, _, told) = probe(folder.path(), address, &["--max-calls", "1"]);
    assert_eq!(code, 3, "{told}");
    assert!(told.contains("with retries at most 1 call\n"), "{told}");
    assert!(
        told.contains("the probe is not complete: the cap of 1 call is reached")
            && told.contains("failed calls: invalid_reply 1")
            && told.contains("invalid_reply: HTTP 200 OK, but"),
        "{told}"
    );
}
