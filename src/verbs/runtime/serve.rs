//! `fabc serve`: an embedded model or a recording as an OpenAI-compatible endpoint on this machine, until interrupted.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::report::Report;
use crate::verbs::runtime::setting::models;
use clap::Args;
use fab_providers::serve::serve;
use serde::Serialize;

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
        let (port, model) = (address.port(), name.clone());
        let endpoint = Endpoint {
            base_url,
            port,
            model,
        };
        io.result(arguments.json, &endpoint);
    };
    serve(model, arguments.port, &interrupt, &mut ready)?;
    Ok(Exit::Done)
}

/// Where the model answers.
#[derive(Serialize)]
struct Endpoint {
    base_url: String,
    port: u16,
    model: String,
}

impl Report for Endpoint {
    fn text(&self) -> String {
        self.base_url.clone()
    }
}
