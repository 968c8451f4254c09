//! The words that the grammar of doubt knows, by what they do in a clause.

use crate::reply::wordlist::words;

/// What stands for the answer.
pub(super) const PRONOUNS: &[&str] = words!("this that it these those they them");

/// What names the answer or a part of it.
pub(super) const PARTS: &[&str] = words!(
    "grasp answer answers value values number numbers coordinate coordinates coords pixels point points pick place pull
    direction distance grip angle action move choice result output entry entries estimate estimates pair suggestion
    proposal response json fold plan figures data spot lines two three above following x y"
);

/// What names an answer as a whole.
pub(super) const ANSWERS: &[&str] = words!(
    "answer answers action move choice result output response reply proposal suggestion pick grasp pull fold attempt example
    values pair"
);

/// What may have stated values besides the model and people.
pub(super) const REPORTERS: &[&str] = words!(
    "model models assistant agent baseline heuristic planner detector script tool user team policy"
);

/// How somebody else states values, or carries them out.
pub(super) const REPORTING: &[&str] = words!(
    "did chose used executed performed ran tried made suggested suggests proposed proposes answered answers said says gave
    gives wrote writes returned returns recommended recommends picked predicted predicts"
);

/// What counts parts of the answer: `none of that`, `both`.
pub(super) const QUANTIFIERS: &[&str] = words!(
    "any all both each either neither none most some much everything anything nothing half one"
);

/// What may stand between an article and its noun.
pub(super) const QUALIFIERS: &[&str] = words!(
    "above two three last final whole entire given stated next previous proposed suggested chosen same"
);

/// Who carries the answer out.
pub(super) const AGENTS: &[&str] = words!(
    "you we robot robots arm arms gripper grippers manipulator machine controller effector hand one nobody"
);

/// Who would decide in the model's place, or do better.
pub(super) const PEOPLE: &[&str] = words!(
    "whoever human humans person operator operators somebody someone supervisor expert experts technician colleague colleagues
    engineer engineers people anybody anyone specialist manager boss novice beginner amateur professional professionals
    tailor teacher reviewer inspector owner staff teammate coworker adult grown-up child layman everyone everybody"
);

pub(super) const ARTICLES: &[&str] = words!("the a an my our your his its their any every");
pub(super) const BE: &[&str] = words!("is are was were be been being am");
pub(super) const MODALS: &[&str] = words!(
    "should must ought need needs have has had may might can could will would shall do does did"
);
pub(super) const DUTIES: &[&str] = words!("should must ought need needs have has had");
pub(super) const SUPPOSING: &[&str] = words!("would might may could");
pub(super) const NEGATIONS: &[&str] =
    words!("not never no nothing none neither nor hardly barely scarcely without little few");

/// What softens doubt to its opposite: `less risky`.
pub(super) const DIMINISHING: &[&str] = words!(
    "less not no without never least avoid avoids avoiding reduce reduces any beyond hardly prevent prevents"
);

/// Verbs beside `be` that join a judgement to its subject.
pub(super) const SEEMING: &[&str] = words!(
    "seem seems seemed look looks looked feel feels felt remain remains sound sounds came come comes turned turns
    ended proved got stay stays"
);

/// What may begin a clause without being part of its statement.
pub(super) const OPENING: &[&str] = words!(
    "please kindly honestly frankly but and or so well actually also just maybe perhaps possibly however still though
    yet sadly unfortunately somehow simply anyway note warning caution disclaimer caveat important oh okay ok really
    personally arguably admittedly again therefore thus hence basically mind remember ah alas importantly ps nb
    overall sorry as that for now today
    reason reasoning explanation rationale comment remark notes message thought thoughts status description why
    justification info brief"
);

/// What tells of a later step.
pub(super) const SEQUEL: &[&str] = words!(
    "then next afterwards afterward later finally once after when subsequently second following thereafter done if
    should future further"
);

/// What begins a clause that gives a reason or describes something.
pub(super) const EXPLAINING: &[&str] =
    words!("because since which who where whereas while when if than although though whether how");

/// What begins any other clause.
pub(super) const JOINING: &[&str] = words!("and but so or before until unless yet");

