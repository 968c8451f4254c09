//! Finds what an answer says about itself: that it counts in another frame, is only a sample, or is not to be carried out.
//!
//! In: the sentences of an answer, and where its last claim stands. Out: for each kind of field, why its values are not
//! those that the answer means. Each remark is a row of a table.

use super::cursor::Cursor;
use super::data::Beside;
use super::doubt::{self, Place, Prose};
use super::lexer::{self, Gap, Kind, Token};
use super::point;
use super::value;
use super::wordlist::says;
use crate::data::actions::{ActionField, Choices};
use crate::pointing::{Notation, Order};

/// What a remark is about.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum About {
    /// Points, where pixels are asked for.
    Pixels,
    Directions,
    Lengths,
    /// The whole action.
    Action,
}

impl About {
    /// Returns whether a remark about this concerns a field.
    pub fn concerns(self, field: &ActionField) -> bool {
        match self {
            About::Pixels => field.is_point(),
            About::Directions => matches!(field.choices, Choices::Directions { .. }),
            About::Lengths => matches!(field.choices, Choices::Lengths { .. }),
            About::Action => true,
        }
    }
}

use About::{Action, Directions, Lengths, Pixels};

/// A kind of remark: a sentence is one if it says a phrase of each group and none of `unless`. Phrases of a group are
/// separated by `|`; signs are words of their own.
struct Row {
    about: About,
    /// Whether only a lone remark is one; in an explanation it tells how the answer was found.
    is_lone: bool,
    /// Whether it counts only after the values; before them, it is about something else.
    is_after: bool,
    says: &'static [&'static str],
    unless: &'static str,
    why: &'static str,
}

const fn anywhere(
    about: About,
    why: &'static str,
    says: &'static [&'static str],
    unless: &'static str,
) -> Row {
    Row {
        about,
        is_lone: false,
        is_after: false,
        says,
        unless,
        why,
    }
}

