//! Rows as tables: aligned text for a terminal, Markdown, CSV.
//!
//! In: [`Row`]s. Out: text. Tables for people have a line per method and number of actions, and a column per measure;
//! CSV has a line per row. Every table ends with notes on what its figures mean and do not mean.

use super::rows::{Effort, FigureMeaning, Row};
use super::statistics::Statistic;
use super::suite::Suite;
use fab_agent::record::CoverageSource;
use fab_base::table::aligned;
use fab_base::wording::counted;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt::Display;

/// The note under every table with quoted figures.
const COMPARISON: &str = "Quoted rows are others' figures and stand for themselves. Ours come from our simulator and our experts, theirs from PyFleX: this is a comparison and not a ranking.";

/// The note under every table with shared answers.
const SHARED: &str = "Answers are shared (`--share-answers`): an equal question at several starts was asked once per repeat. Starts whose rollouts used a common answer are one cluster; `starts` counts them. Every interval is over clusters, also where a note says starts; a single cluster has none, except for shares.";

const QUOTED_SHARES: &str =
    "Intervals of quoted shares are Wilson's, computed here from the quoted counts.";
const BY_PICTURES: &str = "Coverage from pictures: the cloth's pixels divided by those of the flat cloth from the same camera. This is neither SoftGym's measure nor the true area.";
const DIFFERENCES: &str = "Lines with a sign are differences between two methods from the same starts [95 % paired bootstrap interval].";
const ENDED_EARLY: &str =
    "Rollouts that end early are included: the last state of the cloth is measured.";
const STAND_IN: &str = "Results of a stand-in show that the pipeline works, and say nothing about any vision-language model.";
const ORACLE: &str = "An oracle sees true particles and knows what no camera shows: its results are an upper reference and do not compete with the others.";
const ONE_A_START: &str = "One rollout per start unless `starts` shows repeats: a deterministic model would give the same result again.";

/// Writes the tables for a terminal.
pub fn text(suite: &Suite, rows: &[Row]) -> String {
    let mut blocks = Vec::new();
    for (task, table) in tables(suite, rows) {
        let lines = aligned(&[], &table);
        blocks.push(format!("{task}\n  {}", lines.join("\n  ")));
    }
    blocks.push(captions(suite, rows).join("\n"));
    blocks.join("\n\n")
}

/// Writes the tables as Markdown.
pub fn markdown(title: &str, suite: &Suite, rows: &[Row]) -> String {
    let mut blocks = vec![format!("# {title}"), suite.about.clone()];
    for (task, table) in tables(suite, rows) {
        blocks.push(format!("## {task}"));
        blocks.push(piped(&table));
    }
    blocks.extend(captions(suite, rows));
    blocks.join("\n\n") + "\n"
}

/// The columns of the CSV: fields of a row's JSON, and both ends of its interval.
const COLUMNS: &str = "task,method,policy,sees_particles,model,metric,horizon,n,repeats,statistic,value,spread,ci95_low,ci95_high,quoted,source,data_size,queries,s_per_action,planning_s,cost,outcomes,note,causes,answers,clusters,cost_at_most,visible_tokens,hidden_tokens,vary";

/// Writes every row as a line of comma-separated values (RFC 4180), after a header line.
pub fn csv(rows: &[Row]) -> String {
    let mut text = format!("{COLUMNS}\r\n");
    for row in rows {
        let fields = serde_json::to_value(row).expect("a row has string keys");
        let cells = COLUMNS.split(',').map(|column| match column {
            "ci95_low" => cell(&fields["ci95"][0]),
            "ci95_high" => cell(&fields["ci95"][1]),
            column => cell(&fields[column]),
        });
        text += &(cells.collect::<Vec<_>>().join(",") + "\r\n");
    }
    text
}

fn cell(value: &Value) -> String {
    let text = match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Number(number) => number.as_f64().unwrap_or(f64::NAN).to_string(),
        Value::Object(counts) => listed(counts),
        other => other.to_string(),
    };
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text
    }
}

/// A table with its header first.
type Lines = Vec<Vec<String>>;

/// Returns two tables for each task: the figures, and the effort.
fn tables(suite: &Suite, rows: &[Row]) -> Vec<(String, Lines)> {
    let mut tables = Vec::new();
    for rows in rows.chunk_by(|row, next| row.task == next.task) {
        let (task, lines) = (&rows[0].task, lines(rows));
        tables.push((task.clone(), figures(suite, &lines)));
        tables.push((format!("{task}: what it took"), effort(&lines)));
    }
    tables
}

/// Groups rows by table line: a method, its worlds and a number of actions.
fn lines(rows: &[Row]) -> Vec<Vec<&Row>> {
    let mut lines: Vec<Vec<&Row>> = Vec::new();
    for row in rows {
        let key = |row: &Row| (row.method.clone(), row.vary, row.horizon, row.quoted);
        let same = lines.iter_mut().find(|line| key(line[0]) == key(row));
        match same {
            Some(line) => line.push(row),
            None => lines.push(vec![row]),
        }
    }
    lines
}

