use super::says;
use crate::files::app::app;
use glassbox::io::{
    FileError, Notes, OpenOptions, PictureFormat, Problem, SceneSource, check_writable, open, save,
    write_picture,
};
use std::fs;
use std::path::Path;

fn saved(file: &Path) -> Result<Notes, FileError> {
    let mut app = app();
    let source = SceneSource::named("triangle");
    open(app.world_mut(), &source, OpenOptions::default()).unwrap();
    save(app.world_mut(), file)
}

#[test]
fn an_output_in_a_folder_that_does_not_exist() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.scn.ron", "a.obj", "a.glb"] {
        let error = saved(&folder.path().join("gone").join(name)).unwrap_err();
        says(&error, &[name, "folder does not exist"]);
    }
    let file = folder.path().join("gone/a.png");
    says(
        &write_picture(&file, 1, 1, &[[0.0; 3]]).unwrap_err(),
        &["a.png", "folder does not exist"],
    );
    says(
        &check_writable(&file).unwrap_err(),
        &["a.png", "folder does not exist"],
    );
}

#[test]
fn an_output_in_a_file_as_if_that_were_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), "x").unwrap();
    for place in ["file", "file/deeper/still"] {
        for name in ["a.scn.ron", "a.obj", "a.glb"] {
            let error = saved(&folder.path().join(place).join(name)).unwrap_err();
            says(&error, &[name, "file` is a file and no folder"]);
        }
        let error = check_writable(&folder.path().join(place).join("a.png")).unwrap_err();
        says(&error, &["a.png", "file` is a file and no folder"]);
    }
}

#[test]
fn an_output_that_is_written_as_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.png/");
    says(
        &check_writable(&file).unwrap_err(),
        &["a.png/", "is a folder; name a file in it"],
    );
    let error = write_picture(&file, 1, 1, &[[0.0; 3]]).unwrap_err();
    says(&error, &["a.png/", "is a folder"]);
    let nothing = fs::read_dir(folder.path()).unwrap().next();
    assert!(nothing.is_none(), "{nothing:?}");
}

#[test]
fn an_output_that_is_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.scn.ron");
    fs::create_dir(&file).unwrap();
    says(&saved(&file).unwrap_err(), &["a.scn.ron", "is a folder"]);
}

#[cfg(target_os = "linux")]
#[test]
fn an_output_where_nothing_may_be_written() {
    // Not even root may create files here.
    let file = Path::new("/proc/a.png");
    says(
        &check_writable(file).unwrap_err(),
        &["/proc/a.png", "cannot be written"],
    );
    says(
        &write_picture(file, 1, 1, &[[0.0; 3]]).unwrap_err(),
        &["/proc/a.png", "cannot be written"],
    );
    says(
        &saved(Path::new("/proc/a.glb")).unwrap_err(),
        &["/proc/a.glb", "cannot be written"],
    );
}

#[test]
fn an_output_with_an_unknown_extension() {
    let folder = tempfile::tempdir().unwrap();
    says(
        &saved(&folder.path().join("a.blend")).unwrap_err(),
        &["a.blend", "`blend`"],
    );
    let error = PictureFormat::of(Path::new("a.webp")).unwrap_err();
    says(&error, &["a.webp", "`webp`", ".png"]);
}

#[test]
fn a_picture_without_pixels() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.png");
    says(
        &write_picture(&file, 0, 0, &[]).unwrap_err(),
        &["a.png", "0x0", "at least 1"],
    );
    assert!(!file.exists());
}

#[test]
fn a_picture_of_2_to_the_31_pixels() {
    let file = Path::new("a.png");
    let error = write_picture(file, 1 << 16, 1 << 15, &[]).unwrap_err();
    says(&error, &["a.png", "65536x32768", "limit"]);
}

#[test]
fn a_picture_of_more_pixels_than_its_format_says() {
    let file = Path::new("a.jpg");
    for (width, height) in [(65_536, 1), (1, 65_536)] {
        let pixels = vec![[0.0; 3]; 65_536];
        let error = write_picture(file, width, height, &pixels).unwrap_err();
        says(&error, &["a.jpg", "65535 a side", ".png"]);
    }
    assert!(!file.exists());
}

#[test]
fn a_failed_save_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.png");
    fs::write(&file, "precious").unwrap();
    let error = write_picture(&file, 2, 2, &[[0.0; 3]]).unwrap_err();
    assert!(
        matches!(error.problem, Problem::PictureSize { given: 1, .. }),
        "{error}"
    );
    assert_eq!(fs::read_to_string(&file).unwrap(), "precious");
    let names: Vec<_> = fs::read_dir(folder.path())
        .unwrap()
        .map(|e| e.unwrap().file_name())
        .collect();
    assert_eq!(names, ["a.png"]);
}
