//! The catalogue of models and providers.
//!
//! In: the embedded files of `families/`, and a user's file of the same form, whose entries override all embedded ones.
//! Out: the [`Profile`] of a `PROVIDER:NAME`, and its prices. Each embedded entry states its source; what is absent is
//! unknown, and never guessed. Nothing here sends anything or reads the date.

mod date;
mod facts;
mod price;
mod provider;
#[cfg(test)]
mod tests;
pub mod tokens;

pub use date::Date;
pub use facts::{Accepted, Facts, MaxTokensField, PositionFormat, ReasoningFacts, ReasoningKind};
pub use price::{Price, SAFETY};
pub(crate) use provider::is_key_name;
pub use provider::{Provider, RunsOn, Wire};
pub use tokens::{ImageTokens, Tokens};

use fab_base::files::{self, line_of};
use fab_program::nearest::{among, nearest};
use rust_embed::Embed;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::Path;
use toml::{Spanned, Table};

/// One file for each family of models, or for providers alone; dropping another into the folder adds it.
#[derive(Embed)]
#[folder = "src/catalogue/families/"]
struct Families;

/// The longest file accepted, bytes.
const MAX_BYTES: u64 = 1 << 20;

/// What belongs to a vendor's interface, and so is unknown where another server stands before it.
const OF_THE_INTERFACE: [&str; 3] = ["price", "structured_output", "max_tokens_field"];

/// Everything known about models.
#[derive(Clone, Debug, Default)]
pub struct Catalogue {
    providers: Vec<Provider>,
    /// In the order in which they were read.
    entries: Vec<Entry>,
    /// How many of them are embedded; the others are the user's.
    n_embedded: usize,
}

/// Everything known about one model at one provider.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Profile {
    /// The provider that offers it.
    pub provider: Provider,
    /// The provider's id for it.
    pub id: String,
    /// The known facts.
    pub facts: Facts,
    /// The most similar id of another entry.
    pub near: Option<String>,
}

/// An entry's models, with all that is known of them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Listed {
    /// `PROVIDER:ID`, or `PROVIDER:BEGINNING*` for all ids that begin so; open weights have no provider.
    pub model: String,
    /// The facts.
    pub facts: Facts,
    /// Their sources; each overrides those after it.
    pub sources: Vec<Source>,
}

/// A source of facts.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Source {
    /// When they were gathered.
    pub as_of: Option<Date>,
    /// Their origin.
    pub source: Option<String>,
}

/// The structure of a file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    provider: Vec<Spanned<Table>>,
    #[serde(default)]
    model: Vec<Spanned<Table>>,
}

/// An entry without its facts.
#[derive(Clone, Debug, Deserialize)]
struct Head {
    /// The vendor, or the server; `None`: open weights, which answer alike wherever they are served.
    provider: Option<String>,
    /// The only id that the entry is about.
    id: Option<String>,
    /// Beginnings of ids that it is about.
    #[serde(default)]
    family: Vec<String>,
    #[serde(flatten)]
    origin: Source,
}

#[derive(Clone, Debug)]
struct Entry {
    head: Head,
    /// Facts as written; they were read once.
    facts: Table,
}

impl Catalogue {
    /// Returns the catalogue without any user's file.
    pub fn builtin() -> Catalogue {
        let names: BTreeSet<_> = Families::iter().collect();
        let catalogue = names.iter().fold(Catalogue::default(), |catalogue, name| {
            let file = Families::get(name).expect("its name was listed");
            let text = std::str::from_utf8(&file.data).expect("a test reads the embedded facts");
            let overlaid = catalogue.overlaid(text, name);
            overlaid.expect("a test reads the embedded facts")
        });
        Catalogue {
            n_embedded: catalogue.entries.len(),
            ..catalogue
        }
    }

    /// Overrides the catalogue with a file: fields given in an entry replace those of embedded ones, others stay.
    ///
    /// `file` names it in errors, with the line of what is wrong.
    pub fn overlaid(mut self, text: &str, file: &str) -> Result<Catalogue, String> {
        let wrong = |start, why: &str| format!("`{file}`, line {}: {why}", line_of(text, start));
        // Only the message: an excerpt of the file could show a key.
        let read: File = toml::from_str(text).map_err(|error| {
            let start = error.span().map_or(0, |span| span.start);
            wrong(start, error.message())
        })?;
        for entry in read.provider {
            let start = entry.span().start;
            let laid = self.lay_provider(entry.into_inner());
            laid.map_err(|why| wrong(start, &why))?;
        }
        for entry in read.model {
            let start = entry.span().start;
            let laid = self.lay_model(entry.into_inner());
            laid.map_err(|why| wrong(start, &why))?;
        }
        Ok(self)
    }

