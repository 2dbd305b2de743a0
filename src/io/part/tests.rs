use super::*;
use crate::io::Limits;
use glam::{UVec2, Vec3};
use std::fs;
use std::path::Path;

const SIZE: UVec2 = UVec2::new(37, 21);

/// A part with these samples; each sample has a value of its own.
fn part(samples: Range<u64>) -> Part {
    let sums: Vec<Sum> = (0..SIZE.element_product())
        .map(|pixel| {
            let mut sum = Sum::default();
            for index in samples.clone() {
                let value = (pixel as f32 - 300.0) * 1.37 + (index * index) as f32 * 1e-6;
                sum.add(Vec3::new(value, 1e9 * value, -1e-9 * value));
            }
            sum
        })
        .collect();
    let count = (samples.end - samples.start) as u32;
    Part {
        digest: "0123".into(),
        samples: vec![samples],
        uniform: true,
        output: "output.exposure=1.0".into(),
        film: Film::of_sums(SIZE, &sums, count).unwrap(),
    }
}

fn merged(parts: &[(&str, Part)]) -> Result<Part, MergeError> {
    let mut merge = Merge::default();
    for (file, part) in parts {
        merge.add(Path::new(file), part.clone())?;
    }
    merge.finish()
}

#[test]
fn a_part_comes_back_from_its_file_exactly_and_its_bytes_are_the_same_each_time() {
    let folder = tempfile::tempdir().unwrap();
    let (a, b) = (folder.path().join("a.exr"), folder.path().join("b.exr"));
    let written = part(3..11);
    write_part(&a, &written).unwrap();
    write_part(&b, &written).unwrap();
    assert_eq!(read_part(&a, &Limits::default()).unwrap(), written);
    assert_eq!(fs::read(&a).unwrap(), fs::read(&b).unwrap());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn parts_in_any_order_add_up_to_the_whole() {
    let whole = part(0..40);
    let parts = [("a", part(0..7)), ("b", part(7..32)), ("c", part(32..40))];
    for order in [[0, 1, 2], [2, 0, 1], [1, 2, 0]] {
        assert_eq!(merged(&order.map(|i| parts[i].clone())), Ok(whole.clone()));
    }
    let apart = merged(&[parts[2].clone(), parts[0].clone()]).unwrap();
    assert_eq!(apart.samples, [0..7, 32..40]);
    assert_eq!(merged(&parts[..1]), Ok(part(0..7)));
}

#[test]
fn parts_that_do_not_belong_together_are_refused_with_their_names() {
    let refused = |b: Part| {
        let parts = [
            ("a.exr", part(0..16)),
            ("c.exr", part(16..17)),
            ("b.exr", b),
        ];
        merged(&parts).unwrap_err().to_string()
    };
    let text = refused(Part {
        digest: "9".into(),
        ..part(17..32)
    });
    assert!(
        text.starts_with("b.exr: ") && text.contains("another scene") && text.contains("a.exr")
    );
    let text = refused(Part {
        uniform: false,
        ..part(16..32)
    });
    assert!(text.starts_with("b.exr: was sampled adaptively"), "{text}");
    let text = refused(part(12..20));
    assert!(
        text.contains("samples 12..16") && text.contains("a.exr"),
        "{text}"
    );
    assert_eq!(merged(&[]), Err(MergeError::Nothing));
}

#[test]
fn a_part_with_one_changed_byte_is_never_read_as_another() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let written = part(3..11);
    write_part(&path, &written).unwrap();
    let bytes = fs::read(&path).unwrap();
    let mut refused = 0;
    // Of the head every byte, of the sums some.
    for at in (0..1500).chain((1500..bytes.len()).step_by(61)) {
        let mut changed = bytes.clone();
        changed[at] ^= 0x10;
        fs::write(&path, &changed).unwrap();
        match read_part(&path, &Limits::default()) {
            // What is not of the part: the means that other programs show, and what else the format says.
            Ok(read) => assert_eq!(read, written, "byte {at}"),
            Err(error) => refused += usize::from(error.to_string().contains("damaged since")),
        }
    }
    assert!(refused > 100, "{refused}");
}

#[test]
fn sums_that_no_samples_have_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    for (word, is_refused) in [
        (8 << 8, false),
        ((8 << 8) + 1, true),
        (i32::MAX, true),
        (-(9 << 8), true),
    ] {
        let sum = Sum::from_words([[0, 0, 0, word as u32]; 3]);
        let sums = vec![sum; SIZE.element_product() as usize];
        let film = Film::of_sums(SIZE, &sums, 8).unwrap();
        write_part(
            &path,
            &Part {
                film,
                ..part(3..11)
            },
        )
        .unwrap();
        let read = read_part(&path, &Limits::default());
        assert_eq!(read.is_err(), is_refused, "{word}");
    }
}

#[test]
fn what_is_no_part_or_damaged_is_refused_with_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str| {
        let path = folder.path().join(name);
        read_part(&path, &Limits::default())
            .unwrap_err()
            .to_string()
    };
    assert!(read("none.exr").contains("no such file"));
    fs::write(folder.path().join("text.exr"), "hello").unwrap();
    assert!(read("text.exr").contains("no part"), "{}", read("text.exr"));
    let picture = folder.path().join("picture.exr");
    crate::io::write_picture(&picture, 2, 1, &[[1.0; 3]; 2]).unwrap();
    assert!(read("picture.exr").contains("no part"));
    let whole = folder.path().join("whole.exr");
    write_part(&whole, &part(0..2)).unwrap();
    let bytes = fs::read(&whole).unwrap();
    for length in [0, 1, 8, 100, 400, 1000, bytes.len() / 2, bytes.len() - 1] {
        fs::write(folder.path().join("cut.exr"), &bytes[..length]).unwrap();
        let text = read("cut.exr");
        assert!(
            text.contains("cut.exr") && text.lines().count() == 1,
            "{length} bytes: {text}"
        );
        let is_cut = text.contains("ends too early");
        assert_eq!(is_cut, length >= 8, "{length} bytes: {text}");
    }
    let mut damaged = bytes.clone();
    let end = damaged.len();
    damaged[end - 24..].fill(0x80);
    fs::write(folder.path().join("damaged.exr"), damaged).unwrap();
    let text = read("damaged.exr");
    assert!(text.contains("not a picture that can be decoded"), "{text}");
    // A header that promises more than the file can hold asks for no memory.
    let small = Limits {
        pixels: 100,
        ..Limits::default()
    };
    let text = read_part(&whole, &small).unwrap_err().to_string();
    assert!(text.contains("37x21") && text.contains("100"), "{text}");
}
