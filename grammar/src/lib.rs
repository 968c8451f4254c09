//! The grammar of the Fab language: text in, a lossless syntax tree and its syntax faults out.
//!
//! Every text has a [`Tree`]. Its leaves, joined, are the text, including comments and blank lines. Text that does
//! not parse is in the tree too, as junk. Each piece of junk has a [`Fault`] that says where it is and what was
//! expected there; the rest of the file is parsed as usual. [`ast`] gives nodes typed views, and [`blocks`] lists
//! the words that may begin a line in each block.
//!
//! ```
//! use fab_grammar::ast::Expr;
//! use fab_grammar::{Sources, parse};
//!
//! let text = "task half { # in half\n    horizon 10\n    goal overlap >\n}";
//! let mut sources = Sources::default();
//! let file = sources.add("half.fab".to_owned(), text.to_owned());
//! let parsed = parse(file, text);
//!
//! // The goal is incomplete. The fault says where, and the horizon is still there.
//! assert_eq!(parsed.faults.len(), 1);
//! assert_eq!(sources.get(file).line_and_column(parsed.faults[0].span.start), (3, 19));
//! let task = parsed.tree.view().tasks().next().expect("the file has a task");
//! let horizon = task.body().statements().next().expect("the task has a horizon");
//! assert_eq!(horizon.word().text(), "horizon");
//! assert!(matches!(horizon.value(), Expr::Quantity(ten) if ten.value() == 10.0));
//!
//! // No byte is lost.
//! let leaves: String = parsed.tree.leaves().map(|leaf| leaf.text()).collect();
//! assert_eq!(leaves, text);
//! ```
//!
//! # Architecture invariants
//!
//! - The grammar is `fab.pest`, and every keyword of the language is defined there. Pest's types never leave
//!   this crate.
//! - This crate names no unit, measure or function. The compiler decides what names and numbers mean, and words
//!   the messages for people.
//! - No function of this crate fails or panics, whatever the text.

pub mod ast;
mod conflicts;
mod fault;
mod faults;
mod limits;
mod measure;
mod rules;
mod source;
mod tree;
mod vocabulary;

pub use fault::{Fault, Problem};
pub use limits::{MAX_BYTES, MAX_NESTING, MAX_WORD_BYTES, limit_calls};
pub use source::{FileId, Source, Sources, Span};
pub use tree::{Kind, Node, Tree};
pub use vocabulary::{Block, blocks, is_keyword, keywords, words};

use pest::Parser;
use rules::{FabParser, Rule};

/// A text's tree, and its syntax faults.
#[derive(Clone, Debug)]
pub struct Parsed {
    /// The whole text as a tree.
    pub tree: Tree,
    /// The syntax faults in source order; empty if there are none.
    pub faults: Vec<Fault>,
}

/// Parses a text; never fails and never panics.
///
/// Beyond [`MAX_BYTES`], [`MAX_NESTING`] or [`MAX_WORD_BYTES`], or with an unresolved merge, the tree is one piece of
/// junk.
pub fn parse(file: FileId, text: &str) -> Parsed {
    let unparsed = |faults| Parsed {
        tree: Tree::junk(file, text),
        faults,
    };
    if let Some(fault) = limits::exceeded(file, text) {
        return unparsed(vec![fault]);
    }
    let conflicts = conflicts::find(file, text);
    if !conflicts.is_empty() {
        return unparsed(conflicts);
    }
    match FabParser::parse(Rule::file, text) {
        Ok(pairs) => {
            let tree = Tree::from_pairs(file, text, pairs);
            let faults = faults::collect(&tree);
            Parsed { tree, faults }
        }
        // The rule `file` accepts every text, so only pest's guard of the native stack can fail.
        Err(_) => unparsed(vec![limits::too_deep(Span::new(file, 0..text.len()))]),
    }
}
