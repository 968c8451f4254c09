//! The integration tests, one binary: the command, the traits' conformance suites, recorded data.

#![allow(clippy::unwrap_used)]

mod suite;
