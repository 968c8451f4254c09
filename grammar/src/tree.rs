//! The lossless syntax tree: every byte of the text lies in exactly one leaf.
//!
//! Nodes are kept in one list in the order in which they begin, so that neither walking nor dropping
//! a tree recurses.

use crate::rules::Rule;
use pest::Token;
use pest::iterators::Pairs;
use std::ops::Range;

/// A syntax tree and the text it stands for.
#[derive(Clone, Debug)]
pub struct Tree {
    text: String,
    entries: Vec<Entry>,
}

#[derive(Clone, Debug)]
struct Entry {
    kind: Kind,
    // A text is shorter than 4 GiB by far, and a tree of half the size is walked faster.
    start: u32,
    end: u32,
    /// Index of the first entry after this one's descendants.
    next: u32,
}

impl Entry {
    fn new(kind: Kind, span: Range<usize>, next: usize) -> Entry {
        Entry {
            kind,
            start: span.start as u32,
            end: span.end as u32,
            next: next as u32,
        }
    }

    fn span(&self) -> Range<usize> {
        self.start as usize..self.end as usize
    }

    fn next(&self) -> usize {
        self.next as usize
    }
}

/// A place in a [`Tree`].
#[derive(Clone, Copy, Debug)]
pub struct Node<'t> {
    tree: &'t Tree,
    index: usize,
}

