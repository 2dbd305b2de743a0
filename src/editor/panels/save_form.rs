//! Saving what a panel shows, by a path and a button: a table as Markdown or as comma-separated values, a picture.

use super::replaces::Replaces;
use super::says::Says;
use crate::editor::notice::Notices;
use crate::editor::texts::{path_of, path_text};
use crate::io::{check_not_read, replace_file};
use bevy::ecs::world::World;
use bevy_egui::egui::{Button, Key, TextEdit, Ui};
use std::io::Write;
use std::path::Path;

/// The kinds of a table's file.
pub(super) const TABLES: &str = ".md for Markdown, .csv for a spreadsheet";

/// What is entered.
#[derive(Default)]
pub(super) struct SaveForm {
    path: Option<String>,
    replaces: Replaces,
    refused: Option<String>,
}

/// What the name of a table's file asks for.
pub(super) fn is_csv(path: &Path) -> Result<bool, String> {
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

/// A path and a button; `bytes` is asked for what to write into a file of that name, and `kinds` tells which there are.
pub(super) fn save_ui(
    ui: &mut Ui,
    world: &mut World,
    form: &mut SaveForm,
    (suggestion, kinds): (&str, &str),
    bytes: impl FnOnce(&Path) -> Result<Vec<u8>, String>,
) {
    let path = form.path.get_or_insert_with(|| suggestion.to_owned());
    ui.add_space(4.0);
    let mut wanted = false;
    let file = path_of(path);
    let replaces = form.replaces.look(ui.ctx(), &file);
    ui.horizontal(|ui| {
        let name = if replaces { "Replace" } else { "Save" };
        let width = (ui.available_width() - 76.0).max(60.0);
        let field = ui.add(TextEdit::singleline(path).desired_width(width));
        let says = format!(
            "Where this is written: {kinds}; relative paths begin in the working folder, ~ is home"
        );
        let field = field.says(&says);
        wanted = field.lost_focus() && !replaces && ui.input(|input| input.key_pressed(Key::Enter));
        let says = match replaces {
            true => "The file is there already: it is replaced",
            false => "Writes this",
        };
        let button = ui.add_enabled(!file.as_os_str().is_empty(), Button::new(name));
        wanted |= button.says(says).clicked();
    });
    if let Some(refused) = &form.refused {
        ui.colored_label(ui.visuals().error_fg_color, refused);
    }
    if !wanted || file.as_os_str().is_empty() || !form.replaces.allows(replaces) {
        return;
    }
    let written = bytes(&file).and_then(|bytes| {
        check_not_read(world, &file)
            .and_then(|()| replace_file(&file, |out| out.write_all(&bytes)))
            .map_err(|why| why.to_string())
    });
    form.refused = written.as_ref().err().cloned();
    if written.is_ok() {
        let text = format!("Wrote {}", path_text(&file));
        world.resource_mut::<Notices>().tell(text);
        form.replaces.note_written();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::panels::tests::bounds;
    use bevy_egui::egui::accesskit::Role;
    use bevy_egui::egui::{
        self, Event, FullOutput, Modifiers, PointerButton, Pos2, RawInput, Rect, vec2,
    };
    use std::fs;

    /// A form in an egui of its own.
    struct Sheet {
        form: SaveForm,
        world: World,
        context: egui::Context,
    }

    impl Sheet {
        fn new(path: &str) -> Self {
            let mut world = World::new();
            world.init_resource::<Notices>();
            let form = SaveForm {
                path: Some(path.to_owned()),
                ..SaveForm::default()
            };
            let context = egui::Context::default();
            context.enable_accesskit();
            Self {
                form,
                world,
                context,
            }
        }

        fn frame(&mut self, events: Vec<Event>) -> FullOutput {
            let screen = Rect::from_min_size(Pos2::ZERO, vec2(400.0, 300.0));
            let input = RawInput {
                screen_rect: Some(screen),
                events,
                ..RawInput::default()
            };
            let (form, world) = (&mut self.form, &mut self.world);
            self.context.run_ui(input, |ui| {
                save_ui(ui, world, form, ("a.md", TABLES), |_| Ok(b"new".to_vec()));
            })
        }

        /// Presses the button; something else happens before it is let go.
        fn press(&mut self, meanwhile: impl FnOnce()) {
            let output = self.frame(Vec::new());
            let pos = bounds(&output, Role::Button)[0].center();
            let button = |pressed| Event::PointerButton {
                pos,
                button: PointerButton::Primary,
                pressed,
                modifiers: Modifiers::NONE,
            };
            self.frame(vec![Event::PointerMoved(pos)]);
            self.frame(vec![button(true)]);
            meanwhile();
            self.frame(vec![button(false)]);
        }
    }

    #[test]
    fn a_path_from_home_is_one() {
        let text = "~/no/such/folder/of/glassbox/a.md";
        let mut sheet = Sheet::new(text);
        sheet.press(|| {});
        let there = path_of(text).display().to_string();
        let refused = &sheet.form.refused;
        assert!(
            refused.as_ref().is_some_and(|why| why.contains(&there)),
            "{refused:?}"
        );
    }

    #[test]
    fn a_file_that_has_come_since_the_button_was_drawn_is_replaced_by_a_second_press() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.md");
        let mut sheet = Sheet::new(&file.display().to_string());
        let written = || fs::read_to_string(&file).unwrap();
        sheet.press(|| fs::write(&file, "old").unwrap());
        assert_eq!(written(), "old");
        sheet.press(|| {});
        assert_eq!(written(), "new");
    }

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
