//! Reading accessors, with every offset checked. Sparse ones too.

use super::super::error::Problem;
use super::document::Document;
use gltf::accessor::{DataType, Dimensions, sparse::IndexType};

/// Values without bytes behind them, only claimed: sparse accessors may start from zeros. No file
/// that is meant has more of those than this.
const MOST_CLAIMED: usize = 1 << 24;

/// Vectors of `N` floats. Integers are taken where they are marked as normalised.
pub(super) fn floats<const N: usize>(
    document: &Document,
    accessor: &gltf::Accessor,
) -> Result<Vec<[f32; N]>, Problem> {
    let shape = match N {
        2 => Dimensions::Vec2,
        _ => Dimensions::Vec3,
    };
    let kind = accessor.data_type();
    let scale = match (kind, accessor.normalized()) {
        (DataType::F32, _) => 1.0,
        (DataType::U8, true) => 1.0 / 255.0,
        (DataType::U16, true) => 1.0 / 65_535.0,
        (DataType::I8, true) => 1.0 / 127.0,
        (DataType::I16, true) => 1.0 / 32_767.0,
        _ => return Err(wrong_type(accessor)),
    };
    if accessor.dimensions() != shape {
        return Err(wrong_type(accessor));
    }
    let size = kind.size();
    elements(document, accessor, [0.0; N], |bytes| {
        std::array::from_fn(|i| {
            let value = number(kind, &bytes[i * size..]) as f32 * scale;
            // The two lowest integers both stand for -1.
            if kind == DataType::F32 {
                value
            } else {
                value.max(-1.0)
            }
        })
    })
}

/// Indices of vertices.
pub(super) fn indices(document: &Document, accessor: &gltf::Accessor) -> Result<Vec<u32>, Problem> {
    let kind = accessor.data_type();
    let is_unsigned = matches!(kind, DataType::U8 | DataType::U16 | DataType::U32);
    if accessor.dimensions() != Dimensions::Scalar || !is_unsigned {
        return Err(wrong_type(accessor));
    }
    elements(document, accessor, 0, |bytes| number(kind, bytes) as u32)
}

fn wrong_type(accessor: &gltf::Accessor) -> Problem {
    Problem::Malformed(format!(
        "accessor {} holds {:?} of {:?}, which does not fit its use",
        accessor.index(),
        accessor.dimensions(),
        accessor.data_type()
    ))
}

/// The number at the start of `bytes`, which hold one. Every kind fits into `f64` exactly.
fn number(kind: DataType, bytes: &[u8]) -> f64 {
    match (kind, bytes) {
        (DataType::U8, &[a, ..]) => a.into(),
        (DataType::I8, &[a, ..]) => i8::from_le_bytes([a]).into(),
        (DataType::U16, &[a, b, ..]) => u16::from_le_bytes([a, b]).into(),
        (DataType::I16, &[a, b, ..]) => i16::from_le_bytes([a, b]).into(),
        (DataType::U32, &[a, b, c, d, ..]) => u32::from_le_bytes([a, b, c, d]).into(),
        (DataType::F32, &[a, b, c, d, ..]) => f32::from_le_bytes([a, b, c, d]).into(),
        _ => 0.0,
    }
}

fn elements<T: Copy>(
    document: &Document,
    accessor: &gltf::Accessor,
    zero: T,
    read: impl Fn(&[u8]) -> T,
) -> Result<Vec<T>, Problem> {
    let count = accessor.count();
    if count as u64 > document.limits.vertices.max(3 * document.limits.triangles) {
        return Err(Problem::TooMany {
            what: "values in an accessor",
            count: count as u64,
            limit: document.limits.vertices,
        });
    }
    let size = accessor.size();
    let pieces = match accessor.view() {
        Some(view) => Some(strided(document, &view, accessor.offset(), count, size)?),
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
    if let Some(sparse) = accessor.sparse() {
        let indices = sparse.indices();
        let kind = match indices.index_type() {
            IndexType::U8 => DataType::U8,
            IndexType::U16 => DataType::U16,
            IndexType::U32 => DataType::U32,
        };
        let number_of = sparse.count();
        let at = strided(
            document,
            &indices.view(),
            indices.offset(),
            number_of,
            kind.size(),
        )?;
        let sparse = sparse.values();
        let with = strided(document, &sparse.view(), sparse.offset(), number_of, size)?;
        for (at, with) in at.zip(with) {
            let index = number(kind, at);
            let Some(value) = values.get_mut(index as usize) else {
                return Err(Problem::IndexOutOfRange {
                    what: "sparse value",
                    index: index.to_string(),
                    count,
                });
            };
            *value = read(with);
        }
    }
    Ok(values)
}

/// `count` pieces of `size` bytes of a buffer view.
fn strided<'a>(
    document: &'a Document,
    view: &gltf::buffer::View,
    offset: usize,
    count: usize,
    size: usize,
) -> Result<impl Iterator<Item = &'a [u8]> + use<'a>, Problem> {
    let bytes = document.view(view)?;
    let stride = view.stride().unwrap_or(size);
    let length = count
        .checked_sub(1)
        .and_then(|last| last.checked_mul(stride))
        .and_then(|start| start.checked_add(size));
    let part = length
        .and_then(|length| offset.checked_add(length))
        .and_then(|end| bytes.get(offset..end));
    let Some(part) = part.filter(|_| stride >= size && size > 0) else {
        return Err(Problem::Truncated(format!(
            "{count} values of {size} bytes are claimed, and buffer view {} has {} bytes",
            view.index(),
            bytes.len()
        )));
    };
    Ok((0..count).map(move |i| &part[i * stride..i * stride + size]))
}