macro_rules! kinds {
    ($($kind:ident $rule:ident $what:literal,)*) => {
        /// What a node is. Words and signs of the language itself are [`Kind::Token`].
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Kind {
            /// A keyword or a sign.
            Token,
            /// Blanks and line ends.
            Space,
            $(#[doc = $what] $kind,)*
        }

        impl Kind {
            /// Returns whether it says nothing: blanks and comments.
            pub fn is_trivia(self) -> bool {
                matches!(self, Kind::Space | Kind::Comment)
            }

            fn of(rule: Rule) -> Kind {
                match rule {
                    $(Rule::$rule => Kind::$kind,)*
                    _ => Kind::Token,
                }
            }
        }
    };
}

kinds! {
    Comment COMMENT "`# …` to the end of the line.",
    File file "The whole file.",
    UseFile use_file "`use \"…\"`.",
    Experts experts "`experts NAME { … }` of a file.",
    ExpertsHead experts_head "Its first words.",
    Sequence sequence "`sequence { … }`.",
    SequenceHead sequence_head "Its first word.",
    Fold fold "`fold A -> B, …`.",
    Move r#move "`A -> B at F`.",
    Task task "`task NAME … { … }`.",
    TaskHead task_head "Its first words.",
    Extends extends "`extends NAME`.",
    Constant constant "`const NAME = …`.",
    Cloth cloth "`cloth …`.",
    Camera camera "`camera …`.",
    Picker picker "`picker …`.",
    Goal goal "`goal …`.",
    Horizon horizon "`horizon …`.",
    ExpertsUsed experts_used "`experts NAME` of a task.",
    Demos demos "`demos STAGE from \"…\"`.",
    Subgoals subgoals "`subgoals { … }`.",
    SubgoalsHead subgoals_head "Its first word.",
    Demonstrate demonstrate "`demonstrate { … }`.",
    DemonstrateHead demonstrate_head "Its first word.",
    Image image "`image \"…\" arrow (…) -> (…)`.",
    Pair pair "`(…, …)`.",
    Keypoints keypoints "`keypoints { … }`.",
    KeypointsHead keypoints_head "Its first word.",
    Keypoint keypoint "`NAME = …`.",
    Annotate annotate "`annotate { … }`.",
    AnnotateHead annotate_head "Its first word.",
    Actions actions "`actions { … }`.",
    ActionsHead actions_head "Its first word.",
    Field field "`NAME: one of …`, or `NAME: any of MASK`.",
    AnyOf any_of "`any of MASK`.",
    Component component "`component NAME …`.",
    OverrideComponent override_component "`override component NAME …`.",
    Without without "`without component NAME, …`.",
    OverrideCheck override_check "`override check NAME { … } else \"…\"`.",
    WithoutCheck without_check "`without check NAME, …`.",
    Stage stage "`stage NAME { … }`.",
    StageHead stage_head "Its first words.",
    Model model "`model …`.",
    Setting setting "`NAME`, or `NAME VALUE`.",
    Show show "`show …`.",
    Picture picture "`… with NAME`.",
    Say say "`say …`.",
    System system "`system …`.",
    Saying saying "A name or a text.",
    Read read "`read NAME from \"…\"`.",
    Example example "`example { … }` of a stage.",
    ExampleHead example_head "Its first word.",
    Reply reply "`reply \"…\"`, with or without a stage's name.",
    Verify verify "`verify { … }`.",
    VerifyHead verify_head "Its first word.",
    Check check "`check NAME { … } else \"…\"`.",
    CheckHead check_head "Its first words.",
    Attempts attempts "`attempts N`.",
    WithPicture with_picture "`with picture`.",
    Relax relax "`then without NAME, …`.",
    ElseSkip else_skip "`else skip`.",
    Result result "`result overlap > N, retries N else \"…\"`.",
    Retries retries "`retries N`.",
    Guard guard "`when …`.",
    Variant variant "`variant NAME { … }`.",
    VariantHead variant_head "Its first words.",
    Ablate ablate "`ablate NAME, …`.",
    Test test "`test \"…\" { … }`.",
    TestHead test_head "Its first words.",
    Given given "`given NAME = …`.",
    Expect expect "`expect NAME`.",
    Expr expr "Parts joined by `or`.",
    Conjunction conjunction "Parts joined by `and`.",
    Negation negation "A part after any number of `not`.",
    Relation relation "An operand, compared or not.",
    Margin margin "`N of`.",
    ToWord to_word "`to`.",
    Operand operand "A value, converted or not.",
    Target target "What it is converted to.",
    Heading heading "`from A to B`.",
    Group group "`( … )`, one part or two.",
    Call call "`NAME( … )`.",
    Argument argument "`NAME: …`, or the value alone.",
    Label label "An argument's name.",
    Compare compare "A sign of comparison.",
    Quantity quantity "A number and its unit.",
    Number number "The number.",
    Unit unit "The unit.",
    KnownUnit known_unit "A unit that stands apart from its number.",
    BlockText block_text "A text between triple quotes.",
    BlockChars block_chars "Literal characters of it.",
    String string "A text between quotes.",
    StringChars string_chars "Literal characters of it.",
    Escape escape "`\\\"` or `\\\\`.",
    BadEscape bad_escape "A `\\` before anything else.",
    Placeholder placeholder "`{{ … }}` in a text.",
    Path path "Names joined by dots.",
    Literal literal "A literal text in a placeholder.",
    LoneBraces lone_braces "`{{` that begins no placeholder.",
    Name name "A name.",
    CurlyText curly_text "A long text in typographic quotes.",
    CurlyString curly_string "A text in typographic quotes.",
    SingleString single_string "A text in single quotes.",
    NoOpen no_open "Where a `{` is missing.",
    NoClose no_close "Where a `}` is missing.",
    NoQuote no_quote "Where a `\"` is missing.",
    NoTriple no_triple "Where triple quotes are missing.",
    Open open "`{`.",
    Close close "`}`.",
    Arrow arrow "`->`.",
    NotWord not_word "`not`.",
    Surplus surplus "What stands between a block's name and its `{`.",
    Junk junk "A line that does not fit its block.",
    JunkSection junk_section "A line that does not fit its task.",
    JunkCondition junk_condition "What does not fit as a check's condition.",
    JunkGuard junk_guard "What does not fit behind `when`.",
    Stray stray "What belongs to no item of the file.",
}

impl Tree {
    /// Makes the tree of a text that is not parsed.
    pub(crate) fn junk(text: &str) -> Tree {
        // Only a text that is too long to be parsed could be longer than an entry can say.
        let end = text.floor_char_boundary(text.len().min(u32::MAX as usize));
        let stray = |kind, next| Entry::new(kind, 0..end, next);
        Tree {
            text: text.to_owned(),
            entries: vec![stray(Kind::File, 2), stray(Kind::Stray, 2)],
        }
    }

    /// Keeps what pest found, and fills the gaps between with words, signs and blanks.
    pub(crate) fn from_pairs(text: &str, pairs: Pairs<'_, Rule>) -> Tree {
        let mut tree = Tree {
            text: text.to_owned(),
            entries: Vec::new(),
        };
        let mut open = Vec::new();
        let mut cursor = 0;
        for token in pairs.tokens() {
            match token {
                Token::Start {
                    rule: Rule::EOI, ..
                }
                | Token::End {
                    rule: Rule::EOI, ..
                } => {}
                Token::Start { rule, pos } => {
                    // Before the file's own node there is nothing to fill.
                    if !open.is_empty() {
                        tree.fill(cursor..pos.pos());
                    }
                    cursor = pos.pos();
                    open.push(tree.entries.len());
                    tree.entries
                        .push(Entry::new(Kind::of(rule), cursor..cursor, 0));
                }
                Token::End { pos, .. } => {
                    let index = open.pop().expect("pest closes only what it opened");
                    if tree.entries.len() > index + 1 {
                        tree.fill(cursor..pos.pos());
                    }
                    cursor = pos.pos();
                    tree.close(index, cursor);
                }
            }
        }
        tree
    }

    /// Ends a node; blanks and comments at its end become its neighbours, so that a span ends with a word.
    fn close(&mut self, index: usize, mut end: usize) {
        let mut next = self.entries.len();
        let is_file = self.entries[index].kind == Kind::File;
        while !is_file && next > index + 1 && self.entries[next - 1].kind.is_trivia() {
            next -= 1;
            end = self.entries[next].span().start;
        }
        self.entries[index].end = end as u32;
        self.entries[index].next = next as u32;
    }

    fn fill(&mut self, gap: Range<usize>) {
        let is_space = |character: char| character.is_whitespace();
        let mut start = gap.start;
        while start < gap.end {
            let rest = &self.text[start..gap.end];
            let spaces = rest.starts_with(is_space);
            let length = rest
                .find(|character| is_space(character) != spaces)
                .unwrap_or(rest.len());
            let kind = if spaces { Kind::Space } else { Kind::Token };
            let next = self.entries.len() + 1;
            self.entries
                .push(Entry::new(kind, start..start + length, next));
            start += length;
        }
    }

    /// Returns the text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the node of the whole file.
    pub fn root(&self) -> Node<'_> {
        Node {
            tree: self,
            index: 0,
        }
    }

    /// Returns every node, each before its children.
    pub fn nodes(&self) -> impl Iterator<Item = Node<'_>> {
        (0..self.entries.len()).map(|index| Node { tree: self, index })
    }

    /// Returns the nodes without children in source order; their texts make up the whole text.
    pub fn leaves(&self) -> impl Iterator<Item = Node<'_>> {
        self.nodes()
            .filter(|node| node.entry().next() == node.index + 1)
    }
}