/// A column: its heading, and what it shows of a line.
type Column<'c> = (&'c str, Box<dyn Fn(&[&Row]) -> String + 'c>);

fn column<'c>(heading: &'c str, cell: impl Fn(&Row) -> String + 'c) -> Column<'c> {
    (heading, Box::new(move |line| cell(line[0])))
}

fn filled<'r>(columns: &[Column<'_>], lines: impl Iterator<Item = &'r Vec<&'r Row>>) -> Lines {
    let headings = columns.iter().map(|(heading, _)| (*heading).to_owned());
    let mut table = vec![headings.collect()];
    table.extend(lines.map(|line| columns.iter().map(|(_, cell)| cell(line)).collect()));
    table
}

fn figures(suite: &Suite, lines: &[Vec<&Row>]) -> Lines {
    let is_varied = is_varied(lines);
    let mut columns = names(is_varied);
    for metric in &suite.metrics {
        if !lines.iter().flatten().any(|row| row.metric == *metric) {
            continue;
        }
        let cell = |is_change: bool| {
            Box::new(move |line: &[&Row]| {
                let mut rows = line.iter().filter(|row| row.metric == *metric);
                let row = rows.find(|row| is_a_change(row) == is_change);
                row.map_or(String::new(), |row| figure(row))
            })
        };
        columns.push((metric.row().heading, cell(false)));
        if is_varied {
            columns.push(("change", cell(true)));
        }
    }
    filled(&columns, lines.iter())
}

fn is_varied(lines: &[Vec<&Row>]) -> bool {
    lines.iter().any(|line| line[0].vary.is_some())
}

fn is_a_change(row: &Row) -> bool {
    matches!(row.statistic, FigureMeaning::Change(_))
}

fn is_difference(row: &Row) -> bool {
    matches!(row.statistic, FigureMeaning::Difference(_)) || is_a_change(row)
}

/// Describes the effort and outcomes of each line's rollouts.
fn effort(lines: &[Vec<&Row>]) -> Lines {
    let number = |value: Option<f64>, digits: usize| {
        value.map_or("-".to_owned(), |value| format!("{value:.digits$}"))
    };
    let used = move |row: &Row, value: Option<f64>| match (is_difference(row), value) {
        (true, Some(value)) => format!("{value:+.2}"),
        _ => number(value, 2),
    };
    let planning_ms = |row: &Row| row.effort.planning_s.map(|seconds| seconds * 1000.0);
    let mut columns = names(is_varied(lines));
    columns.extend([
        column("examples", |row| shown(row.effort.data_size)),
        column("queries/action", move |row| used(row, row.effort.queries)),
        column("s/action", move |row| used(row, row.effort.s_per_action)),
        column("planning, ms", move |row| number(planning_ms(row), 0)),
        column("cost/action", cost),
        column("ended", |row| listed(&row.effort.outcomes)),
    ]);
    let any = |has: fn(&Effort) -> bool| lines.iter().any(|line| has(&line[0].effort));
    if any(|effort| effort.hidden_tokens > Some(0.0)) {
        columns.extend([
            column("visible tokens/action", move |row| {
                number(row.effort.visible_tokens, 0)
            }),
            column("hidden tokens/action", move |row| {
                number(row.effort.hidden_tokens, 0)
            }),
        ]);
    }
    if any(|effort| !effort.causes.is_empty()) {
        columns.push(column("not reached for", |row| listed(&row.effort.causes)));
    }
    // A gain is read beside what it costs. Quoted figures have no effort.
    filled(&columns, lines.iter().filter(|line| !line[0].quoted))
}

fn shown(value: Option<impl ToString>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}

/// Writes the cost per action; what calls of unknown usage cost is an upper bound.
fn cost(row: &Row) -> String {
    let digits = |value: f64| format!("{value:.2}");
    let at_most = row.effort.cost_at_most.map(digits);
    match (row.effort.cost.map(digits), at_most) {
        (Some(cost), Some(at_most)) if cost != at_most => format!("{cost} to {at_most}"),
        (Some(cost), _) => cost,
        (None, Some(at_most)) => format!("at most {at_most}"),
        (None, None) => "-".to_owned(),
    }
}

/// Returns the first columns: method, policy, what varies if anything does in the table, actions, starts.
fn names(is_varied: bool) -> Vec<Column<'static>> {
    let method = |row: &Row| {
        if row.quoted {
            format!("quoted: {}", row.method)
        } else {
            row.method.clone()
        }
    };
    let varied = |row: &Row| match (row.vary, row.quoted) {
        (Some(varied), _) => varied.to_owned(),
        (None, true) => String::new(),
        (None, false) => "nothing".to_owned(),
    };
    let mut columns = vec![
        column("method", method),
        column("policy", |row| shown(row.policy.as_ref())),
    ];
    if is_varied {
        columns.push(column("varied", varied));
    }
    columns.push(column("actions", |row| shown(row.horizon)));
    columns.push(column("starts", starts));
    columns
}

