//! The panels as a person meets them: drawn by egui without a window, and operated by pointer and
//! keys at the places where their texts stand.

use super::outline::{Outline, outline_scene};
use super::panels_ui;
use super::state::{Dialog, Panels, Tab};
use crate::editor::action::Action;
use crate::editor::headless_editor;
use crate::editor::inspection::RaysPlugin;
use crate::editor::notice::Notices;
use crate::editor::preferences::Preferences;
use crate::editor::selection::Selection;
use crate::editor::viewport::{EditorCamera, Show, Viewport};
use crate::io::builtin::{self, SCENES};
use crate::io::{OpenOptions, SceneSource, open};
use crate::scene::{Environment, PointLamp, RenderSettings, SceneId};
use crate::view::TracedView;
use bevy::app::{App, Last, Plugin};
use bevy::ecs::change_detection::DetectChanges;
use bevy::ecs::entity::Entity;
use bevy::ecs::message::Messages;
use bevy::ecs::name::Name;
use bevy::ecs::query::With;
use bevy::ecs::world::World;
use bevy::math::Vec2;
use bevy_egui::egui::{self, Event, FullOutput, Key, Modifiers, PointerButton, Pos2, Shape, vec2};

/// Windows that must do: the smallest, the usual one, and 4K at twice the scale.
pub(super) const SMALL: [f32; 3] = [1024.0, 640.0, 1.0];
pub(super) const USUAL: [f32; 3] = [1280.0, 720.0, 1.0];
const LARGE: [f32; 3] = [1920.0, 1080.0, 2.0];

/// An editor without a window.
pub(super) struct Desk {
    pub app: App,
    pub context: egui::Context,
    pub size: [f32; 3],
    time: f64,
    output: FullOutput,
}

impl Desk {
    pub fn open(scene: &str) -> Self {
        let mut desk = Self::empty(USUAL);
        let source = SceneSource::Builtin(builtin::find(scene).unwrap());
        open(desk.app.world_mut(), &source, OpenOptions::default()).unwrap();
        desk.settle();
        desk
    }

    fn empty(size: [f32; 3]) -> Self {
        let mut app = headless_editor();
        app.insert_resource(Preferences {
            hint_seen: true,
            ..Preferences::default()
        })
        .init_resource::<Panels>()
        .init_resource::<Outline>()
        .init_resource::<Viewport>()
        .init_resource::<Notices>()
        .add_message::<Action>()
        .add_systems(Last, outline_scene);
        // The app is finished already, and takes no more plugins by itself.
        RaysPlugin.build(&mut app);
        app.world_mut().spawn((EditorCamera, TracedView::default()));
        let context = egui::Context::default();
        context.options_mut(|options| options.max_passes = std::num::NonZero::new(1).unwrap());
        Self {
            app,
            context,
            size,
            time: 0.0,
            output: FullOutput::default(),
        }
    }

    pub fn world(&mut self) -> &mut World {
        self.app.world_mut()
    }

    /// Until sizes and the list of entities are what they will be.
    pub fn settle(&mut self) {
        for _ in 0..4 {
            self.frame(Vec::new());
        }
    }

    pub fn frame(&mut self, events: Vec<Event>) {
        self.app.update();
        self.draw(events);
    }

