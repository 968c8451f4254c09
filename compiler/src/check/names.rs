//! The names of one task, and the meaning of each.
//!
//! Constants, keypoints, texts that stages read, action fields and layers share one namespace: all can be used in a
//! text.

use crate::diag::{Code, Diagnostic, Report, Reported};
use crate::merge::{Merged, declared_twice};
use fab_grammar::ast::{Expr, Name};
use fab_program::{EXTRACTORS, KeypointShape};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

/// Names that keypoints and constants cannot have.
pub(crate) const RESERVED: [&str; 5] = ["last", "step", "scene", "depth", "unreachable"];

/// The meaning of a name.
#[derive(Clone, Copy)]
pub(crate) enum Meaning<'a> {
    /// A constant with its value.
    Constant(Expr<'a>),
    /// A keypoint with its shape and its place among all keypoints. It has no shape if its declaration is wrong; once that
    /// is reported, the name has no meaning.
    Keypoint(Option<KeypointShape>, usize),
    /// A text that the stage with this index reads.
    Text(usize),
    /// A field of the action.
    Field,
    /// A layer that is drawn on the camera's picture.
    Layer,
}

impl Meaning<'_> {
    fn noun(&self) -> &'static str {
        match self {
            Meaning::Constant(_) => "constant",
            Meaning::Keypoint(..) => "keypoint",
            Meaning::Text(_) => "text",
            Meaning::Field => "field",
            Meaning::Layer => "layer",
        }
    }
}

/// Every name of a task, with the proof of an error if its declaration is wrong. Outside of tasks there are none.
#[derive(Default)]
pub(crate) struct Names<'a>(BTreeMap<&'a str, Result<Meaning<'a>, Reported>>);

impl<'a> Names<'a> {
    /// Collects the names of a task, and reports reserved ones and those with two meanings. A keypoint's shape follows
    /// from the call in its declaration.
    pub fn of(merged: &Merged<'a>, report: &mut Report) -> Names<'a> {
        let mut declared = declared(merged);
        // Of two declarations, the one further down is at fault; what another file declares was there before.
        declared.sort_by_key(|(name, _)| (Reverse(name.span().file), name.span().start));
        let mut names = Names::default();
        let mut places: BTreeMap<&str, (Name<'_>, &str)> = BTreeMap::new();
        for (name, meaning) in declared {
            let kind = meaning.noun();
            let (first, first_kind) = *places.entry(name.text()).or_insert((name, kind));
            let meaning = if first.span() != name.span() {
                let kind = if kind == first_kind { kind } else { "name" };
                let diagnostic = declared_twice(kind, name.text(), first.span(), name.span());
                Err(report.error(diagnostic))
            } else if RESERVED.contains(&name.text())
                && matches!(meaning, Meaning::Constant(_) | Meaning::Keypoint(..))
            {
                let message = format!("`{}` is a reserved name", name.text());
                let help = format!("choose another name for the {kind}");
                let diagnostic = Diagnostic::new(Code::DuplicateName, name.span(), message);
                Err(report.error(diagnostic.help(help)))
            } else {
                Ok(meaning)
            };
            names.0.insert(name.text(), meaning);
        }
        // A missing or misspelt field is reported at the action's declaration.
        if merged.actions().is_some() {
            for field in ["pick", "place"] {
                names.0.entry(field).or_insert(Ok(Meaning::Field));
            }
        }
        names
    }

    /// Returns the meaning of a name, `None` if it has none; fails if its declaration is wrong.
    pub fn get(&self, name: &str) -> Result<Option<Meaning<'a>>, Reported> {
        self.0.get(name).copied().transpose()
    }

    /// Notes that the declaration of a name is wrong.
    pub fn fail(&mut self, name: &'a str, reported: Reported) {
        self.0.insert(name, Err(reported));
    }

    /// Returns the names whose meaning passes the test, in alphabetical order; only the first 1000 names are
    /// searched.
    pub fn that(&self, fits: impl Fn(Meaning<'a>) -> bool) -> Vec<&'a str> {
        // These are only suggestions. Searching all names for each unknown one would take quadratic time.
        const MOST: usize = 1000;
        let some = self.0.iter().take(MOST);
        some.filter(|(_, meaning)| meaning.is_ok_and(&fits))
            .map(|(name, _)| *name)
            .collect()
    }
}

/// Returns every declared name with its meaning.
fn declared<'a>(merged: &Merged<'a>) -> Vec<(Name<'a>, Meaning<'a>)> {
    let constants = merged.constants.iter();
    let constants = constants.map(|it| (it.name(), Meaning::Constant(it.value())));
    let keypoints = merged.keypoints.iter().map(|keypoint| {
        let shape = shape(keypoint.value());
        let place = merged.keypoints.place(keypoint.name().text());
        let place = place.unwrap_or_default();
        (keypoint.name(), Meaning::Keypoint(shape, place))
    });
    let fields = merged.actions().into_iter().flat_map(|part| part.fields());
    let fields = fields.map(|field| (field.name(), Meaning::Field));
    let texts = merged.stages.iter().enumerate().flat_map(|(stage, part)| {
        // A stage with two `read` lines gets its own error.
        let mut seen = BTreeSet::from(["action"]);
        let names = part.read().map(|read| read.name());
        let names = names.filter(move |name| seen.insert(name.text()));
        names.map(move |name| (name, Meaning::Text(stage)))
    });
    let layers = merged.annotate().into_iter().flat_map(|part| part.list());
    let layers = layers.map(|layer| (layer.name(), Meaning::Layer));
    constants
        .chain(keypoints)
        .chain(fields)
        .chain(texts)
        .chain(layers)
        .collect()
}

fn shape(value: Expr<'_>) -> Option<KeypointShape> {
    let Expr::Call(call) = value else {
        return None;
    };
    let mut rows = EXTRACTORS.iter();
    let row = rows.find(|row| row.call.signature.name == call.name().text());
    row.map(|row| row.gives)
}
