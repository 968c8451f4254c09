//! Clauses that take an answer back or point elsewhere, whatever else they say: one row for each way to say it.
//!
//! A pattern is a row of words. `a|b` stands for either, a name in capitals for a list of words, `pick*` for words that
//! begin so and `*ly` for words that end so, `*` for up to six words. `^` stands for the beginning of a clause, and `$` for its end.

use super::clause::{
    CHANGED, CONDITIONAL, Clause, DOUBTED, HALTED, OTHERWISE, Place, Subject, refers_forward,
};
use super::vocabulary::*;
use std::sync::LazyLock;

/// The most words for which `*` stands.
const MAX_GAP: usize = 6;

/// The lists of words that patterns name.
const LISTS: [(&str, &[&str]); 11] = [
    ("ACT", ACTS),
    ("ANOTHER", ANOTHER),
    ("BE", BE),
    ("CHOSEN", CHOSEN),
    ("CLOTH", CLOTHS),
    ("MOTION", MOTIONS),
    ("ORDER", ORDERS),
    ("PART", PARTS),
    ("PLACE", PLACES),
    ("SHOWN", SHOWN),
    ("SUPERIOR", SUPERIOR),
];

/// Where a clause stands.
#[derive(Clone, Copy, PartialEq, Eq)]
enum When {
    After,
    /// After the values or beside them.
    Later,
    /// Anywhere; before the values only if it speaks of what follows.
    Always,
    /// Anywhere, whatever it speaks of.
    Ever,
}

/// Of whom a clause speaks.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Of {
    Anything,
    Answer,
    Author,
    World,
    /// An order, or a clause without a verb.
    Nobody,
}

struct Row {
    when: When,
    of: Of,
    says: &'static str,
    unless: &'static str,
    why: &'static str,
}

const fn row(
    when: When,
    of: Of,
    says: &'static str,
    unless: &'static str,
    why: &'static str,
) -> Row {
    Row {
        when,
        of,
        says,
        unless,
        why,
    }
}

use Of::{Answer, Anything, Author, Nobody, World};
use When::{After, Always, Ever, Later};