    /// Overrides the catalogue with a file of at most 1 MiB.
    pub fn overlaid_by(self, path: &Path) -> Result<Catalogue, String> {
        let name = path.display().to_string();
        let text = files::read_text(path, MAX_BYTES);
        let text = text.map_err(|why| format!("cannot read `{name}`: {why}"))?;
        self.overlaid(&text, &name)
    }

    fn lay_provider(&mut self, changes: Table) -> Result<(), String> {
        let name = changes.get("name").and_then(|name| name.as_str());
        let mut table = Table::new();
        let before = self.provider(name.unwrap_or_default()).ok();
        if let Some(before) = before {
            table = Table::try_from(before).map_err(|error| error.to_string())?;
        }
        table.extend(changes);
        let provider: Provider = from_table(table)?;
        match { self.providers.iter_mut() }.find(|it| it.name == provider.name) {
            Some(before) => *before = provider,
            None => self.providers.push(provider),
        }
        Ok(())
    }

    fn lay_model(&mut self, mut facts: Table) -> Result<(), String> {
        let names = ["provider", "id", "family", "as_of", "source"];
        let head = names.map(|name| Some((name.to_owned(), facts.remove(name)?)));
        let head: Head = from_table(head.into_iter().flatten().collect())?;
        if head.id.is_none() && head.family.is_empty() {
            return Err("a model needs `id`, or `family` with the beginnings of ids".to_owned());
        }
        if let Some(name) = &head.provider {
            self.provider(name)?;
        } else if head.id.is_some() {
            return Err("a model with `id` needs `provider`: ids are a provider's".to_owned());
        }
        let read: Facts = from_table(facts.clone())?;
        { read.price.iter().flatten() }.try_for_each(Price::check)?;
        self.entries.push(Entry { head, facts });
        Ok(())
    }

    /// Returns all providers, in the order of their files.
    pub fn providers(&self) -> &[Provider] {
        &self.providers
    }

    /// Returns a provider by its name; fails with the one that was probably meant, and all of them.
    pub fn provider(&self, name: &str) -> Result<&Provider, String> {
        let names = || self.providers.iter().map(|provider| provider.name.as_str());
        let found = self.providers.iter().find(|provider| provider.name == name);
        found.ok_or_else(|| {
            let near = meant(nearest(name, names()));
            let all = among(names());
            format!("there is no provider `{name}`{near}; there is {all}")
        })
    }

    /// Finds a model by `PROVIDER:NAME`; for a name that matches no entry nothing is known.
    pub fn find(&self, model: &str) -> Result<Profile, String> {
        let split = model.split_once(':');
        let split = split.filter(|(_, id)| !id.is_empty() && !id.chars().any(char::is_control));
        let (provider, id) = split
            .ok_or_else(|| format!("`{model}` is not a model; write PROVIDER:NAME, on one line"))?;
        let provider = self.provider(provider)?;
        let (facts, _) = self.known(Some(provider), id);
        let of_provider = |entry: &&Entry| entry.head.provider.as_deref() == Some(provider.owner());
        let ids = self.entries.iter().filter(of_provider);
        let near = nearest(id, ids.filter_map(|entry| entry.head.id.as_deref()));
        Ok(Profile {
            provider: provider.clone(),
            id: id.to_owned(),
            facts,
            near: near.filter(|near| *near != id).map(str::to_owned),
        })
    }