/// Doubt, as nouns, adjectives and participles.
pub(super) const DOUBTS: &[&str] = words!(
    "scrambled jumbled pretended fallback fallbacks illustrative symbolic notional bad pending awaiting sketch guess guesses guessed guessing guesswork guesstimate guesstimates eyeballed hunch stab dice gamble lottery
    random randomly arbitrary arbitrarily haphazard hallucinated hallucination hallucinations fabricated fabrication
    invented fictional fictitious imaginary imagined fake faked bogus dummy placeholder placeholders filler fillers
    nonsense nonsensical garbage gibberish rubbish junk trash meaningless worthless useless pointless unreliable
    untrustworthy dubious doubtful doubt doubts questionable iffy shaky sketchy fishy flimsy speculative speculation
    tentative provisional premature unverified untested unconfirmed unchecked unmeasured unsure uncertain unknown void
    null invalid retracted withdrawn revoked rescinded cancelled canceled improvised joke prank hypothetical
    hypothetically moot stale outdated obsolete expired superseded leftover leftovers recycled boilerplate mistaken
    mistake mistakes erroneous error faulty flawed incorrect inaccurate imprecise wrong wrongly backwards backward
    mixed swapped transposed garbled botched unsafe dangerous risky hazardous unusable untenable inadvisable unwise
    foolish reckless makeshift stopgap blind blindly nominal suspect suspicious crude sloppy careless debatable
    disputable unfounded baseless unsupported unjustified inconclusive insufficient unacceptable unworkable infeasible
    impossible unrealistic implausible unlikely misguided misplaced misjudged mistyped typo bluff fiction fantasy
    premise draft scribble improbable ungrounded unreal doomed hopeless off outside nowhere anywhere unfinished
    incomplete untrue false illusory worse worst defective unfit unsuitable inappropriate vague
    exaggerated overestimated underestimated contrived fluke shot todo tbd fixme stub stubs mock mocked fib myth mirage sham"
);

/// Doubt that also describes places and sides, and so counts only in a judgement of the answer.
pub(super) const WEAK_DOUBTS: &[&str] = words!(
    "bad off outside nowhere anywhere backwards backward mixed swapped blind blindly unknown draft error mistake mistakes
    premise null shot worse worst wrong incorrect impossible incomplete unlikely false risky suspect nominal unsafe
    insufficient invalid misplaced incorrectly wrongly unfinished dangerous crude imprecise inaccurate vague"
);

/// Trust, which is doubt where it is denied.
pub(super) const TRUSTED: &[&str] = words!(
    "instruction recommendation command solution prediction measurement supposed how what where reliable trustworthy real final accurate certain sure correct right valid usable safe trusted verified measured
    permissible admissible meant serious binding official authoritative definitive conclusive sound suitable ready feasible reachable
    executable intended recommended advisable wise useful worth dependable confident grounded based checked tested
    confirmed credible sensible good mine settled true possible workable sane solid convinced comfortable allowed
    permitted acceptable happy satisfied convincing plausible believable guaranteed"
);

/// What the author may do to doubt the answer: `I doubt`, `I made it up`.
pub(super) const AUTHOR_DOUBTS: &[&str] = words!(
    "transposed scrambled mistyped admit confess concede wonder ponder mixed confused guess guessed doubt doubted regret retract retracted withdraw withdrew revoke rescind hesitate distrust mistrust
    eyeballed improvised invented fabricated hallucinated bluffed gambled faked lied erred misjudged misread miscounted
    misidentified misplaced copied pasted recycled borrowed pretended rushed botched fumbled dislike apologise
    apologize disagree question object refuse decline worry fear dread suspect abstain reconsider recant"
);

/// What the author feels in doubt: `I am unsure`.
pub(super) const AUTHOR_FEELINGS: &[&str] = words!(
    "surprised amazed astonished shocked leaning tempted inclined unsure uncertain hesitant reluctant sceptical skeptical doubtful wary uneasy uncomfortable confused lost torn
    guessing bluffing joking kidding pretending improvising worried afraid sorry unhappy unconvinced clueless stumped
    speculating inventing wrong mistaken retracting withdrawing dubious nervous unwilling unable"
);

/// What the author does with an answer that is meant.
pub(super) const COMMITTING: &[&str] = words!(
    "trust vouch guarantee recommend rely stand advise endorse bet go risk execute act commit promise believe count
    use do send follow swear attest defend support suggest bank carry run perform mean say know
    assume propose want"
);

