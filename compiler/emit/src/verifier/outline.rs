//! The content of a verifier, with its expressions in one language.

use super::dialect::Dialect;
use super::expression::Lowering;
use super::fields::{Field, fields};
use super::helpers::{HELPERS, Helper, with_dependencies};
use super::layout::Code;
use super::names;
use crate::error::EmitError;
use fab_program::{Check, Choices, Program};
use std::collections::BTreeSet;

/// A verifier, with expressions in one language but not yet laid out as a module.
pub(super) struct Outline<'p> {
    pub program: &'p Program,
    pub fields: Vec<Field<'p>>,
    /// Whether each field is one of the offered values.
    pub offered: Code,
    pub checks: Vec<CheckOutline<'p>>,
    /// Names of the helper functions that the code calls.
    pub helpers: BTreeSet<&'static str>,
}

/// One check.
pub(super) struct CheckOutline<'p> {
    pub check: &'p Check,
    /// The function that runs it.
    pub function: String,
    pub when: Option<Code>,
    pub holds: Code,
}

impl<'p> Outline<'p> {
    /// Returns the texts of the helper functions that the code calls.
    pub fn called(&self, text: fn(&Helper) -> &'static str) -> Vec<&'static str> {
        let called = HELPERS
            .iter()
            .filter(|helper| self.helpers.contains(helper.name));
        called.map(text).filter(|text| !text.is_empty()).collect()
    }

    pub fn of(program: &'p Program, dialect: &'static Dialect) -> Result<Outline<'p>, EmitError> {
        let fields = fields(program, dialect)?;
        let mut lowering = Lowering {
            dialect,
            fields: &fields,
            helpers: BTreeSet::new(),
        };
        let offered = lowering.offered();
        let functions = names::identifiers(
            program
                .verify
                .checks
                .iter()
                .map(|check| format!("check_{}", check.name)),
        );
        let mut checks = Vec::with_capacity(functions.len());
        for (check, function) in program.verify.checks.iter().zip(functions) {
            checks.push(CheckOutline {
                check,
                function,
                when: check
                    .when
                    .as_ref()
                    .map(|when| lowering.condition(when))
                    .transpose()?,
                holds: lowering.condition(&check.holds)?,
            });
        }
        let helpers = with_dependencies(lowering.helpers);
        Ok(Outline {
            program,
            fields,
            offered,
            checks,
            helpers,
        })
    }

    /// Returns whether a check is run when the task's `then without` applies.
    pub fn is_kept(&self, check: &Check) -> bool {
        !self.program.verify.relaxed.contains(&check.name)
    }

    /// Names the checks that are removed when the task's `then without` applies.
    pub fn left_out(&self, escaped: impl Fn(&str) -> String) -> String {
        let names: Vec<String> = self
            .checks
            .iter()
            .filter(|it| !self.is_kept(it.check))
            .map(|it| format!("`{}`", escaped(&it.check.name)))
            .collect();
        if names.is_empty() {
            "this task leaves out none".to_owned()
        } else {
            format!("without {}", names.join(", "))
        }
    }

    /// Writes example values of an action.
    pub fn example(&self, between: &str) -> String {
        let values: Vec<String> = self
            .fields
            .iter()
            .map(|field| format!("{}{between}{}", field.identifier, field.example))
            .collect();
        values.join(", ")
    }

    /// Returns the fields that are directions, which the previous action must provide.
    pub fn directions(&self) -> impl Iterator<Item = &Field<'p>> {
        let is_direction =
            |field: &&Field<'p>| matches!(field.declared.choices, Choices::Directions { .. });
        self.fields.iter().filter(is_direction)
    }
}
