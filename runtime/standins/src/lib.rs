//! Stand-ins for models: they answer prompts without a key, a network or knowledge of the task.
//!
//! In: a [`fab_model::Request`], as any model gets it. Out: a reply. [`Geometric`] works from pictures and words,
//! [`Random`] draws from what is offered, [`Imperfect`] makes the mistakes of another. Their figures are those of stand-ins,
//! and each table says so.

pub mod geometric;
pub mod imperfect;
pub mod random;

mod choices;

pub use geometric::Geometric;
pub use imperfect::Imperfect;
pub use random::Random;