/// What the author would prefer to the answer.
pub(super) const PREFERRING: &[&str] =
    words!("rather sooner prefer opt hold wait leave skip want love start begin");

/// Orders that stop what is going on, whatever follows them.
pub(super) const HALTS: &[&str] = words!(
    "wait stop pause halt abort postpone delay defer refrain desist freeze reconsider rethink replan retake rescan
    remeasure recheck recalibrate rewind"
);

/// In which way an arm moves: `the gripper should stay closed`.
pub(super) const WAYS: &[&str] = words!(
    "closed shut open level low high above slow steady firm gentle vertical upright parallel"
);

/// Orders that dismiss or change what they name.
pub(super) const DISMISSALS: &[&str] = words!(
    "skip ignore discard disregard scrap toss bin drop forget reject delete erase strike scratch cancel void overwrite
    undo redo revert treat consider regard take view see verify check confirm double-check adjust correct fix shift swap
    change replace revise nudge raise lower reverse mirror flip abandon shelve dismiss trash dump revisit repeat ditch
    distrust mistrust doubt question unsee rub suspend hold refuse veto override round scale rotate invert exchange
    interchange switch shorten lengthen extend enlarge shrink halve double multiply divide add subtract turn drop bump tweak modify amend edit reinterpret reread keep call file postpone strike burn"
);

/// Orders that may name the answer without dismissing it: `Keep it flat`, `Check it in the next image`.
pub(super) const HARMLESS_ORDERS: &[&str] =
    words!("take see view keep call lower raise turn repeat check verify confirm consider hold");

/// Orders that carry something out, which are doubt where they are forbidden.
pub(super) const ACTS: &[&str] = words!(
    "read act execute move do go run use follow trust rely send start try pick grasp grab grip fold lift apply perform carry
    believe proceed take count put pull drag touch begin place tackle choose select commit fire press rush bother
    unfold smooth flatten flip turn stack straighten"
);

/// The same, of the answer alone.
pub(super) const EXECUTING: &[&str] =
    words!("act execute run use trust rely apply perform proceed believe commit");

/// Orders that are no business of the robot.
pub(super) const CALMING: &[&str] =
    words!("worry mind hesitate forget need want think let be expect");

/// What a later look would do to the answer.
pub(super) const REVISED: &[&str] = words!(
    "determined found located recomputed redetermined ignored discarded skipped scrapped checked verified confirmed measured treated taken adjusted corrected shifted
    moved swapped raised lowered nudged rounded increased decreased reduced extended shortened flipped reversed rotated
    scaled replaced changed revised reconsidered rechecked double-checked re-measured reviewed disregarded dismissed
    dropped deleted cancelled canceled overwritten redone revisited mirrored exchanged inverted doubled halved
    subtracted added multiplied divided offset approved validated remeasured refined postponed delayed amended retaken
    turned tweaked trimmed bumped put interpreted considered regarded viewed seen higher further farther
    smaller larger bigger shorter longer closer left"
);

/// What is done to an answer that is meant.
pub(super) const USED: &[&str] = words!(
    "used executed trusted followed carried relied taken run performed sent believed considered acted treated applied
    tried done read counted attempted quoted implemented happen counted"
);

/// What an answer may demand instead of being carried out.
pub(super) const DEMANDING: &[&str] =
    words!("need needs require requires want wants deserve deserves call calls");
pub(super) const DEMANDED: &[&str] = words!(
    "checking measuring verification review confirmation adjusting turning correcting approval supervision testing
    validation shifting care caution rethinking work revision adjustment correction double-checking refinement another
    attention salt"
);

