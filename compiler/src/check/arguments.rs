//! Binds the arguments of a call to the parameters of its row.
//!
//! In: a call, and the rows of its name. Out: the row that fits best, and each parameter with its expression.
//! Reading the expressions is left to [`super::expressions`].

use super::context::{Context, Result};
use crate::diag::{Code, Diagnostic, among, every};
use fab_grammar::Span;
use fab_grammar::ast::{Argument, Call, Expr, Name};
use fab_program::vocabulary::{Arg, Place, Signature};
use std::collections::BTreeMap;

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
    let places = signature.args.iter();
    let mut places = places.flat_map(|arg| {
        let most = match arg.place {
            Place::Named => 0,
            Place::Positional => 1,
            Place::Rest => usize::MAX,
        };
        std::iter::repeat_n(arg, most)
    });
    let mut seen: BTreeMap<&str, Span> = BTreeMap::new();
    // A wrong label is probably a misspelt one, so missing arguments are not reported too.
    let bound = every(call.arguments().map(|argument| {
        let arg = match argument.label() {
            Some(label) => parameter(signature, label.text())
                .ok_or_else(|| unknown_label(call.name(), label, signature, form)),
            None => {
                { places.next() }.ok_or_else(|| surplus(call.name(), argument, signature, form))
            }
        };
        let arg = arg.map_err(|diagnostic| context.error(diagnostic))?;
        let value = argument.value();
        if let Some(first) = seen.insert(arg.name, value.span())
            && arg.place != Place::Rest
        {
            let label = argument.label().map(|label| label.span());
            let message = format!("`{}` is given twice", arg.name);
            let span = label.unwrap_or(value.span());
            let diagnostic = Diagnostic::new(Code::WrongArguments, span, message);
            return Err(context.error(diagnostic.also(first, "given here first")));
        }
        Ok((arg, value))
    }))?;
    let is_given = |arg: &Arg| bound.iter().any(|(given, _)| given.name == arg.name);
    let missing = signature.args.iter().filter(|arg| arg.default.is_none());
    let missing: Vec<&Arg> = missing.filter(|arg| !is_given(arg)).collect();
    if let [first, ..] = missing.as_slice() {
        let lacks = among(missing.iter().map(|arg| arg.name)).replace(" or ", " and ");
        let message = format!("`{}` lacks {lacks}", signature.name);
        let diagnostic = Diagnostic::new(Code::WrongArguments, call.name().span(), message)
            .help(format!("write `{}`", form(signature)));
        return Err(context.error(match first.kind.words() {
            Some(words) => {
                let words = among(words.iter().map(|word| word.name));
                diagnostic.help(format!("{} is {words}", first.name.to_uppercase()))
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
    let (call, span) = (call.text(), argument.value().span());
    let places = signature.args.iter();
    let places = places.filter(|arg| arg.place == Place::Positional);
    let message = match places.count() {
        0 => format!("`{call}` takes its arguments by name"),
        1 => format!("`{call}` takes one argument without a name"),
        n_places => format!("`{call}` takes {n_places} arguments without a name"),
    };
    let diagnostic = Diagnostic::new(Code::WrongArguments, span, message)
        .help(format!("write `{}`", form(signature)));
    match argument.value() {
        // `2,5`
        Expr::Quantity(_) => diagnostic.help("the decimal separator is a point, not a comma"),
        _ => diagnostic,
    }
}
