//! Folds between points of the cloth: `corner(back_left) -> center at 0.9`.

use super::Context;
use super::arguments::{Bound, bare, bind};
use super::quantity::{Measure, Wanted, read};
use crate::ast::{Experts, Expr, ExprKind, Folds, Ident, Move};
use crate::diag::{Code, Diagnostic, among, nearest};
use crate::merge::Merged;
use fab_program::{ClothPoint, Fold, Sequence, Subgoals};

/// The corners: name, fraction from the left, fraction from the back.
const CORNERS: &[(&str, f64, f64)] = &[
    ("back_left", 0.0, 0.0),
    ("back_right", 1.0, 0.0),
    ("front_left", 0.0, 1.0),
    ("front_right", 1.0, 1.0),
];

/// The middles of the sides.
const MIDDLES: &[(&str, f64, f64)] = &[
    ("left", 0.0, 0.5),
    ("right", 1.0, 0.5),
    ("back", 0.5, 0.0),
    ("front", 0.5, 1.0),
];

const FRACTION: Wanted = Wanted {
    measure: Measure::Number,
    range: f64::MIN_POSITIVE..=1.0,
    range_words: "a fraction above `0` and at most `1`",
};

const PLACE: Wanted = Wanted {
    measure: Measure::Number,
    range: 0.0..=1.0,
    range_words: "a fraction from `0` to `1`",
};

/// The most folds in a sequence.
const MAX_FOLDS: usize = 100;

/// Builds the folds of one block; what is wrong is left out.
pub(crate) fn check(folds: &Folds, context: &mut Context<'_>) -> Vec<Fold> {
    if folds.moves.is_empty() && !folds.has_faults {
        context.push(
            Diagnostic::new(Code::NoFolds, folds.span, "there is no fold here")
                .help("write one such as `fold corner(back_left) -> corner(front_left)`"),
        );
    }
    if let Some(beyond) = folds.moves.get(MAX_FOLDS) {
        let message = format!(
            "a sequence has at most {MAX_FOLDS} folds, this one has {}",
            folds.moves.len()
        );
        context.push(Diagnostic::new(Code::OutOfRange, beyond.span, message));
        return Vec::new();
    }
    folds
        .moves
        .iter()
        .filter_map(|part| fold(part, context))
        .collect()
}

/// Builds the sequences of a list of experts.
pub(crate) fn experts(experts: &Experts, context: &mut Context<'_>) -> Vec<Sequence> {
    if experts.sequences.is_empty() && !experts.has_faults {
        let message = format!("`{}` has no sequence", experts.name.text);
        context.push(
            Diagnostic::new(Code::NoFolds, experts.name.span, message)
                .help("write one such as `sequence { fold corner(back_left) -> center }`"),
        );
    }
    experts
        .sequences
        .iter()
        .map(|folds| Sequence {
            folds: check(folds, context),
        })
        .collect()
}

/// Returns the sequences that count as right for a task: those of the named experts, else the demonstration.
pub(crate) fn expert_sequences(
    merged: &Merged<'_>,
    subgoals: Option<&Subgoals>,
    context: &mut Context<'_>,
) -> Vec<Sequence> {
    let Some(reference) = merged.experts else {
        return match subgoals {
            Some(Subgoals::Demonstrate { folds }) => vec![Sequence {
                folds: folds.clone(),
            }],
            _ => Vec::new(),
        };
    };
    let seen = || {
        context
            .loaded
            .visible_from(reference.name.span.file)
            .flat_map(|file| &file.experts)
    };
    match context
        .loaded
        .experts(reference.name.span.file, &reference.name.text)
    {
        // The list itself is reported once, where all lists are.
        Some(found) => experts(found, context),
        None => {
            let names: Vec<&str> = seen().map(|experts| experts.name.text.as_str()).collect();
            context.unknown("list of experts", &reference.name, names);
            Vec::new()
        }
    }
}

fn fold(part: &Move, context: &mut Context<'_>) -> Option<Fold> {
    let pick = point(&part.pick, context);
    let place = point(&part.place, context);
    let fraction = match &part.fraction {
        Some(fraction) => read(fraction, &FRACTION, context),
        None => Some(1.0),
    };
    let fold = Fold {
        pick: pick?,
        place: place?,
        fraction: fraction?,
    };
    if fold.pick == fold.place {
        context.push(
            Diagnostic::new(
                Code::FoldGoesNowhere,
                part.span,
                "this fold ends where it begins",
            )
            .label("picks and places the same point"),
        );
        return None;
    }
    Some(fold)
}

