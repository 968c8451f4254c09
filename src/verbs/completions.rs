//! `fabc completions`: scripts with which a shell completes this command line.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::Cli;
use clap::{Args, CommandFactory};
use clap_complete::Shell;

const INSTALL: &str = "\
bash        fabc completions bash > ~/.local/share/bash-completion/completions/fabc
zsh         fabc completions zsh > _fabc     in a folder of your $fpath, such as ~/.zfunc; then `autoload -U compinit && compinit`
fish        fabc completions fish > ~/.config/fish/completions/fabc.fish
powershell  fabc completions powershell | Out-String | Invoke-Expression     in your $PROFILE
elvish      eval (fabc completions elvish | slurp)     in ~/.config/elvish/rc.elv

A shell that is opened afterwards completes verbs, options and files.";

#[derive(Args)]
#[command(after_help = INSTALL)]
pub struct CompletionsArguments {
    /// The shell.
    #[arg(value_enum, value_name = "SHELL")]
    pub shell: Shell,
}

pub fn run(arguments: &CompletionsArguments, io: &Io) -> Result<Exit, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Cli::command(), "fabc", &mut script);
    let script = String::from_utf8(script).map_err(Failure::environment)?;
    io.data(script.trim_end());
    Ok(Exit::Done)
}
