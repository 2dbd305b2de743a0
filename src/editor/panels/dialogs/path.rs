//! A path is typed, where the system has no dialog for it: with what lies in the folder, recent folders, and Tab to
//! complete.

use super::super::asked::Asked;
use super::super::number_field::select_letters;
use super::super::says::Says;
use super::folder::{Taken, above, list_ui, names_in};
use super::question::{is_pressed_anew, whole_path_ui};
use crate::editor::document::{Answer, Purpose};
use crate::editor::texts::{path_of, path_text};
use crate::io::PICTURE_EXTENSIONS;
use bevy_egui::egui::{Button, Context, EventFilter, Id, Key, Modifiers, RichText, TextEdit, Ui};
use std::ops::Range;
use std::path::{MAIN_SEPARATOR, Path, PathBuf};

/// Recent folders that are offered.
const OFFERED: usize = 6;
/// What a scene's name ends with where one is suggested.
const SUGGESTED: &str = ".scn.ron";
/// What names end with of what is saved.
const EXTENSIONS: [&str; 3] = [SUGGESTED, ".obj", ".glb"];
/// What is typed, and what lies in the folder that it names.
pub(in super::super) struct PathForm {
    text: String,
    is_new: bool,
    given: Option<Given>,
    /// Folders that were used before and are there.
    recent: Vec<PathBuf>,
    names: Asked<(PathBuf, Purpose), Vec<String>>,
    /// Tab was pressed, and what lies in the folder is not known yet.
    completes: bool,
}

/// A path that was given. What is being done with it is shown in a frame of its own, since all others wait for it.
struct Given {
    path: PathBuf,
    is_shown: bool,
}

impl PathForm {
    /// Begins with a path. Of the folders those are offered that are there now: asked once, as a disk that is far away
    /// may be slow to answer.
    pub fn new(suggestion: &Path, recent: &[PathBuf]) -> Self {
        let text = suggestion.display().to_string();
        let there = recent.iter().filter(|folder| folder.is_dir());
        Self {
            text,
            is_new: true,
            given: None,
            recent: there.take(OFFERED).cloned().collect(),
            names: Asked::default(),
            completes: false,
        }
    }

    /// The names that fit what was typed behind the last separator; `None` until the folder was read.
    fn fitting(&mut self, context: &Context, purpose: Purpose) -> Option<Vec<String>> {
        let (folder, begun) = split(&self.text);
        let names = self
            .names
            .look(context, (path_of(folder), purpose), names_in)?;
        let fits = |name: &&String| {
            let is_hidden = name.starts_with('.') && !begun.starts_with('.');
            !is_hidden && begins_with(name, begun)
        };
        Some(names.iter().filter(fits).cloned().collect())
    }

    /// Puts a name in the place of what was begun.
    fn complete(&mut self, name: &str) {
        let (folder, _) = split(&self.text);
        self.text = format!("{folder}{name}");
    }
}

/// The folder with its separator, and what follows.
pub(super) fn split(text: &str) -> (&str, &str) {
    let is_separator = |c: char| c == '/' || c == MAIN_SEPARATOR;
    text.split_at(text.rfind(is_separator).map_or(0, |at| at + 1))
}

/// Case is not minded: nobody remembers it.
fn begins_with(name: &str, begun: &str) -> bool {
    let mut letters = name.chars().flat_map(char::to_lowercase);
    begun
        .chars()
        .flat_map(char::to_lowercase)
        .all(|letter| letters.next() == Some(letter))
}

/// What all of them begin with.
fn shared(names: &[String]) -> String {
    let Some((first, others)) = names.split_first() else {
        return String::new();
    };
    let fits = |end: usize| {
        let begin = &first[..end];
        others.iter().all(|name| begins_with(name, begin))
    };
    let ends = first.char_indices().map(|(at, c)| at + c.len_utf8());
    let end = ends.take_while(|&end| fits(end)).last().unwrap_or(0);
    first[..end].to_owned()
}

