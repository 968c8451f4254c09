//! Checks of a task: declared by `verify`, replaced, left out.

use super::lists::{LEAVE_OUT, OVERRIDE};
use super::{Merged, once, unique};
use crate::ast::Body;
use crate::diag::{Code, Diagnostic, Report};
use std::collections::BTreeSet;

impl<'a> Merged<'a> {
    /// Takes the checks of a `verify`, or changes single ones of those that are there.
    pub(super) fn add_checks(&mut self, body: &'a Body, report: &mut Report) {
        if let Some(verify) = once(&body.verify, "`verify`", |part| part.span, report) {
            if let Some(name) = body
                .without_checks
                .iter()
                .chain(body.checks.iter().map(|check| &check.name))
                .next()
            {
                let message = "a `verify` beside it replaces all inherited checks";
                report.push(
                    Diagnostic::new(Code::NothingToOverride, name.span, message)
                        .also(verify.span, "here")
                        .help("state in that `verify` what is to be checked, or drop it"),
                );
            }
            unique(
                verify.checks.iter().map(|check| &check.name),
                "check",
                report,
            );
            self.verify = Some(verify);
            self.checks = Default::default();
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
        for check in &body.checks {
            if self.checks.get(&check.name.text).is_some() {
                self.checks.put(&check.name.text, check);
            } else if !self.is_broken {
                report.push(OVERRIDE.report("check", &check.name, &inherited));
            }
        }
    }

    /// Returns the names of all checks, in their order.
    pub fn check_names(&self) -> impl Iterator<Item = &'a str> {
        self.checks.iter().map(|check| check.name.text.as_str())
    }
}
