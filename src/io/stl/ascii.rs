//! An ASCII STL: words, whatever the lines are.

use super::super::Limits;
use super::super::error::{FileError, Place, Problem};
use super::super::polygon::Triangulator;
use super::super::text::{Lines, keyword, number, shown, text};
use super::facets::{Facet, Facets, More};
use super::neither;
use bevy::math::{DVec3, Vec3};

const LEFT_OUT: &str = "left out";
/// Corners of one loop. More are no facet but noise.
const MOST_CORNERS: usize = 1 << 16;

/// Reads the solids of a file.
pub(super) fn read_ascii(facets: &mut Facets, limits: &Limits) -> Result<(), FileError> {
    let mut lines = Lines::open(facets.file, limits.file_bytes, limits.line_bytes)?;
    let mut reader = Reader {
        facets,
        line: 0,
        normal: Vec::new(),
        corners: Vec::new(),
        exact: Vec::new(),
        is_broken: false,
        triangulator: Triangulator::default(),
        triangles: Vec::new(),
    };
    while let Some((number, line)) = lines.next_unjoined()? {
        reader.line = number;
        reader.read(line)?;
    }
    reader.end_loop()
}

struct Reader<'a, 'b> {
    facets: &'a mut Facets<'b>,
    line: u64,
    normal: Vec<f32>,
    corners: Vec<[f32; 3]>,
    /// The same with all their digits, where the model is far off.
    exact: Vec<[f64; 3]>,
    /// Something of the loop could not be read.
    is_broken: bool,
    triangulator: Triangulator,
    triangles: Vec<[u32; 3]>,
}

impl Reader<'_, '_> {
    fn read(&mut self, line: &[u8]) -> Result<(), FileError> {
        let mut rest = line;
        loop {
            let (word, after) = keyword(rest);
            rest = after;
            match lower(word, &mut [0; 8]) {
                b"" => return Ok(()),
                b"solid" => {
                    self.end_loop()?;
                    let (name, facets) = split_name(rest);
                    self.facets.begin(&text(name))?;
                    rest = facets;
                }
                b"endsolid" => {
                    self.end_loop()?;
                    rest = split_name(rest).1;
                }
                b"facet" => {
                    self.end_loop()?;
                    self.normal.clear();
                    let (word, after) = keyword(rest);
                    if word.eq_ignore_ascii_case(b"normal") {
                        rest = self.normal(after);
                    }
                }
                b"vertex" => rest = self.vertex(rest),
                b"endloop" | b"endfacet" => self.end_loop()?,
                b"outer" | b"loop" => {}
                other => {
                    let what = format!("`{}`, which is no keyword of STL", shown(other));
                    self.note(&what, LEFT_OUT);
                    let place = Place::Line(self.line);
                    let file = self.facets.file;
                    (self.facets.fault)
                        .get_or_insert_with(|| FileError::at(file, place, neither()));
                    return Ok(());
                }
            }
        }
    }

    fn note(&mut self, what: &str, instead: &'static str) {
        let place = Place::Line(self.line);
        self.facets
            .notes
            .add(self.facets.file, place, what, instead);
    }

    fn fault(&mut self, problem: Problem) {
        self.is_broken = true;
        let (file, place) = (self.facets.file, Place::Line(self.line));
        (self.facets.fault).get_or_insert_with(|| FileError::at(file, place, problem));
    }

    /// Three numbers, which may be none: facets have a normal of their own.
    fn normal<'a>(&mut self, mut rest: &'a [u8]) -> &'a [u8] {
        for _ in 0..3 {
            let (word, after) = keyword(rest);
            if word.is_empty() || word.eq_ignore_ascii_case(b"outer") {
                break;
            }
            self.normal.push(number(word).unwrap_or(0.0));
            rest = after;
        }
        rest
    }

    fn vertex<'a>(&mut self, mut rest: &'a [u8]) -> &'a [u8] {
        let mut corner = [0.0; 3];
        let mut words: [&[u8]; 3] = [&[]; 3];
        for (value, of_value) in corner.iter_mut().zip(&mut words) {
            let (word, after) = keyword(rest);
            *of_value = word;
            match number(word) {
                Ok(number) => *value = number,
                Err(problem) => {
                    self.fault(problem);
                    // The rest of the line belongs to it.
                    return &[];
                }
            }
            rest = after;
        }
        if self.corners.len() < MOST_CORNERS {
            self.corners.push(corner);
            if self.facets.far_off.wants(corner) {
                let exact = |word| std::str::from_utf8(word).ok()?.parse().ok();
                self.exact
                    .push(words.map(|word| exact(word).unwrap_or(0.0)));
            }
        }
        rest
    }

    /// Makes facets of the corners of a loop.
    fn end_loop(&mut self) -> Result<(), FileError> {
        let is_broken = std::mem::take(&mut self.is_broken);
        let count = self.corners.len();
        if is_broken || count == 1 || count == 2 {
            let what = "a facet without three corners that are numbers";
            self.note(what, LEFT_OUT);
            self.corners.clear();
            self.exact.clear();
            return Ok(());
        }
        if count == 0 {
            return Ok(());
        }
        let (corners, exact) = (
            std::mem::take(&mut self.corners),
            std::mem::take(&mut self.exact),
        );
        let polygon: Vec<Vec3> = match exact.first() {
            // Which way it bends is seen near it.
            Some(&first) => {
                let near = exact.iter().map(|&at| DVec3::from(at) - DVec3::from(first));
                near.map(|at| at.as_vec3()).collect()
            }
            None => corners.iter().copied().map(Vec3::from).collect(),
        };
        self.triangles.clear();
        (self.triangulator).triangulate(&polygon, &mut self.triangles);
        if count > 3 {
            self.note("a facet of more than 3 corners", "read as a polygon");
        }
        let normal = match self.normal[..] {
            [x, y, z] => [x, y, z],
            _ => [0.0; 3],
        };
        let line = self.line;
        for triangle in &self.triangles {
            let facet = Facet {
                normal,
                corners: triangle.map(|i| corners[i as usize]),
                more: match exact.is_empty() {
                    true => More::Nothing,
                    false => More::Digits(triangle.map(|i| exact[i as usize])),
                },
            };
            self.facets.push(facet, || Place::Line(line))?;
        }
        Ok(())
    }
}

/// A solid's name, and what of the line comes after it: a file may have no lines.
fn split_name(rest: &[u8]) -> (&[u8], &[u8]) {
    const NEXT: &[u8] = b"facet normal";
    let next = rest
        .windows(NEXT.len())
        .position(|word| word.eq_ignore_ascii_case(NEXT));
    let (name, after) = rest.split_at(next.unwrap_or(rest.len()));
    (name.trim_ascii(), after)
}

/// A word in lower case, where it is as short as a keyword.
fn lower<'a>(word: &'a [u8], buffer: &'a mut [u8; 8]) -> &'a [u8] {
    match buffer.get_mut(..word.len()) {
        Some(key) => {
            key.copy_from_slice(word);
            key.make_ascii_lowercase();
            key
        }
        None => word,
    }
}