/// The question for a path; `refused` says why the one before did not do.
pub(super) fn path_ui(
    ui: &mut Ui,
    form: &mut PathForm,
    purpose: Purpose,
    refused: Option<&str>,
) -> Option<Answer> {
    let pictures = format!("A picture: .{}", PICTURE_EXTENSIONS.join(", ."));
    ui.label(match purpose {
        Purpose::Open => {
            "A scene or a model: .scn.ron, .obj, .gltf, .glb, .stl, .ply, or a built-in scene's name"
        }
        Purpose::SaveAs => "Where to: .scn.ron keeps everything; .obj and .glb are models",
        Purpose::Import => "A model: .obj, .gltf, .glb, .stl or .ply",
        Purpose::Picture => &pictures,
    });
    let id = Id::new("path that is asked for");
    let fitting = form.fitting(ui.ctx(), purpose);
    let has_keys = ui.memory(|memory| memory.has_focus(id));
    let tab = has_keys && ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Tab));
    form.completes |= tab;
    let mut chosen = None;
    if let Some(fitting) = &fitting
        && std::mem::take(&mut form.completes)
        && !fitting.is_empty()
    {
        chosen = Some(shared(fitting));
    }
    let is_known = fitting.is_some();
    let fitting = fitting.unwrap_or_default();
    let field = TextEdit::singleline(&mut form.text)
        .id(id)
        .desired_width(ui.available_width());
    let response = ui
        .add(field)
        .says("The path; relative ones begin in the working folder, ~ is home, Tab completes");
    // Tab is the field's own: it completes.
    ui.memory_mut(|memory| {
        let filter = EventFilter {
            tab: true,
            horizontal_arrows: true,
            vertical_arrows: false,
            escape: false,
        };
        memory.set_focus_lock_filter(id, filter);
    });
    if std::mem::take(&mut form.is_new) {
        response.request_focus();
        // A name that is only suggested is typed over; what was refused is mended at its end.
        match purpose == Purpose::SaveAs && refused.is_none() {
            true => select_letters(ui, id, stem(&form.text)),
            false => end_caret(ui, id, &form.text),
        }
    }
    let entered = response.lost_focus() && ui.input(|input| is_pressed_anew(input, Key::Enter));
    let path = path_of(match purpose {
        Purpose::SaveAs => without_suggested(&form.text),
        Purpose::Open | Purpose::Import | Purpose::Picture => &form.text,
    });
    match path.as_os_str().is_empty() {
        true => drop(ui.weak(path_text(Path::new(".")))),
        false => whole_path_ui(ui, &path),
    }
    if let Some(given) = &form.given {
        let verb = match purpose {
            Purpose::Open | Purpose::Import | Purpose::Picture => "Reading",
            Purpose::SaveAs => "Writing",
        };
        ui.label(format!("{verb} {}…", path_text(&given.path)));
    } else if let Some(why) = refused {
        let ink = ui.visuals().error_fg_color;
        ui.label(RichText::new(why).color(ink));
    }
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        for folder in &form.recent {
            let name = path_text(folder);
            let says = "What lies in a folder that was used before";
            if ui.small_button(&name).says(says).clicked() {
                form.text = format!("{name}/");
                chosen = Some(String::new());
            }
        }
    });
    let missing = match (is_known, purpose) {
        (false, _) => Some("Reading the folder…"),
        (true, Purpose::SaveAs) => None,
        (true, _) => Some("Nothing like that is here"),
    };
    match list_ui(ui, above(&form.text).is_some(), &fitting, missing) {
        Some(Taken::Above) => {
            form.text = above(&form.text).unwrap_or_default();
            chosen = Some(String::new());
        }
        Some(Taken::Name(name)) => chosen = Some(name),
        None => {}
    }
    if let Some(name) = chosen {
        if !name.is_empty() {
            form.complete(&name);
        }
        ui.memory_mut(|memory| memory.request_focus(id));
        end_caret(ui, id, &form.text);
    }
    ui.add_space(8.0);
    let answered = buttons_ui(ui, path, entered);
    match (form.given.take(), answered) {
        (Some(given), _) if given.is_shown => return Some(Answer::Path(given.path)),
        (Some(given), _) => {
            form.given = Some(Given {
                is_shown: true,
                ..given
            });
        }
        (None, Some(Answer::Path(path))) => {
            let is_shown = false;
            form.given = Some(Given { path, is_shown });
        }
        (None, answered) => return answered,
    }
    ui.ctx().request_repaint();
    None
}

