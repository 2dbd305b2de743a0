//! What a person chose about the editor itself, kept from one day to the next in a file of the
//! user's configuration folder. Nothing in it belongs to a scene.

use super::keys::Bindings;
use super::notice::Notices;
use crate::io::{Problem, read_text, replace_file};
use bevy::app::{App, AppExit, Last, Plugin};
use bevy::ecs::message::MessageReader;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Local, Res, ResMut};
use serde::{Deserialize, Serialize};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The variable that puts the configuration elsewhere, for tests and portable copies.
pub const CONFIG_VARIABLE: &str = "GLASSBOX_CONFIG_DIR";

/// The file's name.
const FILE: &str = "preferences.ron";
/// How many files, and how many folders, are remembered.
const MOST_RECENT: usize = 10;
/// How long preferences stand still before they are written: dragging a border is one change.
const SETTLE: Duration = Duration::from_millis(700);
/// No file of ours is larger.
const LARGEST: u64 = 1 << 20;

/// Dark or light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ThemeChoice {
    /// As the desktop says; dark where it says nothing.
    System,
    /// Light text on dark: what is rendered is easier to judge.
    #[default]
    Dark,
    /// Dark text on light.
    Light,
}

/// How large a model becomes that is imported into a scene, and where it stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ImportPlace {
    /// As large as the view asks for, on what is dropped on or looked at.
    #[default]
    Fitted,
    /// As large as the file has it, on what is dropped on or looked at.
    FileScale,
    /// As large as the file has it, and where.
    FilePlace,
}

/// What a person chose about the editor itself.
#[derive(Resource, Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// Dark or light.
    pub theme: ThemeChoice,
    /// Multiplies the size of everything in panels, besides the screen's own scale factor; 0.5 to 3.
    pub zoom: f32,
    /// Logical pixels.
    pub hierarchy_width: f32,
    /// Logical pixels.
    pub inspector_width: f32,
    /// Whether the list of entities is shown.
    pub show_hierarchy: bool,
    /// Whether the properties are shown.
    pub show_inspector: bool,
    /// Whether the ray inspector is shown.
    pub show_rays: bool,
    /// It is a window over the picture, and no panel below it.
    pub rays_float: bool,
    /// Logical pixels.
    pub rays_height: f32,
    /// Screen pixels along each side of one that is traced, 1 to 8: larger is quicker and coarser.
    pub pixel_size: u32,
    /// The traced view keeps what each light adds apart, which takes memory and makes edits of lights quick.
    pub lights_apart: bool,
    /// What becomes of models that are imported into a scene.
    pub import_place: ImportPlace,
    /// Lights and cameras of models that are imported are added too.
    pub import_lights: bool,
    /// The first-run hint was read.
    pub hint_seen: bool,
    /// Keys that were given to commands.
    pub keys: Bindings,
    /// Files that were opened or saved, the newest first.
    pub recent: Vec<PathBuf>,
    /// Folders of what was opened, imported or written, the newest first.
    pub recent_folders: Vec<PathBuf>,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            theme: ThemeChoice::default(),
            zoom: 1.0,
            hierarchy_width: 220.0,
            inspector_width: 300.0,
            show_hierarchy: true,
            show_inspector: true,
            show_rays: false,
            rays_float: false,
            rays_height: 240.0,
            pixel_size: 1,
            lights_apart: true,
            import_place: ImportPlace::default(),
            import_lights: true,
            hint_seen: false,
            keys: Bindings::default(),
            recent: Vec::new(),
            recent_folders: Vec::new(),
        }
    }
}

impl Preferences {
    /// Puts a file at the head of the recent ones, and its folder at that of the recent folders.
    pub fn remember(&mut self, file: &Path) {
        let whole = std::path::absolute(file).unwrap_or_else(|_| file.to_path_buf());
        put_first(&mut self.recent, whole);
        self.remember_folder_of(file);
    }

    /// Puts the folder of a file at the head of the recent ones.
    pub fn remember_folder_of(&mut self, file: &Path) {
        // Where the working folder is gone, a relative path leads nowhere.
        if let Ok(whole) = std::path::absolute(file)
            && let Some(folder) = whole.parent()
        {
            put_first(&mut self.recent_folders, folder.to_path_buf());
        }
    }

    /// Takes a file out of the recent ones: it is gone.
    pub fn forget(&mut self, file: &Path) {
        self.recent.retain(|other| other != file);
    }

