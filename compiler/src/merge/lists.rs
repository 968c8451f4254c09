//! Lists of named parts, and statements that may appear only once.

use crate::diag::{Code, Diagnostic, Report, Reported, among, nearest};
use crate::load::Loaded;
use fab_grammar::Span;
use fab_grammar::ast::Name;
use std::collections::{BTreeMap, BTreeSet};

/// Parts in order, found by name.
pub(crate) struct Indexed<'a, T> {
    list: Vec<Option<T>>,
    places: BTreeMap<&'a str, usize>,
}

impl<T> Default for Indexed<'_, T> {
    fn default() -> Self {
        Indexed {
            list: Vec::new(),
            places: BTreeMap::new(),
        }
    }
}

impl<'a, T: Copy> Indexed<'a, T> {
    /// Replaces the part of this name in place, or appends a new one.
    pub fn put(&mut self, name: &'a str, part: T) {
        match self.places.get(name) {
            Some(place) => self.list[*place] = Some(part),
            None => {
                self.places.insert(name, self.list.len());
                self.list.push(Some(part));
            }
        }
    }

    /// Merges a block of parts. A part with an existing name replaces the old one. New parts above it in the block go
    /// directly before it; all other parts go last.
    pub fn put_block(&mut self, block: impl Iterator<Item = T>, name: impl Fn(T) -> &'a str) {
        let mut before: BTreeMap<usize, Vec<T>> = BTreeMap::new();
        let mut new: Vec<T> = Vec::new();
        for part in block {
            match self.places.get(name(part)) {
                Some(place) => {
                    self.list[*place] = Some(part);
                    before.entry(*place).or_default().append(&mut new);
                }
                None => new.push(part),
            }
        }
        if before.values().any(|moved| !moved.is_empty()) {
            let old = std::mem::take(&mut self.list);
            self.places.clear();
            for (place, part) in old.into_iter().enumerate() {
                for moved in before.remove(&place).into_iter().flatten() {
                    self.put(name(moved), moved);
                }
                match part {
                    Some(part) => self.put(name(part), part),
                    None => self.list.push(None),
                }
            }
        }
        for part in new {
            self.put(name(part), part);
        }
    }

    /// Removes a part.
    pub fn remove(&mut self, name: &str) -> Option<T> {
        let place = self.places.remove(name)?;
        self.list[place].take()
    }

    pub fn get(&self, name: &str) -> Option<T> {
        self.places.get(name).and_then(|place| self.list[*place])
    }

    /// Returns the position of a part among all that were ever added; later ones have higher numbers.
    pub fn place(&self, name: &str) -> Option<usize> {
        self.places.get(name).copied()
    }

    pub fn iter(&self) -> impl DoubleEndedIterator<Item = T> {
        self.list.iter().filter_map(|part| *part)
    }

    pub fn len(&self) -> usize {
        self.places.len()
    }

    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }
}

/// The first of some statements, and the proof of an error if there are more.
///
/// The first is still checked, so its own errors are reported in the same run.
pub(crate) struct FirstStatement<T> {
    pub first: Option<T>,
    pub alone: Result<(), Reported>,
}

/// Returns the first statement, and reports any others.
pub(crate) fn once<T: Copy>(
    list: impl IntoIterator<Item = T>,
    what: &str,
    span: impl Fn(T) -> Span,
    report: &mut Report,
) -> FirstStatement<T> {
    let mut list = list.into_iter();
    let first = list.next();
    let mut alone = Ok(());
    for (first, again) in first.into_iter().cycle().zip(list) {
        alone = Err(report.error(repeated(what, span(first), span(again))));
    }
    FirstStatement { first, alone }
}

/// Makes the diagnostic for a statement that is repeated.
pub(crate) fn repeated(what: &str, first: Span, again: Span) -> Diagnostic {
    let message = format!("`{what}` is stated twice");
    Diagnostic::new(Code::Repeated, again, message).also(first, "stated here first")
}

/// The names that are declared twice, each with the proof of its error.
#[derive(Default)]
pub(crate) struct DuplicateNames<'a>(pub BTreeMap<&'a str, Reported>);

