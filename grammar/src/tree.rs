//! The lossless syntax tree: every byte of the text is in exactly one leaf.
//!
//! In: pest's tokens. Out: a [`Tree`] of [`Node`]s, each with its [`Kind`] and [`Span`]. The views in
//! [`ast`](crate::ast) give access to the parts of a node.
//!
//! Nodes are stored in one list in the order in which they begin, so walking or dropping a tree does not
//! recurse.

use crate::rules::Rule;
use crate::source::{FileId, Span};
use pest::Token;
use pest::iterators::Pairs;
use std::fmt;
use std::ops::Range;

/// A syntax tree and its text.
#[derive(Clone, Debug)]
pub struct Tree {
    file: FileId,
    text: String,
    entries: Vec<Entry>,
}

#[derive(Clone, Debug)]
struct Entry {
    kind: Kind,
    range: Range<usize>,
    /// Index of the first entry after this one's descendants.
    next: usize,
    /// Index of the parent entry; the root is its own parent.
    parent: usize,
}

/// A node of a [`Tree`].
#[derive(Clone, Copy)]
pub struct Node<'t> {
    tree: &'t Tree,
    index: usize,
}

macro_rules! kinds {
    ($($kind:ident $($rule:ident)|+, $what:literal;)*) => {
        /// The kind of a node. Keywords and signs are [`Kind::Token`].
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Kind {
            /// A keyword or a sign.
            Token,
            /// Blanks and line ends.
            Space,
            $(#[doc = $what] $kind,)*
        }

        impl Kind {
            /// Returns whether it is text that does not parse.
            pub fn is_junk(self) -> bool {
                matches!(
                    self,
                    Kind::Junk
                        | Kind::JunkSection
                        | Kind::JunkCondition
                        | Kind::JunkGuard
                        | Kind::Stray
                        | Kind::Surplus
                )
            }

            /// Returns whether it is a blank or a comment.
            pub fn is_trivia(self) -> bool {
                matches!(self, Kind::Space | Kind::Comment)
            }

            pub(crate) fn of(rule: Rule) -> Kind {
                match rule {
                    $($(Rule::$rule)|+ => Kind::$kind,)*
                    _ => Kind::Token,
                }
            }
        }
    };
}

kinds! {
    Comment COMMENT, "`# …` to the end of the line.";
    File file, "The whole file.";
    Head named_head | plain_head | test_head, "The first words of a block, up to its `{`.";
    UseFile use_file, "`use \"…\"`.";
    Experts experts, "`experts NAME { … }` of a file.";
    Material material, "`material NAME { … }` of a file.";
    Property property, "`NAME VALUE from \"…\"` of a material.";
    Cited cited, "`from \"…\"`: where a value comes from.";
    Sequence sequence, "`sequence { … }`.";
    Fold fold, "`fold A -> B, …`.";
    Move r#move, "`A -> B at F`.";
    Task task, "`task NAME … { … }`.";
    Extends extends, "`extends NAME`.";
    Constant constant, "`const NAME = …`.";
    Statement statement, "`cloth …`, `goal …`: a word and its value.";
    StatementWord statement_word, "The word.";
    ExpertsUsed experts_used, "`experts NAME` of a task.";
    Demos demos, "`demos STAGE from \"…\"`.";
    Subgoals subgoals, "`subgoals { … }`.";
    Demonstrate demonstrate, "`demonstrate { … }`.";
    Image image, "`image \"…\" arrow (…) -> (…)`.";
    Pair pair, "`(…, …)`.";
    Keypoints keypoints, "`keypoints { … }`.";
    Keypoint keypoint, "`NAME = …`.";
    Annotate annotate, "`annotate { … }`.";
    Actions actions, "`actions { … }`.";
    Field field, "`NAME: one of …`, or `NAME: any of MASK`.";
    AnyOf any_of, "`any of MASK`.";
    Component component, "`component NAME …`.";
    OverrideComponent override_component, "`override component NAME …`.";
    Without without, "`without component NAME, …`.";
    OverrideCheck override_check, "`override check NAME { … } else \"…\"`.";
    WithoutCheck without_check, "`without check NAME, …`.";
    WithoutVariant without_variant, "`without variant NAME, …`.";
    AddedSay added_say, "`say NAME, … in STAGE after NAME`, or `before NAME`.";
    Stage stage, "`stage NAME { … }`.";
    Model model, "`model …`.";
    Setting setting, "`NAME`, or `NAME VALUE`.";
    Show show, "`show …`.";
    Picture picture, "`… with NAME`.";
    Say say, "`say …`.";
    System system, "`system …`.";
    ComponentOrText saying, "A name or a text.";
    Read read, "`read NAME from \"…\"`.";
    Example example, "`example { … }` of a stage.";
    Reply reply, "`reply \"…\"`, with or without a stage's name.";
    Rehearse rehearse, "`rehearse STAGE { … }`.";
    Twin twin, "`twin(…)`.";
    Choose choose, "`choose most MEASURE`.";
    Revise revise, "`revise N with picture`.";
    Trust trust, "`trust overlap > N, else refuse`.";
    ElseRefuse else_refuse, "`else refuse`.";
    Verify verify, "`verify { … }`.";
    Check check, "`check NAME { … } else \"…\"`.";
    Attempts attempts, "`attempts N`.";
    WithPicture with_picture, "`with picture`.";
    Relax relax, "`then without NAME, …`.";
    ElseSkip else_skip, "`else skip`.";
    Result result, "`result overlap > N, retries N else \"…\"`.";
    Retries retries, "`retries N`.";
    Guard guard, "`when …`.";
    Variant variant, "`variant NAME { … }`.";
    Ablate ablate, "`ablate NAME, …`.";
    Test test, "`test \"…\" { … }`.";
    Given given, "`given NAME = …`.";
    Expect expect, "`expect NAME`.";
    Expr expr, "Parts joined by `or`.";
    Conjunction conjunction, "Parts joined by `and`.";
    Negation negation, "A part after any number of `not`.";
    Relation relation, "An operand, compared or not.";
    Margin margin, "`N of`.";
    Operand operand | amount, "A value, converted or not.";
    Target target, "What it is converted to.";
    Heading heading, "`from A to B`.";
    Group group, "`( … )`, one part or two.";
    Call call, "`NAME( … )`.";
    Argument argument, "`NAME: …`, or the value alone.";
    Label label, "An argument's name.";
    Compare compare, "A sign of comparison.";
    Quantity quantity, "A number and its unit.";
    Unit unit | apart_unit, "The unit.";
    BlockText block_text, "A text between triple quotes.";
    BlockChars block_chars, "Literal characters of it.";
    String string, "A text between quotes.";
    StringChars string_chars, "Literal characters of it.";
    Escape escape, "`\\\"` or `\\\\`.";
    BadEscape bad_escape, "A `\\` before anything else.";
    Placeholder placeholder, "`{{ … }}` in a text.";
    Path path, "Names joined by dots.";
    Literal literal, "A literal text in a placeholder.";
    LoneBraces lone_braces, "`{{` that begins no placeholder.";
    Name name | setting_word | twin_word, "A name.";
    CurlyText curly_text, "A long text in typographic quotes.";
    CurlyString curly_string, "A text in typographic quotes.";
    SingleString single_string, "A text in single quotes.";
    NoCondition no_condition, "Where a condition after `when` is missing.";
    NoName no_name, "Where a name is missing.";
    NoOpen no_open, "Where a `{` is missing.";
    NoClose no_close, "Where a `}` is missing.";
    NoQuote no_quote, "Where a `\"` is missing.";
    NoTriple no_triple, "Where triple quotes are missing.";
    Open open, "`{`.";
    Close close, "`}`.";
    Surplus surplus, "What stands between a block's name and its `{`.";
    Junk junk | verify_junk, "A line that does not fit its block.";
    JunkSection junk_section, "A line that does not fit its task.";
    JunkCondition junk_condition, "What does not fit as a check's condition.";
    JunkGuard junk_guard, "What does not fit behind `when`.";
    Stray stray, "What belongs to no item of the file.";
}

impl Tree {
    /// Makes the tree of a text that is not parsed.
    pub(crate) fn junk(file: FileId, text: &str) -> Tree {
        let mut builder = Builder::new(file, text);
        builder.open(Kind::File, 0);
        builder.push(Kind::Stray, 0..text.len());
        builder.cursor = text.len();
        builder.close(text.len());
        builder.tree
    }

    /// Builds the tree from pest's tokens, and fills the gaps between them with words, signs and blanks.
    pub(crate) fn from_pairs(file: FileId, text: &str, pairs: Pairs<'_, Rule>) -> Tree {
        let mut builder = Builder::new(file, text);
        for token in pairs.tokens() {
            let (Token::Start { rule, .. } | Token::End { rule, .. }) = token;
            match token {
                _ if rule == Rule::EOI => {}
                Token::Start { rule, pos } => builder.open(Kind::of(rule), pos.pos()),
                Token::End { pos, .. } => builder.close(pos.pos()),
            }
        }
        builder.tree
    }

    /// Returns the text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the node of the whole file.
    pub fn root(&self) -> Node<'_> {
        self.node(0)
    }

    /// Makes the span of some of its bytes.
    pub(crate) fn span(&self, range: Range<usize>) -> Span {
        Span::new(self.file, range)
    }

    fn node(&self, index: usize) -> Node<'_> {
        Node { tree: self, index }
    }

    /// Returns every node, each before its children.
    pub fn nodes(&self) -> impl Iterator<Item = Node<'_>> {
        (0..self.entries.len()).map(|index| self.node(index))
    }

    /// Returns the nodes without children in source order; joined, their texts are the whole text.
    pub fn leaves(&self) -> impl Iterator<Item = Node<'_>> {
        self.nodes()
            .filter(|node| node.entry().next == node.index + 1)
    }

    /// Returns the innermost node that contains the byte at `offset`; at or beyond the end, the one with the last
    /// byte.
    pub fn node_at(&self, offset: usize) -> Node<'_> {
        let offset = offset.min(self.text.len().saturating_sub(1));
        let after = self
            .entries
            .partition_point(|entry| entry.range.start <= offset);
        // Every byte is in a leaf; empty nodes that begin after that leaf are skipped.
        let last = self.node(after.saturating_sub(1));
        std::iter::once(last)
            .chain(last.ancestors())
            .find(|node| node.range().contains(&offset))
            .unwrap_or(self.root())
    }
}