    /// The same with every number inside its range: the file may have been edited by hand.
    fn checked(mut self) -> Self {
        let default = Self::default();
        let within = |value: f32, least: f32, most: f32, default: f32| {
            if value.is_finite() {
                value.clamp(least, most)
            } else {
                default
            }
        };
        self.zoom = within(self.zoom, 0.5, 3.0, default.zoom);
        let width = |value, default| within(value, 120.0, 2000.0, default);
        self.hierarchy_width = width(self.hierarchy_width, default.hierarchy_width);
        self.inspector_width = width(self.inspector_width, default.inspector_width);
        self.rays_height = within(self.rays_height, 120.0, 2000.0, default.rays_height);
        self.pixel_size = self.pixel_size.clamp(1, 8);
        self.recent.truncate(MOST_RECENT);
        self.recent_folders.truncate(MOST_RECENT);
        if self.recent_folders.is_empty() {
            // They were not kept before.
            for file in self.recent.clone().iter().rev() {
                self.remember_folder_of(file);
            }
        }
        self
    }

    /// The preferences in a folder; the defaults where there are none. Where the file cannot be
    /// read the second value says why, and the file is kept under another name.
    pub fn load(folder: &Path) -> (Self, Option<String>) {
        let file = folder.join(FILE);
        match read(&file) {
            Ok(None) => (Self::default(), None),
            Ok(Some(preferences)) => (preferences.checked(), None),
            Err(why) => {
                let kept = folder.join(format!("{FILE}.broken"));
                let then = match fs::rename(&file, &kept) {
                    Ok(()) => format!("it is kept as {}", kept.display()),
                    Err(_) => "it will be replaced".into(),
                };
                let text = format!(
                    "{}: {why}; the defaults are used, and {then}",
                    file.display()
                );
                (Self::default(), Some(text))
            }
        }
    }

    /// Writes them into a folder, which is made where it is missing.
    pub fn save(&self, folder: &Path) -> Result<(), String> {
        fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        let pretty = ron::ser::PrettyConfig::default();
        let text = ron::ser::to_string_pretty(self, pretty).map_err(|error| error.to_string())?;
        replace_file(&folder.join(FILE), |out| out.write_all(text.as_bytes()))
            .map_err(|error| error.to_string())
    }
}

fn put_first(paths: &mut Vec<PathBuf>, path: PathBuf) {
    paths.retain(|other| *other != path);
    paths.insert(0, path);
    paths.truncate(MOST_RECENT);
}

fn read(file: &Path) -> Result<Option<Preferences>, String> {
    let text = match read_text(file, LARGEST) {
        Ok(text) => text,
        Err(error) if matches!(error.problem, Problem::NotFound) => return Ok(None),
        Err(error) => return Err(error.problem.to_string()),
    };
    ron::from_str(&text)
        .map(Some)
        .map_err(|error| error.to_string())
}

/// Where the editor keeps its own files; `None` where the system names no place for them.
pub fn config_folder() -> Option<PathBuf> {
    if let Some(folder) = std::env::var_os(CONFIG_VARIABLE).filter(|folder| !folder.is_empty()) {
        return Some(folder.into());
    }
    let folders = directories::ProjectDirs::from("", "", "glassbox")?;
    Some(folders.config_dir().to_path_buf())
}

/// Loads the preferences, and writes them when they have changed.
pub struct PreferencesPlugin;

impl Plugin for PreferencesPlugin {
    fn build(&self, app: &mut App) {
        let (preferences, fault) = match config_folder() {
            Some(folder) => Preferences::load(&folder),
            None => (Preferences::default(), None),
        };
        app.init_resource::<Notices>();
        if let Some(fault) = fault {
            app.world_mut().resource_mut::<Notices>().fault(fault);
        }
        app.insert_resource(preferences)
            .add_systems(Last, write_changes);
    }
}

/// What is in the file, and since when something else is meant.
#[derive(Default)]
struct Written {
    preferences: Option<Preferences>,
    pending: Option<(Preferences, Instant)>,
    failed: bool,
}

