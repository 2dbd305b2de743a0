//! How much of an OpenEXR file is decoded at a time: blocks, with every channel that the file has.

use exr::meta::BlockDescription;
use exr::meta::header::Header;

/// Bytes of one block, decoded: of all channels, those too that nobody asks for.
pub(crate) fn block_bytes(header: &Header) -> u64 {
    let (width, height) = (header.layer_size.x() as u64, header.layer_size.y() as u64);
    let pixels = match header.blocks {
        BlockDescription::ScanLines => header.compression.scan_lines_per_block() as u64 * width,
        BlockDescription::Tiles(tiles) => {
            (tiles.tile_size.x() as u64).saturating_mul(tiles.tile_size.y() as u64)
        }
    };
    let pixels = pixels.min(width.saturating_mul(height));
    pixels.saturating_mul(header.channels.bytes_per_pixel as u64)
}
