use crate::io::FileError;
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
    /// The scene does not hold what the command needs.
    #[error("{0}")]
    Scene(String),
    /// The operating system refused something that is no file.
    #[error("{0}")]
    System(String),
}

impl Failure {
    /// Prints the failure in one line and gives the program's exit code.
    pub(super) fn report(self) -> ExitCode {
        match self {
            Self::Arguments(error) if !error.use_stderr() => {
                // Help and version. A reader that closed the pipe has read enough.
                let _ = error.print();
                ExitCode::SUCCESS
            }
            Self::Arguments(error) => {
                eprintln!("error: {}", one_line(&error.render().to_string()));
                ExitCode::from(2)
            }
            Self::Usage(text) => {
                eprintln!("error: {}", joined(&text));
                ExitCode::from(2)
            }
            other => {
                eprintln!("error: {}", joined(&other.to_string()));
                ExitCode::FAILURE
            }
        }
    }
}

/// What clap says about wrong arguments, without the usage that follows.
fn one_line(text: &str) -> String {
    let said = text.split("\n\nUsage:").next().unwrap_or(text);
    let said = said
        .split("\n\nFor more information")
        .next()
        .unwrap_or(said);
    let said = said.trim_start_matches("error:");
    let paragraphs: Vec<String> = said.split("\n\n").map(joined).collect();
    format!("{}; see --help", paragraphs.join("; "))
}

/// A name from a file may hold a line break; the message stays one line.
fn joined(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_clap_says_over_several_lines_becomes_one() {
        let text = "error: the following required arguments were not provided:\n  <SCENE>\n\n\
                    Usage: glassbox render <SCENE>\n\nFor more information, try '--help'.\n";
        assert_eq!(
            one_line(text),
            "the following required arguments were not provided: <SCENE>; see --help"
        );
        let text =
            "error: unexpected argument '-x' found\n\n  tip: use '-- -x'\n\nUsage: glassbox\n";
        assert_eq!(
            one_line(text),
            "unexpected argument '-x' found; tip: use '-- -x'; see --help"
        );
    }
}
