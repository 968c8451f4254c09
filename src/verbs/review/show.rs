//! Formats a group for the terminal.
//!
//! In: a group and how to show it. Out: lines. Every removed line begins with `-`, every added one with `+`.

use super::cost::{self, Pricing};
use super::edits::{Cause, Edit};
use super::find::Pending;
use super::groups::{Group, Kind};
use super::styled::{Line, Style};
use crate::snapshots::Contents;
use fab_compiler::diag::Color;
use similar::{ChangeTag, TextDiff};
use std::path::PathBuf;

/// The arrangement of removed and added lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// One below the other.
    Unified,
    /// Side by side.
    SideBySide,
}

impl Layout {
    /// Returns the other layout.
    pub fn other(self) -> Layout {
        match self {
            Layout::Unified => Layout::SideBySide,
            Layout::SideBySide => Layout::Unified,
        }
    }
}

/// How much of a long list is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// Only its beginning.
    Folded,
    /// Everything.
    Full,
}

/// How groups are shown.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Width of the terminal, columns.
    pub columns: usize,
    /// Whether colours are wanted.
    pub color: Color,
    /// The arrangement of removed and added lines.
    pub layout: Layout,
    /// How much of a long list is shown.
    pub extent: Extent,
}

/// Items shown of a folded list: snapshots, causes, lines of a new text.
const FOLDED_SNAPSHOTS: usize = 8;
const FOLDED_CAUSES: usize = 4;
const FOLDED_LINES: usize = 12;
/// Indent of a long line's continuation rows, so that they are not taken for separate lines.
const SET_IN: usize = 2;
/// Below this similarity of two lines, marking the different words would mark nearly all.
const LIKE: f32 = 0.4;
/// The longest lines whose words are compared, bytes; the time grows with the square.
const MAX_COMPARED_BYTES: usize = 10_000;

/// Returns a group as lines for the terminal.
pub fn group(group: &Group, pending: &[Pending], pricing: Option<&Pricing>, view: &View) -> String {
    let mut page = Page {
        view,
        lines: Vec::new(),
    };
    page.line(Line::of(&head(group, pending), Style::Head));
    if group.kind != Kind::Edit {
        page.causes(&group.causes);
    }
    for edit in &group.edits {
        page.edit(edit);
    }
    if group.edits.is_empty() && matches!(group.kind, Kind::Edit | Kind::Scene) {
        page.plain("  the text is the same; what stands above it changed");
    }
    if group.kind == Kind::New {
        page.new_ones(group, pending);
    }
    page.plain("snapshots:");
    let shown = limited(group.members.len(), FOLDED_SNAPSHOTS, view.extent);
    for member in &group.members[..shown] {
        page.plain(&format!("  {}", pending[*member].name));
    }
    page.rest(group.members.len() - shown, "more");
    for line in cost::in_words(&group.tokens, pricing)
        .iter()
        .flat_map(|words| words.lines())
    {
        page.plain(line);
    }
    page.lines.join("\n")
}

fn head(group: &Group, pending: &[Pending]) -> String {
    let count = group.members.len();
    let snapshots = if count == 1 { "snapshot" } else { "snapshots" };
    let what = match group.kind {
        Kind::Edit => {
            let cause = group.causes.first();
            let place = cause.map_or(String::new(), |cause| format!(": {}", place(cause)));
            format!("one edit changes {count} {snapshots}{place}")
        }
        Kind::Scene => format!("{count} pinned {snapshots} of scenes changed"),
        Kind::Picture => format!("{count} {snapshots} of pictures changed alike"),
        Kind::New => {
            let task = group
                .members
                .first()
                .map(|first| &pending[*first].info.task);
            let task = task.map_or("", String::as_str);
            format!("{count} new {snapshots} of `{task}`")
        }
    };
    format!("{} {what}", group.id)
}

/// Formats a cause: component, file and line.
pub fn place(cause: &Cause) -> String {
    match (&cause.file, cause.line) {
        (Some(file), Some(line)) => format!("{} {file}:{line}", cause.component),
        _ => cause.component.clone(),
    }
}

fn limited(count: usize, folded: usize, extent: Extent) -> usize {
    match extent {
        // Folding a single line would save nothing.
        Extent::Folded if count > folded + 1 => folded,
        _ => count,
    }
}

/// Lines under construction.
struct Page<'a> {
    view: &'a View,
    lines: Vec<String>,
}

