//! Provider models: wire formats, known facts, probes, cost estimates.
//!
//! In: a [`fab_model::Request`], and the catalogue's facts about the model. Out: a reply, or a named fault. Each call
//! is noted before it is sent. Only `remote` sends over the network.

pub mod catalogue;
pub mod estimate;
pub mod probe;
pub mod remote;

pub use remote::Remote;
