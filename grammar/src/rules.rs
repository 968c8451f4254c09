//! The parser that pest makes of `fab.pest`.
//!
//! `missing_docs` cannot be met by generated code; everything here is private to the crate.
#![allow(missing_docs)]

use pest_derive::Parser;

#[derive(Parser)]
#[grammar = "fab.pest"]
pub(crate) struct FabParser;
