//! What is typed into number fields.

use super::super::dialogs::{Dialog, Dialogs, RenderForm};
use super::super::inspector::{Inspector, Tab};
use super::desk::{Desk, bounds};
use crate::editor::action::Action;
use crate::editor::history::{History, undo};
use crate::editor::inspection::choice::Side;
use crate::editor::inspection::debug_ray::Shot;
use crate::editor::inspection::{DebugRay, Inspected};
use crate::editor::preferences::Preferences;
use crate::inspect::InspectSettings;
use crate::scene::{
    Cone, DirectionalLamp, Environment, Lens, MeshSource, Motion, ParallelogramLamp, Phong,
    PointLamp, Projection, RenderSettings, SceneCamera, SceneId, SegmentLamp, Shape,
    range_problems,
};
use crate::sync::TracedCameras;
use crate::view::ViewSettings;
use bevy::ecs::component::Component;
use bevy::ecs::entity::Entity;
use bevy::ecs::name::Name;
use bevy::ecs::query::With;
use bevy::ecs::world::World;
use bevy::math::UVec2;
use bevy::reflect::PartialReflect;
use bevy::transform::components::Transform;
use bevy_egui::egui::accesskit::Role;
use bevy_egui::egui::{self, Event, Key, Modifiers, PointerButton, Pos2, RawInput, Rect, Ui, vec2};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

/// What no field should take as it is, and some that most should.
const NONSENSE: [&str; 20] = [
    "",
    "many",
    "10cc",
    "2*",
    "(",
    "1..2",
    "+=",
    "1e999",
    "-1e999",
    "inf",
    "-inf",
    "NaN",
    "0/0",
    "1e30",
    "-1e30",
    "-1",
    "0",
    "99999999999",
    "0x10",
    "*=1e300",
];

impl Desk {
    fn number_fields(&self) -> Vec<Pos2> {
        self.controls(Role::SpinButton)
    }

    pub fn type_at(&mut self, at: Pos2, text: &str) {
        self.click(at);
        if self.context.text_edit_focused() {
            self.key(Key::Delete);
            self.frame(vec![Event::Text(text.into())]);
            self.key(Key::Enter);
        }
        self.settle();
    }
}

/// Types all of it into every number field of a piece of a panel, and has looked after each what came of it. Returns how
/// many fields there are.
pub fn type_nonsense<S>(
    state: &mut S,
    piece: impl Fn(&mut Ui, &mut S),
    check: impl Fn(&S, &str),
) -> usize {
    let context = egui::Context::default();
    context.enable_accesskit();
    let mut time = 0.0;
    let mut frame = |state: &mut S, events: Vec<Event>| {
        // Slow enough that no two clicks are a double click.
        time += 0.5;
        let size = vec2(800.0, 600.0);
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, size)),
            time: Some(time),
            events,
            ..RawInput::default()
        };
        let output = context.run_ui(input, |ui| piece(ui, state));
        bounds(&output, Role::SpinButton)
    };
    frame(state, Vec::new());
    let count = frame(state, Vec::new()).len();
    for field in 0..count {
        for text in NONSENSE {
            let at = frame(state, Vec::new())[field].center();
            let button = |pressed| Event::PointerButton {
                pos: at,
                button: PointerButton::Primary,
                pressed,
                modifiers: Modifiers::NONE,
            };
            let key = |key| Event::Key {
                key,
                physical_key: None,
                pressed: true,
                repeat: false,
                modifiers: Modifiers::NONE,
            };
            for event in [
                Event::PointerMoved(at),
                button(true),
                button(false),
                key(Key::Delete),
                Event::Text(text.into()),
                key(Key::Enter),
            ] {
                frame(state, vec![event]);
            }
            frame(state, Vec::new());
            check(state, text);
        }
    }
    count
}

