//! Plays every failure of a provider against `remote`, and counts the requests that the provider got.

#![allow(clippy::unwrap_used)]

mod answer_cache;
mod caps;
mod connections;
mod failure_messages;
mod faults;
mod hidden_reasoning;
mod interrupts;
mod leaked_keys;
mod support;
