//! OpenEXR pictures some of whose channels have fewer values than pixels: chroma, one value for two by two of them.
//!
//! The decoder refuses them when it reads the head. So it is given one that says that no channel is so, which leaves
//! where the blocks are, and each block with the sizes that it really has (OpenEXR, "OpenEXR File Layout", "Channel List",
//! "Scan Line Blocks").

use super::super::error::{FileError, Problem};
use super::exr_problem;
use super::open_exr::{Layer, Pixels, check_memory};
use super::read::Decoded;
use crate::io::Limits;
use exr::block::chunk::CompressedBlock;
use exr::compression::Compression;
use exr::error::Error;
use exr::meta::BlockDescription;
use exr::meta::attribute::{ChannelDescription, ChannelList, IntegerBounds, SampleType};
use exr::meta::header::Header;
use exr::prelude::Vec2;
use std::io::{Cursor, Read};
use std::ops::Range;
use std::path::Path;

/// Bytes before the first attribute, and the flag of a file with several parts.
const MARK: usize = 8;
const HAS_PARTS: u8 = 0x10;
/// More than any program writes.
const MOST_STEPS: usize = 64;

/// Decodes such a picture. `None` where it is not one, or has several parts.
pub(super) fn decode(
    name: &Path,
    reader: impl Read,
    limits: &Limits,
) -> Result<Option<Decoded>, FileError> {
    let fails = |problem| FileError::new(name, problem);
    let mut bytes = Vec::new();
    (reader.take(limits.file_bytes))
        .read_to_end(&mut bytes)
        .map_err(|error| FileError::reading(name, &error))?;
    let claimed = limits.memory.claim(bytes.len() as u64);
    claimed.map_err(fails)?;
    let Some(steps) = take_steps(&mut bytes) else {
        return Ok(None);
    };
    let fails = |error| FileError::new(name, exr_problem(error));
    let reader = exr::block::read(Cursor::new(bytes), false).map_err(fails)?;
    let layer = Layer::chosen(reader.headers()).map_err(|problem| FileError::new(name, problem))?;
    let header = reader.headers()[0].clone();
    check_memory(name, &header, limits)?;
    let blocks = Blocks::new(header, &steps).map_err(|problem| FileError::new(name, problem))?;
    let is_half = layer.is_half(&blocks.header);
    let mut pixels = Pixels::new(layer, &blocks.header);
    let chunks = reader.filter_chunks(false, |_, _, _| true).map_err(fails)?;
    for chunk in chunks {
        if let CompressedBlock::ScanLine(block) = chunk.map_err(fails)?.compressed_block {
            let (y, bytes) = (block.y_coordinate, block.compressed_pixels_le);
            blocks.take(y, bytes, &mut pixels).map_err(fails)?;
        }
    }
    pixels.decoded(name, is_half).map(Some)
}

/// Takes from a head how many pixels a value of each channel stands for, across and down, and leaves 1 there. `None` where
/// all are 1, or where the head is not of one part.
fn take_steps(file: &mut [u8]) -> Option<Vec<[usize; 2]>> {
    if file.get(5)? & HAS_PARTS != 0 {
        return None;
    }
    let mut at = MARK;
    loop {
        let (is_last, name) = text(file, &mut at)?;
        if is_last {
            return None;
        }
        let is_channels = &file[name] == b"channels";
        text(file, &mut at)?;
        let size = number(file, at)?;
        at += 4;
        if is_channels {
            break;
        }
        at = at.checked_add(size)?;
    }
    let mut steps = Vec::new();
    loop {
        let (is_last, _) = text(file, &mut at)?;
        if is_last {
            break;
        }
        // The kind of numbers, and how they are to be rounded.
        at += 8;
        steps.push([number(file, at)?, number(file, at + 4)?]);
        for axis in 0..2 {
            let one = 1_i32.to_le_bytes();
            file.get_mut(at + 4 * axis..)?
                .get_mut(..4)?
                .copy_from_slice(&one);
        }
        at += 8;
    }
    let is_subsampled = steps.iter().any(|step| *step != [1, 1]);
    is_subsampled.then_some(steps)
}

/// The place of a text that ends in 0, which is skipped; whether it is empty.
fn text(file: &[u8], at: &mut usize) -> Option<(bool, Range<usize>)> {
    let start = *at;
    let length = file.get(start..)?.iter().position(|byte| *byte == 0)?;
    *at = start + length + 1;
    Some((length == 0, start..start + length))
}

fn number(file: &[u8], at: usize) -> Option<usize> {
    let bytes = file.get(at..)?.first_chunk()?;
    usize::try_from(i32::from_le_bytes(*bytes)).ok()
}

/// The blocks of rows of such a picture.
struct Blocks {
    /// With the steps of its channels.
    header: Header,
}

