//! Checks of a task: declared by `verify`, replaced, left out.

use super::lists::{Indexed, LEAVE_OUT, OVERRIDE};
use super::{Merged, once, unique};
use crate::ast::{Body, Ident, Verify};
use crate::diag::{Code, Diagnostic, Report};
use std::collections::BTreeSet;

impl<'a> Merged<'a> {
    /// Takes the checks of a `verify`, or changes single ones of those that are there.
    pub(super) fn add_checks(&mut self, body: &'a Body, report: &mut Report) {
        if let Some(verify) = once(&body.verify, "`verify`", |part| part.span, report) {
            let changed = body.checks.iter().map(|check| &check.name);
            for name in changed.chain(&body.without_checks) {
                report.push(beside(name, verify));
            }
            unique(
                verify.checks.iter().map(|check| &check.name),
                "check",
                report,
            );
            self.verify = Some(verify);
            self.checks = Indexed::default();
            self.removed_checks.clear();
            for check in &verify.checks {
                self.checks.put(&check.name.text, check);
            }
            return;
        }
        unique(body.checks.iter().map(|check| &check.name), "check", report);
        let inherited: BTreeSet<&str> = self.check_names().collect();
        for name in &body.without_checks {
            if self.checks.remove(&name.text).is_some() {
                self.removed_checks.insert(&name.text);
            } else if !self.is_broken && !self.removed_checks.contains(name.text.as_str()) {
                report.push(LEAVE_OUT.report("check", name, &inherited));
            }
        }
        let left: BTreeSet<&str> = self.check_names().collect();
        for check in &body.checks {
            if left.contains(check.name.text.as_str()) {
                self.checks.put(&check.name.text, check);
            } else if !self.is_broken {
                report.push(OVERRIDE.report("check", &check.name, &left));
            }
        }
    }

    /// Returns the names of all checks, in their order.
    pub fn check_names(&self) -> impl Iterator<Item = &'a str> {
        self.checks.iter().map(|check| check.name.text.as_str())
    }
}

/// Says that a single check is not changed where all of them are stated anew.
fn beside(name: &Ident, verify: &Verify) -> Diagnostic {
    let message = format!(
        "`{}` is no inherited check any more: the `verify` beside it states all checks anew",
        name.text
    );
    Diagnostic::new(Code::Repeated, name.span, message)
        .also(verify.span, "stated here")
        .help("change the check in that `verify`, and drop this line")
}
