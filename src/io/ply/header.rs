//! The head of a PLY: lines that say what follows, and how it is written.

use super::super::error::{FileError, Place, Problem};
use super::super::file_name::of_file;
use super::super::folder::Folder;
use super::super::names::Names;
use super::super::text::{is_utf_16, keyword, no_text, shown, text, utf_16};
use super::content::Work;
use crate::scene::{Phong, TextureSource};
use bevy::color::LinearRgba;
use std::io::{BufRead, Read};

/// No head is longer.
const HEAD_BYTES: u64 = 1 << 20;

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Format {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// What a number is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scalar {
    Int8,
    Uint8,
    Int16,
    Uint16,
    Int32,
    Uint32,
    Float32,
    Float64,
}

impl Scalar {
    fn named(word: &[u8]) -> Option<Self> {
        Some(match word {
            b"char" | b"int8" => Self::Int8,
            b"uchar" | b"uint8" => Self::Uint8,
            b"short" | b"int16" => Self::Int16,
            b"ushort" | b"uint16" => Self::Uint16,
            b"int" | b"int32" => Self::Int32,
            b"uint" | b"uint32" => Self::Uint32,
            b"float" | b"float32" => Self::Float32,
            b"double" | b"float64" => Self::Float64,
            _ => return None,
        })
    }

    /// What a colour's channel of 1 is.
    pub fn whole(self) -> f64 {
        match self {
            Self::Int8 => i8::MAX.into(),
            Self::Uint8 => u8::MAX.into(),
            Self::Int16 => i16::MAX.into(),
            Self::Uint16 => u16::MAX.into(),
            Self::Int32 => i32::MAX.into(),
            Self::Uint32 => u32::MAX.into(),
            Self::Float32 | Self::Float64 => 1.0,
        }
    }
}

/// A number, or a list of them, that every one of an element's kind has.
pub(super) struct Property {
    pub name: String,
    pub scalar: Scalar,
    /// What the length of a list is; `None` for a single number.
    pub length: Option<Scalar>,
}

/// A kind of thing, and how many there are, if the file says the truth.
pub(super) struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
}

/// What a file says of itself.
pub(super) struct Header {
    pub format: Format,
    pub elements: Vec<Element>,
    pub lines: u64,
    /// After `comment TextureFile`.
    textures: Vec<String>,
}

/// What is taken in while a file's numbers are gone through.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Pass {
    All,
    Vertices,
    Faces,
}

impl Header {
    /// How often the numbers are gone through: faces name vertices, and stand behind them in nearly all files. Where
    /// they stand in front, the file is read twice.
    pub fn passes(&self) -> &'static [Pass] {
        let place = |is: fn(&str) -> bool| self.elements.iter().position(|e| is(&e.name));
        let faces = place(|name| matches!(name, "face" | "tristrips"));
        let vertices = place(|name| name == "vertex");
        match faces < vertices && faces.is_some() {
            true => &[Pass::Vertices, Pass::Faces],
            false => &[Pass::All],
        }
    }
}

/// Reads up to and with `end_header`.
pub(super) fn read_header(reader: &mut impl BufRead, work: &mut Work) -> Result<Header, FileError> {
    let file = work.file;
    let mut lines = HeadLines {
        reader: reader.take(HEAD_BYTES),
        number: 0,
        end: None,
    };
    let reading = |error: std::io::Error| FileError::reading(file, &error);
    let start = lines.reader.fill_buf().map_err(reading)?;
    let problem = match is_utf_16(start) {
        true => Some(utf_16("PLY")),
        // A header of text stands in front of whatever there is.
        false => no_text(start).filter(|_| !start.starts_with(b"ply")),
    };
    if let Some(problem) = problem {
        return Err(FileError::new(file, problem));
    }
    let mut line = Vec::new();
    let mut next = |line: &mut Vec<u8>| {
        let more = lines.next(line);
        let more = more.map_err(|error| FileError::reading(file, &error))?;
        match more {
            true => Ok(lines.number),
            false => {
                let problem = Problem::Truncated("the header has no `end_header`".into());
                Err(FileError::new(file, problem))
            }
        }
    };
    let malformed =
        |line: u64, what: String| FileError::at(file, Place::Line(line), Problem::Malformed(what));
    next(&mut line)?;
    if line.trim_ascii() != b"ply" {
        return Err(malformed(
            1,
            "is no PLY: it does not begin with `ply`".into(),
        ));
    }
    let mut format = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut textures = Vec::new();
    loop {
        let number = next(&mut line)?;
        let (word, rest) = keyword(&line);
        match word {
            b"format" => {
                let (name, version) = keyword(rest);
                format = Some(match name {
                    b"ascii" => Format::Ascii,
                    b"binary_little_endian" => Format::LittleEndian,
                    b"binary_big_endian" => Format::BigEndian,
                    _ => {
                        let text = format!("`{}` is no format of PLY", shown(name));
                        return Err(malformed(number, text));
                    }
                });
                if version != b"1.0" {
                    let what = format!("version `{}` of PLY", shown(version));
                    let instead = "read as version 1.0";
                    work.notes.add(file, Place::Line(number), what, instead);
                }
            }
            b"comment" => {
                let (key, value) = keyword(rest);
                if key.eq_ignore_ascii_case(b"TextureFile") && !value.is_empty() {
                    textures.push(text(value).into_owned());
                }
            }
            b"element" => {
                let (name, count) = keyword(rest);
                let count = std::str::from_utf8(count).ok().and_then(|n| n.parse().ok());
                let Some(count) = count else {
                    let text = format!("element `{}` has no number", shown(name));
                    return Err(malformed(number, text));
                };
                elements.push(Element {
                    name: shown(name).into_owned(),
                    count,
                    properties: Vec::new(),
                });
            }
            b"property" => {
                let property = property(rest);
                match (property, elements.last_mut()) {
                    (Some(property), Some(element)) => element.properties.push(property),
                    _ => {
                        let text = format!("`{}` is no property of an element", shown(rest));
                        return Err(malformed(number, text));
                    }
                }
            }
            b"obj_info" | b"" => {}
            b"end_header" => break,
            _ => {
                let what = format!("`{}`, which is no keyword of PLY", shown(word));
                work.notes.add(file, Place::Line(number), what, "left out");
            }
        }
    }
    let lines = lines.number;
    match format {
        Some(format) => Ok(Header {
            format,
            elements,
            lines,
            textures,
        }),
        None => Err(malformed(lines, "the header says no `format`".into())),
    }
}

