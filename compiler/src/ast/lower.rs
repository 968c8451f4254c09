//! From the syntax tree to what a file says.

use super::expr::{self, ident};
use super::{
    Actions, Check, Component, Declares, Experts, Field, File, Folds, Ident, Image, Keypoint,
    Keypoints, Move, Pictures, Read, Reference, Saying, Sayings, Settings, Stage, Statement,
    Subgoals, Task, Verify, text,
};
use crate::source::{FileId, Span};
use grammar::{Kind, Node, Tree};

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
        Kind::Junk | Kind::JunkSection | Kind::JunkCondition | Kind::Stray | Kind::Surplus
    )
}

/// Returns whether a statement is cut off by what does not fit; a whole block before such a thing is kept.
fn is_half(node: Node<'_>) -> bool {
    let is_block = node.child(Kind::Close).is_some() && node.kind() != Kind::Check;
    !is_block && node.is_cut()
}

/// Returns the whole statements of a kind.
fn whole<'t>(block: Node<'t>, kind: Kind) -> impl Iterator<Item = Node<'t>> {
    block.all(kind).filter(|node| !is_half(*node))
}

/// Returns whether something directly in a block does not fit.
fn has_faults(block: Node<'_>) -> bool {
    block
        .children()
        .any(|child| is_junk(child.kind()) || matches!(child.kind(), Kind::NoOpen | Kind::NoClose))
}

struct Reader {
    file: FileId,
}

impl Reader {
    fn span(&self, node: Node<'_>) -> Span {
        Span::new(self.file, node.span())
    }

    /// Returns the first name directly below a node.
    fn name(&self, node: Node<'_>) -> Option<Ident> {
        node.child(Kind::Name).map(|name| ident(self.file, name))
    }

    fn names(&self, node: Node<'_>) -> Vec<Ident> {
        node.all(Kind::Name)
            .map(|name| ident(self.file, name))
            .collect()
    }

    /// Returns the place of a block's first words.
    fn head(&self, node: Node<'_>) -> Span {
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
        Some(Task {
            name: self.name(node.child(Kind::TaskHead)?)?,
            extends: node
                .child(Kind::Extends)
                .and_then(|extends| self.name(extends)),
            cloth: self.statements(node, Kind::Cloth),
            camera: self.statements(node, Kind::Camera),
            goal: self.statements(node, Kind::Goal),
            horizon: self.statements(node, Kind::Horizon),
            subgoals: node
                .all(Kind::Subgoals)
                .map(|part| self.subgoals(part))
                .collect(),
            experts: whole(node, Kind::ExpertsUsed)
                .filter_map(|part| self.reference(part))
                .collect(),
            keypoints: node
                .all(Kind::Keypoints)
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
            has_faults: has_faults(node),
        })
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

    fn image(&self, node: Node<'_>) -> Option<Image> {
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
        let keypoint = |part| {
            Some(Keypoint {
                name: self.name(part)?,
                value: last_expr(self.file, part)?,
            })
        };
        Keypoints {
            span: self.head(node),
            list: whole(node, Kind::Keypoint).filter_map(keypoint).collect(),
        }
    }

    fn actions(&self, node: Node<'_>) -> Actions {
        let field = |part| {
            let mut names = self.names(part);
            let one_of = names.split_off(1.min(names.len()));
            Some(Field {
                name: names.pop()?,
                one_of,
            })
        };
        Actions {
            span: self.head(node),
            fields: whole(node, Kind::Field).filter_map(field).collect(),
            has_faults: has_faults(node),
        }
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
            text: text::first(self.file, node)?,
        })
    }

    fn stage(&self, node: Node<'_>) -> Option<Stage> {
        let sayings = |kind| whole(node, kind).map(|part| self.sayings(part)).collect();
        Some(Stage {
            name: self.name(node.child(Kind::StageHead)?)?,
            model: whole(node, Kind::Model)
                .map(|part| self.settings(part))
                .collect(),
            show: whole(node, Kind::Show)
                .map(|part| self.pictures(part))
                .collect(),
            say: sayings(Kind::Say),
            system: sayings(Kind::System),
            read: whole(node, Kind::Read)
                .filter_map(|part| self.read(part))
                .collect(),
            has_faults: has_faults(node),
        })
    }

    fn settings(&self, node: Node<'_>) -> Settings {
        let setting = |part: Node<'_>| {
            let value = part
                .child(Kind::Quantity)
                .and_then(|quantity| expr::expr(self.file, quantity));
            Some((self.name(part)?, value))
        };
        Settings {
            span: self.span(node),
            list: node.all(Kind::Setting).filter_map(setting).collect(),
        }
    }

    fn pictures(&self, node: Node<'_>) -> Pictures {
        let picture = |part: Node<'_>| {
            Some((
                expr::expr(self.file, part.child(Kind::Expr)?)?,
                self.name(part),
            ))
        };
        Pictures {
            span: self.span(node),
            list: node.all(Kind::Picture).filter_map(picture).collect(),
        }
    }

    fn sayings(&self, node: Node<'_>) -> Sayings {
        let saying = |part: Node<'_>| match self.name(part) {
            Some(name) => Some(Saying::Component(name)),
            None => text::first(self.file, part).map(Saying::Text),
        };
        Sayings {
            span: self.span(node),
            list: node.all(Kind::Saying).filter_map(saying).collect(),
        }
    }

    fn read(&self, node: Node<'_>) -> Option<Read> {
        Some(Read {
            span: self.span(node),
            name: self.name(node)?,
            pattern: text::first(self.file, node),
        })
    }

    fn verify(&self, node: Node<'_>) -> Verify {
        Verify {
            span: self.head(node),
            checks: whole(node, Kind::Check)
                .filter_map(|part| self.check(part))
                .collect(),
            attempts: self.statements(node, Kind::Attempts),
        }
    }

    fn check(&self, node: Node<'_>) -> Option<Check> {
        let head = node.child(Kind::CheckHead)?;
        Some(Check {
            span: self.head(node),
            name: self.name(head)?,
            condition: node
                .child(Kind::Expr)
                .and_then(|condition| expr::expr(self.file, condition)),
            message: text::first(self.file, node),
            has_faults: has_faults(node),
        })
    }
}

/// Returns the value of `NAME = value`: the name itself reads as an expression too.
fn last_expr(file: FileId, node: Node<'_>) -> Option<expr::Expr> {
    expr::all(file, node).pop()
}
