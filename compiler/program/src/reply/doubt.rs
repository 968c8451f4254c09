//! Finds sentences after the values that put the answer in doubt.
//!
//! In: a sentence behind the last value. Out: whether it may change what the values mean. What a model says of itself
//! and of its answer is a closed world: `I chose`, `this brings`, `the distance keeps`. Any other verb is doubt, in
//! whatever words. What is said of the cloth and the robot is free.

use super::lexer::{Gap, Kind, Token};
use super::wordlist::words;

/// What refers to the answer or to one of its values.
const REFERRING: &[&str] = words!("this that it these those they them both");

/// What names the answer or a part of it.
const PARTS: &[&str] = words!(
    "answer answers values value numbers point points coordinates pick place direction distance grip angle action
    lines"
);

/// What a model may have done with its answer without changing it.
const HARMLESS_DEEDS: &[&str] = words!(
    "adjust agree answer answered anticipate assume assumed avoid avoided based be believe change check checked
    choose chose chosen confirm confirmed consider considered continue decided did do double estimate estimated
    expect expected find fold folded followed found give go grab grabbed grasp guide have help hope hoped ignore
    ignored interpret interpreted judge keep kept know lay leave left let lift limit lower made make measured move
    moved need note pick picked place placed plan prefer preferred propose proposed provide pull put read recommend
    recommended repeat see select selected send set settled shift shorten skipped start stay stayed suggest suggested take
    target targeted think took tried trust try understand use used verified verify want went will work"
);

/// How sure a model may be.
const SURE: &[&str] = words!(
    "absolutely also aiming assuming certain confident fairly folding following glad going happy highly keeping
    moving moderately picking placing pretty pulling quite ready reasonably sure taking using very"
);

const AUXILIARY: &[&str] = words!(
    "am are was were can can't cannot could couldn't did didn't do don't had have haven't may might not shall should will won't
    would wouldn't"
);

/// What may be asked for without changing the answer, and what is no request.
const HARMLESS_REQUESTS: &[&str] = words!(
    "a about above all each every my your our its no after afterwards and any apply as at because before both bring
    but by calibrate can carry check confirm convert could did do does drag drop during ensure execute expect
    expected explanation final fold for from given grab grasp guide hold hope how i if in into is it keep lay let
    lift like lower make may means might move no not note of on once onto or over perform pick place press pull put
    reason release remember repeat result run see send shall should since slide smooth so than that the then these
    they this those though to try under until was we were what when where whether which while why will with within
    would you yes"
);

/// What tells that the answer is not as it should be.
const LACKING: &[&str] = words!(
    "got must mustn't shouldn't shouldn’t need needs ought require requires want wants belong refer"
);

/// What may stand before an order.
const JOINING: &[&str] = words!("please kindly and so but then just");

/// What an order to leave the action begins with.
const HALTING: &[&str] = words!("stop halt abort cancel skip discard delete better instead");

/// What values may do: `They lie on the cloth`.
const THEY: &[&str] = words!(
    "agree allow are bring can coincide come correspond cover define do end fall fold follow form give have keep lead
    leave lie make match may meet might mark move overlap point put reach show should sit stay use were will"
);

/// What a robot may be unable to do with the answer.
const REACHING: &[&str] =
    words!("reach get go grip grasp grab execute executed perform carry carried run do move");

/// What it must not be.
const UNFIT: &[&str] =
    words!("arbitrary fictional fictitious invalid invented made mistaken off random too wrong");

/// What takes back or regrets, in languages that models drift into.
const REGRETS: &[&str] = words!(
    "alas apologies oops regrettably sadly sorry unfortunately whoops falsch verwechselt vertauscht vertan nein
    stimmt entschuldigung perdón equivoqué equivocado erreur désolé trompé inversé sbagliato scusa scusate invertita
    invertito invertida invertido errado errei desculpe"
);

/// The same, in languages without blanks between words.
const REGRETS_WITHIN: [&str; 7] = ["不对", "错", "等等", "間違", "违", "違", "잘못"];

/// What begins a sentence that objects to what stands before it: `However, …`, `Come to think of it, …`.
const CONTRASTING: &[&str] =
    words!("but however yet except unless nevertheless nonetheless whereas come");

const AGAIN: &[&str] = words!("again closer closely second twice");
const LOOK: &[&str] = words!("look looked looking view viewing glance inspection thought");

/// What says that a second look changed nothing.
const CONFIRMING: &[&str] = words!(
    "also unchanged stays same confirm confirms confirmed confirming correct fine consistent agrees matches okay"
);