#[rustfmt::skip]
const ROWS: &[Row] = &[
    // Where an action ought to begin.
    row(Later, World, "BE * PLACE to ACT", "", OTHERWISE),
    row(Later, World, "PLACE i mean|meant|want|wanted", "", OTHERWISE),
    row(Later, World, "^ a|the|some *er PART|PLACE|grip|pull|hold|stroke|step BE needed|required|necessary|due|called", "not|lower|upper|outer|inner|other|latter", OTHERWISE),
    row(Later, World, "PLACE that should|must|needs|matters|counts|wants|ought|deserves", "", OTHERWISE),
    row(Later, World, "PLACE that has to", "", OTHERWISE),
    row(After, Answer, "^ it is the * that needs|should|must|ought", "", OTHERWISE),
    row(After, Answer, "^ it is the * that has to", "", OTHERWISE),
    row(Later, World, "ANOTHER * BE needed|required|due|called", "not", OTHERWISE),
    row(After, World, "should|must|ought be|to * CHOSEN", "CHOSEN to|towards|toward|over the|its|their", OTHERWISE),
    row(After, World, "should|must|ought to|be|start|begin|go|come start|begin|go|come|with|at|first|from", "", OTHERWISE),
    row(After, Answer, "fold|pick|pull ought|should to|begin|start", "", OTHERWISE),
    row(After, Nobody, "^ start|begin with|at|from|on", "", OTHERWISE),
    row(After, Nobody, "^ choose|select|opt|prefer|use the|a|an|that|another|with|for", "@", OTHERWISE),
    row(After, Nobody, "^ try", "", OTHERWISE),
    row(After, Nobody, "^ ORDER from|at|the|a|an|its|it|both|another|that|me|us", "@|then|slow*|gent*|*ly|again|flat|low|about|high|enough|above", OTHERWISE),
    row(After, Anything, "^ what * needs|needed|required|missing|wants|matters|helps|deserves|requires * BE", "", OTHERWISE),
    row(After, World, "goes|comes|moves first $", "", OTHERWISE),
    row(After, Anything, "i would rather|prefer|sooner", "than|hard|harder|far|farther|fast|faster|firmly", OTHERWISE),
    row(After, World, "^ the correct|real|true|proper|better", "not", OTHERWISE),
    row(After, World, "BE the correct|real one $", "not", OTHERWISE),
    row(Later, World, "the other way|direction", "not|no|would|could|second|next|then|will", OTHERWISE),
    row(Later, World, "BE what the CLOTH", "^ BE", OTHERWISE),
    row(After, Answer, "should|must lie|sit|go|be|move|point * left|right|lower|higher|above|below|further", "now|then|after|so", CHANGED),
    row(Later, World, "deserv*|merit*", "", OTHERWISE),
    row(Later, World, "BE what the|this|our SHOWN", "^ BE", OTHERWISE),
    row(Later, World, "needs|requires|wants * SUPERIOR", "", OTHERWISE),
    row(Later, Nobody, "^ BE a|the|much SUPERIOR", "not", OTHERWISE),
    row(Later, Anything, "i should have", "", CHANGED),
    row(Later, World, "PLACE * needs|wants|requires|deserves the|a|its MOTION|attention|care", "not|no", OTHERWISE),
    row(After, Answer, "^ this * has|have|needs|ought to go|be|start|begin|come|point", "then|now|done|again|repeated", CHANGED),
    row(After, Answer, "^ the * has|have|needs|ought to go|be|start|begin|come|point", "then|now|done|again|repeated|long|short|firm|soft|gentle|light|strong|careful|precise|exact|large|small|straight|diagonal", CHANGED),
    row(Later, Anything, "was better|right|best|correct", "not|no", OTHERWISE),
    row(After, Author, "^ i mean|meant the|to|another|up|down|left|right", "", CHANGED),
    row(After, Nobody, "^ leave|let it|this|everything|that $", "", HALTED),
    row(Later, Anything, "calls|call for a|an|the|more", "SHOWN|not", OTHERWISE),
    row(Later, World, "shows|means|wants|needs|is something|somebody|somewhere else", "not", DOUBTED),
    row(Later, Anything, "point|pick|place BE off the CLOTH|mask|table", "not", DOUBTED),
    row(Later, Answer, "make|makes the|this|it * deeper|bigger|worse|tighter|thicker", "not|no", DOUBTED),
    row(Ever, Author, "made an|a|some error|mistake|slip", "", DOUBTED),
    row(Ever, Author, "^ i am guessing", "", DOUBTED),
    row(Later, Answer, "against|contrary|violates the|to|its SHOWN|goal|rule|rules", "not", DOUBTED),
    row(Ever, Author, "would rather not $|answer|say|guess|commit|act|move|do|decide|state", "", HALTED),
    row(Ever, Anything, "following|below|above fails|violates|breaks|contradicts", "not|no|never", DOUBTED),
    row(After, Anything, "this|my|chosen|the choice|answer|action|pull|fold|pair|selection fails|violates|breaks the|a|one * rule|rules|limit|limits|constraint|instruction|check|goal", "not|no|never|ANOTHER", DOUBTED),
    row(Ever, Anything, "then|next|finally|afterwards|and do|repeat the|it|this|that * again|more|twice|opposite|reverse|mirrored|reversed|backwards", "side|sleeve|corner", CHANGED),
    row(Later, Answer, "^ PART BE reversed|exchanged|interchanged|inverted", "not", CHANGED),
    row(Later, Anything, "arm|robot|gripper can|could not", "ANOTHER", DOUBTED),
    row(Later, World, "image|picture|photo can|could|do|does|did not allow|permit|let", "", DOUBTED),
    row(Later, Answer, "stay|staying put", "", HALTED),
    row(Later, Nobody, "stay|staying put", "", HALTED),
    row(After, Anything, "do|did you mean|want|prefer", "", DOUBTED),
    row(Later, Anything, "no CLOTH at|on|in|under|near that|this|the|these|either pixel|pixels|point|points|spot|place|location", "", DOUBTED),
    row(Later, Anything, "calls|call|asks for something|somewhat|*er", "SHOWN|not", OTHERWISE),
    row(Later, Anything, "arm|robot|gripper BE going|bound|likely|sure to hit|miss|collide|bump|fail|lose", "", DOUBTED),
    row(Later, Author, "have|has * no|little|zero|low confidence|trust|faith", "", DOUBTED),
    row(After, Author, "^ i meant", "", CHANGED),
    row(Later, Author, "not agree|concur", "", DOUBTED),
    row(Later, Anything, "would|will need|take|require at least|more", "not", OTHERWISE),
    row(After, Nobody, "^ take|use|make|choose only|just|it half|quarter|third|twice|double", "", CHANGED),
    row(Ever, Author, "not * have|receive|received|get|got|given|view a|an|any|the|your|actual image|picture|photo", "", DOUBTED),
    row(Later, Anything, "^ half|quarter|third|tenth * BE overkill|excessive|plenty|ample|all", "not", OTHERWISE),
    row(Later, Anything, "BE a|another different|separate one|corner|edge|fold|step", "not|no", OTHERWISE),
    row(Later, Nobody, "^ repeat|do|run|execute this|it|that * times|twice", "", CHANGED),
    // Nothing is to be done.
    row(After, Nobody, "^ hold|park|stop|halt the robot|arm|gripper|motion", "", HALTED),
    row(Later, Nobody, "^ confirm|review|approve|delete|replace|adjust $", "", HALTED),
    row(Later, Anything, "without this|these $", "", HALTED),
    row(Later, Anything, "need|needs|require|requires no MOTION", "more|further|other|second|additional|extra", HALTED),
    row(Later, World, "CLOTH is|looks smooth|done|finished|complete $", "not|then|almost", HALTED),
    // The answer is not what it should be.
    row(Later, Anything, "will|would|may|might * reject|refuse|discard|decline this|it|that|these|them", "not|never", DOUBTED),
    row(Later, Answer, "^ * was|were the|a * of|from|for * step", "", DOUBTED),
    row(Always, Answer, "BE not $", "", DOUBTED),
    row(Always, Answer, "BE not for|from|meant|of|at|what", "very|exactly|quite|directly|right|only", DOUBTED),
    row(Later, Anything, "^ neither the|my PART", "", DOUBTED),
    row(Later, Answer, "would be right|correct|fine|good|valid|true", "", CONDITIONAL),
    row(Later, Answer, "without|no any|visible|real|much effect|success|result|gain|use", "", DOUBTED),
    row(Later, Anything, "arm|robot|gripper will|would|may|might|could hit|miss|collide|bump|fail|lose", "", DOUBTED),
    row(Later, Anything, "more|closer|second|another|fresh look|glance|check", "", DOUBTED),
    row(Later, Anything, "corner|edge|hem|sleeve|point might|may|could be a|an|the|part|something|another", "same|also|off|few|slightly", DOUBTED),
    row(Later, Answer, "^ this|these|the|my|it|that|such|both * likely|bound|prone to", "open|flatten|unfold|smooth|expose|reveal|reach|improve|increase|align|give|remove|uncover|bring", DOUBTED),
    row(Later, Answer, "less effective|suitable|efficient|useful|helpful|reliable|stable|clean|good|direct", "not|no", DOUBTED),
    row(Later, Anything, "^ not on|at|in|near * corner|edge|hem|cloth|fabric|sleeve|mask|outline", "only|just", DOUBTED),
    row(Later, Nobody, "^ rejected|refused|declined|denied|failed|vetoed", "", HALTED),
    row(After, Nobody, "^ do|run|execute|use|perform|apply this|it|that only", "", CONDITIONAL),
    row(Later, Anything, "finished|done|complete|completed * ago", "ANOTHER", HALTED),
    row(After, Anything, "^ any|every|anything|everything PART|corner|direction $", "", OTHERWISE),
    row(After, World, "has|have|offers|offer|gives|needs more", "than", OTHERWISE),
    row(Later, Anything, "^ should|must be the|a", "", OTHERWISE),
    row(Later, Anything, "BE not * this|these PART|place|corner", "by|during|part", DOUBTED),
    row(Later, Anything, "BE not the one|step|right|fold|move|action|way", "ANOTHER", DOUBTED),
    row(After, Anything, "^ not the one", "", DOUBTED),
    row(Later, World, "hole|gap|table|floor at|under|below|beneath the pick|place|point", "not|no", DOUBTED),
    row(Later, Answer, "was|were for|from|right|good|meant", "", DOUBTED),
    row(Later, Answer, "out of the", "not|no|never|avoid*|keep*|bring*|without|would", DOUBTED),
    row(Later, Anything, "wrong", "not|no|never|avoid*|instead|would|could|ANOTHER|if|undo*|up|would|make", DOUBTED),
    row(Later, Answer, "more crumpled|wrinkled|bunched|tangled|folded|hidden|covered", "not|no|less", DOUBTED),
    row(Later, Answer, "presses|pinches * onto the table", "not", DOUBTED),
    row(Later, Anything, "out of * reach", "ANOTHER|not", DOUBTED),
    row(After, Anything, "can not be picked|grasped|reached|gripped|lifted|pulled|executed|carried|used", "ANOTHER|remaining", DOUBTED),
    row(Later, World, "falls|slides|slips|drops|ends off the table|cloth", "ANOTHER|larger|longer|further", DOUBTED),
    row(After, Author, "see|find|detect|recognise|recognize no CLOTH|corner|corners|edge|edges|hem|sleeve", "", DOUBTED),
    row(Ever, Author, "can|could not see the|any|a|your picture|image|photo", "", DOUBTED),
    row(Ever, Author, "can|could not see the|a first|second|third|last|other picture|image|photo", "", DOUBTED),
    row(Always, World, "image|picture|photo shows|has|contains no cloth|towel|shirt|fabric|corner|corners", "", DOUBTED),
    row(After, Nobody, "^ read|interpret|take|treat|count the|this|that|it * as", "", CHANGED),
    row(Later, World, "order|roles|sequence BE reversed|swapped|switched|wrong|exchanged", "", CHANGED),
];

