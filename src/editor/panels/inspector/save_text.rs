//! Saving a table: as Markdown or as comma-separated values, by the file's name.

use super::super::says::Says;
use crate::editor::notice::Notices;
use crate::editor::texts::path_text;
use crate::io::{check_not_read, replace_file};
use bevy::ecs::world::World;
use bevy_egui::egui::{Button, Key, TextEdit, Ui};
use std::io::Write;
use std::path::{Path, PathBuf};

/// What is entered.
#[derive(Default)]
pub(super) struct SaveText {
    path: Option<String>,
    /// Written by this panel, or meant to be replaced.
    known: Option<PathBuf>,
    refused: Option<String>,
}

/// What a file's name asks for.
fn is_csv(path: &Path) -> Result<bool, String> {
    let extension = path.extension().map(|e| e.to_ascii_lowercase());
    match extension.as_deref().and_then(|e| e.to_str()) {
        Some("csv") => Ok(true),
        Some("md") => Ok(false),
        _ => Err(format!(
            "{}: call it .md for Markdown or .csv for a spreadsheet",
            path.display()
        )),
    }
}

/// A path and a button; `text` is asked for what to write, as CSV or as Markdown.
pub(super) fn save_text_ui(
    ui: &mut Ui,
    world: &mut World,
    form: &mut SaveText,
    suggestion: &str,
    text: impl Fn(bool) -> String,
) {
    let path = form.path.get_or_insert_with(|| suggestion.to_owned());
    ui.add_space(4.0);
    let mut wanted = false;
    let file = PathBuf::from(path.trim());
    let replaces = form.known.as_deref() != Some(&file) && file.is_file();
    ui.horizontal(|ui| {
        let name = if replaces { "Replace" } else { "Save" };
        let width = (ui.available_width() - 76.0).max(60.0);
        let field = ui.add(TextEdit::singleline(path).desired_width(width));
        let field = field.says(
            "Where this table is written: .md for Markdown, .csv for a spreadsheet; relative paths begin in the working folder",
        );
        wanted = field.lost_focus() && !replaces && ui.input(|input| input.key_pressed(Key::Enter));
        let says = match replaces {
            true => "The file is there already: it is replaced by this table",
            false => "Writes this table",
        };
        let button = ui.add_enabled(!file.as_os_str().is_empty(), Button::new(name));
        wanted |= button.says(says).clicked();
    });
    if let Some(refused) = &form.refused {
        ui.colored_label(ui.visuals().error_fg_color, refused);
    }
    if !wanted || file.as_os_str().is_empty() {
        return;
    }
    let written = is_csv(&file).and_then(|is_csv| {
        let text = text(is_csv);
        check_not_read(world, &file)
            .and_then(|()| replace_file(&file, |out| out.write_all(text.as_bytes())))
            .map_err(|why| why.to_string())
    });
    form.refused = written.as_ref().err().cloned();
    if written.is_ok() {
        let text = format!("Wrote {}", path_text(&file));
        world.resource_mut::<Notices>().tell(text);
        form.known = Some(file);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_says_what_is_written_and_any_other_is_refused() {
        assert_eq!(is_csv(Path::new("a/b.CSV")), Ok(true));
        assert_eq!(is_csv(Path::new("b.md")), Ok(false));
        for name in ["b", "b.txt", ".md"] {
            let why = is_csv(Path::new(name)).unwrap_err();
            assert!(why.starts_with(name), "{why}");
        }
    }
}
