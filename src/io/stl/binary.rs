//! A binary STL: 80 bytes of anything, a count, and as many facets of 50 bytes.

use super::super::error::{FileError, Place, Problem};
use super::facets::{Facet, Facets, More};
use super::{FACET, HEAD};
use bevy::color::Srgba;
use std::io::BufRead;

/// Reads the facets that are there, of a file of that many bytes.
pub(super) fn read_binary(
    facets: &mut Facets,
    mut reader: impl BufRead,
    size: u64,
) -> Result<(), FileError> {
    let file = facets.file;
    let reading = |error: std::io::Error| FileError::reading(file, &error);
    let mut head = [0; HEAD as usize];
    reader.read_exact(&mut head).map_err(reading)?;
    let (text, count) = head.split_at(80);
    let told = count
        .first_chunk()
        .map_or(0, |&count| u32::from_le_bytes(count));
    let whole = (size - HEAD) / FACET;
    let is_uncounted = told == 0 && whole > 0;
    let count = if is_uncounted {
        whole
    } else {
        whole.min(told.into())
    };
    let note = |facets: &mut Facets, what: &str, instead| {
        facets.notes.add(file, Place::Whole, what, instead);
    };
    if is_uncounted {
        note(
            facets,
            "a count of 0 facets",
            "as many as there are are shown",
        );
    } else if u64::from(told) > whole {
        let text = format!("it says that it has {told} facets and has {whole}");
        note(facets, &text, "those that are there are shown");
        facets
            .fault
            .get_or_insert_with(|| FileError::new(file, Problem::Truncated(text)));
    } else if HEAD + FACET * count < size {
        let what = format!("{} bytes behind its facets", size - HEAD - FACET * count);
        note(facets, &what, "left out");
    }
    let colors = Colors::of(text);
    facets.begin("")?;
    let mut bytes = [0; FACET as usize];
    let mut unread = 0_u64;
    for index in 0..count {
        reader.read_exact(&mut bytes).map_err(reading)?;
        let (numbers, attribute) = bytes.split_at(48);
        let float = |bytes: &[u8; 4]| f32::from_le_bytes(*bytes);
        let vector = |bytes: &[u8; 12]| {
            let [x, y, z] = [0, 4, 8].map(|at| bytes[at..].first_chunk().map_or(0.0, float));
            [x, y, z]
        };
        let (vectors, _) = numbers.as_chunks::<12>();
        let [normal, a, b, c] = [0, 1, 2, 3].map(|i| vectors.get(i).map_or([0.0; 3], vector));
        let attribute = attribute
            .first_chunk()
            .map_or(0, |&pair| u16::from_le_bytes(pair));
        let color = colors.of_facet(attribute);
        unread += u64::from(attribute != 0 && color.is_none());
        let facet = Facet {
            normal,
            corners: [a, b, c],
            more: color.map_or(More::Nothing, More::Color),
        };
        facets.push(facet, || Place::Part(format!("facet {index}")))?;
    }
    if unread > 0 {
        let what = "attributes of facets, which are no colours";
        note(facets, what, "left out");
    }
    Ok(())
}

/// Where a facet's two bytes hold its colour, of 5 bits a channel as screens take them. There is no standard, but two
/// habits: Materialise Magics writes the colour of the whole into the head and sets the highest bit where a facet has
/// none of its own; VisCAM and SolidView set it where a facet has one, and turn red and blue around.
enum Colors {
    Magics { whole: [f32; 3] },
    VisCam,
}

impl Colors {
    fn of(head: &[u8]) -> Self {
        const KEY: &[u8] = b"COLOR=";
        let key = head.windows(KEY.len()).position(|bytes| bytes == KEY);
        let color = key.and_then(|at| head[at + KEY.len()..].first_chunk());
        color.map_or(Self::VisCam, |&[r, g, b]: &[u8; 3]| Self::Magics {
            whole: [r, g, b].map(|value| linear(u16::from(value), 255)),
        })
    }

    fn of_facet(&self, attribute: u16) -> Option<[f32; 3]> {
        let channels = [0, 5, 10].map(|shift| linear(attribute >> shift & 31, 31));
        let is_marked = attribute & 0x8000 != 0;
        match self {
            Self::Magics { whole } if is_marked => Some(*whole),
            Self::Magics { .. } => Some(channels),
            Self::VisCam if is_marked => {
                let [b, g, r] = channels;
                Some([r, g, b])
            }
            Self::VisCam => None,
        }
    }
}

fn linear(value: u16, most: u16) -> f32 {
    Srgba::gamma_function(f32::from(value) / f32::from(most))
}
