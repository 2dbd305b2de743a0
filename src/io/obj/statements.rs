//! The statements of an OBJ: one line, one of them.

use super::super::error::{FileError, Place, Problem};
use super::super::far_off::FarOff;
use super::super::notes::Notes;
use super::content::{BEYOND, Content, LEFT_OUT};
use super::text::{Lines, keyword, number, shown, text, values};
use crate::io::Limits;
use crate::io::budget::Growing;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::Path;

mod faces;

/// The name of faces before any `o` or `g`, and after one without a name: the file's.
fn unnamed(file: &Path) -> String {
    let name = file.file_stem().unwrap_or(file.as_os_str());
    name.to_string_lossy().into_owned()
}

/// Reads a file's lines. Whatever one of them holds that cannot be used is noted, and the rest is read.
pub(super) fn read_content(
    file: &Path,
    limits: &Limits,
    notes: &mut Notes,
) -> Result<Content, FileError> {
    let mut lines = Lines::open(file, limits.file_bytes, limits.line_bytes)?;
    let mut reader = Reader {
        file,
        limits,
        notes,
        content: Content::default(),
        line: 0,
        object: 0,
        material: None,
        group: 0,
        part: None,
        triangles: 0,
        numbers: HashMap::new(),
        places: HashMap::new(),
        memory: Growing::of(&limits.memory),
        far_off: FarOff::default(),
        painted: 0,
    };
    reader.object = reader.object_named(&unnamed(file));
    while let Some((number, line)) = lines.next()? {
        reader.line = number;
        reader.read(line)?;
        reader.claim()?;
    }
    let mut content = reader.content;
    (reader.far_off).settle(&mut [&mut content.positions], file, reader.notes);
    content.finish(file, notes);
    Ok(content)
}

struct Reader<'a> {
    file: &'a Path,
    limits: &'a Limits,
    notes: &'a mut Notes,
    content: Content,
    line: u64,
    object: u32,
    material: Option<u32>,
    group: u32,
    /// Where the next face goes, once that is known.
    part: Option<usize>,
    triangles: u64,
    /// Objects, materials and libraries by their names.
    numbers: HashMap<(Kind, String), u32>,
    /// Parts by their object and material.
    places: HashMap<(u32, Option<u32>), usize>,
    memory: Growing<'a>,
    far_off: FarOff,
    /// Vertices that have a colour of a comment.
    painted: usize,
}

#[derive(PartialEq, Eq, Hash)]
enum Kind {
    Object,
    Material,
    Library,
}

