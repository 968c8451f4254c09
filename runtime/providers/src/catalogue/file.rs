//! Parses and validates files of facts.
//!
//! In: TOML text. Out: providers and models with their given fields, or an error with file and line.
//! [`super::Catalogue::overlaid`] merges files.

use super::date::Date;
use super::facts::{Accepted, Facts, MaxTokensField, PositionFormat, ReasoningFacts};
use super::price::Price;
use super::provider::is_key_name;
use super::tokens::ImageTokens;
use super::{CatalogueError, KeyNeed, RunsOn, Source, Wire};
use fab_base::files::line_of;
use serde::Deserialize;
use toml::Spanned;

/// The longest file accepted, bytes.
pub(super) const MAX_BYTES: usize = 1 << 20;
/// The longest id, name or address, bytes.
pub(super) const MAX_NAME: usize = 200;
/// The largest count in a file, so that no sum of tokens overflows.
const MOST: u32 = 100_000;

/// The structure of a file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Form {
    #[serde(default)]
    provider: Vec<Spanned<ProviderForm>>,
    #[serde(default)]
    model: Vec<Spanned<ModelForm>>,
    #[serde(default)]
    retired: Vec<Spanned<RetiredForm>>,
    #[serde(default)]
    gateway: Vec<Spanned<GatewayForm>>,
}

/// One provider of a file, with its given fields.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ProviderForm {
    pub name: String,
    pub wire: Option<Wire>,
    pub base_url: Option<String>,
    pub key_env: Option<Vec<String>>,
    pub key: Option<KeyNeed>,
    pub runs_on: Option<RunsOn>,
    pub models_of: Option<String>,
    pub start: Option<String>,
    pub reasoning: Option<ReasoningFacts>,
    as_of: Date,
    source: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ModelForm {
    provider: Option<String>,
    id: Option<String>,
    name: Option<String>,
    part: Option<String>,
    #[serde(default)]
    aliases: Vec<String>,
    vision: Option<bool>,
    several_pictures: Option<bool>,
    structured_output: Option<bool>,
    temperature: Option<Accepted>,
    top_p: Option<Accepted>,
    reasoning: Option<ReasoningFacts>,
    max_tokens_field: Option<MaxTokensField>,
    largest_side_px: Option<u32>,
    largest_area_px: Option<u64>,
    image_tokens: Option<ImageTokens>,
    coordinates: Option<PositionFormat>,
    price: Option<Vec<Price>>,
    shutdown: Option<Date>,
    replaced_by: Option<String>,
    moving: Option<bool>,
    /// Further facts, each with its own source.
    #[serde(default)]
    more: Vec<ModelForm>,
    as_of: Date,
    source: String,
}

/// Models that a vendor shuts down on one day.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RetiredForm {
    provider: String,
    on: Date,
    ids: Vec<String>,
    instead: Option<String>,
    as_of: Date,
    source: String,
}

/// Beginnings of ids that only say on which way a model is reached.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct GatewayForm {
    prefixes: Vec<String>,
    as_of: Date,
    source: String,
}

/// What an entry is about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Subject {
    /// The model with this id.
    Id(String),
    /// The model with this name; its id is unknown.
    Name(String),
    /// All models whose id contains these words.
    Part(String),
}

/// One model of a file, with its given facts.
#[derive(Clone, Debug)]
pub(super) struct ModelEntry {
    pub provider: Option<String>,
    pub subject: Subject,
    pub aliases: Vec<String>,
    pub facts: Facts,
    pub sources: Vec<Source>,
}

/// Prefixes of ids, with their source.
#[derive(Clone, Debug)]
pub(super) struct Gateway {
    pub prefixes: Vec<String>,
    pub source: Source,
}

/// An entry with its first line's number, from 1.
pub(super) struct AtLine<T> {
    pub line: usize,
    pub entry: T,
}

/// The contents of a file.
pub(super) struct Read {
    pub providers: Vec<AtLine<ProviderForm>>,
    pub models: Vec<AtLine<ModelEntry>>,
    pub gateways: Vec<Gateway>,
}

