//! `fabc review`: pending snapshots as JSON and on a terminal, and the effect of decisions.

mod docs;
mod findings;
mod fixtures;
mod peer_cargo_insta;
mod scripts;
#[cfg(unix)]
mod terminal;