/// Everything that is kept and has numbers, of all entities.
fn numbers(world: &mut World) -> Vec<String> {
    fn note<C: Component + std::fmt::Debug>(world: &World, entity: Entity, all: &mut Vec<String>) {
        all.extend(
            world
                .get::<C>(entity)
                .map(|component| format!("{component:?}")),
        );
    }
    let mut entities = world.query_filtered::<Entity, With<SceneId>>();
    let entities: Vec<Entity> = entities.iter(world).collect();
    let mut all = vec![
        format!("{:?}", world.resource::<RenderSettings>()),
        format!("{:?}", world.resource::<Environment>()),
    ];
    for entity in entities {
        note::<Transform>(world, entity, &mut all);
        note::<PointLamp>(world, entity, &mut all);
        note::<DirectionalLamp>(world, entity, &mut all);
        note::<SegmentLamp>(world, entity, &mut all);
        note::<ParallelogramLamp>(world, entity, &mut all);
        note::<SceneCamera>(world, entity, &mut all);
        note::<Lens>(world, entity, &mut all);
        note::<Motion>(world, entity, &mut all);
        note::<Phong>(world, entity, &mut all);
        note::<MeshSource>(world, entity, &mut all);
    }
    all
}

/// What is out of range anywhere.
fn problems(world: &mut World) -> Vec<String> {
    fn check<C: Component + PartialReflect>(world: &World, entity: Entity, all: &mut Vec<String>) {
        let found = world
            .get::<C>(entity)
            .map(|component| range_problems(component));
        all.extend(
            found
                .into_iter()
                .flatten()
                .map(|problem| problem.to_string()),
        );
    }
    let mut entities = world.query_filtered::<Entity, With<SceneId>>();
    let entities: Vec<Entity> = entities.iter(world).collect();
    let mut all: Vec<String> = range_problems(world.resource::<RenderSettings>())
        .iter()
        .chain(&range_problems(world.resource::<Environment>()))
        .map(ToString::to_string)
        .collect();
    for entity in entities {
        check::<Transform>(world, entity, &mut all);
        check::<PointLamp>(world, entity, &mut all);
        check::<DirectionalLamp>(world, entity, &mut all);
        check::<SegmentLamp>(world, entity, &mut all);
        check::<ParallelogramLamp>(world, entity, &mut all);
        check::<SceneCamera>(world, entity, &mut all);
        check::<Lens>(world, entity, &mut all);
        check::<Motion>(world, entity, &mut all);
        check::<Phong>(world, entity, &mut all);
        check::<MeshSource>(world, entity, &mut all);
    }
    all
}

/// A window high enough for every field, and one entity of every kind.
fn desk_of_everything() -> (Desk, Vec<SceneId>) {
    let mut desk = Desk::empty([1280.0, 2600.0, 1.0]);
    desk.context.enable_accesskit();
    let world = desk.world();
    let spot = PointLamp {
        cone: Some(Cone::default()),
        ..PointLamp::default()
    };
    let flat = SceneCamera {
        projection: Projection::Orthographic { height: 2.0 },
        ..SceneCamera::default()
    };
    let knot = Shape::Knot {
        p: 2,
        q: 3,
        tube_radius: 0.2,
        displacement: 0.1,
        segments: 16,
        sides: 6,
    };
    let lens = (Lens::default(), Motion::default());
    world.spawn((Name::new("spot"), SceneId(1), spot, Motion::default()));
    world.spawn((Name::new("sun"), SceneId(2), DirectionalLamp::default()));
    world.spawn((Name::new("line"), SceneId(3), SegmentLamp::default()));
    world.spawn((Name::new("area"), SceneId(4), ParallelogramLamp::default()));
    world.spawn((
        Name::new("camera"),
        SceneId(5),
        SceneCamera::default(),
        lens,
    ));
    world.spawn((Name::new("flat"), SceneId(6), flat));
    world.spawn((Name::new("knot"), SceneId(7), MeshSource::Shape(knot)));
    world.spawn((Name::new("block"), SceneId(8), MeshSource::default()));
    desk.settle();
    crate::editor::history::reset(desk.world());
    (desk, (1..=8).map(SceneId).collect())
}

