use super::opens_and_says;
use crate::files::app::write;
use std::path::PathBuf;
use tempfile::TempDir;

/// A folder with an OBJ whose material has this picture.
fn textured(name: &str, bytes: &[u8]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), name, bytes);
    write(folder.path(), "a.mtl", format!("newmtl a\nmap_Kd {name}\n"));
    let text = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
    let file = write(folder.path(), "a.obj", text);
    (folder, file)
}

/// A PNG's signature and header for a picture of this size, and nothing after it.
fn png_header(width: u32, height: u32) -> Vec<u8> {
    let mut header = b"IHDR".to_vec();
    header.extend(width.to_be_bytes());
    header.extend(height.to_be_bytes());
    header.extend([8, 2, 0, 0, 0]);
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\r".to_vec();
    bytes.extend(&header);
    bytes.extend(crc32(&header).to_be_bytes());
    // The reader looks for the next chunk before it says how large the picture is.
    bytes.extend([0, 0, 0, 0]);
    bytes.extend(b"IDAT");
    bytes.extend(crc32(b"IDAT").to_be_bytes());
    bytes
}

fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            crc >> 1 ^ (0xedb8_8320 & (crc & 1).wrapping_neg())
        })
    })
}

#[test]
fn a_picture_that_claims_2_to_the_31_pixels() {
    let (_folder, file) = textured("a.png", &png_header(1 << 16, 1 << 15));
    assert_eq!(
        opens_and_says(&file, &["a.png", "65536x32768", "scale the picture down"]),
        1
    );
    let (_folder, file) = textured("a.png", &png_header(0x7fff_ffff, 1));
    assert_eq!(
        opens_and_says(&file, &["a.png", "scale the picture down"]),
        1
    );
}

#[test]
fn a_radiance_picture_that_claims_2_to_the_31_pixels() {
    let head = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 32768 +X 65536\n";
    let (_folder, file) = textured("a.hdr", head);
    assert_eq!(opens_and_says(&file, &["a.hdr", "65536x32768", "limit"]), 1);
}

#[test]
fn a_picture_of_any_kind_that_claims_more_pixels_than_the_limit() {
    let mut tga = [0_u8; 18];
    (tga[2], tga[16]) = (2, 24);
    tga[12..16].fill(0xff);
    let mut bmp = b"BM".to_vec();
    bmp.extend(
        [0_u32, 0, 54, 40, 65_500, 65_500]
            .map(u32::to_le_bytes)
            .as_flattened(),
    );
    bmp.extend([1, 0, 24, 0]);
    bmp.extend([0; 24]);
    let gif = b"GIF89a\xff\xff\xff\xff\x80\0\0\0\0\0\xff\xff\xff,\0\0\0\0\xff\xff\xff\xff\0\x02";
    for (kind, bytes) in [("TGA", &tga[..]), ("BMP", &bmp), ("GIF", gif)] {
        let (_folder, file) = textured("a.png", bytes);
        let note = ["a.png", "scale the picture down", "x65"];
        assert_eq!(opens_and_says(&file, &note), 1, "{kind}");
    }
}

#[test]
fn an_open_exr_that_claims_more_pixels_or_channels_than_the_limit() {
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("a.exr");
    glassbox::io::write_picture(&whole, 4, 4, &[[0.5; 3]; 16]).unwrap();
    let bytes = std::fs::read(&whole).unwrap();
    for window in ["dataWindow\0box2i\0", "displayWindow\0box2i\0"] {
        let mut bytes = bytes.clone();
        let at = (bytes.windows(window.len())).position(|part| part == window.as_bytes());
        let corner = at.unwrap() + window.len() + 4 + 8;
        for coordinate in bytes[corner..corner + 8].as_chunks_mut().0 {
            *coordinate = 0x0fff_ffff_i32.to_le_bytes();
        }
        let (_folder, file) = textured("a.exr", &bytes);
        assert_eq!(opens_and_says(&file, &["a.exr"]), 1, "{window}");
    }
}

#[test]
fn something_that_is_no_picture_or_of_a_kind_that_is_not_read() {
    let (_folder, file) = textured("a.png", b"solid cube\n facet normal 0 0 1\n");
    assert_eq!(opens_and_says(&file, &["a.png", "WebP", "OpenEXR"]), 1);
    let (_folder, file) = textured("a.png", b"II*\0 and so on");
    assert_eq!(opens_and_says(&file, &["a.png", ".tiff"]), 1);
}

#[test]
fn a_picture_that_ends_too_early() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.png", "a.jpg", "a.exr", "a.hdr"] {
        let whole = folder.path().join(name);
        let pixels: Vec<_> = (0..4096).map(|i| [(i % 64) as f32 / 64.0; 3]).collect();
        glassbox::io::write_picture(&whole, 64, 64, &pixels).unwrap();
        let bytes = std::fs::read(&whole).unwrap();
        // A JPEG may lose its last rows without a word; not its head.
        let half = if name == "a.jpg" {
            100
        } else {
            bytes.len() / 2
        };
        let (_folder, file) = textured(name, &bytes[..half]);
        assert_eq!(opens_and_says(&file, &[name]), 1);
    }
}

#[test]
fn a_picture_with_another_ones_extension() {
    let (_folder, file) = textured("a.exr", b"\x89PNG\r\n\x1a\n");
    assert_eq!(opens_and_says(&file, &["a.exr"]), 1);
}

#[test]
fn an_empty_picture() {
    let (_folder, file) = textured("a.png", b"");
    assert_eq!(opens_and_says(&file, &["a.png"]), 1);
}

#[test]
fn half_a_jpeg_is_shown_and_said_to_be_half() {
    let picture = image::RgbImage::from_fn(256, 256, |x, y| {
        image::Rgb([(7 * x) as u8, (13 * y) as u8, (x * y) as u8])
    });
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture
        .write_to(&mut bytes, image::ImageFormat::Jpeg)
        .unwrap();
    let bytes = bytes.into_inner();
    for (part, notes) in [(&bytes[..], 0), (&bytes[..bytes.len() / 2], 1)] {
        let (_folder, file) = textured("a.jpg", part);
        let (_, opened) = crate::files::app::opened(&file);
        let mut told = opened.notes.lines();
        told.retain(|note| note.contains("a.jpg"));
        assert_eq!(told.len(), notes, "{:?}", opened.notes);
        assert!(told.iter().all(|note| note.contains("cut off")), "{told:?}");
    }
}
