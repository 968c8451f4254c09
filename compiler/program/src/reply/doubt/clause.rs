//! A clause as a statement: whom it speaks of, what it says of them, and whether that puts the answer in doubt.

use super::vocabulary::*;
use crate::reply::wordlist::{says, words};

/// Where a sentence stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Before the last value. Other ways to fold are weighed here, and the picture is described.
    Before,
    /// In a member of an object beside the values. It may explain why the values are better than others.
    Beside,
    /// After the last value.
    After,
}

/// How much an answer says beside its values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Prose {
    /// A few words. They are written for a reason, so all of them have to be understood.
    Remark,
    /// An explanation, most of which describes the cloth, the picture and other ways to act.
    Explanation,
}

pub(super) const DOUBTED: &str = "the answer doubts its own values";
pub(super) const HALTED: &str = "the answer says that it is not to be carried out";
pub(super) const OTHERWISE: &str = "the answer proposes something else than its values";
pub(super) const CONDITIONAL: &str = "the answer holds only under a condition";
pub(super) const CHANGED: &str = "the answer changes its values afterwards";

/// Whom a clause speaks of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Subject {
    /// The answer or a part of it.
    Answer,
    /// The model.
    Author,
    /// Whoever carries the answer out.
    Agent,
    /// Somebody who would have to decide.
    Person,
    /// The cloth, the picture, anything else.
    World,
    /// Nobody: an order, or a phrase without a verb.
    Nobody,
}

/// A clause of a sentence.
pub(super) struct Clause<'a> {
    /// Its words, without those that only open it.
    pub(super) words: &'a [&'a str],
    pub(super) joint: &'a str,
    pub(super) place: Place,
    pub(super) prose: Prose,
    /// Whether it tells of a later step.
    pub(super) is_sequel: bool,
    pub(super) subject: Subject,
    /// What is said of the subject.
    pub(super) predicate: &'a [&'a str],
    /// Whether the subject denies it: `none of them`.
    pub(super) is_none: bool,
}

