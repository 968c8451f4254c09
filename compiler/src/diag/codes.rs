//! Every code: its title, what it means, and what to do.
//!
//! A code never changes its meaning. Its name describes the fault, not the cure. `examples/` has a file for each
//! code, which `explain` shows.

use Severity::{Error, Note, Warning};

/// How serious a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The task cannot run.
    Error,
    /// It can run, but probably not as intended.
    Warning,
    /// Only information.
    Note,
}

impl Severity {
    /// Returns the lower-case word.
    pub fn as_str(self) -> &'static str {
        match self {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        }
    }
}

/// The title, severity and explanation of a code.
#[derive(Clone, Copy, Debug)]
pub struct CodeEntry {
    /// The code.
    pub code: Code,
    /// The severity of its findings.
    pub severity: Severity,
    /// One line.
    pub title: &'static str,
    /// What it means and what to do.
    pub explanation: &'static str,
    /// The file of `examples/`: lines that end in `# wrong` or `# right` belong to one of its two versions.
    pub(crate) example: &'static str,
}

/// What the first digits of a code mean.
pub const GROUPS: [(&str, &str); 10] = [
    ("F00", "files"),
    ("F01", "form"),
    ("F02", "quantities and arguments"),
    ("F03", "names"),
    ("F04", "composition"),
    ("F05", "folds and goals"),
    ("F06", "prompts"),
    ("F07", "actions and checks"),
    ("F08", "annotations"),
    ("F09", "tests"),
];

macro_rules! codes {
    ($($number:literal $name:ident $severity:ident $title:literal $explanation:literal)*) => {
        /// The kind of a fault.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Code {
            $(#[doc = $title] $name,)*
        }

        /// Every code, in order.
        pub const CODES: &[CodeEntry] = &[
            $(CodeEntry {
                code: Code::$name,
                severity: $severity,
                title: $title,
                explanation: $explanation,
                example: include_str!(concat!("examples/", $number, ".fab")),
            },)*
        ];

        impl Code {
            /// Returns the code as it is written, such as `F0203`.
            pub fn as_str(self) -> &'static str {
                match self {
                    $(Code::$name => $number,)*
                }
            }
        }
    };
}

impl Code {
    /// Returns the entry of the code.
    pub fn entry(self) -> &'static CodeEntry {
        // The table and the enum are written by one macro in one order.
        &CODES[self as usize]
    }

    /// Returns whether it is about the form of a file, not about what the file means.
    pub(crate) fn is_about_form(self) -> bool {
        self.as_str().starts_with("F01")
    }

    /// Finds a code by its number, such as `F0203`, in either case.
    pub fn parse(number: &str) -> Option<Code> {
        CODES
            .iter()
            .map(|entry| entry.code)
            .find(|code| code.as_str().eq_ignore_ascii_case(number))
    }
}