impl Reader<'_> {
    /// Speaks for the memory of what there is so far.
    fn claim(&mut self) -> Result<(), FileError> {
        let Content {
            positions,
            uvs,
            normals,
            parts,
            ..
        } = &self.content;
        let vertices = positions.len().max(uvs.len()).max(normals.len()) as u64;
        (self.memory)
            .reach(vertices, self.triangles, parts.len() as u64)
            .map_err(|problem| FileError::at(self.file, Place::Line(self.line), problem))
    }

    fn read(&mut self, line: &[u8]) -> Result<(), FileError> {
        let (word, rest) = keyword(line);
        match word {
            b"v" => return self.vertex(rest),
            b"vt" => self.texture_coordinate(rest),
            b"vn" => self.normal(rest),
            b"f" | b"fo" => return self.face(rest),
            b"" => {}
            b"#MRGB" => self.painted(rest),
            _ if word[0] == b'#' => {}
            _ => return self.statement(word, rest),
        }
        Ok(())
    }

    /// Everything that is not most of a file.
    fn statement(&mut self, word: &[u8], rest: &[u8]) -> Result<(), FileError> {
        let lower = word.to_ascii_lowercase();
        match lower.as_slice() {
            b"v" | b"vt" | b"vn" | b"f" => {
                let line = [&lower[..], b" ", rest].concat();
                return self.read(&line);
            }
            b"o" | b"g" => {
                let name = match text(rest) {
                    name if name.is_empty() => unnamed(self.file),
                    name => name.into_owned(),
                };
                self.object = self.object_named(&name);
                self.part = None;
            }
            b"usemtl" => {
                let name = text(rest).into_owned();
                self.material = (!name.is_empty()).then(|| self.material_named(name));
                self.part = None;
            }
            b"mtllib" => {
                let libraries = &mut self.content.libraries;
                let name = text(rest).into_owned();
                let key = (Kind::Library, name.clone());
                if let Entry::Vacant(free) = self.numbers.entry(key) {
                    free.insert(libraries.len() as u32);
                    self.memory.named(&name);
                    libraries.push((name, self.line));
                }
            }
            b"s" => self.smoothing(rest),
            b"l" | b"p" => self.note("lines and points", LEFT_OUT),
            b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"mg" => {
                self.note(
                    "what other programs shall show instead of the faces",
                    LEFT_OUT,
                );
            }
            b"shadow_obj" | b"trace_obj" | b"maplib" | b"usemap" | b"call" | b"csh" => {
                self.unread(word, "about files of another kind");
            }
            b"cstype" | b"deg" | b"bmat" | b"step" | b"curv" | b"curv2" | b"surf" | b"parm"
            | b"trim" | b"hole" | b"scrv" | b"sp" | b"end" | b"con" | b"vp" | b"ctech"
            | b"stech" => {
                self.note("curves and free-form surfaces", LEFT_OUT);
            }
            _ => self.unread(word, "no keyword of OBJ"),
        }
        Ok(())
    }

    fn note(&mut self, what: &str, instead: &'static str) {
        let place = Place::Line(self.line);
        self.notes.add(self.file, place, what, instead);
    }

    fn unread(&mut self, word: &[u8], why: &str) {
        let word = shown(word);
        self.note(&format!("`{word}`, which is {why}"), LEFT_OUT);
    }

    /// Something that cannot be used, and what is done without it.
    fn fault(&mut self, what: &str, problem: Problem, instead: &'static str) {
        self.note(what, instead);
        let place = Place::Line(self.line);
        self.content
            .fault
            .get_or_insert_with(|| FileError::at(self.file, place, problem));
    }

    fn too_many(&self, what: &'static str, count: u64, limit: u64) -> FileError {
        let problem = Problem::TooMany { what, count, limit };
        FileError::at(self.file, Place::Line(self.line), problem)
    }

    fn object_named(&mut self, name: &str) -> u32 {
        let objects = &mut self.content.objects;
        let key = (Kind::Object, name.to_owned());
        *self.numbers.entry(key).or_insert_with(|| {
            self.memory.named(name);
            objects.push(name.to_owned());
            objects.len() as u32 - 1
        })
    }

    fn material_named(&mut self, name: String) -> u32 {
        let (materials, line) = (&mut self.content.materials, self.line);
        let key = (Kind::Material, name.clone());
        *self.numbers.entry(key).or_insert_with(|| {
            self.memory.named(&name);
            materials.push((name, line));
            materials.len() as u32 - 1
        })
    }

    fn smoothing(&mut self, rest: &[u8]) {
        let value = values(rest).next().unwrap_or_default();
        self.group = match value.to_ascii_lowercase().as_slice() {
            b"off" | b"" => 0,
            b"on" => 1,
            digits => match text(digits).parse() {
                Ok(group) => group,
                Err(_) => {
                    self.note("a smoothing group that is no number", "shaded flat");
                    0
                }
            },
        };
    }

    /// Up to `N` numbers, and how many there were. What is no number is a fault.
    fn numbers<const N: usize>(
        &mut self,
        what: &'static str,
        least: usize,
        rest: &[u8],
        instead: &'static str,
    ) -> Option<([f32; N], usize)> {
        let mut numbers = [0.0; N];
        let mut count = 0;
        for word in values(rest) {
            if count < N {
                match number(word) {
                    Ok(value) => numbers[count] = value,
                    Err(problem) if count < least => {
                        let what = format!("{what} that is no finite number");
                        self.fault(&what, problem, instead);
                        return None;
                    }
                    Err(_) => {
                        self.note("words after the numbers", LEFT_OUT);
                        return Some((numbers, count));
                    }
                }
            }
            count += 1;
        }
        if count < least {
            let given = format!("{what} needs {least} numbers and has {count}");
            self.fault(&given, Problem::Malformed(given.clone()), instead);
            return None;
        }
        Some((numbers, count))
    }

    fn vertex(&mut self, rest: &[u8]) -> Result<(), FileError> {
        const WITHOUT: &str = "left out with the faces that use it";
        let place = self.content.positions.len();
        let vertices = place as u64 + 1;
        if vertices > self.limits.vertices.min(BEYOND.into()) {
            return Err(self.too_many("vertices", vertices, self.limits.vertices));
        }
        self.content.positions.push([f32::NAN; 3]);
        let numbers = self.numbers::<8>("a vertex", 3, rest, WITHOUT);
        let mut color = None;
        if let Some(([x, y, z, r, g, b, a, _], count)) = numbers {
            let mut position = [x, y, z];
            match count {
                3 => {}
                4 if r == 0.0 => {
                    let problem = Problem::Malformed("a vertex has w = 0".into());
                    self.fault("a vertex whose w is 0", problem, WITHOUT);
                    position = [f32::NAN; 3];
                }
                4 => position = position.map(|value| value / r),
                6 => color = Some([r, g, b]),
                7 => {
                    // Either a colour with alpha follows, which is 1 mostly, or w, which is 1 then, and a colour.
                    self.note("a vertex of 7 numbers", "read as x y z r g b");
                    let is_w = r == 1.0 && a != 1.0;
                    color = Some(if is_w { [g, b, a] } else { [r, g, b] });
                }
                _ => self.note(
                    &format!("a vertex of {count} numbers"),
                    "the first three are read",
                ),
            }
            self.content.positions[place] = position;
            if self.far_off.wants(position) && count != 4 {
                self.far_off.tell(place, exact(rest), position);
            }
        }
        match color {
            Some(color) => {
                self.content.colors.resize(place, [1.0; 3]);
                self.content.colors.push(color);
            }
            None if !self.content.colors.is_empty() => self.content.colors.push([1.0; 3]),
            None => {}
        }
        Ok(())
    }

    /// Colours that ZBrush writes behind the vertices, in a comment: eight hexadecimal digits each, of which the first two
    /// are a mask.
    fn painted(&mut self, rest: &[u8]) {
        let colors = &mut self.content.colors;
        colors.resize(self.content.positions.len(), [1.0; 3]);
        let (words, left) = rest.as_chunks::<8>();
        let mut is_whole = left.is_empty();
        for word in words {
            let digits = std::str::from_utf8(word).ok();
            let number = digits.and_then(|digits| u32::from_str_radix(digits, 16).ok());
            match (number, colors.get_mut(self.painted)) {
                (Some(number), Some(color)) => {
                    let [_, rgb @ ..] = number.to_be_bytes();
                    *color = rgb.map(|channel| f32::from(channel) / 255.0);
                }
                _ => is_whole = false,
            }
            self.painted += 1;
        }
        if !is_whole {
            self.note("a comment of colours that are those of no vertex", LEFT_OUT);
        }
    }

    fn texture_coordinate(&mut self, rest: &[u8]) {
        const WITHOUT: &str = "the faces that use it have no picture";
        let numbers = self.numbers::<2>("a texture coordinate", 1, rest, WITHOUT);
        if let Some((_, 1)) = numbers {
            self.note("a texture coordinate of one number", "the second is 0");
        }
        let uv = numbers.map_or([f32::NAN; 2], |(uv, _)| uv);
        self.content.uvs.push(uv);
    }

    fn normal(&mut self, rest: &[u8]) {
        const WITHOUT: &str = "the corners that use it take the face's own";
        let numbers = self.numbers::<3>("a normal", 3, rest, WITHOUT);
        let normal = numbers.map_or([f32::NAN; 3], |(normal, _)| normal);
        self.content.normals.push(normal);
    }
}