    /// One pass of egui over all panels.
    fn draw(&mut self, events: Vec<Event>) {
        self.time += 1.0 / 60.0;
        let [width, height, scale] = self.size;
        let mut input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(Pos2::ZERO, vec2(width, height))),
            time: Some(self.time),
            events,
            ..egui::RawInput::default()
        };
        let viewport = input.viewports.entry(egui::ViewportId::ROOT).or_default();
        viewport.native_pixels_per_point = Some(scale);
        let world = self.app.world_mut();
        self.output = self
            .context
            .run_ui(input, |ui| panels_ui(&ui.ctx().clone(), world));
    }

    /// The middle of a text on the screen.
    pub fn find(&self, text: &str) -> Option<Pos2> {
        fn search(shape: &Shape, text: &str) -> Option<Pos2> {
            match shape {
                Shape::Text(shape) if shape.galley.text() == text => {
                    Some(shape.pos + 0.5 * shape.galley.size())
                }
                Shape::Vec(shapes) => shapes.iter().find_map(|shape| search(shape, text)),
                _ => None,
            }
        }
        let shapes = self.output.shapes.iter();
        shapes
            .filter_map(|clipped| {
                let at = search(&clipped.shape, text)?;
                clipped.clip_rect.contains(at).then_some(at)
            })
            .next()
    }

    pub fn place_of(&self, text: &str) -> Pos2 {
        let place = self.find(text);
        place.unwrap_or_else(|| panic!("`{text}` is nowhere on the screen"))
    }

    pub fn point(&mut self, at: Pos2) {
        self.frame(vec![Event::PointerMoved(at)]);
    }

    fn button(&mut self, at: Pos2, pressed: bool, modifiers: Modifiers) {
        let event = Event::PointerButton {
            pos: at,
            button: PointerButton::Primary,
            pressed,
            modifiers,
        };
        self.frame(vec![event]);
    }

    fn click_with(&mut self, at: Pos2, modifiers: Modifiers) {
        self.point(at);
        if modifiers != Modifiers::NONE {
            // Egui asks the state of the keys, not the click.
            self.held(at, modifiers);
            return;
        }
        self.button(at, true, modifiers);
        self.button(at, false, modifiers);
        self.frame(Vec::new());
    }

    fn held(&mut self, at: Pos2, modifiers: Modifiers) {
        for pressed in [true, false] {
            self.app.update();
            self.time += 1.0 / 60.0;
            let [width, height, _] = self.size;
            let input = egui::RawInput {
                screen_rect: Some(egui::Rect::from_min_size(Pos2::ZERO, vec2(width, height))),
                time: Some(self.time),
                modifiers,
                events: vec![Event::PointerButton {
                    pos: at,
                    button: PointerButton::Primary,
                    pressed,
                    modifiers,
                }],
                ..egui::RawInput::default()
            };
            let world = self.app.world_mut();
            self.output = self
                .context
                .run_ui(input, |ui| panels_ui(&ui.ctx().clone(), world));
        }
        self.frame(Vec::new());
    }

    pub fn click(&mut self, at: Pos2) {
        self.click_with(at, Modifiers::NONE);
    }

    pub fn click_on(&mut self, text: &str) {
        let at = self.place_of(text);
        self.click(at);
    }

    pub fn drag(&mut self, from: Pos2, by: egui::Vec2) {
        self.point(from);
        self.button(from, true, Modifiers::NONE);
        for step in 1..=5 {
            self.point(from + by * (step as f32 / 5.0));
        }
        self.button(from + by, false, Modifiers::NONE);
        self.frame(Vec::new());
    }

    fn key(&mut self, key: Key) {
        for pressed in [true, false] {
            self.frame(vec![Event::Key {
                key,
                physical_key: None,
                pressed,
                repeat: false,
                modifiers: Modifiers::NONE,
            }]);
        }
    }

    fn named(&mut self, name: &str) -> (Entity, SceneId) {
        let mut query = self.world().query::<(Entity, &SceneId, &Name)>();
        let found = query
            .iter(self.app.world())
            .find(|(_, _, other)| other.as_str() == name)
            .map(|(entity, id, _)| (entity, *id));
        found.unwrap_or_else(|| panic!("no entity is called {name}"))
    }

    fn select(&mut self, ids: impl IntoIterator<Item = SceneId>) {
        self.world().resource_mut::<Selection>().set(ids);
        self.settle();
    }

    fn ids(&mut self) -> Vec<SceneId> {
        let mut query = self.world().query::<&SceneId>();
        let mut ids: Vec<SceneId> = query.iter(self.app.world()).copied().collect();
        ids.sort_unstable();
        ids
    }

    /// Components of the scene, and its resources, that count as changed since `clear_trackers`.
    fn changed(&mut self) -> Vec<String> {
        let world = self.app.world_mut();
        let (before, now) = (world.last_change_tick(), world.change_tick());
        let mut entities = world.query_filtered::<Entity, With<SceneId>>();
        let entities: Vec<Entity> = entities.iter(world).collect();
        let mut names = Vec::new();
        for entity in entities {
            let entity = world.entity(entity);
            for &component in entity.archetype().components() {
                let ticks = entity.get_change_ticks_by_id(component);
                if ticks.is_some_and(|ticks| ticks.is_changed(before, now)) {
                    let info = world.components().get_info(component);
                    names.push(info.map_or_else(String::new, |info| info.name().to_string()));
                }
            }
        }
        if world
            .get_resource_ref::<RenderSettings>()
            .unwrap()
            .is_changed()
        {
            names.push("RenderSettings".into());
        }
        if world
            .get_resource_ref::<Environment>()
            .unwrap()
            .is_changed()
        {
            names.push("Environment".into());
        }
        names
    }
}

