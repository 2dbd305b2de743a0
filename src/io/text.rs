//! The lines of a text file as old and new programs write them.

use super::error::{FileError, Place, Problem};
use std::borrow::Cow;
use std::io::{BufRead, Cursor, Read};
use std::path::{Path, PathBuf};

/// Hands out a file's lines one at a time: ended by LF, CR LF or CR alone, joined where they end in `\`, without a
/// byte order mark, from UTF-8 or UTF-16.
pub(crate) struct Lines {
    reader: Box<dyn BufRead>,
    file: PathBuf,
    /// Bytes of one line, with those that it is continued on.
    limit: usize,
    line: Vec<u8>,
    /// The line that was read last, counted from 1.
    number: u64,
}

impl Lines {
    /// Opens a file of at most `file_bytes`, unless it begins as no text does.
    pub fn open(file: &Path, file_bytes: u64, limit: usize) -> Result<Self, FileError> {
        let reading = |error: std::io::Error| FileError::reading(file, &error);
        let mut reader = super::open_to_read(file, file_bytes)?;
        let start = reader.fill_buf().map_err(reading)?;
        let (mark, wide) = encoding(start);
        if let Some(problem) = no_text(start).filter(|_| wide.is_none()) {
            return Err(FileError::new(file, problem));
        }
        reader.consume(mark);
        let reader: Box<dyn BufRead> = match wide {
            None => Box::new(reader),
            Some(unit) => {
                let mut bytes = Vec::new();
                let mut reader = reader.take(file_bytes);
                reader.read_to_end(&mut bytes).map_err(reading)?;
                let units = bytes.as_chunks::<2>().0.iter().map(|&pair| unit(pair));
                let text: String = char::decode_utf16(units)
                    .map(|character| character.unwrap_or(char::REPLACEMENT_CHARACTER))
                    .collect();
                Box::new(Cursor::new(text.into_bytes()))
            }
        };
        Ok(Self {
            reader,
            file: file.to_path_buf(),
            limit,
            line: Vec::new(),
            number: 0,
        })
    }

    /// The next line and its number as it stands, whatever it ends in; `None` at the end.
    pub fn next_unjoined(&mut self) -> Result<Option<(u64, &[u8])>, FileError> {
        self.line.clear();
        let any = self.read_line()?;
        self.number += u64::from(any);
        Ok(any.then_some((self.number, self.line.as_slice())))
    }

    /// The next line and its number, that of the last where several were joined; `None` at the end.
    pub fn next(&mut self) -> Result<Option<(u64, &[u8])>, FileError> {
        self.line.clear();
        let mut any = false;
        let mut joined = Joined::default();
        loop {
            let start = self.line.len();
            if !self.read_line()? {
                break;
            }
            any = true;
            self.number += 1;
            let text = self.line[start..].trim_ascii_end();
            let Some((b'\\', before)) = text.split_last() else {
                break;
            };
            if !joined.goes_on(before) {
                break;
            }
            let end = start + before.len();
            self.line.truncate(end);
            self.line.push(b' ');
        }
        Ok(any.then_some((self.number, self.line.as_slice())))
    }

    /// Appends a line without its end; false at the end of the file.
    fn read_line(&mut self) -> Result<bool, FileError> {
        let mut any = false;
        loop {
            let piece = self.reader.fill_buf();
            let piece = piece.map_err(|error| FileError::reading(&self.file, &error))?;
            if piece.is_empty() {
                return Ok(any);
            }
            any = true;
            let end = piece.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
            let length = end.unwrap_or(piece.len());
            if self.line.len() + length >= self.limit {
                let problem = Problem::TooMany {
                    what: "or more bytes in one line",
                    count: self.limit as u64,
                    limit: self.limit as u64,
                };
                let place = Place::Line(self.number + 1);
                return Err(FileError::at(&self.file, place, problem));
            }
            self.line.extend_from_slice(&piece[..length]);
            let Some(end) = end else {
                self.reader.consume(length);
                continue;
            };
            let is_return = piece[end] == b'\r';
            self.reader.consume(end + 1);
            if is_return {
                let then = self.reader.fill_buf();
                let then = then.map_err(|error| FileError::reading(&self.file, &error))?;
                let is_pair = then.first() == Some(&b'\n');
                self.reader.consume(usize::from(is_pair));
            }
            return Ok(true);
        }
    }
}

/// Makes a number of two bytes of UTF-16.
type Unit = fn([u8; 2]) -> u16;

/// How many bytes of a byte order mark there are, and how UTF-16 is to be read where it is that.
fn encoding(start: &[u8]) -> (usize, Option<Unit>) {
    match start {
        [0xef, 0xbb, 0xbf, ..] => (3, None),
        [0xff, 0xfe, ..] => (2, Some(u16::from_le_bytes)),
        [0xfe, 0xff, ..] => (2, Some(u16::from_be_bytes)),
        // Without a mark: no text has a zero in it.
        &[a, 0, b, 0, ..] if a != 0 && b != 0 => (0, Some(u16::from_le_bytes)),
        &[0, a, 0, b, ..] if a != 0 && b != 0 => (0, Some(u16::from_be_bytes)),
        _ => (0, None),
    }
}