const fn after(why: &'static str, says: &'static [&'static str], unless: &'static str) -> Row {
    Row {
        about: Action,
        is_lone: false,
        is_after: true,
        says,
        unless,
        why,
    }
}

const fn lone(why: &'static str, says: &'static [&'static str], unless: &'static str) -> Row {
    Row {
        is_lone: true,
        ..after(why, says, unless)
    }
}

const NOT: &str = "not|no|without|isn't|aren't|haven't";

const POINTS: &str = "coordinates|coordinate|coords|points|point|values|pixels|numbers";

const OTHER_FRAME: &str = "the answer counts from another place than the top left of the picture";
const OTHER_UNIT: &str = "the answer counts in another unit than pixels";
const OTHER_ORDER: &str = "the answer writes its coordinates in another order";
const OTHER_PICTURE: &str = "the answer refers to another picture";
const OTHER_ANGLE: &str = "the answer counts angles in another way";
const SAMPLE: &str = "the answer says that its values are only a sample";
const UNSEEN: &str = "the answer says that it sees no picture";
const CHANGED: &str = "the answer changes its values afterwards";
const WITHDRAWN: &str = "the answer says that it is not to be carried out";

#[rustfmt::skip]
const ROWS: &[Row] = &[
    anywhere(Pixels, OTHER_FRAME, &["origin", "bottom|lower|center|centre|middle|cloth"], "not|no|without|top|nearest to the origin|closest to the origin|nearest to the picture's origin|closest to the picture's origin"),
    anywhere(Pixels, OTHER_FRAME, &["( 0 , 0 )", "is|being|at", "center|centre|middle|bottom|lower"], "not|top"),
    anywhere(Pixels, OTHER_FRAME, &["y", "starts at the bottom|begins at the bottom|zero at the bottom|0 at the bottom|measured upward|measured upwards|increases upward|increases upwards|increasing upward|increasing upwards|grows upward|grows upwards|points up|pointing up|axis up|upward from|upwards from|from the bottom"], "not|no|without|isn't|aren't|haven't|atan2|arctan|atan"),
    anywhere(Pixels, OTHER_FRAME, &["x|y|coordinates|coordinate|columns|rows", "counted|counts|measured|measures|grows|growing|increases|increasing|starts|starting|runs|running", "from the right|from the bottom|from the lower|from right|from bottom|to the left|leftwards"], "i.e. the gripper|so the gripper|not|no|clockwise|counterclockwise|ccw|anticlockwise|angle|angles|direction|directions|deg|°"),
    anywhere(Pixels, OTHER_FRAME, &["relative to the pick|displacement from the pick|offset from the pick|relative to the cloth|not of the image|relative to the cropped"], "the center lies|the centre lies|the center is|the centre is"),
    anywhere(Pixels, OTHER_FRAME, &["millimetres|millimeters|mm|centimetres|centimeters|cm|meters|metres|inches", "robot|base|world", "frame|coordinates"], NOT),
    anywhere(Pixels, OTHER_UNIT, &["centimetres|centimeters|cm|millimetres|millimeters|mm|inches", "units :|unit :|table corner|corner of the table"], "distance|length|lengths|degrees|deg"),
    anywhere(Pixels, OTHER_UNIT, &["normalized|normalised", "coordinates|coordinate|points|values|true|0"], NOT),
    anywhere(Pixels, OTHER_UNIT, &["percent|percentage|percentages|thousandths", "coordinates|coordinate|x|width|height|image size|unit|units"], NOT),
    anywhere(Pixels, OTHER_UNIT, &["1000|999", "grid|scale|range|scaled", "coordinates|coordinate|point|points|values|relative|normalized|both|they|these|all|:"], ""),
    anywhere(Pixels, OTHER_UNIT, &["grid|patches|cells", "column|columns|row|rows|cell", "name|count|divided|number"], NOT),
    anywhere(Pixels, OTHER_UNIT, &["not in pixels|not pixels|not px|not in px|not pixel", POINTS], ""),
    anywhere(Pixels, OTHER_ORDER, &["row before the column|rows before columns|row before column|is the vertical one|row , column|row , col|rows , columns|v , u|y before x|y first|number is the row|coordinate is the row|value is the row"], NOT),
    anywhere(Pixels, OTHER_UNIT, &["0 - 1000 scale|0 - 1000 range|0 to 1000 scale|scale of 0 to 1000|range 0 - 1000|range of 0 to 1000|0 - 999 scale|scale 0 - 1000|on a 0 - 1000|in 0 - 1000"], NOT),
    anywhere(Pixels, OTHER_UNIT, &["^ unit :|^ units :|^ scale :", "normalized|normalised|relative|percent|fraction|mm|cm|inch|inches|thousandths"], "not|no|without|isn't|aren't|haven't|px|pixel|pixels|deg|degrees|distance|distances"),
    anywhere(Pixels, OTHER_FRAME, &["frame : bottom|frame : lower|frame : center|frame : centre|frame : middle|frame : robot|frame : world|frame : base|frame : table|frame : cloth|origin : bottom|origin : lower|origin : center|origin : centre|origin : middle|origin : robot|origin : world|origin : base|origin : table|origin : cloth|coordinate system : bottom|coordinate system : lower|coordinate system : center|coordinate system : centre|coordinate system : middle|coordinate system : robot|coordinate system : world|coordinate system : base|coordinate system : table|coordinate system : cloth|coordinate frame : bottom|coordinate frame : lower|coordinate frame : center|coordinate frame : centre|coordinate frame : middle|coordinate frame : robot|coordinate frame : world|coordinate frame : base|coordinate frame : table|coordinate frame : cloth|reference frame : bottom|reference frame : lower|reference frame : center|reference frame : centre|reference frame : middle|reference frame : robot|reference frame : world|reference frame : base|reference frame : table|reference frame : cloth"], ""),
    anywhere(Pixels, OTHER_ORDER, &["given as y , x|written as y , x|listed as y , x|height first|row first|rows first|vertical first|vertical coordinate first"], NOT),
    anywhere(Pixels, OTHER_ORDER, &["swap x and y|swap the x and y|exchange x and y|x and y are swapped|x and y swapped|swap the coordinates"], NOT),
    anywhere(Action, CHANGED, &["swap pick and place|exchange pick and place"], NOT),
    anywhere(Pixels, OTHER_ORDER, &["yx|y , x|row_col|rowcol", "order|coordinate_order|format|convention|coordinates"], NOT),
    anywhere(Pixels, OTHER_PICTURE, &["enlarged|cropped|zoomed|upscaled|rescaled|magnified", "picture|image|crop|view|version|region", "coordinates|coordinate|points|point|values|relative|in the enlarged|in the cropped|in the zoomed|from the|working on"], NOT),
    anywhere(Pixels, OTHER_PICTURE, &["values|coordinates|points|numbers|they", "are from|are of|come from|belong to|taken from", "previous|last|earlier|another|other|old|first", "scene|picture|image|photo|frame|step"], "not|no|without|isn't|aren't|haven't|from a crease|from the crease|from a wrinkle|from an old crease"),
    anywhere(Pixels, OTHER_PICTURE, &["copy|version|thumbnail|screenshot", "half size|half the size|double size|twice the size|smaller size|reduced size|half scale|another scale"], NOT),
    anywhere(Pixels, OTHER_PICTURE, &["refer to the goal|refers to the goal|refer to the depth|refers to the depth|twice the resolution|double the resolution|from the goal image|from the depth|half the resolution|half resolution"], NOT),
    anywhere(Pixels, OTHER_PICTURE, &["in the depth image|in the goal image", "coordinates|coordinate|pixels|values"], NOT),
    anywhere(Pixels, OTHER_PICTURE, &["image|picture", "be mirrored|upside down|turned it|rotated it|rotated by|is mirrored"], NOT),
    anywhere(Pixels, OTHER_PICTURE, &["image|picture|photo", "rotated|turned|flipped|mirrored|resized|scaled|shrunk|downscaled|downsampled", "before reading|to read|when reading|before i read|then read|for reading"], NOT),
    anywhere(Pixels, OTHER_PICTURE, &["refer to|refers to|relative to|are in|is in|read in|read from", "turned picture|turned image|rotated picture|rotated image|flipped picture|flipped image|mirrored picture|mirrored image"], NOT),
    anywhere(Pixels, OTHER_PICTURE, &["i rescaled|i resized|i downscaled|i upscaled|i shrank|i enlarged|i cropped|i rotated|i flipped|i mirrored", "image|picture|photo|it|everything"], "not|no|without|back|cloth|fold|original"),
    anywhere(Pixels, OTHER_PICTURE, &["relative to|refer to|based on|measured in|measured on|read from|read in|are in the", "version of|copy of|thumbnail|resized|downscaled|downsampled"], NOT),
    anywhere(Directions, OTHER_ANGLE, &["clockwise|cw", "angle|angles|direction|directions|measured|measure|counted|count"], "mistake|mistakes|attempt|corners|outline|right angle|right angles|counter clockwise|counter - clockwise|anti clockwise|anti - clockwise|anticlockwise|counterclockwise|ccw|not"),
    anywhere(Directions, OTHER_ANGLE, &["^ clockwise : true|^ cw : true|^ is clockwise : true"], ""),
    anywhere(Directions, OTHER_ANGLE, &["clockwise|cw", "measuring|counting", "deg|degrees|°|angle|angles|direction|directions"], "mistake|mistakes|attempt|corners|outline|right angle|right angles|counter clockwise|counter - clockwise|anti clockwise|anti - clockwise|anticlockwise|counterclockwise|ccw|not"),
    anywhere(Directions, OTHER_ANGLE, &["clockwise|cw", "from the top|from top|from up|from north|from 12"], "corner|corners|counter clockwise|counter - clockwise|anti clockwise|anti - clockwise|anticlockwise|counterclockwise|ccw|not"),
    anywhere(Directions, OTHER_ANGLE, &["angle|angles|direction|directions|degrees", "measured from|counted from|start at|starts at|starting from|starting at", "top|up|north|vertical|bottom|left"], "measured from the center it's|measured from the center it is|not|right|x - axis|x axis|horizontal|east"),
    anywhere(Directions, OTHER_ANGLE, &["positive is clockwise|clockwise is positive|positive clockwise|clockwise positive|positive = clockwise"], "counter|not"),
    anywhere(Directions, OTHER_ANGLE, &["0 deg|0 degrees|0 °|zero degrees", "is up|points up|pointing up|means up|pointing upwards|is straight up|means straight up|pointing straight up|is north|at the top|straight down"], "not|right|tip comes|comes from"),
    anywhere(Directions, OTHER_ANGLE, &["90 deg|90 degrees|90 °", "points to the bottom|points down|pointing down|is down|means down"], "not|270"),
    anywhere(Directions, OTHER_ANGLE, &["compass bearing|a bearing|right towards the bottom|right toward the bottom|right to the bottom|angle of the fold line|from the vertical"], NOT),
    anywhere(Directions, OTHER_ANGLE, &["direction is relative to|directions are relative to|angle is relative to"], "not relative|relative to the image|relative to the picture"),
    anywhere(Lengths, "the answer counts lengths in another unit", &["in inches|in centimetres|in centimeters|in metres|in meters", "length|lengths|distance|distances"], NOT),
    anywhere(Lengths, "the answer counts lengths in another unit", &["in units of|in multiples of|in halves of|in quarters of", "length|lengths|distance|distances|half|quarter"], NOT),
    anywhere(Lengths, "the answer means another side of the cloth", &["shorter side|shorter edge|short side", "edge|distance"], "not the shorter|not of the shorter|and not"),
    anywhere(Action, SAMPLE, &["illustrative|dummy|hypothetical|fictitious|made - up|made up|invented|random|default", "value|values|number|numbers|coordinates|points|answer|purely|example|below|above|/ /"], NOT),
    anywhere(Action, SAMPLE, &["no idea|wild guess|blind guess|just guessing|something at random|points at random|values at random"], "not|without"),
    anywhere(Action, SAMPLE, &["as a joke|just a joke|only a joke|just joking|only joking|just kidding|let's pretend|just pretending"], ""),
    anywhere(Action, SAMPLE, &["sample values|example values|placeholder values|are placeholders|placeholder coordinates|sample coordinates|example coordinates|only an example|just an example|merely an example|only a template|just a template|only a sample|only an illustration"], NOT),
    anywhere(Action, SAMPLE, &["would look like|would respond|you would write|format would be|would be formatted|would have the form|structure you need|replace the numbers|replace the values|replace these|replace them|replace those|fill in the actual|fill in your|once i know|one usually sees|the demonstration reads|the paper reads"], ""),
    anywhere(Action, "the answer says what would be right in another picture", &["if|assuming", "were at|were in|could see|had the image|were visible|was centered|was centred", "would|could"], ""),
    anywhere(Action, "the answer says what would be right in another picture", &["if|assuming|supposing", "were|was|had|lay", "the answer would|answer would|action would|values would|solution would|pick would|output would|i would answer|it would be :"], ""),
    anywhere(Action, "the answer says what would be right in another picture", &["^ suppose|^ supposing|^ imagine", "were|was|had"], ""),
    anywhere(Action, UNSEEN, &["can't|cannot|unable|don't|can not|couldn't|do not|didn't|not able|no", "see the image|see an image|see any image|see images|see your image|see the picture|see a picture|see any picture|see the photo|see the cloth|view the image|view an image|view images|view the picture|analyze images|analyze the image|access the image|access images|access to the image|process images|open the image|receive an image|receive the image|tell where the cloth"], ""),
    anywhere(Action, UNSEEN, &["no access to|not have access|without access to|without having seen|no image|no picture|no photo|without the image|without an image|not given the image|without seeing the image|without seeing the cloth|image failed|image was not|no cloth in|cloth not detected|didn't come through|did not come through", "picture|photo|attached|came|come|provided|received|through|cannot|can't|given|was|available|determine|load|opinion|image|returning"], ""),
    anywhere(Action, WITHDRAWN, &["status : error|valid : false|success : false|error : true|no further action"], ""),
    anywhere(Action, WITHDRAWN, &["executable : false|safe : false|usable : false|approved : false|verified : false|ready : false|reliable : false|accepted : false|execute : false|feasible : false|certain : false|confirmed : false|final : false"], ""),
    anywhere(Action, SAMPLE, &["^ dry run : true|^ example : true|^ sample : true|^ test : true|^ simulation : true|^ simulated : true|^ placeholder : true|^ is example : true|^ is sample : true|^ dummy : true|^ template : true|^ preview : true|^ confidence : 0|^ confidence : 0.0|^ certainty : 0|^ probability : 0"], ""),
    anywhere(Action, WITHDRAWN, &["would not do this|wouldn't do this|would not do that|would not execute this|would not carry this out"], ""),
    anywhere(Action, WITHDRAWN, &["^ action : none|^ action : noop|^ action : no op|^ action : null|^ action : skip|^ action : abort|^ action : stop|^ action : wait|^ action : no action"], ""),
    anywhere(Action, CHANGED, &["^ corrected|^ revised|^ alternative|^ updated|^ improved|^ actual", "pick :|place :|direction :|distance :|point :|angle :|grip :"], ""),
    anywhere(Action, WITHDRAWN, &["corner to avoid|point to avoid|strike this|strike that|cross this out|strike these|je retire|ich ziehe das|ich nehme das zurück|ich widerrufe|retiro esta|retiro la"], ""),
    anywhere(Action, OTHER_PICTURE, &["not for this cloth|not for this picture|not for this image|not for this robot|not for this step|for another cloth|for another picture|for the other robot|for another robot|for a different cloth|for a different picture"], ""),
    anywhere(Action, "the answer holds only under a condition", &["^ / / only if|^ / / unless|^ / / only when|would say so had"], ""),
    after("the answer holds only under a condition", &["let me know which|let me know where|let me know what|let me know whether|tell me which|tell me where|tell me whether"], "else|you|you'd|next|happens|happened|went|goes|worked"),
    after("the answer holds only under a condition", &["this holds|that holds|answer holds|answer is valid|this is valid|this is right|this is correct|this applies|action applies", "provided that|provided the|only if|only when|as long as"], NOT),
    after(WITHDRAWN, &["this|these", "corner must not be|corner should not be|point must not be|point should not be|pick must not be|values must not be|values should not be|action must not be|action should not be|answer must not be", "used|picked|taken|executed|carried out|pulled"], "again|too|so|because|beyond|past|over|further|more|than|together|last|previous"),
    after("the answer holds only under a condition", &["^ only if|^ unless|^ only when|^ provided that"], "slips|otherwise"),
    anywhere(Action, WITHDRAWN, &["^ error :|, error :"], "error : null|error : false|error : none|error : no|error : 0|error : ,"),
    anywhere(Action, "the answer calls itself a draft", &["not my final|not the final|not final|isn't final"], ""),
    after(UNSEEN, &["please", "ask me again|ask again|clearer picture|clearer image|clearer photo|better picture|better image|better photo"], "next|after|afterwards|once|then|done|step"),
    after(WITHDRAWN, &["cancel that|cancel this|cancel it|never mind|undo this|undo that|undo it|undo these|start again|start over|start anew"], NOT),
    after("the answer names another value under a condition", &["^ if|^ should|^ otherwise", "use|take|try|choose|pick", "instead"], ""),
    after("the answer changes its values under a condition", &["^ if|^ should|^ in case|^ for|^ with", "take|use|choose|make it|pull|go", "half|quarter|third|tenth|double|twice|full|whole|longer|shorter|instead"], "i|we|would|could|might|too|next|not|then|will|second|step|so|is|are"),
    after("the answer changes its values under a condition", &["^ if|^ should|^ in case|^ when", ", pull only|, take only|, use only|, use twice|, use half|, take half|, pull half|, pull twice|, make it|, double it|, halve it"], "i|we|next"),
    after(CHANGED, &["exchange|exchanged|interchange|interchanged|swap|swapped|switch|switched", "those|these|above|two|both|points|lines|answer|that|it"], "not|no|haven't|hasn't|later|unfold|can|could|side"),
    after(CHANGED, &["add|subtract|multiply|divide|scale|double|doubled|halve|halved|reverse|reversed|flip|flipped|invert|inverted|mirror|shift|increase|decrease|reduce", "every x|every y|each x|each y|x value|y value|x values|y values|x coordinate|y coordinate|x coordinates|y coordinates|coordinates|the values|all values|both by|both values|the distance|the direction|the angle|the grip|the pick|the place|them to|to your resolution|by two|double it|halve it|reverse it|flip it|scale it|increase it|decrease it|reduce it|mirror it"], "not|no|will|would|to avoid|double - checked|doublechecked|mirror image|hem|flap|layer|layers"),
    after(CHANGED, &["offset|bias|displacement|margin", "add|added|be added|apply|applied", "to both|to each|to the|to all"], NOT),
    after(CHANGED, &["^ oops|^ hold on|^ wait|^ my mistake|^ my bad|^ actually|^ no ,|^ oh no|^ hmm|^ double - check|^ correction"], "no need|does not|doesn't|need not|unchanged|stays|confirms|confirm|correct|right|same|fine|okay|earlier|previous|last time|first answer|inconvenience"),
    after(CHANGED, &["^ sorry|^ apologies"], "no need|does not|doesn't|need not|unchanged|stays|confirms|confirm|correct|right|same|fine|okay|earlier|previous|last time|first answer|inconvenience|confusion|delay|for that|for this|for missing|for the|last proposal|last answer|last reply|last attempt|last try|last action|last suggestion|was on the|was off the|was next to|i gave before was|i gave earlier was"),
    lone(CHANGED, &["actually ,|looking again|looking at it again|looking closer|looking more closely|on closer look|on closer inspection"], "no need|also|unchanged|stays|confirms|confirm|correct|right|same"),
    lone(CHANGED, &["should be the one|opposite way|than i wrote|one step lower|one step higher|one level"], NOT),
];

/// What says that values of another picture were converted.
const CONVERTED: &str =
    "scaled back|converted|multiplied by|in your picture|divided by|dividing by";

/// The most words of a heading that has no sign.
const MAX_HEADING: usize = 2;

/// The most tokens of a sentence that is a remark.
const MAX_SENTENCE: usize = 300;

/// Where the claims of an answer stand, bytes.
#[derive(Clone, Copy)]
pub(super) struct Stated {
    /// Where the first one begins.
    pub first: usize,
    /// Where the last field is stated first: what follows has the whole answer above it.
    pub settled: usize,
    /// Where the last one begins.
    pub last: usize,
    /// Where the last one ends.
    pub end: usize,
}

/// Returns the remarks of an answer: what each is about, and the reason why those values cannot be used.
///
/// - `stated`: the claims that stand among the tokens; none if the tokens are remarks beside them.
pub(super) fn of(
    tokens: &[Token<'_>],
    notation: &Notation,
    stated: Option<Stated>,
) -> Vec<(About, String)> {
    let last_claim = stated.map(|stated| stated.last);
    let all = doubt::prose(tokens, doubt::MIN_EXPLANATION);
    let reasons = doubt::reasons_begin(tokens).filter(|_| stated.is_some());
    let mut found: Vec<(About, String)> = Vec::new();
    for sentence in sentences(tokens, last_claim) {
        let prose = match reasons.is_some_and(|at| sentence[0].at >= at) {
            true => Prose::Explanation,
            false => all,
        };
        // Nobody writes sentences of this length; looking for every phrase in them would only take time.
        if sentence.len() > MAX_SENTENCE {
            continue;
        }
        let is_after = last_claim.is_some_and(|at| sentence[0].at > at);
        let words = spoken(sentence);
        if !is_after && says(&words, CONVERTED) {
            found.retain(|(about, _)| *about != Pixels);
            continue;
        }
        found.extend(rows_of(&words, is_after, prose).map(|row| (row.about, row.why.to_owned())));
        found.extend(another_size(sentence, notation).map(|why| (Pixels, why)));
        if !says(&words, NOT) && another_order(sentence, notation) {
            found.push((Pixels, OTHER_ORDER.to_owned()));
        }
    }
    found.retain(|(about, _)| *about != Pixels || notation.is_native());
    if has_condition(tokens, last_claim) {
        found.push((Action, "the answer holds only under a condition".to_owned()));
    }
    found
}

fn rows_of(words: &str, is_after: bool, prose: Prose) -> impl Iterator<Item = &'static Row> {
    ROWS.iter().filter(move |row| {
        (!row.is_after || is_after)
            && (!row.is_lone || prose == Prose::Remark)
            && row.says.iter().all(|group| says(words, group))
            && !says(words, row.unless)
    })
}

/// Returns why sentences before or after a text say that it is not to be carried out.
pub(super) fn of_text(tokens: &[Token<'_>], place: Place) -> Option<&'static str> {
    let prose = doubt::prose(tokens, doubt::MIN_EXPLANATION);
    let sentences = sentences(tokens, None).into_iter();
    let mut short = sentences.filter(|sentence| sentence.len() <= MAX_SENTENCE);
    short.find_map(|sentence| {
        let words = spoken(sentence);
        let mut rows = rows_of(&words, place == Place::After, prose);
        rows.find(|row| row.about == Action).map(|row| row.why)
    })
}

/// Cuts a text into sentences; the last value ends with its line.
fn sentences<'a, 't>(tokens: &'a [Token<'t>], last_claim: Option<usize>) -> Vec<&'a [Token<'t>]> {
    let mut found = Vec::new();
    let mut start = 0;
    for index in 0..tokens.len() {
        let goes_on = tokens.get(index + 1).is_some_and(|next| {
            let states_last =
                last_claim.is_some_and(|at| (tokens[start].at..=tokens[index].at).contains(&at));
            let least = if states_last { Gap::Line } else { Gap::Item };
            // `Check` as a heading orders nothing.
            let is_heading = index < start + MAX_HEADING
                && tokens[start].gap >= Gap::Line
                && next.gap >= Gap::Line
                && next.text.starts_with(char::is_uppercase);
            !value::ends_sentence(tokens, index) && next.gap < least && !is_heading
        });
        if !goes_on {
            found.push(&tokens[start..=index]);
            start = index + 1;
        }
    }
    found
}

/// Returns why an answer is in doubt; of the sentence that states the last value, only what follows it is read.
///
/// - `stated`: the claims that stand among the tokens.
/// - `place`: where the tokens stand if there are none.
pub(super) fn doubt(
    tokens: &[Token<'_>],
    stated: Option<Stated>,
    place: Place,
) -> Option<&'static str> {
    let prose = match place {
        Place::Beside => doubt::prose(tokens, doubt::MIN_BESIDE),
        Place::Before | Place::After => doubt::prose(tokens, doubt::MIN_EXPLANATION),
    };
    doubt_in(tokens, stated, place, prose)
}

/// The same, where it is known how much is said.
pub(super) fn doubt_in(
    tokens: &[Token<'_>],
    stated: Option<Stated>,
    place: Place,
    prose: Prose,
) -> Option<&'static str> {
    let last = stated.map(|stated| stated.last);
    let spoken: Vec<_> = sentences(tokens, last)
        .into_iter()
        .filter(|sentence| sentence.len() <= MAX_SENTENCE)
        .collect();
    let language = doubt::language(&spoken);
    let reasons = doubt::reasons_begin(tokens).filter(|_| place != Place::Beside);
    spoken.into_iter().find_map(|sentence| {
        let begins = sentence.first()?.at;
        let prose = match reasons.is_some_and(|at| begins >= at) {
            true => Prose::Explanation,
            false => prose,
        };
        let Some(Stated {
            first,
            settled,
            last,
            end,
        }) = stated
        else {
            return doubt::cast_by(sentence, place, language, prose);
        };
        let (begins, ends) = (sentence.first()?.at, sentence.last()?.at);
        if begins > settled {
            return doubt::cast_by(sentence, Place::After, language, prose);
        }
        // `Draft, to be checked:` above the first value
        if begins < first && first <= ends {
            let above = sentence.partition_point(|token| token.at < first);
            // `If the cloth lay the other way, the answer would be`, on a line of its own
            let is_heading = above > 0
                && (sentence[above - 1].is_sign(':')
                    || sentence
                        .get(above)
                        .is_some_and(|token| token.gap >= Gap::Line));
            if is_heading
                && let Some(why) =
                    doubt::cast_by(&sentence[..above], Place::Before, language, prose)
            {
                return Some(why);
            }
        }
        // A remark on the lines below the first value, before the next one.
        if begins <= first && first <= ends && ends <= last {
            let below = sentence
                .iter()
                .position(|token| token.at > first && token.gap >= Gap::Line);
            if let Some(why) =
                below.and_then(|at| doubt::cast_by(&sentence[at..], Place::Beside, language, prose))
            {
                return Some(why);
            }
        }
        let place = match () {
            () if ends > last => Place::After,
            () if begins > first => Place::Beside,
            () => Place::Before,
        };
        let behind = if begins > last || place != Place::After {
            0
        } else {
            sentence.partition_point(|token| token.at < end)
        };
        doubt::cast_by(&sentence[behind..], place, language, prose)
    })
}

/// Returns why what objects say beside the values puts the answer in doubt.
pub(super) fn doubt_beside(beside: &Beside) -> Option<&'static str> {
    doubt(&lexer::tokens(&beside.said), None, Place::Beside)
        .or_else(|| doubt(&lexer::tokens(&beside.thought), None, Place::Before))
}

/// Returns whether a line such as `If it has to be pulled:` stands above a claim.
fn has_condition(tokens: &[Token<'_>], last_claim: Option<usize>) -> bool {
    const HARMLESS: [&str; 8] = [
        "understand",
        "understood",
        "correctly",
        "mistaken",
        "want",
        "prefer",
        "need",
        "helps",
    ];
    let mut start = 0;
    (0..tokens.len()).any(|at| {
        let line = start..at + 1;
        if tokens.get(at + 1).is_some_and(|next| next.gap < Gap::Line) {
            return false;
        }
        start = at + 1;
        let line = &tokens[line];
        let ends = |token: &Token<'_>| ['.', '!', '?', ';'].iter().any(|sign| token.is_sign(*sign));
        let begin = line.iter().rposition(ends).map_or(0, |end| end + 1);
        let Some(line) = line.get(begin..).filter(|line| !line.is_empty()) else {
            return false;
        };
        let is_heading = line[0].is_any(&["if", "unless"]) && line[line.len() - 1].is_sign(':');
        is_heading
            && !line.iter().any(|token| token.is_any(&HARMLESS))
            && last_claim.is_some_and(|claim| claim > line[0].at)
    })
}

/// Writes a sentence in lower case, with blanks around each word and sign.
pub(super) fn spoken(sentence: &[Token<'_>]) -> String {
    // `^` stands for the beginning.
    let mut words = String::from(" ^ ");
    for token in sentence {
        match token.kind {
            Kind::Sign(sign) => words.push(sign),
            Kind::Word | Kind::Number => {
                words.push_str(&token.text.to_lowercase().replace('’', "'"));
            }
        }
        words.push(' ');
    }
    words
}

/// Returns whether a sentence repeats the format with its coordinates exchanged: `[y, x]`.
fn another_order(sentence: &[Token<'_>], notation: &Notation) -> bool {
    (0..sentence.len()).any(|at| {
        let mut cursor = Cursor::at(sentence, at);
        point::echo(&mut cursor) == Some(Order::Yx) && notation.order() == Order::Xy
    })
}

/// Words between a picture and its size: `the image appears to be 640x480`.
const JOINING: [&str; 14] = [
    "is",
    "of",
    "appears",
    "to",
    "be",
    "a",
    "an",
    "the",
    "size",
    "as",
    "has",
    "resolution",
    "with",
    "uploaded",
];

/// The fewest and the most pixels of a picture's side.
const SIDES: std::ops::RangeInclusive<u32> = 64..=8192;

/// Returns why the points are not in the picture that was sent, if the sentence gives a picture another size.
fn another_size(sentence: &[Token<'_>], notation: &Notation) -> Option<String> {
    let asked = notation.sent_px()?;
    let side = |text: &str| text.parse::<u32>().ok().filter(|side| SIDES.contains(side));
    let is_picture =
        |token: &Token<'_>| token.is_any(&["image", "picture", "photo", "frame", "resolution"]);
    (0..sentence.len().saturating_sub(1)).find_map(|at| {
        let width = side(sentence[at].text)?;
        let joint = &sentence[at + 1];
        // `in a 512-pixel frame`
        let mut behind = sentence[at + 1..].iter().skip_while(|it| it.is_sign('-'));
        let in_pixels = behind.next().is_some_and(|it| it.is_any(&["pixel", "px"]));
        if in_pixels && behind.next().is_some_and(is_picture) && !asked.contains(&width) {
            return Some(format!(
                "the answer refers to a picture of {width} pixels, and this one has {} by {}",
                asked[0], asked[1]
            ));
        }
        // `640x480` and `640 x 480`
        let (height, end) = match joint.text.strip_prefix('x').and_then(side) {
            Some(height) => (height, at + 2),
            None => {
                let joins = joint.is_any(&["x", "by"]) || matches!(joint.kind, Kind::Sign('*' | '×'));
                (side(sentence.get(at + 2).filter(|_| joins)?.text)?, at + 3)
            }
        };
        let named_after = sentence.get(end).is_some_and(is_picture);
        let named_before = sentence[..at]
            .iter()
            .rev()
            .take(8)
            .find(|token| !(token.is_any(&JOINING) || matches!(token.kind, Kind::Sign(',' | ':'))))
            .is_some_and(is_picture);
        (( named_after || named_before) && [width, height] != asked).then(|| {
            format!("the answer refers to a picture of {width} by {height} pixels, and this one has {} by {}", asked[0], asked[1])
        })
    })
}