impl ProviderForm {
    pub(super) fn source(&self) -> Source {
        Source {
            as_of: self.as_of,
            source: self.source.clone(),
        }
    }
}

/// Reads a file; `name` names it in errors.
pub(super) fn read(text: &str, name: &str) -> Result<Read, CatalogueError> {
    let shape = |why: String| CatalogueError::Shape {
        file: name.to_owned(),
        why,
    };
    if text.len() > MAX_BYTES {
        return Err(shape(format!(
            "it is longer than the limit of {MAX_BYTES} bytes"
        )));
    }
    let form: Form =
        toml::from_str(text).map_err(|error| shape(error.to_string().trim_end().to_owned()))?;
    let wrong = |line: usize, why: String| CatalogueError::Entry {
        file: name.to_owned(),
        line,
        why,
    };
    let mut read = Read {
        providers: Vec::new(),
        models: Vec::new(),
        gateways: Vec::new(),
    };
    for spanned in form.provider {
        let line = line_of(text, spanned.span().start);
        let entry = spanned.into_inner();
        check_provider(&entry).map_err(|why| wrong(line, why))?;
        if read
            .providers
            .iter()
            .any(|other| other.entry.name == entry.name)
        {
            return Err(wrong(
                line,
                format!("the provider `{}` is there twice", entry.name),
            ));
        }
        read.providers.push(AtLine { line, entry });
    }
    for spanned in form.model {
        let line = line_of(text, spanned.span().start);
        let entry = model(spanned.into_inner()).map_err(|why| wrong(line, why))?;
        let is_same = |other: &AtLine<ModelEntry>| {
            other.entry.provider == entry.provider && other.entry.subject == entry.subject
        };
        if read.models.iter().any(is_same) {
            return Err(wrong(
                line,
                format!("{} is there twice", entry.subject.words()),
            ));
        }
        read.models.push(AtLine { line, entry });
    }
    for spanned in form.retired {
        let line = line_of(text, spanned.span().start);
        let entries = retired(spanned.into_inner()).map_err(|why| wrong(line, why))?;
        let entries = entries.into_iter().map(|entry| AtLine { line, entry });
        read.models.extend(entries);
    }
    for spanned in form.gateway {
        let line = line_of(text, spanned.span().start);
        let entry = gateway(spanned.into_inner()).map_err(|why| wrong(line, why))?;
        read.gateways.push(entry);
    }
    Ok(read)
}

impl Subject {
    pub(super) fn words(&self) -> String {
        match self {
            Subject::Id(id) => format!("the id `{id}`"),
            Subject::Name(name) => format!("the name `{name}`"),
            Subject::Part(part) => format!("the part `{part}`"),
        }
    }
}

fn model(mut form: ModelForm) -> Result<ModelEntry, String> {
    let subject = match (form.id.take(), form.name.take(), form.part.take()) {
        (Some(id), None, None) => Subject::Id(id),
        (None, Some(name), None) => Subject::Name(name),
        (None, None, Some(part)) => Subject::Part(part),
        _ => return Err("a model needs one of `id`, `name` and `part`".to_owned()),
    };
    let provider = form.provider.take();
    if provider.is_none() && !matches!(subject, Subject::Part(_)) {
        return Err(
            "a model without `provider` needs `part`: it holds wherever the model is served"
                .to_owned(),
        );
    }
    let (Subject::Id(named) | Subject::Name(named) | Subject::Part(named)) = &subject;
    plain("id", named)?;
    provider
        .iter()
        .try_for_each(|name| plain("provider", name))?;
    let aliases = std::mem::take(&mut form.aliases);
    aliases
        .iter()
        .try_for_each(|alias| plain("aliases", alias))?;
    let more = std::mem::take(&mut form.more);
    let (mut facts, source) = sourced_facts(form)?;
    let mut sources = vec![source];
    for form in more {
        let names_a_model = form.id.is_some() || form.name.is_some() || form.part.is_some();
        if names_a_model
            || form.provider.is_some()
            || !(form.aliases.is_empty() && form.more.is_empty())
        {
            return Err(
                "`more` holds facts with their source; the model is named above it".to_owned(),
            );
        }
        let (others, source) = sourced_facts(form)?;
        facts = facts.or(&others);
        sources.push(source);
    }
    Ok(ModelEntry {
        provider,
        subject,
        aliases,
        facts,
        sources,
    })
}

