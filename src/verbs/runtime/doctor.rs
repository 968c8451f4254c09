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
    /// Its category.
    about: About,
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
enum About {
    Version,
    File,
    Model,
    Provider,
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
    fn ready(about: About, name: &str, found: impl Into<String>) -> Finding {
        Finding {
            about,
            name: name.to_owned(),
            state: Readiness::Ready,
            found: found.into(),
            help: None,
            models: Vec::new(),
        }
    }

    fn missing(
        about: About,
        name: &str,
        found: impl Into<String>,
        help: impl Into<String>,
    ) -> Finding {
        Finding {
            state: Readiness::Missing,
            help: Some(help.into()),
            ..Finding::ready(about, name, found)
        }
    }

    fn broken(about: About, name: &str, found: impl Into<String>) -> Finding {
        Finding {
            state: Readiness::Broken,
            ..Finding::ready(about, name, found)
        }
    }
}

/// Checks everything and lists it.
pub fn run(arguments: &DoctorArguments, io: &Io) -> Result<Exit, Failure> {
    let mut findings = versions();
    let (catalogue, facts) = facts(arguments.facts.models.as_deref(), io);
    findings.push(facts);
    let (names, keys) = keys(io);
    findings.push(keys);
    findings.push(cache(io));
    let stand_ins = "embedded stand-ins, ready without key or network; no vision-language models";
    findings.push(Finding::ready(
        About::Model,
        "geometric, random, imperfect",
        stand_ins,
    ));
    findings.extend(providers(&catalogue, &names, io));
    let is_broken = findings
        .iter()
        .any(|finding| finding.state == Readiness::Broken);
    let checkup = Checkup {
        ready: !is_broken,
        findings,
    };
    io.result(arguments.json, &checkup);
    Ok(match is_broken {
        true => Exit::Environment,
        false => Exit::Done,
    })
}

fn versions() -> Vec<Finding> {
    let detectors = match fab_vision::detectors() {
        Ok(whose) => Finding::ready(About::Version, "keypoints", format!("found by {whose}")),
        Err(error) => Finding::broken(About::Version, "keypoints", error.to_string()),
    };
    let tags = if cfg!(feature = "tags") {
        Finding::ready(About::Version, "AprilTags", "found by this build")
    } else {
        Finding::missing(
            About::Version,
            "AprilTags",
            "not found by this build; only `fabc calibrate` looks for them",
            "cargo install --path . --features tags",
        )
    };
    vec![
        Finding::ready(About::Version, "fabc", env!("CARGO_PKG_VERSION")),
        detectors,
        tags,
    ]
}

/// Returns the model catalogue; without the user's file if that is unusable.
fn facts(flag: Option<&Path>, io: &Io) -> (Catalogue, Finding) {
    const NAME: &str = "facts about models";
    let absent = |path: String| {
        let help = format!("to add or correct facts, write {path} (`fabc models --help`)");
        Finding::missing(
            About::File,
            NAME,
            "none of yours; the embedded ones are used",
            help,
        )
    };
    let Some(file) = catalogue::facts_file(flag, io) else {
        return (
            Catalogue::builtin(),
            absent("a file and name it in FABC_MODELS".to_owned()),
        );
    };
    let path = file.path.display().to_string();
    if !file.counts() {
        return (Catalogue::builtin(), absent(path));
    }
    match Catalogue::builtin().overlaid_by(&file.path) {
        Ok(catalogue) => (catalogue, Finding::ready(About::File, NAME, path)),
        Err(error) => (
            Catalogue::builtin(),
            Finding::broken(About::File, NAME, error.to_string()),
        ),
    }
}

/// A file of keys: its path, and the names in it.
struct Keys {
    path: Option<String>,
    names: Vec<String>,
}

fn keys(io: &Io) -> (Keys, Finding) {
    const NAME: &str = "keys";
    let file = catalogue::keys_file(io);
    let path = file.as_ref().map(|file| file.path.display().to_string());
    let mut keys = Keys {
        path,
        names: Vec::new(),
    };
    let found = match file.filter(UserFile::counts) {
        None => {
            let place = keys
                .path
                .as_deref()
                .unwrap_or("a file that FABC_KEYS names");
            let help = format!(
                "keys may stand in variables, or in {place} (chmod 600), a line each: NAME = \"KEY\""
            );
            Finding::missing(About::File, NAME, "no file of keys", help)
        }
        Some(file) => match Key::names_in(&file.path) {
            Ok(names) => {
                let listed = if names.is_empty() {
                    "no key".to_owned()
                } else {
                    names.join(", ")
                };
                keys.names = names;
                Finding::ready(
                    About::File,
                    NAME,
                    format!("{}: {listed}", file.path.display()),
                )
            }
            Err(error) => Finding::broken(About::File, NAME, error.to_string()),
        },
    };
    (keys, found)
}