codes! {
    "F0001" FileTooLong Error
    "a file is too long"
    "A file may have at most 1 MiB, a hundred times a long task. Nothing in it is checked. Split it, and join the parts with `use`."

    "F0002" UnreadableUse Error
    "a file that `use` names cannot be read"
    "The path of `use \"…\"` is relative to the file that contains it, with `/` between folders. The message says why the file cannot be read."

    "F0003" CircularUse Error
    "files use each other in a circle"
    "A file may not use itself, directly or through others. Move what both need into a third file."

    "F0004" TooManyFiles Error
    "too many files are used"
    "At most 64 files take part in one compilation, each at most 16 `use`s away from the first, and 4 MiB of text in all."

    "F0005" BadPath Error
    "a path is not of the right form"
    "Paths are relative, with `/` between folders, without `{{ … }}`, and not empty. They stay in the folder of the first file and in those below. This way a task works on every machine, and reads no other files."

    "F0006" ControlCharacter Error
    "a file has an invisible character"
    "Control characters such as NUL and escape, and characters that turn the direction of writing, change what a terminal or an editor shows. A reader would see another text than the model. Only line ends and tabs are accepted."

    "F0007" FileMissing Error
    "a file that a task names cannot be read"
    "A start, a subgoal picture, a picture of an example, or a file of demonstrations is not where the task says, or cannot be read: a picture must be a whole PNG or JPEG file, a start a `.npy` file of shape (particles, 3) or (particles, 4), and demonstrations have a JSON object in each line. `fabc check` looks into them; a rollout would fail."

    "F0008" PictureOfAnotherSize Warning
    "a subgoal picture has another size than the camera's"
    "Points and arrows are given in pixels of the camera's square picture, and results are compared with the next subgoal pixel by pixel. A picture of another size shows them elsewhere."

    "F0101" Unexpected Error
    "unexpected text"
    "The marked place does not fit the form of the language. The message lists what would fit."

    "F0102" UnknownWord Error
    "a line begins with an unknown word"
    "Each line of a block begins with one of a few words. If one of them is similar, the message suggests it."

    "F0103" MissingBrace Error
    "a brace is missing"
    "Blocks open with `{` and close with `}`. For a missing `}` the message marks the `{` that is still open. Lines below it are not checked, because nobody knows to which block they belong."

    "F0104" StrayBrace Error
    "a `}` closes nothing"
    "There is one `}` too many here, or above, where it closes a task too early."

    "F0105" MissingName Error
    "a name is missing"
    "Tasks, stages, checks, lists of experts and materials have a name: a letter, then letters, digits and `_`."

    "F0106" SectionOutsideTask Error
    "a section is outside of any task"
    "Sections such as `keypoints` belong between the braces of a `task`. Perhaps a `}` above closes it too early."

    "F0107" TrailingComma Error
    "a list ends with a comma"
    "A comma must be followed by another part. Remove it, or add the part."

    "F0108" UnclosedText Error
    "a text does not end"
    "A text between `\"` ends on the same line; a longer one is written between `\"\"\"` and `\"\"\"`."

    "F0109" WrongQuotes Error
    "quotes are not of the right kind"
    "Texts are written between straight double quotes `\"`. Word processors replace them with curved ones."

    "F0110" BadEscape Error
    "a backslash escapes nothing"
    "Between `\"`, only `\\\"` and `\\\\` are written with a backslash. Between `\"\"\"` none is needed."

    "F0111" LoneBraces Error
    "`{{` does not begin a placeholder"
    "`{{ name }}` stands for a value. For two literal braces write `{{ \"{{\" }}`."

    "F0112" NestedTooDeep Error
    "brackets are nested too deeply"
    "At most 32 brackets and braces may be open at once. Nothing in the file is checked."

    "F0113" WordTooLong Error
    "a word is too long"
    "A name, a unit or any other word outside of texts has at most 200 letters and digits. Nothing in the file is checked."

    "F0114" MergeConflict Error
    "a merge conflict is not resolved"
    "A merge left both versions of some lines, between `<<<<<<<`, `=======` and `>>>>>>>`. Inside a text a model would read them. Keep one version, and remove the marked lines. Until then nothing in the file is checked."

    "F0201" UnknownUnit Error
    "a unit is unknown"
    "A number is followed by its unit, without a blank between them. Lengths on the table, lengths in the picture and angles have different units; the message lists them all."

    "F0202" MissingUnit Error
    "a number has no unit"
    "Every length and angle states its unit, so nobody has to guess."

    "F0203" WrongQuantity Error
    "a quantity is of the wrong kind"
    "Lengths on the table, lengths in a picture, angles and plain numbers are different things; one cannot stand for another."

    "F0204" OutOfRange Error
    "a value is out of range"
    "The message says which values are accepted."

    "F0205" NotWhole Error
    "a count is not a whole number"
    "Particles, pixels of a picture's side, steps, attempts and tokens are counted; write a whole number."

    "F0206" WrongArguments Error
    "arguments do not fit"
    "The message says which arguments there are, which are needed, and which were given."

    "F0207" WrongForm Error
    "a value is of the wrong form"
    "The message shows the forms that this place accepts."

    "F0209" CameraSeesTooLittle Warning
    "the cloth does not fit into the picture"
    "The picture's side on the table is twice the height times the tangent of half the field of view. Anything outside is neither seen nor picked."

    "F0210" MaskSeesTable Warning
    "a mask reaches the table"
    "The table is as far from the camera as the camera is high. A depth limit beyond that puts every pixel into the mask."

    "F0211" MixedFrames Error
    "two frames are mixed"
    "Pixels belong to a picture, millimetres to the table. Convert one side: `20mm in px` is the length in the picture of 20 mm on the table; `distance(pick, place) in mm` is the length on the table that this distance in the picture covers. `edge` counts the longer side of the cloth and is a length on the table."

    "F0212" NoConversion Error
    "a value cannot be converted to this unit"
    "`in` is followed by a unit of the same kind as the value, or by `percent` for fractions. The message names both."

    "F0220" MaskSeesNoCloth Warning
    "a mask ends above the cloth"
    "A depth mask keeps what is nearer to the camera than its limit. A flat cloth lies about 5 mm above the table, so the limit is a little less than the camera's height: 646 mm for a camera at 650 mm. If the camera is raised, the limit must be raised as well; the message says to what."

    "F0221" OtherMaskIsCloth Warning
    "another mask is the cloth"
    "The first mask of a task is its cloth: picks land on it, the cloth's coverage and its keypoints are measured on it. `largest` and `closed` of it take its place. A mask that is only called `cloth` does not."

    "F0301" UnknownName Error
    "a name is unknown"
    "Nothing of this kind has this name here. If one is similar, the message suggests it."

    "F0302" DuplicateName Error
    "a name is declared twice"
    "Two things that could be confused cannot have the same name. Rename one. Names of tasks, and of a task's variants, must differ by more than case: folders of runs and snapshots are named after them, and many file systems ignore case."

    "F0303" WrongKindOfName Error
    "a name stands for something else"
    "A mask is a set of pixels; `points` and a `point` can be offered, measured and written into a text. The message says what is needed."

    "F0304" NotYetKnown Error
    "a name is used before it is known"
    "Stages run in order: what one reads is known to the stages after it. Action fields are known only in checks and their messages. An extractor uses only keypoints above it."

    "F0305" NeedsLast Error
    "the previous action is not known in the first step"
    "`last.pick` and `last.place` are the points of the previous action, and the first step has none. Add `when \
     last` to the component or the check."

    "F0306" UnusedName Warning
    "nothing uses a name"
    "A constant or a keypoint with the name of an inherited one replaces it; with any other name it is a new one, and the inherited one keeps its value. If an inherited name is similar, this one was probably meant to replace it. A material is used by a cloth, and a list of experts by a task. In a library, and in a task that lacks parts, others may use the names; there, only those with a similar inherited one are reported."

    "F0401" CircularExtends Error
    "tasks extend each other in a circle"
    "A task may not extend itself, directly or through others."

    "F0402" ExtendsTooDeep Error
    "a chain of `extends` is too long"
    "A task may extend at most 16 others, counting those that they extend in turn."

    "F0403" Repeated Error
    "something is stated twice"
    "The marked part may appear once here. Keep one."

    "F0404" NothingToOverride Error
    "there is nothing to override"
    "`override component` replaces the text of a component that an extended task declares; `override check` replaces one of its checks. A task with its own `verify` inherits no checks. To add a component or a check, write it without `override`."

    "F0405" NothingToRemove Error
    "there is nothing to leave out"
    "`without component` leaves out a component that an extended task declares, in every stage; `without check` leaves out a check of its `verify`; `without variant` leaves out a variant."

    "F0406" NotMarkedAsOverride Error
    "a component or a check replaces another one silently"
    "An extended task declares a component or a check of this name. Write `override component` or `override check` to replace it, or choose another name."

    "F0407" MissingSection Error
    "a task lacks a section"
    "A task that asks models needs the marked section, its own or from the task that it extends."

    "F0408" BaseOnly Note
    "a task cannot run by itself"
    "It lacks a part that every rollout needs. That is right for a task that others extend."

    "F0410" ChecksDropped Warning
    "a `verify` drops inherited checks"
    "A task that states `verify` inherits no checks, so answers that the extended task refuses are carried out. To add a check, write `check NAME { … } else \"…\"` in the task, outside of `verify`; to change one, `override check`. If `attempts` or `result` must change too, state the inherited checks again in the `verify`. To drop checks on purpose, name them: `without check NAME`."

    "F0411" VariantChangesNothing Warning
    "a variant changes nothing"
    "A run of the variant is a run of the task: it says, shows and checks the same. State in the variant what it changes, such as `without component NAME` or a section of its own, or remove it."

    "F0501" NoFolds Error
    "there are no folds"
    "A demonstration, and a sequence of an expert, consists of at least one fold; a list of experts of at least one sequence."

    "F0502" TooFewImages Error
    "there are too few subgoal images"
    "Each step needs a picture before and a picture after it: two images for one step, three for two."

    "F0503" NothingToCompare Error
    "the goal has nothing to compare with"
    "`particle_distance` compares the result with those of expert folds. Name `experts`, or `demonstrate` the folds."

    "F0504" HorizonTooLong Error
    "there are more steps than subgoals"
    "Each step shows the subgoals before and after it, so a rollout cannot have more steps than the subgoals show."

    "F0505" HorizonTooShort Warning
    "the last subgoals are never reached"
    "The rollout ends before the last steps that the subgoals show."

    "F0506" FoldGoesNowhere Error
    "a fold goes nowhere"
    "Pick and place name the same point of the cloth."

    "F0507" MixedSubgoals Error
    "subgoals are both demonstrated and listed as images"
    "Either `demonstrate` the folds once, or list an `image` for each subgoal."

    "F0508" GoalMetAtStart Warning
    "an untouched cloth meets the goal already"
    "The goal is reached before anything is done, so a rollout that does nothing counts as a success. The message says what the untouched cloth scores. For folds that is the score of an ideal sheet of paper, an estimate."

    "F0509" NoHorizon Error
    "a task does not state its number of steps"
    "A task without subgoals has no steps to count, so it must state a `horizon`."

    "F0510" StepFoldsNothing Warning
    "a demonstrated step folds nothing"
    "Cloth that is folded over too little opens again when it is let go. `fabc subgoals` executes the demonstration in the simulator. If a step leaves the cloth as it was, or only slides it, it searches the smallest fold from the same point in the same direction that stays, and keeps the result beside the pictures. `fabc check` reads it there while cloth, picker and folds are the same; it simulates nothing itself."

    "F0511" MaterialIncomplete Error
    "a material lacks a value, or its source"
    "A `material` states its weight, thickness, bending length, crease recovery, stretch and friction, each with the place where the value comes from: a publication, or how it was measured. Without a source, nobody can check a value or improve it. The colours of its faces are optional, and each is a name for prompts and a colour for the simulator's camera."

    "F0512" ClothTooStiff Warning
    "the simulator cannot lay a cloth"
    "The stiffer a cloth and the nearer its particles, the more substeps a step of the simulator needs, and it has at most 100. Every run in the simulator ends with this message. A real arm needs no simulator, so this is only a warning. `fabc check` gives it in builds that have the simulator; the message says which `spacing` would do."

    "F0601" SaidNowhere Warning
    "a component is never used"
    "No stage names it in `say` or `system`, so no model ever reads it."

    "F0602" StageIncomplete Error
    "a stage lacks a part"
    "A stage has a `model`, something to `say`, and something to `read`."

    "F0603" ActionReadElsewhere Error
    "the action is not read by the last stage alone"
    "Exactly one stage has `read action`, and it is the last one."

    "F0604" PicturesForTextModel Error
    "a text model is shown pictures"
    "`show`, and `with picture` after `attempts`, need `model vision`."

    "F0605" TextTooLong Error
    "a text is too long"
    "One text may have at most 16 KiB."

    "F0606" BadPattern Error
    "a pattern does not say where the text begins"
    "`read NAME from \"Instructions: {NAME}\"` needs some words before `{NAME}`, and the same name."

    "F0607" EmptyText Error
    "a text is empty"
    "A component, a question or a message needs some text. To leave out a component of an extended task, write `without component`."

    "F0608" BadExample Error
    "an example cannot be used"
    "An example has one `say` and one `reply`. The stage must be able to read the reply, because the example shows the model how to answer. The message says what is missing or cannot be read."

    "F0609" SingleBraces Warning
    "a value is between single braces"
    "`{corners}` is literal text, as in JSON; a model would read exactly that. Write `{{ corners }}` for the value; the same holds for a measure such as `{count(corners)}`. If the braces are intended, rename the word between them."

    "F0610" FormatNeverSaid Warning
    "no prompt says in which format to answer"
    "The stage that reads the action expects one line for each field, such as `Pick Point = (x, y)`. No text of the stage has `{{ actions.format }}` or such lines, and no example shows them, so the model has to guess."

    "F0611" PointsNeverShown Warning
    "points are offered, but no prompt shows them"
    "A model can choose a point only if it knows it. Write `{{ NAME }}` in a text of a stage, or draw the points as a layer of `annotate` on a picture that a stage shows."

    "F0612" TextNeverUsed Warning
    "a text is read from an answer and never used"
    "`read NAME from` makes the text known to later stages, but none of their texts has `{{ NAME }}`. The question to the model has no effect."

    "F0613" PrefixNeverNamed Warning
    "no prompt says the words before a text that is read"
    "`read NAME from \"Instructions: {NAME}\"` looks for the words before `{NAME}` in the answer. A model writes them only if a text of the stage asks for them, or an example shows them."

    "F0614" CandidatesAlike Error
    "candidates would all be alike"
    "`candidates 4` asks for four answers to one question, and a rehearsal chooses among them. At temperature 0, and with some models without a stated one, all four would be the same. Write a temperature above 0 behind `model`."

    "F0616" RehearsalIncomplete Error
    "a rehearsal lacks a part"
    "`rehearse` needs three things: the twin's material and ranges, what the twin is for (`choose most …` among the stage's candidates, or `revise … with picture`), and how far the twin is trusted. The message says what is missing."

    "F0617" NotMeasuredOnTwin Error
    "a measure cannot be taken on a twin"
    "A twin is all that a rehearsal may measure: without subgoals there is no silhouette to compare it with."

    "F0618" TwinOfOwnMaterial Warning
    "a twin is made of what the cloth is made of"
    "In the simulator, such a twin has the physics of the cloth that is judged, which no camera shows, so a gain says nothing about other cloths. Name another material, and let the ranges of size and friction say what is not known."

    "F0621" TwinIsJudgedCloth Error
    "a twin is the judged cloth"
    "A twin of the task's own material, of its size and with its friction folds as the judged cloth does: the rehearsal would be told the result. Name another material, and let the ranges of size and friction say what is not known."

    "F0622" FoldChosenByCoverage Warning
    "a fold is chosen by coverage"
    "A fold makes a cloth cover less, so in a task with subgoals `choose most coverage` takes the answer that folds least, or that misses the cloth. `choose most overlap` compares with the next subgoal."

    "F0701" MissingField Error
    "an action lacks a field"
    "An action has a `pick` and a `place`, or a `pick`, a `direction` and a `distance`. The message says which of them is missing."

    "F0702" UnknownField Error
    "an action has an unknown field"
    "The fields that move the cloth are called `pick` and `place`, or `pick`, `direction` and `distance`. One of them is missing, and the name of the marked field is similar."

    "F0703" WrongExpression Error
    "an expression does not fit"
    "A check is a condition: comparisons of lengths in pixels and `P within N of MASK`, joined by `and`, `or`, `not`. The message says what is expected and what is found."

    "F0704" MissingMessage Error
    "a check has no message"
    "A check ends with `else \"…\"`: the message for the model if the check fails."

    "F0705" MixedChoices Error
    "the choices of a field are of different kinds"
    "A field offers either keypoints, or directions such as `45deg`, or lengths on the table in one unit, or words in quotes. Split it into several fields."

    "F0706" Contradiction Error
    "the action space contradicts itself"
    "An answer must be able to state each choice of each field: two that differ only in case, in `_` or `-` for a blank, or by less than a prompt writes, read alike, and quotes, brackets and the signs between statements mean something else. Rename the field or the choice, or remove one of the two."

    "F0707" FieldMovesNothing Note
    "nothing acts on a field of the action"
    "Only `pick` and `place`, or `pick`, `direction` and `distance`, move the cloth, and `lift`, `speed`, `release_height` and `press` say how. The model is asked for any further field, and its answer is recorded, but it changes nothing unless a check reads it."

    "F0708" CertainCondition Warning
    "a condition is always true or never true"
    "A count goes from 0 to the `max` of its detector, a step from 1 to the horizon, and the distance of a point to itself is 0. With these the condition always has the same result. A check that can never pass refuses every answer; one that can never fail checks nothing. Variants are not judged by themselves."

    "F0801" LayerNotNamed Error
    "something is drawn, but no prompt says what it is"
    "Each layer of `annotate` is named in a text of every stage that shows the annotated picture, such as `The corners are {{ corner_dots }}.`: a model has to know what the marks mean. Name it, or remove the layer."

    "F0802" LayerNotShown Error
    "a text names a layer that its stage does not show"
    "The text names a layer of `annotate`, but the stage shows no picture `with annotations`. Write `show scene with annotations`, or leave the name out."

    "F0803" NothingToDraw Error
    "annotations are shown, but none are declared"
    "`show scene with annotations` draws the layers of `annotate`, but the task has none. Declare some, or write `show scene`."

    "F0901" TestIncomplete Error
    "a test lacks a part"
    "A test has a name in quotes, a `reply`, and one `expect`; the points of the scene and the texts that earlier stages read are `given`. The message says what is missing."
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_its_numbers_and_each_is_found_by_it() {
        let numbers: Vec<&str> = CODES.iter().map(|entry| entry.code.as_str()).collect();
        assert!(
            numbers.is_sorted_by(|before, after| before < after),
            "{numbers:?}"
        );
        for entry in CODES {
            assert_eq!(
                Code::parse(&entry.code.as_str().to_lowercase()),
                Some(entry.code)
            );
            assert_eq!(entry.code.entry().title, entry.title);
        }
        assert_eq!(Code::parse("F9999"), None);
    }
}