fn sourced_facts(form: ModelForm) -> Result<(Facts, Source), String> {
    form.replaced_by
        .iter()
        .try_for_each(|id| plain("replaced_by", id))?;
    let source = sourced(form.as_of, form.source)?;
    let mut facts = Facts {
        vision: form.vision,
        several_pictures: form.several_pictures,
        structured_output: form.structured_output,
        temperature: form.temperature,
        top_p: form.top_p,
        reasoning: form.reasoning,
        max_tokens_field: form.max_tokens_field,
        largest_side_px: form.largest_side_px,
        largest_area_px: form.largest_area_px,
        image_tokens: form.image_tokens,
        coordinates: form.coordinates,
        price: form.price,
        shutdown: form.shutdown,
        replaced_by: form.replaced_by,
        moving: form.moving,
    };
    facts.reasoning.as_ref().map_or(Ok(()), check_reasoning)?;
    check_facts(&facts)?;
    if let Some(prices) = &mut facts.price {
        prices.sort_by_key(|price| price.from);
    }
    Ok((facts, source))
}

/// Makes an entry of each id; one that ends in `*` stands for all ids that begin so.
fn retired(form: RetiredForm) -> Result<Vec<ModelEntry>, String> {
    plain("provider", &form.provider)?;
    form.instead
        .iter()
        .try_for_each(|id| plain("instead", id))?;
    form.ids.iter().try_for_each(|id| plain("ids", id))?;
    let source = sourced(form.as_of, form.source)?;
    let entry = |id: String| ModelEntry {
        provider: Some(form.provider.clone()),
        aliases: id.ends_with('*').then(|| id.clone()).into_iter().collect(),
        subject: Subject::Id(id),
        facts: Facts {
            shutdown: Some(form.on),
            replaced_by: form.instead.clone(),
            ..Facts::default()
        },
        sources: vec![source.clone()],
    };
    Ok(form.ids.into_iter().map(entry).collect())
}

fn gateway(form: GatewayForm) -> Result<Gateway, String> {
    for prefix in &form.prefixes {
        plain("prefixes", prefix)?;
        // Without a separator `open` would also be seen in `openai-community/…`.
        if !prefix.ends_with(['/', '.', ':']) {
            return Err(format!(
                "the prefix `{prefix}` ends in neither `/`, `.` nor `:`"
            ));
        }
    }
    let source = sourced(form.as_of, form.source)?;
    Ok(Gateway {
        prefixes: form.prefixes,
        source,
    })
}

fn check_provider(entry: &ProviderForm) -> Result<(), String> {
    let is_name = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    if entry.name.is_empty() || entry.name.len() > 40 || !entry.name.chars().all(is_name) {
        return Err(format!(
            "`name = {:?}` is not 1 to 40 small letters, digits or `-`",
            entry.name
        ));
    }
    if let Some(url) = &entry.base_url {
        plain("base_url", url)?;
        // Something that looks like a key must not be repeated in a message, a table, or anything else.
        if url.contains(['@', '?', '#']) {
            return Err("`base_url` holds `@`, `?` or `#`; it is an address alone, and a key has no place in it".to_owned());
        }
        if !url.starts_with("https://") && !url.starts_with("http://") {
            return Err(format!(
                "`base_url = {url:?}` begins with neither `https://` nor `http://`"
            ));
        }
    }
    for name in entry.key_env.iter().flatten() {
        // A key put here by mistake must not be repeated in a message.
        if !is_key_name(name) {
            return Err(
                "`key_env` lists names of variables, such as `OPENAI_API_KEY`, and never keys"
                    .to_owned(),
            );
        }
    }
    entry
        .models_of
        .iter()
        .try_for_each(|name| plain("models_of", name))?;
    entry
        .start
        .iter()
        .try_for_each(|command| plain("start", command))?;
    entry.reasoning.as_ref().map_or(Ok(()), check_reasoning)?;
    sourced(entry.as_of, entry.source.clone()).map(drop)
}

