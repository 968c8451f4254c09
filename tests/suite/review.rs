//! `fabc review`: what is pending, as JSON and on a terminal, and what becomes of it.

mod docs;
mod findings;
mod fixtures;
mod peer_cargo_insta;
mod scripts;
#[cfg(unix)]
mod terminal;