fn starts(row: &Row) -> String {
    let clusters = row.clusters;
    let clusters = clusters.map(|clusters| format!(", {}", counted(clusters, "cluster")));
    let repeats = row.repeats.filter(|repeats| *repeats > 1);
    let repeats = repeats.map(|repeats| format!(" x {repeats}"));
    let starts = [row.n.map(|n| n.to_string()), repeats, clusters];
    starts.into_iter().flatten().collect()
}

/// Writes a figure with its spread and interval.
fn figure(row: &Row) -> String {
    let digits = row.metric.row().digits;
    let mut text = format!("{:.digits$}", row.value);
    if is_difference(row) {
        text = format!("{:+.digits$}", row.value);
    }
    if let Some(spread) = row.spread {
        text.push_str(&format!(" ± {spread:.digits$}"));
    }
    if let Some([low, high]) = row.ci95 {
        text.push_str(&format!(" [{low:.digits$}, {high:.digits$}]"));
    }
    text
}

fn listed(counts: impl IntoIterator<Item = (impl Display, impl Display)>) -> String {
    let counts = counts.into_iter();
    let counts = counts.map(|(name, count)| format!("{count} {name}"));
    counts.collect::<Vec<_>>().join(", ")
}

fn captions(suite: &Suite, rows: &[Row]) -> Vec<String> {
    let any = |has: fn(&Row) -> bool| rows.iter().any(has);
    let mut lines = Vec::new();
    if !suite.note.is_empty() {
        lines.push(suite.note.trim().to_owned());
    }
    for row in rows {
        let Some(note) = &row.note else { continue };
        let policy = row.policy.as_deref().unwrap_or("nobody");
        let line = format!("{} with {policy}: {note}.", row.method);
        if !lines.contains(&line) {
            lines.push(line);
        }
    }
    if any(|row| row.model.is_some()) {
        let format = if suite.structured {
            "with a schema where the server enforces it"
        } else {
            "in the prompt's own format"
        };
        lines.push(format!("Asked: {format}."));
    }
    let shares = any(|row| row.clusters.is_some());
    let figures = match suite.statistic {
        Statistic::Median => {
            "median over all rollouts ± the larger of the distances from the median to the quartiles"
        }
        Statistic::Mean | Statistic::Share => {
            "mean over starts, the repeats of a start averaged first, ± standard deviation over starts"
        }
    };
    let over = if shares { "clusters" } else { "starts" };
    lines.push(format!(
        "Figures: {figures} [95 % bootstrap interval over {over}]."
    ));
    if shares {
        lines.push(SHARED.to_owned());
    }
    for row in rows {
        let caption = row.metric.row().caption.map(str::to_owned);
        lines.extend(caption.filter(|caption| !lines.contains(caption)));
    }
    if any(|row| row.quoted && row.ci95.is_some()) {
        lines.push(QUOTED_SHARES.to_owned());
    }
    if any(|row| row.metric.row().measured_on == Some(CoverageSource::Picture)) {
        lines.push(BY_PICTURES.to_owned());
    }
    if any(|row| matches!(row.statistic, FigureMeaning::Difference(_))) {
        lines.push(DIFFERENCES.to_owned());
    }
    if let Some(vary) = suite
        .vary
        .as_ref()
        .filter(|_| any(|row| row.vary.is_some()))
    {
        let ranges = vary.ranges.iter().map(|range| {
            let (axis, low, high) = (range.axis, range.low, range.high);
            format!("{} from {low} to {high}", axis.name)
        });
        lines.push(format!(
            "Varied worlds: {}; drawn evenly for each start by seed {}, for one axis at a time and for all of them. \
             Change: the difference to the task's own world from the same starts [95 % paired bootstrap interval]. \
             The task is not adapted to what was drawn.",
            ranges.collect::<Vec<_>>().join(", "),
            vary.seed
        ));
    }
    lines.push(ENDED_EARLY.to_owned());
    if any(|row| row.model_is_stand_in) {
        lines.push(STAND_IN.to_owned());
    }
    if any(|row| row.sees_particles) {
        lines.push(ORACLE.to_owned());
    }
    if any(|row| !row.quoted && row.repeats == Some(1)) {
        lines.push(ONE_A_START.to_owned());
    }
    let sources: BTreeSet<&String> = rows.iter().filter_map(|row| row.source.as_ref()).collect();
    lines.extend(
        sources
            .iter()
            .map(|source| format!("Quoted from: {source}.")),
    );
    if any(|row| row.quoted) {
        lines.push(COMPARISON.to_owned());
    }
    lines
}

fn piped(table: &[Vec<String>]) -> String {
    let line = |cells: &Vec<String>| {
        let cells = cells.iter().map(|cell| cell.replace('|', "\\|"));
        format!("| {} |", cells.collect::<Vec<_>>().join(" | "))
    };
    let mut lines: Vec<String> = table.iter().map(line).collect();
    let columns = table.first().map_or(0, Vec::len);
    lines.insert(1.min(lines.len()), format!("|{}", "---|".repeat(columns)));
    lines.join("\n")
}
