//! The catalogue of known models and providers.
//!
//! In: the embedded `models.toml`, and a user's file of the same form that overrides it. Out: the [`Profile`] of a
//! `PROVIDER:NAME`, its notices, prices and estimates. Facts without a source are absent, and absent means unknown.
//! Nothing here sends anything or reads the date.

mod date;
mod error;
mod facts;
mod file;
mod names;
mod notice;
mod price;
mod provider;
#[cfg(test)]
mod tests;
pub mod tokens;

pub use date::{Date, NoDate};
pub use error::CatalogueError;
pub use facts::{Accepted, Facts, MaxTokensField, PositionFormat, ReasoningFacts, ReasoningKind};
pub use notice::Notice;
pub use price::{Price, Priced, SAFETY};
pub(crate) use provider::is_key_name;
pub use provider::{KeyNeed, Provider, RunsOn, Source, Wire};
pub use tokens::{Flat, ImageTokens, Patches, Tiles, Tokens};

use fab_base::files;
use fab_model::Lowering;
use fab_program::nearest::{among, nearest};
use file::{AtLine, Gateway, ModelEntry, ProviderForm, Subject};
use serde::Serialize;
use std::path::Path;

const BUILTIN: &str = include_str!("models.toml");

/// Everything known about models.
#[derive(Clone, Debug)]
pub struct Catalogue {
    providers: Vec<Provider>,
    models: Vec<ModelEntry>,
    gateways: Vec<Gateway>,
}

/// Everything known about one model at one provider.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Profile {
    /// The provider that offers it.
    pub provider: Provider,
    /// The provider's id for it.
    pub id: String,
    /// How it was found.
    pub listed: FactsSource,
    /// The known facts.
    pub facts: Facts,
    /// Sources of the facts, highest precedence first.
    pub sources: Vec<Source>,
}

/// What models have in common whose ids hold the same words.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Family<'c> {
    /// The words.
    pub part: &'c str,
    /// Other words for the same.
    pub aliases: &'c [String],
    /// The vendor; `None`: the weights are open.
    pub provider: Option<&'c str>,
    /// The facts.
    pub facts: &'c Facts,
    /// Their sources.
    pub sources: &'c [Source],
}

/// How the facts of a model were found.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FactsSource {
    /// An entry has its id.
    ById,
    /// An entry has a name that matches the id.
    ByName(String),
    /// Family entries match words of its id.
    ByFamily,
    /// No entry matches.
    Not {
        /// A similar known id.
        near: Option<String>,
    },
}

impl Catalogue {
    /// Returns the catalogue without any user's file.
    pub fn builtin() -> Catalogue {
        let empty = Catalogue {
            providers: Vec::new(),
            models: Vec::new(),
            gateways: Vec::new(),
        };
        empty
            .overlaid(BUILTIN, "models.toml")
            .expect("a test reads the embedded facts")
    }

    /// Overrides the catalogue with a file: fields given in an entry replace existing ones, others stay.
    ///
    /// `file` names it in errors.
    pub fn overlaid(mut self, text: &str, file: &str) -> Result<Catalogue, CatalogueError> {
        let read = file::read(text, file)?;
        let wrong = |line: usize, why: String| CatalogueError::Entry {
            file: file.to_owned(),
            line,
            why,
        };
        for AtLine { line, entry } in read.providers {
            self.lay_provider(entry).map_err(|why| wrong(line, why))?;
        }
        if let Some(lost) = self.providers.iter().find_map(|provider| {
            let other = provider.models_of.as_ref()?;
            self.provider(other)
                .is_err()
                .then_some((&provider.name, other))
        }) {
            let (name, other) = lost;
            return Err(wrong(
                1,
                format!("`{name}` has the models of `{other}`, which is not a provider"),
            ));
        }
        for AtLine { line, entry } in read.models {
            if let Some(Err(error)) = entry.provider.as_deref().map(|name| self.provider(name)) {
                return Err(wrong(line, error.to_string()));
            }
            self.lay_model(entry);
        }
        self.gateways.extend(read.gateways);
        Ok(self)
    }

    /// Overrides the catalogue with a file of at most 1 MiB.
    pub fn overlaid_by(self, path: &Path) -> Result<Catalogue, CatalogueError> {
        let name = path.display().to_string();
        let unreadable = |why: String| CatalogueError::Unreadable {
            file: name.clone(),
            why,
        };
        let text = files::read_text(path, file::MAX_BYTES as u64).map_err(unreadable)?;
        self.overlaid(&text, &name)
    }

    /// Returns all providers, in the file's order.
    pub fn providers(&self) -> &[Provider] {
        &self.providers
    }

