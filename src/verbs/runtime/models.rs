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

    /// Says from when on there is another price, if it is known.
    fn price_ends(&self) -> String {
        let ends = self.notices.iter().find_map(|notice| match notice {
            Notice::PriceChanges { on } => Some(format!(" until {on}")),
            _ => None,
        });
        ends.unwrap_or_default()
    }
}

/// Returns the tokens of a square picture for each of the cameras' sides.
fn image_tokens(facts: &Facts) -> [Option<Tokens>; 2] {
    let formula = facts.image_tokens.as_ref();
    SIDES_PX.map(|side| formula.map(|formula| formula.of(side, side)))
}

const HEADINGS: [&str; 10] = [
    "model",
    "USD/M in/cached/out",
    "vision",
    "schema",
    "temperature",
    "points",
    "tokens 224",
    "tokens 720",
    "until",
    "as of",
];

/// What the table leaves to its reader to know.
const LEGEND: &str = "
?: unknown. *: every model whose id has these words; open weights have no vendor before them. tokens: estimates for one square \
picture. until: when it stops answering, and what its vendor recommends then. Another server's model has its vendor's facts, but \
not its price and schema. Calls to models on your own machine are never billed. `--json` has the source of each fact, and models \
that no longer answer.";

impl Report for KnownModels<'_> {
    fn text(&self) -> String {
        let mut table = vec![HEADINGS.map(str::to_owned)];
        let answers = |model: &&KnownModel| {
            let shutdown = model.profile.facts.shutdown;
            shutdown.is_none_or(|on| self.on.days_until(on) > 0)
        };
        table.extend(self.models.iter().filter(answers).map(|model| {
            let Profile { facts, sources, .. } = &model.profile;
            let price = price(model.price) + &model.price_ends();
            row(model.title(), price, facts, sources)
        }));
        table.extend(self.families.iter().map(|family| {
            let at = family.provider.map(|name| format!("{name}:"));
            let title = format!("{}*{}*", at.unwrap_or_default(), family.part);
            row(title, String::new(), family.facts, family.sources)
        }));
        let mut lines = aligned(&[], &table);
        lines.push(LEGEND.to_owned());
        lines.join("\n")
    }
}

fn row(title: String, price: String, facts: &Facts, sources: &[Source]) -> [String; 10] {
    fn or_unknown<T: ToString>(known: Option<T>) -> String {
        known.map_or("?".to_owned(), |known| known.to_string())
    }
    let answer = |known: Option<bool>| or_unknown(known.map(|yes| if yes { "yes" } else { "no" }));
    let [small, large] = image_tokens(facts).map(or_unknown);
    let instead = facts.replaced_by.as_ref();
    let instead = instead.map_or(String::new(), |id| format!(", then {id}"));
    let shutdown = facts.shutdown.map(|on| format!("{on}{instead}"));
    let as_of = sources.iter().map(|source| source.as_of).max();
    [
        title,
        price,
        answer(facts.vision),
        answer(facts.structured_output),
        or_unknown(facts.temperature.as_ref()),
        or_unknown(facts.coordinates.map(|_| facts.lowering())),
        small,
        large,
        shutdown.unwrap_or_default(),
        or_unknown(as_of),
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
