//! Every code.
//!
//! A code never changes its meaning. Its name describes the fault, not the cure. Each has a page in `examples/`, which
//! `explain` shows: a comment with its title and, from the second line on, what it means and what to do; then an
//! example.

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

/// A code, its severity and its page.
#[derive(Clone, Copy, Debug)]
pub struct CodeEntry {
    /// The code.
    pub code: Code,
    /// How it is written.
    number: &'static str,
    /// The severity of its findings.
    pub severity: Severity,
    /// Its file of `examples/`.
    page: &'static str,
}

impl CodeEntry {
    /// Returns its title, one line.
    pub fn title(&self) -> &'static str {
        let first = self.page.lines().next();
        first.unwrap_or_default().trim_start_matches("# ")
    }

    /// Returns what it means and what to do.
    pub fn explanation(&self) -> String {
        let comment = self.page.lines().take_while(|line| !line.is_empty());
        let lines = comment.skip(1).map(|line| line.trim_start_matches("# "));
        lines.collect::<Vec<&str>>().join(" ")
    }

    /// Returns its example: lines that end in `# wrong` or `# right` belong to one of its two versions.
    ///
    /// Empty if it would be too large to show.
    pub(crate) fn example(&self) -> &'static str {
        let parts = self.page.split_once("\n\n");
        parts.map_or("", |(_, example)| example)
    }
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
    ($($number:literal $name:ident $severity:ident)*) => {
        /// The kind of a fault.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Code {
            $(#[doc = $number] $name,)*
        }

        /// Every code, in order.
        pub const CODES: &[CodeEntry] = &[
            $(CodeEntry {
                code: Code::$name,
                number: $number,
                severity: $severity,
                page: include_str!(concat!("examples/", $number, ".fab")),
            },)*
        ];
    };
}

impl Code {
    /// Returns the entry of the code.
    pub fn entry(self) -> &'static CodeEntry {
        // The table and the enum are written by one macro in one order.
        &CODES[self as usize]
    }

    /// Returns the code as it is written, such as `F0203`.
    pub fn as_str(self) -> &'static str {
        self.entry().number
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
    "F0002" UnreadableUse Error
    "F0003" CircularUse Error
    "F0004" TooManyFiles Error
    "F0005" BadPath Error
    "F0006" ControlCharacter Error
    "F0007" FileMissing Error
    "F0008" PictureOfAnotherSize Warning

    "F0101" Unexpected Error
    "F0102" UnknownWord Error
    "F0103" MissingBrace Error
    "F0104" StrayBrace Error
    "F0105" MissingName Error
    "F0106" SectionOutsideTask Error
    "F0107" TrailingComma Error
    "F0108" UnclosedText Error
    "F0109" WrongQuotes Error
    "F0110" BadEscape Error
    "F0111" LoneBraces Error
    "F0112" NestedTooDeep Error
    "F0113" WordTooLong Error
    "F0114" MergeConflict Error

    "F0201" UnknownUnit Error
    "F0202" MissingUnit Error
    "F0203" WrongQuantity Error
    "F0204" OutOfRange Error
    "F0205" NotWhole Error
    "F0206" WrongArguments Error
    "F0207" WrongForm Error
    "F0209" CameraSeesTooLittle Warning
    "F0210" MaskSeesTable Warning
    "F0211" MixedFrames Error
    "F0212" NoConversion Error
    "F0220" MaskSeesNoCloth Warning
    "F0221" OtherMaskIsCloth Warning

    "F0301" UnknownName Error
    "F0302" DuplicateName Error
    "F0303" WrongKindOfName Error
    "F0304" NotYetKnown Error
    "F0305" NeedsLast Error
    "F0306" UnusedName Warning

    "F0401" CircularExtends Error
    "F0402" ExtendsTooDeep Error
    "F0403" Repeated Error
    "F0404" NothingToOverride Error
    "F0405" NothingToRemove Error
    "F0406" NotMarkedAsOverride Error
    "F0407" MissingSection Error
    "F0408" BaseOnly Note
    "F0410" ChecksDropped Warning
    "F0411" VariantChangesNothing Warning

    "F0501" NoFolds Error
    "F0502" TooFewImages Error
    "F0503" NothingToCompare Error
    "F0504" HorizonTooLong Error
    "F0505" HorizonTooShort Warning
    "F0506" FoldGoesNowhere Error
    "F0507" MixedSubgoals Error
    "F0508" GoalMetAtStart Warning
    "F0509" NoHorizon Error
    "F0510" StepFoldsNothing Warning
    "F0511" MaterialIncomplete Error
    "F0512" ClothTooStiff Warning
    "F0513" StepNotOffered Warning
    "F0514" FoldOfCrumpledCloth Warning

    "F0601" SaidNowhere Warning
    "F0602" StageIncomplete Error
    "F0603" ActionReadElsewhere Error
    "F0604" PicturesForTextModel Error
    "F0605" TextTooLong Error
    "F0606" BadPattern Error
    "F0607" EmptyText Error
    "F0608" BadExample Error
    "F0609" SingleBraces Warning
    "F0610" FormatNeverSaid Warning
    "F0611" PointsNeverShown Warning
    "F0612" TextNeverUsed Warning
    "F0613" PrefixNeverNamed Warning
    "F0614" CandidatesAlike Error
    "F0616" RehearsalIncomplete Error
    "F0617" NotMeasuredOnTwin Error
    "F0618" TwinOfOwnMaterial Warning
    "F0621" TwinIsJudgedCloth Error
    "F0622" FoldChosenByCoverage Warning
    "F0624" PointsNeverOffered Warning

    "F0701" MissingField Error
    "F0702" UnknownField Error
    "F0703" WrongExpression Error
    "F0704" MissingMessage Error
    "F0705" MixedChoices Error
    "F0706" Contradiction Error
    "F0707" FieldMovesNothing Note
    "F0708" CertainCondition Warning

    "F0801" LayerNotNamed Error
    "F0802" LayerNotShown Error
    "F0803" NothingToDraw Error

    "F0901" TestIncomplete Error
}
