//! Models of providers: their wires, what is known of each, what a run will cost, and a server that answers like one.
//!
//! In: a [`fab_model::Request`], and what the catalogue knows of the model. Out: a reply, or a fault by its name. Each call
//! is noted before it is sent. Only `remote` sends over the network, and only `serve` listens.

pub mod catalogue;
pub mod estimate;
pub mod probe;
pub mod remote;
pub mod serve;

pub use remote::Remote;
