//! `fabc models`, `doctor` and `probe`: their output and exit codes.

use super::support::{Captured, Fabc, fabc, finish};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// The command with its settings in the test's own folder, and without the machine's keys.
fn alone(folder: &Path) -> Fabc {
    let mut command = fabc(folder);
    command
        .env("HOME", folder)
        .env("XDG_CONFIG_HOME", folder.join("settings"));
    command.env("FABC_CACHE_DIR", folder.join("cache"));
    for name in [
        "OPENAI_API_KEY",
        "ANTHROPIC_API_KEY",
        "GOOGLE_API_KEY",
        "GEMINI_API_KEY",
        "FABC_MODELS",
        "FABC_KEYS",
    ] {
        command.env_remove(name);
    }
    command
}

fn json(said: &Captured) -> Value {
    serde_json::from_str(&said.stdout)
        .unwrap_or_else(|error| panic!("{error}: {} {}", said.stdout, said.stderr))
}

fn entry<'v>(list: &'v Value, key: &str, value: &str) -> &'v Value {
    let found = list
        .as_array()
        .unwrap()
        .iter()
        .find(|entry| entry[key] == value);
    found.unwrap_or_else(|| panic!("no {value} in {list}"))
}

#[test]
fn models_are_listed_with_prices_and_sources() {
    let folder = tempfile::tempdir().unwrap();
    let said = finish(alone(folder.path()).args(["models", "--json"]));
    assert_eq!(said.code, 0, "{}", said.stderr);
    let listed = json(&said);
    let sol = entry(&listed["models"], "model", "openai:gpt-6.2-sol");
    assert_eq!(sol["facts"]["price"][0]["cached_input"], 0.1);
    assert_eq!(sol["sources"][0]["as_of"], "2026-11-20");
    let argon = entry(&listed["models"], "model", "google:gemini-4-argon");
    assert_eq!(argon["facts"]["price"][1]["from"], "2026-12-01");
    assert_eq!(argon["facts"]["image_tokens"], Value::Null);
    let openai = entry(&listed["providers"], "name", "openai");
    assert_eq!(openai["key_env"][0], "OPENAI_API_KEY");
}

