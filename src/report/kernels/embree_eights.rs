//! Embree's instances, and its queries of eight rays at once.
//!
//! Declarations: `rtcore_geometry.h`, `rtcore_ray.h`, `rtcore_scene.h` and `rtcore_common.h`, versions 3 and 4. What is `unsafe`
//! in the report is here and in [`embree`](super::embree).

use super::embree::{Context, Embree, Embree4Or3, Geometry, INVALID, ROBUST, Scene};
use super::{Found, Kernel};
use crate::bvh::Ray;
use glam::{Affine3A, Vec3};
use std::ffi::{c_int, c_uint, c_void};
use std::rc::Rc;

/// RTC_GEOMETRY_TYPE_INSTANCE.
const INSTANCE: c_int = 121;
/// RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR.
const FLOAT3X4_COLUMN_MAJOR: c_int = 0x9234;
/// RTC_RAY_QUERY_FLAG_COHERENT of version 4, and RTC_INTERSECT_CONTEXT_FLAG_COHERENT of version 3.
const COHERENT_4: c_int = 1 << 16;
const COHERENT_3: c_int = 1;
/// RTC_FEATURE_FLAG_ALL.
const ALL_FEATURES: c_uint = u32::MAX;

/// RTCRay8 and RTCHit8, one after the other (RTCRayHit8), and room behind them for what newer versions add to a hit.
#[repr(C, align(64))]
pub(super) struct RayHits {
    origin: [[f32; 8]; 3],
    t_near: [f32; 8],
    direction: [[f32; 8]; 3],
    time: [f32; 8],
    t_far: [f32; 8],
    mask: [c_uint; 8],
    id: [c_uint; 8],
    flags: [c_uint; 8],
    normal: [[f32; 8]; 3],
    u: [f32; 8],
    v: [f32; 8],
    primitive: [c_uint; 8],
    geometry: [c_uint; 8],
    instances: [[c_uint; 8]; 9],
}

impl RayHits {
    /// At most eight rays, and which lanes they take: -1 is yes.
    fn new(rays: &[Ray]) -> (Self, Valid) {
        let mut all = Self {
            origin: [[0.0; 8]; 3],
            t_near: [0.0; 8],
            direction: [[1.0; 8]; 3],
            time: [0.0; 8],
            t_far: [0.0; 8],
            mask: [u32::MAX; 8],
            id: [0; 8],
            flags: [0; 8],
            normal: [[0.0; 8]; 3],
            u: [0.0; 8],
            v: [0.0; 8],
            primitive: [INVALID; 8],
            geometry: [INVALID; 8],
            instances: [[INVALID; 8]; 9],
        };
        let mut valid = Valid([0; 8]);
        for (lane, ray) in rays.iter().take(8).enumerate() {
            for axis in 0..3 {
                all.origin[axis][lane] = ray.origin[axis];
                all.direction[axis][lane] = ray.direction[axis];
            }
            all.t_far[lane] = ray.t_max;
            valid.0[lane] = -1;
        }
        (all, valid)
    }
}

/// Which lanes hold rays; aligned as Embree asks.
#[repr(C, align(32))]
struct Valid([c_int; 8]);

/// RTCIntersectArguments and RTCOccludedArguments of version 4, and room behind.
#[repr(C)]
pub(super) struct Arguments {
    flags: c_int,
    features: c_uint,
    context: *mut c_void,
    filter: *mut c_void,
    callback: *mut c_void,
    room: [usize; 4],
}

pub(super) type Query3 = unsafe extern "C" fn(*const c_int, Scene, *mut Context, *mut RayHits);
pub(super) type Query4 = unsafe extern "C" fn(*const c_int, Scene, *mut RayHits, *mut Arguments);

/// rtcIntersect8 and rtcOccluded8.
#[derive(Clone, Copy)]
pub(super) enum Eights {
    Version3 { intersect: Query3, occluded: Query3 },
    Version4 { intersect: Query4, occluded: Query4 },
}

