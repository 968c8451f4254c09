//! The sections of one task or variant, as it states them itself.

use super::lists::{declared_twice, duplicates, repeated};
use super::parts::Site;
use crate::diag::{Code, Diagnostic, Report, Reported};
use crate::lang::sections::{Inheritance, inheritance};
use fab_grammar::Node;
use fab_grammar::ast::{
    AddedSay, Body, Check, Component, Declares, Name, NamedValue, Stage, Task, Verify,
};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

/// How a variant changes a task.
#[derive(Clone, Copy)]
pub(crate) enum VariantChange<'a> {
    /// It replaces and adds sections, under its own name.
    Body(Body<'a>),
    /// It removes a component.
    Without(Name<'a>),
}

/// The sections of one body. A mistake that the body makes by itself is reported when this is made.
pub(crate) struct Sections<'a> {
    /// The sections without a name, by the words that they begin with.
    pub single: BTreeMap<&'a str, Node<'a>>,
    pub constants: Vec<Site<'a, NamedValue<'a>>>,
    pub keypoints: Vec<Site<'a, NamedValue<'a>>>,
    pub components: Vec<Site<'a, Component<'a>>>,
    pub stages: Vec<Site<'a, Stage<'a>>>,
    /// The checks of its own `verify`.
    pub verified: Vec<Site<'a, Check<'a>>>,
    /// The checks outside of `verify`.
    pub checks: Vec<Site<'a, Check<'a>>>,
    pub variants: Vec<Site<'a, VariantChange<'a>>>,
    pub without_components: Vec<Name<'a>>,
    pub without_checks: Vec<Name<'a>>,
    pub without_variants: Vec<Name<'a>>,
    /// What it adds to inherited stages.
    pub added_sayings: Vec<(AddedSay<'a>, Name<'a>)>,
    /// The proof of an error in it, if it has one.
    pub fault: Result<(), Reported>,
}

impl<'a> Sections<'a> {
    pub fn of(body: Body<'a>, report: &mut Report) -> Sections<'a> {
        let mut single = BTreeMap::new();
        let mut fault = Ok(());
        for (word, node) in self::single(body) {
            let first: Node<'a> = *single.entry(word).or_insert(node);
            if first.span() != node.span() {
                let diagnostic = repeated(word, first.head_span(), node.head_span());
                fault = Err(report.error(diagnostic));
            }
        }
        let named = |it: NamedValue<'a>| Site::new(it.name(), it);
        let check = |it: Check<'a>| Site::new(it.name(), it);
        let keypoints = body.keypoints().next();
        let keypoints = keypoints.into_iter().flat_map(|block| block.list());
        let verify = single.get("verify").and_then(|node| Verify::cast(*node));
        let verified = verify.into_iter().flat_map(|verify| verify.checks());
        let overriding = body.override_checks().map(check);
        let overriding = overriding.map(|site| site.overriding(Declares::Override));
        let component = |it: Component<'a>| Site::new(it.name(), it).overriding(it.declares());
        let task = Task::cast(body.node());
        let added = body.added_sayings();
        let added = added.flat_map(|line| line.parts().map(move |part| (line, part)));
        let components = body.components().map(component);
        let stages = body.stages().map(|it| Site::new(it.name(), it));
        let variants = task.map(variants).unwrap_or_default();
        let without_variants = task.into_iter().flat_map(Task::without_variants);
        let mut own = Own { report, fault };
        Sections {
            single,
            constants: own.distinct("constant", body.constants().map(named)),
            keypoints: own.distinct("keypoint", keypoints.map(named)),
            components: own.distinct("component", components),
            stages: own.distinct("stage", stages),
            verified: own.distinct("check", verified.map(check)),
            checks: own.distinct("check", body.checks().map(check).chain(overriding)),
            variants: own.distinct("variant", variants),
            without_components: own.left_out(body.without()),
            without_checks: own.left_out(body.without_checks()),
            without_variants: own.left_out(without_variants),
            added_sayings: added.collect(),
            fault: own.fault,
        }
    }
}

/// Reports what a body states or leaves out twice.
struct Own<'r> {
    report: &'r mut Report,
    fault: Result<(), Reported>,
}

impl Own<'_> {
    /// Returns the first part of each name.
    fn distinct<'a, T>(
        &mut self,
        kind: &str,
        sites: impl IntoIterator<Item = Site<'a, T>>,
    ) -> Vec<Site<'a, T>> {
        let mut sites: Vec<Site<'a, T>> = sites.into_iter().collect();
        let names = sites.iter().map(|site| (site.name.as_ref(), site.span));
        let unique = duplicates(names, self.report, |name, first, again| {
            declared_twice(kind, name, first, again)
        });
        self.fault = self.fault.and(unique);
        let mut seen = BTreeSet::new();
        sites.retain(|site| seen.insert(site.name.clone()));
        sites
    }

    fn left_out<'a>(&mut self, names: impl Iterator<Item = Name<'a>>) -> Vec<Name<'a>> {
        let names: Vec<Name<'a>> = names.collect();
        let all = names.iter().map(|name| (name.text(), name.span()));
        let unique = duplicates(all, self.report, |name, first, again| {
            let message = format!("`{name}` is left out twice");
            Diagnostic::new(Code::Repeated, again, message).also(first, "left out here first")
        });
        self.fault = self.fault.and(unique);
        names
    }
}

/// Returns the sections without a name, each with the word that it begins with.
fn single(body: Body<'_>) -> impl Iterator<Item = (&str, Node<'_>)> {
    let sections = body.node().children().filter_map(|section| {
        let mut words = { section.text() }.split(|letter: char| !letter.is_ascii_alphabetic());
        Some((words.next()?, section))
    });
    sections.filter(|(word, _)| {
        inheritance(word) == Inheritance::Whole || ["about", "keypoints"].contains(word)
    })
}

/// Returns the variants that a task declares, and one without each component that it ablates.
fn variants(task: Task<'_>) -> Vec<Site<'_, VariantChange<'_>>> {
    let declared = task.variants();
    let declared = declared.map(|it| Site::new(it.name(), VariantChange::Body(it.body())));
    let ablated = task.ablated().map(|name| Site {
        name: Cow::Owned(format!("without_{}", name.text())),
        ..Site::new(name, VariantChange::Without(name))
    });
    declared.chain(ablated).collect()
}
