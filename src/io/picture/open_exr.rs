//! OpenEXR pictures with channels of any names.
//!
//! Names have the form `LAYER.CHANNEL`; only what follows the last dot says what a channel is, in any case:
//!
//! - a layer with `R`, `G` or `B` (or `red`, `green`, `blue`) is a colour, and what it lacks of them is 0;
//! - one with `Y` (or `luminance`), and no `X` that would make it a vector, is grey;
//! - one that has `RY` and `BY` beside `Y` is a colour, which follows from them;
//! - one of a single channel of another name is grey, too;
//! - `A` (or `alpha`) is the alpha of the first two.
//!
//! Of several the kinds count in this order, then a layer without a name, then one called `Combined` or
//! `beauty`, then what comes first in the file. No other channel is kept.

use super::super::error::{FileError, Problem};
use super::read::Decoded;
use super::{
    block_bytes, check_size, claim_picture, decoder_bytes, exr_problem, exr_subsampled, from_exr,
};
use crate::io::Limits;
use exr::block::UncompressedBlock;
use exr::block::lines::LineIndex;
use exr::block::reader::ChunksReader;
use exr::compression::Compression;
use exr::error::{Error, UnitResult};
use exr::meta::attribute::{ChannelDescription, SampleType};
use exr::meta::header::Header;
use exr::prelude::{Vec2, f16};
use image::{DynamicImage, ImageBuffer};
use std::io::{BufRead, Seek, SeekFrom};
use std::path::Path;

/// Decodes the largest level of an OpenEXR picture, as large as its display window: RGB in `f32`, or RGBA where it has alpha.
pub(super) fn decode(
    name: &Path,
    mut reader: impl BufRead + Seek,
    limits: &Limits,
) -> Result<Decoded, FileError> {
    let fails = |error| FileError::new(name, exr_problem(error));
    let opened = exr::block::read(&mut reader, false);
    let reader = match opened {
        Err(error @ Error::NotSupported(_)) => {
            let rewound = reader.seek(SeekFrom::Start(0));
            rewound.map_err(|error| FileError::reading(name, &error))?;
            let decoded = exr_subsampled::decode(name, reader, limits)?;
            return decoded.ok_or_else(|| fails(error));
        }
        opened => opened.map_err(fails)?,
    };
    let layer = Layer::chosen(reader.headers()).map_err(|problem| FileError::new(name, problem))?;
    let header = &reader.headers()[layer.header];
    if matches!(
        header.compression,
        Compression::HTJ2K32 | Compression::HTJ2K256
    ) {
        let text = "is compressed as HTJ2K, which is not read; ZIP and PIZ are, for example";
        return Err(FileError::new(name, Problem::Malformed(text.to_owned())));
    }
    check_memory(name, header, limits)?;
    let is_half = layer.is_half(header);
    let mut pixels = Pixels::new(layer, header);
    let chosen = pixels.layer.header;
    reader
        .filter_chunks(false, |_, tile, block| {
            block.layer == chosen && tile.is_largest_resolution_level()
        })
        .and_then(|chunks| {
            chunks.decompress_parallel(false, |meta, block| pixels.take(&meta.headers, &block))
        })
        .map_err(fails)?;
    pixels.decoded(name, is_half)
}

/// Blocks that are decoded at the same time.
const BLOCKS_AT_A_TIME: u64 = 8;

/// Refuses what asks for too much memory: as a picture, or for one of the blocks that it is kept in, which
/// hold every channel.
pub(super) fn check_memory(name: &Path, header: &Header, limits: &Limits) -> Result<(), FileError> {
    let (data, display) = (
        header.layer_size,
        header.shared_attributes.display_window.size,
    );
    for size in [display, data] {
        check_size(name, size.width() as u64, size.height() as u64, limits)?;
    }
    let bytes = block_bytes(header);
    let limit = decoder_bytes(limits);
    if bytes > limit {
        let text = format!("keeps {bytes} bytes in one block, and the limit is {limit}");
        return Err(FileError::new(name, Problem::Malformed(text)));
    }
    let size = (display.width() as u32, display.height() as u32);
    claim_picture(name, size, 4, limits)?;
    // Each thread has one, compressed and not.
    let claimed = limits.memory.claim(bytes.saturating_mul(BLOCKS_AT_A_TIME));
    claimed.map_err(|problem| FileError::new(name, problem))
}