/// What instances need.
#[derive(Clone, Copy)]
pub(super) struct Instancing {
    pub set_scene: unsafe extern "C" fn(Geometry, Scene),
    pub set_transform: unsafe extern "C" fn(Geometry, c_uint, c_int, *const c_void),
}

/// Triangles, once for each place.
pub(super) fn instances(
    of: Rc<Embree4Or3>,
    triangles: &[[Vec3; 3]],
    places: &[Affine3A],
    robust: bool,
) -> Embree {
    let mesh = Embree::build(of.clone(), triangles, robust);
    // SAFETY: the device lives as long as `of`, and `mesh` is a committed scene of it; a geometry keeps it alive by its count
    // of references. Handles are used as the manual says: a geometry gets its scene and its transform, twelve floats that
    // Embree copies, is committed, attached and released, the scene is committed last.
    let scene = unsafe {
        let scene = (of.new_scene)(of.device);
        (of.set_scene_flags)(scene, if robust { ROBUST } else { 0 });
        for place in places {
            let geometry = (of.new_geometry)(of.device, INSTANCE);
            (of.instancing.set_scene)(geometry, mesh.scene);
            let columns = place.to_cols_array();
            let columns = columns.as_ptr().cast::<c_void>();
            (of.instancing.set_transform)(geometry, 0, FLOAT3X4_COLUMN_MAJOR, columns);
            (of.commit_geometry)(geometry);
            (of.attach_geometry)(scene, geometry);
            (of.release_geometry)(geometry);
        }
        (of.commit_scene)(scene);
        scene
    };
    Embree { scene, of }
}

/// The same scene, asked with eight rays at once that go the same way.
pub(super) struct InEights(pub Rc<Embree>);

impl InEights {
    fn ask(&self, rays: &[Ray], occluded: bool) -> RayHits {
        let (mut all, valid) = RayHits::new(rays);
        let valid = valid.0.as_ptr();
        let scene = self.0.scene;
        match self.0.of.eights {
            Eights::Version3 {
                intersect,
                occluded: any,
            } => {
                let mut context = Context::new(COHERENT_3);
                let query = if occluded { any } else { intersect };
                // SAFETY: the scene is committed. Lanes, context and rays are laid out and aligned (32 bytes) as version 3
                // declares them, and written to by this call only; an occlusion query uses the rays alone.
                unsafe { query(valid, scene, &raw mut context, &raw mut all) }
            }
            Eights::Version4 {
                intersect,
                occluded: any,
            } => {
                let mut arguments = Arguments {
                    flags: COHERENT_4,
                    features: ALL_FEATURES,
                    context: std::ptr::null_mut(),
                    filter: std::ptr::null_mut(),
                    callback: std::ptr::null_mut(),
                    room: [0; 4],
                };
                let query = if occluded { any } else { intersect };
                // SAFETY: as above; the arguments are those that rtcInitIntersectArguments sets, but for the flag.
                unsafe { query(valid, scene, &raw mut all, &raw mut arguments) }
            }
        }
        all
    }
}

impl Kernel for InEights {
    fn closest(&self, rays: &[Ray], found: &mut Vec<Option<Found>>) {
        found.clear();
        for rays in rays.chunks(8) {
            let all = self.ask(rays, false);
            found.extend((0..rays.len()).map(|lane| {
                (all.geometry[lane] != INVALID).then_some(Found {
                    t: all.t_far[lane],
                    triangle: all.primitive[lane],
                    u: all.u[lane],
                    v: all.v[lane],
                })
            }));
        }
    }

    fn occluded(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        occluded.clear();
        for rays in rays.chunks(8) {
            let all = self.ask(rays, true);
            // What is occluded ends at minus infinity.
            occluded.extend((0..rays.len()).map(|lane| all.t_far[lane] < 0.0));
        }
    }
}

impl Kernel for Rc<Embree> {
    fn closest(&self, rays: &[Ray], found: &mut Vec<Option<Found>>) {
        Embree::closest(self, rays, found);
    }

    fn occluded(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        Embree::occluded(self, rays, occluded);
    }
}
