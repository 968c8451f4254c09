//! What the checks of one task share: its names, what is known so far, and where faults are reported.

use super::names::Names;
use super::variables::Variables;
use crate::diag::{Code, Diagnostic, Report, Reported, among, nearest};
use crate::load::Loaded;
use fab_grammar::ast::{Expr, Name, Quantity};
use fab_grammar::{FileId, Span};
use fab_program::vocabulary::Word;
use fab_program::{ActionField, Camera, Cloth, Layer};
use std::collections::BTreeMap;

/// A part of a task: nothing where it is not declared, the proof of an error where its declaration is wrong.
pub(crate) type Declared<T> = Result<Option<T>, Reported>;

/// What the checks of one task share.
pub(crate) struct Context<'a, 'r> {
    pub loaded: &'r Loaded<'a>,
    pub report: &'r mut Report,
    pub names: Names<'a>,
    pub constants: BTreeMap<&'a str, Result<Quantity<'a>, Reported>>,
    /// Each known once its section is checked; later sections depend on it.
    pub cloth: Declared<Cloth>,
    /// The grid that takes the place of every declared one, where there is one.
    pub grid: Option<[u32; 2]>,
    pub camera: Declared<Camera>,
    /// Where each keypoint stands among them, and the proof of an error where its declaration is wrong.
    pub keypoints: BTreeMap<&'a str, (usize, Result<(), Reported>)>,
    pub actions: Fields<'a>,
    pub layers: BTreeMap<&'a str, Result<Layer, Reported>>,
    /// Layers that the texts of the stage under way name.
    pub named_layers: Vec<(String, Span)>,
    /// The variables of the templates that are built so far.
    pub variables: Variables,
}

/// The fields of the action as declared, each right or reported.
pub(crate) struct Fields<'a> {
    pub list: Vec<(&'a str, Result<ActionField, Reported>)>,
    /// Whether they make up an action.
    pub complete: Result<(), Reported>,
}

impl Fields<'_> {
    /// Returns the field of that name; nothing where there is none.
    pub fn get(&self, name: &str) -> Declared<&ActionField> {
        let field = self.list.iter().find(|(known, _)| *known == name);
        field
            .map(|(_, field)| field.as_ref().map_err(|reported| *reported))
            .transpose()
    }

    /// Returns the fields that are right.
    pub fn right(&self) -> impl Iterator<Item = &ActionField> {
        self.list
            .iter()
            .filter_map(|(_, field)| field.as_ref().ok())
    }
}

impl<'a, 'r> Context<'a, 'r> {
    /// Returns what is known outside of tasks: nothing.
    pub fn outside(loaded: &'r Loaded<'a>, report: &'r mut Report) -> Context<'a, 'r> {
        Context {
            report,
            names: Names::none(loaded.entry().id),
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

    // ---- what is known ---------------------------------------------------------------------------

    /// Returns the cloth's longer side, metres; not a number in a base without a cloth, which is no program.
    pub fn edge_m(&self) -> Result<f64, Reported> {
        Ok(self
            .cloth
            .as_ref()
            .map_err(|it| *it)?
            .as_ref()
            .map_or(f64::NAN, Cloth::edge_m))
    }

    /// Returns the flat cloth's area, square metres; not a number in a base without a cloth.
    pub fn area_m2(&self) -> Result<f64, Reported> {
        Ok(self
            .cloth
            .as_ref()
            .map_err(|it| *it)?
            .as_ref()
            .map_or(f64::NAN, Cloth::area_m2))
    }

    /// Returns the pixels in one metre on the table; not a number in a base without a camera, which is no program.
    pub fn px_per_m(&self) -> Result<f64, Reported> {
        Ok(self
            .camera
            .as_ref()
            .map_err(|it| *it)?
            .as_ref()
            .map_or(f64::NAN, Camera::px_per_m))
    }

    /// Returns what stands at a place, cut to a length that fits a message.
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

    /// Reports that something is missing, unless what does not fit in its block may be it.
    pub fn missing(&mut self, is_damaged: bool, file: FileId, diagnostic: Diagnostic) -> Reported {
        match self.loaded.fault(file).filter(|_| is_damaged) {
            Some(reported) => reported,
            None => self.error(diagnostic),
        }
    }

    /// Reports that something else stands where `wanted` is expected.
    pub fn unexpected(&mut self, code: Code, expr: Expr<'_>, wanted: &str) -> Diagnostic {
        let found = self.written(expr.span());
        Diagnostic::new(
            code,
            expr.span(),
            format!("expected {wanted}, found `{found}`"),
        )
    }

    /// Reports a name that nothing of `kind` has, unless it may be declared where something does not fit.
    pub fn unknown<'c>(
        &mut self,
        kind: &str,
        name: Name<'_>,
        candidates: impl IntoIterator<Item = &'c str>,
    ) -> Reported {
        self.unknown_at(kind, name.text(), name.span(), candidates)
    }

    /// Does what [`Context::unknown`] does, for names joined by dots.
    pub fn unknown_at<'c>(
        &mut self,
        kind: &str,
        text: &str,
        span: Span,
        candidates: impl IntoIterator<Item = &'c str>,
    ) -> Reported {
        if let Some(reported) = self.names.hidden(text, self.loaded) {
            return reported;
        }
        let candidates: Vec<&str> = candidates.into_iter().collect();
        let message = format!("there is no {kind} `{text}`");
        let diagnostic = Diagnostic::new(Code::UnknownName, span, message);
        self.error(match nearest(text, candidates.iter().copied()) {
            Some(meant) => diagnostic.meant(span, meant),
            None if candidates.is_empty() => diagnostic,
            None => diagnostic.help(format!("there is {}", among(candidates))),
        })
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

    /// Reports that there are too many of something, where there is one beyond the limit.
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