impl<'a> Clause<'a> {
    pub(super) fn new(
        words: &'a [&'a str],
        joint: &'a str,
        (place, prose): (Place, Prose),
        was_sequel: bool,
    ) -> Clause<'a> {
        let is_subject = |at: usize| {
            words[at] == "that"
                && words
                    .get(at + 1)
                    .is_some_and(|it| BE.contains(it) || MODALS.contains(it))
        };
        let opened = words.iter().enumerate().take_while(|(at, it)| {
            OPENING.contains(it) && !is_subject(*at)
                || it.ends_with("ly") && !DOUBTS.contains(it) && **it != "only"
        });
        let words = &words[opened.count()..];
        let words = match words {
            ["in", "my", "last" | "first" | "previous" | "earlier", ..] => words,
            ["in", "my", _, rest @ ..] | ["to", "me" | "my", rest @ ..] => rest,
            _ => words,
        };
        // `With this light I see no corner`
        let begins = words
            .iter()
            .position(|it| *it == "i")
            .filter(|_| words.first().is_some_and(|it| PREPOSITIONS.contains(it)));
        let words = &words[begins.unwrap_or(0)..];
        let is_sequel = was_sequel
            || words.first().is_some_and(|it| SEQUEL.contains(it))
            || SEQUEL.contains(&joint)
            || words
                .iter()
                .any(|it| matches!(*it, "next" | "afterwards" | "later"))
            || words
                .windows(2)
                .any(|pair| pair[0] == "after" && matches!(pair[1], "this" | "that"));
        let is_sequel = is_sequel && place != Place::Before;
        let (subject, length) = subject(words);
        Clause {
            words,
            joint,
            place,
            prose,
            is_sequel,
            subject,
            predicate: &words[length..],
            is_none: words[..length].iter().any(|it| NEGATIONS.contains(it)),
        }
    }

    /// Returns the words that name its subject.
    pub(super) fn named(&self) -> &'a [&'a str] {
        &self.words[..self.words.len() - self.predicate.len()]
    }

    /// Returns whether the clause only describes the cloth or the picture, in any words.
    ///
    /// It does not if it says what ought to be done or may be, compares, or points at the answer or its reader.
    pub(super) fn describes_the_world(&self) -> bool {
        let is_verb_or_effect = |it: &str| {
            is_verb(it) || it.ends_with('s') && EFFECTS.iter().any(|stem| it.starts_with(stem))
        };
        let points_elsewhere = |it: &&str| {
            words!("should must ought need needs may might i my me we our you your this these here better best more")
                .contains(it)
                || words!("answer answers values numbers spot idea").contains(it)
                || SUPERIOR.contains(it)
                || AGENTS.contains(it) && *it != "one"
        };
        let is_told = match self.subject {
            Subject::World => true,
            Subject::Nobody => self.words.first().is_some_and(|it| !orders(it)),
            _ => false,
        };
        let is_description = is_told && self.words.iter().skip(1).any(|it| is_verb_or_effect(it))
            || self.is_explaining();
        is_description && !self.words.iter().any(points_elsewhere) || self.tells_its_effect()
    }

    /// Returns whether the clause has no verb, orders nothing and doubts nothing.
    pub(super) fn is_mere_phrase(&self) -> bool {
        self.subject == Subject::Nobody
            && self.words.first().is_some_and(|it| !orders(it))
            && !self.words.iter().any(|it| {
                is_verb(it) || DOUBTS.contains(it) || SUPERIOR.contains(it) || refers(&[it])
            })
    }

    /// Returns whether the clause tells what the answer does to the cloth: `this completes the third corner`.
    fn tells_its_effect(&self) -> bool {
        let Predicate {
            denies,
            modal,
            head,
            rest,
        } = Predicate::of(self.predicate);
        self.subject == Subject::Answer
            && !denies
            && modal.is_none_or(|it| it == "will")
            && head.is_some_and(|verb| {
                verb.ends_with('s')
                    && EFFECTS.iter().any(|stem| verb.starts_with(stem))
                    && !is_evasive(verb)
            })
            && rest
                .first()
                .is_some_and(|it| ARTICLES.contains(it) || it.starts_with(char::is_numeric))
    }

    fn is_remark(&self) -> bool {
        self.prose == Prose::Remark
    }

    pub(super) fn is_explaining(&self) -> bool {
        EXPLAINING.contains(&self.joint)
    }

    /// Returns why the clause puts the answer in doubt.
    pub(super) fn doubt(&self) -> Option<&'static str> {
        if self.words.is_empty() {
            return None;
        }
        if self.joint == "which" {
            let Predicate { denies, head, .. } = Predicate::of(self.words);
            if denies && head == Some("work") {
                return Some(DOUBTED);
            }
        }
        let mine = self.words[0] == "my"
            && self
                .words
                .iter()
                .skip(1)
                .take(2)
                .any(|it| FACULTIES.contains(it));
        let welcomes = self.words[0] == "you"
            && self
                .words
                .iter()
                .take(4)
                .any(|it| matches!(*it, "free" | "welcome"));
        let is_told = self.place == Place::After || mine && refers_forward(self.words);
        if (mine || welcomes) && is_told && !self.is_explaining() {
            return Some(DOUBTED);
        }
        if self.place == Place::Before
            && self.words.iter().any(|it| NEGATIONS.contains(it))
            && self.announces()
        {
            return Some(DOUBTED);
        }
        let judged = match self.subject {
            Subject::Answer => self.judges_answer(),
            Subject::Author => self.confesses(),
            Subject::Agent => self.directs(),
            Subject::Person => self.defers(),
            Subject::World
                if self
                    .words
                    .iter()
                    .take(4)
                    .any(|it| words!("no nothing").contains(it)) =>
            {
                self.rests()
            }
            Subject::World if matches!(self.words[0], "a" | "an") => self.labels(),
            Subject::World => None,
            Subject::Nobody => self
                .rests()
                .or_else(|| self.orders(self.words))
                .or_else(|| self.labels())
                .or_else(|| self.elides()),
        };
        judged
            .or_else(|| self.embeds())
            .or_else(|| self.quotes_saying())
    }

    /// Returns whether the clause names the values that follow it.
    pub(super) fn announces(&self) -> bool {
        let said = self.words.join(" ");
        [
            "comes next",
            "comes below",
            "that follows",
            "what follows",
            "the following",
            "next line",
            "next two lines",
            "numbers below",
            "values below",
            "answer below",
            "coordinates below",
        ]
        .iter()
        .any(|it| said.contains(it))
    }

    fn quotes_saying(&self) -> Option<&'static str> {
        if self.place == Place::Before || self.is_explaining() || !self.is_remark() {
            return None;
        }
        let text = format!(" {} ", self.words.join(" "));
        says(&text, SAYINGS).then_some(DOUBTED)
    }

    /// `None of that is reliable`, `The pick should be shifted`, `These belong to the previous picture`
    pub(super) fn judges_answer(&self) -> Option<&'static str> {
        let Predicate {
            denies,
            modal,
            head,
            rest,
        } = Predicate::of(self.predicate);
        let denies = denies != self.is_none;
        let is_it = self.words[0] == "it";
        let verb = head?;
        let named = self.named();
        if self.place == Place::Before && !refers_forward(named) {
            return None;
        }
        let has = |table: &[&str]| rest.iter().any(|it| table.contains(it));
        let noun = named.last().copied().unwrap_or_default();
        let supposed = modal.is_some_and(|it| SUPPOSING.contains(&it)) && BE.contains(&verb);
        let unreal = supposed
            && words!("these those numbers values").contains(&noun)
            && modal == Some("would");
        let turned = supposed
            && rest.first().is_some_and(|it| {
                words!("reversed swapped exchanged mirrored inverted switched flipped mixed")
                    .contains(it)
            });
        let other = supposed
            && named.is_empty()
            && rest
                .iter()
                .any(|it| words!("other another different either").contains(it));
        let corrects = self.predicate.iter().take(3).any(|it| *it == "actually")
            && BE.contains(&verb)
            && !rest
                .iter()
                .any(|it| words!("last first same only").contains(it))
            && self.place == Place::After;
        if (unreal || turned || other || corrects) && !denies && !self.is_explaining() {
            return Some(DOUBTED);
        }
        let spoils = rest
            .iter()
            .any(|it| words!("worse ruined damaged torn broken").contains(it));
        if spoils && !denies && !is_it && !self.is_explaining() {
            return Some(DOUBTED);
        }
        let n_near = if self.is_remark() { 5 } else { 1 };
        let grows = rest.iter().take(n_near).any(|it| {
            it.len() > 4
                && it.ends_with("er")
                && (self.is_remark() || REVISED.contains(it))
                && !FIT.contains(it)
                && !words!("under after other together upper lower finger gripper either rather")
                    .contains(it)
        });
        if is_duty(modal) && BE.contains(&verb) && grows && !denies && !is_it {
            return Some(CHANGED);
        }
        // `This should only be carried out with the table cleared`
        let only = self.predicate.iter().take(3).any(|it| *it == "only");
        if only && is_duty(modal) && rest.first().is_some_and(|it| USED.contains(it)) {
            return Some(CONDITIONAL);
        }
        if BE.contains(&verb) || SEEMING.contains(&verb) || verb == "have" || verb == "has" {
            let judgement = rest
                .split(|it| words!("to that for by from on in").contains(it))
                .next()
                .unwrap_or_default();
            let denied = |at: usize| {
                judgement[at.saturating_sub(3)..at]
                    .iter()
                    .any(|it| DIMINISHING.contains(it))
            };
            let is_doubt = judgement.iter().enumerate().any(|(at, it)| {
                let next = rest.get(at + 1).copied().unwrap_or_default();
                let is_near = rest
                    .iter()
                    .skip(at + 1)
                    .any(|it| words!("pixel pixels few little couple small bit hair").contains(it));
                // `off by a pixel`, `read off the grid`
                let is_slight = *it == "off"
                    && (next == "by" && is_near
                        || at > 0 && matches!(rest[at - 1], "read" | "taken"));
                let is_weak = is_it && WEAK_DOUBTS.contains(it);
                DOUBTS.contains(it) && !(denied(at) || is_slight || is_weak)
            });
            if is_doubt && !denies {
                return Some(DOUBTED);
            }
            let trusts = judgement.iter().any(|it| TRUSTED.contains(it));
            if trusts && denies && !is_it {
                return Some(DOUBTED);
            }
            let revised = rest.first().is_some_and(|it| REVISED.contains(it));
            if revised && !denies && modal.is_some_and(|it| DUTIES.contains(&it)) && !is_it {
                return Some(CHANGED);
            }
            // `These are the ends of the crease left by the previous fold`
            let is_mark = |at: &usize| {
                let marks = words!("crease creases wrinkle wrinkles pleat pleats");
                let participle = words!("left from").contains(&rest[*at]);
                *at > 0 && participle && marks.contains(&rest[at - 1])
            };
            let from = rest.iter().position(|it| ORIGINATING.contains(it));
            let from = from.filter(|at| !is_mark(at));
            if from.is_some_and(|at| rest[at..].iter().take(6).any(|it| ELSEWHERE.contains(it)))
                && !denies
                && !is_it
            {
                return Some(DOUBTED);
            }
            return self.is_unknown(rest).then_some(DOUBTED);
        }
        // `This corresponds to the third picture of the demonstration`
        let is_shown = verb.starts_with("correspond") && has(SHOWN);
        if ORIGINATING.contains(&verb) && has(ELSEWHERE) && !denies && !is_shown {
            return Some(DOUBTED);
        }
        if DEMANDING.contains(&verb)
            && (has(DEMANDED) || (has(REVISED) && rest.first() == Some(&"to")))
            && !denies
            && !has(&["no"])
            && !is_it
        {
            return Some(CHANGED);
        }
        let is_effect = EFFECTS.iter().any(|stem| verb.starts_with(stem));
        // `This should not disturb the flaps`
        let is_spared = denies && is_unwanted(verb);
        (self.is_plain_reference() && !is_effect && !is_spared).then_some(DOUBTED)
    }

    /// Returns whether the subject can be nothing but the answer, and a verb must follow it.
    fn is_plain_reference(&self) -> bool {
        let named = self.named();
        let next = self.predicate.get(1).copied().unwrap_or_default();
        let is_noun = next.ends_with('s')
            || next.ends_with("ed")
            || BE.contains(&next)
            || MODALS.contains(&next);
        self.prose == Prose::Remark
            && self.place != Place::Before
            && !self.is_explaining()
            && match named {
                [] => false,
                ["this"] => !is_noun,
                ["these" | "both" | "all" | "each"] => {
                    !is_noun && !self.predicate.first().is_some_and(|it| it.ends_with('s'))
                }
                [
                    ..,
                    "x" | "y" | "line" | "lines" | "fold" | "corner" | "it" | "that" | "they"
                    | "those" | "one" | "half",
                ] => false,
                _ => true,
            }
    }

    /// Returns whether a judgement of the answer is none that is known to be harmless: `is a lie`.
    fn is_unknown(&self, judgement: &[&str]) -> bool {
        let excessive = judgement.iter().take(4).any(|it| *it == "too");
        let is_word = judgement.len() == 1
            && self
                .named()
                .last()
                .is_some_and(|it| words!("grip direction distance angle").contains(it));
        let is_fit = is_word
            || judgement.iter().take(8).any(|it| {
                FIT.contains(it)
                    || it.ends_with("ing")
                    || it.ends_with("ed") && !DOUBTS.contains(it)
                    || it.ends_with("est")
                    || it.starts_with(|it: char| it.is_ascii_digit() || it == '@' || !it.is_ascii())
            });
        // Without a subject, the first word counts.
        let noun = self.named().len().saturating_sub(1);
        self.is_plain_reference()
            && !matches!(self.words.get(noun), Some(&"x" | &"y"))
            && (judgement.len() > 1 || excessive)
            && (excessive || !is_fit)
    }

    /// `I doubt it`, `I am not sure`, `I have no idea`, `I would not trust it`, `I'd rather wait`
    fn confesses(&self) -> Option<&'static str> {
        let Predicate {
            denies,
            modal,
            head,
            rest,
        } = Predicate::of(self.predicate);
        if self.words[0] == "we"
            && let Some(why) = self.directs()
        {
            return Some(why);
        }
        let verb = head?;
        let refers = refers(rest);
        let first = rest.first().copied().unwrap_or_default();
        if BE.contains(&verb) || verb == "feel" || verb == "felt" {
            let would_feel =
                modal == Some("would") && !BE.contains(&verb) && self.place == Place::After;
            if would_feel {
                return Some(OTHERWISE);
            }
            let feels = rest.iter().take(4).any(|it| AUTHOR_FEELINGS.contains(it));
            let trusts = rest.iter().take(3).any(|it| TRUSTED.contains(it));
            let weighs = self.place == Place::Before || self.is_explaining();
            let recants = denies && !rest.first().is_some_and(|it| it.ends_with("ing"));
            let is_other = recants && self.place == Place::After
                || BE.contains(&verb)
                    && self.words[0] == "i"
                    && self.place == Place::After
                    && !rest.iter().take(3).any(|it| {
                        COMPOSED.contains(it) || it.ends_with("ing") || it.ends_with("ed")
                    });
            return ((feels && !denies || trusts && denies || is_other && self.is_remark())
                && !weighs)
                .then_some(DOUBTED);
        }
        if AUTHOR_DOUBTS.contains(&verb) && !denies {
            let is_free =
                words!(
                    "apologise apologize suspect worry fear question misplaced object mixed misread misjudged mistyped erred
                    confused transposed"
                )
                    .contains(&verb)
                    && self.place == Place::Before
                    && !refers_forward(rest)
                    || words!("admit concede wonder worry fear suspect").contains(&verb)
                        && !self.is_remark();
            return (!is_free).then_some(DOUBTED);
        }
        let is_aware = words!("know see mean use say count").contains(&verb) && !self.is_remark();
        if COMMITTING.contains(&verb)
            && denies
            && !is_aware
            && (refers || rest.is_empty() || matches!(first, "for" | "by" | "behind"))
        {
            return Some(DOUBTED);
        }
        let denies_sight = self.is_remark()
            && denies
            && words!("tell find see locate identify determine recognise recognize know measure say verify check make judge pinpoint").contains(&verb)
            && self.place != Place::Before
            && (rest.is_empty()
                || rest.iter().take(3).any(|it| {
                    words!("corner cloth which whether where what exactly much clearly anything it this these point").contains(it)
                }))
            && !rest.iter().any(|it| {
                words!("better other wrinkle any more need reason").contains(it)
            });
        if denies_sight {
            return Some(DOUBTED);
        }
        let crossed = words!("mirrored swapped switched flipped exchanged inverted")
            .contains(&verb)
            && (words!("left right x y them both pick place").contains(&first)
                || rest
                    .iter()
                    .any(|it| words!("pairs points values coordinates").contains(it)));
        if crossed && !denies && self.place == Place::After {
            return Some(CHANGED);
        }
        let instead = self.place == Place::Beside
            && modal == Some("would")
            && self.words.last() == Some(&"instead");
        if instead {
            return Some(OTHERWISE);
        }
        if self.place != Place::After {
            return None;
        }
        let slight = self
            .predicate
            .first()
            .is_some_and(|it| words!("only just merely simply").contains(it));
        let object = rest
            .iter()
            .take(3)
            .any(|it| matches!(*it, "this" | "these"));
        if self.is_remark()
            && object
            && (slight || !AUTHORED.contains(&verb) && modal.is_none())
            && !self.is_explaining()
            && !denies
        {
            return Some(DOUBTED);
        }
        let would = modal.is_some_and(|it| it == "would");
        // `I would rather not pinch hard`
        let tempers = rest.first() == Some(&"not")
            && rest.last().is_some_and(|it| {
                words!("hard harder far farther further more fast faster firmly").contains(it)
            });
        if would
            && !tempers
            && !rest.contains(&"@")
            && (PREFERRING.contains(&verb) || self.is_remark() && !POLITE.contains(&verb))
            && !self.is_sequel
            && !self.is_explaining()
            && !denies
        {
            return Some(OTHERWISE);
        }
        None
    }

    /// `Sorry to say this does not solve it`
    fn embeds(&self) -> Option<&'static str> {
        let speaks = matches!(self.subject, Subject::Author | Subject::Nobody)
            || matches!(self.words[0], "to" | "there");
        if !speaks || self.place == Place::Before {
            return None;
        }
        let begins = |at: usize| {
            let named = matches!(self.words[at], "this" | "these" | "those")
                || ARTICLES.contains(&self.words[at]) && PARTS.contains(&self.words[at + 1]);
            let verb = at + 1 + usize::from(ARTICLES.contains(&self.words[at]));
            named && self.words.get(verb).is_some_and(|it| is_verb(it))
        };
        let at = (1..self.words.len().saturating_sub(1)).find(|at| begins(*at))?;
        let clause = Clause::new(
            &self.words[at..],
            self.joint,
            (self.place, self.prose),
            self.is_sequel,
        );
        (clause.subject == Subject::Answer).then(|| clause.judges_answer())?
    }

    /// `Nothing should be moved`
    fn rests(&self) -> Option<&'static str> {
        // `Nothing has been folded` is no duty.
        let is_perfect =
            matches!(self.predicate, ["has" | "have" | "had", next, ..] if *next != "to");
        let duty = self.predicate.first().is_some_and(|it| DUTIES.contains(it)) && !is_perfect;
        let other = self
            .words
            .iter()
            .take(3)
            .any(|it| words!("else other more further").contains(it));
        let left = self
            .words
            .iter()
            .any(|it| words!("remains remaining left").contains(it))
            && self.words.contains(&"nothing");
        let idle = left
            || self
                .words
                .windows(2)
                .any(|pair| matches!(pair, ["to", "do" | "fold" | "move"]));
        let needless = self.words[0] == "no"
            && self
                .words
                .get(1)
                .is_some_and(|it| words!("pull move fold action grasp pick motion").contains(it))
            && self
                .words
                .iter()
                .any(|it| words!("needed required necessary").contains(it));
        (needless && !other
            || self.words.contains(&"nothing") && (duty || idle) && !other && !self.is_sequel)
            .then_some(HALTED)
    }

    /// `You had better not use this`, `The robot should stay where it is`
    fn directs(&self) -> Option<&'static str> {
        if self.is_explaining() || self.is_sequel {
            return None;
        }
        let Predicate {
            denies,
            modal,
            head,
            rest,
        } = Predicate::of(self.predicate);
        let verb = head?;
        let denies = denies || self.is_none;
        if modal.is_none_or(|it| words!("do does did have has").contains(&it)) {
            return None;
        }
        if denies {
            let is_whole = rest.is_empty()
                || refers(rest)
                || rest
                    .iter()
                    .any(|it| words!("yet now anything today").contains(it));
            return (ACTS.contains(&verb)
                && is_whole
                && !modal.is_some_and(|it| words!("will would need can").contains(&it)))
            .then_some(HALTED);
        }
        let may = modal.is_some_and(|it| it != "will");
        let rests = words!("rest stay sit remain idle park stand").contains(&verb)
            && !matches!(self.words[0], "you")
            && !rest.first().is_some_and(|it| WAYS.contains(it));
        if may && (HALTS.contains(&verb) || rests) {
            return Some(HALTED);
        }
        None
    }

    /// `A human should look at this`, `until the operator nods`
    fn defers(&self) -> Option<&'static str> {
        let modal = (0..self.predicate.len().min(3)).any(|at| {
            let it = self.predicate[at];
            // `somebody had pushed it` is no duty.
            let is_perfect = matches!(it, "has" | "have" | "had")
                && self.predicate.get(at + 1).is_none_or(|next| *next != "to");
            DUTIES.contains(&it) && !is_perfect
                || self.place == Place::After && SUPPOSING.contains(&it)
        });
        let waits = words!("until unless before once").contains(&self.joint);
        let like = self.words.iter().any(|it| matches!(*it, "like" | "as"));
        ((waits || modal && !self.is_none) && !like).then_some(HALTED)
    }

    /// `Wait`, `Disregard this`, `Do not let the arm act on it`
    pub(super) fn orders(&self, words: &[&str]) -> Option<&'static str> {
        if self.is_explaining() {
            return None;
        }
        let first = *words.first()?;
        let rest = &words[1..];
        let next = rest.first().copied().unwrap_or_default();
        let forbids = first == "never" || (first == "do" && next == "not");
        if forbids {
            let rest = if first == "do" { &rest[1..] } else { rest };
            let verb = rest.first().copied().unwrap_or_default();
            let object = rest.get(1..).unwrap_or_default();
            let lets = words!("let allow have make").contains(&verb)
                && object.iter().any(|it| AGENTS.contains(it));
            let is_whole = object.is_empty()
                || refers(object)
                || object
                    .iter()
                    .any(|it| words!("yet anything today now all").contains(it));
            let executes = self.place != Place::Before && EXECUTING.contains(&verb);
            let is_order = lets
                || executes
                || ACTS.contains(&verb)
                || DISMISSALS.contains(&verb)
                    && !words!("change discard ignore forget").contains(&verb);
            return (is_order
                && (is_whole || executes)
                && !CALMING.contains(&verb)
                && !self.is_sequel
                || lets)
                .then_some(HALTED);
        }
        if self.place == Place::Before && !refers_forward(rest) {
            return None;
        }
        let is_halt = HALTS.contains(&first) && self.joint.is_empty();
        if self.is_sequel && !is_halt {
            return None;
        }
        if HALTS.contains(&first)
            && !words!("at short before just when in once where over").contains(&next)
        {
            return Some(HALTED);
        }
        let is_refused = first == "not" && next == "to" && rest.iter().any(|it| USED.contains(it));
        if is_refused || first == "do" && words!("as with what whatever nothing").contains(&next) {
            return Some(HALTED);
        }
        let whole = words!("it this that everything things them be").contains(&next)
            || rest.iter().take(2).any(|it| {
                words!("cloth fabric garment towel shirt textile arm robot gripper").contains(it)
            });
        if matches!(first, "leave" | "let" | "keep")
            && whole
            && rest.iter().skip(1).any(|it| {
                words!("alone lie be as settle rest dry untouched cool parked still where")
                    .contains(it)
            })
            // `Let the gripper open only after the tip has come to rest`
            && !rest.iter().any(|it| words!("open close release").contains(it))
        {
            return Some(HALTED);
        }
        if DISMISSALS.contains(&first) {
            let object_refers = rest.iter().take(4).position(|it| {
                PRONOUNS.contains(it)
                    || words!("above below following everything answer values numbers coordinates line lines both all")
                        .contains(it)
            });
            let harmless = HARMLESS_ORDERS.contains(&first)
                && !rest.iter().any(|it| {
                    words!("salt first as before guess lightly loosely").contains(it)
                        || DOUBTS.contains(it)
                });
            if (object_refers.is_some() || rest.is_empty()) && !harmless {
                return Some(CHANGED);
            }
        }
        if matches!(first, "rather" | "preferably")
            && self.place != Place::Before
            && !matches!(next, "" | "than" | "a" | "the" | "large" | "small")
            && !next.ends_with("ing")
        {
            return Some(OTHERWISE);
        }
        let is_act = |it: &str| {
            ACTS.contains(&it)
                || HALTS.contains(&it)
                || DISMISSALS.contains(&it)
                || words!("to not if let leave stay").contains(&it)
        };
        if words!("better best safest safer wiser wisest smarter").contains(&first)
            && is_act(next)
            && self.place == Place::After
        {
            return Some(OTHERWISE);
        }
        let use_that = words!("use take do pick try choose").contains(&first)
            && matches!(next, "that" | "those")
            && rest.len() == 1;
        if use_that {
            return Some(OTHERWISE);
        }
        let slowly = rest
            .iter()
            .any(|it| it.ends_with("ly") || matches!(*it, "slow"));
        let makes = words!("move shift nudge slide").contains(&first)
            && words!("it them both").contains(&next)
            && rest.len() > 1
            && !slowly
            || first == "make" && words!("it this that them both these").contains(&next)
            || first == "make" && next == "the" && rest.get(1).is_some_and(|it| PARTS.contains(it));
        if makes && self.place == Place::After && self.joint != "and" {
            return Some(CHANGED);
        }
        None
    }

    /// `a wild guess`, `not a real answer`
    pub(super) fn labels(&self) -> Option<&'static str> {
        if self.is_explaining() {
            return None;
        }
        let mut denies = false;
        for (at, word) in self.words.iter().enumerate().take(5) {
            if NEGATIONS.contains(word) {
                denies = true;
            } else if DOUBTS.contains(word) && !denies && !WEAK_DOUBTS.contains(word) {
                return Some(DOUBTED);
            } else if TRUSTED.contains(word) && denies {
                return (self.place != Place::Before).then_some(DOUBTED);
            } else if ORIGINATING.contains(word)
                && at < 2
                && !denies
                && !matches!(*word, "from" | "for")
            {
                let other = self.words[at..]
                    .iter()
                    .take(6)
                    .any(|it| ELSEWHERE.contains(it));
                return (other && self.place != Place::Before).then_some(DOUBTED);
            } else if !(ARTICLES.contains(word)
                || word.ends_with("ly")
                || words!("just wild pure rough complete total very quite some somewhat rather best educated bit of really here is are this all only be been too").contains(word))
            {
                return None;
            }
        }
        None
    }

    /// `Could be anywhere`, `would need a closer look`
    fn elides(&self) -> Option<&'static str> {
        let is_elided =
            MODALS.contains(&self.words[0]) && self.words[0] != "do" || BE.contains(&self.words[0]);
        (is_elided && !self.is_explaining() && self.place != Place::Before)
            .then(|| self.judges_answer())?
    }
}

