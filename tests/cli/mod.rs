//! The program itself, run as people run it: exit codes, what is printed where, and which files
//! are there afterwards.

mod check;
mod failures;
mod own_files;
mod pictures;
#[cfg(unix)]
mod places;
#[cfg(unix)]
mod readme;
mod report;
mod statistics;
mod views;

use std::ffi::OsStr;
use std::path::Path;
use std::process::{Command, Output};

/// What `glassbox` is on this machine.
pub(crate) const PROGRAM: &str = env!("CARGO_BIN_EXE_glassbox");

/// A program that is started in a folder, by itself or to start Glassbox: there is no display, on which an editor would
/// open and stay, and settings are the folder's, not a person's.
pub(crate) fn without_display(program: impl AsRef<OsStr>, folder: &Path) -> Command {
    let mut command = Command::new(program);
    command
        .current_dir(folder)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env("GLASSBOX_CONFIG_DIR", folder.join("settings"));
    command
}

/// Runs the program in a folder.
pub(crate) fn glassbox(folder: &Path, arguments: &[&str]) -> Output {
    without_display(PROGRAM, folder)
        .args(arguments)
        .output()
        .expect("the program did not start")
}

/// Runs the program and expects it to succeed; what it printed.
pub(crate) fn succeeds(folder: &Path, arguments: &[&str]) -> String {
    let output = glassbox(folder, arguments);
    let (out, err) = texts(&output);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{arguments:?}\nstdout: {out}\nstderr: {err}"
    );
    out
}

pub(crate) fn texts(output: &Output) -> (String, String) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (text(&output.stdout), text(&output.stderr))
}

/// Names of the files in a folder, sorted.
pub(crate) fn files(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}
