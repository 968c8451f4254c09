//! `fabc models`: the known facts about models, with their dates and sources.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::report::Report;
use crate::verbs::runtime::setting::catalogue::{self, FactsArguments};
use clap::Args;
use fab_base::table::aligned;
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
    #[serde(flatten)]
    profile: Profile,
    price: Option<Price>,
    image_tokens_224: Option<Tokens>,
    image_tokens_720: Option<Tokens>,
    notices: Vec<Notice>,
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
        let [image_tokens_224, image_tokens_720] = image_tokens(&profile.facts);
        KnownModel {
            price: profile.price_on(today),
            image_tokens_224,
            image_tokens_720,
            notices: profile.notices(today),
            profile,
        }
    }

    fn title(&self) -> String {
        let Profile { provider, id, .. } = &self.profile;
        match &self.profile.listed {
            FactsSource::ByName(name) => format!("{}:? ({name})", provider.name),
            _ => format!("{}:{id}", provider.name),
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
        let is_retired = |model: &&KnownModel| model.profile.facts.shutdown.is_some();
        let (retired, current): (Vec<_>, Vec<_>) = self.models.iter().partition(is_retired);
        for model in &current {
            let Profile {
                facts, sources: of, ..
            } = &model.profile;
            table.push(row(
                model.title(),
                price(model.price),
                facts,
                sources.marks(of),
            ));
        }
        for family in &self.families {
            let at = family.provider.map(|name| format!("{name}:"));
            let title = format!("{}*{}*", at.unwrap_or_default(), family.part);
            let marks = sources.marks(family.sources);
            table.push(row(title, String::new(), family.facts, marks));
        }
        let mut lines = aligned(&[], &table);
        lines.push(
            "\n?: unknown. *: every model whose id has these words; open weights have no vendor before them. tokens: \
             estimates for one square picture. Another server's model has its vendor's facts, but not its price and \
             schema.\nCalls to models on your own machine are never billed."
                .to_owned(),
        );
        for model in &current {
            let mut changes = model.notices.iter();
            let change = changes.find(|it| matches!(it, Notice::PriceChanges { .. }));
            lines.extend(change.map(|change| format!("{}: {change}", model.title())));
        }
        if !retired.is_empty() {
            lines.push("\nRetired, or soon to be:".to_owned());
            lines.extend(self.retired(retired, &mut sources));
        }
        lines.push("\nSources:".to_owned());
        for (Source { as_of, source }, number) in sources.0.iter().zip(1..) {
            lines.push(format!("[{number}] {as_of}: {source}"));
        }
        lines.join("\n")
    }
}

impl KnownModels<'_> {
    /// Returns a line for each day and replacement, with its models.
    fn retired(&self, mut retired: Vec<&KnownModel>, sources: &mut Footnotes) -> Vec<String> {
        let of = |model: &&KnownModel| {
            let Profile {
                facts, provider, ..
            } = &model.profile;
            let replaced_by = facts.replaced_by.clone();
            (facts.shutdown, provider.name.clone(), replaced_by)
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
            let ids: Vec<&str> = group.iter().map(|it| it.profile.id.as_str()).collect();
            let instead = instead.map(|id| format!("; its vendor recommends {id}"));
            let (ids, instead) = (ids.join(", "), instead.unwrap_or_default());
            let marks = sources.marks(&group[0].profile.sources);
            Some(format!("{since} {on}  {provider}: {ids}{instead} {marks}"))
        };
        let groups = retired.chunk_by(|a, b| of(a) == of(b));
        groups.filter_map(line).collect()
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