/// Builds the point at a fraction of the way from one point of the cloth to another.
fn between(bound: &Bound<'_>, context: &mut Context<'_>) -> Option<ClothPoint> {
    let mut ends = [None, None];
    for (end, name) in ends.iter_mut().zip(["a", "b"]) {
        let expr = bound.get(name)?;
        *end = match point(expr, context) {
            Some(ClothPoint::Particle { right, front }) => Some([right, front]),
            Some(ClothPoint::Center) => {
                context.push(
                    Diagnostic::new(
                        Code::WrongForm,
                        expr.span,
                        "`center` is a point of the table, not of the cloth",
                    )
                    .help("write `point(0.5, 0.5)` for the middle of the cloth"),
                );
                None
            }
            None => None,
        };
    }
    let fraction = read(bound.get("fraction")?, &PLACE, context);
    let ([Some(a), Some(b)], Some(fraction)) = (ends, fraction) else {
        return None;
    };
    let at = |axis: usize| a[axis] + fraction * (b[axis] - a[axis]);
    Some(ClothPoint::Particle {
        right: at(0),
        front: at(1),
    })
}

fn point(expr: &Expr, context: &mut Context<'_>) -> Option<ClothPoint> {
    const FORMS: &str = "write `corner(back_left)`, `middle(left)`, `center`, `point(0.25, 0.5)` or `between(A, B, 0.3)`";
    match &expr.kind {
        ExprKind::Call { name, arguments } if name.text == "point" => {
            let bound = bind(name, arguments, &[bare("right"), bare("front")], context)?;
            let right = read(bound.get("right")?, &PLACE, context);
            let front = read(bound.get("front")?, &PLACE, context);
            return Some(ClothPoint::Particle {
                right: right?,
                front: front?,
            });
        }
        ExprKind::Call { name, arguments } if name.text == "between" => {
            let parameters = [bare("a"), bare("b"), bare("fraction")];
            let bound = bind(name, arguments, &parameters, context)?;
            return between(&bound, context);
        }
        ExprKind::Name(name) if name == "center" => return Some(ClothPoint::Center),
        ExprKind::Call { name, arguments } if matches!(name.text.as_str(), "corner" | "middle") => {
            let places = if name.text == "corner" {
                CORNERS
            } else {
                MIDDLES
            };
            let names = || places.iter().map(|(name, ..)| *name);
            if let [argument] = arguments.as_slice()
                && argument.label.is_none()
                && let ExprKind::Name(place) = &argument.value.kind
            {
                let found = places.iter().find(|(known, ..)| known == place);
                // Back is the picture's top, front its bottom.
                let turned = place.replace("top", "back").replace("bottom", "front");
                if found.is_none() && places.iter().any(|(known, ..)| *known == turned) {
                    let message = format!("there is no {} `{place}`", name.text);
                    context.push(
                        Diagnostic::new(Code::UnknownName, argument.value.span, message)
                            .help(format!(
                                "write `{turned}`: back is the top of the picture, front its bottom"
                            ))
                            .edit(argument.value.span, turned),
                    );
                } else if found.is_none() {
                    let place = Ident {
                        text: place.clone(),
                        span: argument.value.span,
                    };
                    context.unknown(&name.text, &place, names());
                }
                return found.map(|(_, right, front)| ClothPoint::Particle {
                    right: *right,
                    front: *front,
                });
            }
            let message = format!("`{}` takes {}", name.text, among(names()));
            context.push(Diagnostic::new(Code::WrongArguments, expr.span, message));
        }
        ExprKind::Call { name, .. } => {
            let diagnostic = Diagnostic::new(
                Code::WrongForm,
                name.span,
                format!("`{}` is no point of the cloth", name.text),
            );
            context.push(
                match nearest(&name.text, ["corner", "middle", "point", "between"]) {
                    Some(meant) => diagnostic.meant(name.span, meant),
                    None => diagnostic.help(FORMS),
                },
            );
        }
        _ => {
            let found = context.written(expr.span);
            let message = format!("expected a point of the cloth, found `{found}`");
            let diagnostic = Diagnostic::new(Code::WrongForm, expr.span, message);
            context.push(match nearest(&found, ["center"]) {
                Some(meant) => diagnostic.meant(expr.span, meant),
                None => diagnostic.help(FORMS),
            });
        }
    }
    None
}