/// A tree under construction.
struct Builder {
    tree: Tree,
    /// The nodes that are still open, outermost first.
    open: Vec<usize>,
    /// The end of the text that is already in leaves.
    cursor: usize,
}

impl Builder {
    fn new(file: FileId, text: &str) -> Builder {
        let text = text.to_owned();
        let entries = Vec::new();
        Builder {
            tree: Tree {
                file,
                text,
                entries,
            },
            open: Vec::new(),
            cursor: 0,
        }
    }

    fn push(&mut self, kind: Kind, range: Range<usize>) {
        let entries = &mut self.tree.entries;
        entries.push(Entry {
            kind,
            range,
            next: entries.len() + 1,
            parent: self.open.last().copied().unwrap_or(0),
        });
    }

    fn open(&mut self, kind: Kind, at: usize) {
        // There is nothing to fill before the file's own node.
        if !self.open.is_empty() {
            self.fill(at);
        }
        self.cursor = at;
        self.push(kind, at..at);
        self.open.push(self.tree.entries.len() - 1);
    }

    /// Ends a node; blanks and comments at its end become its siblings, so its span ends with a word.
    fn close(&mut self, at: usize) {
        let index = *self.open.last().expect("pest closes only what it opened");
        if self.tree.entries.len() > index + 1 {
            self.fill(at);
        }
        self.open.pop();
        self.cursor = at;
        let entries = &mut self.tree.entries;
        let Entry { kind, parent, .. } = entries[index];
        let (mut end, mut next) = (at, entries.len());
        while kind != Kind::File && next > index + 1 && entries[next - 1].kind.is_trivia() {
            next -= 1;
            end = entries[next].range.start;
            entries[next].parent = parent;
        }
        entries[index].range.end = end;
        entries[index].next = next;
    }

