//! No allocation per ray, none per batch after warm-up: counted. No memory that edits leave behind:
//! weighed. A binary of its own, because it replaces the allocator.

mod soak;
#[cfg(feature = "view")]
mod soak_game;

use glam::{Affine3A, UVec2, Vec3};
use glassbox::bvh::{Aggregate, BuildOptions, Builder, Instance, Levels, MeshTree, Ray, Triangles};
use glassbox::scene::{Features, RenderSettings};
use glassbox::trace::{
    Camera, Lights, Material, Mesh, Object, ParallelogramLight, PointLight, SampleId, Workspace,
    World, radiance,
};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicIsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// The system's allocator, counting what this thread asks of it, and weighing what all have.
struct Counting;

static LIVE_BYTES: AtomicIsize = AtomicIsize::new(0);

/// Bytes that are allocated now, by all threads.
fn live_bytes() -> isize {
    LIVE_BYTES.load(Ordering::Relaxed)
}

/// Bytes that are allocated when all has come to rest: what other threads give back, they give back by themselves, until that
/// has been for a while.
pub fn bytes_at_rest() -> isize {
    let start = Instant::now();
    let mut bytes = live_bytes();
    let mut since = Instant::now();
    while since.elapsed() < Duration::from_millis(300) {
        assert!(start.elapsed().as_secs() < 60, "it does not come to rest");
        thread::sleep(Duration::from_millis(10));
        if live_bytes() != bytes {
            bytes = live_bytes();
            since = Instant::now();
        }
    }
    bytes
}

/// Held by each test, since others' memory would be weighed too.
pub static ALONE: Mutex<()> = Mutex::new(());

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: every call is handed on to `System` unchanged, which keeps the contract; counting touches
// a constant-initialised thread-local without a destructor and an atomic, so it neither allocates nor
// unwinds.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        LIVE_BYTES.fetch_add(layout.size() as isize, Ordering::Relaxed);
        // SAFETY: the caller's promise about `layout` is handed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        LIVE_BYTES.fetch_sub(layout.size() as isize, Ordering::Relaxed);
        // SAFETY: the pointer came from `alloc` or `realloc` above, that is from `System`.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        LIVE_BYTES.fetch_add(size as isize - layout.size() as isize, Ordering::Relaxed);
        // SAFETY: the pointer came from `System`, and the caller's promises are handed on.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations(f: impl FnOnce()) -> usize {
    let before = ALLOCATIONS.get();
    f();
    ALLOCATIONS.get() - before
}

/// A bumpy floor of 2 · n² triangles, and two instances of it, one of them turned.
fn instances(n: u32, options: &BuildOptions) -> (Arc<MeshTree>, Vec<Instance>) {
    let height = |x: u32, z: u32| ((x * 7 + z * 13) % 5) as f32 * 0.02;
    let mut positions = Vec::new();
    let mut indices = Vec::new();
    for z in 0..=n {
        for x in 0..=n {
            let at = Vec3::new(x as f32, 0.0, z as f32) * (4.0 / n as f32) - Vec3::splat(2.0);
            positions.push(Vec3::new(at.x, height(x, z), at.z));
        }
    }
    for z in 0..n {
        for x in 0..n {
            let i = z * (n + 1) + x;
            indices.push([i, i + n + 1, i + n + 2]);
            indices.push([i, i + n + 2, i + 1]);
        }
    }
    let triangles = Triangles::new(positions, indices).unwrap();
    let tree = Arc::new(MeshTree::build(triangles, options));
    let turned = Affine3A::from_rotation_x(1.2) * Affine3A::from_translation(Vec3::Y * 0.7);
    let instances = [Affine3A::IDENTITY, turned]
        .iter()
        .map(|transform| Instance::new(tree.clone(), transform).unwrap())
        .collect();
    (tree, instances)
}

/// A thousand triangles, each where it stands by its number.
fn alone(at: impl Fn(usize) -> Vec3, options: &BuildOptions) -> Vec<Instance> {
    let corners = |i| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|corner| at(i) + corner);
    let positions = (0..1000).flat_map(corners).collect();
    let indices = (0..1000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let triangles = Triangles::new(positions, indices).unwrap();
    let tree = Arc::new(MeshTree::build(triangles, options));
    vec![Instance::new(tree, &Affine3A::IDENTITY).unwrap()]
}