#[test]
fn every_scene_is_drawn_in_every_tab_at_every_size_and_nothing_of_it_counts_as_changed() {
    for scene in SCENES {
        let mut desk = Desk::open(scene.name);
        let ids = desk.ids();
        for size in [SMALL, LARGE] {
            desk.size = size;
            desk.settle();
            desk.world().clear_trackers();
            for tab in [Tab::Object, Tab::Render, Tab::Debug, Tab::Bvh] {
                desk.world().resource_mut::<Panels>().tab = tab;
                // One after the other, then all at once.
                let choices = ids.iter().map(|&id| vec![id]).chain([ids.clone()]);
                let choices = choices.take(if tab == Tab::Object { 60 } else { 1 });
                for selected in choices {
                    desk.world().resource_mut::<Selection>().set(selected);
                    desk.draw(Vec::new());
                    desk.draw(Vec::new());
                }
            }
            for show in [Show::Raster, Show::Split] {
                desk.world().resource_mut::<Viewport>().show = show;
                desk.draw(Vec::new());
            }
            assert_eq!(desk.changed(), [""; 0], "{} at {size:?}", scene.name);
        }
    }
}

#[test]
fn no_panel_grows_by_itself_whatever_it_shows() {
    let mut desk = Desk::open("showcase");
    let ids = desk.ids();
    for size in [SMALL, USUAL] {
        desk.size = size;
        desk.settle();
        let rect = desk.world().resource::<Viewport>().rect;
        for tab in [Tab::Object, Tab::Render, Tab::Debug, Tab::Bvh] {
            desk.world().resource_mut::<Panels>().tab = tab;
            for &id in &ids {
                desk.world().resource_mut::<Selection>().set([id]);
                desk.draw(Vec::new());
                desk.draw(Vec::new());
                let now = desk.world().resource::<Viewport>().rect;
                assert_eq!(now, rect, "{tab:?} of {id:?}");
            }
        }
    }
}

#[test]
fn of_four_thousand_entities_only_the_rows_that_are_seen_are_laid_out() {
    let mut desk = Desk::empty(SMALL);
    for i in 1..=4000_u64 {
        let name = Name::new(format!("Thing {i}"));
        desk.world().spawn((SceneId(i), PointLamp::default(), name));
    }
    desk.settle();
    let outline = desk.world().resource::<Outline>();
    assert_eq!(outline.items.len(), 4000);
    let versions = outline.versions;
    let drawn = desk.world().resource::<Panels>().rows_drawn;
    assert!((20..40).contains(&drawn), "{drawn} rows of 20 points each");
    assert!(desk.find("Thing 1").is_some() && desk.find("Thing 400").is_none());
    for _ in 0..5 {
        desk.frame(Vec::new());
    }
    assert_eq!(desk.world().resource::<Outline>().versions, versions);
}

