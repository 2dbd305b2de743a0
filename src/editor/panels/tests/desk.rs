//! An editor without a window, and a hand.

use super::super::outline::{Outline, outline_scene};
use super::super::{add_panels, panels_ui};
use crate::editor::headless_editor;
use crate::editor::inspection::RaysPlugin;
use crate::editor::plugins::StatePlugin;
use crate::editor::preferences::Preferences;
use crate::editor::render_job::{RenderFrom, RenderRequest, start_render};
use crate::editor::selection::Selection;
use crate::editor::trees::TreeStudyPlugin;
use crate::editor::viewport::EditorCamera;
use crate::io::builtin;
use crate::io::{OpenOptions, SceneSource, open};
use crate::scene::{Environment, RenderSettings, SceneId};
use crate::view::TracedView;
use bevy::app::{App, Last, Plugin};
use bevy::ecs::change_detection::DetectChanges;
use bevy::ecs::entity::Entity;
use bevy::ecs::name::Name;
use bevy::ecs::query::With;
use bevy::ecs::world::World;
use bevy_egui::egui::accesskit::{self, Role};
use bevy_egui::egui::{self, Event, FullOutput, Key, Modifiers, PointerButton, Pos2, Shape, vec2};
use std::path::PathBuf;

/// Windows that must do: the smallest, the usual one, and 4K at twice the scale.
pub const SMALL: [f32; 3] = [1024.0, 640.0, 1.0];
pub const USUAL: [f32; 3] = [1280.0, 720.0, 1.0];
pub const LARGE: [f32; 3] = [1920.0, 1080.0, 2.0];

/// Whether something with this middle stands in the row of that height.
fn is_in_row(at: Pos2, row: f32) -> bool {
    (at.y - row).abs() < 6.0
}

/// Where all controls of a kind are that a frame told screen readers of.
pub fn bounds(output: &FullOutput, role: Role) -> Vec<egui::Rect> {
    let update = output.platform_output.accesskit_update.as_ref();
    let nodes = update.map_or(&[][..], |update| &update.nodes);
    let controls = nodes.iter().filter(|(_, node)| node.role() == role);
    controls.filter_map(|(_, node)| bounds_of(node)).collect()
}

/// Where a control is.
pub fn bounds_of(node: &accesskit::Node) -> Option<egui::Rect> {
    let bounds = node.bounds()?;
    let [x0, y0, x1, y1] = [bounds.x0, bounds.y0, bounds.x1, bounds.y1].map(|side| side as f32);
    Some(egui::Rect::from_x_y_ranges(x0..=x1, y0..=y1))
}

/// An editor without a window.
pub struct Desk {
    pub app: App,
    pub context: egui::Context,
    pub size: [f32; 3],
    time: f64,
    pub output: FullOutput,
}

impl Desk {
    pub fn open(scene: &str) -> Self {
        let mut desk = Self::empty(USUAL);
        let source = SceneSource::Builtin(builtin::find(scene).unwrap());
        open(desk.app.world_mut(), &source, OpenOptions::default()).unwrap();
        desk.settle();
        desk
    }

    pub fn empty(size: [f32; 3]) -> Self {
        let mut app = headless_editor();
        // The app is finished already, and takes no more plugins by itself.
        RaysPlugin.build(&mut app);
        TreeStudyPlugin.build(&mut app);
        StatePlugin.build(&mut app);
        app.insert_resource(Preferences {
            hint_seen: true,
            ..Preferences::default()
        })
        .init_resource::<Outline>()
        .add_systems(Last, outline_scene);
        add_panels(&mut app);
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
    pub fn draw(&mut self, events: Vec<Event>) {
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
        self.places(text).next()
    }

    /// The same of all texts that are equal.
    pub fn places<'a>(&'a self, text: &'a str) -> impl Iterator<Item = Pos2> + 'a {
        fn search(shape: &Shape, text: &str) -> Option<Pos2> {
            match shape {
                Shape::Text(shape) if shape.galley.text() == text => {
                    Some(shape.pos + 0.5 * shape.galley.size())
                }
                Shape::Vec(shapes) => shapes.iter().find_map(|shape| search(shape, text)),
                _ => None,
            }
        }
        self.output.shapes.iter().filter_map(move |clipped| {
            let at = search(&clipped.shape, text)?;
            clipped.clip_rect.contains(at).then_some(at)
        })
    }

    pub fn place_of(&self, text: &str) -> Pos2 {
        let place = self.find(text);
        place.unwrap_or_else(|| panic!("`{text}` is nowhere on the screen"))
    }

    /// The text in the row of a label: others like it may stand elsewhere.
    pub fn place_beside(&self, label: &str, text: &str) -> Pos2 {
        let row = self.place_of(label).y;
        let place = self.places(text).find(|at| is_in_row(*at, row));
        place.unwrap_or_else(|| panic!("`{text}` is not beside `{label}`"))
    }

    /// Where all controls of a kind are on the screen. The context has to speak to screen readers.
    pub fn bounds(&self, role: Role) -> Vec<egui::Rect> {
        bounds(&self.output, role)
    }

    /// The middles of all controls of a kind.
    pub fn controls(&self, role: Role) -> Vec<Pos2> {
        let bounds = self.bounds(role).into_iter();
        bounds.map(|bounds| bounds.center()).collect()
    }

    /// The first control of a kind in the row of a label.
    pub fn control_beside(&self, label: &str, role: Role) -> Pos2 {
        let at = self.place_of(label);
        let mut controls = self.controls(role).into_iter();
        let control = controls.find(|control| is_in_row(*control, at.y) && control.x > at.x);
        control.unwrap_or_else(|| panic!("there is no {role:?} beside `{label}`"))
    }

    pub fn point(&mut self, at: Pos2) {
        self.frame(vec![Event::PointerMoved(at)]);
    }

    /// Time goes by without a frame.
    pub fn wait(&mut self, seconds: f64) {
        self.time += seconds;
    }

    pub fn button(&mut self, at: Pos2, pressed: bool, modifiers: Modifiers) {
        let event = Event::PointerButton {
            pos: at,
            button: PointerButton::Primary,
            pressed,
            modifiers,
        };
        self.frame(vec![event]);
    }

    pub fn click_with(&mut self, at: Pos2, modifiers: Modifiers) {
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

    pub fn key(&mut self, key: Key) {
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

    /// To a file, with more samples than any test waits for.
    pub fn begin_endless_render(&mut self, file: PathBuf) {
        let request = RenderRequest {
            file,
            camera: RenderFrom::FirstCamera,
            settings: RenderSettings {
                spp: 1 << 20,
                ..RenderSettings::default()
            },
        };
        start_render(self.world(), request).unwrap();
    }

    pub fn named(&mut self, name: &str) -> (Entity, SceneId) {
        let mut query = self.world().query::<(Entity, &SceneId, &Name)>();
        let found = query
            .iter(self.app.world())
            .find(|(_, _, other)| other.as_str() == name)
            .map(|(entity, id, _)| (entity, *id));
        found.unwrap_or_else(|| panic!("no entity is called {name}"))
    }

    pub fn select(&mut self, ids: impl IntoIterator<Item = SceneId>) {
        self.world().resource_mut::<Selection>().set(ids);
        self.settle();
    }

    pub fn ids(&mut self) -> Vec<SceneId> {
        let mut query = self.world().query::<&SceneId>();
        let mut ids: Vec<SceneId> = query.iter(self.app.world()).copied().collect();
        ids.sort_unstable();
        ids
    }

    /// Components of the scene, and its resources, that count as changed since `clear_trackers`.
    pub fn changed(&mut self) -> Vec<String> {
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
