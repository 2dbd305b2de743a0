use super::output::{one_line, tell};
use crate::io::{FileError, MergeError, Problem};
use std::io;
use std::process::ExitCode;

/// Why a command ends without a result.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The command line could not be understood, or it was a question such as `--help`.
    #[error("{0}")]
    Arguments(#[from] clap::Error),
    /// The command line asks for something that there is not, or that is out of range.
    #[error("{0}")]
    Usage(String),
    /// A file could not be read or written.
    #[error("{0}")]
    File(#[from] FileError),
    /// Parts of a picture do not add up.
    #[error("{0}")]
    Parts(#[from] MergeError),
    /// The scene does not hold what the command needs.
    #[error("{0}")]
    Scene(String),
    /// The operating system refused something that is no file.
    #[error("{0}")]
    System(String),
    /// Standard output could not be written to.
    #[error("standard output: {0}")]
    Output(io::Error),
}

impl Failure {
    /// Of a file that was to be written: one that its name or the picture's size rules out is a wrong
    /// command line, where a folder that is missing or closed is none.
    pub(super) fn of_output(error: FileError) -> Self {
        match error.problem {
            Problem::UnknownExtension { .. }
            | Problem::PictureTooLarge { .. }
            | Problem::PictureTooLong { .. } => Self::Usage(error.to_string()),
            _ => Self::File(error),
        }
    }

    /// Prints the failure in one line and gives the program's exit code.
    pub(super) fn report(self) -> ExitCode {
        match self {
            // Help and version. A reader that closed the pipe has read enough.
            Self::Arguments(error) if !error.use_stderr() => {
                let _ = error.print();
                ExitCode::SUCCESS
            }
            Self::Output(error) if error.kind() == io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
            Self::Arguments(error) => {
                tell("error", without_usage(&error.render().to_string()));
                ExitCode::from(2)
            }
            Self::Usage(text) => {
                tell("error", text);
                ExitCode::from(2)
            }
            other => {
                tell("error", other);
                ExitCode::FAILURE
            }
        }
    }
}

/// What clap says about wrong arguments, in one line and without the usage that follows.
fn without_usage(text: &str) -> String {
    let said = text.split("\n\nUsage:").next().unwrap_or(text);
    let said = said
        .split("\n\nFor more information")
        .next()
        .unwrap_or(said);
    let said = said.trim_start_matches("error:");
    let paragraphs: Vec<String> = said.split("\n\n").map(one_line).collect();
    format!("{}; see --help", paragraphs.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_clap_says_over_several_lines_becomes_one() {
        let text = "error: the following required arguments were not provided:\n  <SCENE>\n\n\
                    Usage: glassbox render <SCENE>\n\nFor more information, try '--help'.\n";
        assert_eq!(
            without_usage(text),
            "the following required arguments were not provided: <SCENE>; see --help"
        );
        let text = "error: unexpected argument '-x' found\n\n  tip: use '-- -x'\n\nUsage: a\n";
        assert_eq!(
            without_usage(text),
            "unexpected argument '-x' found; tip: use '-- -x'; see --help"
        );
    }
}