#[test]
fn a_click_on_a_row_selects_ctrl_adds_and_shift_takes_what_lies_between() {
    let mut desk = Desk::open("cornell-box");
    let names: Vec<String> = {
        let outline = desk.world().resource::<Outline>();
        let items = outline.items.iter();
        items.take(5).map(|item| item.name.clone()).collect()
    };
    let ids: Vec<SceneId> = names.iter().map(|name| desk.named(name).1).collect();
    desk.click_on(&names[1]);
    assert_eq!(desk.world().resource::<Selection>().ids(), [ids[1]]);
    let at = desk.place_of(&names[3]);
    desk.click_with(at, Modifiers::COMMAND | Modifiers::CTRL);
    assert_eq!(desk.world().resource::<Selection>().ids(), [ids[1], ids[3]]);
    desk.click_on(&names[0]);
    let at = desk.place_of(&names[2]);
    desk.click_with(at, Modifiers::SHIFT);
    assert_eq!(desk.world().resource::<Selection>().ids(), &ids[..3]);
}

#[test]
fn a_number_that_is_dragged_changes_its_component_and_no_other_as_one_step() {
    let mut desk = Desk::open("cornell-box");
    let mut lamps = desk
        .world()
        .query_filtered::<(Entity, &SceneId), With<PointLamp>>();
    let (lamp, id) = lamps
        .single(desk.app.world())
        .map(|(e, id)| (e, *id))
        .unwrap();
    desk.select([id]);
    let before = desk.world().get::<PointLamp>(lamp).unwrap().clone();
    let steps = desk
        .world()
        .resource::<crate::editor::history::History>()
        .position();
    let at = desk.place_of("Intensity") + vec2(110.0, 0.0);
    desk.drag(at, vec2(60.0, 0.0));
    let after = desk.world().get::<PointLamp>(lamp).unwrap().clone();
    assert!(after.intensity > before.intensity, "{before:?} {after:?}");
    assert_eq!((after.color, after.cone), (before.color, before.cone));
    let history = desk.world().resource::<crate::editor::history::History>();
    assert_eq!(history.position(), steps + 1);
}

#[test]
fn a_number_that_is_typed_out_of_range_is_brought_into_it_and_words_are_refused() {
    let mut desk = Desk::open("cornell-box");
    desk.world().resource_mut::<Panels>().tab = Tab::Render;
    desk.settle();
    let type_into = |desk: &mut Desk, text: &str| {
        let at = desk.place_of("Mirror depth");
        // The number stands at the right end of the slider.
        let at = Pos2::new(desk.size[0] - 40.0, at.y);
        desk.click(at);
        assert!(desk.context.text_edit_focused());
        assert!(!desk.world().resource::<Viewport>().takes_keys);
        desk.frame(vec![Event::Text(text.into())]);
        desk.key(Key::Enter);
        desk.settle();
        desk.world().resource::<RenderSettings>().max_depth
    };
    assert_eq!(type_into(&mut desk, "12"), 12);
    assert_eq!(type_into(&mut desk, "4000"), 50);
    assert_eq!(type_into(&mut desk, "many"), 50);
    assert!(desk.world().resource::<Viewport>().takes_keys);
}

#[test]
fn menus_send_what_they_say() {
    let mut desk = Desk::open("triangle");
    desk.click_on("File");
    desk.click_on("Save");
    let messages = desk.world().resource::<Messages<Action>>();
    let mut cursor = messages.get_cursor();
    assert!(cursor.read(messages).any(|action| *action == Action::Save));
}

#[test]
fn the_pointer_and_the_keys_are_the_scene_s_only_where_no_panel_wants_them() {
    let mut desk = Desk::open("triangle");
    let hovered = |desk: &mut Desk, at: Pos2| {
        desk.point(at);
        desk.world().resource::<Viewport>().hovered
    };
    let rect = desk.world().resource::<Viewport>().rect;
    assert!(rect.width() > 500.0 && rect.height() > 400.0, "{rect:?}");
    let middle = Pos2::new(rect.center().x, rect.center().y);
    assert!(hovered(&mut desk, middle));
    for at in [
        [20.0, 10.0],
        [100.0, 300.0],
        [1200.0, 300.0],
        [600.0, 714.0],
    ] {
        assert!(!hovered(&mut desk, at.into()), "{at:?}");
    }
    // The divider is the panels', what is beside it the scene's.
    desk.world().resource_mut::<Viewport>().show = Show::Split;
    desk.settle();
    assert!(!hovered(&mut desk, middle));
    assert!(hovered(&mut desk, middle + vec2(30.0, 0.0)));
    desk.drag(middle, vec2(80.0, 0.0));
    let expected = 0.5 + 80.0 / rect.width();
    let divider = desk.world().resource::<Viewport>().divider;
    assert!(
        (divider - expected).abs() < 0.01,
        "{divider}, not {expected}"
    );
    // An open menu has both.
    desk.click_on("View");
    let viewport = desk.world().resource::<Viewport>().clone();
    assert!(!viewport.takes_keys);
    desk.key(Key::Escape);
    desk.settle();
    assert!(desk.world().resource::<Viewport>().takes_keys);
}