impl Blocks {
    fn new(mut header: Header, steps: &[[usize; 2]]) -> Result<Self, Problem> {
        let malformed = |text: &str| Problem::Malformed(text.to_owned());
        if header.blocks != BlockDescription::ScanLines || header.deep {
            return Err(malformed(
                "has tiles, and channels of fewer values than pixels",
            ));
        }
        let position = header.own_attributes.layer_position;
        for (channel, &[across, down]) in header.channels.list.iter_mut().zip(steps) {
            let is_known = (1..=MOST_STEPS).contains(&across) && (1..=MOST_STEPS).contains(&down);
            let divides = is_known
                && header.layer_size.x().is_multiple_of(across)
                && header.layer_size.y().is_multiple_of(down)
                && position.x() % across as i32 == 0
                && position.y() % down as i32 == 0;
            if !divides {
                let text =
                    "has channels of fewer values than pixels, whose steps do not fit its size";
                return Err(malformed(text));
            }
            channel.sampling = Vec2(across, down);
        }
        Ok(Self { header })
    }

    /// How many values of a channel a row has.
    fn values(&self, channel: &ChannelDescription, y: usize) -> usize {
        let has_any = y.is_multiple_of(channel.sampling.y());
        usize::from(has_any) * (self.header.layer_size.x() / channel.sampling.x())
    }

    /// Decodes the block whose first row is at `y` in the space of the display window.
    fn take(&self, y: i32, bytes: Vec<u8>, pixels: &mut Pixels) -> Result<(), Error> {
        let header = &self.header;
        let first = y.checked_sub(header.own_attributes.layer_position.y());
        let first = first.and_then(|y| usize::try_from(y).ok());
        let first = first.filter(|y| *y < header.layer_size.y());
        let first = first.ok_or(Error::Invalid("a block that lies outside".into()))?;
        let most = header.compression.scan_lines_per_block();
        let rows = first..header.layer_size.y().min(first + most);
        let channels = &header.channels.list;
        let row_bytes = |y| -> usize {
            let of = |channel| self.values(channel, y) * channel.sample_type.bytes_per_sample();
            channels.iter().map(of).sum()
        };
        let size = rows.clone().map(row_bytes).sum();
        if size == 0 {
            return Ok(());
        }
        let bytes = self.decompressed(rows.clone(), size, bytes)?;
        let mut rest = &bytes[..];
        for y in rows {
            for (index, channel) in channels.iter().enumerate() {
                let length = self.values(channel, y) * channel.sample_type.bytes_per_sample();
                let Some((line, others)) = rest.split_at_checked(length) else {
                    return Err(Error::Invalid("a block with too few values".into()));
                };
                rest = others;
                pixels.put(index, Vec2(0, y), channel, line);
            }
        }
        Ok(())
    }

    fn decompressed(
        &self,
        rows: Range<usize>,
        size: usize,
        bytes: Vec<u8>,
    ) -> Result<Vec<u8>, Error> {
        let (header, section) = self.section(rows, size)?;
        let compression = header.compression;
        compression.decompress_image_section_from_le(&header, bytes, section, false)
    }

