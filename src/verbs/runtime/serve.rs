//! `fabc serve`: an embedded model or a recording as an OpenAI-compatible endpoint on this machine, until interrupted.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::runtime::setting::models;
use clap::Args;
use fab_providers::serve::serve;
use serde_json::json;

/// Arguments of `serve`.
#[derive(Args)]
pub struct ServeArguments {
    /// What answers: an embedded model or a recording, as `run` takes them (`geometric`, `replay:FILE`, …). Models of
    /// providers are refused, since every program on this machine could spend your key.
    #[arg(long, value_name = "MODEL", default_value = "geometric")]
    pub model: String,
    /// The port on 127.0.0.1; 0 takes any free one.
    #[arg(long, value_name = "N", default_value_t = 8642)]
    pub port: u16,
    /// Print the address as one JSON document, and nothing further.
    #[arg(long)]
    pub json: bool,
}

/// Serves until SIGINT.
pub fn run(arguments: &ServeArguments, io: &Io) -> Result<Exit, Failure> {
    let interrupt = io.interrupt()?;
    let model = models::without_provider(&arguments.model)?;
    let name = model.name().to_owned();
    let mut ready = |address: std::net::SocketAddr| {
        let base_url = format!("http://{address}/v1");
        io.talk(&format!("serving {name} at {base_url}; interrupt to end"));
        io.report(
            arguments.json,
            || json!({ "base_url": base_url, "port": address.port(), "model": name }),
            || base_url.clone(),
        );
    };
    serve(model, arguments.port, &interrupt, &mut ready).map_err(Failure::environment)?;
    Ok(Exit::Done)
}
