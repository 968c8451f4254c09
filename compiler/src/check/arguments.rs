//! Arguments of a call: which there are, which are given.

use super::Context;
use crate::ast::{Argument, Expr, ExprKind, Ident};
use crate::diag::{Code, Diagnostic, among, nearest};
use crate::source::Span;

/// One argument that a call takes.
pub(crate) struct Parameter {
    pub name: &'static str,
    pub given: Given,
    pub need: Need,
}

/// How an argument is given.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Given {
    /// By its place: `grid(55, 44)`.
    Bare,
    /// By its name: `image: 224px`.
    Named,
    /// One or more, all that have no name.
    Rest,
}

/// Whether an argument must be given.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Need {
    Required,
    Optional,
}

pub(crate) const fn bare(name: &'static str) -> Parameter {
    Parameter {
        name,
        given: Given::Bare,
        need: Need::Required,
    }
}

pub(crate) const fn named(name: &'static str) -> Parameter {
    Parameter {
        name,
        given: Given::Named,
        need: Need::Required,
    }
}

pub(crate) const fn rest(name: &'static str) -> Parameter {
    Parameter {
        name,
        given: Given::Rest,
        need: Need::Required,
    }
}

pub(crate) const fn optional(name: &'static str) -> Parameter {
    Parameter {
        name,
        given: Given::Named,
        need: Need::Optional,
    }
}

/// The arguments of one call, by the parameters' names.
pub(crate) struct Bound<'e> {
    values: Vec<(&'static str, &'e Expr)>,
    rest: Vec<&'e Expr>,
}

impl<'e> Bound<'e> {
    /// Returns the arguments without a name, where the call takes any number of them.
    pub fn rest(&self) -> &[&'e Expr] {
        &self.rest
    }

    pub fn get(&self, name: &str) -> Option<&'e Expr> {
        self.values
            .iter()
            .find(|(known, _)| *known == name)
            .map(|(_, value)| *value)
    }
}

/// Gives each argument to its parameter; None, with a report, where they do not fit.
pub(crate) fn bind<'e>(
    call: &Ident,
    arguments: &'e [Argument],
    parameters: &[Parameter],
    context: &mut Context<'_>,
) -> Option<Bound<'e>> {
    let mut bound = Bound {
        values: Vec::new(),
        rest: Vec::new(),
    };
    let rest = parameters
        .iter()
        .find(|parameter| parameter.given == Given::Rest);
    let mut places = parameters
        .iter()
        .filter(|parameter| parameter.given == Given::Bare);
    let mut fits = true;
    for argument in arguments {
        if let (None, Some(rest)) = (&argument.label, rest) {
            bound.rest.push(&argument.value);
            if bound.rest.len() == 1 {
                bound.values.push((rest.name, &argument.value));
            }
            continue;
        }
        let parameter = match &argument.label {
            None => places
                .next()
                .ok_or_else(|| Box::new(surplus(call, argument, parameters, context))),
            Some(label) => named_parameter(call, label, parameters),
        };
        let parameter = match parameter {
            Ok(parameter) => parameter,
            Err(diagnostic) => {
                context.push(*diagnostic);
                fits = false;
                continue;
            }
        };
        if let Some(first) = bound.get(parameter.name) {
            let span = argument
                .label
                .as_ref()
                .map_or(argument.value.span, |label| label.span);
            let message = format!("`{}` is given twice", parameter.name);
            context.push(
                Diagnostic::new(Code::WrongArguments, span, message)
                    .also(first.span, "given here first"),
            );
            fits = false;
        } else {
            bound.values.push((parameter.name, &argument.value));
        }
    }
    let missing: Vec<&str> = parameters
        .iter()
        .filter(|parameter| parameter.need == Need::Required && bound.get(parameter.name).is_none())
        .map(|parameter| parameter.name)
        .collect();
    // A wrong name probably stands for a missing one; one report is enough.
    if !missing.is_empty() && fits {
        let message = format!(
            "`{}` lacks {}",
            call.text,
            among(missing).replace(" or ", " and ")
        );
        context.push(
            Diagnostic::new(Code::WrongArguments, call.span, message)
                .help(format!("write `{}`", form(call, parameters))),
        );
        fits = false;
    }
    fits.then_some(bound)
}

fn named_parameter<'p>(
    call: &Ident,
    label: &Ident,
    parameters: &'p [Parameter],
) -> Result<&'p Parameter, Box<Diagnostic>> {
    let named = || {
        parameters
            .iter()
            .filter(|parameter| parameter.given == Given::Named)
    };
    if let Some(parameter) = named().find(|parameter| parameter.name == label.text) {
        return Ok(parameter);
    }
    let diagnostic = Diagnostic::new(
        Code::WrongArguments,
        label.span,
        format!("`{}` takes no `{}`", call.text, label.text),
    );
    let near = nearest(&label.text, named().map(|parameter| parameter.name));
    Err(Box::new(match near {
        Some(meant) => diagnostic.meant(label.span, meant),
        None => diagnostic.help(format!("write `{}`", form(call, parameters))),
    }))
}

fn surplus(
    call: &Ident,
    argument: &Argument,
    parameters: &[Parameter],
    context: &Context<'_>,
) -> Diagnostic {
    let span = argument.value.span;
    let before = &context.loaded.sources.get(span.file).text[..span.start];
    let is_number = matches!(argument.value.kind, ExprKind::Quantity { .. });
    if let Some(whole) = before.strip_suffix(',')
        && is_number
        && whole.ends_with(|last: char| last.is_ascii_digit())
    {
        let comma = Span {
            start: span.start - 1,
            end: span.start,
            ..span
        };
        let message = "decimals stand behind a point, not a comma";
        return Diagnostic::new(Code::WrongArguments, comma, message)
            .help("write `.`, or a blank behind the comma if these are two numbers");
    }
    let n_bare = parameters
        .iter()
        .filter(|parameter| parameter.given == Given::Bare)
        .count();
    let message = match n_bare {
        0 => format!("`{}` takes its arguments by name", call.text),
        1 => format!("`{}` takes one argument without a name", call.text),
        _ => format!("`{}` takes {n_bare} arguments without a name", call.text),
    };
    Diagnostic::new(Code::WrongArguments, argument.value.span, message)
        .help(format!("write `{}`", form(call, parameters)))
}

/// Writes how the call looks when it is complete.
fn form(call: &Ident, parameters: &[Parameter]) -> String {
    let part = |parameter: &Parameter| match (parameter.given, parameter.need) {
        (Given::Bare, _) => parameter.name.to_uppercase(),
        (Given::Rest, _) => format!("{}, …", parameter.name.to_uppercase()),
        (Given::Named, Need::Required) => format!("{}: …", parameter.name),
        (Given::Named, Need::Optional) => format!("[{}: …]", parameter.name),
    };
    format!(
        "{}({})",
        call.text,
        parameters.iter().map(part).collect::<Vec<_>>().join(", ")
    )
}
