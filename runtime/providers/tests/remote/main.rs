//! Plays every failure of a provider against `model::remote`, and counts what the provider got.

#![allow(clippy::unwrap_used)]

mod canary;
mod faults;
mod kept;
mod lost;
mod stopped;
mod support;
