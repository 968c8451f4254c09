//! Components of a task: added, replaced, left out.

use super::lists::{LEAVE_OUT, OVERRIDE};
use super::{Merged, unique};
use crate::ast::{Body, Declares, Ident};
use crate::diag::{Code, Diagnostic, Report};
use std::collections::BTreeSet;

impl<'a> Merged<'a> {
    /// Leaves a component out; an error where there is none.
    pub(super) fn leave_out(&mut self, name: &'a Ident, report: &mut Report) {
        if self.components.remove(&name.text).is_some() {
            self.removed.insert(&name.text);
        } else if !self.is_broken && !self.removed.contains(name.text.as_str()) {
            let inherited = self.component_names();
            report.push(LEAVE_OUT.report("component", name, &inherited));
        }
    }

    fn component_names(&self) -> BTreeSet<&'a str> {
        self.components
            .iter()
            .map(|component| component.name.text.as_str())
            .collect()
    }

    /// Adds and replaces components.
    pub(super) fn add_components(&mut self, body: &'a Body, report: &mut Report) {
        unique(
            body.components.iter().map(|component| &component.name),
            "component",
            report,
        );
        let inherited = self.component_names();
        for name in &body.without {
            self.leave_out(name, report);
        }
        for component in &body.components {
            let name = &component.name;
            let is_inherited = inherited.contains(name.text.as_str())
                && !self.removed.contains(name.text.as_str());
            match component.declares {
                Declares::New if is_inherited => {
                    let before = self.components.get(&name.text);
                    let message =
                        format!("`{}` replaces a component of an extended task", name.text);
                    let mut diagnostic =
                        Diagnostic::new(Code::NotMarkedAsOverride, name.span, message)
                            .help("write `override component` to replace its text");
                    if let Some(before) = before {
                        diagnostic = diagnostic.also(before.name.span, "declared here");
                    }
                    report.push(diagnostic);
                }
                Declares::Override if !is_inherited && !self.is_broken => {
                    report.push(OVERRIDE.report("component", name, &inherited));
                    continue;
                }
                Declares::New | Declares::Override => {}
            }
            self.removed.remove(name.text.as_str());
            self.components.put(&name.text, component);
        }
    }
}
