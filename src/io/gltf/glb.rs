//! The container: a header, the JSON, the bytes (glTF 2.0, section 4).

use super::super::error::Problem;
use serde_json::{Value, json};
use std::io::{self, Write};

/// The binary part while it grows, with the views and accessors that describe it.
#[derive(Default)]
pub(super) struct Bytes {
    data: Vec<u8>,
    pub views: Vec<Value>,
    pub accessors: Vec<Value>,
}

/// `componentType` of floats and of 32-bit indices.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
/// `target` of vertex attributes and of indices.
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

impl Bytes {
    /// Adds bytes as they are, for a picture. Returns the view.
    pub fn push(&mut self, bytes: &[u8]) -> usize {
        while !self.data.len().is_multiple_of(4) {
            self.data.push(0);
        }
        let view = json!({
            "buffer": 0,
            "byteOffset": self.data.len(),
            "byteLength": bytes.len(),
        });
        self.data.extend_from_slice(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    /// Adds vectors of floats. Returns the accessor.
    pub fn push_vectors<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let floats = values.as_flattened();
        let view = self.push_numbers(floats.iter().map(|value| value.to_le_bytes()), ARRAY_BUFFER);
        let mut least = [f32::INFINITY; N];
        let mut most = [f32::NEG_INFINITY; N];
        for value in values {
            for i in 0..N {
                least[i] = least[i].min(value[i]);
                most[i] = most[i].max(value[i]);
            }
        }
        self.accessors.push(json!({
            "bufferView": view,
            "componentType": FLOAT,
            "count": values.len(),
            "type": format!("VEC{N}"),
            "min": least.to_vec(),
            "max": most.to_vec(),
        }));
        self.accessors.len() - 1
    }

    /// Adds indices. Returns the accessor.
    pub fn push_indices(&mut self, indices: impl Iterator<Item = u32>) -> usize {
        let mut count = 0;
        let counted = indices.inspect(|_| count += 1);
        let view = self.push_numbers(counted.map(u32::to_le_bytes), ELEMENT_ARRAY_BUFFER);
        self.accessors.push(json!({
            "bufferView": view,
            "componentType": UNSIGNED_INT,
            "count": count,
            "type": "SCALAR",
        }));
        self.accessors.len() - 1
    }

    fn push_numbers(&mut self, numbers: impl Iterator<Item = [u8; 4]>, target: u32) -> usize {
        let view = self.push(&[]);
        let start = self.data.len();
        numbers.for_each(|number| self.data.extend_from_slice(&number));
        self.views[view]["byteLength"] = json!(self.data.len() - start);
        self.views[view]["target"] = json!(target);
        view
    }

    /// How many bytes there are.
    pub fn len(&self) -> usize {
        self.data.len()
    }

    /// Writes the file around them.
    pub fn write(mut self, root: &Value, out: &mut impl Write) -> io::Result<()> {
        let mut text = serde_json::to_vec(root)?;
        pad(&mut text, b' ');
        pad(&mut self.data, 0);
        let total = 12 + 8 + text.len() + 8 + self.data.len();
        out.write_all(b"glTF")?;
        for number in [2, size(total)?, size(text.len())?] {
            out.write_all(&number.to_le_bytes())?;
        }
        out.write_all(b"JSON")?;
        out.write_all(&text)?;
        out.write_all(&size(self.data.len())?.to_le_bytes())?;
        out.write_all(b"BIN\0")?;
        out.write_all(&self.data)
    }
}

/// What a file holds.
pub(super) struct Parts<'a> {
    pub json: &'a [u8],
    pub blob: Option<&'a [u8]>,
    /// Whether the lengths that it gives are those of what is there.
    pub fits: bool,
}

/// The JSON of a file and the bytes behind it. A file that is no container is JSON as a whole. Where lengths do not fit
/// the file, what is there is taken: whether that is enough is seen where it is used.
pub(super) fn parts(bytes: &[u8]) -> Result<Parts<'_>, Problem> {
    const HEADER: usize = 12;
    let Some((b"glTF", rest)) = bytes.split_at_checked(4) else {
        return Ok(Parts {
            json: bytes,
            blob: None,
            fits: true,
        });
    };
    let number = |bytes: &[u8], at: usize| {
        let bytes = bytes.get(at..)?.first_chunk()?;
        Some(u32::from_le_bytes(*bytes))
    };
    let (Some(version), Some(length)) = (number(rest, 0), number(rest, 4)) else {
        return Err(Problem::Truncated("the header is incomplete".into()));
    };
    if version == 1 {
        let text = "is glTF 1.0, and only 2.0 is read; export it again";
        return Err(Problem::Malformed(text.into()));
    }
    // A program that writes the length before it knows it may leave 0 there.
    let told = Some(length as usize).filter(|&length| length >= HEADER);
    let length = told.unwrap_or(bytes.len());
    let mut fits = told.is_some() && length <= bytes.len();
    let (mut json, mut blob) = (None, None);
    let mut rest = &bytes[HEADER..];
    while !rest.is_empty() {
        let is_behind = bytes.len() - rest.len() >= length;
        // Behind its end a file may hold anything; its bytes are looked for there where it has none before.
        if is_behind && (json.is_none() || blob.is_some()) {
            break;
        }
        let (Some(size), Some(kind)) = (number(rest, 0), rest.get(4..8)) else {
            if json.is_none() {
                let text = "the header of a part is incomplete";
                return Err(Problem::Truncated(text.into()));
            }
            fits &= is_behind;
            break;
        };
        if is_behind && kind != b"BIN\0" {
            break;
        }
        let there = rest.len() - 8;
        let is_cut = there < size as usize;
        if is_cut && kind == b"JSON" {
            let text = format!("{there} of a part's {size} bytes are there");
            return Err(Problem::Truncated(text));
        }
        let (part, after) = rest[8..].split_at(there.min(size as usize));
        fits &= !is_cut && bytes.len() - after.len() <= length;
        match kind {
            b"JSON" if json.is_none() => json = Some(part),
            b"BIN\0" if blob.is_none() => blob = Some(part),
            // Parts that later versions add are to be passed over.
            _ => {}
        }
        rest = after;
    }
    let json = json.ok_or_else(|| Problem::Malformed("it has no JSON part".into()))?;
    Ok(Parts { json, blob, fits })
}

fn pad(bytes: &mut Vec<u8>, with: u8) {
    bytes.resize(bytes.len().next_multiple_of(4), with);
}

fn size(bytes: usize) -> io::Result<u32> {
    u32::try_from(bytes).map_err(|_| io::Error::other("a GLB holds at most 4 GiB; split the scene"))
}
