//! Pictures that come with what each light adds to them, as [`write_lights`](super::write_lights) writes them, and mixes of
//! them.

use super::super::error::{FileError, Problem};
use super::super::open_to_read;
use super::write::write_exr_layers;
use super::{block_bytes, check_size, exr_head, exr_problem, from_exr};
use crate::film::Picture;
use crate::io::Limits;
use exr::prelude::{FlatSamples, ReadChannels, ReadLayers, read};
use glam::{DVec3, UVec2, Vec3};
use std::collections::BTreeMap;
use std::path::Path;

/// What the names of the layers begin with.
pub(super) const LAYER: &str = "Combined_";

/// A picture, and what it consists of.
#[derive(Clone, Debug, PartialEq)]
pub struct LightLayers {
    /// Linear, scene-referred.
    pub picture: Picture,
    /// What each light adds, by the light's name as the file has it; `Own` is what shines by itself, `Others` what lights add
    /// that have no layer each.
    pub layers: BTreeMap<String, Picture>,
    /// What the file says of itself, line by line.
    pub comments: Vec<String>,
    /// Which program wrote it.
    pub software: Option<String>,
}

/// The name that a light's layer has in a file: a dot would part it from its channels, what is no letter ends names and
/// lines, and of a name that is longer than the format's names the beginning is kept.
pub fn layer_name(light: &str) -> String {
    let name = light.replace(|c: char| c == '.' || c.is_control(), "_");
    beginning(&name, MOST_BYTES).to_owned()
}

/// Of a layer's name, so that with `Combined_` before it and `.R` behind it it has no more than the 255 of a channel's.
const MOST_BYTES: usize = 255 - LAYER.len() - 2;

/// The letters of a text that have so many bytes at most.
fn beginning(text: &str, bytes: usize) -> &str {
    &text[..text.floor_char_boundary(bytes)]
}

/// The name, or where a layer has that already, one with a number behind it.
pub(super) fn free_name(name: &str, id: u64, is_taken: impl Fn(&str) -> bool) -> String {
    if !is_taken(name) {
        return name.to_owned();
    }
    let mut numbers = (1_u64..).map(|n| match n {
        1 => format!("-{id}"),
        n => format!("-{id}-{n}"),
    });
    let numbered = |number: String| {
        let start = beginning(name, MOST_BYTES.saturating_sub(number.len()));
        format!("{start}{number}")
    };
    loop {
        let name = numbered(numbers.next().unwrap_or_default());
        if !is_taken(&name) {
            return name;
        }
    }
}

impl LightLayers {
    /// Reads such a picture. Whether it is one, and how large, is found out before anything is decoded.
    pub fn read(path: &Path, limits: &Limits) -> Result<Self, FileError> {
        let no_layers = || Problem::Malformed(NO_LAYERS.to_owned());
        let meta = exr_head(path, limits, no_layers)?;
        let header = meta
            .headers
            .first()
            .ok_or_else(|| FileError::new(path, no_layers()))?;
        let names = header.channels.list.iter().map(|channel| &channel.name);
        if header.deep || !names.clone().any(|name| *name == *OWN_RED) {
            return Err(FileError::new(path, no_layers()));
        }
        let (width, height) = (header.layer_size.x() as u64, header.layer_size.y() as u64);
        check_size(path, width, height, limits)?;
        // Every channel while it is read and as part of a picture, and a block, compressed and not.
        let channels = (names.count() as u64).saturating_mul(8);
        let bytes = (width * height).saturating_mul(channels);
        let block = block_bytes(header).saturating_mul(3);
        (limits.memory)
            .claim(bytes.saturating_add(block))
            .map_err(|problem| FileError::new(path, problem))?;
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .non_parallel()
            .from_buffered(open_to_read(path, limits.file_bytes)?)
            .map_err(|error| FileError::new(path, exr_problem(error)))?;
        let layer = image.layer_data;
        let comments = layer.attributes.comments.as_ref().map(from_exr);
        let mut found = Self {
            picture: Picture::black(UVec2::new(width as u32, height as u32)),
            layers: BTreeMap::new(),
            comments: comments
                .map_or_else(Vec::new, |all| all.lines().map(str::to_owned).collect()),
            software: layer.attributes.software_name.as_ref().map(from_exr),
        };
        for channel in layer.channel_data.list {
            found.take(&from_exr(&channel.name), &channel.sample_data);
        }
        Ok(found)
    }

