//! The Fab language as a grammar: text in, a lossless syntax tree and the faults of its form out.
//!
//! Every text has a [`Tree`]; printing its leaves gives back the text, comments and blank lines
//! included. What does not fit is in the tree too, as junk, and each piece of junk has a [`Fault`] that
//! says where and what was expected. What names and numbers mean is left to the compiler, and so are
//! the words in which a person is told.
//!
//! The grammar itself is `fab.pest`; pest's types never leave this crate.

mod fault;
mod faults;
mod limits;
mod measure;
mod rules;
mod tree;
mod vocabulary;

pub use fault::{Fault, Problem};
pub use limits::{MAX_BYTES, MAX_NESTING, MAX_WORD_BYTES, limit_calls};
pub use tree::{Kind, Node, Tree};
pub use vocabulary::is_keyword;

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
pub fn parse(text: &str) -> Parsed {
    if let Err(fault) = limits::check(text) {
        return Parsed {
            tree: Tree::junk(text),
            faults: vec![fault],
        };
    }
    match FabParser::parse(Rule::file, text) {
        Ok(pairs) => {
            let tree = Tree::from_pairs(text, pairs);
            let faults = faults::collect(&tree);
            Parsed { tree, faults }
        }
        // `file` accepts every text, so only pest's guard of the native stack comes here.
        Err(_) => Parsed {
            tree: Tree::junk(text),
            faults: vec![limits::too_deep(0..text.len())],
        },
    }
}
