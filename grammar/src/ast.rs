//! Typed views of the tree: the contents of a file as written, unchecked.
//!
//! In: a [`Node`]. Out: a view, which wraps the node and gives access to its parts. A view owns nothing and is
//! cheap to copy. Text that does not parse has no view, nor does a node that lacks a required part, such as a task
//! without a name. Names are not looked up and quantities are not checked here.
//!
//! Expressions are read through [`Expr`], which skips grammar levels with a single part. Recursion is bounded by
//! [`MAX_NESTING`](crate::MAX_NESTING).

use crate::source::Span;
use crate::tree::{Kind, Node, Tree};
use std::borrow::Cow;
use std::ops;

// ---- how views are made ------------------------------------------------------------------------

trait View<'t>: Sized {
    fn cast(node: Node<'t>) -> Option<Self>;
}

/// Declares views: the kinds of node, an optional condition, the required parts, and the other parts.
///
/// A part's method has its name. It has docs only where the name is not enough.
macro_rules! views {
    ($(
        $(#[$doc:meta])*
        $view:ident($($kind:ident)|+ $(if $condition:expr)?)
        { $($(#[$part_doc:meta])* $part:ident: $type:ty = $read:expr,)* }
        $({ $($(#[$doc_of:meta])* $found:ident -> $result:ty = |$inner:ident| $find:expr;)* })?
    )*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug)]
            pub struct $view<'t> {
                node: Node<'t>,
                $($part: $type,)*
            }

            #[allow(missing_docs)]
            impl<'t> $view<'t> {
                /// Views a node; `None` if it is of another kind or lacks a required part.
                pub fn cast(node: Node<'t>) -> Option<Self> {
                    let fits = matches!(node.kind(), $(Kind::$kind)|+) $(&& $condition(node))?;
                    if !fits {
                        return None;
                    }
                    Some($view { $($part: $read(node)?,)* node })
                }

                /// Returns the node.
                pub fn node(self) -> Node<'t> {
                    self.node
                }

                /// Returns its span.
                pub fn span(self) -> Span {
                    self.node.span()
                }

                /// Returns the span of its first words, if it is a block.
                pub fn head_span(self) -> Span {
                    self.node.head_span()
                }

                $(
                    $(#[$part_doc])*
                    pub fn $part(self) -> $type {
                        self.$part
                    }
                )*

                $($(
                    $(#[$doc_of])*
                    pub fn $found(self) -> $result {
                        let $inner = self.node;
                        $find
                    }
                )*)?
            }

            impl<'t> View<'t> for $view<'t> {
                fn cast(node: Node<'t>) -> Option<Self> {
                    $view::cast(node)
                }
            }
        )*
    };
}

/// Returns the views of one type directly below a node.
fn all<'t, T: View<'t>>(node: Node<'t>) -> impl Iterator<Item = T> {
    node.children().filter_map(T::cast)
}

fn first<'t, T: View<'t>>(node: Node<'t>) -> Option<T> {
    all(node).next()
}

fn second<'t, T: View<'t>>(node: Node<'t>) -> Option<T> {
    all(node).nth(1)
}

/// Returns the name with this index, counted from the last one.
fn from_end(node: Node<'_>, index: usize) -> Option<Name<'_>> {
    let n_names = all::<Name<'_>>(node).count();
    all(node).nth(n_names.checked_sub(index + 1)?)
}

/// Returns the views of one type below the first child of a kind.
fn below<'t, T: View<'t>>(node: Node<'t>, kind: Kind) -> Option<T> {
    node.child(kind).and_then(first)
}

/// Returns the name in a block's head.
fn head_name(node: Node<'_>) -> Option<Name<'_>> {
    below(node, Kind::Head)
}

/// Returns the names in the lists of a kind: `ablate NAME, …`, `without component NAME, …`, `then without NAME, …`.
fn names<'t>(node: Node<'t>, list: Kind) -> impl Iterator<Item = Name<'t>> {
    node.all(list).flat_map(all)
}

/// Returns the views of the children of a kind, where their type has several.
fn of_kind<'t, T: View<'t>>(node: Node<'t>, kind: Kind) -> impl Iterator<Item = T> {
    node.all(kind).filter_map(T::cast)
}

views! {
    // ---- names ---------------------------------------------------------------------------------

    /// A name, or another word or sign with alternatives: an argument's label, a unit, a
    /// comparison, a statement's word; for `given`, also names joined by dots.
    Name(Name | Label | Target | Unit | Compare | StatementWord | Path) {} {
        text -> &'t str = |node| node.text();
    }

    // ---- a file --------------------------------------------------------------------------------

    /// The whole file.
    File(File) {} {
        uses -> impl Iterator<Item = Use<'t>> = |node| all(node);
        experts -> impl Iterator<Item = Experts<'t>> = |node| all(node);
        materials -> impl Iterator<Item = Material<'t>> = |node| all(node);
        tasks -> impl Iterator<Item = Task<'t>> = |node| all(node);
    }

    /// `use "…"`.
    Use(UseFile) {
        path: Text<'t> = first,
    }

    /// `experts NAME { … }` of a file.
    Experts(Experts) {
        name: Name<'t> = head_name,
    } {
        sequences -> impl Iterator<Item = FoldBlock<'t>> = |node| all(node);
    }

    /// `material NAME { … }` of a file.
    Material(Material) {
        name: Name<'t> = head_name,
    } {
        properties -> impl Iterator<Item = Property<'t>> = |node| all(node);
    }

    /// `NAME VALUE, … from "…"` of a material. Its values are the arguments of [`Property::call`].
    Property(Property) {
        name: Name<'t> = first,
    } {
        /// Returns its values, as a call of its name.
        call -> Option<Call<'t>> = |node| Call::cast(node);
        /// Returns the text beside its value.
        text -> Option<Text<'t>> = |node| first(node);
        /// Returns where its values come from.
        cited -> Option<Text<'t>> = |node| below(node, Kind::Cited);
    }

    /// `sequence { … }` or `demonstrate { … }`.
    FoldBlock(Sequence | Demonstrate) {} {
        /// Returns the moves of all its folds.
        moves -> impl Iterator<Item = Move<'t>> = |node| node.all(Kind::Fold).flat_map(all);
    }

    /// `A -> B at F`.
    Move(Move) {
        pick: Expr<'t> = first,
        place: Expr<'t> = second,
    } {
        /// Returns how far along the way it is moved, as a fraction.
        fraction -> Option<Expr<'t>> = |node| all(node).nth(2);
    }

    // ---- a task --------------------------------------------------------------------------------

    /// `task NAME extends BASE { … }`.
    Task(Task) {
        name: Name<'t> = head_name,
    } {
        extends -> Option<Name<'t>> = |node| below(node, Kind::Extends);
        body -> Body<'t> = |node| Body { node };
        variants -> impl Iterator<Item = Variant<'t>> = |node| all(node);
        ablated -> impl Iterator<Item = Name<'t>> = |node| names(node, Kind::Ablate);
        without_variants -> impl Iterator<Item = Name<'t>> = |node| names(node, Kind::WithoutVariant);
    }

    /// `variant NAME { … }`.
    Variant(Variant) {
        name: Name<'t> = head_name,
    } {
        body -> Body<'t> = |node| Body { node };
    }

    /// The body of a task or a variant, between its braces.
    Body(Task | Variant) {} {
        constants -> impl Iterator<Item = NamedValue<'t>> = |node| all(node);
        statements -> impl Iterator<Item = Statement<'t>> = |node| all(node);
        experts -> impl Iterator<Item = ExpertsUsed<'t>> = |node| all(node);
        keypoints -> impl Iterator<Item = Keypoints<'t>> = |node|
            of_kind(node, Kind::Keypoints);
        /// Returns its components, new and overriding ones in order.
        components -> impl Iterator<Item = Component<'t>> = |node| all(node);
        without -> impl Iterator<Item = Name<'t>> = |node| names(node, Kind::Without);
        stages -> impl Iterator<Item = Stage<'t>> = |node| all(node);
        /// Returns what it adds to the texts of inherited stages.
        added_sayings -> impl Iterator<Item = AddedSay<'t>> = |node| all(node);
        /// Returns the checks that it adds, outside of `verify`.
        checks -> impl Iterator<Item = Check<'t>> = |node| all(node);
        override_checks -> impl Iterator<Item = Check<'t>> = |node|
            node.all(Kind::OverrideCheck).filter_map(first);
        without_checks -> impl Iterator<Item = Name<'t>> = |node| names(node, Kind::WithoutCheck);
        tests -> impl Iterator<Item = Test<'t>> = |node| all(node);
    }

    /// `const NAME = …`, or `NAME = …` in `keypoints` and `annotate`.
    NamedValue(Constant | Keypoint) {
        name: Name<'t> = first,
        value: Expr<'t> = second,
    }

    /// `cloth …`, `goal …`: a word and its value.
    Statement(Statement) {
        word: Name<'t> = first,
        value: Expr<'t> = first,
    }

    /// `experts NAME` of a task.
    ExpertsUsed(ExpertsUsed) {
        /// Returns the name of the file's `experts`.
        name: Name<'t> = first,
    }

    /// `demos STAGE from "FILE"`.
    Demos(Demos) {
        stage: Name<'t> = first,
        file: Text<'t> = first,
    }

    /// `subgoals { … }`.
    Subgoals(Subgoals) {} {
        demonstrations -> impl Iterator<Item = FoldBlock<'t>> = |node| all(node);
        images -> impl Iterator<Item = Image<'t>> = |node| all(node);
    }

    /// `image "…" arrow (…) -> (…)`.
    Image(Image) {
        path: Text<'t> = first,
    }

    /// `keypoints { … }` or `annotate { … }`.
    Keypoints(Keypoints | Annotate) {} {
        list -> impl Iterator<Item = NamedValue<'t>> = |node| all(node);
    }

    /// `actions { … }`.
    Actions(Actions) {} {
        fields -> impl Iterator<Item = Field<'t>> = |node| all(node);
    }

    /// `NAME: one of …`, or `NAME: any of MASK`.
    Field(Field) {
        name: Name<'t> = first,
    } {
        /// Returns the choices; empty if the field is any pixel of a mask.
        // The name itself reads as an expression too.
        one_of -> impl Iterator<Item = Expr<'t>> = |node| all(node).skip(1);
        any_of -> Option<Name<'t>> = |node| below(node, Kind::AnyOf);
    }

    /// `component NAME …`, with or without `override` and `when`.
    Component(Component | OverrideComponent) {
        name: Name<'t> = first,
        text: Text<'t> = first,
    } {
        when -> Option<Expr<'t>> = |node| below(node, Kind::Guard);
    }

    /// `say NAME, … in STAGE after NAME`, or `before NAME`.
    AddedSay(AddedSay) {
        stage: Name<'t> = |node| from_end(node, 1),
        /// Returns the name of the part that it goes beside.
        beside: Name<'t> = |node| from_end(node, 0),
    } {
        /// Returns the names of the components that it adds.
        parts -> impl Iterator<Item = Name<'t>> = |node| {
            let n_parts = all::<Name<'_>>(node).count().saturating_sub(2);
            all(node).take(n_parts)
        };
        /// Returns whether they go before the other part, not after it.
        is_before -> bool = |node| has_word(node, "before");
    }

    // ---- a stage -------------------------------------------------------------------------------

    /// `stage NAME { … }`.
    Stage(Stage) {
        name: Name<'t> = head_name,
    } {
        model -> impl Iterator<Item = Model<'t>> = |node| all(node);
        show -> impl Iterator<Item = Show<'t>> = |node| all(node);
        say -> impl Iterator<Item = Sayings<'t>> = |node| of_kind(node, Kind::Say);
        system -> impl Iterator<Item = Sayings<'t>> = |node| of_kind(node, Kind::System);
        read -> impl Iterator<Item = Read<'t>> = |node| all(node);
        examples -> impl Iterator<Item = Example<'t>> = |node| all(node);
    }

    /// `model …`.
    Model(Model) {} {
        settings -> impl Iterator<Item = Setting<'t>> = |node| all(node);
    }

    /// `NAME`, or `NAME VALUE`.
    Setting(Setting) {
        name: Name<'t> = first,
    } {
        // The name itself reads as an expression too.
        value -> Option<Expr<'t>> = |node| second(node);
    }

    /// `show …`.
    Show(Show) {} {
        pictures -> impl Iterator<Item = Picture<'t>> = |node| all(node);
    }

    /// `… with NAME`.
    Picture(Picture) {
        /// Returns what is shown.
        value: Expr<'t> = first,
    } {
        /// Returns what is drawn on it.
        with -> Option<Name<'t>> = |node| first(node);
    }

    /// `say …` or `system …`.
    Sayings(Say | System) {} {
        list -> impl Iterator<Item = ComponentOrText<'t>> = |node| all(node);
    }

    /// `read NAME from "…"`.
    Read(Read) {
        name: Name<'t> = first,
    } {
        pattern -> Option<Text<'t>> = |node| first(node);
    }

    /// `example { … }`.
    Example(Example) {} {
        say -> impl Iterator<Item = Sayings<'t>> = |node| of_kind(node, Kind::Say);
        images -> impl Iterator<Item = Image<'t>> = |node| all(node);
        replies -> impl Iterator<Item = Reply<'t>> = |node| all(node);
    }

    /// `reply "…"`, with or without a stage's name.
    Reply(Reply) {
        text: Text<'t> = first,
    } {
        /// Returns the name of the stage that it answers.
        stage -> Option<Name<'t>> = |node| first(node);
    }

    // ---- a rehearsal ---------------------------------------------------------------------------

    /// `rehearse STAGE { … }`.
    Rehearse(Rehearse) {
        stage: Name<'t> = head_name,
    } {
        twins -> impl Iterator<Item = Call<'t>> = |node| all(node);
        choices -> impl Iterator<Item = Choose<'t>> = |node| all(node);
        revisions -> impl Iterator<Item = Revise<'t>> = |node| all(node);
        trusts -> impl Iterator<Item = Trust<'t>> = |node| all(node);
    }

    /// `choose most MEASURE`.
    Choose(Choose) {
        measure: Name<'t> = first,
    }

    /// `revise N with picture`.
    Revise(Revise) {
        count: Expr<'t> = first,
    }

    /// `trust overlap > N, else refuse`.
    Trust(Trust) {
        /// Returns the limit that the overlap must exceed.
        above: Expr<'t> = first,
    } {
        else_refuse -> Option<Phrase<'t>> = |node| of_kind(node, Kind::ElseRefuse).next();
    }

    // ---- checks --------------------------------------------------------------------------------

    /// `verify { … }`.
    Verify(Verify) {} {
        checks -> impl Iterator<Item = Check<'t>> = |node| all(node);
        attempts -> impl Iterator<Item = Attempts<'t>> = |node| all(node);
        results -> impl Iterator<Item = ResultCheck<'t>> = |node| all(node);
    }

    /// `check NAME { … } else "…"`.
    Check(Check) {
        name: Name<'t> = head_name,
    } {
        when -> Option<Expr<'t>> = |node| below(node, Kind::Guard);
        /// Returns the condition; `None` if it does not parse.
        condition -> Option<Expr<'t>> = |node| node.child(Kind::Expr).and_then(Expr::cast);
        message -> Option<Text<'t>> = |node| first(node);
    }

    /// `attempts N with picture, then without NAME, …, else skip`.
    Attempts(Attempts) {
        /// Returns how many there are.
        count: Expr<'t> = first,
    } {
        with_picture -> Option<Phrase<'t>> = |node| of_kind(node, Kind::WithPicture).next();
        /// Returns the checks that `then without` removes.
        relaxed -> impl Iterator<Item = Name<'t>> = |node| names(node, Kind::Relax);
        else_skip -> Option<Phrase<'t>> = |node| of_kind(node, Kind::ElseSkip).next();
    }

    /// `with picture`, `else skip` or `else refuse`.
    Phrase(WithPicture | ElseSkip | ElseRefuse) {}

    /// `result overlap > N, retries N else "…"`.
    ResultCheck(Result) {
        /// Returns the limit that the overlap must exceed.
        above: Expr<'t> = first,
    } {
        /// Returns how often a step is tried again.
        retries -> Option<Expr<'t>> = |node| below(node, Kind::Retries);
        message -> Option<Text<'t>> = |node| first(node);
    }

    // ---- tests ---------------------------------------------------------------------------------

    /// `test "…" { … }`.
    Test(Test) {} {
        name -> Option<Text<'t>> = |node| below(node, Kind::Head);
        given -> impl Iterator<Item = Given<'t>> = |node| all(node);
        replies -> impl Iterator<Item = Reply<'t>> = |node| all(node);
        expect -> impl Iterator<Item = Expect<'t>> = |node| all(node);
    }

    /// `given NAME = …`.
    Given(Given) {
        /// Returns the name, or names joined by dots.
        name: Name<'t> = first,
    } {
        /// Returns its values; empty if it is a text.
        values -> impl Iterator<Item = Expr<'t>> = |node| node.all(Kind::Expr).filter_map(Expr::cast);
        text -> Option<Text<'t>> = |node| first(node);
    }

    /// `expect reject(CHECK)`.
    Expect(Expect) {
        /// Returns the word that says what is expected.
        what: Name<'t> = first,
    } {
        /// Returns the check in brackets.
        check -> Option<Name<'t>> = |node| second(node);
        /// Returns the message that is expected.
        text -> Option<Text<'t>> = |node| first(node);
    }

    // ---- values --------------------------------------------------------------------------------

    /// A number and its unit.
    Quantity(Quantity) {
        /// Returns the number; too many digits, or a fraction of 0, give infinity, which no range accepts.
        value: f64 = |node: Node<'_>| number(node.child(Kind::Token)?.text()),
    } {
        unit -> Option<Name<'t>> = |node| first(node);
    }

    /// Names joined by dots.
    Path(Path) {} {
        /// Returns the names with the dots between them.
        text -> &'t str = |node| node.text();
    }

    /// `(A, B)`.
    Pair(Group | Pair if |node| several(node, Kind::Expr)) {} {
        parts -> [Expr<'t>; 2] = |node| [part(node, 0), part(node, 1)];
    }

    /// `VALUE in UNIT`.
    Converted(Operand) {
        target: Name<'t> = |node: Node<'t>| node.child(Kind::Target).and_then(Name::cast),
    } {
        value -> Expr<'t> = |node| part(node, 0);
    }

    /// `from A to B`.
    Heading(Heading) {} {
        from -> Expr<'t> = |node| part(node, 0);
        to -> Expr<'t> = |node| part(node, 1);
    }

    /// `A to B`.
    Range(Relation if |node| has_word(node, "to")) {} {
        low -> Expr<'t> = |node| part(node, 0);
        high -> Expr<'t> = |node| part(node, 1);
    }

    /// `NAME(…)`, a line of a material, or the twin of a rehearsal.
    Call(Call | Property | Twin) {
        name: Name<'t> = first,
    } {
        arguments -> impl Iterator<Item = Argument<'t>> = |node| all(node);
    }

    /// `NAME: …`, or the value alone.
    Argument(Argument) {
        value: Expr<'t> = first,
    } {
        label -> Option<Name<'t>> = |node| first(node);
    }

    /// `A < B` and other comparisons.
    Compare(Relation) {
        /// Returns the sign between the two.
        sign: Name<'t> = first,
    } {
        left -> Expr<'t> = |node| part(node, 0);
        right -> Expr<'t> = |node| part(node, 1);
    }

    /// `POINT within MARGIN of MASK`.
    Within(Relation if |node| has_word(node, "within")) {} {
        point -> Expr<'t> = |node| part(node, 0);
        /// Returns how far outside the point may be.
        margin -> Option<Expr<'t>> = |node| below(node, Kind::Margin);
        /// Returns the mask.
        region -> Expr<'t> = |node| part(node, 1);
    }

    /// Conditions joined by `and`.
    All(Conjunction if |node| several(node, Kind::Negation)) {} {
        parts -> impl Iterator<Item = Expr<'t>> = |node| all(node);
    }

    /// Conditions joined by `or`.
    Any(Expr if |node| several(node, Kind::Conjunction)) {} {
        parts -> impl Iterator<Item = Expr<'t>> = |node| all(node);
    }

    /// `not …`; `not not x` is `x`.
    Not(Negation if |node: Node<'_>| node.all(Kind::Token).count() % 2 == 1) {} {
        condition -> Expr<'t> = |node| part(node, 0);
    }

    // ---- texts ---------------------------------------------------------------------------------

    /// A text for a model, with placeholders for values.
    ///
    /// A text between triple quotes loses the indentation that its lines share, and its first and last line
    /// breaks; every line end becomes a line feed. Nothing else is changed. A text in quotes of the wrong kind is
    /// already a fault; it is read as it is, so it causes no further faults.
    Text(BlockText | String | CurlyText | CurlyString | SingleString) {}
}

// ---- longer methods ----------------------------------------------------------------------------

impl Tree {
    /// Returns the view of the whole file.
    pub fn view(&self) -> File<'_> {
        File::cast(self.root()).expect("the root is a file")
    }
}

impl<'t> Image<'t> {
    /// Returns the arrow's tail and tip.
    pub fn arrow(self) -> Option<[[Expr<'t>; 2]; 2]> {
        let mut ends = all(self.node).map(Pair::parts);
        Some([ends.next()?, ends.next()?])
    }
}

/// Whether a component is new or replaces one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Declares {
    /// `component`.
    New,
    /// `override component`.
    Override,
}

impl<'t> Component<'t> {
    /// Returns whether it is new or replaces one.
    pub fn declares(self) -> Declares {
        match self.node.kind() {
            Kind::OverrideComponent => Declares::Override,
            _ => Declares::New,
        }
    }
}

/// A component by name, or a text.
#[derive(Clone, Copy, Debug)]
pub enum ComponentOrText<'t> {
    /// A component.
    Component(Name<'t>),
    /// A text of its own.
    Text(Text<'t>),
}

impl<'t> ComponentOrText<'t> {
    /// Views a node; `None` if it is of another kind.
    pub fn cast(node: Node<'t>) -> Option<Self> {
        let node = Some(node).filter(|node| node.kind() == Kind::ComponentOrText)?;
        let name = first(node).map(ComponentOrText::Component);
        name.or_else(|| first(node).map(ComponentOrText::Text))
    }

    /// Returns its span.
    pub fn span(self) -> Span {
        match self {
            ComponentOrText::Component(name) => name.span(),
            ComponentOrText::Text(text) => text.span(),
        }
    }
}

impl<'t> View<'t> for ComponentOrText<'t> {
    fn cast(node: Node<'t>) -> Option<Self> {
        ComponentOrText::cast(node)
    }
}

// ---- values ------------------------------------------------------------------------------------

/// Declares [`Expr`]: one view for each kind of value or condition.
macro_rules! expressions {
    ($($(#[$doc:meta])* $case:ident($view:ident),)*) => {
        /// A value or a condition, as written.
        #[derive(Clone, Copy, Debug)]
        pub enum Expr<'t> {
            $($(#[$doc])* $case($view<'t>),)*
        }

        impl<'t> Expr<'t> {
            /// Returns the node.
            pub fn node(self) -> Node<'t> {
                match self {
                    $(Expr::$case(view) => view.node(),)*
                }
            }
        }
    };
}

expressions! {
    /// `5mm`.
    Quantity(Quantity),
    /// `corners`.
    Name(Name),
    /// `last.place`.
    Path(Path),
    /// `"…"`.
    Text(Text),
    /// `(A, B)`.
    Pair(Pair),
    /// `VALUE in UNIT`.
    Converted(Converted),
    /// `from A to B`.
    Heading(Heading),
    /// `A to B`.
    Range(Range),
    /// `NAME(…)`.
    Call(Call),
    /// `A < B`.
    Compare(Compare),
    /// `POINT within MASK`.
    Within(Within),
    /// `A and B`.
    All(All),
    /// `A or B`.
    Any(Any),
    /// `not A`.
    Not(Not),
}

impl<'t> Expr<'t> {
    /// Views a node; `None` if it is not an expression. A node with a single part is viewed as that part.
    pub fn cast(node: Node<'t>) -> Option<Self> {
        let view = match node.kind() {
            Kind::Quantity => Quantity::cast(node).map(Expr::Quantity),
            Kind::Name => Name::cast(node).map(Expr::Name),
            Kind::Path => Path::cast(node).map(Expr::Path),
            Kind::String | Kind::CurlyString | Kind::SingleString => {
                Text::cast(node).map(Expr::Text)
            }
            Kind::Heading => Heading::cast(node).map(Expr::Heading),
            Kind::Call => Call::cast(node).map(Expr::Call),
            Kind::Group => Pair::cast(node).map(Expr::Pair),
            Kind::Operand => Converted::cast(node).map(Expr::Converted),
            Kind::Relation => Compare::cast(node)
                .map(Expr::Compare)
                .or_else(|| Range::cast(node).map(Expr::Range))
                .or_else(|| Within::cast(node).map(Expr::Within)),
            Kind::Negation => Not::cast(node).map(Expr::Not),
            Kind::Conjunction => All::cast(node).map(Expr::All),
            Kind::Expr => Any::cast(node).map(Expr::Any),
            _ => return None,
        };
        view.or_else(|| first(node))
    }

    /// Returns its span.
    pub fn span(self) -> Span {
        self.node().span()
    }
}

impl<'t> View<'t> for Expr<'t> {
    fn cast(node: Node<'t>) -> Option<Self> {
        Expr::cast(node)
    }
}

fn several(node: Node<'_>, kind: Kind) -> bool {
    node.all(kind).nth(1).is_some()
}

fn has_word(node: Node<'_>, word: &str) -> bool {
    node.all(Kind::Token).any(|token| token.text() == word)
}

/// Reads `0.25` or `1/3`.
fn number(text: &str) -> Option<f64> {
    let Some((above, below)) = text.split_once('/') else {
        return text.parse().ok();
    };
    let [above, below]: [f64; 2] = [above.parse().ok()?, below.parse().ok()?];
    Some(if below > 0.0 {
        above / below
    } else {
        f64::INFINITY
    })
}

/// Returns the part with this index.
fn part(node: Node<'_>, number: usize) -> Expr<'_> {
    let part = all(node).nth(number);
    part.expect("the grammar's rule for this node has the part")
}

// ---- texts -------------------------------------------------------------------------------------

/// A part of a [`Text`].
#[derive(Clone, Debug)]
pub enum Piece<'t> {
    /// Literal characters.
    Literal(Cow<'t, str>),
    /// The value of a placeholder.
    Value(Expr<'t>),
}

const TRIPLE: usize = "\"\"\"".len();

impl<'t> Text<'t> {
    /// Returns its parts in order; no two literal parts are adjacent.
    pub fn pieces(self) -> Vec<Piece<'t>> {
        let mut pieces = Pieces::default();
        match self.node.kind() {
            Kind::BlockText => self.block(&mut pieces),
            Kind::String => {
                for child in self.node.children() {
                    match child.kind() {
                        Kind::StringChars => pieces.literal(child.text()),
                        Kind::Escape => pieces.literal(&child.text()[1..]),
                        Kind::Placeholder => pieces.placeholder(child),
                        _ => {}
                    }
                }
            }
            // Quotes of the wrong kind enclose the text all the same.
            _ => {
                let mut inside = self.node.text().chars();
                inside.next();
                inside.next_back();
                pieces.literal(inside.as_str());
            }
        }
        pieces.list
    }

    /// Returns the text if it has no placeholders.
    pub fn plain(self) -> Option<String> {
        let literal = |piece| match piece {
            Piece::Literal(text) => Some(text),
            Piece::Value(_) => None,
        };
        self.pieces().into_iter().map(literal).collect()
    }

    /// Returns whether it is empty or has only blanks.
    pub fn is_blank(self) -> bool {
        self.plain().is_some_and(|text| text.trim().is_empty())
    }

    /// Returns the number of bytes of its literal pieces.
    pub fn literal_bytes(self) -> usize {
        let length = |piece: &Piece<'_>| match piece {
            Piece::Literal(text) => text.len(),
            Piece::Value(_) => 0,
        };
        self.pieces().iter().map(length).sum()
    }

    /// Returns the byte offset of its first character in the file.
    pub fn start(self) -> usize {
        let ops::Range { start, .. } = self.node.range();
        match self.node.kind() {
            Kind::BlockText => self
                .lines()
                .first()
                .map_or(start + TRIPLE, |line| line.start),
            _ => start + self.node.text().chars().next().map_or(0, char::len_utf8),
        }
    }

    /// Adds the parts of a text between triple quotes.
    fn block(self, pieces: &mut Pieces<'t>) {
        let text = |range: ops::Range<usize>| &self.node.tree().text()[range];
        let mut placeholders = self.node.all(Kind::Placeholder).peekable();
        for (number, line) in self.lines().into_iter().enumerate() {
            if number > 0 {
                pieces.literal("\n");
            }
            // A placeholder that spans lines is already a fault, so it is left as it is.
            while placeholders
                .next_if(|node| node.range().start < line.start)
                .is_some()
            {}
            let mut at = line.start;
            while let Some(node) = placeholders.next_if(|node| node.range().end <= line.end) {
                pieces.literal(text(at..node.range().start));
                pieces.placeholder(node);
                at = node.range().end;
            }
            pieces.literal(text(at..line.end));
        }
    }

    /// Returns the byte ranges of the lines between triple quotes, without indentation and line ends.
    fn lines(self) -> Vec<ops::Range<usize>> {
        let ops::Range { start, end } = self.node.range();
        let is_closed = self.node.child(Kind::NoTriple).is_none();
        let body = start + TRIPLE..if is_closed { end - TRIPLE } else { end };
        let text = |line: &ops::Range<usize>| &self.node.tree().text()[line.clone()];
        let mut lines = lines(text(&body), body.start);
        let is_blank = |line: Option<&ops::Range<usize>>| {
            line.is_some_and(|line| text(line).trim().is_empty())
        };
        let opens_with_break = lines.len() > 1 && is_blank(lines.first());
        let closes_with_break = lines.len() > 1 && is_blank(lines.last());
        if closes_with_break {
            lines.pop();
        }
        if opens_with_break && !lines.is_empty() {
            lines.remove(0);
        }
        // Blanks directly after the quotes are not indentation.
        let indented = usize::from(!opens_with_break).min(lines.len());
        let indented = &mut lines[indented..];
        let indent = shared_indent(indented.iter().map(text));
        for line in indented {
            line.start += indent.min(blanks(text(line)).len());
        }
        lines
    }
}

/// Returns the byte ranges of the lines, without their ends.
fn lines(text: &str, offset: usize) -> Vec<ops::Range<usize>> {
    let mut next = offset;
    let range = |line: &str| {
        let start = next;
        next += line.len() + 1;
        start..start + line.strip_suffix('\r').unwrap_or(line).len()
    };
    text.split('\n').map(range).collect()
}

/// Returns a line's leading blanks.
fn blanks(line: &str) -> &str {
    &line[..line.len() - line.trim_start_matches([' ', '\t']).len()]
}

/// Returns how many leading blanks all non-blank lines share.
fn shared_indent<'t>(lines: impl Iterator<Item = &'t str>) -> usize {
    let with_words = lines.filter(|line| blanks(line).len() < line.len());
    let shared = with_words.map(blanks).reduce(|shared, next| {
        let same = shared.bytes().zip(next.bytes()).take_while(|(a, b)| a == b);
        &shared[..same.count()]
    });
    shared.map_or(0, str::len)
}

#[derive(Default)]
struct Pieces<'t> {
    list: Vec<Piece<'t>>,
}

impl<'t> Pieces<'t> {
    fn literal(&mut self, text: &'t str) {
        if text.is_empty() {
            return;
        }
        match self.list.last_mut() {
            Some(Piece::Literal(before)) => before.to_mut().push_str(text),
            _ => self.list.push(Piece::Literal(Cow::Borrowed(text))),
        }
    }

    fn placeholder(&mut self, node: Node<'t>) {
        if let Some(literal) = node.child(Kind::Literal) {
            let text = literal.text();
            self.literal(&text[1..text.len() - 1]);
        }
        if let Some(value) = first(node) {
            self.list.push(Piece::Value(value));
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