#[test]
fn nothing_wrong_that_is_typed_anywhere_applies_and_undo_restores_everything() {
    let (mut desk, ids) = desk_of_everything();
    let before = numbers(desk.world());
    let mut runner = TestRunner::deterministic();
    let texts = proptest::sample::select(NONSENSE.to_vec());
    let mut fields_seen = 0;
    let pages = ids.iter().map(|&id| (Tab::Object, vec![id])).chain([
        (Tab::Object, vec![ids[4], ids[5]]),
        (Tab::Render, Vec::new()),
        (Tab::Bvh, Vec::new()),
        (Tab::Debug, Vec::new()),
    ]);
    for (tab, selected) in pages {
        desk.world().resource_mut::<Inspector>().tab = tab;
        desk.select(selected.clone());
        let fields = desk.number_fields();
        fields_seen += fields.len();
        for at in fields {
            for _ in 0..2 {
                let text = texts.new_tree(&mut runner).unwrap().current();
                desk.type_at(at, text);
                let wrong = problems(desk.world());
                let place = format!("{selected:?} {:?} at {at:?}: `{text}`", tab as u8);
                assert_eq!(wrong, Vec::<String>::new(), "{place}");
            }
        }
    }
    assert!(fields_seen > 80, "only {fields_seen} fields were found");
    undo_everything(&mut desk);
    assert_eq!(numbers(desk.world()), before);
}

fn undo_everything(desk: &mut Desk) {
    while desk.world().resource::<History>().position() > 0 {
        undo(desk.world());
        desk.settle();
    }
}

/// What of the panels' own numbers is out of range, or is none: of what is drawn, of the preferences, of the mix, of the
/// picture that is to be rendered.
fn problems_of_panels(desk: &mut Desk) -> Vec<String> {
    let world = desk.world();
    let inspect = range_problems(world.resource::<InspectSettings>());
    let mut all: Vec<String> = inspect.iter().map(ToString::to_string).collect();
    let preferences = world.resource::<Preferences>();
    if !(0.5..=3.0).contains(&preferences.zoom) || !(1..=8).contains(&preferences.pixel_size) {
        all.push(format!("{preferences:?}"));
    }
    let form = world.resource::<RenderForm>();
    let settings = form.settings(world.resource::<RenderSettings>());
    all.extend(range_problems(&settings).iter().map(ToString::to_string));
    let speed = world.resource::<Inspected>().stepper.speed;
    if !(speed > 0.0 && speed.is_finite()) {
        all.push(format!("{speed} steps a second"));
    }
    let mut views = world.query::<&ViewSettings>();
    let mixes = views.iter(world).map(|view| format!("{:?}", view.mix));
    all.extend(mixes.filter(|mix| mix.contains("inf") || mix.contains("NaN")));
    all
}

#[test]
fn nothing_wrong_that_is_typed_beside_the_inspector_applies_and_the_scene_stays_as_it_is() {
    let mut desk = Desk::with_trees("cornell-box");
    desk.size = [1280.0, 1400.0, 1.0];
    desk.context.enable_accesskit();
    desk.world().resource_mut::<Preferences>().show_inspector = false;
    let camera = desk.world().resource::<TracedCameras>().0[0].camera.clone();
    let (pixel, size) = (UVec2::new(300, 400), UVec2::new(600, 480));
    desk.world().resource_mut::<DebugRay>().shoot(Shot {
        pixel,
        camera,
        size,
    });
    desk.settle();
    let before = numbers(desk.world());
    let mut runner = TestRunner::deterministic();
    let texts = proptest::sample::select(NONSENSE.to_vec());
    let mut fields_seen = 0;
    let rays = |side| {
        move |desk: &mut Desk| {
            desk.world().resource_mut::<Preferences>().show_rays = true;
            let mut inspected = desk.world().resource_mut::<Inspected>();
            inspected.choose_ray(Some(0), false);
            inspected.side = side;
        }
    };
    let dialog = |dialog| {
        move |desk: &mut Desk| {
            desk.world().resource_mut::<Preferences>().show_rays = false;
            desk.world().resource_mut::<Dialogs>().open = Some(dialog);
        }
    };
    let mixer = |desk: &mut Desk| {
        desk.world().resource_mut::<Preferences>().show_rays = false;
        desk.world().write_message(Action::run("lights.mixer"));
    };
    type Page<'a> = (&'a str, Box<dyn Fn(&mut Desk)>);
    let pages: [Page; 5] = [
        ("rays", Box::new(rays(Side::Why))),
        ("steps", Box::new(rays(Side::Steps))),
        ("mixer", Box::new(mixer)),
        ("preferences", Box::new(dialog(Dialog::Preferences))),
        ("render", Box::new(dialog(Dialog::Render))),
    ];
    for (page, open) in pages {
        open(&mut desk);
        desk.settle();
        let count = desk.number_fields().len();
        fields_seen += count;
        for field in 0..count {
            for _ in 0..6 {
                let text = texts.new_tree(&mut runner).unwrap().current();
                // Where the fields are now: what was typed may have moved them.
                let Some(&at) = desk.number_fields().get(field) else {
                    continue;
                };
                desk.type_at(at, text);
                let mut wrong = problems_of_panels(&mut desk);
                wrong.extend(problems(desk.world()));
                assert_eq!(
                    wrong,
                    Vec::<String>::new(),
                    "{page}, field {field}: `{text}`"
                );
            }
            desk.world().resource_mut::<Preferences>().zoom = 1.0;
            desk.settle();
        }
        // Above the view there is the scene's exposure.
        undo_everything(&mut desk);
        assert_eq!(numbers(desk.world()), before, "{page}");
    }
    assert!(fields_seen >= 14, "only {fields_seen} fields were found");
}

