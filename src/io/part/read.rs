use super::header::{ATTRIBUTE, Header};
use super::{Part, channel_name};
use crate::film::{Film, Sum};
use crate::io::error::{FileError, Problem};
use crate::io::limits::Limits;
use crate::io::{check_size, open_to_read};
use exr::meta::MetaData;
use exr::prelude::{
    AnyChannels, AttributeValue, FlatSamples, ReadChannels, ReadLayers, Text, read,
};
use glam::UVec2;
use std::fs;
use std::path::Path;

/// Reads a part. Whether it is one, and how large, is found out before anything is decoded.
pub fn read_part(path: &Path, limits: &Limits) -> Result<Part, FileError> {
    let malformed = |text: &str| FileError::new(path, Problem::Malformed(text.to_owned()));
    let no_part = || malformed(NO_PART);
    let meta = MetaData::read_from_buffered(open_to_read(path, limits.file_bytes)?, false)
        .map_err(|_| no_part())?;
    let header = meta.headers.first().ok_or_else(no_part)?;
    let Some(AttributeValue::Text(text)) = header
        .own_attributes
        .other
        .get(&Text::from(ATTRIBUTE))
        .or_else(|| header.shared_attributes.other.get(&Text::from(ATTRIBUTE)))
    else {
        return Err(no_part());
    };
    let Header {
        digest,
        samples,
        uniform,
        output,
    } = Header::parse(&text.to_string()).map_err(|text| malformed(&text))?;
    let (width, height) = (header.layer_size.x() as u64, header.layer_size.y() as u64);
    check_size(path, width, height, limits)?;
    let incomplete = || {
        let text = "the part is incomplete".to_owned();
        FileError::new(path, Problem::Truncated(text))
    };
    let length = fs::metadata(path)
        .map_err(|error| FileError::reading(path, &error))?
        .len();
    if length.saturating_mul(BEST_RATIO) < width * height * BYTES {
        return Err(incomplete());
    }
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(open_to_read(path, limits.file_bytes)?)
        .map_err(|_| incomplete())?;
    let sums = read_sums(&image.layer_data.channel_data).ok_or_else(incomplete)?;
    let count: u64 = samples.iter().map(|range| range.end - range.start).sum();
    let film = Film::of_sums(UVec2::new(width as u32, height as u32), &sums, count as u32)
        .ok_or_else(incomplete)?;
    Ok(Part {
        digest,
        samples,
        uniform,
        output,
        film,
    })
}

const NO_PART: &str =
    "is no part of a picture; `glassbox render --samples A..B -o part.exr` makes parts";
/// Of a pixel in memory: 15 channels of 4.
const BYTES: u64 = 60;
/// Run-length encoding makes 2 bytes of at most 128.
const BEST_RATIO: u64 = 64;

fn read_sums(channels: &AnyChannels<FlatSamples>) -> Option<Vec<Sum>> {
    let words = |component, word| {
        let name = channel_name(component, word);
        let channel = channels
            .list
            .iter()
            .find(|channel| channel.name.to_string() == name)?;
        match &channel.sample_data {
            FlatSamples::U32(words) => Some(words),
            _ => None,
        }
    };
    let mut all = Vec::with_capacity(12);
    for component in 0..3 {
        for word in 0..4 {
            all.push(words(component, word)?);
        }
    }
    let length = all.first()?.len();
    if all.iter().any(|words| words.len() != length) {
        return None;
    }
    let sum = |pixel| {
        Sum::from_words(std::array::from_fn(|component| {
            std::array::from_fn(|word| all[4 * component + word][pixel])
        }))
    };
    Some((0..length).map(sum).collect())
}
