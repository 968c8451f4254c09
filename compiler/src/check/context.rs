//! The shared state of one task's checks: its names, the parts checked so far, and the report.

use super::names::Names;
use super::variables::Variables;
use crate::diag::{Code, Diagnostic, Report, Reported, among};
use crate::load::Loaded;
use fab_grammar::Span;
use fab_grammar::ast::{Expr, Name};
use fab_program::vocabulary::Word;
use fab_program::{
    ActionField, Camera, Cloth, Colour, Face, Keypoint, Layer, Material, Sequence, Stage, Subgoals,
    Template,
};
use std::collections::BTreeMap;

/// A result of checks that fail only after an error was reported.
pub(crate) type Result<T, E = Reported> = std::result::Result<T, E>;

/// A part of a task: `Ok(None)` if it is not declared, `Err(Reported)` if its declaration is wrong.
pub(crate) type Declared<T> = Result<Option<T>>;

/// Checks a part of a task, if it is declared.
pub(crate) fn declared<N, T>(part: Option<N>, check: impl FnOnce(N) -> Result<T>) -> Declared<T> {
    part.map(check).transpose()
}

/// What files declare outside of tasks, checked once; each by the place of its declaration.
#[derive(Default)]
pub(crate) struct Outside {
    pub experts: BTreeMap<Span, Result<Vec<Sequence>>>,
    pub materials: BTreeMap<Span, Result<Material>>,
}

/// The shared state of one task's checks.
pub(crate) struct Context<'a> {
    pub loaded: &'a Loaded<'a>,
    pub outside: &'a Outside,
    pub report: &'a mut Report,
    pub names: Names<'a>,
    /// Set, like `camera` and the fields below, when its section is checked. Later sections depend on it.
    pub cloth: Declared<Cloth>,
    /// The grid that replaces every declared one, if the caller gave one.
    pub grid: Option<[u32; 2]>,
    pub camera: Declared<Camera>,
    pub subgoals: Declared<Subgoals>,
    /// The most steps.
    pub horizon: Declared<u32>,
    pub keypoints: Result<Vec<Keypoint>>,
    /// How many keypoints may be named: an extractor uses those above its own.
    pub n_keypoints: usize,
    pub actions: Named<'a, ActionField>,
    /// Whether the fields make a complete action.
    pub complete: Result<()>,
    pub layers: Named<'a, Layer>,
    pub stages: Named<'a, Stage>,
    /// The texts that stages say and that tell of a refused answer.
    pub templates: Vec<Result<Template>>,
    /// The layers that the texts of the current stage name.
    pub named_layers: Vec<(String, Span)>,
    /// The variables of the templates built so far.
    pub variables: Variables,
}

/// Parts with names, in the order of their declarations; errors in them were reported.
pub(crate) struct Named<'a, T>(pub Vec<(&'a str, Result<T>)>);

impl<T> Named<'_, T> {
    /// Returns the part of this name, if there is one.
    pub fn get(&self, name: &str) -> Declared<&T> {
        let part = self.0.iter().find(|(declared, _)| *declared == name);
        let part = part.map(|(_, part)| part.as_ref());
        part.transpose().map_err(|reported| *reported)
    }

    /// Returns the parts without errors.
    pub fn right(&self) -> impl Iterator<Item = &T> {
        self.0.iter().filter_map(|(_, part)| part.as_ref().ok())
    }

    /// Takes all parts out; fails if one has an error.
    pub fn take(&mut self) -> Result<Vec<T>> {
        let parts = std::mem::take(&mut self.0).into_iter();
        parts.map(|(_, part)| part).collect()
    }
}