/// What a clause says of its subject.
pub(super) struct Predicate<'a> {
    pub(super) denies: bool,
    pub(super) modal: Option<&'a str>,
    /// Its main verb, or `be`.
    pub(super) head: Option<&'a str>,
    pub(super) rest: &'a [&'a str],
}

impl<'a> Predicate<'a> {
    pub(super) fn of(words: &'a [&'a str]) -> Predicate<'a> {
        let mut denies = false;
        let mut modal = None;
        let mut head = None;
        let mut perfect = None;
        let mut at = 0;
        while let Some(word) = words.get(at) {
            if words!("not never hardly barely scarcely neither nor").contains(word) {
                denies = !denies;
            } else if matches!(*word, "have" | "has" | "had")
                && words.get(at + 1).is_none_or(|it| *it != "to")
                && modal.is_none()
            {
                perfect = Some(*word);
            } else if MODALS.contains(word) && head.is_none() {
                modal = Some(
                    modal
                        .filter(|it: &&str| *it == "would" || DUTIES.contains(it))
                        .unwrap_or(*word),
                );
            } else if BE.contains(word) {
                head = Some(*word);
            } else if !(word.ends_with("ly")
                || words!("to also just now really still all both only then therefore each even well rather sooner much quite very so indeed").contains(word))
                || DOUBTS.contains(word)
            {
                break;
            }
            // `I would rather`
            if matches!(*word, "rather" | "sooner") && modal == Some("would") && head.is_none() {
                head = Some(*word);
                at += 1;
                break;
            }
            at += 1;
        }
        if head.is_none() {
            // `It has doubts`: what looked like an auxiliary is the verb.
            let has = perfect.or(modal.filter(|it| words!("have has had need needs").contains(it)));
            let is_participle = words.get(at).is_some_and(|it| {
                it.ends_with("ed") || it.ends_with('t') || it.ends_with("n") || it.ends_with("d")
            });
            match has {
                Some(verb) if !is_participle && !words[..at].contains(&"to") => head = Some(verb),
                _ => {
                    head = words.get(at).copied();
                    at += usize::from(head.is_some());
                }
            }
        }
        Predicate {
            denies,
            modal,
            head,
            rest: &words[at.min(words.len())..],
        }
    }
}

