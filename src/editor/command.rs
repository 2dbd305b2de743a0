//! The table of commands. A command is one row: what it is called, which keys send it, where it
//! stands, when it can be run, and what it does. Menus, the toolbar, menus of a right click, the
//! palette, the page of keys and scripts read the row; a plugin of an app adds rows as ours do:
//!
//! ```no_run
//! # use bevy::prelude::*;
//! use glassbox::editor::command::{AddCommands, Command};
//! # fn build(app: &mut App) {
//! app.add_commands([
//!     Command::new("game.start", "Start the game", "Begins the first level", |_world| {})
//!         .menu("Game", 0),
//! ]);
//! # }
//! ```

use super::keys::{Bindings, Keys};
use super::notice::Notices;
use super::preferences::Preferences;
use bevy::app::App;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

/// What a right click was made on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// An object, a light, a camera, a material or a group, in the view or in the list.
    Entity,
    /// The view, where nothing is.
    Nothing,
    /// The view, whatever is there.
    Pixel,
    /// A debug ray.
    Ray,
    /// A box of a tree.
    Box,
}

/// What a command is like at the moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Why it cannot be run, as a sentence.
    pub why_not: Option<Cow<'static, str>>,
    /// Of a switch: whether it is on.
    pub on: Option<bool>,
    /// What its name ends in, after a colon: which step undo takes back.
    pub detail: Option<String>,
}

impl State {
    /// It can be run if `ready`; else this is why not.
    pub fn when(ready: bool, why_not: &'static str) -> Self {
        Self {
            why_not: (!ready).then_some(why_not.into()),
            ..Self::default()
        }
    }

    /// A switch.
    pub fn switch(on: bool) -> Self {
        Self {
            on: Some(on),
            ..Self::default()
        }
    }
}

/// One command.
#[derive(Clone)]
pub struct Command {
    /// What scripts, bindings and the rest of the program call it: `edit.undo`.
    pub id: Cow<'static, str>,
    /// What people call it.
    pub name: Cow<'static, str>,
    /// What it does, in a sentence.
    pub help: Cow<'static, str>,
    /// What sends it unless a person chose otherwise; menus show the first.
    pub keys: Vec<Keys>,
    /// Holding its key down sends it again and again.
    pub repeats: bool,
    /// Menus that have it, `"View/Look along"` being a menu within one, and the group within: lines
    /// part groups of different numbers.
    pub menus: Vec<(&'static str, u8)>,
    /// The group of the toolbar that has it, and what its button says.
    pub button: Option<(&'static str, &'static str)>,
    /// What has it in the menu of a right click.
    pub over: &'static [Over],
    state: fn(&World) -> State,
    run: Arc<dyn Fn(&mut World) + Send + Sync>,
}

impl Command {
    /// A command that can always be run, has no key and stands in the palette alone.
    pub fn new(
        id: impl Into<Cow<'static, str>>,
        name: impl Into<Cow<'static, str>>,
        help: impl Into<Cow<'static, str>>,
        run: impl Fn(&mut World) + Send + Sync + 'static,
    ) -> Self {
        Self {
            id: id.into(),
            name: name.into(),
            help: help.into(),
            keys: Vec::new(),
            repeats: false,
            menus: Vec::new(),
            button: None,
            over: &[],
            state: |_| State::default(),
            run: Arc::new(run),
        }
    }

    /// These send it: `"Ctrl+Shift+Z"`.
    ///
    /// # Panics
    ///
    /// Where a text names no key: rows are written by programmers.
    pub fn keys(mut self, keys: &[&str]) -> Self {
        let keys = keys.iter().map(|text| text.parse());
        self.keys = keys.collect::<Result<_, String>>().expect("names of keys");
        self
    }

    /// Puts it into a menu too.
    pub fn menu(mut self, path: &'static str, group: u8) -> Self {
        self.menus.push((path, group));
        self
    }

    /// Gives it a button in a group of the toolbar.
    pub fn button(mut self, group: &'static str, text: &'static str) -> Self {
        self.button = Some((group, text));
        self
    }

    /// Puts it into the menus of right clicks.
    pub fn over(mut self, over: &'static [Over]) -> Self {
        self.over = over;
        self
    }

    /// Asks this what it is like.
    pub fn state(mut self, state: fn(&World) -> State) -> Self {
        self.state = state;
        self
    }

    /// Holding its key down sends it again and again.
    pub fn repeats(mut self) -> Self {
        self.repeats = true;
        self
    }

    /// What it is like at the moment.
    pub fn state_in(&self, world: &World) -> State {
        (self.state)(world)
    }