/// `TYPE NAME`, or `list TYPE TYPE NAME`.
fn property(rest: &[u8]) -> Option<Property> {
    let (word, rest) = keyword(rest);
    let (length, scalar, name) = match word {
        b"list" => {
            let (length, rest) = keyword(rest);
            let (scalar, name) = keyword(rest);
            (Some(Scalar::named(length)?), scalar, name)
        }
        _ => (None, word, rest),
    };
    Some(Property {
        name: shown(name).into_owned(),
        scalar: Scalar::named(scalar)?,
        length,
    })
}

impl Header {
    /// The material of a mesh: that of the first picture, where it has coordinates for it.
    pub fn material(
        &self,
        has_uvs: bool,
        folder: &Folder,
        work: &mut Work,
    ) -> Vec<(String, Phong)> {
        let Some(name) = self.textures.first() else {
            return Vec::new();
        };
        let file = work.file;
        let notes = &mut work.notes;
        if !has_uvs {
            let what = "no texture coordinates for the picture";
            notes.add_named(file, Place::Whole, what, name, "left out");
            return Vec::new();
        }
        for other in &self.textures[1..] {
            let what = "more than one picture:";
            notes.add_named(file, Place::Whole, what, other, "the first is used");
        }
        let found = match Names::new(folder).find("", name) {
            Ok(found) => found,
            Err(missing) => {
                let what = missing.what("picture");
                notes.add_named(file, Place::Whole, what, name, "shown without");
                return Vec::new();
            }
        };
        if found.is_guess {
            let what = "a picture whose name is spelt otherwise:";
            let instead = "the one that was found is used";
            notes.add_named(file, Place::Whole, what, &found.path, instead);
        }
        let phong = Phong {
            diffuse: LinearRgba::WHITE,
            diffuse_map: Some(TextureSource::new(of_file(found.path))),
            ..Phong::default()
        };
        vec![(name.clone(), phong)]
    }
}

/// The lines of a head. What ends the first of them ends all: behind the last, binary numbers begin.
struct HeadLines<R> {
    reader: std::io::Take<R>,
    number: u64,
    end: Option<&'static [u8]>,
}

impl<R: BufRead> HeadLines<R> {
    /// Reads the next line without its end; false where there is none with an end.
    fn next(&mut self, line: &mut Vec<u8>) -> std::io::Result<bool> {
        line.clear();
        loop {
            let mut byte = [0];
            if self.reader.read(&mut byte)? == 0 {
                return Ok(false);
            }
            match (byte[0], self.end) {
                (b'\n', _) => {
                    self.end.get_or_insert(b"\n");
                    break;
                }
                (b'\r', Some(b"\r")) => break,
                (b'\r', None) => {
                    let is_pair = self.reader.fill_buf()?.first() == Some(&b'\n');
                    self.reader.consume(usize::from(is_pair));
                    self.end = Some(if is_pair { b"\r\n" } else { b"\r" });
                    break;
                }
                (byte, _) => line.push(byte),
            }
        }
        self.number += 1;
        Ok(true)
    }
}