fn is_duty(modal: Option<&str>) -> bool {
    modal.is_some_and(|it| DUTIES.contains(&it))
}

/// Returns whether words name the answer: `this`, `the above`, `my answer`, `these numbers`.
fn refers(words: &[&str]) -> bool {
    words.iter().enumerate().any(|(at, it)| {
        let next = words.get(at + 1).copied().unwrap_or_default();
        match *it {
            "it" | "them" | "these" | "those" => true,
            "this" | "that" => {
                next.is_empty()
                    || PARTS.contains(&next)
                    || words!("one instead yet now before at as for on to way corner")
                        .contains(&next)
            }
            "either" => next == "point" || next == "of",
            "above" => at > 0 && matches!(words[at - 1], "the" | "all"),
            "answer" | "answers" | "values" | "numbers" | "coordinates" | "pixels" => true,
            _ => false,
        }
    })
}

/// Returns whether words name what follows them: `the following`, `what comes next`.
pub(super) fn refers_forward(words: &[&str]) -> bool {
    words.iter().any(|it| {
        words!(
            "following follows below here next comes values numbers coordinates pixels answer lines"
        )
        .contains(it)
    })
}

/// Returns whether a word may begin an order.
pub(super) fn orders(word: &str) -> bool {
    [HALTS, DISMISSALS, ACTS, MODALS, NEGATIONS]
        .iter()
        .any(|table| table.contains(&word))
        || words!("let leave keep only better best rather ask pretend feel send show give")
            .contains(&word)
}