    /// Its name, with what it would do now.
    pub fn title(&self, state: &State) -> String {
        match &state.detail {
            Some(detail) => format!("{}: {detail}", self.name),
            None => self.name.clone().into_owned(),
        }
    }
}

/// All commands, in the order in which they were added.
#[derive(Resource, Default)]
pub struct CommandTable {
    rows: Vec<Arc<Command>>,
    places: HashMap<Cow<'static, str>, usize>,
}

impl CommandTable {
    /// Adds a row, or puts it in the place of the one with its id.
    pub fn add(&mut self, command: Command) {
        let end = self.rows.len();
        let at = *self.places.entry(command.id.clone()).or_insert(end);
        match self.rows.get_mut(at) {
            Some(row) => *row = Arc::new(command),
            None => self.rows.push(Arc::new(command)),
        }
    }

    /// All rows.
    pub fn rows(&self) -> &[Arc<Command>] {
        &self.rows
    }

    /// The row with this id.
    pub fn find(&self, id: &str) -> Option<&Arc<Command>> {
        self.rows.get(*self.places.get(id)?)
    }

    /// What these keys send; the first row, where several want them.
    pub fn of_keys(&self, keys: Keys, bindings: &Bindings) -> Option<&Arc<Command>> {
        let mut rows = self.rows.iter();
        rows.find(|row| bindings.of(row).contains(&keys))
    }

    /// Keys that several commands want, and those commands.
    pub fn conflicts(&self, bindings: &Bindings) -> Vec<(Keys, Vec<Arc<Command>>)> {
        let mut wanted: Vec<(Keys, Vec<Arc<Command>>)> = Vec::new();
        for row in &self.rows {
            for &keys in bindings.of(row) {
                match wanted.iter_mut().find(|(other, _)| *other == keys) {
                    Some((_, rows)) => rows.push(row.clone()),
                    None => wanted.push((keys, vec![row.clone()])),
                }
            }
        }
        wanted.retain(|(_, rows)| rows.len() > 1);
        wanted
    }
}

/// Rows, each as `id name [keys] help => run`, followed by what else is said of it.
macro_rules! commands {
    ($($id:literal $name:literal [$($keys:literal),*] $help:literal => $run:expr $(; $said:ident $with:tt)* ,)*) => {
        vec![$(
            $crate::editor::command::Command::new($id, $name, $help, $run)
                .keys(&[$($keys),*])
                $(.$said $with)*
        ),*]
    };
}
pub(super) use commands;

/// Adds rows to the table of commands.
pub trait AddCommands {
    /// Adds them at the end; a row with a known id takes that one's place.
    fn add_commands(&mut self, commands: impl IntoIterator<Item = Command>) -> &mut Self;
}

impl AddCommands for App {
    fn add_commands(&mut self, commands: impl IntoIterator<Item = Command>) -> &mut Self {
        self.init_resource::<CommandTable>();
        let mut table = self.world_mut().resource_mut::<CommandTable>();
        commands.into_iter().for_each(|command| table.add(command));
        self
    }
}

/// The row with this id.
pub(super) fn find(world: &World, id: &str) -> Option<Arc<Command>> {
    let table = world.get_resource::<CommandTable>()?;
    table.find(id).cloned()
}

/// Runs the command with this id. Where it cannot be run, that is said and nothing else happens.
pub(super) fn run(world: &mut World, id: &str) {
    let Some(command) = find(world, id) else {
        let text = format!("There is no command {id:?}; Ctrl+P lists all.");
        world.resource_mut::<Notices>().fault(text);
        return;
    };
    match command.state_in(world).why_not {
        Some(why) => world.resource_mut::<Notices>().tell(why),
        None => (command.run)(world),
    }
}

/// Off where it is on, and the other way round.
pub(super) fn flip(switch: &mut bool) {
    *switch = !*switch;
}

/// The first keys that send it, as menus show them.
pub(super) fn shortcut(world: &World, command: &Command) -> Option<String> {
    let keys = match world.get_resource::<Preferences>() {
        Some(preferences) => preferences.keys.of(command),
        None => &command.keys,
    };
    keys.first().map(Keys::text)
}

/// What it does and which keys send it, for a tooltip.
pub(super) fn tooltip(world: &World, id: &str) -> String {
    let Some(command) = find(world, id) else {
        return String::new();
    };
    match shortcut(world, &command) {
        Some(keys) => format!("{} ({keys})", command.help),
        None => command.help.clone().into_owned(),
    }
}
