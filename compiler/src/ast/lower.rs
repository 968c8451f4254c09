//! From the syntax tree to what a file says.

use super::expr::{self, ident};
use super::{
    Actions, Body, Component, Declares, Demos, Experts, Field, File, Folds, Ident, Image, Keypoint,
    Keypoints, Move, Reference, Statement, Subgoals, Task, Variant, text,
};
use crate::source::{FileId, Span};
use fab_grammar::{Kind, Node, Tree};

/// Reads a tree; what does not fit is left out.
pub(crate) fn lower(file: FileId, tree: &Tree) -> File {
    let root = tree.root();
    let reader = Reader { file };
    let junk = tree
        .nodes()
        .filter(|node| is_junk(node.kind()) || is_half(*node));
    let words = |node: Node<'_>| -> Vec<String> {
        node.text()
            .split(|character: char| !character.is_alphanumeric() && character != '_')
            .map(str::to_owned)
            .collect()
    };
    File {
        id: file,
        uses: root
            .all(Kind::UseFile)
            .filter_map(|node| text::first(file, node))
            .collect(),
        experts: root
            .all(Kind::Experts)
            .filter_map(|node| reader.experts(node))
            .collect(),
        tasks: root
            .all(Kind::Task)
            .filter_map(|node| reader.task(node))
            .collect(),
        junk_words: junk
            .flat_map(words)
            .filter(|word| !word.is_empty())
            .collect(),
    }
}

fn is_junk(kind: Kind) -> bool {
    matches!(
        kind,
        Kind::Junk
            | Kind::JunkSection
            | Kind::JunkCondition
            | Kind::JunkGuard
            | Kind::Stray
            | Kind::Surplus
    )
}

/// Returns whether a statement is cut off by what does not fit; a whole block before such a thing is kept.
fn is_half(node: Node<'_>) -> bool {
    let is_block = node.child(Kind::Close).is_some() && node.kind() != Kind::Check;
    !is_block && node.is_cut()
}

/// Returns the whole statements of a kind.
pub(super) fn whole<'t>(block: Node<'t>, kind: Kind) -> impl Iterator<Item = Node<'t>> {
    block.all(kind).filter(|node| !is_half(*node))
}

/// Returns whether something directly in a block does not fit.
pub(super) fn has_faults(block: Node<'_>) -> bool {
    block
        .children()
        .any(|child| is_junk(child.kind()) || matches!(child.kind(), Kind::NoOpen | Kind::NoClose))
}

pub(super) struct Reader {
    pub(super) file: FileId,
}

impl Reader {
    pub(super) fn span(&self, node: Node<'_>) -> Span {
        Span::new(self.file, node.span())
    }

    /// Returns the first name directly below a node.
    pub(super) fn name(&self, node: Node<'_>) -> Option<Ident> {
        node.child(Kind::Name).map(|name| ident(self.file, name))
    }

    pub(super) fn names(&self, node: Node<'_>) -> Vec<Ident> {
        node.all(Kind::Name)
            .map(|name| ident(self.file, name))
            .collect()
    }

    /// Returns the place of a block's first words.
    pub(super) fn head(&self, node: Node<'_>) -> Span {
        let head = node.children().next().unwrap_or(node);
        let length = head.text().trim_end().len();
        Span::new(self.file, head.span().start..head.span().start + length)
    }

    fn experts(&self, node: Node<'_>) -> Option<Experts> {
        Some(Experts {
            name: self.name(node.child(Kind::ExpertsHead)?)?,
            sequences: node
                .all(Kind::Sequence)
                .map(|sequence| self.folds(sequence))
                .collect(),
            has_faults: has_faults(node),
        })
    }

    fn folds(&self, node: Node<'_>) -> Folds {
        let moves = whole(node, Kind::Fold)
            .flat_map(|fold| fold.all(Kind::Move))
            .filter_map(|part| self.r#move(part));
        Folds {
            span: self.head(node),
            moves: moves.collect(),
            has_faults: has_faults(node),
        }
    }

    fn r#move(&self, node: Node<'_>) -> Option<Move> {
        let mut parts = expr::all(self.file, node).into_iter();
        Some(Move {
            span: self.span(node),
            pick: parts.next()?,
            place: parts.next()?,
            fraction: parts.next(),
        })
    }

