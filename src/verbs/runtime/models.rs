//! `fabc models`: the known facts about models, with their dates and sources.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::report::Report;
use crate::verbs::runtime::setting::catalogue::{self, FactsArguments};
use clap::Args;
use fab_base::table::{Align, aligned};
use fab_providers::catalogue::{
    Catalogue, Date, Facts, FactsSource, Family, Notice, Price, Profile, Provider, Source, Tokens,
};
use fab_providers::probe::SIDES_PX;
use serde::Serialize;

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

/// What is known.
#[derive(Serialize)]
struct KnownModels<'c> {
    on: Date,
    providers: &'c [Provider],
    models: Vec<KnownModel>,
    families: Vec<Family<'c>>,
}

/// What is known of one model.
#[derive(Serialize)]
struct KnownModel {
    provider: String,
    id: Option<String>,
    /// Its vendor's name, where no id is known.
    name: Option<String>,
    facts: Facts,
    price: Option<Price>,
    image_tokens_224: Option<Tokens>,
    image_tokens_720: Option<Tokens>,
    undated: bool,
    notices: Vec<WordedNotice>,
    sources: Vec<Source>,
}

#[derive(Serialize)]
struct WordedNotice {
    #[serde(flatten)]
    notice: Notice,
    message: String,
    warning: bool,
}

/// Lists the models.
pub fn run(arguments: &ModelsArguments, io: &Io) -> Result<Exit, Failure> {
    let catalogue = catalogue::load(arguments.facts.models.as_deref(), io)?;
    let today = arguments.on.unwrap_or_else(|| catalogue::today(io));
    let wanted = arguments.provider.as_deref();
    let wanted = wanted.map(|name| catalogue.provider(name)).transpose();
    let wanted = wanted.map_err(|error| Failure::usage(error.to_string()))?;
    let profiles = match wanted {
        None => catalogue.profiles(),
        Some(provider) => of_provider(&catalogue, provider)?,
    };
    let is_wanted = |at: Option<&str>| match (wanted, at) {
        (Some(wanted), Some(at)) => wanted.owner() == at,
        _ => true,
    };
    let known = KnownModels {
        on: today,
        providers: catalogue.providers(),
        models: { profiles.into_iter() }
            .map(|profile| KnownModel::of(profile, today))
            .collect(),
        families: { catalogue.families() }
            .filter(|family| is_wanted(family.provider))
            .collect(),
    };
    io.result(arguments.json, &known);
    Ok(Exit::Done)
}

fn of_provider(catalogue: &Catalogue, provider: &Provider) -> Result<Vec<Profile>, Failure> {
    let mut own = catalogue.profiles();
    own.retain(|profile| profile.provider.name == provider.owner());
    let ids = own
        .iter()
        .map(|own| format!("{}:{}", provider.name, own.id));
    ids.map(|id| catalogue.find(&id).map_err(Failure::environment))
        .collect()
}

impl KnownModel {
    fn of(profile: Profile, today: Date) -> KnownModel {
        // That it has no id is told by its name.
        let notices = profile.notices(today).into_iter();
        let notices = notices.filter(|notice| !matches!(notice, Notice::ByName { .. }));
        let notices = notices.map(|notice| WordedNotice {
            message: notice.to_string(),
            warning: notice.is_warning(),
            notice,
        });
        let [image_tokens_224, image_tokens_720] = image_tokens(&profile.facts);
        let (id, name) = match &profile.listed {
            FactsSource::ByName(name) => (None, Some(name.clone())),
            _ => (Some(profile.id.clone()), None),
        };
        KnownModel {
            id,
            name,
            price: profile.price_on(today),
            image_tokens_224,
            image_tokens_720,
            undated: profile.is_moving(),
            notices: notices.collect(),
            provider: profile.provider.name,
            facts: profile.facts,
            sources: profile.sources,
        }
    }

    fn title(&self) -> String {
        match (&self.id, &self.name) {
            (Some(id), _) => format!("{}:{id}", self.provider),
            (None, name) => {
                format!("{}:? ({})", self.provider, name.as_deref().unwrap_or("?"))
            }
        }
    }
}

