//! What the lines of an MTL say.

use super::super::error::{FileError, Place};
use super::super::names::{Found, Missing, Names};
use super::super::notes::Notes;
use super::parts::Placement;
use super::text::{Lines, keyword, number, text, unquoted, values};
use crate::io::Limits;
use crate::io::budget::ENTITY;
use bevy::math::Vec2;
use std::path::{Path, PathBuf};

/// An MTL file holds text of a few lines a material; more than this is something else.
const FILE_BYTES: u64 = 1 << 26;

/// A picture of a material.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Map {
    /// From the OBJ's folder.
    pub path: String,
    pub placement: Placement,
    /// It ends at its edges.
    pub is_clamped: bool,
    /// How far it bends.
    pub bump: f32,
}

/// A picture that was named, found or not.
pub(super) type NamedMap = Option<Map>;

/// What stands between one `newmtl` and the next. What is not there was not said.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct MtlMaterial {
    pub name: String,
    pub file: PathBuf,
    pub line: u64,
    pub diffuse: Option<[f32; 3]>,
    pub specular: Option<[f32; 3]>,
    pub emission: Option<[f32; 3]>,
    pub shininess: Option<f32>,
    pub dissolve: Option<f32>,
    /// 1 - `dissolve`.
    pub transparency: Option<f32>,
    /// Index of refraction.
    pub refraction: Option<f32>,
    pub illum: Option<u32>,
    pub diffuse_map: Option<NamedMap>,
    pub opacity_map: Option<NamedMap>,
    pub specular_map: Option<NamedMap>,
    pub emission_map: Option<NamedMap>,
    pub normal_map: Option<NamedMap>,
    pub bump_map: Option<NamedMap>,
}

const LEFT_OUT: &str = "left out";
const WITHOUT_PICTURE: &str = "its material has none";

/// Appends the materials of the MTL file that an OBJ calls `name`, a path from its folder. What cannot be read is
/// noted.
pub(super) fn read_mtl(
    file: &Path,
    name: &str,
    limits: &Limits,
    names: &mut Names,
    notes: &mut Notes,
) -> Result<Vec<MtlMaterial>, FileError> {
    let prefix = name.rfind('/').map_or("", |slash| &name[..=slash]);
    let mut lines = Lines::open(file, FILE_BYTES.min(limits.file_bytes), limits.line_bytes)?;
    let mut reader = Reader {
        file,
        prefix,
        names,
        notes,
        line: 0,
        materials: Vec::new(),
    };
    while let Some((number, line)) = lines.next()? {
        reader.line = number;
        let (word, rest) = keyword(line);
        if !word.is_empty() && word[0] != b'#' {
            let before = reader.materials.len();
            reader.statement(word, rest);
            if reader.materials.len() > before {
                (limits.memory)
                    .claim(ENTITY)
                    .map_err(|problem| FileError::at(file, Place::Line(number), problem))?;
            }
        }
    }
    Ok(reader.materials)
}

struct Reader<'a, 'n> {
    file: &'a Path,
    prefix: &'a str,
    names: &'a mut Names<'n>,
    notes: &'a mut Notes,
    line: u64,
    materials: Vec<MtlMaterial>,
}

impl Reader<'_, '_> {
    fn statement(&mut self, word: &[u8], rest: &[u8]) {
        let lower = word.to_ascii_lowercase();
        if lower == b"newmtl" {
            self.new_material(rest);
            return;
        }
        let Some(mut material) = self.materials.pop() else {
            self.note("a line before the first newmtl", LEFT_OUT);
            return;
        };
        self.read(&lower, word, rest, &mut material);
        self.materials.push(material);
    }

