//! Faces: what their corners are, and which part of the model they belong to.

use super::super::super::error::{FileError, Problem};
use super::super::content::{BEYOND, Corner, Face, LEFT_OUT, NONE, Part, out_of_range};
use super::super::text::{text, values};
use super::Reader;

impl Reader<'_> {
    pub(super) fn face(&mut self, rest: &[u8]) -> Result<(), FileError> {
        let count = values(rest).count() as u64;
        if count < 3 {
            let text = format!("a face needs at least 3 corners and has {count}");
            self.fault(
                "a face with fewer than 3 corners",
                Problem::Malformed(text),
                LEFT_OUT,
            );
            return Ok(());
        }
        self.triangles += count - 2;
        if self.triangles > self.limits.triangles {
            return Err(self.too_many("triangles", self.triangles, self.limits.triangles));
        }
        let part = self.part();
        let mut count = count as u32;
        let start = self.content.parts[part].corners.len();
        for word in values(rest) {
            match self.corner(word) {
                Ok(corner) => self.content.parts[part].corners.push(corner),
                Err(problem) => {
                    let before = self.content.parts[part].corners.len() - start;
                    if before >= 3 && word[0].is_ascii_alphabetic() {
                        self.note("words behind the corners of a face", LEFT_OUT);
                        count = before as u32;
                        break;
                    }
                    self.fault("a face whose corner is no index", problem, LEFT_OUT);
                    self.content.parts[part].corners.truncate(start);
                    return Ok(());
                }
            }
        }
        let face = Face {
            corners: count,
            group: self.group,
            line: u32::try_from(self.line).unwrap_or(u32::MAX),
        };
        self.content.parts[part].faces.push(face);
        Ok(())
    }

    fn part(&mut self) -> usize {
        if let Some(part) = self.part {
            return part;
        }
        let parts = &mut self.content.parts;
        let (object, material) = (self.object, self.material);
        let part = *self.places.entry((object, material)).or_insert_with(|| {
            parts.push(Part {
                object,
                material,
                ..Part::default()
            });
            parts.len() - 1
        });
        self.part = Some(part);
        part
    }

    /// The indices of a corner. Those beyond what there is so far may come later, and are looked at in the end.
    fn corner(&self, word: &[u8]) -> Result<Corner, Problem> {
        let counts = [
            self.content.positions.len(),
            self.content.uvs.len(),
            self.content.normals.len(),
        ];
        let mut corner = [NONE; 3];
        for (kind, digits) in word.split(|&byte| byte == b'/').enumerate() {
            let malformed = || {
                let word = text(word);
                Problem::Malformed(format!("the corner `{word}` of a face is not an index"))
            };
            if kind >= corner.len() {
                return Err(malformed());
            }
            if digits.is_empty() && kind > 0 {
                continue;
            }
            let digits = std::str::from_utf8(digits).map_err(|_| malformed())?;
            let index = match digits.parse::<i64>() {
                Ok(index) => index,
                Err(error) => match error.kind() {
                    std::num::IntErrorKind::PosOverflow => i64::MAX,
                    std::num::IntErrorKind::NegOverflow => i64::MIN,
                    // Some programs write them as they write every number.
                    _ => match digits.parse::<f64>() {
                        Ok(index) if index.fract() == 0.0 => index as i64,
                        _ => return Err(malformed()),
                    },
                },
            };
            let place = match index {
                1.. => u32::try_from(index - 1).ok(),
                0 => None,
                _ => {
                    let back = usize::try_from(index.unsigned_abs()).ok();
                    let place = back.and_then(|back| counts[kind].checked_sub(back));
                    place.and_then(|place| u32::try_from(place).ok())
                }
            };
            corner[kind] = match place {
                Some(place) => place.min(BEYOND),
                None if kind == 0 => return Err(out_of_range(kind, digits, counts[kind])),
                None => BEYOND,
            };
        }
        Ok(corner)
    }
}