/// What takes an answer back in a remark and in the midst of a long explanation alike, whomever the clause speaks of.
#[rustfmt::skip]
const PLAIN: &[Row] = &[
    row(After, Anything, "this|the|that|chosen corner|point|place|tip should|must not be pulled|picked|used|moved|grasped|taken|lifted", "again|ANOTHER|too|far|farther|further|beyond|more|past|high|higher|hard|before|until|by|with|over|than", DOUBTED),
    row(Later, Anything, "^ ANOTHER corner|point|direction|distance|grip has|must|should|needs|ought to|be * chosen|picked|used|taken|found|selected", "next|then|later|follow*|after|afterwards|before|second|third", OTHERWISE),
    // Somebody else has to look, choose or send something first.
    row(Later, Anything, "^ you|we|one|i send|resend|upload|provide|share|attach|supply|repeat|detect * image|images|picture|pictures|photo|version|list|frame|view|scan|corners|again|first", "", HALTED),
    row(Later, Anything, "can|could|would you send|resend|upload|provide|share|attach|supply|repeat|detect|confirm|check|verify|tell|clarify", "explain", HALTED),
    row(Later, Nobody, "^ send|resend|upload|provide|share|attach|supply a|an|the|another|me|new|fresh * image|images|picture|pictures|photo|version|list|frame|view|scan", "resulting|updated|next", HALTED),
    row(Later, Nobody, "^ take|get|make|capture another|a|one|fresh|new * image|picture|photo|frame|scan", "next|then|after|afterwards|once", HALTED),
    row(Later, Nobody, "^ check|verify|confirm|clarify|decide which|whether|what|that|it|this|these|the|left|right|first", "next|then|after|afterwards|gripper|fingers|camera|arm|table|cable|tip", HALTED),
    row(Later, Anything, "describe|first|planning stage|step|module be|should|must|needs|has * repeated|rerun|redone", "", HALTED),
    row(Later, Anything, "you may|might|could prefer|rather", "", OTHERWISE),
    row(Later, Anything, "would|do you like|want|prefer the|it|to robot|arm|start|begin", "", DOUBTED),
    row(Later, Anything, "just|only tell me", "", DOUBTED),
    row(Later, Anything, "should|shall|may i|we use|take|pick|choose|go|proceed", "", DOUBTED),
    // The answer is to be dropped, or taken for something else.
    row(Ever, Anything, "discard|disregard|ignore|scrap|delete|forget|drop this|these|the|my|those * answer|answers|values|lines|numbers|coordinates|output|above|action|reply|response", "not|no|never", CHANGED),
    row(Ever, Anything, "treat|regard|consider|take|read|see * as unknown|tentative|provisional|placeholder|placeholders|guess|draft|void|open|illustration|illustrative|hypothetical|rough", "not|no|never", DOUBTED),
    row(Later, Anything, "should|can|could|must|may|might not be relied|trusted|executed|obeyed|followed", "ANOTHER", DOUBTED),
    row(Later, Anything, "not be used|run|tried on|by|for|with the robot|arm|gripper", "", DOUBTED),
    row(Later, Anything, "not rely|count on the|these|this|my|those|them", "", DOUBTED),
    row(Later, Anything, "not trust the|these|this|my|those|them numbers|values|points|coordinates|lines|answer|$", "", DOUBTED),
    row(Later, Anything, "stand|stands|stood|standing in for", "not", DOUBTED),
    row(Ever, Anything, "answer|answers|response|responses|output|outputs|reply|actions look|looks|appear|appears|read|reads as|like follows|this|so|that", "", DOUBTED),
    row(Ever, Anything, "line|lines|answer|answers|values|output BE supposed|meant|expected to look|read", "", DOUBTED),
    row(Later, Anything, "show|illustrate|demonstrate|see the|how|what|your * layout|format|structure|syntax|parser", "", DOUBTED),
    row(Later, Author, "filled|fill|put|typed|entered|wrote the|these|those|them|it|in * like this|so|merely|only", "", DOUBTED),
    row(Later, Anything, "format|parser|schema|template demands|wants|needs|forces|insists|expects something|three|two|an|a|some|values|lines|numbers|me", "", DOUBTED),
    row(Later, Anything, "to have|give|offer|say something|anything to|at all", "", DOUBTED),
    row(Later, Anything, "do|must|should not carry|execute|run|use|perform|apply|send|act|follow|trust this|these|it|that|them|anything|on|yet", "ANOTHER", HALTED),
    row(Later, Anything, "the wrong way around|round", "not", DOUBTED),
    row(Ever, Anything, "given|is|are|stated in that|this|another scale|size|resolution", "not", DOUBTED),
    row(Later, Anything, "^ multiply|divide|scale|rescale|convert it|them|the|both|these by|to|back|up|down", "robot|base|world", CHANGED),
    row(Later, Anything, "no valid|possible|suitable|feasible action|answer|pick|move", "other|another|else|longer", HALTED),
    row(Ever, Anything, "told me that my|the proposal|answer|action|pick|suggestion", "", DOUBTED),
    row(Ever, Anything, "neither of the * pictures|images|photos", "", DOUBTED),
    row(Later, Anything, "as a stand in", "not", DOUBTED),
    row(Ever, Author, "made|make|making it|them|this|these|that up", "not", DOUBTED),
    row(Ever, Anything, "not let the robot|arm|gripper", "", HALTED),
    row(Later, Author, "advise|recommend|warn|caution against it|this|that|doing|these|the|send*|execut*|runn*", "", HALTED),
    row(Later, Anything, "no pull|pick|action|fold|point|move that|which i|we could|can|would recommend|name|offer|give|suggest", "", HALTED),
    row(Later, Nobody, "^ choose|pick|take|use|do whichever|whatever", "", OTHERWISE),
    row(Ever, Anything, "forget|disregard|ignore what|the|everything * i wrote|said|gave|stated", "", CHANGED),
    row(Later, Author, "put|putting this|that|it|these on hold|ice", "not", HALTED),
    row(Later, Anything, "can|could not give|offer|state|name|provide a|an|any action|answer|pick|point|values", "", DOUBTED),
    row(Later, Anything, "robot|arm|gripper parked|idle|waiting until|till", "", HALTED),
    row(Later, Answer, "does|do the opposite|reverse|contrary of", "not", DOUBTED),
    row(Later, Anything, "points|values|numbers lie|are|sit on the wrong|other side", "not", DOUBTED),
    row(Ever, Anything, "nothing * should|must|may|can reach|go the|to robot|gripper|arm|the", "", HALTED),
    row(Later, Anything, "BE|the default entries|values|numbers of|from my|the", "not", DOUBTED),
    row(Later, Author, "rolled|tossed|flipped|threw|drew a|the|lots * die|dice|coin|lots", "", DOUBTED),
    row(Ever, Author, "still|quite undecided|torn about|between|on", "not", DOUBTED),
    row(Later, Anything, "leave * lines|values|points|answer unexecuted|unused|aside", "", HALTED),
    row(Ever, Anything, "in my next message|answer|reply|response", "", DOUBTED),
    row(Later, Anything, "tell me whether|which|what|how|if", "", HALTED),
    row(Later, Nobody, "^ make it as|somewhat|slightly much|shorter|longer|a|smaller|larger", "", CHANGED),
    // The values are those of another picture, step, robot or time.
    row(Later, Anything, "belong|belongs|belonged to|with different|another|other|earlier|older|previous", "not", DOUBTED),
    row(Later, Anything, "belong|belongs|belonged to|with|from the|an|a|my|its * earlier|older|previous|different|other|first|last picture|image|frame|scene|step|cloth|subgoal", "not", DOUBTED),
    row(Later, Answer, "^ these|this|those was|were the|my value|values|numbers|coordinates|answer|answers|lines|point|points|action|pull|fold", "", DOUBTED),
    row(Later, Anything, "robot|arm|gripper has|have carried|executed|performed|run|made|done them|it|this|these", "", HALTED),
    row(Later, Author, "worked|computed|wrote|made|meant|intended|planned|derived|calculated this|it|these|them * for a|an|another|the * robot|arm|gripper|cloth|picture|scene|setup|step", "current|present|this", DOUBTED),
    row(Later, Anything, "not to the|these|your|this picture|pictures|image|images|scene|cloth", "", DOUBTED),
    row(Later, Anything, "an|the|my|our|another earlier|previous|other|older|last conversation|session|chat", "", DOUBTED),
    row(Later, Anything, "as i remember|recall|remembered it|them|the|from", "", DOUBTED),
    row(Later, Anything, "in|on|to my version|copy|crop|thumbnail", "", DOUBTED),
    row(Later, Author, "not converted|rescaled|scaled|rotated|corrected it|them|these|those|the|for", "", DOUBTED),
    row(Later, Anything, "the|a way it|they|these|those stand|stands", "", DOUBTED),
    row(Later, Anything, "would|will|should be suitable|right|correct|fine|meant for the|a next|step|fold|picture|pull|later|earlier", "", DOUBTED),
    row(Ever, Anything, "i|you received|got|sent|see BE cropped|blurred|corrupted|black|empty|blank|broken|damaged", "", DOUBTED),
    row(Later, Anything, "pictures|images|picture|image appear|appears|seem|seems|look|looks|are to|be|identical|corrupted|unrelated identical|the|same|corrupted|unrelated|$", "subgoal|goal|next|after|not", DOUBTED),
    row(Later, Anything, "may|might|could have|be nothing|unrelated to", "", DOUBTED),
    row(Ever, Anything, "picture|image|photo scaled|resized|rescaled|shrunk down|up|to", "not", DOUBTED),
    row(Ever, Anything, "image|picture|photo BE|been * resized|downscaled|downsampled|rescaled|scaled|shrunk|reduced|enlarged|upscaled to|on|by|down|up", "not", DOUBTED),
    row(Ever, Anything, "in|from|on|of|to that|this|a|the|my smaller|larger|reduced|resized|scaled picture|image|version|copy", "not", DOUBTED),
    row(Later, Anything, "has|have|needs|need|must|should to|be * exchanged|interchanged|swapped|switched|rescaled|multiplied|converted", "not", CHANGED),
    row(Later, Anything, "refers to the|a picture|image|scene|frame|photo labelled|labeled|called|named|before|after", "", DOUBTED),
    row(Later, Anything, "have|has since sent|changed|moved", "", DOUBTED),
    row(Later, Author, "not got|had|looked|analysed|analyzed|seen round|around|time|at that|this|it|to * one|it|yet|$", "", DOUBTED),
    row(Later, Anything, "only once|after|when|if you", "", CONDITIONAL),
    // The author cannot see, or does not stand by it.
    row(Later, Anything, "have|had|has misgivings|doubts|reservations about|with|on|$", "no", DOUBTED),
    row(Later, Anything, "no longer recommend|stand|believe|think|trust|suggest|propose", "", DOUBTED),
    row(Later, Anything, "might|may|could well be", "", DOUBTED),
    row(Later, Author, "lost track", "", DOUBTED),
    row(Later, Anything, "should|ought|must really|rather|better be|have", "", CHANGED),
    row(Later, Anything, "^ the|what one|ones|i i|wrote|gave wrote|gave|stated|put|chose|$ $", "", CHANGED),
    row(Ever, Anything, "can|could|do|did not see|view|open|access|load|process the|any|an|your|these|those|two|either|both|images|pictures images|pictures|image|picture|photo|photos|two|at|here|in|myself", "in the", DOUBTED),
    row(Ever, Anything, "not able to view|see|access|open|load|process the|any|an|your|these|those|two|images|pictures", "corner|edge", DOUBTED),
    row(Ever, Anything, "unable to view|see|access|open|load|process the|any|an|your|these|those|two|images|pictures", "corner|edge|hidden", DOUBTED),
    row(Ever, Author, "am a|an|only|just * text|language only|based|model", "", DOUBTED),
    row(Later, Anything, "what i would|want|wanted|meant|recommend|suggest|advise|intend|intended", "BE", OTHERWISE),
    row(Later, Anything, "not what i would|want|wanted|meant|recommend|suggest|advise|intend|intended", "", DOUBTED),
    row(Later, Anything, "toss up", "", DOUBTED),
    row(Later, Anything, "without|no a|any|real|particular|good|strong reason|basis|evidence|ground to|for", "not", DOUBTED),
    row(Later, Author, "will|can|shall|would|could put|give|fill|issue|send|provide|state|name|supply|replace|update|correct * actual|real|final|correctly|proper|precise|exact|updated|right|true|correct", "", DOUBTED),
    row(Later, Author, "will tell|give|send|name you the|my|a pull|values|answer|point|points|action|fold|coordinates", "", DOUBTED),
    row(Later, Author, "wrote|gave|stated|answered|typed|named|entered * the|a other|wrong|opposite", "had|before|previously|earlier|last", DOUBTED),
    row(Later, Author, "see|realise|realize|notice now", "", DOUBTED),
    row(Later, Author, "now see|realise|realize|notice", "", DOUBTED),
    row(Later, Author, "noticed|saw|realised|realized * too late", "", DOUBTED),
    row(Later, Anything, "as i wrote|gave|stated|proposed|put|said would|will|only|just|it", "", DOUBTED),
    row(Later, Anything, "what i have given|written|wrote|gave|stated|put would|should|could|might|belongs|is", "", DOUBTED),
    // Something else, or nothing, should be done.
    row(Later, Anything, "robot|arm|gripper|one|you|we ought|should to|go|start|begin|work go|start|begin|at|on|with|from|there|this|$", "then|next|later|afterwards|slow*|gent*", OTHERWISE),
    row(Later, Anything, "one|you|we would|will have|need to start|begin|pick|go|take|pull|proceed|use|choose", "then|next|later|afterwards|if", OTHERWISE),
    row(Later, Anything, "it|that would be better|best|preferable|wiser|safer|wise|good $", "", OTHERWISE),
    row(Later, Anything, "it|that would be better|best|preferable|wiser|safer|wise to", "not|than", OTHERWISE),
    row(Later, Anything, "would be a|an|rather * mistake|error|folly to", "ANOTHER", HALTED),
    row(Later, Anything, "BE to stop|wait|pause|halt|abort|leave|stay", "not|will|corner|flap|half", HALTED),
    row(Later, Nobody, "^ stop|end|finish here $", "", HALTED),
    row(Later, Anything, "^ this|that|it * done|completed|executed|performed already", "not", HALTED),
    row(Always, World, "nothing left|more|else * do|fold|smooth|flatten", "", HALTED),
    row(Later, Anything, "nothing left|more|else * do|fold|smooth|flatten", "", HALTED),
    row(Later, Anything, "smoothing|task|job|folding|goal|sequence BE finished|complete|completed|done|reached|accomplished|achieved", "not|then|when|once|until|almost|nearly|next|after|before|will|would", HALTED),
    row(Later, Anything, "no|without further|more|additional|any pull|fold|action|step|move|motion BE|$ needed|required|necessary|$", "", HALTED),
    row(Later, Nobody, "^ may|might not be|match|fit|correspond|hold|show", "", DOUBTED),
    row(Later, Anything, "threw|rolled|tossed|flipped the|a|some dice|die|coin", "", DOUBTED),
    row(Later, Anything, "picked|chose|took|chosen|selected * at random|blindly", "not", DOUBTED),
    row(Later, Anything, "BE * slip|typo|oversight|misprint|misreading", "not|no|earlier", DOUBTED),
    row(Later, Anything, "do|does not belong here|there", "", DOUBTED),
    row(Later, Author, "nothing to propose|suggest|offer|recommend|contribute|add", "else|further|more", HALTED),
    row(Ever, Anything, "gripper|robot|arm was|were|is sent|run|driven with|by|to", "next|then|will", DOUBTED),
    row(Later, Author, "repeated|copied|reused|recycled the|my old|previous|last|earlier", "not", DOUBTED),
    row(Later, Anything, "need|needs|have|has to be reworked|redone|revised|reconsidered|rethought|rechecked|verified|confirmed", "next|then|later", HALTED),
    row(Later, Anything, "^ leave it|them|everything|this|that alone|$", "", HALTED),
    row(Later, Anything, "leave|leaving|left it|this|that|them|the|choice|decision to|up you|your|someone|somebody", "", DOUBTED),
    row(Later, Anything, "which * you want|prefer|would|like|mean|meant", "", DOUBTED),
    row(Ever, Anything, "pull|step|fold|move|action|command|it already been carried|executed|performed|done|completed", "first|second|third|previous|earlier|last|one|two|half|not", HALTED),
    row(Ever, Anything, "the|this step|pull|move|action|command has|have * been performed|executed|carried|completed|done", "first|second|third|previous|earlier|last|once|until|then|half|one|two|not|after|when", HALTED),
    row(Later, Answer, "breaks|violates|breaches|contradicts the|a|your|its rule|rules|instruction|constraint|condition|limit", "not|would|no", DOUBTED),
    row(Later, Anything, "^ what should|must|has|needs|ought * now|instead", "", OTHERWISE),
    row(Later, Author, "not think|believe|recommend|advise the|that|this|it|we * should|ought|be", "problem|matter|issue|risk|obstacle", DOUBTED),
    row(Later, Anything, "skip|omit|cancel the|this|that movement|move|motion|pull|action|command", "not|next", HALTED),
    row(Later, Anything, "nothing more has|needs|is to|needed", "lift|hold|grip|than", HALTED),
    row(Later, Anything, "nothing should|must|can be folded|moved|pulled|done|executed|picked", "", HALTED),
    row(Later, Author, "listed|put|wrote|gave|stated|entered the target|goal|destination|place|start|pick * first|line|second", "", CHANGED),
    row(Ever, Anything, "not received|seen|got|given|been * pictures|picture|image|images|photo|photos", "corner|flap", DOUBTED),
    row(Later, Anything, "merely|just|only|simply a|an|the|one * typical|common|usual|generic|frequent|standard|plausible|template", "", DOUBTED),
    row(Later, Anything, "honest|proper|real|true answer|choice|option|action would|is|should|BE", "not", DOUBTED),
    row(Later, Anything, "no evidence|basis for|of any", "", DOUBTED),
    row(Later, Answer, "point|pick|place|above|direction|distance|value should|ought|must be the|a one|other|opposite", "", CHANGED),
    row(Later, Author, "would have|need|want to know|see|check|verify|ask", "if", DOUBTED),
    row(Later, Author, "would like|need|want|prefer * picture|view|image|photo|look|scan", "", DOUBTED),
    row(Later, Anything, "^ do not * before|until", "", HALTED),
    row(Ever, Anything, "robot|gripper|arm should|must|need not|never touch|move|act|do|grip|pull", "ANOTHER|further|too|far|beyond|faster", HALTED),
    row(Ever, Anything, "run|rollout|task|process can|may|should be closed|ended|stopped|finished", "", HALTED),
    row(Ever, Anything, "robot|arm|gripper stays|rests|remains|waits put|idle|parked|$", "", HALTED),
    row(Ever, Anything, "format|template|fields|lines has|have|had|must to|be * filled", "", DOUBTED),
    row(Later, Anything, "can|could not be right|correct|true", "", DOUBTED),
    row(Later, Anything, "take it|that|this|them back $", "", DOUBTED),
    row(Later, Author, "take the|my|this|that|these|those above|answer|values|lines|proposal|one back", "", DOUBTED),
    row(Later, Answer, "should|must|can not be used", "", DOUBTED),
    row(Later, Answer, "^ it|this|that BE invalid|void|mistaken", "", DOUBTED),
    row(Later, Anything, "lines|values|points|numbers|answer * BE * mistaken|wrong|incorrect|invalid|void", "not|previous|earlier|last", DOUBTED),
    row(Later, Author, "would ask you to", "", HALTED),
    row(Later, Anything, "no other|better proposal|suggestion|idea", "", DOUBTED),
    row(Ever, Anything, "numbers|values|lines|coordinates|points merely|only|just fill|serve|illustrate|restate|repeat|show", "", DOUBTED),
    row(Later, Anything, "not reflect any|an|the|my|real|actual", "", DOUBTED),
    row(Later, Anything, "what should|must|ought be done|picked|pulled|folded", "^ what", OTHERWISE),
    row(Ever, Anything, "^ what was|has * carried|executed|done first|before|last|earlier|out", "not", DOUBTED),
    row(Later, Anything, "BE what was|has|have carried|executed|done|been", "not", DOUBTED),
    row(Later, Answer, "illustrate|illustrates|refer|apply|relate to|how|your", "also", DOUBTED),
    row(Later, Anything, "for the record", "", DOUBTED),
    row(Later, Answer, "^ these|this|those would be the|my", "", CONDITIONAL),
    row(Later, Anything, "seem|seems|appear|appears to stem|originate|date", "", DOUBTED),
    row(Later, Anything, "detection|detector|camera|picture|list|calibration|scan should|must|needs|has|ought * run|repeated|redone|updated|refreshed|retaken", "", HALTED),
    row(Later, Anything, "what worries|bothers|troubles me", "", DOUBTED),
    row(Ever, Anything, "not for|to|intended|meant execution|execute|use|be|for * executed|execution|used|use|run", "", HALTED),
    row(Ever, Anything, "^ not for|intended|meant execution|use|for|to", "", HALTED),
    row(Later, Anything, "final|actual|real version|answer|values|action follows|comes|will", "", DOUBTED),
    row(Later, World, "step|pull|fold * has|have * been completed|performed|executed", "first|second|third|previous|earlier|last|once|until|then|half|one|two|not|after|when", HALTED),
    row(Later, Nobody, "^ proceed|continue|go to|on|with * next|following step|instruction|picture", "then|after|afterwards", HALTED),
    row(Later, Anything, "instead of running|repeating|executing this|it", "", HALTED),
    row(Later, Anything, "contrary to what|my", "", DOUBTED),
    row(Later, Answer, "^ this|these was|were the first|last|previous|earlier", "", DOUBTED),
    row(Later, Anything, "BE still to come|follow", "", DOUBTED),
];