    fn read(&mut self, word: &[u8], written: &[u8], rest: &[u8], material: &mut MtlMaterial) {
        match word {
            b"kd" => self.color("Kd", rest, &mut material.diffuse),
            b"ks" => self.color("Ks", rest, &mut material.specular),
            b"ke" => self.color("Ke", rest, &mut material.emission),
            b"ns" => self.value("Ns", rest, &mut material.shininess),
            b"ni" => self.value("Ni", rest, &mut material.refraction),
            b"d" => {
                let (first, after) = keyword(rest);
                let is_halo = first.eq_ignore_ascii_case(b"-halo");
                if is_halo {
                    self.note("`d -halo`, which depends on the view", "read as `d`");
                }
                let rest = if is_halo { after } else { rest };
                self.value("d", rest, &mut material.dissolve);
            }
            b"tr" => self.value("Tr", rest, &mut material.transparency),
            b"illum" => {
                let mut value = None;
                self.value("illum", rest, &mut value);
                let known = (0..=10_u32).find(|&model| Some(model as f32) == value);
                if known.is_none() && value.is_some() {
                    self.note("an `illum` that is none of 0 to 10", LEFT_OUT);
                }
                if known == Some(10) {
                    let what = "an `illum` of 10, shadows on what is not seen";
                    self.note(what, "its surface is seen");
                }
                material.illum = known.or(material.illum);
            }
            b"map_kd" => material.diffuse_map = self.map("map_Kd", rest),
            b"map_d" | b"map_opacity" => material.opacity_map = self.map("map_d", rest),
            b"map_ks" => material.specular_map = self.map("map_Ks", rest),
            b"map_ke" | b"map_emissive" => material.emission_map = self.map("map_Ke", rest),
            b"map_bump" | b"bump" => material.bump_map = self.map("map_Bump", rest),
            b"norm" => material.normal_map = self.map("norm", rest),
            b"tf" => {
                let mut filter = None;
                self.color("Tf", rest, &mut filter);
                if filter.is_some_and(|filter| filter != [1.0; 3]) {
                    self.unread(b"Tf");
                }
            }
            b"ka" => {
                let mut ambient = None;
                self.color("Ka", rest, &mut ambient);
                if ambient.is_some_and(|ambient| ambient != [0.0; 3]) {
                    self.note("ambient light (Ka), which is computed here", LEFT_OUT);
                }
            }
            // Of reflections that are pictures, which `refl` is noted for.
            b"sharpness" => {}
            _ => self.unread(written),
        }
    }

    fn new_material(&mut self, rest: &[u8]) {
        let mut name = text(rest).into_owned();
        if name.is_empty() {
            self.note("a material without a name", "called `unnamed`");
            name = "unnamed".into();
        }
        self.materials.push(MtlMaterial {
            name,
            file: self.file.to_path_buf(),
            line: self.line,
            ..MtlMaterial::default()
        });
    }

    fn note(&mut self, what: &str, instead: &'static str) {
        self.notes
            .add(self.file, Place::Line(self.line), what, instead);
    }

    fn unread(&mut self, word: &[u8]) {
        const SHOWN: usize = 24;
        let word = text(&word[..word.len().min(SHOWN)]);
        self.note(&format!("`{word}`, which Phong has no place for"), LEFT_OUT);
    }

    /// Three numbers, or one that stands for grey.
    fn color(&mut self, word: &str, rest: &[u8], color: &mut Option<[f32; 3]>) {
        let numbers: Result<Vec<f32>, _> = values(rest).take(4).map(number).collect();
        match numbers.as_deref() {
            Ok([grey]) => *color = Some([*grey; 3]),
            Ok([red, green, blue, ..]) => *color = Some([*red, *green, *blue]),
            _ => self.note(&format!("`{word}` without three numbers"), LEFT_OUT),
        }
    }

    fn value(&mut self, word: &str, rest: &[u8], value: &mut Option<f32>) {
        match values(rest).next().map(number) {
            Some(Ok(number)) => *value = Some(number),
            _ => self.note(&format!("`{word}` without a number"), LEFT_OUT),
        }
    }

    /// The picture that a `map_` names.
    fn map(&mut self, word: &str, rest: &[u8]) -> Option<NamedMap> {
        let mut map = Map {
            path: String::new(),
            placement: Placement::default(),
            is_clamped: false,
            bump: 1.0,
        };
        let rest = text(rest);
        let name = self.options(&rest, word, &mut map);
        if name.is_empty() {
            self.note(&format!("`{word}` without a picture"), LEFT_OUT);
            return None;
        }
        let name = self.name_among_options(name, word, &mut map);
        let path = self.picture(name);
        Some(path.map(|path| Map { path, ..map }))
    }

