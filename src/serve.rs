//! `fabc serve`: an embedded model or a recording as an OpenAI-compatible endpoint on this machine, until it is interrupted.

use crate::cli::models::ServeArguments;
use crate::exit::{Exit, Failure};
use crate::setting::models;
use crate::{output, setting};
use fab_providers::serve::serve;
use serde_json::json;

/// Serves until SIGINT.
pub fn run(arguments: &ServeArguments) -> Result<Exit, Failure> {
    let interrupt = setting::interrupt()?;
    let model = models::without_provider(&arguments.model)?;
    let name = model.name().to_owned();
    let mut ready = |address: std::net::SocketAddr| {
        let base_url = format!("http://{address}/v1");
        output::talk(&format!("serving {name} at {base_url}; interrupt to end"));
        if arguments.json {
            output::json(&json!({ "base_url": base_url, "port": address.port(), "model": name }));
        } else {
            output::data(&base_url);
        }
    };
    serve(model, arguments.port, &interrupt, &mut ready).map_err(Failure::environment)?;
    Ok(Exit::Done)
}