/// The channels that are taken, as indices into those of a part of the file.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Layer {
    /// Which part.
    header: usize,
    /// Red, green and blue, where they are there.
    colors: [Option<usize>; 3],
    /// They are RY, Y and BY, which red, green and blue follow from.
    is_chroma: bool,
    /// In place of them.
    grey: Option<usize>,
    alpha: Option<usize>,
}

impl Layer {
    pub fn chosen(headers: &[Header]) -> Result<Self, Problem> {
        let mut best: Option<([u8; 2], Self)> = None;
        for (index, header) in headers
            .iter()
            .enumerate()
            .filter(|(_, header)| !header.deep)
        {
            let names: Vec<String> = (header.channels.list.iter())
                .map(|channel| from_exr(&channel.name))
                .collect();
            for (rank, layer) in layers(index, &names) {
                if best.as_ref().is_none_or(|(other, _)| rank < *other) {
                    best = Some((rank, layer));
                }
            }
        }
        best.map(|(_, layer)| layer).ok_or_else(|| {
            let channels = headers.iter().flat_map(|header| &header.channels.list);
            let names: Vec<String> = channels.take(8).map(|c| from_exr(&c.name)).collect();
            Problem::Malformed(format!(
                "holds no colours that are read: R, G and B, or Y; its first channels are {}",
                names.join(", ")
            ))
        })
    }

    pub fn is_half(&self, header: &Header) -> bool {
        let taken = self
            .colors
            .iter()
            .chain([&self.grey, &self.alpha])
            .flatten();
        let mut channels = taken.filter_map(|&i| header.channels.list.get(i));
        channels.all(|channel| channel.sample_type == SampleType::F16)
    }
}

/// The layers of a part of a file that could be taken; the smallest rank is the best.
fn layers(header: usize, names: &[String]) -> Vec<([u8; 2], Layer)> {
    let split = |name: &'_ str| -> (String, String) {
        let (layer, channel) = name.rsplit_once('.').unwrap_or(("", name));
        (layer.to_lowercase(), channel.to_lowercase())
    };
    let names: Vec<(String, String)> = names.iter().map(|name| split(name)).collect();
    // Channels of a layer lie side by side: they are sorted by their names.
    let groups = names.chunk_by(|a, b| a.0 == b.0);
    let mut start = 0;
    let mut found = Vec::new();
    for group in groups {
        let first = start;
        start += group.len();
        let called = |names: &[&str]| {
            let at = group
                .iter()
                .position(|(_, name)| names.contains(&name.as_str()));
            at.map(|at| first + at)
        };
        let colors = [["r", "red"], ["g", "green"], ["b", "blue"]].map(|names| called(&names));
        let luminance = called(&["y", "luminance"]).filter(|_| called(&["x"]).is_none());
        let alpha = called(&["a", "alpha"]);
        let (kind, layer) = if colors.iter().any(Option::is_some) {
            let layer = Layer {
                colors,
                alpha,
                ..Layer::default()
            };
            (0, layer)
        } else if let (Some(y), Some(ry), Some(by)) = (luminance, called(&["ry"]), called(&["by"]))
        {
            let layer = Layer {
                colors: [Some(ry), Some(y), Some(by)],
                is_chroma: true,
                alpha,
                ..Layer::default()
            };
            (0, layer)
        } else if luminance.is_some() {
            let layer = Layer {
                grey: luminance,
                alpha,
                ..Layer::default()
            };
            (1, layer)
        } else if group.len() == 1 {
            let layer = Layer {
                grey: Some(first),
                ..Layer::default()
            };
            (2, layer)
        } else {
            continue;
        };
        let name = group.first().map_or("", |(layer, _)| layer.as_str());
        let name = match name.rsplit('.').next() {
            Some("") | None => 0,
            Some("combined" | "beauty") => 1,
            Some(_) => 2,
        };
        found.push(([kind, name], Layer { header, ..layer }));
    }
    found
}

