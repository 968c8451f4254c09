//! `fabc doctor`: reports what is set up, what is missing, and the command that sets it up.
//!
//! Vendors are not called. Every other server with a known address is asked which models it serves, which costs nothing;
//! a key is sent only where a run would send it. Keys are shown by name alone.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::report::Report;
use crate::verbs::runtime::setting::catalogue::{self, FactsArguments, UserFile};
use crate::verbs::runtime::setting::remote;
use clap::Args;
use fab_base::interrupt::Interrupt;
use fab_base::parallel::in_parallel;
use fab_providers::catalogue::{Catalogue, KeyNeed, Provider, RunsOn};
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

impl Finding {
    fn ready(name: &str, found: impl Display) -> Finding {
        Finding {
            name: name.to_owned(),
            state: Ready,
            found: found.to_string(),
            help: None,
        }
    }

    fn broken(name: &str, error: impl Display) -> Finding {
        Finding {
            state: Broken,
            ..Finding::ready(name, error)
        }
    }

    fn missing(name: &str, found: impl Display, help: impl Display) -> Finding {
        Finding {
            state: Missing,
            help: Some(help.to_string()),
            ..Finding::ready(name, found)
        }
    }
}

/// Checks everything and lists it.
pub fn run(arguments: &DoctorArguments, io: &Io) -> Result<Exit, Failure> {
    let (catalogue, facts) = facts(arguments.facts.models.as_deref(), io);
    let keys = keys(io);
    let is_broken = keys.state == Broken;
    let mut findings = vec![
        Finding::ready("fabc", env!("CARGO_PKG_VERSION")),
        keypoints(),
        facts,
        keys,
    ];
    // In parallel, so that ten missing servers take no longer than one.
    let providers = catalogue.providers();
    let look = |index: usize| Ok::<_, Failure>(Some(look(&providers[index], is_broken, io)));
    let found = in_parallel(providers.len(), providers.len(), look, |_| {})?;
    findings.extend(found.into_iter().flatten());
    let checkup = Checkup {
        ready: findings.iter().all(|finding| finding.state != Broken),
        findings,
    };
    io.result(arguments.json, &checkup);
    Ok(if checkup.ready {
        Exit::Done
    } else {
        Exit::Environment
    })
}

fn keypoints() -> Finding {
    match fab_vision::detectors() {
        Ok(whose) => Finding::ready("keypoints", format!("found by {whose}")),
        Err(error) => Finding::broken("keypoints", error),
    }
}

/// Returns the model catalogue; without the user's file if that is unusable.
fn facts(flag: Option<&Path>, io: &Io) -> (Catalogue, Finding) {
    let name = "facts about models";
    let catalogue = match catalogue::load(flag, io) {
        Ok(catalogue) => catalogue,
        Err(error) => return (Catalogue::builtin(), Finding::broken(name, error)),
    };
    let file = catalogue::facts_file(flag, io).filter(UserFile::counts);
    let finding = match file {
        Some(file) => Finding::ready(name, file.path.display()),
        None => Finding::missing(
            name,
            "none of yours; the embedded ones are used",
            "`fabc models --help` says how to add or correct facts",
        ),
    };
    (catalogue, finding)
}

fn keys(io: &Io) -> Finding {
    let file = catalogue::keys_file(io);
    let path = file.as_ref().map(|file| file.path.display().to_string());
    let path = path.unwrap_or_else(|| "a file that FABC_KEYS names".to_owned());
    match file.filter(UserFile::counts) {
        None => Finding::missing(
            "keys",
            "no file of keys",
            format!(
                "keys may stand in variables, or in {path} (chmod 600), a line each: NAME = \"KEY\""
            ),
        ),
        Some(file) => match Key::names_in(&file.path) {
            Ok(names) => Finding::ready("keys", format!("{path}: {}", names.join(", "))),
            Err(error) => Finding::broken("keys", error),
        },
    }
}

/// Looks for a provider's key, and asks a server that is not a vendor's for its models.
///
/// - `is_broken`: whether the file of keys is; its own finding says so.
fn look(provider: &Provider, is_broken: bool, io: &Io) -> Finding {
    let name = &provider.name;
    let key = match remote::key(&provider.key_env, io) {
        Ok(key) => key,
        Err(_) if is_broken => None,
        Err(error) => return Finding::broken(name, error),
    };
    let with = key.as_ref().map(|key| format!(", key: {}", key.name()));
    let with = with.unwrap_or_default();
    let Some(base_url) = &provider.base_url else {
        let found = format!("any server that speaks its interface{with}");
        return Finding::missing(name, found, "name its address with --base-url");
    };
    if provider.runs_on == Some(RunsOn::Vendor) {
        return if key.is_none() && provider.key == KeyNeed::Required {
            Finding::missing(name, "no key", export(provider))
        } else {
            Finding::ready(name, format!("{base_url}{with}; not tried"))
        };
    }
    match BaseUrl::parse(base_url) {
        Ok(base_url) => served(provider, base_url, key, &with),
        Err(error) => Finding::broken(name, error),
    }
}

/// Asks a server for its models.
fn served(provider: &Provider, base_url: BaseUrl, key: Option<Key>, with: &str) -> Finding {
    let name = &provider.name;
    let at = provider.base_url.as_deref().unwrap_or_default();
    let settings = Settings {
        key: key.filter(|_| base_url.keeps_secrets()),
        timeout: LIST_TIME,
        ..Settings::new(name, "", provider.wire, base_url)
    };
    let start = provider.start.as_deref().unwrap_or("start its server");
    let start = format!("{start}, or name its address with --base-url");
    match served_models(&settings, &[], &Interrupt::default()) {
        Ok(models) if models.is_empty() => Finding::missing(
            name,
            format!("answers at {at} and serves no model yet{with}"),
            "load a model in it",
        ),
        Ok(models) => {
            let found = format!("serves {} at {at}{with}", models.join(", "));
            Finding::ready(name, found)
        }
        Err(NotListed::Unauthorised { status }) => {
            let a = if with.is_empty() { "a" } else { "another" };
            let found = format!("answers at {at} and wants {a} key (HTTP {status}){with}");
            Finding::missing(name, found, export(provider))
        }
        Err(NotListed::Absent) => {
            Finding::missing(name, format!("nothing answers at {at}{with}"), start)
        }
        Err(NotListed::Other(why) | NotListed::Unreachable(why)) => Finding::missing(
            name,
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

impl Report for Checkup {
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