    /// Returns a provider by its name.
    pub fn provider(&self, name: &str) -> Result<&Provider, CatalogueError> {
        let names = || self.providers.iter().map(|provider| provider.name.as_str());
        let found = self.providers.iter().find(|provider| provider.name == name);
        found.ok_or_else(|| CatalogueError::NoProvider {
            name: name.chars().take(40).collect(),
            near: nearest(name, names()).map(str::to_owned),
            among: among(names()),
        })
    }

    /// Returns the profiles of all models listed with an id or a name, at their first provider.
    ///
    /// If only a model's name is known, the name serves as the id.
    pub fn profiles(&self) -> Vec<Profile> {
        let listed = self.models.iter().filter_map(|entry| {
            let provider = self.provider(entry.provider.as_deref()?).ok()?;
            let (Subject::Id(id) | Subject::Name(id)) = &entry.subject else {
                return None;
            };
            Some(self.profile(provider, id))
        });
        listed.collect()
    }

    /// Returns the model families.
    pub fn families(&self) -> impl Iterator<Item = Family<'_>> {
        self.models.iter().filter_map(|entry| match &entry.subject {
            Subject::Part(part) => Some(Family {
                part,
                aliases: &entry.aliases,
                provider: entry.provider.as_deref(),
                facts: &entry.facts,
                sources: &entry.sources,
            }),
            Subject::Id(_) | Subject::Name(_) => None,
        })
    }

    /// Returns the prefixes of ids that are seen through, with their sources.
    pub fn gateways(&self) -> impl Iterator<Item = (&[String], &Source)> {
        let gateways = self.gateways.iter();
        gateways.map(|gateway| (gateway.prefixes.as_slice(), &gateway.source))
    }

    /// Finds a model by `PROVIDER:NAME`; for a name without a matching entry nothing is known.
    pub fn find(&self, model: &str) -> Result<Profile, CatalogueError> {
        let no_model = || CatalogueError::NoModel(model.chars().take(80).collect());
        let (provider, id) = model.split_once(':').ok_or_else(no_model)?;
        let provider = self.provider(provider)?;
        if !(1..=file::MAX_NAME).contains(&id.len()) || id.chars().any(char::is_control) {
            return Err(no_model());
        }
        Ok(self.profile(provider, id))
    }

    /// Collects what is known about an id at a provider.
    ///
    /// A vendor's entries also hold where another server stands before it, but for its interface: a gateway's prefix is
    /// seen through, and so is a server that passes the vendor's id on.
    fn profile(&self, provider: &Provider, id: &str) -> Profile {
        let prefixes: Vec<&str> = self
            .gateways
            .iter()
            .flat_map(|gateway| gateway.prefixes.iter().map(String::as_str))
            .collect();
        let bare = names::without_prefixes(id, &prefixes);
        let entries: Vec<(&ModelEntry, Reach)> = self
            .models
            .iter()
            .filter_map(|entry| Some((entry, self.reach(entry, provider)?)))
            .collect();
        let own = own_entries(&entries, id, bare);
        let mut families: Vec<(&ModelEntry, Reach, usize)> = entries
            .iter()
            .filter_map(|(entry, reach)| {
                let Subject::Part(part) = &entry.subject else {
                    return None;
                };
                let parts = std::iter::once(part).chain(&entry.aliases);
                let longest = parts
                    .filter(|part| names::holds(id, part))
                    .map(String::len)
                    .max()?;
                Some((*entry, *reach, longest))
            })
            .collect();
        // More specific families take precedence.
        families.sort_by_key(|(.., length)| std::cmp::Reverse(*length));
        let listed = match own.first().map(|(entry, _)| &entry.subject) {
            Some(Subject::Name(name)) => FactsSource::ByName(name.clone()),
            Some(_) => FactsSource::ById,
            None if !families.is_empty() => FactsSource::ByFamily,
            None => FactsSource::Not {
                near: nearest(
                    id,
                    entries
                        .iter()
                        .filter(|(entry, reach)| {
                            *reach == Reach::Whole && entry.facts.shutdown.is_none()
                        })
                        .filter_map(|(entry, _)| entry.id()),
                )
                .map(str::to_owned),
            },
        };
        let mut profile = Profile {
            provider: provider.clone(),
            id: id.to_owned(),
            listed,
            facts: Facts::default(),
            sources: Vec::new(),
        };
        let families = families.into_iter().map(|(entry, reach, _)| (entry, reach));
        for (entry, reach) in own.into_iter().chain(families) {
            profile.facts = match reach {
                Reach::Whole => profile.facts.or(&entry.facts),
                Reach::BehindAServer => profile.facts.or(&entry.facts.behind_a_server()),
            };
            let new = entry
                .sources
                .iter()
                .filter(|source| !profile.sources.contains(source));
            let new: Vec<Source> = new.cloned().collect();
            profile.sources.extend(new);
        }
        profile
    }

    /// Returns how much of an entry holds at a provider; `None`: nothing.
    fn reach(&self, entry: &ModelEntry, provider: &Provider) -> Option<Reach> {
        let Some(owner) = entry.provider.as_deref() else {
            return Some(Reach::Whole);
        };
        if owner == provider.owner() {
            return Some(Reach::Whole);
        }
        let is_vendors = |name: &str| {
            let provider = self.provider(name).ok();
            provider.is_some_and(|provider| provider.runs_on == Some(RunsOn::Vendor))
        };
        (is_vendors(owner) && !is_vendors(&provider.name)).then_some(Reach::BehindAServer)
    }

    fn lay_provider(&mut self, form: ProviderForm) -> Result<(), String> {
        let source = form.source();
        let known = self
            .providers
            .iter_mut()
            .find(|provider| provider.name == form.name);
        let Some(provider) = known else {
            let (Some(wire), Some(key)) = (form.wire, form.key) else {
                return Err(format!(
                    "the new provider `{}` needs `wire` and `key`",
                    form.name
                ));
            };
            self.providers.push(Provider {
                name: form.name,
                wire,
                base_url: form.base_url,
                key_env: form.key_env.unwrap_or_default(),
                key,
                runs_on: form.runs_on,
                models_of: form.models_of,
                start: form.start,
                reasoning: form.reasoning.unwrap_or_default(),
                sources: vec![source],
            });
            return Ok(());
        };
        provider.wire = form.wire.unwrap_or(provider.wire);
        provider.key = form.key.unwrap_or(provider.key);
        provider.base_url = form.base_url.or(provider.base_url.take());
        provider.runs_on = form.runs_on.or(provider.runs_on);
        provider.models_of = form.models_of.or(provider.models_of.take());
        provider.start = form.start.or(provider.start.take());
        if let Some(reasoning) = form.reasoning {
            provider.reasoning = reasoning.or(&provider.reasoning);
        }
        if let Some(names) = form.key_env {
            provider.key_env = names;
        }
        provider.sources.insert(0, source);
        Ok(())
    }

    fn lay_model(&mut self, entry: ModelEntry) {
        let is_same = |other: &&mut ModelEntry| {
            other.provider == entry.provider && other.subject == entry.subject
        };
        match self.models.iter_mut().find(is_same) {
            None => self.models.push(entry),
            Some(known) => {
                known.facts = entry.facts.or(&known.facts);
                known.aliases.extend(entry.aliases);
                known.sources.splice(..0, entry.sources);
            }
        }
    }
}

