//! Decides whether a sentence favours another action than the answer's.
//!
//! An answer may weigh other ways to act, and most reasons do: `a longer pull would drag the cloth`. So what is said of
//! another way must be understood as a drawback. A gain, or words that are not understood, mean that the answer is not
//! what its author would do. For the answer itself it is the other way round: a harm takes it back.

use super::clause::{Clause, DOUBTED, OTHERWISE, Place, Predicate, Subject, refers_forward};
use super::vocabulary::*;
use crate::reply::wordlist::words;

/// Conjunctions whose clauses say under which circumstances something holds, or to what it is compared.
const CIRCUMSTANCES: &[&str] =
    words!("if that who whether how until unless once when where why or whereas");

/// Conjunctions that set a drawback against a gain: `the collar would do, but it is further away`.
const CONTRASTS: &[&str] = words!("but although though however yet while whereas which");

/// What tells of something that may happen, or that would.
const CONCEIVED: &[&str] = words!("would could might may");

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
    need costs inaccess back smear middle beyond past keep bruise overdo overstr overkill scratch leav strain along worthless pucker waste spoil ruin wreck"
);

/// What a part of the cloth does where the answer leads; stems.
const OUTCOMES: &[&str] = words!(
    "cover lie land end match meet reach overlap point form coincid rest fall align sit stay remain touch show hang look line
    cross stick span fold"
);

/// What denies a whole clause.
const DENYING: &[&str] = words!("not no never nothing none nobody hardly barely scarcely");

/// What is no part of the cloth.
const NO_CLOTH: &[&str] = words!("shadow shadows tabletop background glare");

/// What the person who carries an answer out may do without acting otherwise.
const WATCHING: &[&str] =
    words!("see notice find expect verify check repeat want like need ask observe hear continue");

/// Returns why the clauses of a sentence favour something else than the answer.
pub(super) fn favours_another(clauses: &[Clause<'_>]) -> Option<&'static str> {
    clauses
        .iter()
        .enumerate()
        .filter(|(_, clause)| {
            !clause.words.is_empty()
                && (clause.place != Place::Before || clause.speaks_of_what_follows())
        })
        .find_map(|(at, clause)| {
            // `since any lift would let the flap spring open`
            let is_reason = words!("because since").contains(&clause.joint)
                && !clause.compares()
                && !gains(clause.words);
            let favours = clause.tells_of_another()
                && !is_reason
                && !is_drawn_back(clause, &clauses[at + 1..]);
            match () {
                () if favours => Some(OTHERWISE),
                () if clause.harms() || clause.denies_without_need() => Some(DOUBTED),
                () if clauses[..at]
                    .iter()
                    .any(|it| it.asks_for_another_side(clause)) =>
                {
                    Some(DOUBTED)
                }
                () => None,
            }
        })
}

/// Returns whether a drawback stands against another way to act.
fn is_drawn_back(clause: &Clause<'_>, later: &[Clause<'_>]) -> bool {
    // `The cuff is easier to grasp than the elbow`
    let compares = clause.compares();
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
    // `Picking anywhere else would undo a finished fold`
    if clause
        .conceived_verb()
        .is_some_and(|verb| begins_with(verb, SPOILING))
    {
        return true;
    }
    let gains = compares || gains(clause.words);
    if !gains && clause.tells_of_an_effect() {
        return true;
    }
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

fn names_another_way(words: &[&str]) -> bool {
    words
        .iter()
        .any(|it| ANOTHER.contains(it) || *it == "instead")
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
        // and `stack even more cloth` is no gain.
        let exceeds = *it == "more"
            && words.get(at + 1).is_none_or(|next| {
                CLOTHS.contains(next) || words!("layers wrinkles folds creases").contains(next)
            });
        begins_with(it, GAINS) && !denied && !exceeds
    })
}

