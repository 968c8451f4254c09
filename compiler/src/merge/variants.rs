//! Variants of a task: declared ones, and one for each component of an `ablate`.

use super::Merged;
use crate::ast::{Body, Ident, Task};
use crate::diag::{Code, Diagnostic, Report};
use crate::source::Span;

/// The most variants of a task; each is checked as a task of its own.
pub(crate) const MAX_VARIANTS: usize = 64;

/// A variant that can be chosen.
#[derive(Clone)]
pub(crate) struct VariantOf<'a> {
    /// Its name.
    pub name: String,
    /// What it does to the task.
    pub change: Change<'a>,
    /// Where it is declared.
    pub span: Span,
}

/// What a variant does.
#[derive(Clone, Copy)]
pub(crate) enum Change<'a> {
    /// It replaces and adds sections, under a name of its own.
    Body(&'a Body),
    /// It leaves out a component.
    Without(&'a Ident),
}

impl<'a> Merged<'a> {
    /// Adds the variants of one task; a later one of the same name takes the earlier one's place.
    pub(super) fn add_variants(&mut self, task: &'a Task, report: &mut Report) {
        let declared = task.variants.iter().map(|variant| VariantOf {
            name: variant.name.text.clone(),
            change: Change::Body(&variant.body),
            span: variant.name.span,
        });
        let ablated = task.ablated.iter().map(|name| VariantOf {
            name: format!("without_{}", name.text),
            change: Change::Without(name),
            span: name.span,
        });
        let mut own: Vec<VariantOf<'a>> = Vec::new();
        for variant in declared.chain(ablated) {
            if let Some(first) = own.iter().find(|known| known.name == variant.name) {
                let message = format!("the variant `{}` is declared twice", variant.name);
                report.push(
                    Diagnostic::new(Code::DuplicateName, variant.span, message)
                        .also(first.span, "declared here first"),
                );
                continue;
            }
            if own.len() >= MAX_VARIANTS {
                let message = format!("a task has at most {MAX_VARIANTS} variants");
                report.push(Diagnostic::new(Code::OutOfRange, variant.span, message));
                break;
            }
            own.push(variant);
        }
        for variant in own {
            match self
                .variants
                .iter_mut()
                .find(|known| known.name == variant.name)
            {
                Some(known) => *known = variant,
                None => self.variants.push(variant),
            }
        }
    }
}
