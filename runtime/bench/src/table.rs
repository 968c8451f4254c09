//! Rows as tables: aligned text for a terminal, Markdown, CSV.
//!
//! In: [`Row`]s. Out: text. Tables for people have a line per method and number of actions, and a column per measure;
//! CSV has a line per row. Every table ends with notes on what its figures mean and do not mean.

use super::metric::Metric;
use super::rows::{FigureMeaning, Row};
use super::statistics::Statistic;
use super::suite::Suite;
use fab_agent::record::CoverageSource;
use fab_base::table::aligned;
use std::collections::BTreeMap;

/// The note under every table with quoted figures.
const COMPARISON: &str = "Quoted rows are others' figures and stand for themselves. Ours come from our simulator and our experts, theirs from PyFleX: this is a comparison and not a ranking.";

/// The note under every table with shared answers.
const SHARED: &str = "Answers are shared (`--share-answers`): an equal question at several starts was asked once per repeat. Starts whose rollouts used a common answer are one cluster; `starts` counts them. Every interval is over clusters, also where a note says starts; a single cluster has none, except for shares.";

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

/// Writes every row as a line of comma-separated values (RFC 4180), after a header line.
pub fn csv(rows: &[Row]) -> String {
    let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    let mut lines = vec![
        "task,method,policy,sees_particles,model,metric,horizon,n,repeats,statistic,value,spread,ci95_low,ci95_high,quoted,source,data_size,queries,s_per_action,planning_s,cost,outcomes,note,causes,answers,clusters,cost_at_most,visible_tokens,hidden_tokens,vary"
            .to_owned(),
    ];
    for row in rows {
        let count = |value: Option<usize>| value.map_or(String::new(), |value| value.to_string());
        let cells = [
            row.task.clone(),
            row.method.clone(),
            row.policy.clone().unwrap_or_default(),
            row.sees_particles.to_string(),
            row.model.clone().unwrap_or_default(),
            row.metric.row().name.to_owned(),
            count(row.horizon.map(|it| it as usize)),
            count(row.n),
            count(row.repeats.map(|it| it as usize)),
            row.statistic.to_string(),
            row.value.to_string(),
            number(row.spread),
            number(row.ci95.map(|[low, _]| low)),
            number(row.ci95.map(|[_, high]| high)),
            row.quoted.to_string(),
            row.source.clone().unwrap_or_default(),
            count(row.data_size),
            number(row.queries),
            number(row.s_per_action),
            number(row.planning_s),
            number(row.cost),
            counted(&row.outcomes),
            row.note.clone().unwrap_or_default(),
            counted(&row.causes),
            row.answers.map_or(String::new(), |it| it.name().to_owned()),
            count(row.clusters),
            number(row.cost_at_most),
            number(row.visible_tokens),
            number(row.hidden_tokens),
            row.vary.unwrap_or_default().to_owned(),
        ];
        lines.push(cells.map(|cell| escaped(&cell)).join(","));
    }
    lines.join("\r\n") + "\r\n"
}

fn escaped(cell: &str) -> String {
    if cell.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_owned()
    }
}

/// A table with its header first.
type Lines = Vec<Vec<String>>;

/// Returns two tables for each task: the figures, and the effort.
fn tables(suite: &Suite, rows: &[Row]) -> Vec<(String, Lines)> {
    let mut tasks: Vec<&str> = rows.iter().map(|row| row.task.as_str()).collect();
    tasks.dedup();
    let mut tables = Vec::new();
    for task in tasks {
        let lines = lines(rows.iter().filter(|row| row.task == task));
        tables.push((task.to_owned(), figures(suite, &lines)));
        tables.push((format!("{task}: what it took"), effort(&lines)));
    }
    tables
}

/// Groups rows by table line: a method, its worlds and a number of actions.
fn lines<'r>(rows: impl Iterator<Item = &'r Row>) -> Vec<Vec<&'r Row>> {
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

