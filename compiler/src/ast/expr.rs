//! Expressions: numbers with units, names, calls, comparisons, conditions.

use super::{Ident, Text, text};
use crate::source::{FileId, Span};
use fab_grammar::{Kind, Node};

/// A value or a condition, as written.
#[derive(Clone, Debug)]
pub(crate) struct Expr {
    pub span: Span,
    pub kind: ExprKind,
}

#[derive(Clone, Debug)]
pub(crate) enum ExprKind {
    Quantity {
        value: f64,
        unit: Option<Ident>,
    },
    Name(String),
    /// Names joined by dots.
    Path(String),
    Text(Text),
    /// `(A, B)`.
    Pair(Box<[Expr; 2]>),
    /// `VALUE in UNIT`.
    Converted {
        value: Box<Expr>,
        target: Ident,
    },
    /// `from A to B`.
    Heading {
        from: Box<Expr>,
        to: Box<Expr>,
    },
    /// `A to B`.
    Range {
        low: Box<Expr>,
        high: Box<Expr>,
    },
    Call {
        name: Ident,
        arguments: Vec<Argument>,
    },
    Compare {
        left: Box<Expr>,
        sign: Ident,
        right: Box<Expr>,
    },
    Within {
        point: Box<Expr>,
        margin: Option<Box<Expr>>,
        mask: Box<Expr>,
    },
    All(Vec<Expr>),
    Any(Vec<Expr>),
    Not(Box<Expr>),
}

/// `NAME: …`, or the value alone.
#[derive(Clone, Debug)]
pub(crate) struct Argument {
    pub label: Option<Ident>,
    pub value: Expr,
}

/// Reads an expression from the first part of `node` that is one; recursion is bounded by the grammar's nesting limit.
pub(super) fn first(file: FileId, node: Node<'_>) -> Option<Expr> {
    node.children().find_map(|child| expr(file, child))
}

/// Reads every expression directly below `node`.
pub(super) fn all(file: FileId, node: Node<'_>) -> Vec<Expr> {
    node.children()
        .filter_map(|child| expr(file, child))
        .collect()
}

pub(super) fn ident(file: FileId, node: Node<'_>) -> Ident {
    Ident {
        text: node.text().to_owned(),
        span: Span::new(file, node.span()),
    }
}

/// Reads one node; None where it is no expression.
pub(super) fn expr(file: FileId, node: Node<'_>) -> Option<Expr> {
    let span = Span::new(file, node.span());
    let kind = match node.kind() {
        Kind::Expr => return Some(joined(span, all(file, node), ExprKind::Any)),
        Kind::Conjunction => return Some(joined(span, all(file, node), ExprKind::All)),
        Kind::Negation => return negation(file, node),
        Kind::Relation => return relation(file, node),
        Kind::Group => return group(file, node),
        Kind::Operand => return operand(file, node),
        Kind::Heading => {
            let [from, to] = two(file, node)?;
            ExprKind::Heading { from, to }
        }
        Kind::Path => ExprKind::Path(node.text().to_owned()),
        Kind::String | Kind::CurlyString | Kind::SingleString => {
            ExprKind::Text(text::text(file, node)?)
        }
        Kind::Quantity => quantity(file, node)?,
        Kind::Name => ExprKind::Name(node.text().to_owned()),
        Kind::Call => ExprKind::Call {
            name: ident(file, node.child(Kind::Name)?),
            arguments: node
                .all(Kind::Argument)
                .filter_map(|argument| self::argument(file, argument))
                .collect(),
        },
        _ => return None,
    };
    Some(Expr { span, kind })
}

fn joined(span: Span, mut parts: Vec<Expr>, join: fn(Vec<Expr>) -> ExprKind) -> Expr {
    match parts.len() {
        1 => parts.swap_remove(0),
        _ => Expr {
            span,
            kind: join(parts),
        },
    }
}

fn negation(file: FileId, node: Node<'_>) -> Option<Expr> {
    let span = Span::new(file, node.span());
    let inner = first(file, node)?;
    // `not not x` is x: an even number of them says nothing.
    let negated = node.all(Kind::NotWord).count() % 2 == 1;
    Some(if negated {
        Expr {
            span,
            kind: ExprKind::Not(Box::new(inner)),
        }
    } else {
        inner
    })
}

fn two(file: FileId, node: Node<'_>) -> Option<[Box<Expr>; 2]> {
    let mut parts = all(file, node).into_iter().map(Box::new);
    Some([parts.next()?, parts.next()?])
}

fn group(file: FileId, node: Node<'_>) -> Option<Expr> {
    let mut parts = all(file, node).into_iter();
    let first = parts.next()?;
    Some(match parts.next() {
        None => first,
        Some(second) => Expr {
            span: Span::new(file, node.span()),
            kind: ExprKind::Pair(Box::new([first, second])),
        },
    })
}

fn operand(file: FileId, node: Node<'_>) -> Option<Expr> {
    let value = first(file, node)?;
    Some(match node.child(Kind::Target) {
        None => value,
        Some(target) => Expr {
            span: Span::new(file, node.span()),
            kind: ExprKind::Converted {
                value: Box::new(value),
                target: ident(file, target),
            },
        },
    })
}

fn relation(file: FileId, node: Node<'_>) -> Option<Expr> {
    let span = Span::new(file, node.span());
    let mut operands = all(file, node).into_iter();
    let left = operands.next()?;
    let Some(right) = operands.next() else {
        return Some(left);
    };
    let (left, right) = (Box::new(left), Box::new(right));
    let kind = match node.child(Kind::Compare) {
        Some(sign) => ExprKind::Compare {
            left,
            sign: ident(file, sign),
            right,
        },
        None if node.child(Kind::ToWord).is_some() => ExprKind::Range {
            low: left,
            high: right,
        },
        None => {
            let margin = node
                .child(Kind::Margin)
                .and_then(|margin| first(file, margin))
                .map(Box::new);
            ExprKind::Within {
                point: left,
                margin,
                mask: right,
            }
        }
    };
    Some(Expr { span, kind })
}

fn quantity(file: FileId, node: Node<'_>) -> Option<ExprKind> {
    let number = node.child(Kind::Number)?;
    // The grammar's numbers are digits, so parsing cannot fail; too many digits give infinity, which no range accepts.
    let value = number.text().parse().ok()?;
    let unit = node
        .child(Kind::Unit)
        .or(node.child(Kind::KnownUnit))
        .map(|unit| ident(file, unit));
    Some(ExprKind::Quantity { value, unit })
}

fn argument(file: FileId, node: Node<'_>) -> Option<Argument> {
    let label = node.child(Kind::Label).map(|label| ident(file, label));
    Some(Argument {
        label,
        value: first(file, node)?,
    })
}