/// What a fold does to a cloth, and an answer to its task; stems.
pub(super) const EFFECTS: &[&str] = words!(
    "level eas squar trim bur shield wrap seal press squeez pin relax loosen orient steer guid reposition relocat transfer transport sweep glid head travel pivot nest track trac replicat recreat shrink grow thin crumpl wrinkl pleat gain accomplish progress pav lock secur stabili settl untwist bring brought move mov fold unfold lay laid lie lying put place plac pull lift open clos turn spread stretch
    reach end stop stopp go goes gone come came get gets make made making take took taking align match cover uncover
    reveal expos flatten smooth straighten leav left keep kept give gave giv reduc increas improv creat form avoid
    allow let complet finish result produc yield maximi minimi cross meet met overlap coincid land rest sit start
    begin began follow lead led run point correspond fit fall fell halv doubl shorten lengthen tuck hid undo unroll
    roll repeat mirror preserv restor remov clear carr drag slid touch caus show remain stay cent agree satisf respect
    fulfil achiev advanc free releas separat connect join extend lower rais shift bend bent creas hang hung drop
    gather stack requir need us set fix correct resolv solv help continu work serv mark defin determin narrow widen
    tighten loosen unwrap swing rotat reflect depict represent indicat refer describ say tell mean impl ensur
    prevent protect hold held support prepar enabl simplif add count contribut equal total span measur differ look
    seem appear becom have has had do does target aim address handl divid split pair pass approach exploit balanc
    even mimic imitat reproduc resembl consist contain includ apply appl belong assum suppos presuppos presum
    depend hing los tidy tid sav expand bound suffic favo combin concern flip push pinch grasp grip grab hit
    underl build built tak invert revers unti release guid"
);

/// What a judgement of the answer may say without doubting it.
pub(super) const FIT: &[&str] = words!(
    "corner corners edge edges hem sleeve sleeves cuff cuffs collar fold folds crease creases line lines middle middles
    center centre half quarter side sides end ends tip point points place pick pixel pixels coordinates coordinate image
    picture frame cloth fabric towel shirt garment layer layers outline border boundary mask table gripper robot answer
    choice move step action target goal instruction instructions task demonstration way direction angle distance grip
    degrees deg listed offered allowed free visible flat clear close near nearest closest far farthest furthest same equal
    mirrored opposite parallel perpendicular diagonal diagonally vertical horizontal up down left right top bottom upper
    lower inside within on at in along above below between under over to from enough sufficient necessary needed
    best good ideal optimal correct exact exactly symmetric symmetrical aligned because why what where how due based
    chosen given measured estimated taken counted read used made done meant first second last only next one two three
    length width part portion spot region area location position motion pull path mirror image's result reverse
    inverse continuation counterpart important safe stable reachable about roughly approximately around identical
    consistent complete final straight wrinkle wrinkles shape triangle rectangle square strip midpoint mean average
    tightest largest smallest longest shortest outermost innermost topmost lowest highest leftmost rightmost deepest
    expected similar common typical usual standard simple simplest quick short long small large big gentle slight
    enough all both with without of out back ready going able like as so most more less fully completely just
    already still now then also there possible"
);

/// What the author may be.
pub(super) const COMPOSED: &[&str] = words!(
    "confident sure certain happy glad able ready aware convinced pleased here aiming going assuming"
);

/// What the author would do without preferring something else.
pub(super) const POLITE: &[&str] =
    words!("expect say call keep hope be like love describe estimate also continue still");

/// What the author does with an answer that is meant.
pub(super) const AUTHORED: &[&str] = words!(
    "choose chose chosen pick picked select selected verify verified check checked estimate estimated measure measured
    compute computed calculate calculated derive derived read take took base based mark marked find found determine
    determined confirm confirmed place placed use used set believe think expect prefer preferred recommend suggest
    propose decide decided double-checked doublechecked traced trace follow followed consider considered see saw
    identify identified locate located obtain obtained got infer inferred settle settled compare compared need make
    made did do want keep kept adjust adjusted move moved fold folded hope write wrote rounded round convert converted
    lift lifted pull pulled put get left leave let count counted describe described repeat repeated give gave given
    copied answered answer went go tested test reflected mirrored projected matched aligned reached drew mapped"
);

/// What opens a sentence that takes something back.
pub(super) const DISCLOSING: &[&str] = &[
    "to be honest",
    "to be fair",
    "to be frank",
    "in truth",
    "truth be told",
    "truthfully",
    "frankly",
    "honestly",
    "mind you",
    "nope",
    "nah",
    "sigh",
    "ugh",
    "argh",
    "nevertheless",
    "nonetheless",
    "but",
    "having said that",
    "in reality",
    "in fairness",
    "that being said",
    "regrettably",
    "alas",
    "whoops",
    "oops",
    "yikes",
    "except",
    "come to think",
    "then again",
    "oh",
    "dear",
    "darn",
    "ouch",
    "uh",
    "hm",
    "good grief",
];