/// A word of a pattern: one of several that fit, or a gap.
enum Piece {
    Words(Vec<Fit>),
    Gap,
    Start,
    End,
}

enum Fit {
    Word(&'static str),
    Stem(&'static str),
    Ending(&'static str),
    List(&'static [&'static str]),
    /// The end of the clause, in place of a word: `not $|answer`.
    End,
}

/// What the rows of a table say, and what they say instead.
type Patterns = Vec<(Vec<Piece>, Vec<Piece>)>;

fn patterns(rows: &[Row]) -> Patterns {
    let read = |row: &Row| (pieces(row.says), pieces(row.unless));
    rows.iter().map(read).collect()
}

static OF_ROWS: LazyLock<Patterns> = LazyLock::new(|| patterns(ROWS));
static OF_PLAIN: LazyLock<Patterns> = LazyLock::new(|| patterns(PLAIN));

fn pieces(pattern: &'static str) -> Vec<Piece> {
    let fit = |word: &'static str| {
        if word == "$" {
            return Fit::End;
        }
        let list = LISTS.iter().find(|(name, _)| *name == word);
        match (word.strip_suffix('*'), word.strip_prefix('*'), list) {
            (Some(stem), ..) => Fit::Stem(stem),
            (None, Some(ending), _) => Fit::Ending(ending),
            (None, None, Some((_, list))) => Fit::List(list),
            (None, None, None) => Fit::Word(word),
        }
    };
    let piece = |word: &'static str| match word {
        "*" => Piece::Gap,
        "^" => Piece::Start,
        "$" => Piece::End,
        _ => Piece::Words(word.split('|').map(fit).collect()),
    };
    pattern.split_whitespace().map(piece).collect()
}

