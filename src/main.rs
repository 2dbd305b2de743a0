//! The program; everything that it does is in `glassbox::cli`.

use std::process::ExitCode;

fn main() -> ExitCode {
    glassbox::cli::run()
}
