//! Reading accessors, with every offset checked. Sparse ones too.

use super::super::error::Problem;
use super::document::Document;
use super::json::Json;

/// Values without bytes behind them, only claimed: sparse accessors may start from zeros. No file
/// that is meant has more of those than this.
const MOST_CLAIMED: usize = 1 << 24;

/// What a component is (glTF 2.0, 3.6.2.2).
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Kind {
    fn of(code: Option<usize>) -> Option<Self> {
        match code? {
            5120 => Some(Self::I8),
            5121 => Some(Self::U8),
            5122 => Some(Self::I16),
            5123 => Some(Self::U16),
            5125 => Some(Self::U32),
            5126 => Some(Self::F32),
            _ => None,
        }
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// What a number is multiplied by where it is marked as normalised.
    fn scale(self) -> f32 {
        match self {
            Self::F32 => 1.0,
            Self::I8 => 1.0 / 127.0,
            Self::U8 => 1.0 / 255.0,
            Self::I16 => 1.0 / 32_767.0,
            Self::U16 => 1.0 / 65_535.0,
            Self::U32 => 1.0 / u32::MAX as f32,
        }
    }
}

/// An accessor whose kind is known.
struct Accessor<'a> {
    json: Json<'a>,
    index: usize,
    kind: Kind,
    /// How many numbers a value has.
    width: usize,
    count: usize,
    /// Its integers are fractions of the largest.
    is_normalized: bool,
}

fn accessor(document: &Document, index: usize) -> Result<Accessor<'_>, Problem> {
    let malformed = |what: &str| Problem::Malformed(format!("accessor {index} {what}"));
    let json = document.json().element("accessors", index);
    let json = json.ok_or_else(|| malformed("is named and is not there"))?;
    let kind = Kind::of(json.index("componentType"));
    let width = match json.text("type") {
        Some("SCALAR") => Some(1),
        Some("VEC2") => Some(2),
        Some("VEC3") => Some(3),
        Some("VEC4") => Some(4),
        Some("MAT4") => Some(16),
        _ => None,
    };
    let kind = kind.ok_or_else(|| malformed("has no componentType that there is"))?;
    Ok(Accessor {
        json,
        index,
        kind,
        is_normalized: kind != Kind::F32 && json.is_true("normalized"),
        width: width.ok_or_else(|| malformed("has no type that can be used"))?,
        count: json
            .index("count")
            .ok_or_else(|| malformed("has no count"))?,
    })
}

impl Accessor<'_> {
    fn make_fractions(&mut self, document: &Document) {
        if self.kind != Kind::F32 && !self.is_normalized {
            let part = format!("accessors[{}]", self.index);
            let what = "integers that are to be fractions and are not `normalized`";
            document.note(&part, what, "read as if they were");
            self.is_normalized = true;
        }
    }

    fn wrong_type(&self) -> Problem {
        Problem::Malformed(format!(
            "accessor {} holds {} of {:?}, which does not fit its use",
            self.index,
            self.json.text("type").unwrap_or_default(),
            self.kind
        ))
    }
}

/// Vectors of `N` floats. Integers are taken as they are, or as fractions where they are marked as normalised.
pub(super) fn floats<const N: usize>(
    document: &Document,
    index: usize,
) -> Result<Vec<[f32; N]>, Problem> {
    let accessor = accessor(document, index)?;
    if accessor.width != N {
        return Err(accessor.wrong_type());
    }
    floats_of(document, &accessor)
}

/// The same of what integers can only be fractions of, whether they are marked so or not.
pub(super) fn fractions<const N: usize>(
    document: &Document,
    index: usize,
) -> Result<Vec<[f32; N]>, Problem> {
    let mut accessor = accessor(document, index)?;
    if accessor.width != N {
        return Err(accessor.wrong_type());
    }
    accessor.make_fractions(document);
    floats_of(document, &accessor)
}

/// Colours: three or four floats, the fourth 1 where there is none. Integers are fractions.
pub(super) fn colors(document: &Document, index: usize) -> Result<Vec<[f32; 4]>, Problem> {
    let mut accessor = accessor(document, index)?;
    accessor.make_fractions(document);
    match accessor.width {
        3 => {
            let colors = floats_of::<3>(document, &accessor)?;
            Ok(colors.iter().map(|&[r, g, b]| [r, g, b, 1.0]).collect())
        }
        4 => floats_of(document, &accessor),
        _ => Err(accessor.wrong_type()),
    }
}

fn floats_of<const N: usize>(
    document: &Document,
    accessor: &Accessor,
) -> Result<Vec<[f32; N]>, Problem> {
    let (kind, is_normalized) = (accessor.kind, accessor.is_normalized);
    let scale = if is_normalized { kind.scale() } else { 1.0 };
    let size = kind.size();
    elements(document, accessor, [0.0; N], |bytes| {
        std::array::from_fn(|i| {
            let value = number(kind, &bytes[i * size..]) as f32 * scale;
            // The two lowest integers both stand for -1.
            if is_normalized {
                value.max(-1.0)
            } else {
                value
            }
        })
    })
}

