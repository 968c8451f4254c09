//! `verifier.rs` and `verifier.py`: the checks of a program as code in two languages.
//!
//! [`fab_program::verify`] and [`fab_program::eval`] define their meaning. The code does the same additions,
//! multiplications and comparisons in the same order, evaluates the parts of a condition until the result is certain,
//! and finds the same keypoints missing. There is one difference: a direction of the previous action that was not
//! offered counts as missing here, because turning it into a vector would need trigonometry.
//!
//! Each language has a template for the module, a file of functions that is appended to it, and a [`Dialect`] for what
//! it writes differently within an expression.

mod dialect;
mod expression;
mod fields;
mod names;

use crate::error::EmitError;
use dialect::Dialect;
pub(crate) use dialect::{PYTHON, RUST};
use expression::{Lowering, formula};
use fab_program::measures::{MEASURES, Make};
use fab_program::vocabulary::Signature;
use fab_program::{Choices, Program};
use fields::{Field, fields};
use minijinja::syntax::SyntaxConfig;
use minijinja::value::Serde;
use minijinja::{AutoEscape, Environment, UndefinedBehavior};
use serde::Serialize;

/// What a template writes.
#[derive(Serialize)]
struct Module<'p> {
    title: String,
    compiler: String,
    hash: String,
    fields: Vec<Field<'p>>,
    /// Whether a field is a word.
    has_words: bool,
    /// Whether each field is one of the offered values.
    offered: String,
    checks: Vec<Check>,
    measures: Vec<Measure>,
    /// The functions that the checks call.
    support: &'static str,
}

/// One check.
#[derive(Serialize)]
struct Check {
    name: String,
    /// The function that runs it.
    function: String,
    /// Whether it is run when the task's `then without` applies.
    is_kept: bool,
    when: Option<String>,
    holds: String,
}

/// A length between points.
#[derive(Serialize)]
struct Measure {
    name: &'static str,
    doc: &'static str,
    points: Vec<String>,
    /// Its square.
    square: String,
}

/// Writes the verifier of a program in a language.
pub(super) fn emit(program: &Program, dialect: &'static Dialect) -> Result<String, EmitError> {
    let fields = fields(program, dialect)?;
    let lowering = Lowering {
        dialect,
        fields: &fields,
    };
    let checks = &program.verify.checks;
    let functions = names::identifiers(checks.iter().map(|it| format!("check_{}", it.name)));
    let check = |(check, function): (&fab_program::Check, String)| {
        let when = check.when.as_ref();
        Ok(Check {
            name: (dialect.escaped)(&check.name),
            function,
            is_kept: !program.verify.relaxed.contains(&check.name),
            when: when.map(|when| lowering.condition(when)).transpose()?,
            holds: lowering.condition(&check.holds)?,
        })
    };
    let module = Module {
        title: (dialect.escaped)(&program.title()),
        compiler: (dialect.escaped)(&program.compiler),
        hash: program.hash(),
        has_words: fields
            .iter()
            .any(|it| matches!(it.declared.choices, Choices::Words { .. })),
        offered: lowering.offered(),
        checks: checks
            .iter()
            .zip(functions)
            .map(check)
            .collect::<Result<_, _>>()?,
        measures: measures(),
        support: without_header(dialect.support),
        fields,
    };
    Ok(render(dialect.template, &module))
}

/// Writes each length between points that a condition can name.
fn measures() -> Vec<Measure> {
    let lengths = MEASURES.iter().filter_map(|row| match row.make {
        Make::Length(square) => Some((&row.signature, square)),
        Make::Point(_) | Make::Other(_) => None,
    });
    let measure = |(signature, square): (&Signature, _)| {
        let points = names::identifiers(signature.args.iter().map(|arg| arg.name.to_owned()));
        Measure {
            name: signature.name,
            doc: signature.doc,
            square: formula(square, &points),
            points,
        }
    };
    lengths.map(measure).collect()
}

/// Returns a file's text below the comment that says what the file is for.
fn without_header(text: &'static str) -> &'static str {
    text.split_once("\n\n").map_or(text, |(_, below)| below)
}

fn render(template: &str, module: &Module<'_>) -> String {
    // A line that holds only tags leaves no trace.
    let syntax = SyntaxConfig::builder()
        .trim_blocks(true)
        .lstrip_blocks(true)
        .build();
    let mut environment = Environment::new();
    environment.set_syntax(syntax.expect("the usual delimiters differ from each other"));
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    environment.set_auto_escape_callback(|_| AutoEscape::None);
    environment
        .render_str(template, Serde(module))
        .expect("a module has everything that the templates write")
}