    /// Rows of so many bytes, and the head by which they are compressed.
    fn section(&self, rows: Range<usize>, size: usize) -> Result<(Header, IntegerBounds), Error> {
        use Compression as C;
        let mut header = self.header.clone();
        let section = match header.compression {
            // These know bytes alone: as good as any is one row of one channel of 16 bits.
            C::Uncompressed | C::RLE | C::ZIP1 | C::ZIP16 => {
                let like = ChannelDescription::named("Y", SampleType::F16);
                header.channels = ChannelList::new([like].into_iter().collect());
                header.layer_size = Vec2(size / 2, 1);
                header.layer_size
            }
            C::PIZ => {
                let section = Vec2(header.layer_size.x(), rows.len());
                let of = |channel: &ChannelDescription| {
                    let values = channel.subsampled_resolution(section).area();
                    values * channel.sample_type.bytes_per_sample()
                };
                let fits = header.channels.list.iter().map(of).sum::<usize>() == size;
                if !fits || !size.is_multiple_of(section.area()) {
                    let text = "blocks of rows that its channels do not divide";
                    return Err(Error::NotSupported(text.into()));
                }
                header.channels.bytes_per_pixel = size / section.area();
                section
            }
            other => {
                let text = format!("channels of fewer values than pixels, compressed as {other}");
                return Err(Error::NotSupported(text.into()));
            }
        };
        Ok((header, IntegerBounds::from_dimensions(section)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::open_exr;
    use super::*;
    use exr::prelude::f16;

    const SIZE: usize = 40;
    /// Left and right of the middle.
    const COLORS: [[f32; 3]; 2] = [[0.5, 0.25, 0.125], [0.125, 0.25, 0.5]];

    /// A picture of [`COLORS`] as luminance and a quarter of the chroma, and its head for the blocks.
    fn head(compression: u8) -> Vec<u8> {
        let mut bytes = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
        let mut attribute = |name: &str, kind: &str, value: &[u8]| {
            bytes.extend([name, "\0", kind, "\0"].concat().into_bytes());
            bytes.extend((value.len() as u32).to_le_bytes());
            bytes.extend(value);
        };
        let mut channels = Vec::new();
        for (name, step) in [("BY", 2_u8), ("RY", 2), ("Y", 1)] {
            channels.extend(format!("{name}\0").into_bytes());
            channels.extend([1, 0, 0, 0, 0, 0, 0, 0, step, 0, 0, 0, step, 0, 0, 0]);
        }
        channels.push(0);
        let most = SIZE as u8 - 1;
        let window = [0, 0, 0, 0, 0, 0, 0, 0, most, 0, 0, 0, most, 0, 0, 0];
        let one = 1.0_f32.to_le_bytes();
        attribute("channels", "chlist", &channels);
        attribute("compression", "compression", &[compression]);
        attribute("dataWindow", "box2i", &window);
        attribute("displayWindow", "box2i", &window);
        attribute("lineOrder", "lineOrder", &[0]);
        attribute("pixelAspectRatio", "float", &one);
        attribute("screenWindowCenter", "v2f", &[0; 8]);
        attribute("screenWindowWidth", "float", &one);
        bytes.push(0);
        bytes
    }

    fn row(y: usize) -> Vec<u8> {
        let chroma = |channel: usize| {
            (0..SIZE / 2).map(move |x| {
                let color = COLORS[2 * x / (SIZE / 2)];
                color[channel] / luminance(color) - 1.0
            })
        };
        let mut values: Vec<f32> = Vec::new();
        if y.is_multiple_of(2) {
            values.extend(chroma(2).chain(chroma(0)));
        }
        values.extend((0..SIZE).map(|x| luminance(COLORS[2 * x / SIZE])));
        let halves = values.into_iter().map(f16::from_f32);
        halves.flat_map(f16::to_le_bytes).collect()
    }

    fn luminance([red, green, blue]: [f32; 3]) -> f32 {
        0.2126 * red + 0.7152 * green + 0.0722 * blue
    }

    fn file(compression: u8) -> Vec<u8> {
        let mut bytes = head(compression);
        let mut told = bytes.clone();
        let steps = take_steps(&mut told).expect("steps of 2");
        told.extend(vec![0; 8 * SIZE]);
        let header = exr::block::read(Cursor::new(told), false).expect("a head");
        let blocks = Blocks::new(header.headers()[0].clone(), &steps).expect("steps that fit");
        let most = blocks.header.compression.scan_lines_per_block();
        let starts: Vec<usize> = (0..SIZE).step_by(most).collect();
        let mut data = Vec::new();
        let mut places = Vec::new();
        let first = bytes.len() + 8 * starts.len();
        for y in starts {
            let rows = y..SIZE.min(y + most);
            let raw: Vec<u8> = rows.clone().flat_map(row).collect();
            let (header, section) = blocks
                .section(rows, raw.len())
                .expect("a known compression");
            let compression = header.compression;
            let packed = compression.compress_image_section_to_le(&header, raw, section);
            let packed = packed.expect("numbers that can be compressed");
            places.extend(((first + data.len()) as u64).to_le_bytes());
            data.extend((y as i32).to_le_bytes());
            data.extend((packed.len() as i32).to_le_bytes());
            data.extend(packed);
        }
        bytes.extend(places);
        bytes.extend(data);
        bytes
    }

    fn decoded(bytes: &[u8]) -> Result<Decoded, String> {
        let name = Path::new("a.exr");
        let decoded = open_exr::decode(name, Cursor::new(bytes), &Limits::default());
        decoded.map_err(|error| error.to_string())
    }

    #[test]
    fn chroma_of_two_by_two_pixels_colours_them_all_however_it_is_compressed() {
        for (name, compression) in [("none", 0), ("RLE", 1), ("ZIPS", 2), ("ZIP", 3), ("PIZ", 4)] {
            let decoded = decoded(&file(compression)).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert!(decoded.is_half);
            let picture = decoded.pixels.into_rgb32f();
            assert_eq!(picture.dimensions(), (SIZE as u32, SIZE as u32));
            for (x, y, pixel) in picture.enumerate_pixels() {
                let expected = COLORS[2 * x as usize / SIZE];
                for (found, expected) in pixel.0.into_iter().zip(expected) {
                    // Half a unit of 10 bits, of a chroma up to 1.5, twice.
                    assert!(
                        (found - expected).abs() < 2e-3,
                        "{name}: {found} at {x}, {y}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_compression_or_steps_that_are_not_read_are_named() {
        let mut bytes = file(0);
        let at = bytes.windows(12).position(|w| w == b"compression\0");
        bytes[at.expect("that attribute") + 12 + 12 + 4] = 6;
        let told = decoded(&bytes).err().unwrap_or_default();
        assert!(
            told.contains("b44") && told.contains("fewer values"),
            "{told}"
        );
        let mut bytes = file(0);
        // The second channel's steps, behind its name, kind and rounding: at the first the decoder gives up.
        let at = bytes
            .windows(3)
            .position(|w| w == b"RY\0")
            .expect("that channel");
        bytes[at + 11] = 3;
        let told = decoded(&bytes).err().unwrap_or_default();
        assert!(told.contains("do not fit"), "{told}");
    }

    #[test]
    fn a_head_that_ends_anywhere_is_refused() {
        let whole = file(0);
        for length in 8..head(0).len() {
            assert!(decoded(&whole[..length]).is_err(), "{length} bytes");
        }
    }
}