fn write_changes(
    preferences: Res<Preferences>,
    mut exits: MessageReader<AppExit>,
    mut written: Local<Written>,
    mut notices: ResMut<Notices>,
) {
    let leaving = exits.read().next().is_some();
    let current = &*preferences;
    let saved = written.preferences.get_or_insert_with(|| current.clone());
    if saved == current {
        written.pending = None;
        return;
    }
    let since = match &written.pending {
        Some((pending, since)) if pending == current => *since,
        _ => {
            let now = Instant::now();
            written.pending = Some((current.clone(), now));
            now
        }
    };
    if !leaving && since.elapsed() < SETTLE {
        return;
    }
    written.preferences = Some(current.clone());
    written.pending = None;
    let Some(folder) = config_folder() else {
        return;
    };
    if let Err(why) = current.save(&folder)
        && !written.failed
    {
        // Once: what cannot be written now will not be written a second later.
        written.failed = true;
        notices.fault(format!("the preferences are not kept: {why}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_saved_is_loaded_again() {
        let folder = tempfile::tempdir().unwrap();
        let inner = folder.path().join("glassbox");
        assert_eq!(Preferences::load(&inner), (Preferences::default(), None));
        let mut preferences = Preferences {
            theme: ThemeChoice::Light,
            zoom: 1.5,
            hierarchy_width: 310.0,
            hint_seen: true,
            ..Preferences::default()
        };
        preferences.remember(Path::new("/a/b.scn.ron"));
        preferences.save(&inner).unwrap();
        assert_eq!(Preferences::load(&inner), (preferences, None));
    }

    #[test]
    fn a_file_that_cannot_be_read_is_kept_and_named_and_the_defaults_are_used() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(FILE), "(zoom: \"large\")").unwrap();
        let (preferences, fault) = Preferences::load(folder.path());
        assert_eq!(preferences, Preferences::default());
        assert!(fault.unwrap().contains(FILE));
        let kept = folder.path().join(format!("{FILE}.broken"));
        assert_eq!(fs::read_to_string(kept).unwrap(), "(zoom: \"large\")");
    }

    #[test]
    fn numbers_that_were_edited_out_of_range_come_back_into_it() {
        let folder = tempfile::tempdir().unwrap();
        let text = "(zoom: 1000.0, hierarchy_width: inf, pixel_size: 0)";
        fs::write(folder.path().join(FILE), text).unwrap();
        let (preferences, fault) = Preferences::load(folder.path());
        assert_eq!(fault, None);
        assert_eq!(preferences.zoom, 3.0);
        assert_eq!(preferences.hierarchy_width, 220.0);
        assert_eq!(preferences.pixel_size, 1);
    }

    #[test]
    fn a_file_that_is_opened_again_moves_to_the_head_of_the_recent_ones() {
        let mut preferences = Preferences::default();
        for i in 0..15 {
            preferences.remember(Path::new(&format!("/scenes/{i}.scn.ron")));
        }
        preferences.remember(Path::new("/scenes/10.scn.ron"));
        let names: Vec<_> = preferences
            .recent
            .iter()
            .filter_map(|file| file.file_name()?.to_str()?.split('.').next())
            .collect();
        assert_eq!(
            names,
            ["10", "14", "13", "12", "11", "9", "8", "7", "6", "5"]
        );
    }

    #[test]
    fn folders_are_remembered_once_each_the_newest_first_and_those_of_an_older_file_come_from_its_files()
     {
        let mut preferences = Preferences::default();
        for file in ["/a/1.scn.ron", "/b/2.scn.ron", "/a/3.scn.ron"] {
            preferences.remember(Path::new(file));
        }
        preferences.remember_folder_of(Path::new("/models/cup.obj"));
        preferences.remember_folder_of(Path::new("/b/2.scn.ron"));
        let folders = ["/b", "/models", "/a"].map(PathBuf::from);
        assert_eq!(preferences.recent_folders, folders);
        assert_eq!(preferences.recent.len(), 3, "an import is no file to open");
        let folder = tempfile::tempdir().unwrap();
        preferences.save(folder.path()).unwrap();
        let (again, _) = Preferences::load(folder.path());
        assert_eq!(again.recent_folders, folders);
        let older = "(recent: [\"/a/3.scn.ron\", \"/b/2.scn.ron\", \"/a/1.scn.ron\"])";
        fs::write(folder.path().join(FILE), older).unwrap();
        let (older, _) = Preferences::load(folder.path());
        assert_eq!(older.recent_folders, ["/a", "/b"].map(PathBuf::from));
    }
}