impl Page<'_> {
    fn line(&mut self, line: Line) {
        for line in line.wrapped(self.view.columns, SET_IN) {
            self.lines.push(line.painted(self.view.color));
        }
    }

    fn plain(&mut self, text: &str) {
        self.line(Line::of(text, Style::Plain));
    }

    fn rest(&mut self, count: usize, what: &str) {
        if count > 0 {
            self.plain(&format!("  … and {count} {what}"));
        }
    }

    fn signed(&mut self, sign: &str, line: &Line, style: Style) {
        let columns = self.view.columns.saturating_sub(2);
        for line in line.wrapped(columns, SET_IN) {
            let line = Line::of(&format!("{sign} "), style).followed_by(&line);
            self.lines.push(line.painted(self.view.color));
        }
    }

    fn causes(&mut self, causes: &[Cause]) {
        let shown = limited(causes.len(), FOLDED_CAUSES, self.view.extent);
        for cause in &causes[..shown] {
            self.plain(&format!("   {}", place(cause)));
        }
        self.rest(causes.len() - shown, "more places");
    }

    fn edit(&mut self, edit: &Edit) {
        let first = edit.causes.first().map_or(String::new(), place);
        self.line(Line::of(&format!("@@ {first}"), Style::Faint));
        self.causes(edit.causes.get(1..).unwrap_or_default());
        for line in &edit.before {
            self.signed(" ", &Line::of(line, Style::Faint), Style::Faint);
        }
        let (removed, added) = marked(&edit.removed, &edit.added);
        match self.view.layout {
            Layout::Unified => {
                for line in &removed {
                    self.signed("-", line, Style::Removed);
                }
                for line in &added {
                    self.signed("+", line, Style::Added);
                }
            }
            Layout::SideBySide => self.side_by_side(&removed, &added),
        }
        for line in &edit.after {
            self.signed(" ", &Line::of(line, Style::Faint), Style::Faint);
        }
    }

    fn side_by_side(&mut self, removed: &[Line], added: &[Line]) {
        // Two signs with a blank each, and a bar between blanks.
        let column = (self.view.columns.saturating_sub(7) / 2).max(8);
        for at in 0..removed.len().max(added.len()) {
            let rows = |lines: &[Line]| {
                lines
                    .get(at)
                    .map_or(Vec::new(), |line| line.wrapped(column, SET_IN))
            };
            let (left, right) = (rows(removed), rows(added));
            for row in 0..left.len().max(right.len()) {
                let cell = |rows: &[Line], sign: &str, style: Style| match rows.get(row) {
                    Some(line) => Line::of(sign, style).followed_by(line),
                    None => Line::default(),
                };
                let line = cell(&left, "- ", Style::Removed)
                    .padded(column + 2)
                    .followed_by(&Line::of(" │ ", Style::Faint))
                    .followed_by(&cell(&right, "+ ", Style::Added));
                self.lines.push(line.painted(self.view.color));
            }
        }
    }

    fn new_ones(&mut self, group: &Group, pending: &[Pending]) {
        let members = || group.members.iter().map(|at| &pending[*at]);
        let texts = members().filter_map(|one| match &one.proposed.contents {
            Contents::Text(text) => Some((&one.name, text)),
            Contents::Picture(_) => None,
        });
        let n_texts = match self.view.extent {
            Extent::Folded => 1,
            Extent::Full => usize::MAX,
        };
        for (name, text) in texts.take(n_texts) {
            self.line(Line::of(&format!("@@ {name}"), Style::Faint));
            let n_lines = text.lines().count();
            let n_shown = limited(n_lines, FOLDED_LINES, self.view.extent);
            for line in text.lines().take(n_shown) {
                self.signed("+", &Line::of(line, Style::Added), Style::Added);
            }
            self.rest(n_lines - n_shown, "more lines");
        }
        let files: Vec<PathBuf> = members().filter_map(Pending::picture_file).collect();
        if !files.is_empty() {
            self.plain("pictures to look at:");
        }
        let n_shown = limited(files.len(), FOLDED_SNAPSHOTS, self.view.extent);
        for file in &files[..n_shown] {
            self.plain(&format!("  {}", file.display()));
        }
        self.rest(files.len() - n_shown, "more");
    }
}

/// Returns the removed and the added lines; where two lines correspond, the words that differ are marked.
fn marked(removed: &[String], added: &[String]) -> (Vec<Line>, Vec<Line>) {
    let whole = |lines: &[String], style| lines.iter().map(|line| Line::of(line, style)).collect();
    let mut old: Vec<Line> = whole(removed, Style::Removed);
    let mut new: Vec<Line> = whole(added, Style::Added);
    for (at, (before, after)) in removed.iter().zip(added).enumerate() {
        if before.len().max(after.len()) > MAX_COMPARED_BYTES {
            continue;
        }
        let words = TextDiff::from_words(before.as_str(), after.as_str());
        if words.ratio() < LIKE {
            continue;
        }
        (old[at], new[at]) = (Line::default(), Line::default());
        for change in words.iter_all_changes() {
            match change.tag() {
                ChangeTag::Equal => {
                    old[at].push(change.value(), Style::Removed);
                    new[at].push(change.value(), Style::Added);
                }
                ChangeTag::Delete => old[at].push(change.value(), Style::RemovedWord),
                ChangeTag::Insert => new[at].push(change.value(), Style::AddedWord),
            }
        }
    }
    (old, new)
}
