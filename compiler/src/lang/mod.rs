//! The tables of the language: one row for each word. Checks, messages, the reference and editors read them.
//!
//! Rows that make parts of the program are beside those parts in `fab-program`: units, extractors, measures, manners.
//! Words that may begin a line are in the grammar, except the properties of a material.

pub(crate) mod actions;
pub(crate) mod annotate;
pub(crate) mod calls;
pub(crate) mod conditions;
pub(crate) mod goal;
pub(crate) mod material;
pub(crate) mod rehearse;
pub(crate) mod sections;
pub(crate) mod stage;
pub(crate) mod test;
pub(crate) mod verify;
mod vocabulary;

pub use sections::{Inheritance, RequiredFor, Section};
pub use vocabulary::{BlockWords, CallEntry, VOCABULARY_FORMAT, Vocabulary, WordEntry, vocabulary};

#[cfg(test)]
mod tests;
