//! The shared state of one task's checks: its names, the parts checked so far, and the report.

use super::names::Names;
use super::variables::Variables;
use crate::diag::{Code, Diagnostic, Report, Reported};
use crate::load::Loaded;
use fab_grammar::Span;
use fab_grammar::ast::{Expr, Name, Quantity};
use fab_program::vocabulary::Word;
use fab_program::{ActionField, Camera, Cloth, Layer, Material, Sequence};
use std::collections::BTreeMap;

/// A part of a task: `Ok(None)` if it is not declared, `Err(Reported)` if its declaration is wrong.
pub(crate) type Declared<T> = Result<Option<T>, Reported>;

/// What files declare outside of tasks, checked once; each by the place of its declaration.
#[derive(Default)]
pub(crate) struct Outside {
    pub experts: BTreeMap<Span, Result<Vec<Sequence>, Reported>>,
    pub materials: BTreeMap<Span, Result<Material, Reported>>,
}

/// The shared state of one task's checks.
pub(crate) struct Context<'a, 'r> {
    pub loaded: &'r Loaded<'a>,
    pub outside: &'r Outside,
    pub report: &'r mut Report,
    pub names: Names<'a>,
    pub constants: BTreeMap<&'a str, Result<Quantity<'a>, Reported>>,
    /// Set, like `camera` and the fields below, when its section is checked. Later sections depend on it.
    pub cloth: Declared<Cloth>,
    /// The grid that replaces every declared one, if the caller gave one.
    pub grid: Option<[u32; 2]>,
    pub camera: Declared<Camera>,
    /// The index of each keypoint, and the proof of an error if its declaration is wrong.
    pub keypoints: BTreeMap<&'a str, (usize, Result<(), Reported>)>,
    pub actions: Fields<'a>,
    pub layers: BTreeMap<&'a str, Result<Layer, Reported>>,
    /// The layers that the texts of the current stage name.
    pub named_layers: Vec<(String, Span)>,
    /// The variables of the templates built so far.
    pub variables: Variables,
}

/// The declared fields of the action; errors in them were reported.
pub(crate) struct Fields<'a> {
    pub list: Vec<(&'a str, Result<ActionField, Reported>)>,
    /// Whether together they make a complete action.
    pub complete: Result<(), Reported>,
}

impl Fields<'_> {
    /// Returns the field of this name, if there is one.
    pub fn get(&self, name: &str) -> Declared<&ActionField> {
        let field = self.list.iter().find(|(declared, _)| *declared == name);
        field
            .map(|(_, field)| field.as_ref().map_err(|reported| *reported))
            .transpose()
    }

    /// Returns the fields without errors.
    pub fn right(&self) -> impl Iterator<Item = &ActionField> {
        self.list
            .iter()
            .filter_map(|(_, field)| field.as_ref().ok())
    }
}

impl<'a, 'r> Context<'a, 'r> {
    /// Makes the context in which nothing is declared yet.
    pub fn new(
        loaded: &'r Loaded<'a>,
        outside: &'r Outside,
        report: &'r mut Report,
    ) -> Context<'a, 'r> {
        Context {
            report,
            outside,
            names: Names::none(),
            constants: BTreeMap::new(),
            cloth: Ok(None),
            grid: None,
            camera: Ok(None),
            keypoints: BTreeMap::new(),
            actions: Fields {
                list: Vec::new(),
                complete: Ok(()),
            },
            layers: BTreeMap::new(),
            named_layers: Vec::new(),
            variables: Variables::default(),
            loaded,
        }
    }

    // ---- cloth and camera ------------------------------------------------------------------------

    /// Returns the cloth's longer side, metres; NaN in a base without a cloth, which never becomes a program.
    pub fn edge_m(&self) -> Result<f64, Reported> {
        measure_of(&self.cloth, Cloth::edge_m)
    }

    /// Returns the flat cloth's area, square metres; NaN in a base without a cloth.
    pub fn area_m2(&self) -> Result<f64, Reported> {
        measure_of(&self.cloth, Cloth::area_m2)
    }

    /// Returns the pixels per metre on the table; NaN in a base without a camera, which never becomes a program.
    pub fn px_per_m(&self) -> Result<f64, Reported> {
        measure_of(&self.camera, Camera::px_per_m)
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

    /// Reports an error in one line.
    pub fn fault(&mut self, code: Code, span: Span, message: impl Into<String>) -> Reported {
        self.error(Diagnostic::new(code, span, message))
    }

    /// Adds a warning or a note.
    pub fn remark(&mut self, diagnostic: Diagnostic) {
        self.report.remark(diagnostic);
    }

    /// Keeps only those findings of a check that are within a place.
    pub fn within(&mut self, place: Span, check: impl FnOnce(&mut Context<'a, '_>)) {
        let before = std::mem::take(self.report);
        check(self);
        let found = std::mem::replace(self.report, before);
        self.report.absorb_within(place, found);
    }

    /// Makes the diagnostic for an expression that is not `expected`.
    pub fn unexpected(&mut self, code: Code, expr: Expr<'_>, expected: &str) -> Diagnostic {
        let found = self.written(expr.span());
        let message = format!("expected {expected}, found `{found}`");
        let diagnostic = Diagnostic::new(code, expr.span(), message);
        let inside = found
            .strip_prefix('"')
            .and_then(|text| text.strip_suffix('"'));
        match inside.filter(|text| expected.contains(&format!("`{text}`"))) {
            Some(word) => diagnostic.help(format!("write `{word}`, without quotes")),
            None => diagnostic,
        }
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

    /// Does the same as [`Context::unknown`] for names joined by dots.
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

    /// Finds a word of a closed set of `kind`.
    pub fn word(
        &mut self,
        kind: &str,
        name: Name<'_>,
        words: &'static [Word],
    ) -> Result<&'static str, Reported> {
        match words.iter().find(|word| word.name == name.text()) {
            Some(word) => Ok(word.name),
            None => Err(self.unknown(kind, name, words.iter().map(|word| word.name))),
        }
    }

    /// Reports that there are too many of something.
    ///
    /// - `beyond`: the first one beyond the limit, if there is one.
    pub fn bounded(
        &mut self,
        beyond: Option<Span>,
        message: impl FnOnce() -> String,
    ) -> Result<(), Reported> {
        match beyond {
            None => Ok(()),
            Some(span) => Err(self.fault(Code::OutOfRange, span, message())),
        }
    }
}

/// Returns a measure of what is declared once; NaN in a base that lacks it.
fn measure_of<T>(declared: &Declared<T>, measure: fn(&T) -> f64) -> Result<f64, Reported> {
    let declared = declared.as_ref().map_err(|reported| *reported)?;
    Ok(declared.as_ref().map_or(f64::NAN, measure))
}