fn figures(suite: &Suite, lines: &[Vec<&Row>]) -> Lines {
    let there = |metric: &&Metric| lines.iter().flatten().any(|row| row.metric == **metric);
    let metrics: Vec<Metric> = suite.metrics.iter().filter(there).copied().collect();
    let is_varied = is_varied(lines);
    let mut head = headings(is_varied);
    for metric in &metrics {
        head.push(metric.row().heading.to_owned());
        head.extend(is_varied.then(|| "change".to_owned()));
    }
    let mut table = vec![head];
    for line in lines {
        let mut cells = names(line[0], is_varied);
        for metric in &metrics {
            let shown = |is_change: bool| {
                let mut rows = line.iter().filter(|row| row.metric == *metric);
                let row = rows.find(|row| is_a_change(row) == is_change);
                row.map_or(String::new(), |row| figure(row))
            };
            cells.push(shown(false));
            cells.extend(is_varied.then(|| shown(true)));
        }
        table.push(cells);
    }
    table
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

/// Returns the headings of the cells of [`names`].
fn headings(is_varied: bool) -> Vec<String> {
    let varied = is_varied.then_some("varied");
    let first = ["method", "policy"].into_iter().chain(varied);
    let all = first.chain(["actions", "starts"]);
    all.map(str::to_owned).collect()
}

/// Describes the effort and outcomes of each line's rollouts.
fn effort(lines: &[Vec<&Row>]) -> Lines {
    let is_varied = is_varied(lines);
    let head = [
        "examples",
        "queries/action",
        "s/action",
        "planning, ms",
        "cost/action",
        "ended",
    ];
    let mut table = vec![headings(is_varied)];
    table[0].extend(head.map(str::to_owned));
    let has_hidden = lines.iter().any(|line| line[0].hidden_tokens > Some(0.0));
    if has_hidden {
        table[0].extend(["visible tokens/action", "hidden tokens/action"].map(str::to_owned));
    }
    let has_causes = lines.iter().any(|line| !line[0].causes.is_empty());
    if has_causes {
        table[0].push("not reached for".to_owned());
    }
    let number = |value: Option<f64>, digits: usize| {
        value.map_or("-".to_owned(), |value| format!("{value:.digits$}"))
    };
    let used = |row: &Row, value: Option<f64>| match (is_difference(row), value) {
        (true, Some(value)) => format!("{value:+.2}"),
        _ => number(value, 2),
    };
    // A gain is read beside what it costs. Quoted figures have no effort.
    for row in lines.iter().map(|line| line[0]).filter(|row| !row.quoted) {
        let mut cells = names(row, is_varied);
        cells.extend([
            row.data_size.map_or(String::new(), |size| size.to_string()),
            used(row, row.queries),
            used(row, row.s_per_action),
            number(row.planning_s.map(|seconds| seconds * 1000.0), 0),
            cost(row),
            counted(&row.outcomes),
        ]);
        if has_hidden {
            cells.extend([number(row.visible_tokens, 0), number(row.hidden_tokens, 0)]);
        }
        if has_causes {
            cells.push(counted(&row.causes));
        }
        table.push(cells);
    }
    table
}

/// Writes the cost per action; what calls of unknown usage cost is an upper bound.
fn cost(row: &Row) -> String {
    let digits = |value: f64| format!("{value:.2}");
    let at_most = row.cost_at_most.map(digits);
    match (row.cost.map(digits), at_most) {
        (Some(cost), Some(at_most)) if cost != at_most => format!("{cost} to {at_most}"),
        (Some(cost), _) => cost,
        (None, Some(at_most)) => format!("at most {at_most}"),
        (None, None) => "-".to_owned(),
    }
}

/// Writes the first cells of a line: method, policy, what varies if anything does in the table, actions, starts.
fn names(row: &Row, is_varied: bool) -> Vec<String> {
    let starts = row.n.map(|n| match row.repeats {
        Some(repeats) if repeats > 1 => format!("{n} x {repeats}"),
        _ => n.to_string(),
    });
    let clusters = row.clusters.map(|clusters| match clusters {
        1 => ", 1 cluster".to_owned(),
        _ => format!(", {clusters} clusters"),
    });
    let starts = starts.map(|starts| starts + &clusters.unwrap_or_default());
    let mut cells = vec![
        match row.quoted {
            true => format!("quoted: {}", row.method),
            false => row.method.clone(),
        },
        row.policy.clone().unwrap_or_default(),
    ];
    cells.extend(is_varied.then(|| match (row.vary, row.quoted) {
        (Some(varied), _) => varied.to_owned(),
        (None, true) => String::new(),
        (None, false) => "nothing".to_owned(),
    }));
    cells.extend([
        row.horizon
            .map_or(String::new(), |horizon| horizon.to_string()),
        starts.unwrap_or_default(),
    ]);
    cells
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

fn counted(counts: &BTreeMap<&'static str, usize>) -> String {
    let counts = counts.iter().map(|(name, count)| format!("{count} {name}"));
    counts.collect::<Vec<_>>().join(", ")
}

fn captions(suite: &Suite, rows: &[Row]) -> Vec<String> {
    let mut lines = Vec::new();
    if !suite.note.is_empty() {
        lines.push(suite.note.trim().to_owned());
    }
    for row in rows {
        if let Some(note) = &row.note {
            let line = format!(
                "{} with {}: {note}.",
                row.method,
                row.policy.as_deref().unwrap_or("nobody")
            );
            if !lines.contains(&line) {
                lines.push(line);
            }
        }
    }
    if rows.iter().any(|row| row.model.is_some()) {
        let format = match suite.structured {
            true => "with a schema where the server enforces it",
            false => "in the prompt's own format",
        };
        lines.push(format!("Asked: {format}."));
    }
    let shares = rows.iter().any(|row| row.clusters.is_some());
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
    if rows.iter().any(|row| row.quoted && row.ci95.is_some()) {
        lines.push(
            "Intervals of quoted shares are Wilson's, computed here from the quoted counts."
                .to_owned(),
        );
    }
    if rows
        .iter()
        .any(|row| row.metric.row().measured_on == Some(CoverageSource::Picture))
    {
        lines.push("Coverage from pictures: the cloth's pixels divided by those of the flat cloth from the same \
            camera. This is neither SoftGym's measure nor the true area.".to_owned());
    }
    if rows
        .iter()
        .any(|row| matches!(row.statistic, FigureMeaning::Difference(_)))
    {
        lines.push("Lines with a sign are differences between two methods from the same starts [95 % paired bootstrap interval].".to_owned());
    }
    if let Some(vary) = &suite.vary
        && rows.iter().any(|row| row.vary.is_some())
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
    lines.push(
        "Rollouts that end early are included: the last state of the cloth is measured.".to_owned(),
    );
    if rows.iter().any(|row| row.model_is_stand_in) {
        lines.push("Results of a stand-in show that the pipeline works, and say nothing about any vision-language \
            model.".to_owned());
    }
    if rows.iter().any(|row| row.sees_particles) {
        lines.push("An oracle sees true particles and knows what no camera shows: its results are an upper reference \
            and do not compete with the others.".to_owned());
    }
    if rows.iter().any(|row| !row.quoted && row.repeats == Some(1)) {
        lines.push("One rollout per start unless `starts` shows repeats: a deterministic model would give the same \
            result again.".to_owned());
    }
    for source in sources(rows) {
        lines.push(format!("Quoted from: {source}."));
    }
    if rows.iter().any(|row| row.quoted) {
        lines.push(COMPARISON.to_owned());
    }
    lines
}

fn sources(rows: &[Row]) -> Vec<&str> {
    let mut sources: Vec<&str> = rows
        .iter()
        .filter_map(|row| row.source.as_deref())
        .collect();
    sources.sort_unstable();
    sources.dedup();
    sources
}

fn piped(table: &[Vec<String>]) -> String {
    let line = |cells: &[String]| {
        format!(
            "| {} |",
            cells
                .iter()
                .map(|cell| cell.replace('|', "\\|"))
                .collect::<Vec<_>>()
                .join(" | ")
        )
    };
    let mut lines: Vec<String> = table.iter().map(|cells| line(cells)).collect();
    let columns = table.first().map_or(0, Vec::len);
    lines.insert(1.min(lines.len()), format!("|{}", "---|".repeat(columns)));
    lines.join("\n")
}
