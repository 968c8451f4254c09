//! `fabc doctor`: reports what is set up, what is missing, and the command that sets it up.
//!
//! Vendors are not called. Every other server with a known address is asked which models it serves, which costs nothing;
//! a key is sent only where a run would send it. Keys are shown by name alone.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::runtime::setting::catalogue::{self, FactsArguments, UserFile};
use crate::verbs::runtime::setting::remote;
use clap::Args;
use fab_base::interrupt::Interrupt;
use fab_base::parallel::in_parallel;
use fab_providers::catalogue::{Catalogue, Provider, RunsOn};
use fab_providers::remote::{BaseUrl, Key, NotListed, Settings, served_models};
use serde::Serialize;
use std::fmt::Display;
use std::path::Path;
use std::time::Duration;

use Readiness::{Broken, Missing, Ready};

/// Arguments of `doctor`.
#[derive(Args)]
pub struct DoctorArguments {
    #[command(flatten)]
    pub facts: FactsArguments,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Time limit for a server's list of models.
const LIST_TIME: Duration = Duration::from_secs(2);

/// All that was checked.
#[derive(Serialize)]
struct Checkup {
    ready: bool,
    findings: Vec<Finding>,
}

/// One item that was checked.
#[derive(Serialize)]
struct Finding {
    /// Its name.
    name: String,
    state: Readiness,
    /// The result in words.
    found: String,
    /// The line that sets it up.
    help: Option<String>,
}

#[derive(Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Readiness {
    /// It is usable.
    Ready,
    /// It is not set up, which is allowed.
    Missing,
    /// It is set up but unusable.
    Broken,
}

/// Makes the finding of a check: what is ready, or what is missing and the line that sets it up.
fn finding<E: Display>(name: &str, result: Result<Found, E>) -> Finding {
    let (state, found, help) = match result {
        Ok(Ok(found)) => (Ready, found, None),
        Ok(Err([found, help])) => (Missing, found, Some(help)),
        Err(error) => (Broken, error.to_string(), None),
    };
    let name = name.to_owned();
    Finding {
        name,
        state,
        found,
        help,
    }
}

/// Checks everything and lists it.
pub fn run(arguments: &DoctorArguments, io: &Io) -> Result<Exit, Failure> {
    let flag = arguments.facts.models.as_deref();
    let (catalogue, facts) = match catalogue::load(flag, io) {
        Ok(catalogue) => (catalogue, Ok(facts(flag, io))),
        // Without the user's file.
        Err(error) => (Catalogue::builtin(), Err(error)),
    };
    let keys = finding("keys", keys(io));
    let is_broken = keys.state == Broken;
    let keypoints = fab_vision::detectors().map(|whose| Ok(format!("found by {whose}")));
    let mut findings = vec![
        finding::<String>("fabc", Ok(Ok(env!("CARGO_PKG_VERSION").to_owned()))),
        finding("keypoints", keypoints),
        finding("facts about models", facts),
        keys,
    ];
    // In parallel, so that ten missing servers take no longer than one.
    let providers = catalogue.providers();
    let look = |index: usize| {
        let provider: &Provider = &providers[index];
        let found = finding(&provider.name, look(provider, is_broken, io));
        Ok::<_, Failure>(Some(found))
    };
    let found = in_parallel(providers.len(), providers.len(), look, |_| {})?;
    findings.extend(found.into_iter().flatten());
    let checkup = Checkup {
        ready: findings.iter().all(|finding| finding.state != Broken),
        findings,
    };
    io.either(arguments.json, &checkup, || checkup.text());
    Ok(if checkup.ready {
        Exit::Done
    } else {
        Exit::Environment
    })
}

/// What is ready, or what is missing and the line that sets it up.
type Found = Result<String, [String; 2]>;

fn missing(found: impl Into<String>, help: impl Into<String>) -> Found {
    Err([found.into(), help.into()])
}