    fn task(&self, node: Node<'_>) -> Option<Task> {
        let variant = |part: Node<'_>| {
            Some(Variant {
                name: self.name(part.child(Kind::VariantHead)?)?,
                body: self.body(part),
            })
        };
        Some(Task {
            name: self.name(node.child(Kind::TaskHead)?)?,
            extends: node
                .child(Kind::Extends)
                .and_then(|extends| self.name(extends)),
            body: self.body(node),
            variants: node.all(Kind::Variant).filter_map(variant).collect(),
            ablated: whole(node, Kind::Ablate)
                .flat_map(|part| self.names(part))
                .collect(),
            tests: node.all(Kind::Test).map(|part| self.test(part)).collect(),
        })
    }

    fn body(&self, node: Node<'_>) -> Body {
        Body {
            constants: whole(node, Kind::Constant)
                .filter_map(|part| self.named_value(part))
                .collect(),
            cloth: self.statements(node, Kind::Cloth),
            camera: self.statements(node, Kind::Camera),
            picker: self.statements(node, Kind::Picker),
            goal: self.statements(node, Kind::Goal),
            horizon: self.statements(node, Kind::Horizon),
            subgoals: node
                .all(Kind::Subgoals)
                .map(|part| self.subgoals(part))
                .collect(),
            experts: whole(node, Kind::ExpertsUsed)
                .filter_map(|part| self.reference(part))
                .collect(),
            demos: whole(node, Kind::Demos)
                .filter_map(|part| self.demos(part))
                .collect(),
            keypoints: node
                .all(Kind::Keypoints)
                .map(|part| self.keypoints(part))
                .collect(),
            annotate: node
                .all(Kind::Annotate)
                .map(|part| self.keypoints(part))
                .collect(),
            actions: node
                .all(Kind::Actions)
                .map(|part| self.actions(part))
                .collect(),
            components: node
                .children()
                .filter(|part| !is_half(*part))
                .filter_map(|part| self.component(part))
                .collect(),
            without: whole(node, Kind::Without)
                .flat_map(|part| self.names(part))
                .collect(),
            stages: node
                .all(Kind::Stage)
                .filter_map(|part| self.stage(part))
                .collect(),
            verify: node
                .all(Kind::Verify)
                .map(|part| self.verify(part))
                .collect(),
            checks: whole(node, Kind::OverrideCheck)
                .filter_map(|part| self.check(part.child(Kind::Check)?))
                .collect(),
            without_checks: whole(node, Kind::WithoutCheck)
                .flat_map(|part| self.names(part))
                .collect(),
            bytes: node.span().len(),
            has_faults: has_faults(node),
        }
    }

    fn statements(&self, node: Node<'_>, kind: Kind) -> Vec<Statement> {
        let statement = |part| {
            Some(Statement {
                span: self.span(part),
                value: expr::first(self.file, part)?,
            })
        };
        whole(node, kind).filter_map(statement).collect()
    }

    fn reference(&self, node: Node<'_>) -> Option<Reference> {
        Some(Reference {
            span: self.span(node),
            name: self.name(node)?,
        })
    }

    fn demos(&self, node: Node<'_>) -> Option<Demos> {
        Some(Demos {
            span: self.span(node),
            stage: self.name(node)?,
            file: text::first(self.file, node)?,
        })
    }

    fn subgoals(&self, node: Node<'_>) -> Subgoals {
        Subgoals {
            span: self.head(node),
            demonstrate: node
                .all(Kind::Demonstrate)
                .map(|part| self.folds(part))
                .collect(),
            images: whole(node, Kind::Image)
                .filter_map(|part| self.image(part))
                .collect(),
            has_faults: has_faults(node),
        }
    }

    pub(super) fn image(&self, node: Node<'_>) -> Option<Image> {
        let mut pairs = node
            .all(Kind::Pair)
            .filter_map(|pair| <[_; 2]>::try_from(expr::all(self.file, pair)).ok());
        let arrow = pairs.next().and_then(|tail| Some([tail, pairs.next()?]));
        Some(Image {
            span: self.span(node),
            path: text::first(self.file, node)?,
            arrow,
        })
    }

    fn keypoints(&self, node: Node<'_>) -> Keypoints {
        Keypoints {
            span: self.head(node),
            list: whole(node, Kind::Keypoint)
                .filter_map(|part| self.named_value(part))
                .collect(),
        }
    }

    fn named_value(&self, node: Node<'_>) -> Option<Keypoint> {
        Some(Keypoint {
            name: self.name(node)?,
            // The name itself reads as an expression too.
            value: expr::all(self.file, node).pop()?,
        })
    }

    fn actions(&self, node: Node<'_>) -> Actions {
        let field = |part| {
            let mut choices = expr::all(self.file, part);
            let one_of = choices.split_off(1.min(choices.len()));
            Some(Field {
                name: self.name(part)?,
                one_of,
                any_of: part.child(Kind::AnyOf).and_then(|region| self.name(region)),
            })
        };
        Actions {
            span: self.head(node),
            fields: whole(node, Kind::Field).filter_map(field).collect(),
            has_faults: has_faults(node),
        }
    }

    pub(super) fn guard(&self, node: Node<'_>) -> Option<expr::Expr> {
        node.child(Kind::Guard)
            .and_then(|guard| expr::first(self.file, guard))
    }

    fn component(&self, node: Node<'_>) -> Option<Component> {
        let declares = match node.kind() {
            Kind::Component => Declares::New,
            Kind::OverrideComponent => Declares::Override,
            _ => return None,
        };
        Some(Component {
            declares,
            name: self.name(node)?,
            when: self.guard(node),
            text: text::first(self.file, node)?,
        })
    }
}