impl Clause<'_> {
    fn speaks_of_what_follows(&self) -> bool {
        self.subject == Subject::Answer && refers_forward(self.named())
    }

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
        let is_early =
            words.len() > 3 && words[..2.min(verb)].iter().any(|it| ANOTHER.contains(it));
        let is_subject = names_another
            && (is_early
                || verb < words.len()
                    && words[..verb].iter().take(5).any(|it| ANOTHER.contains(it)));
        // `The flap would cover the pink area`
        let is_outcome = !names_another_way(words)
            && !words
                .iter()
                .any(|it| SUPERIOR.contains(it) || words!("more best first").contains(it))
            && self
                .conceived_verb()
                .is_some_and(|verb| begins_with(verb, OUTCOMES));
        let instead = words
            .windows(2)
            .any(|pair| pair[0] == "instead" && pair[1] != "of")
            || words.last() == Some(&"instead");
        is_subject
            || instead
            || self.compares()
            || conceives && !is_outcome
            || CONCEIVED.contains(&words[words.len() - 1])
    }

    /// Returns what something would do, where the clause says so.
    fn conceived_verb(&self) -> Option<&str> {
        let modal = self.words.iter().position(|it| CONCEIVED.contains(it))?;
        let mut behind = self.words[modal + 1..].iter();
        let verb = behind.find(|it| {
            !(it.ends_with("ly") || words!("also only then still even just again").contains(it))
        });
        verb.copied()
    }

    /// Returns whether the clause says what another way does to the cloth: `would give the mirror image`.
    fn tells_of_an_effect(&self) -> bool {
        let length = self.words.len();
        self.subject == Subject::World
            && self
                .conceived_verb()
                .is_some_and(|verb| !begins_with(verb, EVASIVE) && !begins_with(verb, GAINS))
            && length > 4
            || self.words.contains(&"mirror")
            || self.words.contains(&"mirrored")
    }

    /// Returns whether the clause calls something better than the answer: `the cuff is easier to grasp`.
    fn compares(&self) -> bool {
        let words = self.words;
        let acts = self.subject == Subject::Nobody
            && words[0].ends_with("ing")
            && words
                .get(1)
                .is_some_and(|it| !words!("it this here there").contains(it));
        (self.subject == Subject::World || acts)
            && !words!("because since as so which").contains(&self.joint)
            && words.iter().any(|it| SUPERIOR.contains(it))
            && !words
                .iter()
                .any(|it| CONCEIVED.contains(it) || words!("not no never nor too").contains(it))
    }

    /// Returns whether the clause tells of a harm that the answer does, or that it misses the cloth.
    fn harms(&self) -> bool {
        let words = self.words;
        let is_here = words[0].ends_with("ing") && words.get(1) == Some(&"here");
        if !(self.subject == Subject::Answer || is_here) || self.is_sequel {
            // `The instruction asks for a diagonal pull, which 90 deg is not`
            return self.joint == "which" && matches!(words, [.., "is" | "are", "not"]);
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
                lies(&near[0])
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

    /// Returns whether the clause says of the cloth what it is not: `the cloth is not centred`.
    fn describes(&self) -> bool {
        let speaks_of_answer =
            |it: &&str| words!("this these here there at pick place point for").contains(it);
        self.subject == Subject::World
            && self.words.contains(&"not")
            && (self.words.windows(3).any(|it| it == ["not", "part", "of"])
                || !self.words.iter().any(speaks_of_answer))
    }

    /// Returns whether the clause denies something that nobody would want to deny of an answer that is meant.
    fn denies_without_need(&self) -> bool {
        let words = self.words;
        // `Firm, not soft`, `why not 90 deg?`, `(1, 2) does not help`
        let is_contrast = words[0] == "not" && !words[1..].starts_with(&["much"])
            || words[0] == "why"
            || BE.contains(&words[0])
            || words.len() == 1
            || words.contains(&"@");
        let is_excused = self.is_sequel
            || is_contrast
            || CIRCUMSTANCES.contains(&self.joint)
            || words!("because since which").contains(&self.joint)
            || self.subject == Subject::Author
            || self.describes()
            || words[0].starts_with(|letter: char| letter.is_ascii_digit())
            || words.iter().take(4).any(|it| ANOTHER.contains(it))
            || words.iter().any(|it| CONCEIVED.contains(it));
        let denied = words.iter().position(|it| DENYING.contains(it));
        let exceeds = words
            .iter()
            .position(|it| *it == "too")
            .filter(|at| at + 1 < words.len());
        let harmless = |at: usize| {
            let next = words.get(at + 1).copied().unwrap_or_default();
            // `This is not the place of the last pull`
            let of_last = words
                .windows(3)
                .any(|it| matches!(it, ["of", "the", "last" | "previous"]));
            words[at + 1..].iter().any(|it| is_unwanted(it))
                || of_last
                || words!("pull push press underneath beneath under below above behind")
                    .contains(&next)
        };
        !is_excused && (denied.is_some_and(|at| !harmless(at)) || exceeds.is_some())
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
}