/// The first three numbers of a vertex that are numbers, with all their digits.
fn exact(rest: &[u8]) -> [f64; 3] {
    let mut words = values(rest);
    [(); 3].map(|()| {
        let word = words.next().and_then(|word| std::str::from_utf8(word).ok());
        word.and_then(|word| word.parse().ok()).unwrap_or(0.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::Budget;

    #[test]
    fn what_has_no_name_is_called_as_its_file() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("pyramid.obj");
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no roof\nf 1 2 3\no\nf 3 2 1\n";
        std::fs::write(&file, text).unwrap();
        let content = read_content(&file, &Limits::default(), &mut Notes::default()).unwrap();
        assert_eq!(content.objects, ["pyramid", "roof"]);
    }

    #[test]
    fn names_count_as_memory_while_they_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("names.obj");
        let limits = |bytes| Limits {
            memory: Budget::of(bytes),
            ..Limits::default()
        };
        for word in ["g", "o", "usemtl", "mtllib"] {
            let lines: String = (0..20_000).map(|i| format!("{word} {i}\n")).collect();
            std::fs::write(&file, lines).unwrap();
            let read = |bytes| read_content(&file, &limits(bytes), &mut Notes::default());
            let error = read(2 << 20).err().expect(word);
            assert!(error.problem.is_of_memory(), "{word}: {error}");
            // It was not after the last of them.
            assert!(error.to_string().contains("names.obj:"), "{word}: {error}");
            assert!(!error.to_string().contains("20000"), "{word}: {error}");
            assert!(read(16 << 20).is_ok(), "{word}");
        }
    }
}