fn cache(io: &Io) -> Finding {
    const NAME: &str = "cache";
    let Some(folder) = io.cache_folder() else {
        let help = "name a folder in FABC_CACHE_DIR";
        return Finding::missing(
            About::File,
            NAME,
            "no folder: results are computed anew each time",
            help,
        );
    };
    let shown = folder.display();
    // A name of this process's own, so that two doctors running at once do not collide.
    let trial = folder.join(format!("doctor-{}", std::process::id()));
    let written = std::fs::create_dir_all(&folder)
        .and_then(|()| std::fs::write(&trial, "written by fabc doctor"))
        .and_then(|()| std::fs::remove_file(&trial));
    match written {
        Ok(()) => Finding::ready(About::File, NAME, shown.to_string()),
        Err(error) => Finding {
            help: Some("make it writable, or name another folder in FABC_CACHE_DIR".to_owned()),
            ..Finding::broken(
                About::File,
                NAME,
                format!("cannot write into {shown}: {error}"),
            )
        },
    }
}

fn providers(catalogue: &Catalogue, keys: &Keys, io: &Io) -> Vec<Finding> {
    let providers = catalogue.providers();
    // In parallel, so that ten missing servers take no longer than one.
    std::thread::scope(|scope| {
        let looks: Vec<_> = providers
            .iter()
            .map(|provider| scope.spawn(|| look(provider, keys, io)))
            .collect();
        let found = looks
            .into_iter()
            .map(|look| look.join().expect("looking at a provider does not panic"));
        found.collect()
    })
}

fn look(provider: &Provider, keys: &Keys, io: &Io) -> Finding {
    let name = provider.name.as_str();
    let key = key(provider, keys, io);
    let with = key
        .as_ref()
        .map_or(String::new(), |key| format!(", key: {key}"));
    let Some(base_url) = &provider.base_url else {
        let found = format!("any server that speaks its interface{with}");
        return Finding::missing(
            About::Provider,
            name,
            found,
            "name its address with --base-url",
        );
    };
    if provider.runs_on != Some(RunsOn::Vendor) {
        return match ask(provider, base_url, io) {
            Ok(listed) => served(provider, base_url, listed, &with, keys),
            Err(why) => Finding::broken(About::Provider, name, why),
        };
    }
    match (key, provider.key) {
        (Some(key), _) => Finding::ready(About::Provider, name, format!("key: {key}; not tried")),
        (None, KeyNeed::Optional) => {
            Finding::ready(About::Provider, name, format!("{base_url}, without a key"))
        }
        (None, KeyNeed::Required) => {
            let help = export(provider, keys);
            Finding::missing(About::Provider, name, "no key", help)
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
    let name = provider.name.as_str();
    let missing =
        |found: String, help: String| Finding::missing(About::Provider, name, found, help);
    let elsewhere = "or name its address with --base-url";
    match listed {
        Ok(models) if models.is_empty() => missing(
            format!("answers at {base_url} and serves no model yet{with}"),
            "load a model in it".to_owned(),
        ),
        Ok(models) => {
            let shown: Vec<&str> = models.iter().take(MAX_LISTED).map(String::as_str).collect();
            let more = match models.len() - shown.len() {
                0 => String::new(),
                more => format!(" and {more} more"),
            };
            let found = format!("serves {}{more} at {base_url}{with}", shown.join(", "));
            Finding {
                models,
                ..Finding::ready(About::Provider, name, found)
            }
        }
        Err(NotListed::Unauthorised { status }) if with.is_empty() => missing(
            format!("answers at {base_url} and wants a key (HTTP {status})"),
            export(provider, keys),
        ),
        Err(NotListed::Unauthorised { status }) => missing(
            format!("answers at {base_url} and does not accept the key (HTTP {status}){with}"),
            export(provider, keys),
        ),
        Err(NotListed::Absent) => missing(
            format!("nothing answers at {base_url}{with}"),
            match &provider.start {
                Some(start) => format!("{start}, {elsewhere}{}", not_run(provider)),
                None => format!("start its server, {elsewhere}"),
            },
        ),
        Err(NotListed::Other(why)) => missing(
            format!("something answers at {base_url} and lists no models ({why}){with}"),
            format!("another program may have its port: start it at a free one, {elsewhere}"),
        ),
        Err(NotListed::Unreachable(why)) => missing(
            format!(
                "no list of models came from {base_url} within {} s ({why}){with}",
                LIST_TIME.as_secs()
            ),
            format!("look into its log, {elsewhere}"),
        ),
    }
}

/// Says so if no test runs the command that starts a provider's server, with the day of its source.
fn not_run(provider: &Provider) -> String {
    // The oldest layer is the one that has the command.
    match provider.sources.last() {
        Some(source) if !provider.start_run => {
            format!(
                " (from its documentation of {}, not run by us)",
                source.as_of
            )
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
    let is_set = |name: &&String| remote::environment(name, io).is_some();
    let variable = provider.key_env.iter().find(is_set);
    let in_file = || {
        provider
            .key_env
            .iter()
            .find(|name| keys.names.contains(name))
    };
    variable
        .map(|name| format!("{name} (environment)"))
        .or_else(|| in_file().map(|name| format!("{name} (file of keys)")))
}

impl Report for Checkup {
    fn text(&self) -> String {
        let lines = self.findings.iter().map(|finding| {
            let state = match finding.state {
                Readiness::Ready => "ready  ",
                Readiness::Missing => "missing",
                Readiness::Broken => "BROKEN ",
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
