//! Parts of one kind, found by their names: how those of a task join those that it inherits.

use crate::diag::{Code, Diagnostic};
use fab_grammar::Span;
use fab_grammar::ast::{Declares, Name};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

/// A part where it is declared.
#[derive(Clone)]
pub(crate) struct Site<'a, T> {
    pub name: Cow<'a, str>,
    /// Where the name stands.
    pub span: Span,
    pub declares: Declares,
    pub part: T,
}

impl<'a, T> Site<'a, T> {
    pub fn new(name: Name<'a>, part: T) -> Site<'a, T> {
        Site {
            name: Cow::Borrowed(name.text()),
            span: name.span(),
            declares: Declares::New,
            part,
        }
    }

    pub fn overriding(self, declares: Declares) -> Site<'a, T> {
        Site { declares, ..self }
    }
}

/// Parts in order, found by name.
pub(crate) struct Parts<'a, T> {
    /// The word for one of them.
    kind: &'static str,
    list: Vec<Option<Site<'a, T>>>,
    places: BTreeMap<Cow<'a, str>, usize>,
    /// The inherited parts that are left out.
    removed: BTreeSet<Cow<'a, str>>,
}

impl<'a, T: Copy> Parts<'a, T> {
    /// - `kind`: the word for one of them.
    pub(super) fn of(kind: &'static str) -> Parts<'a, T> {
        Parts {
            kind,
            list: Vec::new(),
            places: BTreeMap::new(),
            removed: BTreeSet::new(),
        }
    }

    /// Takes all parts out; those that were left out stay known.
    fn take(&mut self) -> Parts<'a, T> {
        let taken = std::mem::replace(self, Parts::of(self.kind));
        self.removed.clone_from(&taken.removed);
        taken
    }

    pub fn get(&self, name: &str) -> Option<T> {
        self.site(name).map(|site| site.part)
    }

    pub fn site(&self, name: &str) -> Option<&Site<'a, T>> {
        self.list[*self.places.get(name)?].as_ref()
    }

    /// Returns the position of a part among all that were ever added; later ones have higher numbers.
    pub fn place(&self, name: &str) -> Option<usize> {
        self.places.get(name).copied()
    }

    pub fn iter(&self) -> impl DoubleEndedIterator<Item = T> {
        self.sites().map(|site| site.part)
    }

    pub fn sites(&self) -> impl DoubleEndedIterator<Item = &Site<'a, T>> {
        self.list.iter().flatten()
    }

    pub fn names(&self) -> impl DoubleEndedIterator<Item = &str> {
        self.sites().map(|site| site.name.as_ref())
    }

    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Returns whether an inherited part of this name is left out.
    pub fn is_removed(&self, name: &str) -> bool {
        self.removed.contains(name)
    }

    /// Replaces parts in their places, and appends new ones.
    pub fn put(&mut self, own: &[Site<'a, T>]) {
        for site in own {
            self.removed.remove(&site.name);
            match self.places.get(&site.name) {
                Some(place) => self.list[*place] = Some(site.clone()),
                None => {
                    self.places.insert(site.name.clone(), self.list.len());
                    self.list.push(Some(site.clone()));
                }
            }
        }
    }

    /// Replaces and appends the parts of a block, which may use those above them: a new part directly above a
    /// replaced one goes before it.
    pub fn put_block(&mut self, own: &[Site<'a, T>]) {
        let mut above: BTreeMap<usize, &[Site<'a, T>]> = BTreeMap::new();
        let mut begin = 0;
        for (at, site) in own.iter().enumerate() {
            if let Some(place) = self.place(&site.name) {
                above.insert(place, &own[begin..at]);
                begin = at + 1;
            }
        }
        let before = self.take();
        for (place, site) in before.list.into_iter().enumerate() {
            self.put(above.remove(&place).unwrap_or_default());
            self.put(site.as_slice());
        }
        self.put(own);
    }

    /// Adds new parts, and replaces those that are marked with `override`. Returns what is wrong with the marks.
    pub(super) fn change(&mut self, own: &[Site<'a, T>]) -> Vec<Diagnostic> {
        let unfit = own.iter().filter_map(|site| {
            let inherited = self.site(&site.name);
            match (site.declares, inherited) {
                (Declares::New, Some(inherited)) => Some(self.not_marked(site, inherited)),
                (Declares::Override, None) => Some(self.nothing_to_override(site)),
                _ => None,
            }
        });
        let unfit = unfit.collect();
        self.put(own);
        unfit
    }

    /// Leaves inherited parts out. Returns a diagnostic for each that neither is there nor was left out before.
    pub(super) fn remove(&mut self, names: &[Name<'a>]) -> Vec<Diagnostic> {
        let mut unknown = Vec::new();
        for name in names {
            if let Some(place) = self.places.remove(name.text()) {
                self.list[place] = None;
                self.removed.insert(Cow::Borrowed(name.text()));
            } else if !self.is_removed(name.text()) {
                let message = format!("there is no {} `{}` to leave out", self.kind, name.text());
                let diagnostic = Diagnostic::new(Code::NothingToRemove, name.span(), message);
                unknown.push(self.suggest(diagnostic, name.text()));
            }
        }
        unknown
    }

    /// Replaces all parts by others.
    pub(super) fn restate(&mut self, own: &[Site<'a, T>]) {
        let before = self.take();
        self.removed.extend(before.places.into_keys());
        self.put(own);
    }

    fn not_marked(&self, site: &Site<'a, T>, inherited: &Site<'a, T>) -> Diagnostic {
        let kind = self.kind;
        let message = format!("`{}` replaces a {kind} of an extended task", site.name);
        Diagnostic::new(Code::NotMarkedAsOverride, site.span, message)
            .also(inherited.span, "declared here")
            .help(format!(
                "write `override {kind}` to replace it, or choose another name to add a {kind}"
            ))
    }

    fn nothing_to_override(&self, site: &Site<'a, T>) -> Diagnostic {
        let (kind, name) = (self.kind, &site.name);
        let message = format!("there is no {kind} `{name}` to override");
        let diagnostic = Diagnostic::new(Code::NothingToOverride, site.span, message);
        self.suggest(diagnostic, name).help(format!(
            "to add a {kind}, write `{kind} {name}` without `override`"
        ))
    }

    /// Offers an inherited part for a name that none has.
    fn suggest(&self, diagnostic: Diagnostic, name: &str) -> Diagnostic {
        let none = format!(
            "this is only for a {} of an extended task, and this task inherits none",
            self.kind
        );
        diagnostic.about(name).suggest(name, self.names(), &none)
    }
}
