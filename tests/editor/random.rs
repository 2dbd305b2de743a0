//! A thousand random edits, with undo and redo between them.

use super::scene_copy::{SceneCopy, traced};
use super::{act, editor, history};
use bevy::app::App;
use bevy::color::LinearRgba;
use bevy::math::{Quat, Vec3};
use bevy::prelude::{Entity, Transform};
use glassbox::editor::Action;
use glassbox::editor::action::{Addition, shapes};
use glassbox::editor::edits::scene_entity;
use glassbox::editor::history::{Gesture, go_to};
use glassbox::scene::{
    Builder, Environment, Lens, Motion, Phong, PointLamp, RenderSettings, SceneId, TextureSource,
    UsesMaterial,
};
use proptest::prelude::*;

/// Beyond this many entities something is deleted, so that the scene stays one that is quick to trace.
const MOST: usize = 40;

/// One edit: which, at which entities, with which numbers.
type Edit = (u8, usize, usize, [f32; 3]);

fn ids(app: &mut App) -> Vec<SceneId> {
    let world = app.world_mut();
    let mut ids: Vec<SceneId> = world.query::<&SceneId>().iter(world).copied().collect();
    ids.sort_unstable();
    ids
}

fn edit(app: &mut App, (kind, a, b, numbers): Edit) {
    let ids = ids(app);
    let pick = |n: usize| (!ids.is_empty()).then(|| ids[n % ids.len()]);
    let (Some(id), Some(other)) = (pick(a), pick(b)) else {
        act(app, Action::Add(Addition::Shape("Cuboid".into())));
        return;
    };
    let entity = scene_entity(app.world(), id).unwrap();
    let other_entity = scene_entity(app.world(), other).unwrap();
    let vector = Vec3::from_array(numbers);
    let color = LinearRgba::rgb(vector.x.abs(), vector.y.abs(), vector.z.abs());
    if ids.len() > MOST {
        act(app, Action::Select(ids[..MOST / 2].to_vec()));
        act(app, Action::run("edit.delete"));
        return;
    }
    match kind % 24 {
        0 => {
            let all = shapes();
            // Not the large ones: the test is about edits.
            let name = all[a % 8].0;
            act(app, Action::Add(Addition::Shape(name.into())));
        }
        1 => {
            let what = [
                Addition::PointLamp,
                Addition::DirectionalLamp,
                Addition::SegmentLamp,
                Addition::ParallelogramLamp,
                Addition::Camera,
                Addition::Group,
                Addition::Material,
            ];
            act(app, Action::Add(what[b % what.len()].clone()));
        }
        2 => {
            act(app, Action::Select(vec![id]));
            act(app, Action::run("edit.delete"));
        }
        3 => {
            act(app, Action::Select(vec![id, other]));
            act(app, Action::run("edit.duplicate"));
        }
        4 => {
            act(app, Action::Select(vec![id, other]));
            act(app, Action::run("edit.copy"));
        }
        5 => act(app, Action::run("edit.paste")),
        6 => act(app, Action::Reparent(vec![id], Some(other))),
        7 => act(app, Action::Reparent(vec![id, other], None)),
        8 => {
            act(app, Action::Select(vec![id, other]));
            act(app, Action::run("edit.hide"));
        }
        9 => act(app, Action::Rename(id, format!("{:.1}", vector.x))),
        10..=12 => {
            app.world_mut().resource_mut::<Gesture>().begin("Drag");
            for _ in 0..3 {
                if let Some(mut place) = app.world_mut().get_mut::<Transform>(entity) {
                    place.translation += vector;
                    place.rotation = Quat::from_scaled_axis(vector);
                    // Flat and mirrored ones too.
                    place.scale.y = if kind > 128 { vector.y.round() } else { 1.0 };
                }
                app.update();
            }
            app.world_mut().resource_mut::<Gesture>().end();
        }
        13 | 14 => {
            if let Some(mut phong) = app.world_mut().get_mut::<Phong>(entity) {
                phong.diffuse = color;
                phong.diffuse_map = (kind > 128)
                    .then(|| TextureSource::new(["builtin:checker", "builtin:uv"][b % 2]));
            }
        }
        15 => {
            if let Some(mut lamp) = app.world_mut().get_mut::<PointLamp>(entity) {
                lamp.color = color;
            }
        }
        16 => toggle(app, entity, UsesMaterial(other_entity)),
        17 => toggle(app, entity, Lens::default()),
        18 => toggle(
            app,
            entity,
            Motion {
                velocity: vector,
                samples: 2,
            },
        ),
        19 => {
            // Behind the back of the edits.
            app.world_mut().despawn(entity);
        }
        20 => {
            let mut settings = app.world_mut().resource_mut::<RenderSettings>();
            settings.tree.builder = [Builder::Median, Builder::Sah, Builder::Ploc][b % 3];
            settings.output.exposure = vector.x;
        }
        21 => app.world_mut().resource_mut::<Environment>().background = color,
        22 => {
            for _ in 0..=a % 4 {
                act(app, Action::run("edit.undo"));
            }
        }
        _ => {
            for _ in 0..=a % 4 {
                act(app, Action::run("edit.redo"));
            }
        }
    }
    app.update();
}

fn toggle<C: bevy::prelude::Component>(app: &mut App, entity: Entity, component: C) {
    let mut entity = app.world_mut().entity_mut(entity);
    if entity.contains::<C>() {
        entity.remove::<C>();
    } else {
        entity.insert(component);
    }
}

fn assert_fresh(app: &mut App, when: &str) -> SceneCopy {
    app.update();
    app.update();
    let copy = SceneCopy::of(app);
    let mut fresh = copy.spawn();
    fresh.update();
    copy.assert_same(&SceneCopy::of(&mut fresh), when);
    assert_eq!(traced(app), traced(&fresh), "{when}");
    copy
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 3,
        max_shrink_iters: 60,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn a_thousand_edits_trace_as_a_fresh_scene_does_and_undo_to_the_first(
        edits in prop::collection::vec(
            (any::<u8>(), any::<usize>(), any::<usize>(), prop::array::uniform3(-1.0_f32..1.0)),
            1_000,
        )
    ) {
        let mut app = editor("cornell-box");
        let first = SceneCopy::of(&mut app);
        for (i, one) in edits.into_iter().enumerate() {
            edit(&mut app, one);
            if i % 100 == 99 {
                assert_fresh(&mut app, &format!("after edit {i}"));
            }
        }
        let last = assert_fresh(&mut app, "at the end");
        let position = history(&app).position();
        prop_assert!(position > 100, "only {position} steps");
        go_to(app.world_mut(), 0);
        assert_fresh(&mut app, "all undone").assert_same(&first, "all undone");
        go_to(app.world_mut(), position);
        assert_fresh(&mut app, "all redone").assert_same(&last, "all redone");
    }
}
