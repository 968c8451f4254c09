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
use fab_providers::catalogue::{Catalogue, KeyNeed, Provider, RunsOn};
use fab_providers::remote::{BaseUrl, Key, NotListed, Settings, served_models};
use serde::Serialize;
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

/// How many models are listed for a server; JSON has all.
const MAX_LISTED: usize = 8;

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
    /// The line that sets it up or repairs it.
    help: Option<String>,
    /// The models that a server says it serves.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    models: Vec<String>,
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
    fn new(name: &str, state: Readiness, found: impl ToString) -> Finding {
        Finding {
            name: name.to_owned(),
            state,
            found: found.to_string(),
            help: None,
            models: Vec::new(),
        }
    }

    fn help(self, help: impl ToString) -> Finding {
        Finding {
            help: Some(help.to_string()),
            ..self
        }
    }
}

/// Checks everything and lists it.
pub fn run(arguments: &DoctorArguments, io: &Io) -> Result<Exit, Failure> {
    let mut findings = versions();
    let (catalogue, facts) = facts(arguments.facts.models.as_deref(), io);
    let (names, keys) = keys(io);
    findings.extend([facts, keys, cache(io)]);
    findings.push(Finding::new(
        "geometric, random, imperfect",
        Ready,
        "embedded stand-ins, ready without key or network; no vision-language models",
    ));
    findings.extend(providers(&catalogue, &names, io));
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

fn versions() -> Vec<Finding> {
    let version = |name, state, found: String| Finding::new(name, state, found);
    let mut versions = vec![version("fabc", Ready, env!("CARGO_PKG_VERSION").to_owned())];
    versions.push(match fab_vision::detectors() {
        Ok(whose) => version("keypoints", Ready, format!("found by {whose}")),
        Err(error) => version("keypoints", Broken, error.to_string()),
    });
    versions.push(if cfg!(feature = "tags") {
        version("AprilTags", Ready, "found by this build".to_owned())
    } else {
        let found = "not found by this build; only `fabc calibrate` looks for them";
        version("AprilTags", Missing, found.to_owned())
            .help("cargo install --path . --features tags")
    });
    versions
}

/// Returns the model catalogue; without the user's file if that is unusable.
fn facts(flag: Option<&Path>, io: &Io) -> (Catalogue, Finding) {
    let builtin = Catalogue::builtin();
    let finding = |state, found| Finding::new("facts about models", state, found);
    let file = catalogue::facts_file(flag, io);
    match &file {
        Some(file) if file.counts() => match Catalogue::builtin().overlaid_by(&file.path) {
            Ok(catalogue) => (catalogue, finding(Ready, file.path.display().to_string())),
            Err(error) => (builtin, finding(Broken, error.to_string())),
        },
        _ => {
            let place = file.map(|file| file.path.display().to_string());
            let place = place.unwrap_or("a file and name it in FABC_MODELS".to_owned());
            let found = "none of yours; the embedded ones are used".to_owned();
            let help = format!("to add or correct facts, write {place} (`fabc models --help`)");
            (builtin, finding(Missing, found).help(help))
        }
    }
}

/// A file of keys: its path, and the names in it.
struct Keys {
    path: Option<String>,
    names: Vec<String>,
}

fn keys(io: &Io) -> (Keys, Finding) {
    let finding = |state, found| Finding::new("keys", state, found);
    let file = catalogue::keys_file(io);
    let path = file.as_ref().map(|file| file.path.display().to_string());
    let (names, found) = match file.filter(UserFile::counts) {
        None => {
            let place = path.as_deref().unwrap_or("a file that FABC_KEYS names");
            let help = format!(
                "keys may stand in variables, or in {place} (chmod 600), a line each: NAME = \"KEY\""
            );
            let found = finding(Missing, "no file of keys".to_owned());
            (Vec::new(), found.help(help))
        }
        Some(file) => match Key::names_in(&file.path) {
            Err(error) => (Vec::new(), finding(Broken, error.to_string())),
            Ok(names) => {
                let listed = if names.is_empty() {
                    "no key".to_owned()
                } else {
                    names.join(", ")
                };
                let found = format!("{}: {listed}", file.path.display());
                (names, finding(Ready, found))
            }
        },
    };
    (Keys { path, names }, found)
}

fn cache(io: &Io) -> Finding {
    let finding = |state, found| Finding::new("cache", state, found);
    let Some(folder) = io.cache_folder() else {
        return finding(
            Missing,
            "no folder: results are computed anew each time".to_owned(),
        )
        .help("name a folder in FABC_CACHE_DIR");
    };
    let shown = folder.display();
    // A name of this process's own, so that two doctors running at once do not collide.
    let trial = folder.join(format!("doctor-{}", std::process::id()));
    let written = std::fs::create_dir_all(&folder)
        .and_then(|()| std::fs::write(&trial, "written by fabc doctor"))
        .and_then(|()| std::fs::remove_file(&trial));
    match written {
        Ok(()) => finding(Ready, shown.to_string()),
        Err(error) => finding(Broken, format!("cannot write into {shown}: {error}"))
            .help("make it writable, or name another folder in FABC_CACHE_DIR"),
    }
}

fn providers(catalogue: &Catalogue, keys: &Keys, io: &Io) -> Vec<Finding> {
    // In parallel, so that ten missing servers take no longer than one.
    std::thread::scope(|scope| {
        let providers = catalogue.providers().iter();
        let looks = providers.map(|provider| scope.spawn(|| look(provider, keys, io)));
        let looks: Vec<_> = looks.collect();
        let found = looks.into_iter().map(|look| look.join());
        found
            .map(|found| found.expect("looking at a provider does not panic"))
            .collect()
    })
}

fn look(provider: &Provider, keys: &Keys, io: &Io) -> Finding {
    let finding = |state, found| Finding::new(&provider.name, state, found);
    let key = key(provider, keys, io);
    let with = key.as_ref().map(|key| format!(", key: {key}"));
    let with = with.unwrap_or_default();
    let Some(base_url) = &provider.base_url else {
        return finding(
            Missing,
            format!("any server that speaks its interface{with}"),
        )
        .help("name its address with --base-url");
    };
    if provider.runs_on != Some(RunsOn::Vendor) {
        return match ask(provider, base_url, io) {
            Ok(listed) => served(provider, base_url, listed, &with, keys),
            Err(why) => finding(Broken, why),
        };
    }
    match (key, provider.key) {
        (Some(key), _) => finding(Ready, format!("key: {key}; not tried")),
        (None, KeyNeed::Optional) => finding(Ready, format!("{base_url}, without a key")),
        (None, KeyNeed::Required) => {
            finding(Missing, "no key".to_owned()).help(export(provider, keys))
        }
    }
}

/// Asks a server for its models; fails if it cannot be asked as it is set up.
fn ask(
    provider: &Provider,
    base_url: &str,
    io: &Io,
) -> Result<Result<Vec<String>, NotListed>, String> {
    let base_url = BaseUrl::parse(base_url).map_err(|error| error.to_string())?;
    let key = remote::key(&provider.key_env, io).map_err(|error| error.to_string())?;
    let settings = Settings {
        key: key.filter(|_| base_url.keeps_secrets()),
        timeout: LIST_TIME,
        ..Settings::new(&provider.name, "", provider.wire, base_url)
    };
    Ok(served_models(&settings, &[], &Interrupt::default()))
}

/// Says what a server answered to the question for its models.
fn served(
    provider: &Provider,
    base_url: &str,
    listed: Result<Vec<String>, NotListed>,
    with: &str,
    keys: &Keys,
) -> Finding {
    let elsewhere = "or name its address with --base-url";
    let (found, help) = match listed {
        Ok(models) if !models.is_empty() => {
            let mut shown = models
                .iter()
                .take(MAX_LISTED)
                .cloned()
                .collect::<Vec<_>>()
                .join(", ");
            if models.len() > MAX_LISTED {
                shown += &format!(" and {} more", models.len() - MAX_LISTED);
            }
            let found = format!("serves {shown} at {base_url}{with}");
            return Finding {
                models,
                ..Finding::new(&provider.name, Ready, found)
            };
        }
        Ok(_) => (
            format!("answers at {base_url} and serves no model yet{with}"),
            "load a model in it".to_owned(),
        ),
        Err(NotListed::Unauthorised { status }) => {
            let wants = if with.is_empty() {
                "wants a key"
            } else {
                "does not accept the key"
            };
            let found = format!("answers at {base_url} and {wants} (HTTP {status}){with}");
            (found, export(provider, keys))
        }
        Err(NotListed::Absent) => (
            format!("nothing answers at {base_url}{with}"),
            match &provider.start {
                Some(start) => format!("{start}, {elsewhere}{}", not_run(provider)),
                None => format!("start its server, {elsewhere}"),
            },
        ),
        Err(NotListed::Other(why)) => (
            format!("something answers at {base_url} and lists no models ({why}){with}"),
            format!("another program may have its port: start it at a free one, {elsewhere}"),
        ),
        Err(NotListed::Unreachable(why)) => (
            format!(
                "no list of models came from {base_url} within {} s ({why}){with}",
                LIST_TIME.as_secs()
            ),
            format!("look into its log, {elsewhere}"),
        ),
    };
    Finding::new(&provider.name, Missing, found).help(help)
}

/// Says so if no test runs the command that starts a provider's server, with the day of its source.
fn not_run(provider: &Provider) -> String {
    // The oldest layer is the one that has the command.
    match provider.sources.last() {
        Some(source) if !provider.start_run => {
            let as_of = source.as_of;
            format!(" (from its documentation of {as_of}, not run by us)")
        }
        _ => String::new(),
    }
}

/// Returns the line that sets a provider's key.
fn export(provider: &Provider, keys: &Keys) -> String {
    let variable = provider.key_env.first().map_or("its key", String::as_str);
    let place = keys.path.as_ref();
    let place = place.map_or(String::new(), |path| format!(", or write it into {path}"));
    format!("export {variable}=…{place}")
}

/// Returns the source from which a provider's key would be taken.
fn key(provider: &Provider, keys: &Keys, io: &Io) -> Option<String> {
    let names = || provider.key_env.iter();
    let variable = names().find(|name| remote::environment(name, io).is_some());
    let variable = variable.map(|name| format!("{name} (environment)"));
    let in_file = || names().find(|name| keys.names.contains(name));
    variable.or_else(|| Some(format!("{} (file of keys)", in_file()?)))
}

impl Report for Checkup {
    fn text(&self) -> String {
        let lines = self.findings.iter().map(|finding| {
            let state = match finding.state {
                Ready => "ready  ",
                Missing => "missing",
                Broken => "BROKEN ",
            };
            let help = finding
                .help
                .iter()
                .map(|help| format!("\n         -> {help}"));
            let help: String = help.collect();
            format!("{state}  {}: {}{help}", finding.name, finding.found)
        });
        lines.collect::<Vec<_>>().join("\n")
    }
}