/// Returns whether a word is a form of `be`, a modal verb, or one for how something seems.
fn is_verb(word: &str) -> bool {
    [BE, MODALS, SEEMING]
        .iter()
        .any(|table| table.contains(&word))
}

/// Returns whom a clause speaks of, and how many words name them.
pub(super) fn subject(words: &[&str]) -> (Subject, usize) {
    let word = |at: usize| words.get(at).copied().unwrap_or_default();
    match word(0) {
        "i" => return (Subject::Author, 1),
        "we" => return (Subject::Author, 1),
        "you" => return (Subject::Agent, 1),
        "nobody" => return (Subject::Agent, 0),
        it if PEOPLE.contains(&it) => return (Subject::Person, 1),
        "below" | "here" | "above" if BE.contains(&word(1)) => return (Subject::Answer, 1),
        "what"
            if matches!(word(1), "i" | "we")
                && words.iter().take(5).any(|it| {
                    words!("think want mean meant would recommend suggest prefer").contains(it)
                }) =>
        {
            return (Subject::Nobody, 0);
        }
        "what" | "whatever" => {
            let tells = |it: &&str| words!("i follows comes stands above below").contains(it);
            if words.iter().skip(1).take(2).any(tells) {
                let verb = words
                    .iter()
                    .skip(2)
                    .position(|it| BE.contains(it) || MODALS.contains(it));
                return (Subject::Answer, verb.map_or(words.len(), |at| at + 2));
            }
            return (Subject::World, 1);
        }
        _ => {}
    }
    // `The corner I gave`, `the pick point I gave above`
    if ARTICLES.contains(&word(0))
        && let Some(at) = (2..4).find(|at| word(*at) == "i")
        && words!("gave wrote named said chose picked stated listed").contains(&word(at + 1))
    {
        return (
            Subject::Answer,
            at + 2 + usize::from(word(at + 2) == "above"),
        );
    }
    if QUANTIFIERS.contains(&word(0)) && word(1) == "i" && words.len() > 3 {
        return (Subject::Answer, 3);
    }
    if word(0) == "this" && word(1) == "way" {
        return (Subject::World, 2);
    }
    let mut at = 0;
    if matches!(
        (word(0), word(1)),
        ("every", "one") | ("each", "one") | ("every", "single")
    ) {
        at += 1 + usize::from(word(2) == "one");
    }
    if QUANTIFIERS.contains(&word(at)) || (word(0) == "not" && word(1) == "one") {
        at += 1;
        if word(at) == "of" {
            at += 1;
        } else if is_verb(word(at)) || word(0) == "both" && !PARTS.contains(&word(at)) {
            let counts = !words!("nothing everything anything one half some").contains(&word(0));
            return (
                if counts {
                    Subject::Answer
                } else {
                    Subject::World
                },
                at,
            );
        }
    }
    if PRONOUNS.contains(&word(at)) {
        let demonstrative = words!("this that these those").contains(&word(at));
        at += 1;
        if demonstrative {
            let noun = (at..at + 3).find(|it| PARTS.contains(&word(*it)) || word(*it) == "corner");
            let all_qualify = noun.is_some_and(|noun| {
                (at..noun).all(|it| QUALIFIERS.contains(&word(it)) || PARTS.contains(&word(it)))
            });
            if let (Some(noun), true) = (noun, all_qualify) {
                return (Subject::Answer, noun + 1);
            }
        }
        return (Subject::Answer, at);
    }
    // `Executing it`
    if word(0).ends_with("ing")
        && words!("it this that these them").contains(&word(1))
        && (is_verb(word(2)) || is_verb(word(3)))
    {
        return (Subject::Answer, 2);
    }
    if word(0) == "such" && word(1) == "a" && PARTS.contains(&word(2)) {
        return (Subject::Answer, 3);
    }
    let begins = at;
    if ARTICLES.contains(&word(at)) {
        at += 1;
    }
    let is_named = at > begins;
    if is_named && words!("chosen selected picked proposed").contains(&word(at)) {
        return (Subject::Answer, at + 2);
    }
    if is_named && words!("below above").contains(&word(at + 1)) {
        return (Subject::Answer, at + 2);
    }
    for index in at..at + 4 {
        let it = word(index);
        if is_named && PEOPLE.contains(&it) {
            return (Subject::Person, index + 1);
        }
        if is_named && AGENTS.contains(&it) && !matches!(words[begins], "a" | "an") {
            return (Subject::Agent, index + 1);
        }
        if is_named && index > at && matches!(it, "above" | "below") {
            return (Subject::Answer, index + 1);
        }
        let ends_name = is_verb(word(index + 1))
            || word(index + 1).ends_with('s')
            || word(index + 1).ends_with("ly")
            || words!("not came never both").contains(&word(index + 1));
        let counts = words!("two three following lines line").contains(&it);
        if PARTS.contains(&it)
            && (!counts || is_verb(word(index + 1)))
            && !PARTS.contains(&word(index + 1))
            && word(index + 1) != "of"
            && (is_named && ends_name
                || is_verb(word(index + 1))
                || words!("lies falls lands below above").contains(&word(index + 1)))
        {
            let is_placed = matches!(word(index + 1), "below" | "above");
            return (Subject::Answer, index + 1 + usize::from(is_placed));
        }
        if !(QUALIFIERS.contains(&it) || PARTS.contains(&it) || it == "and") {
            break;
        }
    }
    let has_verb = words.iter().skip(1).take(7).any(|it| is_verb(it));
    if is_named || begins > 0 || (has_verb && !orders(word(0))) {
        (Subject::World, at.max(1).min(words.len()))
    } else {
        (Subject::Nobody, 0)
    }
}
