//! What a reader left out, replaced or added, told once for each kind of it.
//!
//! A reader fills them while it reads; the command line prints a line for each, the editor shows them in one message.
//! They are saved nowhere.

use super::error::{OneLine, Place};
use std::fmt::{self, Write};
use std::path::{Path, PathBuf};

/// Names that a line shows before it counts the rest.
const NAMES_OF_A_LINE: usize = 3;
/// Names that are kept of one kind. A file can hold millions of faults.
const MOST_NAMES: usize = 100;
/// Kinds that are kept: a file of noise has a new keyword in each of its lines.
const MOST_KINDS: usize = 100;

/// What there is to say about what was read, in the order in which it was met.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Notes {
    list: Vec<FileNote>,
}

/// One kind of thing that was not taken as the file has it, however often it was met.
#[derive(Clone, Debug, PartialEq)]
pub struct FileNote {
    /// The file, as the user or the file that refers to it named it.
    pub file: PathBuf,
    /// Where in it the first one is.
    pub place: Place,
    /// What is the matter there.
    pub what: String,
    /// What that was about, each once, up to a hundred: a picture's name, a material's.
    pub names: Vec<String>,
    /// What was done instead.
    pub instead: &'static str,
    /// How many there are, at least 1.
    pub count: u64,
}

impl Notes {
    /// Says that something was not taken as the file has it, and what was done instead.
    pub(crate) fn add(
        &mut self,
        file: &Path,
        place: Place,
        what: impl AsRef<str>,
        instead: &'static str,
    ) {
        self.entry(file, place, what.as_ref(), instead);
    }

    /// The same about something that has a name. Those that differ in it alone are one note.
    pub(crate) fn add_named(
        &mut self,
        file: &Path,
        place: Place,
        what: impl AsRef<str>,
        name: &str,
        instead: &'static str,
    ) {
        if let Some(note) = self.entry(file, place, what.as_ref(), instead)
            && note.names.len() < MOST_NAMES
            && !note.names.iter().any(|known| known == name)
        {
            note.names.push(name.to_owned());
        }
    }

    fn entry(
        &mut self,
        file: &Path,
        place: Place,
        what: &str,
        instead: &'static str,
    ) -> Option<&mut FileNote> {
        let same = |note: &FileNote| note.what == what && note.instead == instead;
        let known = self.list.iter().position(|n| same(n) && n.file == file);
        let full = self.list.len() >= MOST_KINDS;
        match known.or(full.then_some(MOST_KINDS - 1)) {
            Some(at) => {
                let note = &mut self.list[at];
                note.count += 1;
                if known.is_none() {
                    note.what = "more than can be told".to_owned();
                    note.place = Place::Whole;
                    note.names.clear();
                    return None;
                }
                Some(note)
            }
            None => {
                self.list.push(FileNote {
                    file: file.to_path_buf(),
                    place,
                    what: what.to_owned(),
                    names: Vec::new(),
                    instead,
                    count: 1,
                });
                self.list.last_mut()
            }
        }
    }

    /// Adds those of another reader.
    pub(crate) fn append(&mut self, others: Self) {
        for other in others.list {
            let same = |note: &&mut FileNote| {
                (&note.what, note.instead, &note.file) == (&other.what, other.instead, &other.file)
            };
            match self.list.iter_mut().find(same) {
                Some(note) => note.count += other.count,
                None => self.list.push(other),
            }
        }
    }

    /// Each kind once, in the order in which they were met.
    pub fn iter(&self) -> std::slice::Iter<'_, FileNote> {
        self.list.iter()
    }

    /// A line for each kind.
    pub fn lines(&self) -> Vec<String> {
        self.iter().map(ToString::to_string).collect()
    }

    /// Everything was taken as the file has it.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// How many kinds there are.
    pub fn len(&self) -> usize {
        self.list.len()
    }
}

impl fmt::Display for FileNote {
    /// One line, whatever the names in the file hold.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut out = OneLine(f);
        write!(out, "{}{}: {}", self.file.display(), self.place, self.what)?;
        let mut shown = self.names.iter().take(NAMES_OF_A_LINE).enumerate();
        shown.try_for_each(|(i, name)| {
            let before = if i == 0 { " " } else { ", " };
            write!(out, "{before}`{name}`")
        })?;
        let more = self.names.len().saturating_sub(NAMES_OF_A_LINE);
        match self.names.len() {
            MOST_NAMES => write!(out, " and many more")?,
            _ if more > 0 => write!(out, " and {more} more")?,
            _ => {}
        }
        write!(out, "; {}", self.instead)?;
        if self.count as usize > self.names.len().max(1) {
            write!(out, " ({} times)", self.count)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "a.obj";

    fn note(notes: &mut Notes, line: u64, what: &str, name: &str) {
        notes.add_named(FILE.as_ref(), Place::Line(line), what, name, "left out");
    }

    #[test]
    fn notes_that_differ_in_a_name_alone_are_one_line_with_the_first_place() {
        let mut notes = Notes::default();
        for (line, name) in [(3, "a"), (4, "b"), (5, "a"), (6, "c"), (7, "d")] {
            note(&mut notes, line, "there is no picture", name);
        }
        notes.add(FILE.as_ref(), Place::Line(9), "points", "left out");
        notes.add(FILE.as_ref(), Place::Line(10), "points", "left out");
        assert_eq!(
            notes.lines(),
            [
                "a.obj:3: there is no picture `a`, `b`, `c` and 1 more; left out (5 times)",
                "a.obj:9: points; left out (2 times)",
            ]
        );
    }

    #[test]
    fn a_name_with_line_breaks_in_it_stays_in_one_line() {
        let mut notes = Notes::default();
        note(&mut notes, 1, "there is no\n", "x\r\n\x1b[2Jy");
        let lines = notes.lines();
        assert!(!lines[0].contains(char::is_control), "{lines:?}");
    }

    #[test]
    fn a_million_different_faults_are_counted_in_bounded_memory() {
        let mut notes = Notes::default();
        for i in 0..1000 {
            note(&mut notes, i, &format!("keyword {i}"), "");
            note(&mut notes, i, "the same", &i.to_string());
        }
        assert_eq!(notes.len(), MOST_KINDS);
        let most = notes.iter().map(|note| note.names.len()).max();
        assert_eq!(most, Some(MOST_NAMES));
        let all: u64 = notes.iter().map(|note| note.count).sum();
        assert_eq!(all, 2000);
    }
}
