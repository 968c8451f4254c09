//! Decides whether a sentence favours another action than the answer's.
//!
//! An answer may weigh other ways to act, and most reasons do: `a longer pull would drag the cloth`. So what is said of
//! another way must be understood as a drawback. A gain, or words that are not understood, mean that the answer is not
//! what its author would do. For the answer itself it is the other way round: a harm takes it back.

use super::vocabulary::*;
use super::{Clause, Place, Predicate, Subject};
use crate::reply::wordlist::words;

/// Conjunctions whose clauses say under which circumstances something holds, or to what it is compared.
const CIRCUMSTANCES: &[&str] =
    words!("if that who whether how until unless once when where why or whereas");

/// Conjunctions that set a drawback against a gain: `the collar would do, but it is further away`.
const CONTRASTS: &[&str] = words!("but although though however yet while whereas which");

/// What names another way to act.
const ANOTHER: &[&str] = words!(
    "other others another different alternative alternatives opposite anything instead rest"
);

/// What tells of something that may happen, or that would.
const CONCEIVED: &[&str] = words!("would could might may");

/// What shows how to act, and is no way to act itself.
const SHOWN: &[&str] = words!("arrow picture image instruction demonstration example");

/// Ways to act that are as good as the answer's.
const EQUAL: &[&str] = words!("same either equal equally equivalent alike");

/// Gains; stems.
const GAINS: &[&str] = words!(
    "better best wise sensibl prudent good great ideal optimal perfect suit proper correct safe easi easy
    clean neat tidi crisp flatter smooth flatten unfold open remov reveal uncover expos solv work help improv increas
    gain fewer effect efficien promis profit benefi win sense prefer serv fit deserv merit recommend advis reliabl
    accura more most maxim reach succe fulfil achiev satisf justif favo matter pay count faster quick simpl finish
    complet straighten sooner warrant worth"
);

/// What is said of a way that is better than the answer, unless it is compared with yet another: `easier than`.
const SUPERIOR: &[&str] = words!(
    "better safer wiser smarter easier cleaner neater tidier firmer stronger smoother flatter faster simpler nicer
    quicker sounder surer clearer"
);

/// Drawbacks, and what tells that nothing needs to be done there; stems.
const DRAWBACKS: &[&str] = words!(
    "not no never nothing none neither nor without less too only little few hardly barely cannot
    leav overshoot undershoot exceed wrong skew drag slip slid los short cover hid occlu obscur crush mark drop crease
    undo undone disturb enlarg wrinkl bunch crumpl off out outside expose harder further farther distan heavy pinch
    press gap overlap stick shift tilt rotat twist tangl push block collid pinned stuck trap beneath underneath under
    already place remain stay still untouch next later after second follow ignor considered excluded compar avoid risk
    tear tore damag flip toppl collaps wors weak smaller wast unnecess redundan needless difficult awkward ambig
    unclear blurr shrink limit miss fail doubl layer whole entire expense conflict contradict violat unreach unstable
    thick stiff center centre duplicat repeat again lift move float slight bit again time folded inward loose
    need costs inaccess back smear middle bruise overkill scratch leav strain worthless pucker waste spoil ruin wreck"
);

/// What an action does that makes it unfit; stems.
const HARMS: &[&str] =
    words!("tear tore rips ripp snag overshoot undershoot topple collaps overkill");

/// What is no part of the cloth.
const NO_CLOTH: &[&str] = words!("shadow shadows tabletop background reflection glare");

/// What is done to the place where an action begins.
const CHOSEN: &[&str] = words!(
    "picked chosen grasped grabbed gripped selected used taken pulled held tackled addressed handled flattened
    straightened smoothed unfolded opened preferred done tried dealt"
);

/// What the person who carries an answer out may do without acting otherwise.
const WATCHING: &[&str] =
    words!("see notice find expect verify check repeat want like need ask observe hear continue");

/// Parts of a cloth that an action may begin at.
const PLACES: &[&str] = words!(
    "one thing part place spot corner corners edge side sleeve hem collar cuff flap wrinkle fold layer half point"
);

/// Verbs that begin an action.
const BEGINNING: &[&str] = words!("start begin go come");

/// Motions that an answer asks for.
const MOTIONS: &[&str] = words!(
    "pull pulls pulling fold folding action actions move motion step grasp pick flattening smoothing"
);