    /// Puts a channel where it belongs; what belongs to no light is not kept.
    fn take(&mut self, name: &str, samples: &FlatSamples) {
        let (layer, channel) = name.rsplit_once('.').unwrap_or(("", name));
        let Some(channel) = ["R", "G", "B"].iter().position(|other| *other == channel) else {
            return;
        };
        let size = self.picture.size();
        let picture = match layer.strip_prefix(LAYER) {
            Some(light) => {
                let layer = self.layers.entry(light.to_owned());
                layer.or_insert_with(|| Picture::black(size))
            }
            None if layer.is_empty() => &mut self.picture,
            None => return,
        };
        for (pixel, value) in picture.pixels.iter_mut().zip(samples.values_as_f32()) {
            pixel[channel] = value;
        }
    }

    /// Multiplies layers by linear RGB factors, by their names; the picture is the sum of what comes of it. Where all factors
    /// are 1 it stays as it is, bit for bit. Returns how many of its pixels were brought to the largest number of f32.
    pub fn mix(&mut self, factors: &BTreeMap<String, Vec3>) -> usize {
        let is_neutral = |name: &String| factors.get(name).is_none_or(|gain| *gain == Vec3::ONE);
        if self.layers.keys().all(is_neutral) {
            return 0;
        }
        let mut sums = vec![DVec3::ZERO; self.picture.pixels.len()];
        for (name, layer) in &mut self.layers {
            let factor = factors.get(name).map_or(DVec3::ONE, |gain| gain.as_dvec3());
            for (sum, pixel) in sums.iter_mut().zip(&mut layer.pixels) {
                // Of what is infinite without light is nothing left.
                let value = DVec3::select(
                    factor.cmpeq(DVec3::ZERO),
                    DVec3::ZERO,
                    pixel.as_dvec3() * factor,
                );
                *sum += value;
                *pixel = value.clamp(DVec3::MIN_OF_F32, DVec3::MAX_OF_F32).as_vec3();
            }
        }
        let mut clamped = 0;
        for (pixel, sum) in self.picture.pixels.iter_mut().zip(sums) {
            let held = sum.clamp(DVec3::MIN_OF_F32, DVec3::MAX_OF_F32);
            clamped += usize::from(held != sum);
            *pixel = held.as_vec3();
        }
        clamped
    }

    /// Writes it as such a picture, with another line of what it says of itself.
    pub fn write(&self, path: &Path, line: &str) -> Result<(), FileError> {
        let layers: Vec<(String, &Picture)> = (self.layers.iter())
            .map(|(name, layer)| (format!("{LAYER}{name}"), layer))
            .collect();
        let mut notes: Vec<(&str, String)> = Vec::new();
        notes.extend(self.software.iter().map(|name| ("Software", name.clone())));
        let lines = self.comments.iter().map(String::as_str).chain([line]);
        notes.extend(lines.filter_map(|line| {
            let (name, text) = line.split_once(": ")?;
            Some((name, text.to_owned()))
        }));
        write_exr_layers(path, &self.picture, &layers, &notes)
    }
}

const NO_LAYERS: &str = "holds no light apart; `glassbox render --lights-separately -o lights.exr` writes what each light adds as a layer";
const OWN_RED: &str = "Combined_Own.R";

/// The ends of f32.
trait EndsOfF32 {
    const MIN_OF_F32: Self;
    const MAX_OF_F32: Self;
}

impl EndsOfF32 for DVec3 {
    const MIN_OF_F32: Self = DVec3::splat(f32::MIN as f64);
    const MAX_OF_F32: Self = DVec3::splat(f32::MAX as f64);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layers() -> LightLayers {
        let picture = |value: [f32; 3]| Picture {
            pixels: vec![value.into(); 6],
            ..Picture::black(UVec2::new(3, 2))
        };
        let layers = [
            ("Own", [0.1, 0.2, 0.3]),
            ("Key", [1.0, 2.0, 4.0]),
            ("Fill", [0.5, 0.0, 0.25]),
        ];
        LightLayers {
            // Not quite the sum, as it is of exact sums.
            picture: picture([1.600_001, 2.2, 4.55]),
            layers: layers
                .map(|(name, value)| (name.to_owned(), picture(value)))
                .into(),
            comments: vec!["Camera: a".into(), "Samples: 4".into()],
            software: Some("Glassbox".into()),
        }
    }

    fn factors(name: &str, factor: Vec3) -> BTreeMap<String, Vec3> {
        std::iter::once((name.to_owned(), factor)).collect()
    }

