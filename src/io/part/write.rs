use super::checksum::checksum;
use super::header::{ATTRIBUTE, Header};
use super::{Part, channel_name, sums};
use crate::io::check_size;
use crate::io::error::FileError;
use crate::io::limits::Limits;
use crate::io::picture::to_exr;
use crate::io::replace::replace_file;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, FlatSamples, Image,
    Layer, LayerAttributes, LineOrder, SmallVec, Text, WritableImage,
};
use std::io;
use std::path::Path;

/// Writes a part. The file appears complete or not at all; the same part gives the same bytes.
pub fn write_part(path: &Path, part: &Part) -> Result<(), FileError> {
    let size = part.film.size();
    check_size(path, size.x.into(), size.y.into(), &Limits::default())?;
    let picture = part.film.picture();
    let mut channels = SmallVec::new();
    for (component, name) in ["R", "G", "B"].into_iter().enumerate() {
        let values = picture
            .pixels
            .iter()
            .map(|pixel| pixel[component])
            .collect();
        channels.push(AnyChannel::new(name, FlatSamples::F32(values)));
        for word in 0..4 {
            let values = sums(&part.film)
                .map(|sum| sum.to_words()[component][word])
                .collect();
            let name = channel_name(component, word);
            channels.push(AnyChannel::new(
                Text::from(name.as_str()),
                FlatSamples::U32(values),
            ));
        }
    }
    let mut attributes = LayerAttributes::default();
    let header = Header::of(part);
    let checksum = checksum(&header, size, sums(&part.film));
    let header = to_exr(&header.with_checksum(checksum));
    attributes
        .other
        .insert(Text::from(ATTRIBUTE), AttributeValue::Text(header));
    // The words' high bytes repeat, and the low ones are noise that nothing compresses.
    let encoding = Encoding {
        compression: Compression::RLE,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let layer = Layer::new(
        (size.x as usize, size.y as usize),
        attributes,
        encoding,
        AnyChannels::sort(channels),
    );
    let image = Image::from_layer(layer);
    replace_file(path, |writer| {
        let written = image.write().non_parallel().to_buffered(writer);
        written.map_err(|error| match error {
            exr::error::Error::Io(error) => error,
            other => io::Error::other(other.to_string()),
        })
    })
}