impl ModelEntry {
    fn id(&self) -> Option<&str> {
        match &self.subject {
            Subject::Id(id) => Some(id),
            Subject::Name(_) | Subject::Part(_) => None,
        }
    }
}

/// How much of an entry holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reach {
    /// All of it.
    Whole,
    /// What does not belong to the vendor's interface.
    BehindAServer,
}

/// Returns the entries of one model, most precise first: by its id, by an alias, the longest, or else by its name.
fn own_entries<'e>(
    entries: &[(&'e ModelEntry, Reach)],
    id: &str,
    bare: &str,
) -> Vec<(&'e ModelEntry, Reach)> {
    let fits = |(entry, _): &&(&'e ModelEntry, Reach)| {
        let aliases = entry.aliases.iter();
        let longest = aliases.filter(|alias| names::is_alias(bare, alias));
        longest.map(String::len).max()
    };
    let by_id = |id: &str| {
        entries
            .iter()
            .find(move |(entry, _)| entry.id() == Some(id))
    };
    let by_alias = entries
        .iter()
        .filter(|(entry, _)| !matches!(entry.subject, Subject::Part(_)))
        .filter(|entry| fits(entry).is_some())
        .max_by_key(fits);
    let found = [by_id(id), by_id(bare), by_alias];
    let mut own: Vec<_> = found.into_iter().flatten().copied().collect();
    own.dedup_by(|one, other| std::ptr::eq(one.0, other.0));
    if own.is_empty() {
        let by_name = entries.iter().find(|(entry, _)| {
            matches!(&entry.subject, Subject::Name(name) if name == bare || names::spells(bare, name))
        });
        own.extend(by_name);
    }
    own
}

impl Profile {
    /// Returns `PROVIDER:NAME`.
    pub fn title(&self) -> String {
        format!("{}:{}", self.provider.name, self.id)
    }

    /// Returns how the model gets points of a picture; see [`Facts::lowering`].
    pub fn lowering(&self) -> Lowering {
        self.facts.lowering()
    }

    /// Returns how the model takes `reasoning` at its provider.
    pub fn reasoning(&self) -> ReasoningFacts {
        let own = self.facts.reasoning.clone().unwrap_or_default();
        own.or(&self.provider.reasoning)
    }

    /// Returns whether no call is billed, because the user's own machine answers.
    pub fn is_free(&self) -> bool {
        self.provider.runs_on == Some(RunsOn::Own)
    }
}
