//! The integration tests, one binary: the command, the traits' conformance suites, recorded data.

#![allow(clippy::unwrap_used)]

mod recorded_data;
mod suite;