fn check_reasoning(facts: &ReasoningFacts) -> Result<(), String> {
    if let Some(least) = facts
        .least_tokens
        .filter(|least| !(1..=MOST).contains(least))
    {
        return Err(format!("`least_tokens = {least}` is not from 1 to {MOST}"));
    }
    // No other field of a request has such a name, so it cannot replace one.
    let is_budget = |name: &&String| {
        let is_part = |c: char| c.is_ascii_lowercase() || c == '_';
        name.len() <= 40 && name.contains("budget") && name.chars().all(is_part)
    };
    match facts.tokens_field.as_ref().filter(|name| !is_budget(name)) {
        Some(name) => Err(format!(
            "`tokens_field = {name:?}` is not a name such as `thinking_token_budget`"
        )),
        None => Ok(()),
    }
}

fn check_facts(facts: &Facts) -> Result<(), String> {
    for (key, accepted) in [("temperature", &facts.temperature), ("top_p", &facts.top_p)] {
        let is_right = match accepted {
            None | Some(Accepted::Refused) => true,
            Some(Accepted::Only(values)) => {
                !values.is_empty() && values.iter().all(|value| value.is_finite())
            }
            Some(Accepted::Range([least, most])) => {
                least.is_finite() && most.is_finite() && least <= most
            }
        };
        if !is_right {
            return Err(format!(
                "`{key}` needs finite numbers: `{{ only = [1] }}`, `{{ range = [0, 2] }}` or `\"refused\"`"
            ));
        }
    }
    let counts: Vec<(&str, u32)> = match facts.image_tokens {
        None => Vec::new(),
        Some(ImageTokens::Patches(it)) => vec![("side_px", it.side_px), ("percent", it.percent)],
        Some(ImageTokens::Tiles(it)) => vec![
            ("side_px", it.side_px),
            ("short_side_px", it.short_side_px),
            ("each", it.each),
            ("base", it.base.max(1)),
        ],
        Some(ImageTokens::Flat(it)) if it.at_least > it.at_most => {
            return Err(format!(
                "`flat` has more tokens at least ({}) than at most ({})",
                it.at_least, it.at_most
            ));
        }
        Some(ImageTokens::Flat(it)) => vec![("at_most", it.at_most)],
    };
    let multiples = facts.coordinates.and_then(|habit| habit.multiples_of_px);
    let sides = multiples.map(|step| ("multiples_of_px", step)).into_iter();
    let sides = sides.chain(facts.largest_side_px.map(|side| ("largest_side_px", side)));
    for (key, count) in counts.into_iter().chain(sides) {
        if !(1..=MOST).contains(&count) {
            return Err(format!("`{key} = {count}` is not from 1 to {MOST}"));
        }
    }
    check_prices(facts.price.as_deref().unwrap_or_default())
}

fn check_prices(prices: &[Price]) -> Result<(), String> {
    for (number, price) in prices.iter().enumerate() {
        for dollars in [Some(price.input), price.cached_input, Some(price.output)]
            .into_iter()
            .flatten()
        {
            if !(0.0..=Price::MOST).contains(&dollars) {
                return Err(format!(
                    "the price {dollars} is not from 0 to {} USD per million tokens",
                    Price::MOST
                ));
            }
        }
        if prices[..number]
            .iter()
            .any(|other| other.from == price.from)
        {
            let from = price
                .from
                .map_or("no day".to_owned(), |from| from.to_string());
            return Err(format!(
                "two prices count from {from}; all but one need a day of their own in `from`"
            ));
        }
    }
    Ok(())
}

fn sourced(as_of: Date, source: String) -> Result<Source, String> {
    if source.trim().is_empty() {
        return Err("`source` is empty; say where the facts are from".to_owned());
    }
    Ok(Source { as_of, source })
}

/// Restricts sent or printed text to one short line.
fn plain(key: &str, text: &str) -> Result<(), String> {
    if (1..=MAX_NAME).contains(&text.len()) && !text.chars().any(char::is_control) {
        return Ok(());
    }
    Err(format!("`{key}` is not 1 to {MAX_NAME} bytes on one line"))
}