#[test]
fn a_dialog_takes_everything_until_escape() {
    let mut desk = Desk::open("triangle");
    desk.world().write_message(Action::ToggleHelp);
    desk.settle();
    assert_eq!(desk.world().resource::<Panels>().dialog, Some(Dialog::Keys));
    assert!(desk.find("Keys and mouse").is_some());
    let viewport = desk.world().resource::<Viewport>().clone();
    assert!(!viewport.takes_keys);
    let middle = Pos2::new(640.0, 360.0);
    desk.point(middle);
    assert!(!desk.world().resource::<Viewport>().hovered);
    desk.key(Key::Escape);
    desk.settle();
    assert_eq!(desk.world().resource::<Panels>().dialog, None);
    assert!(desk.world().resource::<Viewport>().takes_keys);
}

#[test]
fn every_dialog_is_drawn_at_every_size() {
    let mut desk = Desk::open("triangle");
    for size in [SMALL, USUAL, LARGE] {
        desk.size = size;
        for dialog in [
            Dialog::Keys,
            Dialog::About,
            Dialog::Preferences,
            Dialog::History,
            Dialog::Render,
        ] {
            desk.world().resource_mut::<Panels>().dialog = Some(dialog);
            desk.settle();
            assert_eq!(desk.world().resource::<Panels>().dialog, Some(dialog));
        }
    }
}

#[test]
fn unsaved_changes_are_asked_about_and_cancel_leaves_everything() {
    let mut desk = Desk::open("triangle");
    let ids = desk.ids();
    desk.select([ids[0]]);
    desk.world().write_message(Action::Duplicate);
    desk.settle();
    assert_eq!(desk.ids().len(), ids.len() + 1);
    desk.world().write_message(Action::New);
    desk.settle();
    assert!(desk.find("Don't save").is_some());
    desk.click_on("Cancel");
    desk.settle();
    assert!(desk.find("Don't save").is_none());
    assert_eq!(desk.ids().len(), ids.len() + 1);
}

#[test]
fn searching_leaves_what_was_searched_for_and_its_keys_go_nowhere_else() {
    let mut desk = Desk::open("cornell-box");
    let all = desk.world().resource::<Panels>().rows_drawn;
    let hint = desk.place_of("Search");
    desk.click(hint);
    desk.frame(vec![Event::Text("camera".into())]);
    desk.settle();
    assert!(!desk.world().resource::<Viewport>().takes_keys);
    let found = desk.world().resource::<Panels>().rows_drawn;
    assert!(found >= 1 && found < all, "{found} of {all}");
}

#[test]
fn a_message_stays_within_the_picture_and_can_be_closed() {
    let mut desk = Desk::empty(SMALL);
    let text = "the file cannot be written: ".to_owned() + &"very long ".repeat(30);
    desk.world().resource_mut::<Notices>().fault(text.clone());
    desk.settle();
    let rect = desk.world().resource::<Viewport>().rect;
    let at = desk.place_of(&text);
    assert!(rect.contains(Vec2::new(at.x, at.y)), "{at:?} in {rect:?}");
    // The first ✖ is that of the search field.
    let close = desk
        .output
        .shapes
        .iter()
        .filter_map(|clipped| match &clipped.shape {
            Shape::Text(shape) if shape.galley.text() == "✖" => {
                Some(shape.pos + 0.5 * shape.galley.size())
            }
            _ => None,
        });
    let close = close.collect::<Vec<_>>().pop().unwrap();
    desk.click(close);
    assert!(desk.world().resource::<Notices>().is_empty());
}