    /// Lists the models of all entries that hold at a provider, or of all; open weights come last.
    pub fn listed(&self, wanted: Option<&Provider>) -> Vec<Listed> {
        let mut heads: Vec<&Head> = self.entries.iter().map(|entry| &entry.head).collect();
        heads.sort_by_key(|head| head.provider.is_none());
        let mut listed: Vec<Listed> = Vec::new();
        for head in heads {
            let owner = head.provider.as_deref();
            if wanted.is_some_and(|wanted| owner.is_some_and(|owner| wanted.owner() != owner)) {
                continue;
            }
            let provider = owner.and_then(|owner| wanted.or(self.provider(owner).ok()));
            let (name, end) = match &head.id {
                Some(id) => (id.as_str(), ""),
                None => (head.family[0].as_str(), "*"),
            };
            let at = provider.map_or(String::new(), |provider| format!("{}:", provider.name));
            let model = format!("{at}{name}{end}");
            if listed.iter().all(|it| it.model != model) {
                let (facts, sources) = self.known(provider, name);
                listed.push(Listed {
                    model,
                    facts,
                    sources,
                });
            }
        }
        listed
    }

    /// Joins what is known about an id at a provider: the user's entries count before embedded ones, then the entry of
    /// this id before families, and among these the one with the longest beginning.
    fn known(&self, provider: Option<&Provider>, id: &str) -> (Facts, Vec<Source>) {
        let entries = self.entries.iter().enumerate();
        let entries = entries.filter_map(|(index, entry)| {
            let facts = self.facts_at(entry, provider)?;
            let rank = (index >= self.n_embedded, fit(&entry.head, id)?);
            Some((rank, &entry.head, facts))
        });
        let mut entries: Vec<_> = entries.collect();
        // Stable: of two that fit alike, the later one overrides.
        entries.sort_by_key(|(rank, ..)| *rank);
        let (mut facts, mut sources) = (Table::new(), Vec::new());
        for (_, head, own) in entries {
            facts.extend(own);
            sources.retain(|other| *other != head.origin);
            sources.insert(0, head.origin.clone());
        }
        let facts = from_table(facts).expect("whole facts were read, and replace each other");
        (facts, sources)
    }

    /// Returns an entry's facts as far as they hold at a provider; `None`: not at all.
    fn facts_at(&self, entry: &Entry, provider: Option<&Provider>) -> Option<Table> {
        let mut facts = entry.facts.clone();
        let Some(owner) = entry.head.provider.as_deref() else {
            return Some(facts);
        };
        let provider = provider?;
        if owner != provider.owner() {
            let is_vendor = |provider: &Provider| provider.runs_on == Some(RunsOn::Vendor);
            if is_vendor(provider) || !self.provider(owner).is_ok_and(is_vendor) {
                return None;
            }
            // A server that passes a vendor's model on.
            facts.retain(|name, _| !OF_THE_INTERFACE.contains(&name));
        }
        Some(facts)
    }
}

/// Returns how well an entry fits an id; `None`: not at all.
fn fit(head: &Head, id: &str) -> Option<usize> {
    // What stands before the last `/` names who serves or packed the model.
    let last = id.rsplit('/').next().unwrap_or(id);
    let [whole, last] = [id, last].map(comparable);
    let own = head.id.as_deref().map(comparable);
    if own.is_some_and(|own| own == whole || own == last) {
        return Some(usize::MAX);
    }
    let family = head.family.iter().map(|family| comparable(family));
    let fitting = family.filter(|family| last.starts_with(family));
    fitting.map(|family| family.len()).max()
}

/// Returns an id, or the beginning of one, in lower case and with `-` for each separator.
fn comparable(id: &str) -> String {
    let id = id.chars().flat_map(char::to_lowercase);
    let is_separator = |c: &char| !c.is_alphanumeric() && *c != '.';
    let separated = id.map(|c| if is_separator(&c) { '-' } else { c });
    separated.collect()
}

fn from_table<T: for<'de> Deserialize<'de>>(table: Table) -> Result<T, String> {
    let read = table.try_into();
    read.map_err(|error: toml::de::Error| error.to_string().trim_end().replace('\n', " "))
}

fn meant(near: Option<&str>) -> String {
    near.map_or(String::new(), |near| format!(" (did you mean `{near}`?)"))
}

impl Profile {
    /// Returns `PROVIDER:NAME`.
    pub fn title(&self) -> String {
        format!("{}:{}", self.provider.name, self.id)
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

    /// Returns what makes a run with the model likely to mislead, in words.
    pub fn warning(&self) -> Option<String> {
        let near = meant(self.near.as_deref());
        self.facts.coordinates.is_none().then(|| {
            format!(
                "it is not known how it states positions in a picture{near}: `fabc probe` finds out"
            )
        })
    }
}
