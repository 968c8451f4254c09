//! The parser that pest generates from `fab.pest`.
//!
//! The generated code has no docs; everything here is private to the crate.
#![allow(missing_docs)]

use pest_derive::Parser;

#[derive(Parser)]
#[grammar = "fab.pest"]
pub(crate) struct FabParser;
