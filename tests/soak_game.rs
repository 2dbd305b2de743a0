//! Games of Bevy's own components: what one that spawns, despawns and edits in every frame allocates is
//! given back, and one that stands still allocates nothing.

use crate::{ALONE, allocations, bytes_at_rest};
use bevy::asset::Assets;
use bevy::ecs::entity::Entity;
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::mesh::{Mesh, Mesh3d, VertexAttributeValues};
use bevy::pbr::{MeshMaterial3d, StandardMaterial};
use bevy::prelude::{App, Cuboid, Mat4, Name, PointLight, Sphere, Transform, Vec3, World};
use glassbox::app::headless_app_with;
use glassbox::sync::{Traced, TreeBuilding, finish};
use glassbox::view::StandardMappingPlugin;
use std::collections::VecDeque;
use std::sync::PoisonError;

/// What may be left after three times [`FRAMES`]: a leak of 22 bytes a frame is found, which is less than anything that comes
/// and goes takes. Below it are the queues of threads, of which several may just have their next size.
const TOLERANCE: isize = 64 << 10;
/// Until lists and the threads' scratch memory have grown to their size.
const WARM_UP: usize = 500;
const FRAMES: usize = 1000;

struct Soaked {
    app: App,
    /// The oldest first.
    spawned: VecDeque<Entity>,
    joint: Entity,
    edited: Entity,
}

impl Soaked {
    fn new() -> Self {
        let mut app = headless_app_with(StandardMappingPlugin);
        app.insert_resource(TreeBuilding::InBackground);
        let world = app.world_mut();
        let joint = spawn_skin(world);
        let mut meshes = world.resource_mut::<Assets<Mesh>>();
        let edited = meshes.add(Cuboid::default());
        let edited = world.spawn((Mesh3d(edited), Transform::default())).id();
        Self {
            app,
            spawned: VecDeque::new(),
            joint,
            edited,
        }
    }

    fn frame(&mut self, i: usize) {
        let world = self.app.world_mut();
        let mesh = match i % 2 {
            0 => Mesh::from(Sphere::new(0.5)),
            _ => Mesh::from(Cuboid::default()),
        };
        let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
        let material = StandardMaterial {
            metallic: (i % 7) as f32 / 7.0,
            ..StandardMaterial::default()
        };
        let material = world
            .resource_mut::<Assets<StandardMaterial>>()
            .add(material);
        let place = Transform::from_xyz((i % 10) as f32, 0.0, 0.0);
        let object = (
            Mesh3d(mesh),
            MeshMaterial3d(material),
            place,
            Name::new("one of many"),
        );
        let object = world.spawn(object).id();
        let lamp = world.spawn((PointLight::default(), place)).id();
        self.spawned.extend([object, lamp]);
        while self.spawned.len() > 40 {
            if let Some(oldest) = self.spawned.pop_front() {
                world.despawn(oldest);
            }
        }
        let wobble = 0.1 * (i % 10) as f32;
        if let Some(mut place) = world.get_mut::<Transform>(self.joint) {
            place.translation = Vec3::Y * wobble;
        }
        let handle = world.get::<Mesh3d>(self.edited).map(|mesh| mesh.0.clone());
        let other = Mesh::from(Cuboid::new(1.0, 1.0 + wobble, 1.0));
        if let Some(handle) = handle {
            let mut meshes = world.resource_mut::<Assets<Mesh>>();
            meshes.insert(handle.id(), other).expect("it is used");
        }
        self.app.update();
        if i.is_multiple_of(8) {
            // Frames without a picture come so fast that nothing would be traced before it is gone.
            finish(&mut self.app);
        }
    }

    /// Bytes that are allocated when all has come to rest.
    fn at_rest(&mut self) -> isize {
        finish(&mut self.app);
        bytes_at_rest()
    }
}

/// An object that hangs on a joint, which is given back.
fn spawn_skin(world: &mut World) -> Entity {
    let mesh = Mesh::from(Cuboid::default());
    let count = mesh.count_vertices();
    let joints = VertexAttributeValues::Uint16x4(vec![[0; 4]; count]);
    let skinned = mesh
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, joints)
        .with_inserted_attribute(
            Mesh::ATTRIBUTE_JOINT_WEIGHT,
            vec![[1.0, 0.0, 0.0, 0.0]; count],
        );
    let skinned = world.resource_mut::<Assets<Mesh>>().add(skinned);
    let mut poses = world.resource_mut::<Assets<SkinnedMeshInverseBindposes>>();
    let inverse_bindposes = poses.add(vec![Mat4::IDENTITY]);
    let joint = world.spawn(Transform::default()).id();
    let skin = SkinnedMesh {
        inverse_bindposes,
        joints: vec![joint],
    };
    world.spawn((Mesh3d(skinned), Transform::default(), skin));
    joint
}

#[test]
fn skinned_meshes_that_stand_still_allocate_nothing() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let in_a_frame = |skins: usize| {
        let mut app = headless_app_with(StandardMappingPlugin);
        for _ in 0..skins {
            spawn_skin(app.world_mut());
        }
        for _ in 0..5 {
            app.update();
        }
        // Bevy's scheduler has some of its own, now more and now fewer.
        let frames = (0..10).map(|_| allocations(|| app.update()));
        frames.min().unwrap_or_default()
    };
    let (one, many) = (in_a_frame(1), in_a_frame(101));
    // Far from one a skin.
    assert!(
        many < one + 50,
        "{one} allocations with one, {many} with 101"
    );
}

#[test]
fn a_game_that_spawns_despawns_and_edits_in_every_frame_leaves_no_memory_behind() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut soaked = Soaked::new();
    let mut frames = 0..;
    let mut lap = |count: usize| {
        for i in frames.by_ref().take(count) {
            soaked.frame(i);
        }
        let left = soaked.at_rest();
        let traced = soaked.app.world().resource::<Traced>();
        let objects = traced.world.aggregate.instances().len();
        assert!(objects > 20, "{objects} are traced");
        left
    };
    lap(WARM_UP);
    // The threads' queues have now one size and now the next, of sixteen thousand bytes more.
    let [before, after] = [(); 2].map(|()| [(); 3].map(|()| lap(FRAMES)));
    let grown = after.iter().min().unwrap() - before.iter().min().unwrap();
    assert!(
        grown < TOLERANCE,
        "{FRAMES} frames three times left {grown} bytes: {before:?}, {after:?}"
    );
}
