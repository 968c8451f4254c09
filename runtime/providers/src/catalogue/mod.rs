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
pub use facts::{Accepted, Facts, MaxTokensField, PositionFormat};
pub use notice::Notice;
pub use price::{Price, Priced, SAFETY};
pub(crate) use provider::is_key_name;
pub use provider::{KeyNeed, Provider, RunsOn, Source, Wire};
pub use tokens::{Flat, ImageTokens, Patches, Tiles, Tokens};

use fab_base::files;
use fab_compiler::diag::{among, nearest};
use fab_model::Lowering;
use file::{AtLine, ModelEntry, ProviderForm, Subject};
use serde::Serialize;
use std::path::Path;

const BUILTIN: &str = include_str!("models.toml");

/// Everything known about models.
#[derive(Clone, Debug)]
pub struct Catalogue {
    providers: Vec<Provider>,
    models: Vec<ModelEntry>,
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

    /// Returns the model families: the common words of their ids, at which provider (`None`: at any), and their common
    /// facts.
    pub fn families(&self) -> impl Iterator<Item = (&str, Option<&str>, &Facts, &[Source])> {
        self.models.iter().filter_map(|entry| match &entry.subject {
            Subject::Part(part) => Some((
                part.as_str(),
                entry.provider.as_deref(),
                &entry.facts,
                entry.sources.as_slice(),
            )),
            Subject::Id(_) | Subject::Name(_) => None,
        })
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

    fn profile(&self, provider: &Provider, id: &str) -> Profile {
        let owner = provider.owner();
        let here = |entry: &&ModelEntry| entry.provider.as_deref().is_none_or(|name| name == owner);
        let entries: Vec<&ModelEntry> = self.models.iter().filter(here).collect();
        let own = own_entry(&entries, id);
        let mut families: Vec<(&ModelEntry, usize)> = entries
            .iter()
            .filter_map(|entry| {
                let Subject::Part(part) = &entry.subject else {
                    return None;
                };
                let parts = std::iter::once(part).chain(&entry.aliases);
                let longest = parts
                    .filter(|part| names::holds(id, part))
                    .map(String::len)
                    .max()?;
                Some((*entry, longest))
            })
            .collect();
        // More specific families take precedence.
        families.sort_by_key(|(_, length)| std::cmp::Reverse(*length));
        let listed = match own.map(|entry| &entry.subject) {
            Some(Subject::Name(name)) => FactsSource::ByName(name.clone()),
            Some(_) => FactsSource::ById,
            None if !families.is_empty() => FactsSource::ByFamily,
            None => FactsSource::Not {
                near: nearest(id, entries.iter().filter_map(|entry| entry.id())).map(str::to_owned),
            },
        };
        let mut profile = Profile {
            provider: provider.clone(),
            id: id.to_owned(),
            listed,
            facts: Facts::default(),
            sources: Vec::new(),
        };
        for entry in own
            .into_iter()
            .chain(families.into_iter().map(|(entry, _)| entry))
        {
            profile.facts = profile.facts.or(&entry.facts);
            let new = entry
                .sources
                .iter()
                .filter(|source| !profile.sources.contains(source));
            let new: Vec<Source> = new.cloned().collect();
            profile.sources.extend(new);
        }
        profile
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
                start_run: form.start_run.unwrap_or(false),
                sources: vec![source],
            });
            return Ok(());
        };
        provider.wire = form.wire.unwrap_or(provider.wire);
        provider.key = form.key.unwrap_or(provider.key);
        provider.base_url = form.base_url.or(provider.base_url.take());
        provider.runs_on = form.runs_on.or(provider.runs_on);
        provider.models_of = form.models_of.or(provider.models_of.take());
        if form.start.is_some() {
            // Nobody has run a command that a user wrote down.
            provider.start_run = false;
        }
        provider.start = form.start.or(provider.start.take());
        provider.start_run = form.start_run.unwrap_or(provider.start_run);
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

/// Returns the entry of one model: by its id, else by an alias, the longest first, else by its name.
fn own_entry<'e>(entries: &[&'e ModelEntry], id: &str) -> Option<&'e ModelEntry> {
    let by_id = || entries.iter().find(|entry| entry.id() == Some(id));
    let by_alias = || {
        let fits = |entry: &&&'e ModelEntry| {
            let longest = entry
                .aliases
                .iter()
                .filter(|alias| names::is_alias(id, alias));
            longest.map(String::len).max()
        };
        let named = entries
            .iter()
            .filter(|entry| !matches!(entry.subject, Subject::Part(_)));
        named.filter(|entry| fits(entry).is_some()).max_by_key(fits)
    };
    let by_name = || {
        entries.iter().find(|entry| {
            matches!(&entry.subject, Subject::Name(name) if name == id || names::spells(id, name))
        })
    };
    by_id().or_else(by_alias).or_else(by_name).copied()
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

    /// Returns whether no call is billed, because the user's own machine answers.
    pub fn is_free(&self) -> bool {
        self.provider.runs_on == Some(RunsOn::Own)
    }
}