impl<'t> Node<'t> {
    fn entry(self) -> &'t Entry {
        &self.tree.entries[self.index]
    }

    /// Returns what the node is.
    pub fn kind(self) -> Kind {
        self.entry().kind
    }

    /// Returns its bytes' place in the text.
    pub fn span(self) -> Range<usize> {
        self.entry().span()
    }

    /// Returns its text.
    pub fn text(self) -> &'t str {
        &self.tree.text[self.span()]
    }

    /// Returns whether something that does not fit follows on the same line, so that the node is only a part of what was meant.
    pub fn is_cut(self) -> bool {
        for entry in &self.tree.entries[self.entry().next()..] {
            let ends_line =
                entry.kind.is_trivia() && self.tree.text[entry.span()].contains(['\n', '\r']);
            if ends_line || !entry.kind.is_trivia() {
                return matches!(entry.kind, Kind::Junk | Kind::JunkSection);
            }
        }
        false
    }

    /// Returns its children in source order, blanks and comments included.
    pub fn children(self) -> impl Iterator<Item = Node<'t>> {
        let end = self.entry().next();
        let mut index = self.index + 1;
        std::iter::from_fn(move || {
            let child = (index < end).then_some(Node {
                tree: self.tree,
                index,
            })?;
            index = child.entry().next();
            Some(child)
        })
    }

    /// Returns the first child of a kind.
    pub fn child(self, kind: Kind) -> Option<Node<'t>> {
        self.children().find(|child| child.kind() == kind)
    }

    /// Returns the children of a kind.
    pub fn all(self, kind: Kind) -> impl Iterator<Item = Node<'t>> {
        self.children().filter(move |child| child.kind() == kind)
    }
}