/// Returns why a clause cannot stand beside an answer that is meant, if a row says so.
pub(super) fn why(clause: &Clause<'_>) -> Option<&'static str> {
    first(ROWS, &OF_ROWS, clause)
}

/// The same, by the rows that hold in the midst of an explanation.
pub(super) fn plainly(clause: &Clause<'_>) -> Option<&'static str> {
    first(PLAIN, &OF_PLAIN, clause)
}

fn first(rows: &[Row], patterns: &Patterns, clause: &Clause<'_>) -> Option<&'static str> {
    let named = clause.named();
    let found = rows.iter().zip(patterns).find(|(row, (says, unless))| {
        let is_then = match row.when {
            When::After => clause.place == Place::After,
            When::Later => clause.place != Place::Before,
            When::Ever => true,
            When::Always => {
                clause.place != Place::Before || row.of == World || refers_forward(named)
            }
        };
        let is_of_it = match row.of {
            Anything => true,
            Answer => clause.subject == Subject::Answer,
            Author => clause.subject == Subject::Author,
            World => clause.subject == Subject::World,
            // `Reason: fold the hem up` is no order, and neither is `this lifts the hem and moves it`.
            Nobody => {
                let goes_on = row.when == After && [":", "and", "or"].contains(&clause.joint);
                clause.subject == Subject::Nobody && !goes_on
            }
        };
        is_then
            && (row.when == Ever || !clause.is_sequel)
            && is_of_it
            && says_pattern(clause.words, says)
            && !says_pattern(clause.words, unless)
    });
    found.map(|(row, _)| row.why)
}

fn says_pattern(words: &[&str], pattern: &[Piece]) -> bool {
    !pattern.is_empty() && (0..words.len()).any(|at| fits(words, at, pattern))
}

fn fits(words: &[&str], at: usize, pattern: &[Piece]) -> bool {
    let Some((piece, rest)) = pattern.split_first() else {
        return true;
    };
    match piece {
        Piece::Start => at == 0 && fits(words, at, rest),
        Piece::End => at == words.len() && fits(words, at, rest),
        Piece::Gap => (at..=at + MAX_GAP).any(|at| fits(words, at, rest)),
        Piece::Words(any) => {
            let fits_word = |word: &&str| {
                any.iter().any(|fit| match fit {
                    Fit::Word(wanted) => wanted == word,
                    Fit::Stem(stem) => word.starts_with(stem),
                    Fit::Ending(ending) => word.ends_with(ending),
                    Fit::List(list) => list.contains(word),
                    Fit::End => false,
                })
            };
            let may_end = any.iter().any(|fit| matches!(fit, Fit::End));
            may_end && at == words.len() && fits(words, at, rest)
                || words.get(at).is_some_and(fits_word) && fits(words, at + 1, rest)
        }
    }
}