/// Indices of vertices.
pub(super) fn indices(document: &Document, index: usize) -> Result<Vec<u32>, Problem> {
    let accessor = accessor(document, index)?;
    let kind = accessor.kind;
    if accessor.width != 1 || !matches!(kind, Kind::U8 | Kind::U16 | Kind::U32) {
        return Err(accessor.wrong_type());
    }
    elements(document, &accessor, 0, |bytes| number(kind, bytes) as u32)
}

/// Four indices of joints for each vertex.
pub(super) fn joints(document: &Document, index: usize) -> Result<Vec<[u32; 4]>, Problem> {
    let accessor = accessor(document, index)?;
    let kind = accessor.kind;
    if accessor.width != 4 || kind == Kind::F32 {
        return Err(accessor.wrong_type());
    }
    let size = kind.size();
    elements(document, &accessor, [0; 4], |bytes| {
        std::array::from_fn(|i| number(kind, &bytes[i * size..]) as u32)
    })
}

/// The number at the start of `bytes`, which hold one. Every kind fits into `f64` exactly.
fn number(kind: Kind, bytes: &[u8]) -> f64 {
    match (kind, bytes) {
        (Kind::U8, &[a, ..]) => a.into(),
        (Kind::I8, &[a, ..]) => i8::from_le_bytes([a]).into(),
        (Kind::U16, &[a, b, ..]) => u16::from_le_bytes([a, b]).into(),
        (Kind::I16, &[a, b, ..]) => i16::from_le_bytes([a, b]).into(),
        (Kind::U32, &[a, b, c, d, ..]) => u32::from_le_bytes([a, b, c, d]).into(),
        (Kind::F32, &[a, b, c, d, ..]) => f32::from_le_bytes([a, b, c, d]).into(),
        _ => 0.0,
    }
}

fn elements<T: Copy>(
    document: &Document,
    accessor: &Accessor,
    zero: T,
    read: impl Fn(&[u8]) -> T,
) -> Result<Vec<T>, Problem> {
    let Accessor { json, count, .. } = *accessor;
    if count as u64 > document.limits.vertices.max(3 * document.limits.triangles) {
        return Err(Problem::TooMany {
            what: "values in an accessor",
            count: count as u64,
            limit: document.limits.vertices,
        });
    }
    let size = accessor.kind.size() * accessor.width;
    let offset = json.index("byteOffset").unwrap_or(0);
    let sparse = json.get("sparse");
    let pieces = match json.index("bufferView") {
        Some(view) => Some(strided(document, view, offset, count, size)?),
        None if sparse.is_none() => {
            let text = format!("accessor {} has no bytes", accessor.index);
            return Err(Problem::Malformed(text));
        }
        None if count > MOST_CLAIMED => {
            return Err(Problem::TooMany {
                what: "values that no bytes stand behind",
                count: count as u64,
                limit: MOST_CLAIMED as u64,
            });
        }
        None => None,
    };
    // Here, and again in the tracer.
    let bytes = 2 * count as u64 * size_of::<T>() as u64;
    document.limits.memory.claim(bytes)?;
    let mut values = match pieces {
        Some(pieces) => pieces.map(&read).collect(),
        None => vec![zero; count],
    };
    if let Some(sparse) = sparse {
        let malformed = || {
            let text = format!(
                "accessor {} is sparse and does not say where",
                accessor.index
            );
            Problem::Malformed(text)
        };
        let places = sparse.get("indices").ok_or_else(malformed)?;
        let kind = Kind::of(places.index("componentType")).ok_or_else(malformed)?;
        let number_of = sparse.index("count").ok_or_else(malformed)?;
        let part = |json: Json, size| {
            let view = json.index("bufferView").ok_or_else(malformed)?;
            let offset = json.index("byteOffset").unwrap_or(0);
            strided(document, view, offset, number_of, size)
        };
        let at = part(places, kind.size())?;
        let with = part(sparse.get("values").ok_or_else(malformed)?, size)?;
        for (at, with) in at.zip(with) {
            let index = number(kind, at);
            match values.get_mut(index as usize) {
                Some(value) => *value = read(with),
                None => {
                    let part = format!("accessors[{}].sparse", accessor.index);
                    let what = "a value in a place that there is not";
                    document.note(&part, what, "left out");
                }
            }
        }
    }
    Ok(values)
}

/// `count` pieces of `size` bytes of a buffer view.
fn strided(
    document: &Document,
    view: usize,
    offset: usize,
    count: usize,
    size: usize,
) -> Result<impl Iterator<Item = &[u8]>, Problem> {
    let part = document.view(view)?;
    let stride = part.stride.unwrap_or(size);
    let length = count
        .checked_sub(1)
        .and_then(|last| last.checked_mul(stride))
        .and_then(|start| start.checked_add(size));
    let bytes = length
        .and_then(|length| offset.checked_add(length))
        .and_then(|end| part.bytes.get(offset..end));
    let Some(bytes) = bytes.filter(|_| stride >= size && size > 0) else {
        return Err(Problem::Malformed(format!(
            "{count} values of {size} bytes are claimed, and buffer view {view} has {} bytes",
            part.bytes.len()
        )));
    };
    Ok((0..count).map(move |i| &bytes[i * stride..i * stride + size]))
}
