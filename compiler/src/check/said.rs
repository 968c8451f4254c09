//! What the stages of a task say, all in all: components that none says, layers that none names.

use super::Context;
use super::stages::Builder;
use super::templates::{self, Place, Scope};
use super::{conditions, uses};
use crate::ast::{Component, Expr};
use crate::diag::{Code, Diagnostic};
use fab_program::Condition;
use fab_program::Depends;
use std::collections::BTreeSet;

impl Builder<'_, '_> {
    /// Warns of components of this task itself that no stage says, and checks their names all the same.
    pub(super) fn unsaid(&mut self, context: &mut Context<'_>) {
        for component in self.merged.components.iter() {
            let Component { name, text, .. } = component;
            if self.said.contains(name.text.as_str()) {
                continue;
            }
            let when = component
                .when
                .as_ref()
                .and_then(|expr| guard(expr, context));
            let scope = Scope {
                place: Place::Nowhere,
                has_last: true,
                guarded: "",
            };
            templates::template(&name.text, text, when, scope, context);
            let is_own = name.span.file == self.merged.task.name.span.file
                && self.merged.is_own_component(name.span);
            if is_own && !self.merged.stages.is_empty() && !self.merged.is_broken {
                let message = format!("the component `{}` is said nowhere", name.text);
                context.push(
                    Diagnostic::new(Code::SaidNowhere, name.span, message)
                        .help("name it in a stage's `say` or `system`, or remove it"),
                );
            }
        }
    }

    /// Reports layers that are drawn and not named, or named and not drawn.
    pub(super) fn layers(&self, context: &mut Context<'_>) {
        let mut named = BTreeSet::new();
        for spoken in &self.spoken {
            for (layer, span) in &spoken.layers {
                named.insert(layer.as_str());
                if !spoken.shows_layers {
                    let message = format!("no picture of this stage shows `{layer}`");
                    context.push(
                        Diagnostic::new(Code::LayerNotShown, *span, message)
                            .help("write `show scene with annotations` in the stage"),
                    );
                }
            }
        }
        let Some(part) = self
            .merged
            .annotate
            .filter(|_| !self.merged.stages.is_empty())
        else {
            return;
        };
        // What a variant leaves out is not the author's slip.
        if self.merged.variant.is_some() || self.merged.has_faults {
            return;
        }
        let all: Vec<String> = context
            .layers
            .iter()
            .map(|layer| layer.name.clone())
            .collect();
        for layer in &part.list {
            let name = layer.name.text.as_str();
            if all.iter().any(|known| known == name) && !named.contains(name) {
                let message = format!("the layer `{name}` is drawn and no prompt says what it is");
                context.push(
                    Diagnostic::new(Code::LayerNotNamed, layer.name.span, message).help(format!(
                        "write `{{{{ {name} }}}}` in a text of the stage that shows it"
                    )),
                );
            }
        }
    }
}

/// Builds the condition under which a component is said.
pub(super) fn guard(expr: &Expr, context: &mut Context<'_>) -> Option<Condition> {
    let when = conditions::check(expr, context)?;
    let uses = when.uses();
    if uses.action {
        uses::needs_action(expr.span, context);
        return None;
    }
    if uses.last && !when.implies_last() {
        uses::needs_last(expr.span, "… when last and …", context);
        return None;
    }
    Some(when)
}
