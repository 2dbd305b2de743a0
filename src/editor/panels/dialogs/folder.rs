//! What lies in a folder, to be taken by a click, and the way out of it.

use super::super::says::Says;
use super::path::split;
use crate::editor::document::Purpose;
use crate::editor::texts::{path_of, path_text};
use crate::io::{MODEL_EXTENSIONS, PICTURE_EXTENSIONS, extension};
use bevy_egui::egui::{Button, ScrollArea, Ui};
use std::fs;
use std::path::{MAIN_SEPARATOR, Path, PathBuf};

/// Files and folders of one folder that are looked at.
const MOST: usize = 2000;

/// Folders, and those files that the purpose is about. Empty where it cannot be read: then typing goes on alone.
pub(super) fn names_in((folder, purpose): (PathBuf, Purpose)) -> Vec<String> {
    let folder = match folder.as_os_str().is_empty() {
        true => Path::new("."),
        false => &folder,
    };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let (mut folders, mut files) = (Vec::new(), Vec::new());
    for entry in entries.take(MOST) {
        // A name that is no text cannot be typed.
        let Ok(name) = entry.file_name().into_string() else {
            continue;
        };
        // Through links, as what is opened is.
        let is_folder = fs::metadata(entry.path()).is_ok_and(|data| data.is_dir());
        if is_folder {
            folders.push(name + "/");
        } else if is_meant(&name, purpose) {
            files.push(name);
        }
    }
    folders.sort();
    files.sort();
    folders.into_iter().chain(files).collect()
}

fn is_meant(name: &str, purpose: Purpose) -> bool {
    let extension = extension(Path::new(name));
    let extension = extension.as_str();
    match purpose {
        Purpose::Picture => PICTURE_EXTENSIONS.contains(&extension),
        Purpose::Import => MODEL_EXTENSIONS.contains(&extension),
        Purpose::Open | Purpose::SaveAs => {
            extension == "scn.ron" || MODEL_EXTENSIONS.contains(&extension)
        }
    }
}

/// What was taken of what lies in the folder.
pub(super) enum Taken {
    /// The folder that it lies in.
    Above,
    Name(String),
}

/// What lies in the folder, below the way out of it; `missing` is said where nothing does.
pub(super) fn list_ui(
    ui: &mut Ui,
    has_above: bool,
    names: &[String],
    missing: Option<&str>,
) -> Option<Taken> {
    let mut taken = None;
    let above = usize::from(has_above);
    let said = usize::from(names.is_empty() && missing.is_some());
    // As high however little is in it: the field stays where it is while a path is typed.
    ScrollArea::vertical()
        .max_height(180.0)
        .auto_shrink(false)
        .show_rows(
            ui,
            ui.spacing().interact_size.y,
            above + names.len() + said,
            |ui, rows| {
                for row in rows {
                    let name = row.checked_sub(above).map(|i| names.get(i));
                    let (name, says) = match name {
                        None => ("../", "Looks into the folder that this one lies in"),
                        Some(None) => {
                            ui.weak(missing.unwrap_or_default());
                            continue;
                        }
                        Some(Some(name)) if name.ends_with('/') => {
                            (name.as_str(), "Looks into this folder")
                        }
                        Some(Some(name)) => (name.as_str(), "Takes this file"),
                    };
                    let button = Button::selectable(false, name);
                    if ui.add(button).says(says).clicked() {
                        taken = Some(match row < above {
                            true => Taken::Above,
                            false => Taken::Name(name.to_owned()),
                        });
                    }
                }
            },
        );
    taken
}

/// The folder that the folder of a path lies in, as it is typed; `None` for the root.
pub(super) fn above(text: &str) -> Option<String> {
    let (folder, _) = split(text);
    let folder = match folder.is_empty() {
        true => PathBuf::from("."),
        false => path_of(folder),
    };
    let here = path_text(&folder);
    let above = path_text(&folder.join(".."));
    let ends = |text: &str| text.ends_with(['/', MAIN_SEPARATOR]);
    (above != here).then(|| match ends(&above) {
        true => above,
        false => format!("{above}/"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_every_folder_but_the_root_a_row_leads_out_of_it() {
        for (text, out) in [
            ("/a/b/room", Some("/a/")),
            ("/a/b/", Some("/a/")),
            ("/a/b/../c.obj", Some("/")),
            ("/a", None),
            ("/", None),
        ] {
            assert_eq!(above(text).as_deref(), out, "{text}");
        }
        let working = std::env::current_dir().unwrap();
        let out = path_of(&above("").unwrap());
        assert_eq!(Some(out.as_path()), working.parent());
    }
}
