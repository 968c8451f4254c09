//! Finds the clauses of a longer explanation that take the answer back.
//!
//! Most of an explanation describes the cloth, the picture, earlier tries and other ways to act, in any words. So only
//! what plainly speaks of the answer, of its author or to whoever carries it out counts.

use super::clause::{
    Clause, DOUBTED, OTHERWISE, Place, Predicate, Subject, orders, refers_forward,
};
use super::sayings;
use super::vocabulary::*;
use crate::reply::wordlist::words;

/// What points back to what was just described, and seldom to the answer.
const BACKWARD: &[&str] = words!("it that they those them which one");

/// What tells of an earlier try.
const EARLIER: &[&str] =
    words!("before earlier previous previously ago former formerly attempt attempts");

/// What is an earlier try after `first` or `last`.
const TRIES: &[&str] =
    words!("try tries attempt time round pull fold action step move answer reply proposal");

/// Returns why a sentence of an explanation takes the answer back.
pub(super) fn why(clauses: &[Clause<'_>]) -> Option<&'static str> {
    let clauses: Vec<&Clause<'_>> = clauses.iter().filter(|it| !it.words.is_empty()).collect();
    clauses
        .iter()
        .enumerate()
        .filter(|(at, it)| {
            // `I apologise, in my last reply the points were swapped`
            let is_past =
                it.regrets() && clauses[at + 1..].iter().any(|it| it.names_an_earlier_try());
            !is_past && !it.tells_of_an_earlier_try()
        })
        .find_map(|(at, clause)| {
            sayings::plainly(clause).or_else(|| {
                let next = clauses.get(at + 1);
                // `I would rather gain a little than lose what is won`
                let compares = next.is_some_and(|next| next.joint == "than");
                let settles = |it: &&Clause<'_>| it.holds_either_way();
                let is_settled =
                    clauses[at + 1..].iter().take(2).any(settles) && !clause.names_the_answer();
                if compares || is_settled || next.is_some_and(|next| next.wonders_about_the_cloth())
                {
                    return None;
                }
                clause.takes_back(at)
            })
        })
}

impl Clause<'_> {
    /// Whom the clause speaks of decides what counts.
    ///
    /// - `at`: its index in the sentence.
    fn takes_back(&self, at: usize) -> Option<&'static str> {
        match self.subject {
            Subject::World => None,
            Subject::Nobody => (at == 0 || self.joint == "but")
                .then(|| self.demands())
                .flatten(),
            Subject::Answer if self.joint == "than" => None,
            Subject::Answer if BACKWARD.contains(&self.words[0]) => self.is_belittled(),
            Subject::Author if self.doubts_the_world() => sayings::why(self),
            _ if self.is_explaining() => self.doubt(),
            _ => self.doubt().or_else(|| sayings::why(self)),
        }
    }

    /// `[I am not sure] whether this wedge is a single layer`; of the answer, it would be doubt.
    fn wonders_about_the_cloth(&self) -> bool {
        let judges = |it: &&str| {
            words!("correct best answer values numbers pick works work helps intended meant")
                .contains(it)
        };
        let is_right = |pair: &[&str]| {
            BE.contains(&pair[0]) && pair[1] == "right"
                || pair[0] == "this" && (BE.contains(&pair[1]) || MODALS.contains(&pair[1]))
        };
        words!("whether how why").contains(&self.joint)
            && !self.words.iter().any(judges)
            && !self.words.windows(2).any(is_right)
    }

    /// `[I can't be sure that it is a corner,] but pulling it will help in either case`
    fn holds_either_way(&self) -> bool {
        let helps = |it: &&str| words!("help helps gain gains").contains(it);
        let weakens =
            |it: &&str| words!("may might could should nothing not you something").contains(it);
        self.joint == "but"
            && self.words.iter().any(helps)
            && !self.words.iter().any(weakens)
            && (self.words.ends_with(&["in", "either", "case"])
                || self.words.ends_with(&["either", "way"])
                || self.words.ends_with(&["in", "any", "case"]))
    }

    fn names_the_answer(&self) -> bool {
        let names = |it: &&str| {
            ANSWERS.contains(it)
                || words!("these those values numbers coordinates point points direction distance")
                    .contains(it)
        };
        self.words.iter().any(names)
    }

    fn regrets(&self) -> bool {
        let is_regret = |it: &&str| words!("sorry apologise apologize apologies").contains(it);
        self.words.iter().any(is_regret)
    }

    /// `my last answer`, `before`
    fn names_an_earlier_try(&self) -> bool {
        let is_last =
            |near: &[&str]| matches!(near[0], "first" | "last") && TRIES.contains(&near[1]);
        self.words.windows(2).any(is_last) || self.words.iter().any(|it| EARLIER.contains(it))
    }

    /// `The last attempt was wrong`, `the two points that I gave before were too close`, `I had misread the arrow`
    fn tells_of_an_earlier_try(&self) -> bool {
        let named = self.named();
        // `I am sorry about my last answer`
        let regrets = self.regrets() && self.names_an_earlier_try();
        let gave = self
            .words
            .windows(3)
            .any(|near| near[0] == "i" && EARLIER.contains(&near[2]));
        let had = self.subject == Subject::Author && self.predicate.first() == Some(&"had");
        // `What I was unsure about`
        let wondered = matches!(
            self.words,
            [.., "i", "was", "unsure" | "uncertain", _]
                | ["i", "was", "unsure" | "uncertain" | "tempted", ..]
                | ["i", "was", _, "unsure" | "uncertain" | "tempted", ..]
        );
        let is_named = named.iter().any(|it| EARLIER.contains(it))
            || named
                .windows(2)
                .any(|near| matches!(near[0], "first" | "last") && TRIES.contains(&near[1]));
        // `I was not sure at first whether …`
        let at_first = self.subject == Subject::Author
            && self.words.windows(2).enumerate().any(|(at, pair)| {
                let next = self.words.get(at + 2).copied().unwrap_or_default();
                pair == ["at", "first"] && !words!("sight glance look").contains(&next)
            });
        regrets || gave || had || wondered || is_named || at_first && self.words.contains(&"was")
    }

    /// `I am a bit worried by the scale`, `I did not go for half an edge`, `I am not entirely certain of this`
    fn doubts_the_world(&self) -> bool {
        let rest = Predicate::of(self.predicate).rest;
        let names_answer = |it: &&str| {
            ANSWERS.contains(it)
                || words!("these those numbers coordinates point points place pixels guess")
                    .contains(it)
        };
        let wants = Predicate::of(self.predicate).head == Some("want");
        let names_it = |it: &&str| {
            names_answer(it) || *it == "this" || !wants && words!("it them both").contains(it)
        };
        let is_slight = self.predicate.windows(2).any(|pair| {
            pair[0] == "not"
                && words!("entirely fully completely absolutely totally quite perfectly")
                    .contains(&pair[1])
        });
        // `I do not want to squeeze it more than needed`
        let spares = wants && rest.ends_with(&["more", "than", "needed"]);
        let tells_of_values = self.place == Place::Before && refers_forward(rest);
        !tells_of_values && rest.len() > 2 && !rest.iter().any(names_it)
            || is_slight && !rest.iter().any(names_answer)
            || spares
    }

    /// `Wait for the operator`, `a mere guess`
    fn demands(&self) -> Option<&'static str> {
        let first = self.words[0];
        if PREPOSITIONS.contains(&first) || first.ends_with("ing") {
            return None;
        }
        if orders(first) {
            // `Fold the left corner to the middle` repeats what is asked for.
            let saying = sayings::why(self)
                .filter(|why| *why != OTHERWISE || self.words.contains(&"instead"));
            return self.orders(self.words).or(saying);
        }
        self.labels()
    }

    /// `It is only a guess`
    fn is_belittled(&self) -> Option<&'static str> {
        let Predicate { denies, rest, .. } = Predicate::of(self.predicate);
        let doubts = rest
            .iter()
            .take(4)
            .any(|it| DOUBTS.contains(it) && !WEAK_DOUBTS.contains(it));
        // `That was a slip` is told of what was corrected.
        let is_past = matches!(self.predicate.first(), Some(&"was" | &"were"))
            && rest
                .iter()
                .any(|it| words!("slip mistake error typo misreading oversight").contains(it));
        (doubts && !denies && !is_past && self.place != Place::Before).then_some(DOUBTED)
    }
}