/// The picture while its blocks arrive.
pub(super) struct Pixels {
    layer: Layer,
    /// Columns and rows of the display window.
    size: (usize, usize),
    /// Where the data begin in it.
    offset: Vec2<i32>,
    /// 3, or 4 with alpha.
    channels: usize,
    values: Vec<f32>,
}

impl Pixels {
    pub fn new(layer: Layer, header: &Header) -> Self {
        let display = header.shared_attributes.display_window;
        let size = (display.size.width(), display.size.height());
        let channels = if layer.alpha.is_some() { 4 } else { 3 };
        Self {
            layer,
            size,
            offset: header.own_attributes.layer_position - display.position,
            channels,
            // What lies outside of the data is black, and transparent where there is alpha.
            values: vec![0.0; size.0 * size.1 * channels],
        }
    }

    /// `RY = (R - Y) / Y` and `BY = (B - Y) / Y` become red, green and blue, with the luminances of sRGB's primaries, which
    /// files have that say no others (OpenEXR, "Technical Introduction", "Luminance/Chroma Images").
    fn colors_from_chroma(&mut self) {
        let [to_red, to_green, to_blue] = [0.212_6, 0.715_2, 0.072_2];
        for pixel in self.values.chunks_exact_mut(self.channels) {
            if let [red, green, blue, ..] = pixel {
                let luminance = *green;
                *red = (*red + 1.0) * luminance;
                *blue = (*blue + 1.0) * luminance;
                *green = (luminance - to_red * *red - to_blue * *blue) / to_green;
            }
        }
    }

    /// Takes the lines of the chosen channels.
    fn take(&mut self, headers: &[Header], block: &UncompressedBlock) -> UnitResult {
        let header = headers.get(self.layer.header);
        let list = &header
            .ok_or(Error::Invalid("no such part".into()))?
            .channels;
        for line in block.lines(list) {
            let LineIndex {
                channel, position, ..
            } = line.location;
            if let Some(description) = list.list.get(channel) {
                self.put(channel, position, description, line.value);
            }
        }
        Ok(())
    }

    /// Takes a line of a channel that begins at such a pixel of the data, where the channel is one of the chosen.
    pub fn put(
        &mut self,
        channel: usize,
        at: Vec2<usize>,
        description: &ChannelDescription,
        line: &[u8],
    ) {
        let to = if self.layer.grey == Some(channel) {
            0..3
        } else if self.layer.alpha == Some(channel) {
            3..4
        } else if let Some(i) = self.layer.colors.iter().position(|c| *c == Some(channel)) {
            i..i + 1
        } else {
            return;
        };
        let Vec2(across, down) = description.sampling;
        for y in at.y()..at.y() + down {
            let Some(start) = self.start_of(Vec2(at.x(), y)) else {
                continue;
            };
            let (width, channels) = (self.size.0 as i64, self.channels);
            let values = &mut self.values;
            let mut put = |i: usize, value: f32| {
                for column in i * across..(i + 1) * across {
                    let x = start.0 + column as i64;
                    if (0..width).contains(&x) {
                        let texel = (start.1 + x as usize) * channels;
                        values[texel..][to.clone()].fill(value);
                    }
                }
            };
            let words = || line.as_chunks().0.iter().copied().enumerate();
            match description.sample_type {
                SampleType::F16 => {
                    let halves = line.as_chunks().0.iter().copied().enumerate();
                    halves.for_each(|(i, bytes)| put(i, f16::from_ne_bytes(bytes).to_f32()));
                }
                SampleType::F32 => words().for_each(|(i, bytes)| put(i, f32::from_ne_bytes(bytes))),
                SampleType::U32 => {
                    words().for_each(|(i, bytes)| put(i, u32::from_ne_bytes(bytes) as f32));
                }
            }
        }
    }