fn buttons_ui(ui: &mut Ui, path: PathBuf, entered: bool) -> Option<Answer> {
    let is_empty = path.as_os_str().is_empty();
    let mut answered = (entered && !is_empty).then(|| Answer::Path(path.clone()));
    ui.horizontal(|ui| {
        let go = ui.add_enabled(!is_empty, Button::new("OK"));
        if go.says("Goes on with this path").clicked() {
            answered = Some(Answer::Path(path));
        }
        let cancel = ui.button("Cancel").says("Leaves everything as it is");
        if cancel.clicked() {
            answered = Some(Answer::Cancel);
        }
    });
    answered
}

fn end_caret(ui: &Ui, id: Id, text: &str) {
    let end = text.chars().count();
    select_letters(ui, id, end..end);
}

/// A path without the extension that was suggested, where its own was typed before it: over a selected stem people type
/// whole names.
fn without_suggested(text: &str) -> &str {
    let typed = text.strip_suffix(SUGGESTED);
    let is_whole = |typed: &&str| EXTENSIONS.iter().any(|own| typed.ends_with(own));
    typed.filter(is_whole).unwrap_or(text)
}

/// Which letters of a path are the file's name without its extensions.
fn stem(text: &str) -> Range<usize> {
    let (folder, name) = split(text);
    let stem = name.split('.').next().unwrap_or(name);
    let start = folder.chars().count();
    start..start + stem.chars().count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy_egui::egui::{Event, PointerButton, RawInput, Shape};
    use std::fs;

    #[test]
    fn a_path_is_completed_from_what_lies_in_its_folder() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["Scenes", "scans"] {
            fs::create_dir(folder.path().join(name)).unwrap();
        }
        for name in [
            "scene.scn.ron",
            "b.obj",
            "c.webp",
            "notes.txt",
            ".hidden.obj",
        ] {
            fs::write(folder.path().join(name), "").unwrap();
        }
        let mut form = PathForm::new(&folder.path().join(""), &[]);
        let fitting = |form: &mut PathForm, purpose| {
            let context = Context::default();
            let (folder, _) = split(&form.text);
            form.names.wait((path_of(folder), purpose), names_in);
            form.fitting(&context, purpose).unwrap()
        };
        let of = |form: &mut PathForm, purpose| fitting(form, purpose).join(" ");
        let all = of(&mut form, Purpose::Open);
        assert_eq!(all, "Scenes/ scans/ b.obj scene.scn.ron");
        let models = of(&mut form, Purpose::Import);
        assert_eq!(models, "Scenes/ scans/ b.obj");
        let pictures = of(&mut form, Purpose::Picture);
        assert_eq!(pictures, "Scenes/ scans/ c.webp");
        form.text += "sc";
        let begun = fitting(&mut form, Purpose::Open);
        assert_eq!(begun, ["Scenes/", "scans/", "scene.scn.ron"]);
        assert_eq!(shared(&begun), "Sc");
        form.text += "ene";
        let begun = fitting(&mut form, Purpose::Open);
        assert_eq!(shared(&begun), "Scene");
        form.complete(&begun[0]);
        assert!(form.text.ends_with("/Scenes/"), "{}", form.text);
        form.text = "/no/such/folder/x".into();
        assert!(fitting(&mut form, Purpose::Open).is_empty());
    }

    #[test]
    fn where_nothing_can_be_taken_it_is_said_and_the_way_out_is_there() {
        let folder = tempfile::tempdir().unwrap();
        let inner = folder.path().join("inner");
        fs::create_dir(&inner).unwrap();
        let mut form = PathForm::new(&inner.join(""), &[]);
        form.names.wait((inner.join(""), Purpose::Open), names_in);
        let context = Context::default();
        let mut frame = |events| {
            let input = RawInput {
                events,
                ..RawInput::default()
            };
            let output = context.run_ui(input, |ui| {
                path_ui(ui, &mut form, Purpose::Open, None);
            });
            let place = |wanted: &str| {
                output.shapes.iter().find_map(|shape| match &shape.shape {
                    Shape::Text(text) if text.galley.text() == wanted => {
                        Some(text.visual_bounding_rect().center())
                    }
                    _ => None,
                })
            };
            let found = ["../", "Nothing like that is here"].map(place);
            (found, form.text.clone())
        };
        frame(Vec::new());
        let ([up, nothing], _) = frame(Vec::new());
        assert!(nothing.is_some());
        let pos = up.unwrap();
        let button = |pressed| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        frame(vec![Event::PointerMoved(pos)]);
        frame(vec![button(true)]);
        frame(vec![button(false)]);
        let (_, text) = frame(Vec::new());
        assert_eq!(path_of(&text), folder.path().join(""));
    }

    #[test]
    fn tab_completes_a_path_as_soon_as_its_folder_was_read() {
        let (sender, names) = Asked::sent((PathBuf::from("/far/"), Purpose::Open));
        let mut form = PathForm {
            names,
            ..PathForm::new(Path::new("/far/sc"), &[])
        };
        let context = Context::default();
        let mut frame = |events| {
            let input = RawInput {
                events,
                ..RawInput::default()
            };
            let _ = context.run_ui(input, |ui| {
                path_ui(ui, &mut form, Purpose::Open, None);
            });
            form.text.clone()
        };
        for _ in 0..2 {
            frame(Vec::new());
        }
        let tab = Event::Key {
            key: Key::Tab,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::NONE,
        };
        assert_eq!(frame(vec![tab]), "/far/sc", "nobody knows yet");
        sender.send(vec!["scenes/".to_owned()]).unwrap();
        assert_eq!(frame(Vec::new()), "/far/scenes/");
    }

    #[test]
    fn the_stem_of_a_path_is_its_name_without_folders_and_extensions() {
        for (text, letters) in [
            ("room.scn.ron", 0..4),
            ("/tmp/übung/ö.obj", 11..12),
            ("room", 0..4),
            ("/tmp/", 5..5),
            ("", 0..0),
        ] {
            assert_eq!(stem(text), letters, "{text}");
        }
    }

    #[test]
    fn a_whole_name_that_is_typed_over_a_stem_is_the_name() {
        for (text, path) in [
            ("/tmp/room.scn.ron.scn.ron", "/tmp/room.scn.ron"),
            ("/tmp/room.glb.scn.ron", "/tmp/room.glb"),
            ("room.scn.ron", "room.scn.ron"),
            ("room.v2.scn.ron", "room.v2.scn.ron"),
            ("room.glb", "room.glb"),
            ("", ""),
        ] {
            assert_eq!(without_suggested(text), path);
        }
    }

    #[test]
    fn recent_folders_are_offered_in_their_order_where_they_are_there() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in ["new", "old"] {
            fs::create_dir(at(name)).unwrap();
        }
        fs::write(at("file"), "").unwrap();
        let recent = ["new", "gone", "file", "old"].map(at);
        let form = PathForm::new(Path::new(""), &recent);
        assert_eq!(form.recent, ["new", "old"].map(at));
    }
}
