use super::{refused_with, says};
use crate::files::app::write;
use glassbox::io::{Limits, OpenOptions, check_size};
use std::path::Path;

#[test]
fn sizes_of_pictures_are_checked_in_64_bits() {
    let limits = Limits::default();
    let check = |width, height| check_size(Path::new("a.png"), width, height, &limits);
    assert!(check(1, 1).is_ok());
    assert!(check(16_384, 16_384).is_ok(), "2^28 pixels");
    assert!(check(65_536, 4_096).is_ok(), "2^28 pixels");
    for (width, height) in [
        (0, 1),
        (1, 0),
        (65_537, 1),
        (16_384, 16_385),
        (1 << 31, 1),
        (1 << 16, 1 << 16),
        (u64::MAX, u64::MAX),
    ] {
        assert!(
            check(width, height).is_err(),
            "{width}x{height} was allowed"
        );
    }
}

#[test]
fn more_entities_than_the_limit() {
    let folder = tempfile::tempdir().unwrap();
    let entity = |id| format!("{id}: (components: {{}}),");
    let text = format!(
        "(resources: {{\"glassbox::io::FileVersion\": (1)}}, entities: {{{}}})",
        (1..=3).map(entity).collect::<String>()
    );
    let file = write(folder.path(), "a.scn.ron", text);
    let mut options = OpenOptions::default();
    options.limits.entities = 2;
    says(
        &refused_with(&file, options),
        &["a.scn.ron", "3 entities", "limit is 2"],
    );
}
