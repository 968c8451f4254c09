//! `fabc models`: the known facts about models, with their dates and sources.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::runtime::setting::catalogue::{self, FactsArguments};
use clap::Args;
use fab_base::table::aligned;
use fab_providers::catalogue::{Facts, Listed, Price, Provider};
use fab_providers::probe::SIDES_PX;
use serde::Serialize;

/// How to write a file of facts.
const FORM: &str = "\
A file of facts has the form of the embedded ones. The fields that an entry gives replace those there were, the others stay:

  [[provider]]                   # a server that speaks OpenAI's Chat Completions
  name = \"lab\"                   # as in PROVIDER:NAME
  base_url = \"https://gpu.example/v1\"
  key_env = [\"LAB_KEY\"]          # the variable with its key, if it wants one
  runs_on = \"own\"                # calls are not billed

  [[model]]
  provider = \"lab\"
  id = \"my-model\"                # or: family = [\"qwen3-vl\"], for all ids that begin so
  coordinates = { unit = \"per_mille\", order = \"xy\" }   # or pixels, fraction, percent; yx
  price = [{ input = 2, cached_input = 0.1, output = 10 }]  # USD per million tokens
  as_of = \"2026-11-20\"           # if you like
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
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// What is known.
#[derive(Serialize)]
struct KnownModels<'c> {
    providers: &'c [Provider],
    models: Vec<Listed>,
}

/// Lists the models.
pub fn run(arguments: &ModelsArguments, io: &Io) -> Result<Exit, Failure> {
    let catalogue = catalogue::load(arguments.facts.models.as_deref(), io)?;
    let wanted = arguments.provider.as_deref();
    let wanted = wanted.map(|name| catalogue.provider(name)).transpose();
    let wanted = wanted.map_err(Failure::usage)?;
    let known = KnownModels {
        providers: catalogue.providers(),
        models: catalogue.listed(wanted),
    };
    io.either(arguments.json, &known, || known.text());
    Ok(Exit::Done)
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
    "as of",
];

/// What the table leaves to its reader to know.
const LEGEND: &str = "
?: unknown. *: every model whose id begins so; open weights have no vendor before them. tokens: estimates for one square \
picture. Another server's model has its vendor's facts, but not its price and schema. Calls to models on your own machine are \
never billed. `--json` has the source of each fact.";

impl KnownModels<'_> {
    fn text(&self) -> String {
        let mut table = vec![HEADINGS.map(str::to_owned)];
        table.extend(self.models.iter().map(row));
        let mut lines = aligned(&[], &table);
        lines.push(LEGEND.to_owned());
        lines.join("\n")
    }
}

fn row(listed: &Listed) -> [String; 9] {
    let facts = &listed.facts;
    let answer = |known: Option<bool>| or_unknown(known.map(|yes| if yes { "yes" } else { "no" }));
    let formula = facts.image_tokens.as_ref();
    let [small, large] = SIDES_PX.map(|side| or_unknown(formula.map(|it| it.of(side, side))));
    let as_of = listed
        .sources
        .iter()
        .filter_map(|source| source.as_of)
        .max();
    [
        listed.model.clone(),
        prices(facts),
        answer(facts.vision),
        answer(facts.structured_output),
        or_unknown(facts.temperature.as_ref()),
        or_unknown(facts.coordinates.map(|_| facts.lowering())),
        small,
        large,
        or_unknown(as_of),
    ]
}

fn prices(facts: &Facts) -> String {
    let price = |price: &Price| {
        let from = price
            .from
            .map_or(String::new(), |from| format!(" from {from}"));
        let cached = or_unknown(price.cached_input);
        format!("{} / {cached} / {}{from}", price.input, price.output)
    };
    let prices: Option<Vec<_>> = facts
        .price
        .as_ref()
        .map(|all| all.iter().map(price).collect());
    or_unknown(prices.map(|prices| prices.join(", ")))
}

fn or_unknown<T: ToString>(known: Option<T>) -> String {
    known.map_or("?".to_owned(), |known| known.to_string())
}
