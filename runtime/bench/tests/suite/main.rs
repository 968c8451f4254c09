//! The tests of suites and their figures, in one binary.

#![allow(clippy::unwrap_used)]

mod metrics;
mod statistics;
mod suites;
