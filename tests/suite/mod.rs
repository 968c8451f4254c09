//! One module per subject; `support` holds what they share.

mod support;

mod agent_loop;
mod bad_bench_input;
mod bad_input;
mod bad_see_input;
mod bad_sim_input;
mod bad_starts;
mod bench;
mod build;
mod demos;
mod free_pick;
mod job_options;
mod journal;
mod model_conformance;
mod named_ends;
mod other_grids;
mod peer_providers;
mod peers;
mod prompts;
mod readme;
mod recorded_starts;
mod retried_steps;
mod see;
mod sim_outlines;
mod sim_replay;
mod sim_verbs;
mod skipped_steps;
mod stand_in;
mod steered;
mod tidy;
mod verbs;
mod whole_programs;
mod world_conformance;