    /// Makes leaves of the words and blanks up to `end`.
    fn fill(&mut self, end: usize) {
        let mut start = self.cursor;
        while start < end {
            let rest = &self.tree.text[start..end];
            let is_space = rest.starts_with(char::is_whitespace);
            let length = rest
                .find(|character: char| character.is_whitespace() != is_space)
                .unwrap_or(rest.len());
            let kind = if is_space { Kind::Space } else { Kind::Token };
            self.push(kind, start..start + length);
            start += length;
        }
    }
}

impl<'t> Node<'t> {
    /// Returns the tree that it belongs to.
    pub fn tree(self) -> &'t Tree {
        self.tree
    }

    fn entry(self) -> &'t Entry {
        &self.tree.entries[self.index]
    }

    /// Returns its kind.
    pub fn kind(self) -> Kind {
        self.entry().kind
    }

    /// Returns its span: the file and the bytes.
    pub fn span(self) -> Span {
        self.tree.span(self.range())
    }

    /// Returns the range of its bytes in the text.
    pub fn range(self) -> Range<usize> {
        self.entry().range.clone()
    }

    /// Returns the span of the first words of a block; of any other node, its whole span.
    pub fn head_span(self) -> Span {
        let head = self.child(Kind::Head).unwrap_or(self);
        let start = head.range().start;
        self.tree.span(start..start + head.text().trim_end().len())
    }

    /// Returns its text.
    pub fn text(self) -> &'t str {
        &self.tree.text[self.range()]
    }

    /// Returns its parent; `None` for the whole file.
    pub fn parent(self) -> Option<Node<'t>> {
        (self.index > 0).then(|| self.tree.node(self.entry().parent))
    }

    /// Returns its parent, the parent's parent and so on.
    pub fn ancestors(self) -> impl Iterator<Item = Node<'t>> {
        std::iter::successors(self.parent(), |node| node.parent())
    }

    /// Returns its children in source order, blanks and comments included.
    pub fn children(self) -> impl Iterator<Item = Node<'t>> {
        let end = self.entry().next;
        let mut index = self.index + 1;
        std::iter::from_fn(move || {
            let child = (index < end).then(|| self.tree.node(index))?;
            index = child.entry().next;
            Some(child)
        })
    }

    /// Returns the first child of a kind.
    pub fn child(self, kind: Kind) -> Option<Node<'t>> {
        self.all(kind).next()
    }

    /// Returns the children of a kind.
    pub fn all(self, kind: Kind) -> impl Iterator<Item = Node<'t>> {
        self.children().filter(move |child| child.kind() == kind)
    }
}

impl fmt::Debug for Node<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{:?}@{:?}", self.kind(), self.range())
    }
}