/// Returns why the clauses of a sentence favour something else than the answer.
pub(super) fn favours_another(clauses: &[Clause<'_>]) -> Option<&'static str> {
    clauses
        .iter()
        .enumerate()
        .filter(|(_, clause)| clause.place != Place::Before && !clause.words.is_empty())
        .find_map(|(at, clause)| {
            let favours = clause.tells_of_another() && !is_drawn_back(clause, &clauses[at + 1..]);
            match () {
                () if favours || clause.points_elsewhere() => Some(super::OTHERWISE),
                () if clause.harms() => Some(super::DOUBTED),
                () if clause.is_needless() => Some(super::HALTED),
                () if clauses[..at]
                    .iter()
                    .any(|it| it.asks_for_another_side(clause)) =>
                {
                    Some(super::DOUBTED)
                }
                () => None,
            }
        })
}

/// Returns whether a drawback stands against another way to act.
fn is_drawn_back(clause: &Clause<'_>, later: &[Clause<'_>]) -> bool {
    // `The cuff is easier to grasp than the elbow`
    let compares = clause.words.iter().any(|it| SUPERIOR.contains(it));
    if compares
        && later
            .first()
            .is_some_and(|it| it.joint == "than" && it.subject != Subject::Answer)
    {
        return true;
    }
    let is_equal = |it: &Clause<'_>| it.words.iter().any(|it| EQUAL.contains(it));
    if is_equal(clause) || later.iter().any(is_equal) {
        return true;
    }
    let gains = gains(clause.words);
    let is_drawback = says(clause.words, DRAWBACKS)
        || clause.words.last() == Some(&"more")
        || clause.words.contains(&"@");
    if !gains && is_drawback {
        return true;
    }
    later.iter().any(|it| {
        let contrasts = CONTRASTS.contains(&it.joint);
        let speaks_of_it = !matches!(it.words.first(), None | Some(&"this" | &"these" | &"i"));
        let tells_why = contrasts
            || words!("and since because as so").contains(&it.joint)
            || it.joint.is_empty();
        let is_drawback = says(it.words, DRAWBACKS) && tells_why;
        speaks_of_it
            && if gains {
                contrasts && is_drawback
            } else {
                contrasts || is_drawback
            }
    })
}

fn says(words: &[&str], stems: &[&str]) -> bool {
    words.iter().any(|it| begins_with(it, stems))
}

fn begins_with(word: &str, stems: &[&str]) -> bool {
    stems.iter().any(|stem| {
        word.starts_with(stem) && word.len() <= stem.len() + if stem.len() > 3 { 4 } else { 1 }
    })
}

/// Returns whether words name a gain that they do not deny.
fn gains(words: &[&str]) -> bool {
    words.iter().enumerate().any(|(at, it)| {
        let denied = words[..at].contains(&"too")
            || words[..at].iter().rev().take(5).any(|it| {
                DIMINISHING.contains(it)
                    || words!("nor neither too cannot little only second").contains(it)
            });
        // `more than 200 px from the middle`
        let exceeds = *it == "more" && at + 1 == words.len();
        begins_with(it, GAINS) && !denied && !exceeds
    })
}

impl Clause<'_> {
    /// Returns whether the clause tells of another way to act: `the collar would`, `the other corner`.
    fn tells_of_another(&self) -> bool {
        let words = self.words;
        let is_told_of = match self.subject {
            Subject::World | Subject::Nobody => true,
            Subject::Agent => {
                matches!(words[0], "you" | "we" | "one")
                    && !words.iter().take(5).any(|it| WATCHING.contains(it))
            }
            Subject::Answer | Subject::Author | Subject::Person => false,
        };
        let conceives = words[..words.len() - 1]
            .iter()
            .any(|it| CONCEIVED.contains(it));
        if !is_told_of
            || self.is_sequel
            || CIRCUMSTANCES.contains(&self.joint)
            || self.joint == "than" && !conceives
            || words.iter().take(3).any(|it| SHOWN.contains(it))
        {
            return false;
        }
        let verb = words
            .iter()
            .position(|it| BE.contains(it) || MODALS.contains(it))
            .unwrap_or(words.len());
        let names_another = ARTICLES.contains(&words[0]) || ANOTHER.contains(&words[0]);
        let is_subject = names_another
            && verb < words.len()
            && words[..verb].iter().take(5).any(|it| ANOTHER.contains(it));
        let instead = words
            .windows(2)
            .any(|pair| pair[0] == "instead" && pair[1] != "of")
            || words.last() == Some(&"instead");
        let compares = self.subject == Subject::World
            && !words!("because since as so which").contains(&self.joint)
            && words.iter().any(|it| SUPERIOR.contains(it));
        is_subject
            || instead
            || compares
            || conceives
            || CONCEIVED.contains(&words[words.len() - 1])
    }

    /// Returns whether the clause says where an action ought to begin: `the sleeve is the one to pick`.
    fn points_elsewhere(&self) -> bool {
        let words = self.words;
        // `It is the top edge that has to go down`, `this is where the fold ought to begin`
        let is_cleft = words.starts_with(&["it", "is", "the"]) || self.joint == "where";
        let speaks_of_answer = self.subject == Subject::Answer && !is_cleft;
        if self.place != Place::After || self.is_sequel || speaks_of_answer {
            return false;
        }
        let is_one = (self.subject == Subject::World || is_cleft)
            && words.iter().enumerate().any(|(at, it)| {
                PLACES.contains(it)
                    && match words[at + 1..] {
                        ["to", verb, ..] => ACTS.contains(&verb),
                        ["that", "has", "to", ..] => true,
                        ["that", verb, ..] => {
                            words!("should must needs matters counts wants ought deserves")
                                .contains(&verb)
                        }
                        _ => false,
                    }
            })
            && words.iter().any(|it| BE.contains(it));
        let Predicate {
            modal, head, rest, ..
        } = Predicate::of(self.predicate);
        let verb = head.unwrap_or_default();
        let is_owed = (self.subject == Subject::World || self.joint == "where")
            && self.joint != "because"
            && modal.is_some_and(|it| words!("should must ought").contains(&it))
            && (BE.contains(&verb) && rest.iter().take(2).any(|it| CHOSEN.contains(it))
                || BEGINNING.contains(&verb) && !rest.is_empty());
        let next = words.get(1).copied().unwrap_or_default();
        let begins = self.subject == Subject::Nobody
            && (words!("start begin").contains(&words[0])
                && words!("with at from on").contains(&next)
                || words!("take choose use try select prefer opt go").contains(&words[0])
                    && words!("the a an that another with for").contains(&next)
                    && !words.contains(&"@"));
        // `What the shirt needs is a fold at the waist`
        let is_what = words[0] == "what"
            && words
                .iter()
                .any(|it| words!("needs wants matters helps deserves requires").contains(it))
            && words.iter().any(|it| BE.contains(it));
        let goes_first = self.subject == Subject::World
            && words.last() == Some(&"first")
            && words
                .iter()
                .any(|it| words!("goes comes moves").contains(it));
        let deserved = self.subject == Subject::World && says(words, words!("deserv merit"));
        is_one || is_owed || begins || is_what || goes_first || deserved
    }

    /// Returns whether the clause tells of a harm that the answer does, or that it misses the cloth.
    fn harms(&self) -> bool {
        let words = self.words;
        let is_here = words[0].ends_with("ing") && words.get(1) == Some(&"here");
        if !(self.subject == Subject::Answer || is_here) || self.is_sequel {
            // `The order is reversed`
            let is_crossed = words.windows(3).take(4).any(|near| {
                words!("order roles sequence").contains(&near[0])
                    && BE.contains(&near[1])
                    && words!("reversed swapped switched wrong exchanged").contains(&near[2])
            });
            // `The instruction asks for a diagonal pull, which 90 deg is not`
            return is_crossed
                || self.joint == "which" && matches!(words, [.., "is" | "are", "not"]);
        }
        let denied = |at: usize| {
            words[..at].iter().rev().take(4).any(|it| {
                DIMINISHING.contains(it) || words!("of than rather across over along").contains(it)
            })
        };
        let harms = words
            .iter()
            .enumerate()
            .any(|(at, it)| begins_with(it, HARMS) && !denied(at));
        let lies = |it: &&str| {
            words!("sit sits lie lies fall falls are is land lands hit hits").contains(it)
        };
        let misses = words.iter().any(|it| NO_CLOTH.contains(it))
            || words.windows(4).any(|near| {
                lies(&&near[0])
                    && words!("on in at").contains(&near[1])
                    && near[2..]
                        .iter()
                        .any(|it| words!("table floor").contains(it))
            });
        let Predicate { modal, head, .. } = Predicate::of(self.predicate);
        let lacks = modal.is_some_and(|it| words!("would should must").contains(&it))
            && words
                .windows(2)
                .any(|pair| matches!(pair, ["need" | "have", "to"]))
            && head.is_some_and(|it| REVISED.contains(&it) || it == "move");
        harms || misses || lacks
    }

    /// Returns whether a later clause says that the answer takes another side than this clause says is asked for.
    fn asks_for_another_side(&self, answer: &Clause<'_>) -> bool {
        const OPPOSITES: [(&str, &str); 8] = [
            ("left", "right"),
            ("right", "left"),
            ("top", "bottom"),
            ("bottom", "top"),
            ("upper", "lower"),
            ("lower", "upper"),
            ("inside", "outside"),
            ("front", "back"),
        ];
        let is_asked = self.words.iter().take(3).any(|it| SHOWN.contains(it));
        let is_answer = matches!(
            answer.words,
            ["this" | "these" | "it" | "that", "is" | "are", ..]
        );
        is_asked
            && is_answer
            && OPPOSITES.iter().any(|(side, opposite)| {
                let says = |clause: &Clause<'_>, side: &str| clause.words.contains(&side);
                says(self, side)
                    && !says(self, opposite)
                    && says(answer, opposite)
                    && !says(answer, side)
            })
    }

    /// Returns whether the clause says that the cloth is as it should be: `the cloth needs no pull`.
    fn is_needless(&self) -> bool {
        let words = self.words;
        let more = words
            .iter()
            .any(|it| words!("more further other second additional extra").contains(it));
        !more
            && !self.is_sequel
            && words.windows(3).any(|near| {
                words!("needs need requires require").contains(&near[0])
                    && near[1] == "no"
                    && MOTIONS.contains(&near[2])
            })
    }
}
