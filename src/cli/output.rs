//! Printing without a panic where nobody listens, and a line that stays one line.

use super::Failure;
use crate::io;
use std::fmt::Display;
use std::io::Write;
use std::path::Path;

/// Prints a result.
pub(super) fn say(text: impl Display) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{text}")
        .and_then(|()| out.flush())
        .map_err(Failure::Output)
}

/// Prints a note, a warning or an error.
pub(super) fn tell(what: &str, text: impl Display) {
    // Where standard error is closed there is no place left to complain at.
    let _ = writeln!(
        std::io::stderr().lock(),
        "{what}: {}",
        one_line(&text.to_string())
    );
}

/// Refuses what its disk has no room for; says, unless `quiet`, where the room is less than may be needed.
pub(super) fn check_room(file: &Path, bytes: u64, quiet: bool) -> Result<(), Failure> {
    let doubt = io::check_room(file, bytes)?;
    if let Some(doubt) = doubt.filter(|_| !quiet) {
        tell("warning", doubt);
    }
    Ok(())
}

/// Names in files may hold line breaks and terminal codes; the line stays one, and text.
pub(super) fn one_line(text: &str) -> String {
    let words: Vec<String> = text
        .split_whitespace()
        .map(|word| word.replace(|c: char| c.is_control(), "?"))
        .collect();
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_breaks_and_terminal_codes_do_not_pass() {
        assert_eq!(one_line("a\n  b\tc\x1b[31md"), "a b c?[31md");
    }
}