impl<'a> Context<'a> {
    /// Makes the context in which nothing is declared yet.
    pub fn new(
        loaded: &'a Loaded<'a>,
        outside: &'a Outside,
        report: &'a mut Report,
    ) -> Context<'a> {
        Context {
            report,
            outside,
            names: Names::default(),
            cloth: Ok(None),
            grid: None,
            camera: Ok(None),
            subgoals: Ok(None),
            horizon: Ok(None),
            keypoints: Ok(Vec::new()),
            n_keypoints: usize::MAX,
            actions: Named(Vec::new()),
            complete: Ok(()),
            layers: Named(Vec::new()),
            stages: Named(Vec::new()),
            templates: Vec::new(),
            named_layers: Vec::new(),
            variables: Variables::default(),
            loaded,
        }
    }

    // ---- parts of the task -----------------------------------------------------------------------

    /// Returns the cloth's longer side, metres; NaN in a base without a cloth, which never becomes a program.
    pub fn edge_m(&self) -> Result<f64> {
        measure_of(&self.cloth, Cloth::edge_m)
    }

    /// Returns the flat cloth's area, square metres; NaN in a base without a cloth.
    pub fn area_m2(&self) -> Result<f64> {
        measure_of(&self.cloth, Cloth::area_m2)
    }

    /// Returns the pixels per metre on the table; NaN in a base without a camera, which never becomes a program.
    pub fn px_per_m(&self) -> Result<f64> {
        measure_of(&self.camera, Camera::px_per_m)
    }

    /// Returns the colour of a face of the cloth; in a base without a cloth, that of the recorded one.
    pub fn colour(&self, face: Face) -> Result<Colour> {
        let cloth = self.cloth.as_ref().map_err(|reported| *reported)?;
        let cloth = cloth.as_ref();
        Ok(cloth.map_or_else(|| Colour::recorded(face), |it| it.colour(face)))
    }

    /// Finds the stage of this name, with its index.
    pub fn stage(&mut self, name: Name<'_>) -> Result<(usize, Stage)> {
        let stages = &self.stages.0;
        match stages.iter().position(|(known, _)| *known == name.text()) {
            Some(number) => Ok((number, stages[number].1.clone()?)),
            None => {
                let names: Vec<&str> = stages.iter().map(|(known, _)| *known).collect();
                Err(self.unknown("stage", name, names))
            }
        }
    }

    /// Returns the text of a span, cut to a length that fits a message.
    pub fn written(&self, span: Span) -> String {
        const MOST: usize = 40;
        let text = self.loaded.written(span);
        match text.char_indices().nth(MOST) {
            None => text.to_owned(),
            Some((end, _)) => format!("{}…", &text[..end]),
        }
    }

    // ---- faults ----------------------------------------------------------------------------------

    /// Reports an error.
    pub fn error(&mut self, diagnostic: Diagnostic) -> Reported {
        self.report.error(diagnostic)
    }

    /// Reports an error without advice.
    pub fn fault(&mut self, code: Code, span: Span, message: impl Into<String>) -> Reported {
        self.error(Diagnostic::new(code, span, message))
    }

    /// Reports an error with advice.
    pub fn refuse(
        &mut self,
        code: Code,
        span: Span,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Reported {
        self.error(Diagnostic::new(code, span, message).help(help))
    }

    /// Adds a warning or a note.
    pub fn remark(&mut self, diagnostic: Diagnostic) {
        self.report.remark(diagnostic);
    }

    /// Adds a warning or a note with advice.
    pub fn warn(
        &mut self,
        code: Code,
        span: Span,
        message: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.remark(Diagnostic::new(code, span, message).help(help));
    }

    /// Keeps only those findings of a check that are within a place.
    pub fn within(&mut self, place: Span, check: impl FnOnce(&mut Context<'a>)) {
        let before = std::mem::take(self.report);
        check(self);
        let found = std::mem::replace(self.report, before);
        self.report.absorb_within(place, found);
    }

    /// Makes the diagnostic for an expression that is not `expected`.
    pub fn unexpected(&self, code: Code, expr: Expr<'_>, expected: &str) -> Diagnostic {
        let found = self.written(expr.span());
        let message = format!("expected {expected}, found `{found}`");
        let diagnostic = Diagnostic::new(code, expr.span(), message);
        let word = found.trim_matches('"');
        if word != found && expected.contains(&format!("`{word}`")) {
            return diagnostic.help(format!("write `{word}`, without quotes"));
        }
        diagnostic
    }

    /// Reports pictures for a model that takes none.
    ///
    /// - `what`: what shows them; `stage`: the stage that asks the model.
    pub fn text_model(&mut self, span: Span, what: &str, stage: &str) -> Reported {
        let message = format!("{what} shows a picture, but the stage `{stage}` asks a text model");
        let help = format!("write `model vision` in that stage, or leave out {what}");
        self.refuse(Code::PicturesForTextModel, span, message, help)
    }

    /// Reports a value that depends on the previous action if there may be none.
    ///
    /// - `guarded`: the beginning of the declaration that can have a condition.
    pub fn needs_last(&mut self, span: Span, guarded: &str) -> Reported {
        let message = format!("`{}` is not known in the first step", self.written(span));
        let help = format!("write `{guarded} when last`");
        self.refuse(Code::NeedsLast, span, message, help)
    }

    /// Reports a value that depends on the action before one is proposed.
    pub fn needs_action(&mut self, span: Span) -> Reported {
        let written = self.written(span);
        let message = format!("`{written}` is known only when an action is proposed");
        let help = "fields of the action can be used in checks and their messages";
        self.refuse(Code::NotYetKnown, span, message, help)
    }

    /// Reports the lines that a block must have and does not, all in one error.
    ///
    /// - `lines`: the word of each, and whether it is there.
    pub fn lacking(
        &mut self,
        code: Code,
        (block, span): (&str, Span),
        lines: &[(&str, bool)],
        help: &str,
    ) -> Reported {
        let lacks = lines.iter().filter(|(_, is_there)| !is_there);
        let message = format!("{block} has no {}", among(lacks.map(|(word, _)| *word)));
        self.refuse(code, span, message, help)
    }

    /// Reports an expression that is not `expected`.
    pub fn wrong(
        &mut self,
        code: Code,
        expr: Expr<'_>,
        expected: &str,
        help: Option<&str>,
    ) -> Reported {
        let diagnostic = self.unexpected(code, expr, expected);
        self.error(match help {
            Some(help) => diagnostic.help(help),
            None => diagnostic,
        })
    }

    /// Reports an unknown name of `kind`.
    pub fn unknown<'c>(
        &mut self,
        kind: &str,
        name: Name<'_>,
        candidates: impl IntoIterator<Item = &'c str>,
    ) -> Reported {
        self.unknown_at(kind, name.text(), name.span(), candidates)
    }

    /// Reports an unknown name, which may be joined by dots, such as `last.pick`.
    pub fn unknown_at<'c>(
        &mut self,
        kind: &str,
        text: &str,
        span: Span,
        candidates: impl IntoIterator<Item = &'c str>,
    ) -> Reported {
        let mut candidates: Vec<&str> = candidates.into_iter().collect();
        // A word with several forms has several rows, one after the other.
        candidates.dedup();
        let message = format!("there is no {kind} `{text}`");
        let diagnostic = Diagnostic::new(Code::UnknownName, span, message).about(text);
        let none = "declare it, or write `use` with the file that declares it";
        self.error(diagnostic.suggest(text, candidates, none))
    }

    /// Finds the row of a table that a name means.
    ///
    /// - `kind`: the noun for a row.
    pub fn row<T>(
        &mut self,
        kind: &str,
        name: Name<'_>,
        rows: &'static [T],
        word: fn(&T) -> &str,
    ) -> Result<&'static T> {
        let row = rows.iter().find(|row| word(row) == name.text());
        row.ok_or_else(|| self.unknown(kind, name, rows.iter().map(word)))
    }

    /// Finds a word of a closed set of `kind`.
    pub fn word(
        &mut self,
        kind: &str,
        name: Name<'_>,
        words: &'static [Word],
    ) -> Result<&'static str> {
        Ok(self.row(kind, name, words, |word| word.name)?.name)
    }

    /// Reports that there are too many of something.
    ///
    /// - `places`: where each is.
    /// - `whole`, `parts`: what has at most so many of what.
    pub fn at_most(
        &mut self,
        most: usize,
        mut places: impl Iterator<Item = Span>,
        whole: &str,
        parts: &str,
    ) -> Result<()> {
        places.nth(most).map_or(Ok(()), |beyond| {
            let message = format!("{whole} has at most {most} {parts}");
            Err(self.fault(Code::OutOfRange, beyond, message))
        })
    }
}

/// Returns a measure of what is declared once; NaN in a base that lacks it.
fn measure_of<T>(declared: &Declared<T>, measure: fn(&T) -> f64) -> Result<f64> {
    let declared = declared.as_ref().map_err(|reported| *reported)?;
    Ok(declared.as_ref().map_or(f64::NAN, measure))
}
