//! A thousand random edits, and again and again a fresh app with the same entities: the same
//! world, the same hits.

use super::dice::Dice;
use super::edited::Edited;
use super::*;
use crate::bvh::Ray;
use crate::film;
use crate::scene::RenderSettings;
use crate::sync::{TracedCameras, finish};
use bevy::math::UVec2;

/// Everything that rays read, as text: NaN equals itself there, and -0.0 differs from 0.0.
fn describe(world: &trace::World) -> Vec<String> {
    let mut lines = Vec::new();
    for (object, instance) in world.objects.iter().zip(world.aggregate.instances()) {
        let triangles = object.mesh.tree.triangles();
        lines.push(format!(
            "object {} material {} moving {:?} {} at {:?} {:?} {:?} {:?} {:?}",
            object.id,
            object.material,
            instance.velocity(),
            object.motion_samples,
            instance.world_from_object(),
            triangles.positions(),
            triangles.indices(),
            object.mesh.normals,
            object.mesh.uvs,
        ));
    }
    lines.extend(
        world
            .materials
            .iter()
            .map(|material| format!("{material:?}")),
    );
    lines.extend(world.textures.iter().map(|texture| format!("{texture:?}")));
    lines.push(format!("{:?}", world.lights));
    lines.push(format!("{:?}", world.environment));
    lines.push(format!("{:?}", world.aggregate.options()));
    lines.push(format!("{:?}", world.aggregate.stats()));
    lines
}

fn assert_same(edited: &App, fresh: &App, dice: &mut Dice, edits: usize) -> usize {
    let (a, b) = (world(edited), world(fresh));
    let (lines, others) = (describe(&a), describe(&b));
    for (line, other) in lines.iter().zip(&others) {
        assert_eq!(line, other, "after {edits} edits");
    }
    assert_eq!(lines.len(), others.len(), "after {edits} edits");
    assert_eq!(problems(edited), problems(fresh), "after {edits} edits");
    let cameras = |app: &App| app.world().resource::<TracedCameras>().0.clone();
    assert_eq!(cameras(edited), cameras(fresh), "after {edits} edits");
    let settings = RenderSettings {
        size: UVec2::splat(16),
        spp: 2,
        ..edited.world().resource::<RenderSettings>().clone()
    };
    for camera in cameras(edited) {
        let render = |world| film::render(world, &camera.camera, &settings, &|_, _| {}).picture;
        assert_eq!(
            render(&a),
            render(&b),
            "after {edits} edits, {}",
            camera.name
        );
    }
    let mut hits = 0;
    for _ in 0..1_000 {
        let mut ray = Ray::new(dice.vector() * 8.0, dice.vector());
        ray.time = dice.number().abs();
        let hit = a.aggregate.closest_hit(&ray);
        assert_eq!(
            hit,
            b.aggregate.closest_hit(&ray),
            "after {edits} edits: {ray:?}"
        );
        hits += usize::from(hit.is_some());
    }
    hits
}

#[test]
fn a_thousand_edits_leave_the_same_world_and_hits_as_a_fresh_build() {
    assert_edits_add_up(29, TreeBuilding::AtOnce);
}

#[test]
fn so_do_a_thousand_edits_while_trees_are_being_built() {
    assert_edits_add_up(30, TreeBuilding::InBackground);
}

fn assert_edits_add_up(seed: u64, building: TreeBuilding) {
    let mut edited = Edited::new(seed, building);
    for _ in 0..12 {
        edited.spawn_object();
        edited.spawn_other();
    }
    let (mut hits, mut frames_with_changes) = (0, 0);
    for edits in 1..=1_000 {
        edited.edit();
        // Several edits may fall into one frame.
        if edits % 3 != 0 {
            frames_with_changes += usize::from(frame(&mut edited.app).any());
        }
        if edits % 25 == 0 {
            finish(&mut edited.app);
            assert_eq!(edited.app.world().resource::<Traced>().pending, 0);
            let fresh = edited.fresh();
            hits += assert_same(&edited.app, &fresh, &mut edited.dice, edits);
        }
    }
    // The test tests nothing where nothing is there, or nothing happens.
    assert!(hits > 2_000, "only {hits} of 40,000 rays hit anything");
    assert!(
        // Behind trees that are being built changes wait, and come together: on a busy machine most of them.
        frames_with_changes > 30,
        "only {frames_with_changes} frames changed anything"
    );
}
