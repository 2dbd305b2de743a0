//! What is typed into number fields.

use super::super::inspector::{Inspector, Tab};
use super::desk::Desk;
use crate::editor::history::{History, undo};
use crate::scene::{
    Cone, DirectionalLamp, Environment, Lens, MeshSource, Motion, ParallelogramLamp, Phong,
    PointLamp, Projection, RenderSettings, SceneCamera, SceneId, SegmentLamp, Shape,
    range_problems,
};
use bevy::ecs::component::Component;
use bevy::ecs::entity::Entity;
use bevy::ecs::name::Name;
use bevy::ecs::query::With;
use bevy::ecs::world::World;
use bevy::reflect::PartialReflect;
use bevy::transform::components::Transform;
use bevy_egui::egui::accesskit::Role;
use bevy_egui::egui::{Event, Key, Pos2};
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

    fn type_at(&mut self, at: Pos2, text: &str) {
        self.click(at);
        if self.context.text_edit_focused() {
            self.key(Key::Delete);
            self.frame(vec![Event::Text(text.into())]);
            self.key(Key::Enter);
        }
        self.settle();
    }
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
    while desk.world().resource::<History>().position() > 0 {
        undo(desk.world());
        desk.settle();
    }
    assert_eq!(numbers(desk.world()), before);
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
