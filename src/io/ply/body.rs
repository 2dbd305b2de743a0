//! What follows the head: numbers, one after another.

use super::super::error::{Place, Problem};
use super::header::{Format, Property, Scalar};
use std::io::BufRead;

/// No number that is written out has more digits.
const WORD_BYTES: usize = 512;

/// Why reading went no further.
pub(super) enum Fault {
    /// What was read before can be shown.
    Of(Problem),
    /// A limit was reached: nothing is opened.
    Final(Problem),
}

/// Hands out numbers.
pub(super) struct Body<R> {
    reader: R,
    format: Format,
    line: u64,
    /// The last byte between words; 0 behind one.
    before: u8,
    word: Vec<u8>,
}

impl<R: BufRead> Body<R> {
    /// After a head of so many lines.
    pub fn of(reader: R, format: Format, lines: u64) -> Self {
        Self {
            reader,
            format,
            line: lines + 1,
            before: 0,
            word: Vec::new(),
        }
    }

    /// Where the number is that was read last, of an element.
    pub fn place(&self, element: &str) -> Place {
        match self.format {
            Format::Ascii => Place::Line(self.line),
            _ => Place::Part(format!("element {element}")),
        }
    }

    /// The next number; every kind of them is one of those exactly.
    pub fn number(&mut self, scalar: Scalar) -> Result<f64, Fault> {
        if self.format == Format::Ascii {
            return self.written(scalar);
        }
        Ok(match scalar {
            Scalar::Int8 => i8::from_le_bytes(self.bytes()?).into(),
            Scalar::Uint8 => u8::from_le_bytes(self.bytes()?).into(),
            Scalar::Int16 => i16::from_le_bytes(self.bytes()?).into(),
            Scalar::Uint16 => u16::from_le_bytes(self.bytes()?).into(),
            Scalar::Int32 => i32::from_le_bytes(self.bytes()?).into(),
            Scalar::Uint32 => u32::from_le_bytes(self.bytes()?).into(),
            Scalar::Float32 => f32::from_le_bytes(self.bytes()?).into(),
            Scalar::Float64 => f64::from_le_bytes(self.bytes()?),
        })
    }

    /// The next bytes of a number, the least first.
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let mut bytes = [0; N];
        self.reader.read_exact(&mut bytes).map_err(fault)?;
        if self.format == Format::BigEndian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    /// The number that was read last with all digits that are written out, also where the head says that it is a float.
    pub fn exact(&self, number: f64) -> f64 {
        if self.format != Format::Ascii {
            return number;
        }
        let word = std::str::from_utf8(&self.word).ok();
        word.and_then(|word| word.parse().ok()).unwrap_or(number)
    }

    fn written(&mut self, scalar: Scalar) -> Result<f64, Fault> {
        self.read_word()?;
        let word = std::str::from_utf8(&self.word).ok();
        let value = match scalar {
            // Not over f64, which would round twice.
            Scalar::Float32 => word
                .and_then(|word| word.parse::<f32>().ok())
                .map(f64::from),
            _ => word.and_then(|word| word.parse::<f64>().ok()),
        };
        let is_float = matches!(scalar, Scalar::Float32 | Scalar::Float64);
        let is_none = || is_float && word.is_some_and(says_not_a_number);
        let value = value.or_else(|| is_none().then_some(f64::NAN));
        value.ok_or_else(|| {
            let word = String::from_utf8_lossy(&self.word);
            Fault::Of(Problem::Malformed(format!("`{word}` is not a number")))
        })
    }

    fn read_word(&mut self) -> Result<(), Fault> {
        self.word.clear();
        loop {
            let piece = self.reader.fill_buf().map_err(fault)?;
            if piece.is_empty() {
                return match self.word.is_empty() {
                    true => Err(ended()),
                    false => Ok(()),
                };
            }
            let is_space = |byte: &u8| byte.is_ascii_whitespace();
            if self.word.is_empty() {
                let start = piece.iter().position(|byte| !is_space(byte));
                let start = start.unwrap_or(piece.len());
                for &byte in &piece[..start] {
                    // Lines end in one of them, or in both.
                    let is_end = byte == b'\r' || (byte == b'\n' && self.before != b'\r');
                    self.line += u64::from(is_end);
                    self.before = byte;
                }
                if start > 0 {
                    self.reader.consume(start);
                    continue;
                }
            }
            let end = piece.iter().position(is_space);
            let length = end.unwrap_or(piece.len());
            if self.word.len() + length > WORD_BYTES {
                let text = "a word of so many letters is not a number".to_owned();
                return Err(Fault::Of(Problem::Malformed(text)));
            }
            self.word.extend_from_slice(&piece[..length]);
            self.before = 0;
            self.reader.consume(length);
            if end.is_some() {
                return Ok(());
            }
        }
    }

    /// The length of a list.
    pub fn length(&mut self, scalar: Scalar) -> Result<u64, Fault> {
        let length = self.number(scalar)?;
        match length >= 0.0 && length.fract() == 0.0 {
            true => Ok(length as u64),
            false => {
                let text = format!("a list has a length of {length}");
                Err(Fault::Of(Problem::Malformed(text)))
            }
        }
    }

    /// Reads a number or a list, and forgets it.
    pub fn skip(&mut self, property: &Property) -> Result<(), Fault> {
        let count = match property.length {
            Some(length) => self.length(length)?,
            None => 1,
        };
        for _ in 0..count {
            self.number(property.scalar)?;
        }
        Ok(())
    }

    /// Whether nothing is left but white space.
    pub fn is_at_end(&mut self) -> std::io::Result<bool> {
        loop {
            let piece = self.reader.fill_buf()?;
            let count = piece.len();
            if count == 0 || !piece.iter().all(u8::is_ascii_whitespace) {
                return Ok(count == 0);
            }
            self.reader.consume(count);
        }
    }
}

/// Microsoft's spellings of what is no finite number: `-nan(ind)`, `1.#QNAN`, `-1.#IND`, `1.#INF`.
fn says_not_a_number(word: &str) -> bool {
    let word = word.trim_start_matches(['-', '+']);
    word.starts_with("nan(") || word.starts_with("1.#")
}

fn ended() -> Fault {
    let text = "its header says that there is more".to_owned();
    Fault::Of(Problem::Truncated(text))
}

fn fault(error: std::io::Error) -> Fault {
    match error.kind() {
        std::io::ErrorKind::UnexpectedEof => ended(),
        _ => Fault::Final(Problem::Unreadable(error.to_string())),
    }
}
