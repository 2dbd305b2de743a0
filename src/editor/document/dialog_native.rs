//! The desktop's own file dialogs.

use super::question::Purpose;
use crate::io::{MODEL_EXTENSIONS, PICTURE_EXTENSIONS};
use rfd::FileDialog;
use std::env::{split_paths, var_os};
use std::path::{Path, PathBuf};

/// Whether a dialog can be expected to appear. On Linux it takes a desktop portal, which is reached
/// over the session's message bus, or the program `zenity`.
pub(super) fn is_available() -> bool {
    if !cfg!(target_os = "linux") {
        return true;
    }
    let has = |name: &str| var_os(name).is_some_and(|value| !value.is_empty());
    let display = has("DISPLAY") || has("WAYLAND_DISPLAY");
    let bus = has("DBUS_SESSION_BUS_ADDRESS")
        || var_os("XDG_RUNTIME_DIR").is_some_and(|folder| Path::new(&folder).join("bus").exists());
    let zenity = || {
        let paths = var_os("PATH").unwrap_or_default();
        split_paths(&paths).any(|folder| folder.join("zenity").is_file())
    };
    display && (bus || zenity())
}

/// Waits for a person. `None` where they chose nothing, or where no dialog appeared.
pub(super) fn choose(purpose: Purpose, start: &Path) -> Option<PathBuf> {
    let folder = start.parent().filter(|folder| folder.is_dir());
    let mut dialog = FileDialog::new();
    if let Some(folder) = folder {
        dialog = dialog.set_directory(folder);
    }
    match purpose {
        Purpose::Open => dialog
            .set_title("Open")
            .add_filter(
                "Scenes and models",
                &[&["ron"], &MODEL_EXTENSIONS[..]].concat(),
            )
            .pick_file(),
        Purpose::Import => dialog
            .set_title("Import")
            .add_filter("Models", &MODEL_EXTENSIONS)
            .pick_file(),
        Purpose::Picture => dialog
            .set_title("Picture")
            .add_filter("Pictures", &PICTURE_EXTENSIONS)
            .add_filter("All files", &["*"])
            .pick_file(),
        Purpose::SaveAs => {
            let name = start.file_name().unwrap_or_default().to_string_lossy();
            dialog
                .set_title("Save as")
                .set_file_name(name)
                .add_filter("Scene", &["scn.ron"])
                .add_filter("Wavefront OBJ", &["obj"])
                .add_filter("glTF, binary", &["glb"])
                .save_file()
        }
    }
}
