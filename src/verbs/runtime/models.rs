//! `fabc models`: the known facts about models, with their dates and sources.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::runtime::setting::catalogue;
use crate::verbs::runtime::setting::catalogue::FactsArguments;
use clap::Args;
use fab_providers::catalogue::{
    Catalogue, Date, Facts, FactsSource, Family, ImageTokens, Price, Profile, Provider, Source,
    Tokens,
};
use fab_providers::probe::SIDES_PX;
use serde_json::{Value, json};

/// How to write a file of facts.
const FORM: &str = "\
A file of facts has the form of the embedded one. The fields that an entry gives replace those there were, the others stay:

  [[model]]
  provider = \"vllm\"            # as in PROVIDER:NAME
  id = \"my-model\"              # or: part = \"qwen3-vl\", for all models with these words in their id
  coordinates = { unit = \"per_mille\", order = \"xy\" }   # pixels, fraction, percent, per_mille; xy, yx
  price = [{ input = 2, cached_input = 0.1, output = 10 }]  # USD per million tokens
  as_of = \"2026-11-20\"         # both are required
  source = \"fabc probe\"";

/// Arguments of `models`.
#[derive(Args)]
#[command(after_help = FORM)]
pub struct ModelsArguments {
    /// Only those of this provider.
    #[arg(value_name = "PROVIDER")]
    pub provider: Option<String>,
    #[command(flatten)]
    pub facts: FactsArguments,
    /// The day whose prices and warnings count; default: today.
    #[arg(long, value_name = "DATE")]
    pub on: Option<Date>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Lists the models.
pub fn run(arguments: &ModelsArguments, io: &Io) -> Result<Exit, Failure> {
    let catalogue = catalogue::load(arguments.facts.models.as_deref(), io)?;
    let today = arguments.on.unwrap_or_else(|| catalogue::today(io));
    let wanted = match &arguments.provider {
        None => None,
        Some(name) => {
            let found = catalogue.provider(name);
            Some(found.map_err(|error| Failure::usage(error.to_string()))?)
        }
    };
    let profiles = match wanted {
        None => catalogue.profiles(),
        Some(provider) => of_provider(&catalogue, provider)?,
    };
    let is_wanted = |at: Option<&str>| match (wanted, at) {
        (Some(wanted), Some(at)) => wanted.owner() == at,
        _ => true,
    };
    let families: Vec<Family<'_>> = catalogue
        .families()
        .filter(|family| is_wanted(family.provider))
        .collect();
    io.report(
        arguments.json,
        || as_json(&catalogue, &profiles, &families, today),
        || as_text(&catalogue, &profiles, &families, today),
    );
    Ok(Exit::Done)
}

fn of_provider(catalogue: &Catalogue, provider: &Provider) -> Result<Vec<Profile>, Failure> {
    let owner = provider.owner();
    let own = catalogue
        .profiles()
        .into_iter()
        .filter(|profile| profile.provider.name == owner);
    own.map(|profile| {
        catalogue
            .find(&format!("{}:{}", provider.name, profile.id))
            .map_err(Failure::environment)
    })
    .collect()
}

fn as_json(
    catalogue: &Catalogue,
    profiles: &[Profile],
    families: &[Family<'_>],
    today: Date,
) -> Value {
    let models = profiles.iter().map(|profile| {
        let (id, name) = match &profile.listed {
            FactsSource::ByName(name) => (None, Some(name)),
            _ => (Some(&profile.id), None),
        };
        let notices: Vec<Value> = shown_notices(profile, today)
            .map(|notice| {
                let mut value = json!(notice);
                value["message"] = json!(notice.to_string());
                value["warning"] = json!(notice.is_warning());
                value
            })
            .collect();
        let tokens = SIDES_PX.map(|side| image_tokens(profile.facts.image_tokens.as_ref(), side));
        json!({
            "provider": profile.provider.name,
            "id": id,
            "name": name,
            "facts": profile.facts,
            "price": profile.price_on(today),
            "image_tokens_224": tokens[0],
            "image_tokens_720": tokens[1],
            "undated": profile.is_moving(),
            "notices": notices,
            "sources": profile.sources,
        })
    });
    json!({
        "on": today,
        "providers": catalogue.providers(),
        "models": models.collect::<Vec<_>>(),
        "families": families,
        "gateways": catalogue
            .gateways()
            .map(|(prefixes, source)| json!({ "prefixes": prefixes, "source": source }))
            .collect::<Vec<_>>(),
    })
}

/// Returns the notices about a listed model, except that it has no id, which has a column of its own.
fn shown_notices(
    profile: &Profile,
    today: Date,
) -> impl Iterator<Item = fab_providers::catalogue::Notice> {
    use fab_providers::catalogue::Notice;
    profile
        .notices(today)
        .into_iter()
        .filter(|notice| !matches!(notice, Notice::ByName { .. }))
}

fn image_tokens(formula: Option<&ImageTokens>, side_px: u32) -> Option<Tokens> {
    formula.map(|formula| formula.of(side_px, side_px))
}

const HEADINGS: [&str; 9] = [
    "model",
    "USD/M in/cached/out",
    "vision",
    "schema",
    "temperature",
    "points",
    "tokens 224",
    "tokens 720",
    "source",
];

fn as_text(
    catalogue: &Catalogue,
    profiles: &[Profile],
    families: &[Family<'_>],
    today: Date,
) -> String {
    let mut sources: Vec<Source> = Vec::new();
    let mut rows: Vec<[String; 9]> = vec![HEADINGS.map(str::to_owned)];
    let mut notes = Vec::new();
    let (retired, current): (Vec<&Profile>, Vec<&Profile>) = profiles
        .iter()
        .partition(|profile| profile.facts.shutdown.is_some());
    for profile in current {
        let title = match &profile.listed {
            FactsSource::ByName(name) => format!("{}:? ({name})", profile.provider.name),
            _ => profile.title(),
        };
        let price = price(profile.price_on(today));
        let marks = footnotes(&profile.sources, &mut sources);
        rows.push(row(title.clone(), price, &profile.facts, marks));
        let changes = shown_notices(profile, today).filter(|notice| {
            matches!(
                notice,
                fab_providers::catalogue::Notice::PriceChanges { .. }
            )
        });
        notes.extend(changes.map(|notice| format!("{title}: {notice}")));
    }
    let (vendors, open): (Vec<&Family<'_>>, Vec<&Family<'_>>) = families
        .iter()
        .partition(|family| family.provider.is_some());
    let mut groups = vec![("", rows.len() - 1)];
    let mut other_names = Vec::new();
    for (title, families) in [
        ("Families of vendors:", vendors),
        ("Families of open weights, wherever they are served:", open),
    ] {
        groups.push((title, families.len()));
        for family in families {
            let words = format!("*{}*", family.part);
            let at = family
                .provider
                .map_or(String::new(), |name| format!("{name}:"));
            let marks = footnotes(family.sources, &mut sources);
            rows.push(row(
                format!("{at}{words}"),
                String::new(),
                family.facts,
                marks,
            ));
            if !family.aliases.is_empty() {
                other_names.push(format!("{}: {}", family.part, family.aliases.join(", ")));
            }
        }
    }
    let mut text = grouped(&table(&rows), &groups);
    text.push_str(
        "\n\n?: unknown. *: every model whose id has these words. tokens: estimates for one square picture. Another \
         server's model has its vendor's facts, but not its price and schema.\nCalls to models on your own machine are \
         never billed.",
    );
    for note in notes {
        text.push_str(&format!("\n{note}"));
    }
    for (title, lines) in [
        ("Other words for the same family:", other_names),
        (
            "Retired, or soon to be:",
            retired_lines(&retired, today, &mut sources),
        ),
        (
            "Seen through at the beginning of an id:",
            prefix_lines(catalogue, &mut sources),
        ),
    ] {
        if !lines.is_empty() {
            text.push_str(&format!("\n\n{title}\n{}", lines.join("\n")));
        }
    }
    text.push_str("\n\nSources:");
    for (number, source) in sources.iter().enumerate() {
        text.push_str(&format!(
            "\n[{}] {}: {}",
            number + 1,
            source.as_of,
            source.source
        ));
    }
    text
}

/// Returns a line for each day and replacement, with its models.
fn retired_lines(retired: &[&Profile], today: Date, sources: &mut Vec<Source>) -> Vec<String> {
    let mut groups: Vec<(Date, &Profile, Vec<&Profile>)> = Vec::new();
    for profile in retired {
        let Some(on) = profile.facts.shutdown else {
            continue;
        };
        let is_same = |first: &Profile| {
            first.facts.replaced_by == profile.facts.replaced_by
                && first.provider.name == profile.provider.name
        };
        match groups
            .iter_mut()
            .find(|(day, first, _)| *day == on && is_same(first))
        {
            Some((.., group)) => group.push(profile),
            None => groups.push((on, profile, vec![profile])),
        }
    }
    groups.sort_by_key(|(on, first, _)| (*on, first.provider.name.clone()));
    let line = |(on, first, group): (Date, &Profile, Vec<&Profile>)| {
        let ids: Vec<&str> = group.iter().map(|profile| profile.id.as_str()).collect();
        let instead = first.facts.replaced_by.as_ref();
        let instead = instead.map_or(String::new(), |id| format!("; its vendor recommends {id}"));
        let verb = if today.days_until(on) > 0 {
            "from"
        } else {
            "since"
        };
        let marks = footnotes(&first.sources, sources);
        format!(
            "{verb} {on}  {}: {}{instead} {marks}",
            first.provider.name,
            ids.join(", ")
        )
    };
    groups.into_iter().map(line).collect()
}

fn prefix_lines(catalogue: &Catalogue, sources: &mut Vec<Source>) -> Vec<String> {
    let line = |(prefixes, source): (&[String], &Source)| {
        let marks = footnotes(std::slice::from_ref(source), sources);
        format!("{} {marks}", prefixes.join(" "))
    };
    catalogue.gateways().map(line).collect()
}

fn row(title: String, price: String, facts: &Facts, marks: String) -> [String; 9] {
    let answer = |known: Option<bool>| {
        known
            .map_or("?", |yes| if yes { "yes" } else { "no" })
            .to_owned()
    };
    let tokens = |side| {
        let tokens = image_tokens(facts.image_tokens.as_ref(), side);
        tokens.map_or("?".to_owned(), |tokens| tokens.to_string())
    };
    [
        title,
        price,
        answer(facts.vision),
        answer(facts.structured_output),
        facts
            .temperature
            .as_ref()
            .map_or("?".to_owned(), |accepted| accepted.to_string()),
        facts
            .coordinates
            .map_or("?".to_owned(), |_| facts.lowering().to_string()),
        tokens(SIDES_PX[0]),
        tokens(SIDES_PX[1]),
        marks,
    ]
}

fn price(price: Option<Price>) -> String {
    price.map_or("?".to_owned(), |price| {
        let cached = price
            .cached_input
            .map_or("?".to_owned(), |dollars| dollars.to_string());
        format!("{} / {cached} / {}", price.input, price.output)
    })
}

/// Returns the numbers of sources, and adds new ones to the list.
fn footnotes(of: &[Source], sources: &mut Vec<Source>) -> String {
    let numbers = of.iter().map(|source| {
        let known = sources.iter().position(|known| known == source);
        let index = known.unwrap_or_else(|| {
            sources.push(source.clone());
            sources.len() - 1
        });
        format!("[{}]", index + 1)
    });
    numbers.collect::<Vec<_>>().join("")
}

/// Puts titles before groups of lines, after the line of headings; a group without lines is left out.
fn grouped(lines: &[String], groups: &[(&str, usize)]) -> String {
    let mut lines = lines.iter();
    let mut text = lines.next().cloned().unwrap_or_default();
    for (title, count) in groups {
        if *count > 0 && !title.is_empty() {
            text.push_str(&format!("\n\n{title}"));
        }
        for line in lines.by_ref().take(*count) {
            text.push_str(&format!("\n{line}"));
        }
    }
    text
}

fn table(rows: &[[String; 9]]) -> Vec<String> {
    let width = |column: usize| {
        rows.iter()
            .map(|row| row[column].chars().count())
            .max()
            .unwrap_or(0)
    };
    let widths: [usize; 9] = std::array::from_fn(width);
    let lines = rows.iter().map(|row| {
        let cells = row
            .iter()
            .zip(widths)
            .map(|(cell, width)| format!("{cell:<width$}"));
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    });
    lines.collect()
}
