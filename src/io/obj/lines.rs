use super::super::error::{FileError, Place, Problem};
use super::blame::unbounded;
use crate::io::Limits;
use crate::io::budget::Growing;
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::io::{self, BufRead, Read};
use std::path::Path;

/// After so many faces an object is handed over in parts. tobj keeps 104 bytes a face and a map of
/// all corners until an object ends; this bounds both to about 200 MB, however large the mesh is.
const FACES_OF_A_PART: u64 = 1 << 20;

/// What the lines of an OBJ told, shared between the reader and tobj's loader of materials.
#[derive(Default)]
pub(super) struct Seen {
    /// The line that was handed out last, counted from 1.
    pub line: u64,
    /// The first problem that a line alone shows.
    pub error: Option<FileError>,
    /// Names that the MTL files so far define.
    pub materials: BTreeSet<String>,
    /// Whether any MTL file was named.
    pub has_mtllib: bool,
    /// Names of `usemtl` in a file without MTL.
    pub undefined: BTreeSet<String>,
    /// Faces so far, and the triangles that they make.
    pub faces: u64,
    pub triangles: u64,
}

/// Hands the lines of an OBJ to tobj one at a time, counted, joined where they end in `\`, and
/// checked for what tobj would pass over in silence.
pub(super) struct Lines<'a, R> {
    reader: R,
    file: &'a Path,
    limits: &'a Limits,
    seen: &'a RefCell<Seen>,
    current: Vec<u8>,
    position: usize,
    /// The last `o` or `g` line: said again to cut a large object into parts.
    object: Vec<u8>,
    faces_of_part: u64,
    /// Vertices, texture coordinates and normals so far.
    counts: [usize; 3],
    /// Lines that may begin one.
    meshes: u64,
    memory: Growing<'a>,
}

impl<'a, R: BufRead> Lines<'a, R> {
    pub fn new(reader: R, file: &'a Path, limits: &'a Limits, seen: &'a RefCell<Seen>) -> Self {
        Self {
            reader,
            file,
            limits,
            seen,
            current: Vec::new(),
            position: 0,
            object: b"o unnamed_object\n".to_vec(),
            faces_of_part: 0,
            counts: [0; 3],
            meshes: 0,
            memory: Growing::of(&limits.memory),
        }
    }

    fn next_line(&mut self) -> io::Result<()> {
        self.current.clear();
        self.position = 0;
        if self.faces_of_part >= FACES_OF_A_PART {
            self.faces_of_part = 0;
            self.current.extend_from_slice(&self.object);
            return Ok(());
        }
        loop {
            let limit = self.limits.line_bytes;
            let left = limit.saturating_sub(self.current.len()) as u64;
            let read = (&mut self.reader)
                .take(left)
                .read_until(b'\n', &mut self.current)?;
            if read == 0 && left > 0 {
                break;
            }
            self.seen.borrow_mut().line += 1;
            if self.current.len() >= limit && self.current.last() != Some(&b'\n') {
                let problem = Problem::TooMany {
                    what: "or more bytes in one line",
                    count: limit as u64,
                    limit: limit as u64,
                };
                return Err(self.refuse(problem));
            }
            let end = self.current.trim_ascii_end().len();
            if end > 0 && self.current[end - 1] == b'\\' {
                self.current.truncate(end - 1);
                self.current.push(b' ');
            } else {
                break;
            }
        }
        if self.current.last().is_some_and(|&last| last != b'\n') {
            self.current.push(b'\n');
        }
        if std::str::from_utf8(&self.current).is_err() {
            // Old exporters wrote names and comments in other encodings.
            self.current = String::from_utf8_lossy(&self.current).into_owned().into();
        }
        self.check().map_err(|problem| self.refuse(problem))
    }

    fn refuse(&self, problem: Problem) -> io::Error {
        let mut seen = self.seen.borrow_mut();
        let place = Place::Line(seen.line);
        seen.error
            .get_or_insert(FileError::at(self.file, place, problem));
        io::Error::other("refused")
    }

    fn check(&mut self) -> Result<(), Problem> {
        let line = std::str::from_utf8(&self.current).unwrap_or_default();
        // As tobj splits it.
        let mut words = line.split_whitespace();
        let mut seen = self.seen.borrow_mut();
        let kind = words.next();
        if let Some("f" | "l") = kind {
            let mut corners = words.clone();
            if let Some(problem) = corners.find_map(|corner| unbounded(corner, &self.counts)) {
                return Err(problem);
            }
        }
        match kind {
            Some("f") => {
                let corners = words.count() as u64;
                if corners < 3 {
                    return Err(Problem::Truncated(format!(
                        "a face needs at least 3 corners and has {corners}"
                    )));
                }
                seen.faces += 1;
                seen.triangles += corners - 2;
                self.faces_of_part += 1;
                if seen.triangles > self.limits.triangles {
                    return Err(Problem::TooMany {
                        what: "triangles",
                        count: seen.triangles,
                        limit: self.limits.triangles,
                    });
                }
            }
            Some("v") => {
                self.counts[0] += 1;
                let vertices = self.counts[0] as u64;
                if vertices > self.limits.vertices {
                    return Err(Problem::TooMany {
                        what: "vertices",
                        count: vertices,
                        limit: self.limits.vertices,
                    });
                }
            }
            Some("vt") => self.counts[1] += 1,
            Some("vn") => self.counts[2] += 1,
            Some("o" | "g") => {
                self.object.clear();
                self.object.extend_from_slice(line.trim().as_bytes());
                self.object.push(b'\n');
                self.faces_of_part = 0;
                self.meshes += 1;
            }
            Some("mtllib") => seen.has_mtllib = true,
            Some("usemtl") => {
                self.meshes += 1;
                let name = line.split_once(' ').unwrap_or_default().1.trim();
                if seen.has_mtllib && !seen.materials.contains(name) {
                    return Err(Problem::UnknownMaterial { name: name.into() });
                }
                if !seen.has_mtllib {
                    seen.undefined.insert(name.to_owned());
                }
            }
            _ => {}
        }
        let triangles = seen.triangles;
        drop(seen);
        let vertices = self.counts.into_iter().max().unwrap_or_default() as u64;
        self.memory.reach(vertices, triangles, self.meshes)
    }
}

impl<R: BufRead> Read for Lines<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let available = self.fill_buf()?;
        let length = available.len().min(buffer.len());
        buffer[..length].copy_from_slice(&available[..length]);
        self.consume(length);
        Ok(length)
    }
}

impl<R: BufRead> BufRead for Lines<'_, R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.position >= self.current.len() {
            self.next_line()?;
        }
        Ok(&self.current[self.position..])
    }

    fn consume(&mut self, amount: usize) {
        self.position += amount;
    }
}