impl DuplicateNames<'_> {
    /// Returns the proof of an error if this name is declared twice.
    pub fn of(&self, name: &str) -> Result<(), Reported> {
        self.0.get(name).map_or(Ok(()), |reported| Err(*reported))
    }

    /// Returns the proof of an error if any name is declared twice.
    pub fn any(&self) -> Result<(), Reported> {
        self.0.values().next().map_or(Ok(()), |it| Err(*it))
    }
}

/// Reports names that appear twice.
pub(crate) fn unique<'a>(
    names: impl IntoIterator<Item = Name<'a>>,
    kind: &str,
    report: &mut Report,
) -> DuplicateNames<'a> {
    twice(names, report, |name, first| {
        declared_twice(kind, name.text(), first, name.span())
    })
}

/// Reports names that are left out twice.
pub(crate) fn left_out_once<'a>(
    names: impl IntoIterator<Item = Name<'a>>,
    report: &mut Report,
) -> Result<(), Reported> {
    let make = |name: Name<'_>, first| {
        let message = format!("`{}` is left out twice", name.text());
        let diagnostic = Diagnostic::new(Code::Repeated, name.span(), message);
        diagnostic.also(first, "left out here first")
    };
    twice(names, report, make).any()
}

/// - `make`: makes the diagnostic of a name, and of where it appears first.
fn twice<'a>(
    names: impl IntoIterator<Item = Name<'a>>,
    report: &mut Report,
    make: impl Fn(Name<'a>, Span) -> Diagnostic,
) -> DuplicateNames<'a> {
    let mut seen: BTreeMap<&str, Span> = BTreeMap::new();
    let mut twice = DuplicateNames::default();
    for name in names {
        if let Some(first) = seen.get(name.text()) {
            let reported = report.error(make(name, *first));
            twice.0.insert(name.text(), reported);
        } else {
            seen.insert(name.text(), name.span());
        }
    }
    twice
}

/// Makes the diagnostic for a name that is declared twice.
pub(crate) fn declared_twice(kind: &str, name: &str, first: Span, again: Span) -> Diagnostic {
    let message = format!("the {kind} `{name}` is declared twice");
    Diagnostic::new(Code::DuplicateName, again, message).also(first, "declared here first")
}

/// A change to an inherited part, by name. It is an error if no such part is inherited.
pub(super) struct Change {
    code: Code,
    verb: &'static str,
    adds: Adds,
}

/// Whether the author may have meant to add the part.
#[derive(PartialEq)]
enum Adds {
    Perhaps,
    No,
}

pub(super) const OVERRIDE: Change = Change {
    code: Code::NothingToOverride,
    verb: "override",
    adds: Adds::Perhaps,
};

pub(super) const LEAVE_OUT: Change = Change {
    code: Code::NothingToRemove,
    verb: "leave out",
    adds: Adds::No,
};

impl Change {
    /// Reports a name that is not inherited, and lists the names that are; nothing if it may be in a file that
    /// cannot be read.
    pub fn impossible<'a>(
        &self,
        kind: &str,
        name: Name<'a>,
        inherited: &BTreeSet<&str>,
        loaded: &Loaded<'a>,
        report: &mut Report,
    ) -> Reported {
        if let Some(reported) = loaded.unread(name.span().file) {
            return reported;
        }
        let message = format!("there is no {kind} `{}` to {}", name.text(), self.verb);
        let diagnostic = Diagnostic::new(self.code, name.span(), message).about(name.text());
        let diagnostic = match nearest(name.text(), inherited.iter().copied()) {
            Some(meant) => diagnostic.meant(name.span(), meant),
            None if inherited.is_empty() => diagnostic.help(format!(
                "this is only for a {kind} of an extended task, and this task inherits none"
            )),
            None => diagnostic.help(format!("it inherits {}", among(inherited.iter().copied()))),
        };
        report.error(match self.adds {
            Adds::No => diagnostic,
            Adds::Perhaps => diagnostic.help(format!(
                "to add a {kind}, write `{kind} {}` without `override`",
                name.text()
            )),
        })
    }
}
