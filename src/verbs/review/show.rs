//! Formats a group for the terminal.
//!
//! In: a group and how to show it. Out: lines. Every removed line begins with `-`, every added one with `+`.

use super::edits::{Cause, Edit};
use super::find::Pending;
use super::groups::{Group, Kind};
use crate::snapshots::Contents;
use console::Style;
use fab_base::wording::counted;
use fab_compiler::diag::{Color, visible};
use similar::{ChangeTag, TextDiff};

/// Causes and names of snapshots that are listed; `--json` lists all.
const LISTED: usize = 8;

pub fn group(group: &Group, pending: &[Pending], color: Color) -> String {
    let lines = Vec::new();
    let mut page = Page { color, lines };
    let members = || group.members.iter().map(|at| &pending[*at]);
    let bold = page.style().bold();
    page.line(&format!("{} {}", group.id, head(group, pending)), &bold);
    // The first cause of an edit is in the heading.
    let shown = usize::from(group.kind == Kind::Edit);
    let causes = group.causes.iter().skip(shown).map(place);
    page.list("   ", causes);
    for edit in &group.edits {
        page.edit(edit);
    }
    match group.kind {
        Kind::Edit | Kind::Scene if group.edits.is_empty() => {
            page.plain("  the text is the same; blank lines or what stands above it changed");
        }
        Kind::New => page.new_texts(members()),
        _ => {}
    }
    for picture in members().filter_map(Pending::pictures_to_look_at) {
        page.plain(&format!("look at {picture}"));
    }
    page.plain("snapshots:");
    page.list("  ", members().map(|one| one.name.to_string()));
    if let Some(tokens) = group.tokens {
        let change = tokens.after as i64 - tokens.before as i64;
        let questions = counted(group.members.len(), "question");
        let of = "tokens of whole texts (estimated)";
        page.plain(&format!("{of}: {change:+} over {questions}"));
    }
    page.lines.join("\n")
}

fn head(group: &Group, pending: &[Pending]) -> String {
    let counted = |what: &str| counted(group.members.len(), what);
    match group.kind {
        Kind::Edit => {
            let cause = group.causes.first();
            let place = cause.map_or(String::new(), |cause| format!(": {}", place(cause)));
            format!("one edit changes {}{place}", counted("snapshot"))
        }
        Kind::Scene => format!("{} changed", counted("pinned scene")),
        Kind::Picture => format!("{} changed alike", counted("picture")),
        Kind::New => {
            let task = &pending[group.members[0]].info.task;
            format!("{} of `{task}`", counted("new snapshot"))
        }
    }
}

fn place(cause: &Cause) -> String {
    match (&cause.file, cause.line) {
        (Some(file), Some(line)) => format!("{} {file}:{line}", cause.component),
        _ => cause.component.clone(),
    }
}

struct Page {
    color: Color,
    lines: Vec<String>,
}

impl Page {
    /// Returns a style that has an effect only if colours are wanted.
    fn style(&self) -> Style {
        Style::new().force_styling(self.color == Color::Ansi)
    }

    fn plain(&mut self, text: &str) {
        self.line(text, &Style::new());
    }

    fn line(&mut self, text: &str, style: &Style) {
        self.lines.push(style.apply_to(shown(text)).to_string());
    }

    fn list(&mut self, indent: &str, items: impl Iterator<Item = String>) {
        let items: Vec<String> = items.collect();
        for item in items.iter().take(LISTED) {
            self.plain(&format!("{indent}{item}"));
        }
        if items.len() > LISTED {
            self.plain(&format!("{indent}… and {} more", items.len() - LISTED));
        }
    }

    /// Adds the lines of an edit; in colour, the words that differ are marked.
    fn edit(&mut self, edit: &Edit) {
        let faint = self.style().dim();
        self.line("@@", &faint);
        for line in &edit.before {
            self.line(&format!("  {line}"), &faint);
        }
        let [old, new] = [&edit.removed, &edit.added].map(|lines| {
            let lines = lines.iter().map(|line| shown(line) + "\n");
            lines.collect::<String>()
        });
        let diff = TextDiff::from_lines(&old, &new);
        let changes = diff.ops().iter();
        for change in changes.flat_map(|op| diff.iter_inline_changes(op)) {
            let (sign, style) = match change.tag() {
                ChangeTag::Delete => ("- ", self.style().red()),
                ChangeTag::Insert => ("+ ", self.style().green()),
                ChangeTag::Equal => ("  ", faint.clone()),
            };
            let marked = style.clone().bold().underlined();
            let mut line = style.apply_to(sign).to_string();
            for (is_other, text) in change.iter_strings_lossy() {
                let style = if is_other { &marked } else { &style };
                line.push_str(&style.apply_to(text.trim_end_matches('\n')).to_string());
            }
            self.lines.push(line);
        }
        for line in &edit.after {
            self.line(&format!("  {line}"), &faint);
        }
    }

    fn new_texts<'p>(&mut self, members: impl Iterator<Item = &'p Pending>) {
        for one in members {
            if let Contents::Text(text) = &one.proposed.contents {
                self.line(&format!("@@ {}", one.name), &self.style().dim());
                for line in text.lines() {
                    self.plain(&format!("+ {line}"));
                }
            }
        }
    }
}

/// Makes foreign text safe for a terminal.
fn shown(text: &str) -> String {
    visible(&text.replace('\t', "    ")).into_owned()
}