/// What takes back or doubts, in languages that models drift into; stems.
pub(super) const FOREIGN: &[&str] = words!(
    "ejecutes ejecute falsch verwechselt vertauscht vertan ausführen geraten erfunden platzhalter unsicher ignorier verwerf ungültig
    entschuldigung verworfen vermutung zweifel abwarten
    perdón equivoqu inventad adivin ignora dudos duda descart aleatori
    équivoqu erreur désolé trompé inversé inventé ignorez exécut hasard devin deviné
    sbagliato scusa scusate inventat ignorate invertit eseguir
    errado errei desculpe chutei inventei
    неверн ошиб случайн выдуман игнориру"
);

/// The same as phrases; separated by `|`.
pub(super) const FOREIGN_SAYINGS: &str = "stimmt nicht|stimmt so nicht|nicht richtig|nicht sicher|bitte nicht|no estoy|al azar|no deben ejecutarse|no debe ejecutarse|no deben enviarse|no consigo ver|no puedo ver|envíe la|envíe una|no uses|pas sûr|pas certain|pas fiable|n'est pas|ne pas|não tenho|não use|não estou|non sono|non usare|non usate|bitte warten|por favor espere|me trompe|ziehe sie zurück|ziehe ich zurück|ziehe das zurück|ist hinfällig|noch einmal fotografieren|noch einmal fragen|d'illustration|mieux vaut ne|reposer la question|revenir là dessus|retiro lo dicho|sin efecto|repetir la foto|riempite a caso|rifatemi la domanda";

/// The same, in languages without blanks between words.
pub(super) const FOREIGN_WITHIN: &[&str] = words!(
    "信頼でき 不可靠 不可信 不准 存疑 待确认 未确认 不对 错 等等 参考 不要 不确定 随便 瞎 编的 占位 忽略 猜 作废 別 别用 無視 推測 実行しない 仮の 間違 自信が わかりません
    適当 违 違 잘못 무시 추측 실행하지 확실하지"
);

/// What makes the line above the values an introduction of what is right elsewhere, later or in somebody else's words.
pub(super) const LATER: &[&str] =
    words!("later if unless once until could might had were said wrote answered");

/// What an answer of another turn, or of another picture, is introduced with.
pub(super) const OTHER: &[&str] = words!("last previous earlier first other former old");
pub(super) const OTHERS: &[&str] = words!(
    "week month session message answer reply response step turn picture image photo photograph frame scene cloth demonstration example"
);

/// What introduces values that are not meant; separated by `|`.
pub(super) const FORMALITIES: &str = "as long as|so long as|provided that|on condition|since i have to answer|because i have to answer|since i must answer|because i must answer|have to say something|for the sake of|satisfy the|to comply|that parses|it parses|here is something|here are some|for completeness\
    |for form|pro forma|formally|nominally|are worth|is worth|if only to|if i had to|if i were|were i|if forced|if pressed\
    |if you insist|just to have|so as not to|to keep the parser|your own numbers|your own values|your own coordinates|your own points|wants something|needs something|expects something|requires something|something anyway|wants an answer|needs an answer|wants some|expects some|to please";

/// Verbs that tell where an answer is from or what it is for.
pub(super) const ORIGINATING: &[&str] = words!(
    "belong belongs refer refers stem stems come comes date dates meant intended taken copied borrowed left from for
    lifted quoted cribbed pertain pertains describe describes correspond corresponds apply applies concern concerns"
);

/// What is not this answer's picture, step or robot.
pub(super) const ELSEWHERE: &[&str] = words!(
    "neighbouring neighboring similar once previous earlier another other old different second example examples format prompt template tomorrow later
    demonstration yesterday somebody someone memory nowhere wrong previous"
);

