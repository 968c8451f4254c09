//! The Fab language as a grammar: text in, a lossless syntax tree and the faults of its form out.
//!
//! Every text has a [`Tree`]; its leaves, joined, are the text, comments and blank lines included. What does
//! not fit is in the tree too, as junk, and each piece of junk has a [`Fault`] that says where and what was
//! expected there; the rest of the file has its tree all the same. [`ast`] gives each node a typed view,
//! and [`blocks`] says which words may begin a line where.
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
//! // The goal lacks a part. The fault says where, and the horizon is there all the same.
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
//! - The grammar itself is `fab.pest`, and every word of the language stands there; pest's types never leave
//!   this crate.
//! - No unit, measure or function is named here: what names and numbers mean is left to the compiler, and
//!   so are the words in which a person is told.
//! - No function of this crate fails or panics, whatever the text.

pub mod ast;
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
pub use source::{FileId, Source, Sources, Span, line_and_column};
pub use tree::{Kind, Node, Tree};
pub use vocabulary::{Block, blocks, is_keyword, keywords, words};

use pest::Parser;
use rules::{FabParser, Rule};

/// A text's tree, and what is wrong with its form.
#[derive(Clone, Debug)]
pub struct Parsed {
    /// The whole text as a tree.
    pub tree: Tree,
    /// What does not fit, in source order; empty when the form is right.
    pub faults: Vec<Fault>,
}

/// Parses a text; never fails and never panics.
///
/// Beyond [`MAX_BYTES`], [`MAX_NESTING`] or [`MAX_WORD_BYTES`] the tree is one piece of junk with one fault.
pub fn parse(file: FileId, text: &str) -> Parsed {
    if let Err(fault) = limits::check(file, text) {
        return Parsed {
            tree: Tree::junk(file, text),
            faults: vec![fault],
        };
    }
    match FabParser::parse(Rule::file, text) {
        Ok(pairs) => {
            let tree = Tree::from_pairs(file, text, pairs);
            let faults = faults::collect(&tree);
            Parsed { tree, faults }
        }
        // `file` accepts every text, so only pest's guard of the native stack comes here.
        Err(_) => Parsed {
            tree: Tree::junk(file, text),
            faults: vec![limits::too_deep(Span::new(file, 0..text.len()))],
        },
    }
}
