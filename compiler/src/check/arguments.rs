//! Binds the arguments of a call to the parameters of its row.
//!
//! In: a call, and the rows of its name. Out: the row that fits best, and each parameter with its expression.
//! Reading the expressions is left to [`super::expressions`].

use super::context::{Context, Result};
use crate::diag::{Code, Diagnostic, among};
use fab_grammar::ast::{Argument, Call, Expr, Name};
use fab_program::vocabulary::{Arg, Place, Signature};

/// The most arguments of a call that takes any number of them.
const MAX_ARGUMENTS: usize = 1000;

/// The parameters of a call with the expressions given for them; [`Place::Rest`] may appear several times.
pub(crate) type Bound<'a> = Vec<(&'static Arg, Expr<'a>)>;

/// Returns the row that fits a call best: of the rows with its name, the one that has the most of its labels.
pub(crate) fn form<'s>(
    call: Call<'_>,
    rows: impl Iterator<Item = &'s Signature>,
) -> Option<(usize, &'s Signature)> {
    let n_given = call.arguments().count();
    let labels = || call.arguments().filter_map(|argument| argument.label());
    let fit = |signature: &Signature| {
        let is_known = |label: &Name<'_>| parameter(signature, label.text()).is_some();
        let takes_labels = signature.args.iter().any(|arg| arg.place == Place::Named);
        (
            labels().filter(is_known).count(),
            labels().next().is_some() && takes_labels,
            n_given == 0 && signature.args.is_empty(),
        )
    };
    let named = rows
        .enumerate()
        .filter(|(_, row)| row.name == call.name().text());
    // Of equally good rows, take the first; `max_by_key` would return the last.
    named.fold(None, |best, (index, row)| match best {
        Some((_, before)) if fit(before) >= fit(row) => best,
        _ => Some((index, row)),
    })
}

fn parameter(signature: &Signature, label: &str) -> Option<&'static Arg> {
    let mut named = signature
        .args
        .iter()
        .filter(|arg| arg.place == Place::Named);
    named.find(|arg| arg.name == label)
}

/// Binds each argument to its parameter, and reports every argument that fits none.
///
/// - `form`: how a call is written, for advice.
pub(crate) fn bind<'a>(
    call: Call<'a>,
    signature: &Signature,
    form: fn(&Signature) -> String,
    context: &mut Context<'_>,
) -> Result<Bound<'a>> {
    let mut bound: Bound<'a> = Vec::with_capacity(signature.args.len());
    let mut places = signature
        .args
        .iter()
        .filter(|arg| arg.place != Place::Named);
    let mut place = places.next();
    let mut fits = Ok(());
    for argument in call.arguments() {
        let arg = match argument.label() {
            Some(label) => parameter(signature, label.text())
                .ok_or_else(|| unknown_label(call.name(), label, signature, form)),
            None => match place {
                Some(arg) => {
                    if arg.place == Place::Positional {
                        place = places.next();
                    }
                    Ok(arg)
                }
                None => Err(surplus(call.name(), argument, signature, form)),
            },
        };
        let arg = match arg {
            Ok(arg) => arg,
            Err(diagnostic) => {
                fits = Err(context.error(diagnostic));
                continue;
            }
        };
        let first = bound.iter().find(|(given, _)| given.name == arg.name);
        match first {
            Some((_, first)) if arg.place != Place::Rest => {
                let span = argument
                    .label()
                    .map_or(argument.value().span(), |label| label.span());
                let message = format!("`{}` is given twice", arg.name);
                let diagnostic = Diagnostic::new(Code::WrongArguments, span, message);
                fits = Err(context.error(diagnostic.also(first.span(), "given here first")));
            }
            _ => bound.push((arg, argument.value())),
        }
        if bound.len() > MAX_ARGUMENTS {
            let span = argument.value().span();
            let message = format!("a call takes at most {MAX_ARGUMENTS} arguments");
            return Err(context.fault(Code::OutOfRange, span, message));
        }
    }
    // A wrong label is probably a misspelt one, so missing arguments are not reported too.
    fits?;
    let is_given = |arg: &Arg| bound.iter().any(|(given, _)| given.name == arg.name);
    let missing = signature
        .args
        .iter()
        .filter(|arg| arg.default.is_none() && !is_given(arg));
    let missing: Vec<&str> = missing.map(|arg| arg.name).collect();
    if !missing.is_empty() {
        let lacks = among(missing.iter().copied()).replace(" or ", " and ");
        let message = format!("`{}` lacks {lacks}", signature.name);
        let diagnostic = Diagnostic::new(Code::WrongArguments, call.name().span(), message)
            .help(format!("write `{}`", form(signature)));
        let mut args = signature.args.iter();
        let first = args.find(|arg| missing.contains(&arg.name));
        let words = first.and_then(|arg| Some((arg.name, arg.kind.words()?)));
        return Err(context.error(match words {
            Some((name, words)) => {
                let words = among(words.iter().map(|word| word.name));
                diagnostic.help(format!("{} is {words}", name.to_uppercase()))
            }
            None => diagnostic,
        }));
    }
    for (arg, value) in &bound {
        needs_partner(arg, *value, &bound, context)?;
    }
    Ok(bound)
}

/// Reports an argument whose required partner is missing.
fn needs_partner(
    arg: &Arg,
    value: Expr<'_>,
    bound: &Bound<'_>,
    context: &mut Context<'_>,
) -> Result<()> {
    let Some(needs) = arg.needs else {
        return Ok(());
    };
    let other = bound.iter().find(|(given, _)| given.name == needs.arg);
    let is_there = match other {
        None => false,
        Some((_, Expr::Name(word))) if !needs.words.is_empty() => {
            needs.words.contains(&word.text())
        }
        Some(_) => true,
    };
    if is_there {
        return Ok(());
    }
    let partner = match needs.words.first() {
        None => format!("{}: …", needs.arg),
        Some(word) => format!("{}: {word}", needs.arg),
    };
    let message = format!("`{}` has no effect without `{partner}`", arg.name);
    let help = format!("add `{partner}`, or remove `{}`", arg.name);
    Err(context.refuse(Code::WrongArguments, value.span(), message, help))
}

fn unknown_label(
    call: Name<'_>,
    label: Name<'_>,
    signature: &Signature,
    form: fn(&Signature) -> String,
) -> Diagnostic {
    let message = format!("`{}` takes no `{}`", call.text(), label.text());
    let named = signature.args.iter();
    let named = named.filter(|arg| arg.place == Place::Named);
    let form = format!("write `{}`", form(signature));
    Diagnostic::new(Code::WrongArguments, label.span(), message).suggest(
        label.text(),
        named.map(|arg| arg.name),
        &form,
    )
}

fn surplus(
    call: Name<'_>,
    argument: Argument<'_>,
    signature: &Signature,
    form: fn(&Signature) -> String,
) -> Diagnostic {
    let span = argument.value().span();
    let places = signature
        .args
        .iter()
        .filter(|arg| arg.place == Place::Positional);
    let message = match places.count() {
        0 => format!("`{}` takes its arguments by name", call.text()),
        1 => format!("`{}` takes one argument without a name", call.text()),
        n_places => format!(
            "`{}` takes {n_places} arguments without a name",
            call.text()
        ),
    };
    let diagnostic = Diagnostic::new(Code::WrongArguments, span, message)
        .help(format!("write `{}`", form(signature)));
    match argument.value() {
        // `2,5`
        Expr::Quantity(_) => diagnostic.help("the decimal separator is a point, not a comma"),
        _ => diagnostic,
    }
}