/// Returns the tokens of a square picture for each of the cameras' sides.
fn image_tokens(facts: &Facts) -> [Option<Tokens>; 2] {
    let formula = facts.image_tokens.as_ref();
    SIDES_PX.map(|side| formula.map(|formula| formula.of(side, side)))
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

impl Report for KnownModels<'_> {
    fn text(&self) -> String {
        let mut sources = Footnotes(Vec::new());
        let mut table = vec![HEADINGS.map(str::to_owned)];
        let (retired, current): (Vec<_>, Vec<_>) = self
            .models
            .iter()
            .partition(|model| model.facts.shutdown.is_some());
        for model in &current {
            let marks = sources.marks(&model.sources);
            table.push(row(model.title(), price(model.price), &model.facts, marks));
        }
        for family in &self.families {
            let at = family
                .provider
                .map_or(String::new(), |name| format!("{name}:"));
            let marks = sources.marks(family.sources);
            let title = format!("{at}*{}*", family.part);
            table.push(row(title, String::new(), family.facts, marks));
        }
        let mut lines = aligned([Align::Left; 9], &table);
        if !self.families.is_empty() {
            let at = current.len() + 1;
            lines.splice(
                at..at,
                [
                    String::new(),
                    "Families, with their vendor unless the weights are open:".to_owned(),
                ],
            );
        }
        lines.push(
            "\n?: unknown. *: every model whose id has these words. tokens: estimates for one square picture. Another \
             server's model has its vendor's facts, but not its price and schema.\nCalls to models on your own machine \
             are never billed."
                .to_owned(),
        );
        for model in &current {
            let changes = model
                .notices
                .iter()
                .filter(|it| matches!(it.notice, Notice::PriceChanges { .. }));
            lines.extend(changes.map(|it| format!("{}: {}", model.title(), it.message)));
        }
        if !retired.is_empty() {
            lines.push("\nRetired, or soon to be:".to_owned());
            lines.extend(self.retired(retired, &mut sources));
        }
        lines.push("\nSources:".to_owned());
        let sources = sources.0.iter().zip(1..);
        lines.extend(
            sources
                .map(|(Source { as_of, source }, number)| format!("[{number}] {as_of}: {source}")),
        );
        lines.join("\n")
    }
}

impl KnownModels<'_> {
    /// Returns a line for each day and replacement, with its models.
    fn retired(&self, mut retired: Vec<&KnownModel>, sources: &mut Footnotes) -> Vec<String> {
        let of = |model: &&KnownModel| {
            let KnownModel {
                facts, provider, ..
            } = model;
            (facts.shutdown, provider.clone(), facts.replaced_by.clone())
        };
        retired.sort_by_key(of);
        let line = |group: &[&KnownModel]| {
            let (on, provider, instead) = of(&group[0]);
            let on = on?;
            let since = if self.on.days_until(on) > 0 {
                "from"
            } else {
                "since"
            };
            let ids: Vec<&str> = group
                .iter()
                .filter_map(|model| model.id.as_deref())
                .collect();
            let instead =
                instead.map_or(String::new(), |id| format!("; its vendor recommends {id}"));
            let marks = sources.marks(&group[0].sources);
            Some(format!(
                "{since} {on}  {provider}: {}{instead} {marks}",
                ids.join(", ")
            ))
        };
        retired
            .chunk_by(|a, b| of(a) == of(b))
            .filter_map(line)
            .collect()
    }
}

/// Sources by their numbers, from 1.
struct Footnotes(Vec<Source>);

impl Footnotes {
    /// Returns the numbers of sources, and adds new ones.
    fn marks(&mut self, sources: &[Source]) -> String {
        let number = |source: &Source| {
            let known = self.0.iter().position(|known| known == source);
            let index = known.unwrap_or_else(|| {
                self.0.push(source.clone());
                self.0.len() - 1
            });
            format!("[{}]", index + 1)
        };
        sources.iter().map(number).collect()
    }
}

fn row(title: String, price: String, facts: &Facts, marks: String) -> [String; 9] {
    let or_unknown = |known: Option<String>| known.unwrap_or("?".to_owned());
    let answer = |known: Option<bool>| {
        or_unknown(known.map(|yes| if yes { "yes" } else { "no" }.to_owned()))
    };
    let [small, large] =
        image_tokens(facts).map(|tokens| or_unknown(tokens.map(|it| it.to_string())));
    [
        title,
        price,
        answer(facts.vision),
        answer(facts.structured_output),
        or_unknown(
            facts
                .temperature
                .as_ref()
                .map(|accepted| accepted.to_string()),
        ),
        or_unknown(facts.coordinates.map(|_| facts.lowering().to_string())),
        small,
        large,
        marks,
    ]
}

fn price(price: Option<Price>) -> String {
    price.map_or("?".to_owned(), |price| {
        let cached = price
            .cached_input
            .map_or("?".to_owned(), |it| it.to_string());
        format!("{} / {cached} / {}", price.input, price.output)
    })
}
