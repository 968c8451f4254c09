//! From the syntax tree to stages, checks and tests.

use super::expr::{self, ident};
use super::lower::{Reader, has_faults, whole};
use super::{
    Attempts, Check, Example, Expect, Given, Pictures, Read, Reply, ResultCheck, Saying, Sayings,
    Settings, Stage, Test, Verify, text,
};
use fab_grammar::{Kind, Node};

impl Reader {
    pub(super) fn stage(&self, node: Node<'_>) -> Option<Stage> {
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
            examples: node
                .all(Kind::Example)
                .map(|part| self.example(part))
                .collect(),
            has_faults: has_faults(node),
        })
    }

    fn settings(&self, node: Node<'_>) -> Settings {
        let setting = |part: Node<'_>| {
            let mut parts = expr::all(self.file, part).into_iter();
            parts.next();
            Some((self.name(part)?, parts.next()))
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

    pub(super) fn verify(&self, node: Node<'_>) -> Verify {
        Verify {
            span: self.head(node),
            checks: whole(node, Kind::Check)
                .filter_map(|part| self.check(part))
                .collect(),
            attempts: whole(node, Kind::Attempts)
                .filter_map(|part| self.attempts(part))
                .collect(),
            results: whole(node, Kind::Result)
                .filter_map(|part| self.result(part))
                .collect(),
        }
    }

    pub(super) fn check(&self, node: Node<'_>) -> Option<Check> {
        let head = node.child(Kind::CheckHead)?;
        Some(Check {
            span: self.head(node),
            name: self.name(head)?,
            when: self.guard(node),
            condition: node
                .child(Kind::Expr)
                .and_then(|condition| expr::expr(self.file, condition)),
            message: text::first(self.file, node),
            has_faults: has_faults(node),
        })
    }

    fn result(&self, node: Node<'_>) -> Option<ResultCheck> {
        Some(ResultCheck {
            span: self.span(node),
            above: expr::first(self.file, node)?,
            retries: node
                .child(Kind::Retries)
                .and_then(|retries| expr::first(self.file, retries)),
            message: text::first(self.file, node),
            has_faults: has_faults(node),
        })
    }

    fn attempts(&self, node: Node<'_>) -> Option<Attempts> {
        Some(Attempts {
            span: self.span(node),
            count: expr::first(self.file, node)?,
            with_picture: node
                .child(Kind::WithPicture)
                .map(|picture| self.span(picture)),
            else_skip: node.child(Kind::ElseSkip).map(|skip| self.span(skip)),
            relaxed: node
                .child(Kind::Relax)
                .map_or(Vec::new(), |relax| self.names(relax)),
        })
    }

    fn example(&self, node: Node<'_>) -> Example {
        Example {
            span: self.head(node),
            say: whole(node, Kind::Say)
                .map(|part| self.sayings(part))
                .collect(),
            images: whole(node, Kind::Image)
                .filter_map(|part| self.image(part))
                .collect(),
            replies: whole(node, Kind::Reply)
                .filter_map(|part| self.reply(part))
                .collect(),
            has_faults: has_faults(node),
        }
    }

    fn reply(&self, node: Node<'_>) -> Option<Reply> {
        Some(Reply {
            span: self.span(node),
            stage: self.name(node),
            text: text::first(self.file, node)?,
        })
    }

    pub(super) fn test(&self, node: Node<'_>) -> Test {
        let head = node.child(Kind::TestHead);
        Test {
            span: self.head(node),
            name: head.and_then(|head| text::first(self.file, head)),
            given: whole(node, Kind::Given)
                .filter_map(|part| self.given(part))
                .collect(),
            replies: whole(node, Kind::Reply)
                .filter_map(|part| self.reply(part))
                .collect(),
            expect: whole(node, Kind::Expect)
                .filter_map(|part| self.expect(part))
                .collect(),
            has_faults: has_faults(node),
        }
    }

    fn given(&self, node: Node<'_>) -> Option<Given> {
        let name = node.child(Kind::Path).or(node.child(Kind::Name))?;
        Some(Given {
            name: ident(self.file, name),
            values: node
                .all(Kind::Expr)
                .filter_map(|part| expr::expr(self.file, part))
                .collect(),
            text: text::first(self.file, node),
        })
    }

    fn expect(&self, node: Node<'_>) -> Option<Expect> {
        let mut names = self.names(node).into_iter();
        Some(Expect {
            span: self.span(node),
            what: names.next()?,
            check: names.next(),
            text: text::first(self.file, node),
        })
    }
}