    /// The whole picture.
    pub fn decoded(mut self, name: &Path, is_half: bool) -> Result<Decoded, FileError> {
        if self.layer.is_chroma {
            self.colors_from_chroma();
        }
        let (width, height) = (self.size.0 as u32, self.size.1 as u32);
        let picture = if self.channels == 4 {
            ImageBuffer::from_raw(width, height, self.values).map(DynamicImage::ImageRgba32F)
        } else {
            ImageBuffer::from_raw(width, height, self.values).map(DynamicImage::ImageRgb32F)
        };
        let incomplete = || Problem::Malformed("holds fewer pixels than it says".into());
        Ok(Decoded {
            is_half,
            ..Decoded::from(picture.ok_or_else(|| FileError::new(name, incomplete()))?)
        })
    }

    /// The column where a line begins, and the index of its row's first pixel; `None` where that row is
    /// not shown.
    fn start_of(&self, at: Vec2<usize>) -> Option<(i64, usize)> {
        let x = at.x() as i64 + i64::from(self.offset.x());
        let y = usize::try_from(at.y() as i64 + i64::from(self.offset.y())).ok()?;
        (y < self.size.1).then(|| (x, y * self.size.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn best(names: &[&str]) -> Layer {
        let names: Vec<String> = names.iter().map(ToString::to_string).collect();
        let found = layers(0, &names).into_iter();
        found
            .min_by_key(|(rank, _)| *rank)
            .map(|(_, layer)| layer)
            .unwrap_or_default()
    }

    #[test]
    fn colours_come_before_brightness_and_that_before_a_single_channel_of_any_name() {
        let rgb = |r, g, b| [Some(r), Some(g), Some(b)];
        assert_eq!(best(&["A", "B", "G", "R", "Z"]).colors, rgb(3, 2, 1));
        assert_eq!(best(&["A", "B", "G", "R", "Z"]).alpha, Some(0));
        assert_eq!(best(&["b", "g", "r"]).colors, rgb(2, 1, 0));
        assert_eq!(best(&["blue", "green", "red"]).colors, rgb(2, 1, 0));
        assert_eq!(best(&["Y"]).grey, Some(0));
        assert_eq!(best(&["A", "Y"]).alpha, Some(0));
        assert_eq!(best(&["depth"]).grey, Some(0));
        assert_eq!(best(&["BY", "RY", "Y"]).colors, rgb(1, 2, 0));
        assert!(best(&["BY", "RY", "Y"]).is_chroma);
        assert_eq!(best(&["B.Y", "C.B", "C.G", "C.R"]).colors, rgb(3, 2, 1));
        assert_eq!(best(&["G", "R"]).colors, [Some(1), Some(0), None]);
    }

    #[test]
    fn the_layer_without_a_name_comes_first_then_the_combined_one_then_the_order() {
        let rgb = |first: usize| [Some(first + 2), Some(first + 1), Some(first)];
        let named = [
            "a.B",
            "a.G",
            "a.R",
            "View.Combined.B",
            "View.Combined.G",
            "View.Combined.R",
        ];
        assert_eq!(best(&named).colors, rgb(3));
        assert_eq!(best(&named[..3]).colors, rgb(0));
        let both = [
            "B",
            "G",
            "R",
            "View.Combined.B",
            "View.Combined.G",
            "View.Combined.R",
        ];
        assert_eq!(best(&both).colors, rgb(0));
    }

    #[test]
    fn a_vector_is_no_brightness() {
        assert_eq!(
            best(&["Normal.X", "Normal.Y", "Normal.Z"]),
            Layer::default()
        );
        let with_depth = best(&["Depth.Z", "Normal.X", "Normal.Y", "Normal.Z"]);
        assert_eq!(with_depth.grey, Some(0));
    }
}