    #[test]
    fn a_mix_is_the_sum_of_its_layers_and_with_factors_of_one_the_picture_that_it_was() {
        let mut mixed = layers();
        assert_eq!(mixed.mix(&factors("Key", Vec3::ONE)), 0);
        assert_eq!(mixed, layers());
        assert_eq!(mixed.mix(&factors("Key", Vec3::new(2.0, 1.0, 0.0))), 0);
        assert_eq!(mixed.picture.pixels[5], Vec3::new(2.6, 2.2, 0.55));
        assert_eq!(mixed.layers["Key"].pixels[0], Vec3::new(2.0, 2.0, 0.0));
        assert_eq!(mixed.layers["Fill"], layers().layers["Fill"]);
    }

    #[test]
    fn what_is_brighter_than_a_file_holds_stays_a_number_and_is_counted() {
        let mut mixed = layers();
        assert_eq!(mixed.mix(&factors("Key", Vec3::splat(f32::MAX))), 6);
        assert_eq!(mixed.picture.pixels[0], Vec3::MAX);
        let mut dark = layers();
        dark.layers.get_mut("Key").unwrap().pixels[0] = Vec3::INFINITY;
        dark.mix(&factors("Key", Vec3::ZERO));
        assert!(dark.picture.pixels[0].is_finite());
    }

    #[test]
    fn names_in_every_script_and_of_any_length_come_back_from_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let mut named = layers();
        let key = named.layers["Key"].clone();
        // The second to last byte of the longest is within a letter.
        let long = layer_name(&"灯".repeat(90));
        assert_eq!(long.len(), 243);
        for name in ["Größe", "灯", &long, &layer_name(&"a".repeat(300))] {
            named.layers.insert(name.into(), key.clone());
        }
        named.comments.push("Mix: Größe=2".into());
        named.write(&path, "Mix: 灯=2").unwrap();
        named.comments.push("Mix: 灯=2".into());
        assert_eq!(LightLayers::read(&path, &Limits::default()).unwrap(), named);
        // As other programs read them.
        let bytes = std::fs::read(&path).unwrap();
        for text in ["Combined_Größe.R", "Combined_灯.G", "Mix: 灯=2"] {
            let text = text.as_bytes();
            assert!(bytes.windows(text.len()).any(|bytes| bytes == text));
        }
        // What an older version wrote.
        let old = exr::prelude::Text::new_or_panic("Größe");
        assert_eq!(from_exr(&old), "Größe");
    }

    #[test]
    fn lights_whose_names_begin_alike_have_layers_of_their_own() {
        let name = layer_name(&"x".repeat(400));
        assert_eq!(name.len() + LAYER.len() + 2, 255);
        let mut taken = vec![name.clone()];
        for _ in 0..3 {
            let free = free_name(&name, u64::MAX, |name| {
                taken.iter().any(|other| other == name)
            });
            assert!(free.len() <= name.len() && !taken.contains(&free), "{free}");
            assert_eq!(layer_name(&free), free, "it is found by its name");
            taken.push(free);
        }
        assert_eq!(free_name("Key", 7, |name| name == "Key"), "Key-7");
    }

    #[test]
    fn a_mix_that_is_written_is_read_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        layers().write(&path, "Mix: Key=2").unwrap();
        let read = LightLayers::read(&path, &Limits::default()).unwrap();
        let mut expected = layers();
        expected.comments.push("Mix: Key=2".into());
        assert_eq!(read, expected);
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() - 9]).unwrap();
        let error = LightLayers::read(&path, &Limits::default()).unwrap_err();
        assert!(matches!(error.problem, Problem::Truncated(_)), "{error}");
        std::fs::write(&path, &bytes[..60]).unwrap();
        let error = LightLayers::read(&path, &Limits::default()).unwrap_err();
        assert!(matches!(error.problem, Problem::Truncated(_)), "{error}");
        // All is there, and what is packed in its last block is not what was packed.
        let black = Picture::black(UVec2::splat(64));
        let large = LightLayers {
            layers: std::iter::once(("Own".to_owned(), black.clone())).collect(),
            picture: black,
            ..layers()
        };
        large.write(&path, "Mix: Own=1").unwrap();
        let mut damaged = std::fs::read(&path).unwrap();
        let end = damaged.len();
        damaged[end - 24..].fill(0x80);
        std::fs::write(&path, damaged).unwrap();
        let error = LightLayers::read(&path, &Limits::default()).unwrap_err();
        assert!(matches!(error.problem, Problem::Malformed(_)), "{error}");
        std::fs::write(&path, "no picture").unwrap();
        let error = LightLayers::read(&path, &Limits::default()).unwrap_err();
        assert!(error.to_string().contains("no light apart"), "{error}");
    }
}