#[test]
fn the_table_shows_what_is_unknown_as_such_and_each_price_with_its_day() {
    let folder = tempfile::tempdir().unwrap();
    let listed = |provider: &str| {
        let said = finish(alone(folder.path()).args(["models", provider]));
        assert_eq!(said.code, 0, "{}", said.stderr);
        said.stdout
    };
    let row = |table: &str, name: &str| {
        let found = table.lines().find(|line| line.starts_with(name));
        let found = found.unwrap_or_else(|| panic!("no {name} in {table}"));
        found.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let chat = listed("openai-chat");
    assert_eq!(
        row(&chat, "openai-chat:gpt-6.2-sol "),
        "openai-chat:gpt-6.2-sol 2 / 0.1 / 10 yes yes 1 alone x y, pixels 59 635 2026-11-24"
    );
    assert!(!chat.contains("claude"), "{chat}");
    assert_eq!(
        row(&listed("google"), "google:gemini-4-argon "),
        "google:gemini-4-argon 2 / ? / 10, 4 / ? / 20 from 2026-12-01 yes yes ? y x, 0-1000 ? ? 2026-11-24"
    );
    let unknown = finish(alone(folder.path()).args(["models", "opnai"]));
    assert_eq!(unknown.code, 64);
    assert!(
        unknown.stderr.contains("did you mean `openai`?"),
        "{}",
        unknown.stderr
    );
}

#[test]
fn facts_of_the_users_are_found_by_flag_by_variable_and_in_the_folder_of_settings() {
    let folder = tempfile::tempdir().unwrap();
    let facts = |input: f64| {
        format!(
            "[[model]]\nprovider = \"openai\"\nid = \"mine\"\nprice = [{{ input = {input}, output = 1 }}]\n"
        )
    };
    let price = |listed: &Value| {
        let mine = entry(&listed["models"], "model", "openai:mine");
        mine["facts"]["price"][0]["input"].as_f64().unwrap()
    };
    let file = |name: &str, input: f64| fs::write(folder.path().join(name), facts(input)).unwrap();
    file("flag.toml", 1.0);
    file("variable.toml", 2.0);
    if cfg!(target_os = "linux") {
        fs::create_dir_all(folder.path().join("settings/fabc")).unwrap();
        file("settings/fabc/models.toml", 3.0);
        let placed = json(&finish(alone(folder.path()).args(["models", "--json"])));
        assert_eq!(price(&placed), 3.0);
    }
    let named = json(&finish(
        alone(folder.path())
            .env("FABC_MODELS", "variable.toml")
            .args(["models", "--json"]),
    ));
    assert_eq!(price(&named), 2.0);
    let flag = json(&finish(
        alone(folder.path())
            .env("FABC_MODELS", "variable.toml")
            .args(["models", "--json", "--models", "flag.toml"]),
    ));
    assert_eq!(price(&flag), 1.0);
    fs::write(folder.path().join("bad.toml"), "\n[[model]]\nid = 1\n").unwrap();
    for (name, expected) in [
        ("none.toml", "cannot read `none.toml`"),
        ("bad.toml", "`bad.toml`, line 2: invalid type: integer `1`"),
    ] {
        let said = finish(alone(folder.path()).args(["models", "--json", "--models", name]));
        assert_eq!(said.code, 2);
        assert!(
            json(&said)["error"].as_str().unwrap().contains(expected),
            "{}",
            said.stdout
        );
    }
}

#[test]
fn doctor_says_what_is_missing_and_the_line_that_helps() {
    let folder = tempfile::tempdir().unwrap();
    let said = finish(
        alone(folder.path())
            .env("OPENAI_API_KEY", " ")
            .args(["doctor", "--json"]),
    );
    assert_eq!(said.code, 0, "{}", said.stdout);
    let found = json(&said);
    let findings = &found["findings"];
    assert_eq!(
        entry(findings, "name", "fabc")["found"],
        env!("CARGO_PKG_VERSION")
    );
    assert_eq!(entry(findings, "name", "keys")["state"], "missing");
    let openai = entry(findings, "name", "openai");
    assert_eq!(openai["state"], "missing");
    assert!(
        openai["help"]
            .as_str()
            .unwrap()
            .starts_with("export OPENAI_API_KEY="),
        "{openai}"
    );
    let text = finish(alone(folder.path()).arg("doctor"));
    assert!(
        text.stdout
            .contains("missing  anthropic: no key\n         -> export ANTHROPIC_API_KEY="),
        "{}",
        text.stdout
    );
}

/// Answers every connection with the same reply; ends with the test's process.
fn answering(reply: &'static str) -> std::net::SocketAddr {
    use std::io::{Read, Write};
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            let mut stream = stream.unwrap();
            let _ = stream.read(&mut [0; 4096]);
            let _ = stream.write_all(reply.as_bytes());
        }
    });
    address
}

/// Returns what doctor says of a server at an address, given as Ollama's.
fn ollama_at(address: std::net::SocketAddr, key: Option<&str>) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let facts = format!(
        "[[provider]]\nname = \"ollama\"\nbase_url = \"http://{address}/v1\"\nas_of = \"2027-01-01\"\nsource = \"us\"\n"
    );
    fs::write(folder.path().join("facts.toml"), facts).unwrap();
    let mut command = alone(folder.path());
    command.args(["doctor", "--json", "--models", "facts.toml"]);
    if let Some(key) = key {
        command.env("FABC_OLLAMA_KEY", key);
    }
    let said = finish(&mut command);
    assert_eq!(said.code, 0, "{}", said.stdout);
    entry(&json(&said)["findings"], "name", "ollama").clone()
}

