//! Stand-ins for models: they answer prompts without an API key, a network or knowledge of the task.
//!
//! In: a [`fab_model::Request`], like any model. Out: a reply. [`Geometric`] works from pictures and words, [`Random`]
//! draws from the offered choices, [`Imperfect`] adds errors to another stand-in. Every table labels their figures as
//! those of stand-ins.

pub mod geometric;
pub mod imperfect;
pub mod random;

pub use geometric::Geometric;
pub use imperfect::Imperfect;
pub use random::Random;
