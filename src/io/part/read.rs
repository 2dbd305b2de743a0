use super::checksum::checksum;
use super::header::{ATTRIBUTE, Header};
use super::{Part, channel_name};
use crate::film::{Film, Sum};
use crate::io::error::{FileError, Problem};
use crate::io::limits::Limits;
use crate::io::picture::{block_bytes, exr_head, exr_problem, from_exr};
use crate::io::{check_size, open_to_read};
use exr::block::reader::ChunksReader;
use exr::meta::attribute::SampleType;
use exr::prelude::{AttributeValue, Text, Vec2};
use glam::UVec2;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

/// Reads a part. Whether it is one, and how large, is found out before anything is decoded.
pub fn read_part(path: &Path, limits: &Limits) -> Result<Part, FileError> {
    let fails = |problem| FileError::new(path, problem);
    let is_none = || Problem::Malformed(NO_PART.to_owned());
    let no_part = || fails(is_none());
    let meta = exr_head(path, limits, is_none)?;
    let header = meta.headers.first().ok_or_else(no_part)?;
    let Some(AttributeValue::Text(text)) = header
        .own_attributes
        .other
        .get(&Text::from(ATTRIBUTE))
        .or_else(|| header.shared_attributes.other.get(&Text::from(ATTRIBUTE)))
    else {
        return Err(no_part());
    };
    let malformed = |text: String| fails(Problem::Malformed(text));
    let (said, written) = Header::parse(&from_exr(text)).map_err(malformed)?;
    let (width, height) = (header.layer_size.x() as u64, header.layer_size.y() as u64);
    check_size(path, width, height, limits)?;
    let length = fs::metadata(path)
        .map_err(|error| FileError::reading(path, &error))?
        .len();
    if length.saturating_mul(BEST_RATIO) < width * height * BYTES {
        return Err(fails(incomplete()));
    }
    // A block of all channels, compressed and not.
    let block = block_bytes(header).saturating_mul(3);
    (limits.memory)
        .claim((width * height * PIXEL).saturating_add(block))
        .map_err(fails)?;
    let file = open_to_read(path, limits.file_bytes)?;
    let sums = read_sums(file, header).map_err(fails)?;
    let size = UVec2::new(width as u32, height as u32);
    let count: u64 = said
        .samples
        .iter()
        .map(|range| range.end - range.start)
        .sum();
    let is_whole = checksum(&said, size, sums.iter().copied()) == written;
    if !is_whole || !sums.iter().all(|sum| can_be_of(sum, count)) {
        return Err(malformed(DAMAGED.to_owned()));
    }
    let film = Film::of_sums(size, &sums, count as u32).ok_or_else(|| fails(incomplete()))?;
    let Header {
        digest,
        samples,
        uniform,
        output,
    } = said;
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
const DAMAGED: &str = "was damaged since it was written: its sums are not those that were; get a complete copy, or render it again";

/// Whether a sum can be that of so many samples, each at most 2^40, or 2^104 steps: others would not add up in 128 bits.
fn can_be_of(sum: &Sum, count: u64) -> bool {
    let most = (count << 8) as i64;
    (sum.to_words().iter()).all(|words| (-most..=most).contains(&i64::from(words[3] as i32)))
}

/// Of a pixel while it is read: words of 48 bytes become a sum of 48, and that one of 64 in the film.
const PIXEL: u64 = 120;
/// Of a pixel in the file's blocks: 15 channels of 4.
const BYTES: u64 = 60;
/// Run-length encoding makes 2 bytes of at most 128.
const BEST_RATIO: u64 = 64;

fn incomplete() -> Problem {
    Problem::Truncated("the part is incomplete".to_owned())
}

/// The sums of all pixels, row by row. Of other channels nothing is kept.
fn read_sums(
    file: BufReader<File>,
    header: &exr::meta::header::Header,
) -> Result<Vec<Sum>, Problem> {
    let channels = &header.channels;
    let mut places = vec![None; channels.list.len()];
    for component in 0..3 {
        for word in 0..4 {
            let name = channel_name(component, word);
            let mut names = channels.list.iter();
            let place = names.position(|channel| {
                channel.name.to_string() == name && channel.sample_type == SampleType::U32
            });
            let missing = || Problem::Malformed(format!("has no channel {name} of whole numbers"));
            places[place.ok_or_else(missing)?] = Some((component, word));
        }
    }
    let (width, height) = (header.layer_size.x(), header.layer_size.y());
    let mut words = vec![[[0_u32; 4]; 3]; width * height];
    let mut found = 0;
    let reader = exr::block::read(file, false).map_err(exr_problem)?;
    let chunks = reader.all_chunks(false).map_err(exr_problem)?;
    let taken = chunks.decompress_sequential(false, |_, block| {
        if block.index.layer != 0 || block.index.level != Vec2(0, 0) {
            return Ok(());
        }
        for line in block.lines(channels) {
            let (Some((component, word)), at) = (places[line.location.channel], line.location)
            else {
                continue;
            };
            let start = at.position.y() * width + at.position.x();
            let row = words.get_mut(start..start + at.sample_count);
            let row = row.filter(|_| at.position.x() + at.sample_count <= width);
            let row = row
                .ok_or_else(|| exr::error::Error::Invalid("a block outside the picture".into()))?;
            for (pixel, bytes) in row.iter_mut().zip(line.value.as_chunks().0) {
                pixel[component][word] = u32::from_ne_bytes(*bytes);
                found += 1;
            }
        }
        Ok(())
    });
    taken.map_err(exr_problem)?;
    match found == 12 * words.len() {
        true => Ok(words.into_iter().map(Sum::from_words).collect()),
        false => Err(incomplete()),
    }
}