/// Why a file can be no text, by how it begins. Zeros say nothing where others stand between or behind them: a file that
/// has text too can be shown in part.
pub(crate) fn no_text(start: &[u8]) -> Option<Problem> {
    /// Bytes that are looked at.
    const SEEN: usize = 1024;
    /// Fewer say too little.
    const LEAST: usize = 64;
    /// Of noise one byte in ten is a control character; of text that an old program wrote one or two may be.
    const ONE_IN: usize = 20;
    let seen = start.iter().filter(|&&byte| byte != 0).take(SEEN);
    let count = seen.clone().count();
    let controls = seen.filter(|&&byte| is_control(byte)).count();
    if count == 0 && !start.is_empty() {
        let text = "holds zeros and no text; get a complete copy";
        return Some(Problem::Malformed(text.into()));
    }
    let is_noise = count >= LEAST && controls * ONE_IN > count;
    is_noise.then(|| {
        let text = "is no text, as such a file is; it holds something else, or is damaged";
        Problem::Malformed(text.into())
    })
}

/// Whether a byte is one that text does not have, but for zeros: no space, end of a line, page or file, and no escape.
fn is_control(byte: u8) -> bool {
    byte.is_ascii_control() && !matches!(byte, b'\t'..=b'\r' | 0x1a | 0x1b)
}

/// Text in UTF-16 where its format is UTF-8 alone.
pub(crate) fn utf_16(format: &str) -> Problem {
    Problem::Malformed(format!(
        "is text in UTF-16, and {format} is UTF-8; save it as that"
    ))
}

/// Whether text begins as UTF-16 does.
pub(crate) fn is_utf_16(start: &[u8]) -> bool {
    encoding(start).1.is_some()
}

/// What is known of a line that was joined from several: each is looked at once, as there may be many of them.
#[derive(Default)]
struct Joined {
    has_words: bool,
    has_comment: bool,
    /// Behind its first word there is one that is no number.
    has_name: bool,
}

impl Joined {
    /// Whether a line goes on after the `\` behind this piece of it: not in a comment, and not where a name ends in it,
    /// which may be that of a folder.
    fn goes_on(&mut self, piece: &[u8]) -> bool {
        let is_number =
            |word: &[u8]| matches!(word.first(), Some(b'0'..=b'9' | b'+' | b'-' | b'.'));
        for word in words(piece) {
            self.has_comment |= word[0] == b'#';
            self.has_name |= self.has_words && !is_number(word);
            self.has_words = true;
        }
        let is_apart = piece.last().is_none_or(u8::is_ascii_whitespace);
        !self.has_comment && (is_apart || !self.has_name)
    }
}

/// The words of a line, without spaces and tabs.
pub(crate) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> + Clone {
    line.split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty())
}

/// The words before a comment, which may follow a number without a space. `1.#INF` has none in it: old programs wrote so
/// what is no number.
pub(crate) fn values(line: &[u8]) -> impl Iterator<Item = &[u8]> + Clone {
    let mut before = b' ';
    let comment = line.iter().position(|&byte| {
        let begins = byte == b'#' && before != b'.';
        before = byte;
        begins
    });
    words(&line[..comment.unwrap_or(line.len())])
}

/// The first word, and what follows it without the spaces around.
pub(crate) fn keyword(line: &[u8]) -> (&[u8], &[u8]) {
    let line = line.trim_ascii();
    let end = line.iter().position(u8::is_ascii_whitespace);
    let (word, rest) = line.split_at(end.unwrap_or(line.len()));
    (word, rest.trim_ascii())
}

/// Bytes as text. What is no UTF-8 is taken as Latin-1, which old exporters wrote.
pub(crate) fn text(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    }
}

/// The start of a word, as a message shows it: a file of noise has words of any length.
pub(crate) fn shown(word: &[u8]) -> Cow<'_, str> {
    const SHOWN: usize = 24;
    text(&word[..word.len().min(SHOWN)])
}

/// Why a word is no number that can be used.
pub(crate) fn number(word: &[u8]) -> Result<f32, Problem> {
    let parsed = std::str::from_utf8(word)
        .ok()
        .and_then(|word| word.parse::<f32>().ok());
    match parsed {
        Some(value) if value.is_finite() => Ok(value),
        Some(_) => Err(Problem::NotFinite {
            what: format!("`{}`", shown(word)),
        }),
        None => Err(Problem::Malformed(format!(
            "`{}` is not a number",
            shown(word)
        ))),
    }
}