#[test]
fn rays_through_any_tree_allocate_nothing() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    for builder in [Builder::None, Builder::Median, Builder::Sah, Builder::Ploc] {
        for levels in [Levels::One, Levels::Two] {
            let options = BuildOptions {
                builder,
                levels,
                ..BuildOptions::default()
            };
            // A floor; a thousand triangles in one place; as many in a row along x.
            let down = |x: f32| Ray::new(Vec3::new(x, 3.0, 1.0), Vec3::new(0.1, -1.0, x * 0.3));
            let onto_one = |x: f32| Ray::new(Vec3::new(0.2 + 0.02 * x, 0.2, 1.0), Vec3::NEG_Z);
            let onto_row = |x: f32| {
                let from = Vec3::new((200.0 * (x + 2.0)).round() * 2.0 + 0.2, 0.2, 1.0);
                Ray::new(from, Vec3::NEG_Z)
            };
            let one_place = alone(|_| Vec3::ZERO, &options);
            let row = alone(|i| Vec3::X * (2 * i) as f32, &options);
            type Shoot<'a> = &'a dyn Fn(f32) -> Ray;
            let scenes: [(_, _, Shoot); 3] = [
                ("floor", instances(16, &options).1, &down),
                ("one place", one_place, &onto_one),
                ("row", row, &onto_row),
            ];
            for (name, instances, ray) in scenes {
                let aggregate = Aggregate::build(instances, &options);
                let mut hits = 0;
                let count = allocations(|| {
                    for i in 0..1000 {
                        let ray = ray((i % 37) as f32 * 0.1 - 1.8);
                        hits += u32::from(aggregate.closest_hit(&ray).is_some());
                        hits += u32::from(aggregate.occluded(&ray));
                    }
                });
                assert!(hits > 500, "{name}: only {hits} hits");
                assert_eq!(
                    count, 0,
                    "{name}, {builder:?}, {levels:?}: {count} allocations"
                );
            }
        }
    }
}

#[test]
fn a_batch_allocates_nothing_once_its_arrays_have_grown() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let options = BuildOptions::default();
    let (tree, instances) = instances(32, &options);
    let mesh = Arc::new(Mesh::of(tree));
    let objects = (0..2)
        .map(|i| Object {
            id: i + 1,
            material: i as u32,
            motion_samples: 0,
            mesh: mesh.clone(),
        })
        .collect();
    let mirror = Material {
        specular: Vec3::splat(0.5),
        mirror: Vec3::splat(0.5),
        opacity: 0.6,
        ..Material::default()
    };
    let world = World {
        aggregate: Arc::new(Aggregate::build(instances, &options)),
        objects: Arc::new(objects),
        materials: Arc::new(vec![Material::default(), mirror]),
        lights: Arc::new(Lights {
            points: vec![PointLight {
                id: 3,
                position: Vec3::new(1.0, 3.0, 2.0),
                color: Vec3::splat(10.0),
                cone: None,
            }],
            parallelograms: vec![ParallelogramLight {
                id: 4,
                corner: Vec3::new(-1.0, 3.0, -1.0),
                edges: [Vec3::X, Vec3::Z],
                colors: [Vec3::ONE; 4],
                two_sided: true,
                visible: true,
                samples: 4,
            }],
            ..Lights::default()
        }),
        ..World::default()
    }
    .with_needs();
    let mut camera = Camera::looking_at(Vec3::new(0.0, 2.0, 5.0), Vec3::ZERO, Vec3::Y, 0.8);
    camera.optics.aperture_radius = 0.05;
    let settings = RenderSettings {
        size: UVec2::splat(16),
        features: Features {
            glossy: true,
            translucency: true,
            ..Features::default()
        },
        ..RenderSettings::default()
    };
    let samples: Vec<_> = (0..256)
        .map(|i| SampleId {
            pixel: UVec2::new(i % 16, i / 16),
            index: 0,
        })
        .collect();
    let mut values = vec![Vec3::ZERO; samples.len()];
    let mut workspace = Workspace::default();
    let mut trace = || {
        radiance(
            &world,
            &camera,
            &settings,
            &samples,
            &mut values,
            &mut workspace,
        )
        .total()
    };
    // The arrays change places from bounce to bounce: both must have met the longest list.
    let rays = trace() + trace();
    let count = allocations(|| {
        trace();
    });
    assert!(rays > 2000, "only {rays} rays");
    assert_eq!(count, 0, "{count} allocations in a batch");
}