fn facts(flag: Option<&Path>, io: &Io) -> Found {
    match catalogue::facts_file(flag, io).filter(UserFile::counts) {
        Some(file) => Ok(file.path.display().to_string()),
        None => missing(
            "none of yours; the embedded ones are used",
            "`fabc models --help` says how to add or correct facts",
        ),
    }
}

fn keys(io: &Io) -> Result<Found, String> {
    let file = catalogue::keys_file(io);
    let path = file.as_ref().map(|file| file.path.display().to_string());
    let path = path.unwrap_or_else(|| "a file that FABC_KEYS names".to_owned());
    Ok(match file.filter(UserFile::counts) {
        None => missing(
            "no file of keys",
            format!(
                "keys may stand in variables, or in {path} (chmod 600), a line each: NAME = \"KEY\""
            ),
        ),
        Some(file) => Ok(format!("{path}: {}", Key::names_in(&file.path)?.join(", "))),
    })
}

/// Looks for a provider's key, and asks a server that is not a vendor's for its models.
///
/// - `is_broken`: whether the file of keys is; its own finding says so.
fn look(provider: &Provider, is_broken: bool, io: &Io) -> Result<Found, Failure> {
    let key = match remote::key(&provider.key_env, io) {
        Err(_) if is_broken => None,
        key => key?,
    };
    let with = key.as_ref().map(|key| format!(", key: {}", key.name()));
    let with = with.unwrap_or_default();
    let Some(base_url) = &provider.base_url else {
        let found = format!("any server that speaks its interface{with}");
        return Ok(missing(found, "name its address with --base-url"));
    };
    if provider.runs_on == Some(RunsOn::Vendor) {
        return Ok(if key.is_none() {
            missing("no key", export(provider))
        } else {
            Ok(format!("{base_url}{with}; not tried"))
        });
    }
    let base_url = BaseUrl::parse(base_url).map_err(Failure::environment)?;
    Ok(served(provider, base_url, key, &with))
}

/// Asks a server for its models.
fn served(provider: &Provider, base_url: BaseUrl, key: Option<Key>, with: &str) -> Found {
    let at = provider.base_url.as_deref().unwrap_or_default();
    let settings = Settings {
        key: key.filter(|_| base_url.keeps_secrets()),
        timeout: LIST_TIME,
        ..Settings::new(&provider.name, "", provider.wire, base_url)
    };
    let start = provider.start.as_deref().unwrap_or("start its server");
    let start = format!("{start}, or name its address with --base-url");
    match served_models(&settings, &Interrupt::default()) {
        Ok(models) if models.is_empty() => missing(
            format!("answers at {at} and serves no model yet{with}"),
            "load a model in it",
        ),
        Ok(models) => Ok(format!("serves {} at {at}{with}", models.join(", "))),
        Err(NotListed::Unauthorised { status }) => {
            let a = if with.is_empty() { "a" } else { "another" };
            let found = format!("answers at {at} and wants {a} key (HTTP {status}){with}");
            missing(found, export(provider))
        }
        Err(NotListed::Absent) => missing(format!("nothing answers at {at}{with}"), start),
        Err(NotListed::Other(why)) => missing(
            format!("no list of models came from {at} ({why}){with}"),
            format!("look into its log, or whether another program has its port; {start}"),
        ),
    }
}

/// Returns the line that sets a provider's key.
fn export(provider: &Provider) -> String {
    let variable = provider.key_env.first().map_or("its key", String::as_str);
    format!("export {variable}=…, or write it into the file of keys")
}

impl Checkup {
    fn text(&self) -> String {
        let lines = self.findings.iter().map(|finding| {
            let state = match finding.state {
                Ready => "ready  ",
                Missing => "missing",
                Broken => "BROKEN ",
            };
            let help = finding.help.as_ref();
            let help = help.map_or(String::new(), |help| format!("\n         -> {help}"));
            format!("{state}  {}: {}{help}", finding.name, finding.found)
        });
        lines.collect::<Vec<_>>().join("\n")
    }
}