/// A name without the quotes around it.
pub(crate) fn unquoted(name: &str) -> &str {
    let inner = |quote: char| name.strip_prefix(quote)?.strip_suffix(quote);
    inner('"').or_else(|| inner('\'')).map_or(name, str::trim)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(bytes: &[u8]) -> Vec<(u64, String)> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.obj");
        std::fs::write(&file, bytes).unwrap();
        let mut lines = Lines::open(&file, 1 << 20, 1 << 10).unwrap();
        let mut all = Vec::new();
        while let Some((number, line)) = lines.next().unwrap() {
            all.push((number, text(line).into_owned()));
        }
        all
    }

    fn numbered(texts: &[(u64, &str)]) -> Vec<(u64, String)> {
        texts.iter().map(|&(n, text)| (n, text.into())).collect()
    }

    #[test]
    fn lines_end_as_every_system_ends_them() {
        let expected = numbered(&[(1, "v 1"), (2, ""), (3, "f 2")]);
        for end in ["\n", "\r\n", "\r"] {
            let text = ["v 1", "", "f 2", ""].join(end);
            assert_eq!(lines(text.as_bytes()), expected, "{end:?}");
            assert_eq!(lines(text.trim_end().as_bytes()), expected, "{end:?}");
        }
    }

    #[test]
    fn a_line_goes_on_after_a_backslash_unless_that_ends_a_comment() {
        assert_eq!(
            lines(b"f 1 \\\n 2 3\n# C:\\\\\nv 1 # D:\\\nv 2\\"),
            numbered(&[
                (2, "f 1   2 3"),
                (3, "# C:\\\\"),
                (4, "v 1 # D:\\"),
                (5, "v 2 ")
            ])
        );
        assert_eq!(
            lines(b"o C:\\art\\\ng wall \\\nred\nf 1 2\\\n3\n"),
            numbered(&[(1, "o C:\\art\\"), (3, "g wall  red"), (5, "f 1 2 3")])
        );
    }

    #[test]
    fn a_line_of_very_many_lines_is_joined_in_a_moment() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.obj");
        let count = 200_000;
        std::fs::write(&file, format!("f{}", " 1\\\n".repeat(count))).unwrap();
        let started = std::time::Instant::now();
        let mut lines = Lines::open(&file, 1 << 20, 1 << 20).unwrap();
        let (number, line) = lines.next().unwrap().unwrap();
        assert_eq!((number, line.len()), (count as u64, 1 + 3 * count));
        // Each line again for each that follows would be 60 billion bytes.
        let seconds = started.elapsed().as_secs();
        assert!(seconds < 20, "{seconds} s");
    }

    #[test]
    fn a_comment_may_follow_a_number_without_a_space() {
        let found = |line: &'static [u8]| values(line).map(text).collect::<Vec<_>>();
        assert_eq!(found(b"1 2#three 4"), ["1", "2"]);
        assert_eq!(found(b"1 # 2"), ["1"]);
        assert_eq!(found(b"-1.#IND 1.#QNAN 2"), ["-1.#IND", "1.#QNAN", "2"]);
    }

    #[test]
    fn noise_and_zeros_are_no_text_and_text_with_zeros_or_a_control_character_is() {
        let mut state = 1_u32;
        let noise: Vec<u8> = std::iter::repeat_with(|| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        })
        .take(1 << 14)
        .collect();
        let told = |bytes: &[u8]| no_text(bytes).map(|problem| problem.to_string());
        assert!(told(&noise).unwrap().contains("is no text"));
        assert!(told(&[0; 100]).unwrap().contains("zeros"));
        let latin = b"# Stra\xdfe, \xc4pfel \x1b[1m\x1a\x0c \x01\n".repeat(9);
        for text in [
            &b"v 1"[..],
            b"",
            b"v 0 0 0\n\0\0\0\0\0\0\0\0\0\0",
            b"\0\0\0\0\0\0\0\0\0\0\nv 0 0 0\n",
            &latin,
        ] {
            assert_eq!(told(text), None, "{text:?}");
        }
    }

    #[test]
    fn text_is_found_in_utf_8_utf_16_and_latin_1() {
        let expected = numbered(&[(1, "newmtl ä"), (2, "Kd 1")]);
        let source = "newmtl ä\nKd 1";
        let little: Vec<u8> = source.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = source.encode_utf16().flat_map(u16::to_be_bytes).collect();
        for bytes in [
            source.as_bytes().to_vec(),
            [&[0xef, 0xbb, 0xbf], source.as_bytes()].concat(),
            [&[0xff, 0xfe], &little[..]].concat(),
            [&[0xfe, 0xff], &big[..]].concat(),
            little,
            big,
            b"newmtl \xe4\nKd 1".to_vec(),
        ] {
            assert_eq!(lines(&bytes), expected, "{bytes:?}");
        }
    }
}
