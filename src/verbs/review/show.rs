//! Formats a group for the terminal.
//!
//! In: a group and how to show it. Out: lines. Every removed line begins with `-`, every added one with `+`.

use super::cost_in_words;
use super::edits::{Cause, Edit};
use super::find::Pending;
use super::groups::{Group, Kind};
use crate::snapshots::Contents;
use crate::verbs::price::Price;
use console::Style;
use fab_compiler::diag::{Color, visible};
use similar::{ChangeTag, TextDiff};
use std::path::PathBuf;
use textwrap::{Options, WordSeparator, WordSplitter};

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
    /// How much of a long list is shown.
    pub extent: Extent,
}

/// Items shown of a folded list: snapshots or files, causes, lines of a new text.
const FOLDED_SNAPSHOTS: usize = 8;
const FOLDED_CAUSES: usize = 4;
const FOLDED_LINES: usize = 12;

/// Returns a group as lines for the terminal.
pub fn group(group: &Group, pending: &[Pending], price: Option<&Price>, view: &View) -> String {
    let mut page = Page {
        view,
        lines: Vec::new(),
    };
    let bold = page.style().bold();
    page.line("", &head(group, pending), &bold);
    let plain = Style::new();
    // The first cause of an edit is in the heading.
    let shown = usize::from(group.kind == Kind::Edit);
    let causes = group.causes.iter().skip(shown).map(place);
    page.list("   ", causes.collect(), FOLDED_CAUSES, "more places");
    for edit in &group.edits {
        page.edit(edit);
    }
    if group.edits.is_empty() && matches!(group.kind, Kind::Edit | Kind::Scene) {
        page.line(
            "",
            "  the text is the same; blank lines or what stands above it changed",
            &plain,
        );
    }
    let members = || group.members.iter().map(|at| &pending[*at]);
    if group.kind == Kind::New {
        page.new_texts(members());
        let files: Vec<PathBuf> = members().filter_map(Pending::picture_file).collect();
        if !files.is_empty() {
            page.line("", "pictures to look at:", &plain);
        }
        let files = files.iter().map(|file| file.display().to_string());
        page.list("  ", files.collect(), FOLDED_SNAPSHOTS, "more");
    }
    page.line("", "snapshots:", &plain);
    let names = members().map(|one| one.name.to_string());
    page.list("  ", names.collect(), FOLDED_SNAPSHOTS, "more");
    for line in cost_in_words(group, price).iter().flat_map(|it| it.lines()) {
        page.line("", line, &plain);
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
            let task = &pending[group.members[0]].info.task;
            format!("{count} new {snapshots} of `{task}`")
        }
    };
    format!("{} {what}", group.id)
}

/// Formats a cause: component, file and line.
fn place(cause: &Cause) -> String {
    match (&cause.file, cause.line) {
        (Some(file), Some(line)) => format!("{} {file}:{line}", cause.component),
        _ => cause.component.clone(),
    }
}

/// Lines under construction.
struct Page<'a> {
    view: &'a View,
    lines: Vec<String>,
}

impl Page<'_> {
    /// Returns a style that has an effect only if colours are wanted.
    fn style(&self) -> Style {
        Style::new().force_styling(self.view.color == Color::Ansi)
    }

    /// Adds a line of one style.
    fn line(&mut self, sign: &str, text: &str, style: &Style) {
        self.wrapped(sign, &style.apply_to(shown(text)).to_string(), style);
    }

    /// Adds a painted line after a sign; what does not fit is set in below it.
    fn wrapped(&mut self, sign: &str, painted: &str, style: &Style) {
        let first = style.apply_to(sign).to_string();
        let later = style.apply_to(format!("{sign}  ")).to_string();
        let options = Options::new(self.view.columns)
            .initial_indent(&first)
            .subsequent_indent(&later)
            .word_separator(WordSeparator::AsciiSpace)
            .word_splitter(WordSplitter::NoHyphenation);
        let lines = textwrap::wrap(painted, options).into_iter();
        self.lines
            .extend(lines.map(|line| line.trim_end().to_owned()));
    }

    /// Adds the lines of a list, or the first of them.
    fn list(&mut self, indent: &str, items: Vec<String>, folded: usize, what: &str) {
        let shown = match self.view.extent {
            // Folding a single line would save nothing.
            Extent::Folded if items.len() > folded + 1 => folded,
            _ => items.len(),
        };
        for item in &items[..shown] {
            self.line(indent, item, &Style::new());
        }
        if shown < items.len() {
            let rest = format!("  … and {} {what}", items.len() - shown);
            self.line("", &rest, &Style::new());
        }
    }

    /// Adds the lines of an edit; in colour, the words that differ are marked.
    fn edit(&mut self, edit: &Edit) {
        let faint = self.style().dim();
        self.line("@@", "", &faint);
        for line in &edit.before {
            self.line("  ", line, &faint);
        }
        let [removed, added] = [&edit.removed, &edit.added].map(|lines| {
            let lines = lines.iter().map(|line| shown(line) + "\n");
            lines.collect::<Vec<String>>()
        });
        let [old, new] = [&removed, &added].map(|it| it.iter().map(String::as_str).collect());
        let (old, new): (Vec<&str>, Vec<&str>) = (old, new);
        let diff = TextDiff::from_slices(&old, &new);
        let changes = diff
            .ops()
            .iter()
            .flat_map(|op| diff.iter_inline_changes(op));
        let changes: Vec<_> = changes.collect();
        for (tag, sign, style) in [
            (ChangeTag::Delete, "- ", self.style().red()),
            (ChangeTag::Insert, "+ ", self.style().green()),
        ] {
            // A line that only moved is both.
            let is_meant = |found: ChangeTag| found == tag || found == ChangeTag::Equal;
            for change in changes.iter().filter(|change| is_meant(change.tag())) {
                let marked = style.clone().bold().underlined();
                let parts = change.iter_strings_lossy().map(|(is_other, text)| {
                    let text = text.trim_end_matches('\n').to_owned();
                    let style = if is_other { &marked } else { &style };
                    style.apply_to(text).to_string()
                });
                self.wrapped(sign, &parts.collect::<String>(), &style);
            }
        }
        for line in &edit.after {
            self.line("  ", line, &faint);
        }
    }

    fn new_texts<'p>(&mut self, members: impl Iterator<Item = &'p Pending>) {
        let texts = members.filter_map(|one| match &one.proposed.contents {
            Contents::Text(text) => Some((&one.name, text)),
            Contents::Picture(_) => None,
        });
        let n_texts = match self.view.extent {
            Extent::Folded => 1,
            Extent::Full => usize::MAX,
        };
        for (name, text) in texts.take(n_texts) {
            self.line("@@ ", &name.to_string(), &self.style().dim());
            let lines = text.lines().map(str::to_owned).collect();
            self.list("+ ", lines, FOLDED_LINES, "more lines");
        }
    }
}

/// Makes foreign text safe for a terminal.
fn shown(text: &str) -> String {
    visible(&text.replace('\t', "    ")).into_owned()
}