/// Returns whether a sentence behind the values may change what they mean.
pub(super) fn is_cast_by(sentence: &[Token<'_>]) -> bool {
    let says = |words: &[&str]| sentence.iter().any(|token| token.is_any(words));
    let regrets = sentence
        .iter()
        .any(|token| REGRETS_WITHIN.iter().any(|it| token.text.contains(it)));
    let thinks_again = sentence.len() > 1 && sentence[0].is("then") && sentence[1].is("again");
    if regrets || thinks_again {
        return true;
    }
    if says(CONFIRMING) || says(&["if"]) {
        return false;
    }
    let contrasts = sentence[0].is_any(CONTRASTING)
        || sentence.windows(3).any(|near| {
            matches!(near[0].kind, Kind::Sign(_))
                && near[1].is("though")
                && matches!(near[2].kind, Kind::Sign(_))
        });
    let looks_again = sentence.windows(3).any(|near| {
        near.iter().any(|it| it.is_any(LOOK)) && near.iter().any(|it| it.is_any(AGAIN))
    });
    contrasts
        || looks_again
        || says(REGRETS)
        || sentence
            .split(|token| matches!(token.kind, Kind::Sign(_)))
            .any(|clause| {
                halts(clause) || confesses(clause) || asks_for_change(clause) || lacks(clause)
            })
}

const ADVERBS: &[&str] = words!("also just then now only therefore still first");

fn is_adverb(token: &Token<'_>) -> bool {
    token.text.ends_with("ly") || token.is_any(ADVERBS)
}

/// `Stop`, `You had better skip this`, `They stand in for the real ones`, `further left than stated`
fn halts(clause: &[Token<'_>]) -> bool {
    let is_pair = |pair: &[Token<'_>]| {
        (pair[0].is("you") && pair[1].is_any(&["had", "must", "should", "need", "ought"]))
            || (pair[0].is("than")
                && pair[1].is_any(&["stated", "given", "written", "said", "listed", "above", "i"]))
    };
    let says_pair = clause.windows(2).any(is_pair);
    // `go gentler`
    let compares = clause.windows(2).any(|pair| {
        pair[0].is("go")
            && pair[1].text.ends_with("er")
            && !pair[1].is_any(&["over", "under", "after"])
    });
    let mut words = clause.iter().skip_while(|it| it.is_any(JOINING));
    let first = words.next();
    let they = first.is_some_and(|it| it.is("they"))
        && words
            .find(|it| !is_adverb(it))
            .is_some_and(|it| !it.is_any(THEY));
    says_pair || compares || they || first.is_some_and(|it| it.is_any(HALTING))
}

/// `I counted y upwards`, `I got those two the wrong way round`
fn confesses(clause: &[Token<'_>]) -> bool {
    (0..clause.len()).any(|at| {
        let pronoun = clause[at].text.to_ascii_lowercase().replace('’', "'");
        let (who, short) = pronoun.split_once('\'').unwrap_or((&pronoun, ""));
        let is_asked = at > 0 && clause[at - 1].is_any(AUXILIARY);
        if !matches!(who, "i" | "we") || is_asked {
            return false;
        }
        let mut rest = clause[at + 1..]
            .iter()
            .skip_while(|token| is_adverb(token) || token.is_any(AUXILIARY));
        let is_being = matches!(short, "m" | "re")
            || clause
                .get(at + 1)
                .is_some_and(|next| next.is_any(&["am", "are", "was", "were"]));
        match rest.next() {
            Some(verb) if is_being => !verb.is_any(SURE) && !verb.is_any(&["one", "a", "the"]),
            Some(verb) => {
                let denies = ["haven't", "haven’t", "didn't", "didn’t"];
                // `we then have a triangle`
                let is_thing = verb.is_any(&["a", "an", "the", "no", "two", "only"]);
                !verb.is_any(HARMLESS_DEEDS) && !is_thing && !clause[at + 1].is_any(&denies)
            }
            None => false,
        }
    })
}

/// `Scratch it`, `Treat the above as a guess`, `Hold off executing this`
fn asks_for_change(clause: &[Token<'_>]) -> bool {
    let mut clause = clause.iter().skip_while(|it| it.is_any(JOINING));
    let Some(verb) = clause.next() else {
        return false;
    };
    let is_forbidding = verb.is_any(&["don't", "don’t", "never"])
        || (verb.is("do") && clause.clone().next().is_some_and(|next| next.is("not")));
    if is_forbidding {
        return clause.any(|it| it.is_any(REFERRING));
    }
    let is_verb = verb.kind == Kind::Word
        && !verb.is_any(HARMLESS_REQUESTS)
        && !verb.is_any(PARTS)
        && !is_adverb(verb)
        && !["ing", "ed"].iter().any(|end| verb.text.ends_with(end))
        && (!verb.text.ends_with('s') || verb.text.ends_with("ss"));
    let mut object = clause.skip_while(|it| {
        it.is_any(&[
            "the",
            "off",
            "out",
            "up",
            "down",
            "all",
            "on",
            "executing",
            "running",
            "using",
        ])
    });
    is_verb
        && object.next().is_some_and(|it| {
            it.is_any(REFERRING) || it.is_any(&["above", "answer", "values", "lines"])
        })
}

/// `Both ought to sit lower`, `The direction needs turning`, `The arm cannot reach this spot`
fn lacks(clause: &[Token<'_>]) -> bool {
    let refers = |it: &Token<'_>| it.is_any(REFERRING) || it.is_any(PARTS);
    let mut rest = clause.iter().skip_while(|it| {
        it.is_any(JOINING) || it.is_any(&["since", "because", "the", "my"]) || is_adverb(it)
    });
    let subject = rest.next().filter(|it| refers(it));
    let is_part = subject.is_some_and(|it| it.is_any(PARTS))
        || rest.clone().next().is_some_and(|it| it.is_any(PARTS));
    let mut rest = rest
        .skip_while(|it| it.is_any(PARTS) || is_adverb(it) || it.is_any(&["two", "all", "above"]));
    let verb = subject.and_then(|_| rest.next());
    let next = rest.find(|it| !is_adverb(it));
    let is_lacking = verb.is_some_and(|verb| {
        let says = |verbs: &[&str], words: &[&str]| {
            verb.is_any(verbs) && next.is_some_and(|next| next.is_any(words))
        };
        // `it needs one hand only`
        let is_help = verb.is_any(&["needs", "requires"])
            && !is_part
            && next.is_some_and(|next| {
                !next.text.ends_with("ing") && !next.is_any(&["to", "more", "less", "another"])
            });
        (verb.is_any(LACKING) && !is_help)
            || (is_part && verb.is_any(&["would", "could"]))
            || says(&["has", "have"], &["to"])
            || (is_part && says(&["should"], &["be"]))
            || says(&["is", "are", "was", "were"], UNFIT)
    });
    let cannot = clause
        .iter()
        .position(|it| it.is_any(&["cannot", "can't", "can’t", "unable", "impossible", "fails"]));
    let reaches = |it: &Token<'_>| it.is_any(REACHING);
    is_lacking
        || cannot
            .is_some_and(|at| clause[at..].iter().any(refers) && clause[at..].iter().any(reaches))
}

/// What makes a line an introduction of what is right elsewhere, later or in somebody else's words.
const ELSEWHERE: &[&str] =
    words!("after before later if unless once until could might had were said wrote answered");

/// What an answer of another turn, or of another picture, is introduced with.
const OTHER: &[&str] = words!("last previous earlier first other former old");
const OTHERS: &[&str] = words!(
    "message answer reply response step turn picture image photo photograph frame scene cloth demonstration example"
);

/// Returns whether the line above the first value says that the values are not for this cloth, or not for now.
///
/// - `before`: the tokens above the first value.
pub(super) fn is_announced_by(before: &[Token<'_>]) -> bool {
    let ends = |token: &Token<'_>| ['.', '!', '?', ';'].iter().any(|sign| token.is_sign(*sign));
    let begin = (0..before.len())
        .rev()
        .find(|at| before[*at].gap >= Gap::Line)
        .unwrap_or(0);
    let line = &before[begin..];
    if line.last().is_none_or(ends) {
        return false;
    }
    let start = line.iter().rposition(ends).map_or(0, |end| end + 1);
    let sentence = &line[start..];
    let says = |words: &[&str]| sentence.iter().any(|token| token.is_any(words));
    let is_own = says(&["i", "we"]);
    let begins = sentence[0].is_any(&["if", "unless", "once", "until", "had", "draft"])
        && !says(&["more", "again"]);
    let is_other = |pair: &[Token<'_>]| {
        (pair[0].is_any(OTHER) && pair[1].is_any(OTHERS))
            || (pair[1].is_any(ELSEWHERE) && !sentence[0].is("as"))
            || (pair[1].is("would") && !is_own)
            || (pair[1].is("used")
                && !pair[0].is_any(&["is", "are", "convention", "format", "units"]))
    };
    begins || sentence.windows(2).any(is_other)
}