/// Sayings that doubt or halt, whatever they are said of; separated by `|`.
pub(super) const SAYINGS: &str = "stand in for|stands in for|should rather|must rather|ought rather|could be that|may be that|might be that|could well be|may well be|might well be|more good|will want to|may want to|might want to|place to start|place to begin|more promising|more urgent|more sensible|more suitable|seems better|looks better|came to mind|chance of success|no point in|no sense in|no use in|no guarantee|no hope|no certainty|too early|too late|from nothing|on balance|wanted to say|meant to say|would benefit|should come first|must come first|needs to come first|has to come first|ought to come first|the other way round|the other way around|wrong way round|in the dark|grain of salt|pinch of salt\
    |coin flip|coin toss|flip of a coin|toss of a coin|second opinion|need a closer look|needs a closer look|deserves a closer look\
    |take it back|take that back|take this back|strike that|my gut|top of my head|at face value|this one out|stand down|standing down|hold off|holding off|hold fire|hold your|hold back|call it off|call this off\
    |drawing board|not so fast|too soon|think twice|think again|who knows|your guess|no way to know|own risk|no promises\
    |no guarantee|no guarantees|no warranty|for what it is worth|made up|made it up|made them up|making this up|making it up\
    |had better|would better|best left|better left|up to you|your call|your discretion|never said|never happened|out of thin air\
    |on a whim|on a hunch|not mine|not my|do nothing|strikes me|do not act|not act on|not act upon|better not|rather not|best not\
    |of no use|good for nothing|blind guess|filled in the blanks|fill in the blanks|i see now|now i see|i now see|i realise now\
    |i now realise|i realize now|i now realize|i just noticed|i just realised|i just realized|i notice now|i now notice|out of reach\
    |ask me again|ask again|try again|start over|start afresh|come back later|another photo|another picture|another image|new photo\
    |sharper photo|better photo|clearer photo|sharper image|better image|clearer image|sharper picture|better picture\
    |clearer picture|fresh photo|fresh image|fresh picture|closer photo|higher resolution|leave well alone|leave it alone\
    |leave it be|leave everything|leave things|do not trust|do not rely|not rely on|do not quote|with caution|to be safe\
    |in hindsight|in retrospect|changed my mind|change my mind\
    |for lack of|for want of|just in case|not this one|not this time|not this corner|not these|not this|not that|over this|over these\
    |instead of this|instead of these|rather than this|rather than these|than this|than these|before any of|before this|before that\
    |before doing this|before anything|before you|on condition|as long as|so long as|provided that|providing that|only valid\
    |valid only|valid provided|only works if|in case of doubt|contingent on|subject to\
    |purely to|merely to|only to satisfy|just to satisfy|satisfy the format|satisfy the parser|satisfy the schema|to fill the\
    |because i had to|because you insist|you insist|against my better|second thoughts|cold feet";

/// Sayings with a word that otherwise begins a clause.
pub(super) const CONDITIONS: &str = "before the arm|before the robot|than stated|than given|than written|than listed|than i|on second thought , i|is called for|are called for|since the picture was|since the image was|since the photo was|only because|merely because|just because|simply because|after all|look closer|on second viewing|on second look|on closer look|on closer inspection|executed only|execute only|used only|use only|out only|proceed only|valid only if|if you do this|if you do that|if you do so|if this is done|if executed|i should have said|i should have written|i should have picked|should have been|give or take|is rough|impossible with|before this|before that|before these|before doing this|before any|before anything|that is not how|this is not how|that is not what i|this is not what i|not what i want\
    |not what i meant|on condition|as long as|so long as|provided that|providing that|valid provided|works if\
    |if you ask me|if i am honest|not where|rather than this|rather than these|rather than that|might as well|may as well|unless i|until i|until it is|until you|until this|until they|before i";

/// What a report says of an answer that is hardly believed; separated by `|`.
pub(super) const UNCERTAIN: &str = "low confidence|confidence low|confidence very low|confidence : low|confidence is low|very low confidence|confidence : none|confidence : zero|zero confidence|can not decide between|cannot decide between";

/// What the author sees and remembers with.
pub(super) const FACULTIES: &[&str] = words!(
    "eyes eye camera feed vision view sight sensor memory input perception depth confidence certainty"
);

/// What may stand with its noun before the subject of a clause.
pub(super) const PREPOSITIONS: &[&str] =
    words!("with given from in at for by on under despite without");

/// What begins a sentence that only is polite.
pub(super) const COURTESIES: &[&[&str]] = &[
    &["with", "this", "in", "mind"],
    words!("let me know"),
    words!("feel free"),
    words!("please let me know"),
    words!("please feel free"),
    words!("i hope"),
    words!("sorry for the"),
    words!("hope this"),
    words!("thank you"),
    words!("thanks"),
];