#[test]
fn what_cannot_be_read_leaves_the_number_and_can_be_mended_where_it_was_typed() {
    let (mut desk, ids) = desk_of_everything();
    desk.select([ids[0]]);
    let field = desk.control_beside("Position", Role::SpinButton);
    let place = |desk: &mut Desk| {
        let (entity, _) = desk.named("spot");
        desk.world().get::<Transform>(entity).unwrap().translation.x
    };
    for (text, x) in [
        ("10cm", 0.1),
        ("+=.1", 0.2),
        ("2*3", 6.0),
        ("0,5", 0.5),
        ("0.1/2", 0.05),
    ] {
        desk.type_at(field, text);
        let found = place(&mut desk);
        assert!((found - x).abs() < 1e-6, "`{text}` gives {found}");
    }
    let steps = desk.world().resource::<History>().position();
    desk.type_at(field, "10cc");
    assert!((place(&mut desk) - 0.05).abs() < 1e-6);
    assert_eq!(desk.world().resource::<History>().position(), steps);
    desk.click(field);
    desk.key(Key::End);
    desk.key(Key::Backspace);
    desk.frame(vec![Event::Text("m".into())]);
    desk.key(Key::Enter);
    desk.settle();
    assert!((place(&mut desk) - 0.1).abs() < 1e-6, "10cm");
}

#[test]
fn what_is_typed_for_one_object_does_not_reach_another_that_is_selected_meanwhile() {
    let (mut desk, ids) = desk_of_everything();
    desk.select([ids[0]]);
    let field = desk.control_beside("Position", Role::SpinButton);
    desk.click(field);
    desk.frame(vec![Event::Text("7".into())]);
    desk.select([ids[1]]);
    desk.key(Key::Enter);
    desk.settle();
    let (sun, _) = desk.named("sun");
    assert_eq!(
        desk.world().get::<Transform>(sun).unwrap().translation.x,
        0.0
    );
}

#[test]
fn what_is_entered_for_several_reaches_those_that_have_it_and_changes_nothing_else() {
    let (mut desk, ids) = desk_of_everything();
    // The active one is selected last.
    desk.select([ids[5], ids[4]]);
    let at = desk.control_beside("Field of view", Role::SpinButton);
    desk.type_at(at, "30");
    let at = desk.control_beside("Shutter opens", Role::SpinButton);
    desk.type_at(at, "0.25");
    let cameras = ["camera", "flat"].map(|name| {
        let (entity, _) = desk.named(name);
        desk.world().get::<SceneCamera>(entity).unwrap().clone()
    });
    let fov_y = 30_f32.to_radians();
    assert_eq!(cameras[0].projection, Projection::Perspective { fov_y });
    assert_eq!(
        cameras[1].projection,
        Projection::Orthographic { height: 2.0 }
    );
    assert_eq!(cameras.map(|camera| camera.shutter_open), [0.25; 2]);
}