#[test]
fn doctor_lists_what_a_server_serves_and_says_what_others_want() {
    let closed = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let nowhere = closed.local_addr().unwrap();
    drop(closed);
    let list = "HTTP/1.1 200 OK\r\nconnection: close\r\n\r\n{\"data\":[{\"id\":\"qwen3-vl:8b\"},{\"id\":\"gemma3\"}]}";
    let none = "HTTP/1.1 200 OK\r\nconnection: close\r\n\r\n{\"object\":\"list\",\"data\":null}";
    let locked = "HTTP/1.1 401 Unauthorized\r\nconnection: close\r\n\r\n";
    let page = "HTTP/1.1 200 OK\r\nconnection: close\r\n\r\n<html>Jenkins</html>";
    let key = Some("sk-canary-key");
    for (address, key, state, found, help) in [
        (
            answering(list),
            None,
            "ready",
            "serves qwen3-vl:8b, gemma3 at ",
            None,
        ),
        (
            answering(none),
            None,
            "missing",
            "and serves no model yet",
            Some("load a model in it"),
        ),
        (
            answering(locked),
            None,
            "missing",
            "and wants a key (HTTP 401)",
            Some("export FABC_OLLAMA_KEY="),
        ),
        (
            answering(locked),
            key,
            "missing",
            "and wants another key (HTTP 401), key: FABC_OLLAMA_KEY",
            Some("export"),
        ),
        (
            answering(page),
            None,
            "missing",
            "no list of models came from",
            Some("look into its log, or whether another program has its port"),
        ),
        (
            nowhere,
            None,
            "missing",
            "nothing answers at ",
            Some("ollama serve, or name its address with --base-url"),
        ),
    ] {
        let ollama = ollama_at(address, key);
        let text = ollama.to_string();
        assert_eq!(ollama["state"], state, "{text}");
        assert!(ollama["found"].as_str().unwrap().contains(found), "{text}");
        let said = ollama["help"].as_str();
        assert_eq!(said.is_some(), help.is_some(), "{text}");
        let is_help = said
            .zip(help)
            .is_none_or(|(said, help)| said.starts_with(help));
        assert!(is_help, "{text}");
        assert!(!text.contains("canary"), "{text}");
    }
}

#[cfg(unix)]
#[test]
fn doctor_names_keys_and_never_shows_one() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let keys = folder.path().join("keys.toml");
    let look = |mode: u32, text: &str| {
        fs::write(&keys, text).unwrap();
        fs::set_permissions(&keys, fs::Permissions::from_mode(mode)).unwrap();
        let said = finish(
            alone(folder.path())
                .env("FABC_KEYS", &keys)
                .env("OPENAI_API_KEY", "sk-canary-1")
                .args(["doctor", "--json"]),
        );
        assert!(
            !said.stdout.contains("canary") && !said.stderr.contains("canary"),
            "{}",
            said.stdout
        );
        (said.code, json(&said))
    };
    let (code, found) = look(0o600, "ANTHROPIC_API_KEY = \"sk-canary-2\"\n");
    assert_eq!(code, 0);
    let key = |name: &str| {
        entry(&found["findings"], "name", name)["found"]
            .as_str()
            .unwrap()
            .to_owned()
    };
    assert!(key("openai").ends_with(", key: OPENAI_API_KEY; not tried"));
    assert!(key("anthropic").ends_with(", key: ANTHROPIC_API_KEY; not tried"));
    let (code, found) = look(0o644, "ANTHROPIC_API_KEY = \"sk-canary-2\"\n");
    let state = entry(&found["findings"], "name", "keys");
    assert_eq!((code, &state["state"]), (2, &"broken".into()));
    let provider = entry(&found["findings"], "name", "anthropic");
    assert_eq!(provider["found"], "no key");
    assert!(
        state["found"].as_str().unwrap().contains("chmod 600"),
        "{state}"
    );
    let (code, found) = look(0o600, "ANTHROPIC_API_KEY = sk-canary-2\n");
    assert_eq!((code, &found["ready"]), (2, &false.into()));
}

#[test]
fn doctor_tells_broken_set_ups_by_its_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let said = finish(
        alone(folder.path())
            .env("FABC_MODELS", "none.toml")
            .args(["doctor", "--json"]),
    );
    assert_eq!(said.code, 2);
    let found = json(&said);
    assert!(
        entry(&found["findings"], "name", "facts about models")["found"]
            .as_str()
            .unwrap()
            .contains("cannot read `none.toml`")
    );
    assert_eq!(
        entry(&found["findings"], "name", "openai")["state"],
        "missing",
        "the rest is looked at all the same"
    );
}

#[test]
fn what_has_no_interface_is_not_probed() {
    let folder = tempfile::tempdir().unwrap();
    for refused in [
        &["probe", "nobody"][..],
        &["probe", "random:3"],
        &["probe", "openai:gpt-6.2-sol", "--marks"],
    ] {
        let said = finish(alone(folder.path()).args(refused));
        assert_eq!(said.code, 64, "{refused:?}: {}", said.stderr);
    }
}
