//! Models of providers: facts, keys and addresses, collected from files and the environment.

use super::catalogue::{self, UserFile};
use crate::exit::Failure;
use crate::io::Io;
use crate::verbs::runtime::setting;
use crate::verbs::runtime::setting::model_arguments::{Purpose, ReachArguments};
use fab_base::interrupt::Interrupt;
use fab_model::lowering::{Lowering, Points};
use fab_providers::catalogue::{Catalogue, Profile, RunsOn};
use fab_providers::remote::{Answers, BaseUrl, Gate, Key, Redactor, Remote, Settings, Shared};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

/// The most concurrent calls to one provider; the gate lowers this if the provider wants fewer.
const MOST_CALLS_AT_ONCE: usize = 16;

/// What all models of one command share.
pub struct Providers {
    arguments: ReachArguments,
    catalogue: Catalogue,
    answers: Arc<Answers>,
    gates: BTreeMap<String, Arc<Gate>>,
    interrupt: Interrupt,
    keys: Vec<Key>,
    io: Io,
}

impl Providers {
    /// Reads the model catalogue, and every key that is set.
    pub fn new(
        arguments: &ReachArguments,
        interrupt: &Interrupt,
        io: &Io,
    ) -> Result<Providers, Failure> {
        let catalogue = catalogue::load(arguments.facts.models.as_deref(), io)?;
        let (mut keys, mut gates) = (Vec::new(), BTreeMap::new());
        for provider in catalogue.providers() {
            // An unusable key matters only if its provider is used.
            keys.extend(key(&provider.key_env, io).ok().flatten());
            let gate = Arc::new(Gate::new(MOST_CALLS_AT_ONCE));
            gates.insert(provider.name.clone(), gate);
        }
        let answers = if arguments.no_cache {
            Answers::none()
        } else {
            Answers::kept_in(setting::cache_of("answers", io))
        };
        Ok(Providers {
            arguments: arguments.clone(),
            catalogue,
            answers: Arc::new(answers),
            gates,
            interrupt: interrupt.clone(),
            keys,
            io: io.clone(),
        })
    }

    /// Makes the model of a profile; sends nothing.
    ///
    /// - `base_url`: the provider's address, if not the usual one.
    pub fn model(
        &self,
        profile: &Profile,
        base_url: Option<&str>,
        purpose: Purpose,
    ) -> Result<Remote, Failure> {
        if purpose == Purpose::Asking {
            self.refuse_unknown_price(profile)?;
        }
        let address = base_url.or(profile.provider.base_url.as_deref());
        let Some(address) = address else {
            return Err(Failure::usage(format!(
                "`{}` has no address of its own; say where it is reached with `--base-url URL`",
                profile.provider.name
            )));
        };
        // The message may repeat the URL, which must not show a key that was pasted into it.
        let address = BaseUrl::parse(address)
            .map_err(|error| Failure::usage(Redactor::of(&self.keys).text(&error)))?;
        let arguments = &self.arguments;
        let key = match purpose {
            Purpose::Asking => self.key_of(profile)?,
            Purpose::Estimating => None,
        };
        if let (Some(key), false) = (&key, address.keeps_secrets()) {
            return Err(Failure::usage(format!(
                "`{}` would go to `{}` unencrypted; use an address with https, or one on this machine",
                key.name(),
                profile.provider.name
            )));
        }
        let settings = Settings {
            lowering: lowering(profile.facts.lowering(), arguments.marks),
            key,
            omit: arguments.omitted().collect(),
            timeout: Duration::from_secs(arguments.timeout.into()),
            ..Settings::of(profile, address, catalogue::today(&self.io))
        };
        let io = self.io.clone();
        let shared = Shared {
            tell: Arc::new(move |why| io.talk(&format!("  {why}"))),
            gate: Arc::clone(&self.gates[&profile.provider.name]),
            answers: Arc::clone(&self.answers),
            interrupt: self.interrupt.clone(),
            hidden: self.keys.clone(),
        };
        Remote::new(settings, shared).map_err(Failure::environment)
    }

    /// Finds the profile of a `PROVIDER:NAME`, and warns the user of what is likely to fail.
    pub fn profile(&self, name: &str) -> Result<Profile, Failure> {
        if Redactor::of(&self.keys).text(name) != name {
            return Err(Failure::usage(
                "the model name contains an API key; put keys into the environment or a key file, and write the \
                 model as `PROVIDER:NAME`, such as `openai:NAME`",
            ));
        }
        let profile = self.catalogue.find(name).map_err(Failure::usage)?;
        if let Some(warning) = profile.warning() {
            self.io.talk(&format!("warning: {name}: {warning}"));
        }
        Ok(profile)
    }

    fn refuse_unknown_price(&self, profile: &Profile) -> Result<(), Failure> {
        if self.arguments.allow_unknown_price
            || profile.price_on(catalogue::today(&self.io)).is_some()
        {
            return Ok(());
        }
        let near = profile.near.as_ref();
        let near = near.map_or(String::new(), |near| format!(" (did you mean `{near}`?)"));
        Err(Failure::environment(format!(
            "what `{}` costs is not known{near}; `--allow-unknown-price` asks it anyway, and a `price` in a file of your own (`--models FILE`) makes it known",
            profile.title()
        )))
    }

    fn key_of(&self, profile: &Profile) -> Result<Option<Key>, Failure> {
        let provider = &profile.provider;
        let found = key(&provider.key_env, &self.io)?;
        if found.is_none() && provider.runs_on == Some(RunsOn::Vendor) {
            let place = catalogue::keys_file(&self.io).map(|file| file.path.display().to_string());
            return Err(Failure::environment(format!(
                "there is no key for `{}`: set {} in the environment, or write `{} = \"…\"` into `{}`, which nobody else may be able to read",
                provider.name,
                provider.key_env.join(" or "),
                provider.key_env.first().map_or("NAME", String::as_str),
                place.as_deref().unwrap_or("the file that FABC_KEYS names")
            )));
        }
        Ok(found)
    }
}

/// Returns the form in which a model gets points: its own, or as numbered marks.
pub fn lowering(known: Lowering, marks: bool) -> Lowering {
    let points = if marks { Points::Marks } else { known.points };
    Lowering { points, ..known }
}

/// Finds the first of the named keys, in the environment or else in the file of keys.
pub fn key(names: &[String], io: &Io) -> Result<Option<Key>, Failure> {
    let file = catalogue::keys_file(io).filter(UserFile::counts);
    let path = file.as_ref().map(|file| file.path.as_path());
    let variable = |name: &str| io.variable(name)?.into_string().ok();
    Key::find(names, &variable, path).map_err(Failure::environment)
}