    /// The name of a picture that is there: options may stand behind it, or be none that the format has. Where no
    /// part of the words is one, all of them.
    fn name_among_options<'t>(&mut self, words: &'t str, word: &str, map: &mut Map) -> &'t str {
        /// Each is looked for on the disk, so that of a line without an end only the first are.
        const MOST_NAMES: usize = 32;
        if self.is_there(words) {
            return words;
        }
        let behind = words.match_indices(" -").take(MOST_NAMES);
        let behind = behind.map(|(at, _)| words.split_at(at));
        for (name, options) in behind {
            if !name.is_empty() && self.is_there(name.trim_end()) {
                let left = self.options(options.trim_start(), word, map);
                if !left.is_empty() {
                    self.note("words behind a picture's name", LEFT_OUT);
                }
                return name.trim_end();
            }
        }
        let Some((option, after)) = words
            .strip_prefix('-')
            .and_then(|words| words.split_once(char::is_whitespace))
        else {
            return words;
        };
        // With a value or without.
        let after = after.trim_start();
        let value = after.split_once(char::is_whitespace);
        for name in [Some(after), value.map(|(_, name)| name)] {
            let name = name.map(|name| self.options(name.trim_start(), word, map));
            if let Some(name) = name.filter(|name| self.is_there(name)) {
                let what = format!("the option `-{option}` of {word}, which is none");
                self.note(&what, LEFT_OUT);
                return name;
            }
        }
        words
    }

    fn is_there(&mut self, name: &str) -> bool {
        self.find(name).is_ok()
    }

    /// The file of this name seen from the MTL's folder, or else from the OBJ's, from where some programs see it.
    fn find(&mut self, name: &str) -> Result<Found, Missing> {
        let name = unquoted(name);
        let found = self.names.find(self.prefix, name);
        found.or_else(|missing| {
            let Found { path, .. } = self.names.find("", name).map_err(|_| missing)?;
            let is_guess = true;
            Ok(Found { path, is_guess })
        })
    }

    /// The picture of this name, or of what stands before a comment.
    fn picture(&mut self, name: &str) -> Option<String> {
        let before_comment = name.split_once(" #").map(|(name, _)| name.trim_end());
        let candidates = std::iter::once(name).chain(before_comment);
        let mut missing = None;
        for name in candidates {
            match self.find(name) {
                Ok(found) => {
                    if found.is_guess {
                        let place = Place::Line(self.line);
                        let what = "a picture whose name or folder is another:";
                        let instead = "the one that was found is shown";
                        self.notes
                            .add_named(self.file, place, what, &found.path, instead);
                    }
                    return Some(found.path);
                }
                Err(why) => missing = missing.or(Some((why, name))),
            }
        }
        if let Some((why, name)) = missing {
            let what = why.what("picture");
            let place = Place::Line(self.line);
            self.notes
                .add_named(self.file, place, what, unquoted(name), WITHOUT_PICTURE);
        }
        None
    }

    /// What follows a picture's options, each with its values.
    fn options<'t>(&mut self, rest: &'t str, word: &str, map: &mut Map) -> &'t str {
        let mut rest = rest;
        while let Some(option) = rest.strip_prefix('-') {
            let (option, mut after) = option
                .split_once(char::is_whitespace)
                .unwrap_or((option, ""));
            let option = option.to_ascii_lowercase();
            let most = match option.as_str() {
                "o" | "s" | "t" => 3,
                "mm" => 2,
                "blendu" | "blendv" | "cc" | "clamp" | "texres" | "bm" | "boost" | "imfchan"
                | "type" | "halo" => 1,
                // It is how the name begins.
                _ => break,
            };
            let mut numbers = [None; 3];
            let mut first = "";
            for (i, slot) in numbers.iter_mut().take(most).enumerate() {
                after = after.trim_start();
                let (value, then) = after.split_once(char::is_whitespace).unwrap_or((after, ""));
                let parsed = number(value.as_bytes()).ok();
                // `-o`, `-s` and `-t` take one to three numbers.
                if i > 0 && parsed.is_none() {
                    break;
                }
                if i == 0 {
                    first = value;
                }
                *slot = parsed;
                after = then;
            }
            self.option(&option, first, numbers, word, map);
            rest = after.trim_start();
        }
        rest
    }

    fn option(
        &mut self,
        option: &str,
        first: &str,
        numbers: [Option<f32>; 3],
        word: &str,
        map: &mut Map,
    ) {
        let vector = |otherwise: f32| {
            let [u, v, _] = numbers;
            Vec2::new(u.unwrap_or(otherwise), v.unwrap_or(otherwise))
        };
        let says_nothing = match option {
            "s" => {
                map.placement.scale = vector(1.0);
                true
            }
            "o" => {
                map.placement.offset = vector(0.0);
                true
            }
            "t" => vector(0.0) == Vec2::ZERO && numbers[2].unwrap_or(0.0) == 0.0,
            "mm" => numbers[0] == Some(0.0) && matches!(numbers[1], None | Some(1.0)),
            "clamp" => {
                map.is_clamped = first.eq_ignore_ascii_case("on");
                map.is_clamped || first.eq_ignore_ascii_case("off")
            }
            "cc" => first.eq_ignore_ascii_case("off"),
            "bm" if matches!(word, "norm" | "map_Bump") => {
                map.bump = numbers[0].unwrap_or(1.0);
                true
            }
            "bm" => numbers[0] == Some(1.0),
            "boost" => numbers[0] == Some(0.0),
            // How a picture is smoothed is a setting of the render.
            "blendu" | "blendv" | "texres" => true,
            _ => false,
        };
        if !says_nothing {
            let what = format!("the option `-{option}` of {word}");
            self.note(&what, LEFT_OUT);
        }
    }
}

#[cfg(test)]
mod tests;