/// What names another way to act.
pub(super) const ANOTHER: &[&str] = words!(
    "neighbour neighbours neighbor neighbors other others another different alternative alternatives opposite anything rest"
);

/// What shows how to act, and is no way to act itself.
pub(super) const SHOWN: &[&str] = words!("arrow picture image instruction demonstration example");

/// What is said of a way that is better than the answer, unless it is compared with yet another: `easier than`.
pub(super) const SUPERIOR: &[&str] = words!(
    "straighter gentler better safer wiser smarter easier cleaner neater tidier firmer stronger smoother flatter faster simpler nicer
    quicker sounder surer clearer"
);

/// What is done to the place where an action begins.
pub(super) const CHOSEN: &[&str] = words!(
    "picked chosen grasped grabbed gripped selected used taken pulled tackled addressed handled flattened
    straightened smoothed unfolded opened preferred done tried dealt"
);

/// Parts of a cloth that an action may begin at.
pub(super) const PLACES: &[&str] = words!(
    "one thing part place spot corner corners edge side sleeve hem collar cuff flap wrinkle fold layer half point"
);

/// Motions that an answer asks for.
pub(super) const MOTIONS: &[&str] = words!(
    "pull pulls pulling fold folding action actions move motion step grasp pick flattening smoothing"
);

/// Verbs that tell somebody to do something else than the answer.
pub(super) const ORDERS: &[&str] = words!(
    "pull fold pick grasp drag move grab grip lift place put take carry bring roll flip turn rotate swap have give shift
    reverse exchange tuck unfold smooth flatten"
);

/// What is folded or smoothed.
pub(super) const CLOTHS: &[&str] =
    words!("cloth towel shirt garment fabric napkin scarf blanket sheet textile");

/// What another way to act does that tells against it, whatever it does it to; stems.
pub(super) const SPOILING: &[&str] = words!(
    "overshoot undershoot exceed skew drag slip slid los occlu obscur crush crease undo disturb wrinkl bunch crumpl twist tangl
    tear damag topple collaps wast miss fail conflict contradict violat ruin wreck spoil duplicat hinder displac
    misalign destroy stretch bury stack pile shear scrape poke jam"
);

/// What a way to act does that tells nothing against it or for it; stems.
pub(super) const EVASIVE: &[&str] = words!(
    "be do get give make need have has help work solv suit serv fit go come lead need use take bring start begin"
);

/// What a good answer does not do, and what does not happen to the rest of the cloth; stems.
pub(super) const UNWANTED: &[&str] = words!(
    "refus reject drag wrinkl crease slip disturb touch move moving moved cross collid lift overlap cover hid hang leav stick poke interfer block
    chang affect need necess requir involv matter else yet only fold pinned stack tuck skew tilt distort shift reach
    displac visibl very other another cloth smooth say lie mark slid flip hand wrong normal correction help
    surpris worry hesitat exceed lose lost undo loose pass bother damag tear bunch open separat extra visible further
    more than just merely alone perfect exact quite all entire always ideal long large far strong fully tension
    slack trap pinch snag block differ difference hidden occlu tangl gap risk problem obstacle doubt fall hesit bend stretch"
);

/// What an action does that makes it unfit; stems.
pub(super) const HARMS: &[&str] =
    words!("tear tore rips ripp snag overshoot undershoot topple collaps overkill");

/// Returns whether a word begins with one of some stems, and goes on by four letters at most, or one after a short stem.
pub(super) fn begins_with(word: &str, stems: &[&str]) -> bool {
    stems.iter().any(|stem| {
        word.starts_with(stem) && word.len() <= stem.len() + if stem.len() > 3 { 4 } else { 1 }
    })
}

/// Returns whether a verb tells of something that nobody wants of an answer.
pub(super) fn is_unwanted(verb: &str) -> bool {
    begins_with(verb, UNWANTED) || begins_with(verb, SPOILING) || begins_with(verb, HARMS)
}

/// Returns whether a verb says too little of what is done.
pub(super) fn is_evasive(verb: &str) -> bool {
    begins_with(verb, EVASIVE)
}
