//! What a stage says: the parts that it lists, and those that extending tasks add beside them.

use fab_grammar::Kind;
use fab_grammar::ast::{AddedSay, ComponentOrText, Name, Sayings, Stage};

/// What a stage says in `system` and in `say`, in order.
#[derive(Default)]
pub(crate) struct Said<'a>(Vec<Saying<'a>>);

struct Saying<'a> {
    line: Line,
    part: ComponentOrText<'a>,
    /// The component that it was added beside, if it was added.
    beside: Option<&'a str>,
}

/// A line of a stage.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Line {
    System,
    Say,
}

impl<'a> Saying<'a> {
    fn component(&self) -> Option<&'a str> {
        match self.part {
            ComponentOrText::Component(name) => Some(name.text()),
            ComponentOrText::Text(_) => None,
        }
    }
}

impl<'a> Said<'a> {
    /// Returns what a stage says as it is declared.
    pub fn of(stage: Stage<'a>) -> Said<'a> {
        let of = |line, kind| {
            let lines = stage.node().all(kind).filter_map(Sayings::cast);
            lines.flat_map(Sayings::list).map(move |part| Saying {
                line,
                part,
                beside: None,
            })
        };
        let system = of(Line::System, Kind::System);
        Said(system.chain(of(Line::Say, Kind::Say)).collect())
    }

    /// Returns whether it says a component; a component that is left out keeps its place.
    pub fn says(&self, name: &str) -> bool {
        self.names().any(|known| known == name)
    }

    /// Returns the components that it says.
    pub fn names(&self) -> impl Iterator<Item = &'a str> {
        self.0.iter().filter_map(Saying::component)
    }

    /// Returns the parts of one line.
    pub fn line(&self, line: Line) -> impl Iterator<Item = ComponentOrText<'a>> {
        let of_line = self.0.iter().filter(move |saying| saying.line == line);
        of_line.map(|saying| saying.part)
    }

    /// Adds a component next to another that it says. Those at one place keep the order in which they are added.
    pub fn add(&mut self, part: Name<'a>, added: AddedSay<'a>) {
        let beside = added.beside().text();
        let is_beside = |saying: &Saying<'_>| saying.component() == Some(beside);
        let Some(mut place) = self.0.iter().position(is_beside) else {
            return;
        };
        let line = self.0[place].line;
        if !added.is_before() {
            place += 1;
            let after = &self.0[place..];
            let added = after
                .iter()
                .take_while(|it| self.was_added_beside(it, beside));
            place += added.count();
        }
        let part = ComponentOrText::Component(part);
        self.0.insert(
            place,
            Saying {
                line,
                part,
                beside: Some(beside),
            },
        );
    }

    /// Returns whether a part was added beside a component, or beside another part that was.
    fn was_added_beside(&self, saying: &Saying<'a>, component: &str) -> bool {
        let mut beside = saying.beside;
        while let Some(name) = beside {
            if name == component {
                return true;
            }
            let mut all = self.0.iter();
            let next = all.find(|it| it.component() == Some(name));
            beside = next.and_then(|it| it.beside);
        }
        false
    }
}
