//! A render that is killed leaves no broken file.

use crate::cli::{PROGRAM, files, succeeds, without_display};
use std::path::Path;
use std::process::Stdio;
use std::thread;
use std::time::Duration;

fn whole(folder: &Path, file: &str) -> bool {
    image::open(folder.join(file)).is_ok_and(|picture| picture.width() == 64)
}

#[test]
fn a_killed_render_leaves_the_old_file_or_the_new_one_and_never_half_of_one() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let what = [
        "render", "teapot", "--size", "64x64", "--quiet", "-o", "a.png",
    ];
    succeeds(folder, &[&what[..], &["--spp", "1"]].concat());
    // From before it begins to long after, so that some are hit while they write.
    for milliseconds in [0, 5, 20, 40, 60, 80, 100, 150, 250, 400] {
        let mut child = without_display(PROGRAM, folder)
            .args([&what[..], &["--spp", "20"]].concat())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        thread::sleep(Duration::from_millis(milliseconds));
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(whole(folder, "a.png"), "broken after {milliseconds} ms");
        // What a killed process could not tidy up bears a name that no picture has.
        for file in files(folder) {
            let named = file == "a.png" || (file.starts_with(".a.png.") && file.ends_with(".part"));
            assert!(named, "{file} after {milliseconds} ms");
        }
    }
    let what = [
        "render", "teapot", "--size", "64x64", "--quiet", "-o", "b.exr",
    ];
    for milliseconds in [50, 150] {
        // More samples than any machine takes in that time.
        let mut child = without_display(PROGRAM, folder)
            .args([&what[..], &["--samples", "0..1000000"]].concat())
            .spawn()
            .unwrap();
        thread::sleep(Duration::from_millis(milliseconds));
        assert_eq!(child.try_wait().unwrap(), None, "it has ended by itself");
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(
            !folder.join("b.exr").exists(),
            "a part after {milliseconds} ms"
        );
    }
}
