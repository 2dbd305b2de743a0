//! `glassbox completions` and `glassbox man`: the command line described to a shell, and to `man`.

use super::output::say;
use super::similar::unknown;
use super::{Cli, Failure};
use clap::{Args, CommandFactory};
use clap_complete::Shell;

#[derive(Args)]
pub(super) struct Completions {
    /// Shell that is to complete the program's commands and options
    shell: Shell,
}

#[derive(Args)]
pub(super) struct Man {
    /// Command that the page is of (default: the program as a whole)
    command: Option<String>,
}

/// Prints the script that a shell reads.
pub(super) fn completions(args: Completions) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "glassbox", &mut script);
    say(String::from_utf8_lossy(&script).trim_end())
}

/// Prints a page in the form that `man` reads.
pub(super) fn man(args: Man) -> Result<(), Failure> {
    let mut program = Cli::command();
    // Commands learn their whole names.
    program.build();
    let of = match &args.command {
        None => &program,
        Some(name) => program.find_subcommand(name).ok_or_else(|| {
            let names = program.get_subcommands().map(|command| command.get_name());
            Failure::Usage(unknown(&format!("man {name}"), "command", name, names))
        })?,
    };
    let mut page = Vec::new();
    clap_mangen::Man::new(of.clone())
        .render(&mut page)
        .map_err(Failure::Output)?;
    say(String::from_utf8_lossy(&page).trim_end())
}
