//! Embree, where the machine has it: loaded while the program runs, so that nothing depends on it.
//!
//! Declarations: Embree's manual and public headers, `rtcore_device.h`, `rtcore_geometry.h`, `rtcore_scene.h`,
//! `rtcore_ray.h` and `rtcore_common.h`, versions 3 and 4. What is `unsafe` in the report is here and in
//! [`embree_eights`](super::embree_eights).

use super::embree_eights::{Eights, Instancing};
use super::{Found, Kernel};
use crate::bvh::Ray;
use glam::Vec3;
use libloading::{Library, Symbol};
use std::ffi::{c_char, c_int, c_uint, c_void};
use std::mem::ManuallyDrop;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Names under which systems install it, newest first.
const NAMES: [&str; 6] = [
    "libembree4.so.4",
    "libembree4.so",
    "libembree3.so.3",
    "libembree3.so",
    "libembree4.dylib",
    "embree4.dll",
];

/// RTC_BUFFER_TYPE_INDEX and RTC_BUFFER_TYPE_VERTEX.
const INDEX_BUFFER: c_int = 0;
const VERTEX_BUFFER: c_int = 1;
/// RTC_FORMAT_UINT3 and RTC_FORMAT_FLOAT3.
const UINT3: c_int = 0x5003;
const FLOAT3: c_int = 0x9003;
/// RTC_GEOMETRY_TYPE_TRIANGLE.
const TRIANGLES: c_int = 0;
/// RTC_SCENE_FLAG_ROBUST.
pub(super) const ROBUST: c_int = 1 << 2;
/// RTC_DEVICE_PROPERTY_VERSION: 10000 · major + 100 · minor + patch.
const VERSION: c_int = 0;
/// RTC_INVALID_GEOMETRY_ID.
pub(super) const INVALID: c_uint = u32::MAX;

type Device = *mut c_void;
pub(super) type Scene = *mut c_void;
pub(super) type Geometry = *mut c_void;

/// RTCRay and RTCHit, one after the other (RTCRayHit), and room behind them for what newer versions add to a hit.
#[repr(C, align(64))]
struct RayHit {
    origin: [f32; 3],
    t_near: f32,
    direction: [f32; 3],
    time: f32,
    t_far: f32,
    mask: c_uint,
    id: c_uint,
    flags: c_uint,
    normal: [f32; 3],
    u: f32,
    v: f32,
    primitive: c_uint,
    geometry: c_uint,
    instances: [c_uint; 9],
}

impl RayHit {
    fn new(ray: &Ray) -> Self {
        Self {
            origin: ray.origin.to_array(),
            t_near: 0.0,
            direction: ray.direction.to_array(),
            time: 0.0,
            t_far: ray.t_max,
            mask: u32::MAX,
            id: 0,
            flags: 0,
            normal: [0.0; 3],
            u: 0.0,
            v: 0.0,
            primitive: INVALID,
            geometry: INVALID,
            instances: [INVALID; 9],
        }
    }
}

/// RTCIntersectContext of version 3, and room behind it.
#[repr(C)]
pub(super) struct Context {
    flags: c_int,
    filter: *mut c_void,
    instances: [c_uint; 4],
}

impl Context {
    pub(super) fn new(flags: c_int) -> Self {
        Self {
            flags,
            filter: std::ptr::null_mut(),
            instances: [INVALID; 4],
        }
    }
}

/// What version 3 takes between a scene and a ray, and version 4 behind the ray.
type Query3 = unsafe extern "C" fn(Scene, *mut Context, *mut RayHit);
type Query4 = unsafe extern "C" fn(Scene, *mut RayHit, *mut c_void);

#[derive(Clone, Copy)]
enum Queries {
    Version3 { intersect: Query3, occluded: Query3 },
    Version4 { intersect: Query4, occluded: Query4 },
}

/// Embree's functions, as far as they are used.
pub(super) struct Embree4Or3 {
    path: PathBuf,
    version: isize,
    pub(super) device: Device,
    pub(super) new_scene: unsafe extern "C" fn(Device) -> Scene,
    release_scene: unsafe extern "C" fn(Scene),
    release_device: unsafe extern "C" fn(Device),
    pub(super) set_scene_flags: unsafe extern "C" fn(Scene, c_int),
    pub(super) commit_scene: unsafe extern "C" fn(Scene),
    pub(super) new_geometry: unsafe extern "C" fn(Device, c_int) -> Geometry,
    new_buffer: unsafe extern "C" fn(Geometry, c_int, c_uint, c_int, usize, usize) -> *mut c_void,
    pub(super) commit_geometry: unsafe extern "C" fn(Geometry),
    pub(super) attach_geometry: unsafe extern "C" fn(Scene, Geometry) -> c_uint,
    pub(super) release_geometry: unsafe extern "C" fn(Geometry),
    pub(super) instancing: Instancing,
    pub(super) eights: Eights,
    queries: Queries,
    /// Never unloaded: threads that Embree has started may still be in its code when its device is gone.
    _library: ManuallyDrop<Library>,
}

impl Drop for Embree4Or3 {
    fn drop(&mut self) {
        // SAFETY: the device was made by this library's rtcNewDevice and is released once; every scene of it holds this
        // struct in an `Rc`, so none is left.
        unsafe { (self.release_device)(self.device) }
    }
}

/// Looks at `EMBREE_LIB`, then where systems install it, then where pip puts the one of the package embreex. What
/// `EMBREE_LIB` names has to be there; the others need not.
pub(super) fn find() -> Result<Option<Embree4Or3>, String> {
    if let Some(path) = std::env::var_os("EMBREE_LIB") {
        let path = Path::new(&path);
        let cannot = |why| format!("EMBREE_LIB={}: {why}", path.display());
        return load(path).map(Some).map_err(cannot);
    }
    let installed = NAMES.iter().find_map(|name| load(Path::new(name)).ok());
    Ok(installed.or_else(|| from_python().iter().find_map(|path| load(path).ok())))
}

fn from_python() -> Vec<PathBuf> {
    let below = |folder: &Path| -> Vec<PathBuf> {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.map(|entry| entry.path()).collect()
    };
    let mut bases = vec![PathBuf::from("/usr/lib"), PathBuf::from("/usr/local/lib")];
    if let Some(home) = std::env::var_os("HOME") {
        bases.push(Path::new(&home).join(".local/lib"));
    }
    if let Some(environment) = std::env::var_os("VIRTUAL_ENV") {
        bases.push(Path::new(&environment).join("lib"));
    }
    let pythons = bases.iter().flat_map(|base| below(base));
    let packages = pythons.flat_map(|python| {
        ["site-packages", "dist-packages"].map(|name| python.join(name).join("embreex.libs"))
    });
    let files = packages.flat_map(|folder| below(&folder));
    let is_embree = |path: &PathBuf| {
        let name = path
            .file_name()
            .map(|name| name.to_string_lossy().into_owned());
        name.is_some_and(|name| name.starts_with("libembree"))
    };
    files.filter(is_embree).collect()
}

fn load(path: &Path) -> Result<Embree4Or3, String> {
    // SAFETY: loading runs the library's initialisers. It is Embree by its name, or what the user names in EMBREE_LIB;
    // Embree's initialisers have no preconditions.
    let library = unsafe { Library::new(path) }.map_err(|error| error.to_string())?;
    of_library(path, library).ok_or_else(|| "it is not the library of Embree 3 or 4".into())
}

/// All that is asked of a library.
const FUNCTIONS: [&[u8]; 18] = [
    b"rtcNewDevice",
    b"rtcGetDeviceProperty",
    b"rtcIntersect1",
    b"rtcOccluded1",
    b"rtcIntersect8",
    b"rtcOccluded8",
    b"rtcNewScene",
    b"rtcReleaseScene",
    b"rtcReleaseDevice",
    b"rtcSetSceneFlags",
    b"rtcCommitScene",
    b"rtcNewGeometry",
    b"rtcSetNewGeometryBuffer",
    b"rtcCommitGeometry",
    b"rtcAttachGeometry",
    b"rtcReleaseGeometry",
    b"rtcSetGeometryInstancedScene",
    b"rtcSetGeometryTransform",
];

/// `None` where it is another library, or another version's.
fn of_library(path: &Path, library: Library) -> Option<Embree4Or3> {
    // One that lacks a function is left before it has made a device, which nobody would release.
    let has = |name: &&[u8]| {
        // SAFETY: the function is not called; any of them has some type of function.
        unsafe { library.get::<unsafe extern "C" fn()>(name) }.is_ok()
    };
    if !FUNCTIONS.iter().all(has) {
        return None;
    }
    // SAFETY: the types are those of the C declarations; they are the same in versions 3 and 4.
    let device = unsafe {
        let new_device: Symbol<unsafe extern "C" fn(*const c_char) -> Device> =
            library.get(b"rtcNewDevice").ok()?;
        new_device(c"".as_ptr())
    };
    if device.is_null() {
        return None;
    }
    macro_rules! function {
        ($name:literal) => {{
            // SAFETY: the field or variable that this goes into has the type of the C declaration of that name, and the
            // library is kept as long as the function.
            unsafe { *library.get($name).ok()? }
        }};
    }
    let property: unsafe extern "C" fn(Device, c_int) -> isize = function!(b"rtcGetDeviceProperty");
    // SAFETY: the device is not null, and every version has this property.
    let version = unsafe { property(device, VERSION) };
    let queries = match version / 10_000 {
        3 => Queries::Version3 {
            intersect: function!(b"rtcIntersect1"),
            occluded: function!(b"rtcOccluded1"),
        },
        4 => Queries::Version4 {
            intersect: function!(b"rtcIntersect1"),
            occluded: function!(b"rtcOccluded1"),
        },
        _ => {
            let release: unsafe extern "C" fn(Device) = function!(b"rtcReleaseDevice");
            // SAFETY: the device was made above, and nothing is of it.
            unsafe { release(device) };
            // Its threads may still be in its code.
            std::mem::forget(library);
            return None;
        }
    };
    let eights = match queries {
        Queries::Version3 { .. } => Eights::Version3 {
            intersect: function!(b"rtcIntersect8"),
            occluded: function!(b"rtcOccluded8"),
        },
        Queries::Version4 { .. } => Eights::Version4 {
            intersect: function!(b"rtcIntersect8"),
            occluded: function!(b"rtcOccluded8"),
        },
    };
    Some(Embree4Or3 {
        path: path.to_path_buf(),
        version,
        device,
        new_scene: function!(b"rtcNewScene"),
        release_scene: function!(b"rtcReleaseScene"),
        release_device: function!(b"rtcReleaseDevice"),
        set_scene_flags: function!(b"rtcSetSceneFlags"),
        commit_scene: function!(b"rtcCommitScene"),
        new_geometry: function!(b"rtcNewGeometry"),
        new_buffer: function!(b"rtcSetNewGeometryBuffer"),
        commit_geometry: function!(b"rtcCommitGeometry"),
        attach_geometry: function!(b"rtcAttachGeometry"),
        release_geometry: function!(b"rtcReleaseGeometry"),
        instancing: Instancing {
            set_scene: function!(b"rtcSetGeometryInstancedScene"),
            set_transform: function!(b"rtcSetGeometryTransform"),
        },
        eights,
        queries,
        _library: ManuallyDrop::new(library),
    })
}

impl Embree4Or3 {
    /// Major and minor.
    pub fn version(&self) -> String {
        format!("{}.{}", self.version / 10_000, self.version / 100 % 100)
    }

    /// Version and file.
    pub fn describe(&self) -> String {
        let file = self.path.file_name().unwrap_or(self.path.as_os_str());
        format!(
            "{}.{} ({})",
            self.version(),
            self.version % 100,
            file.to_string_lossy()
        )
    }
}

/// Triangles in Embree.
pub(super) struct Embree {
    pub(super) scene: Scene,
    pub(super) of: Rc<Embree4Or3>,
}

impl Embree {
    pub fn build(of: Rc<Embree4Or3>, triangles: &[[Vec3; 3]], robust: bool) -> Self {
        let positions: Vec<[f32; 3]> = triangles
            .as_flattened()
            .iter()
            .map(|corner| corner.to_array())
            .collect();
        let indices: Vec<[u32; 3]> = (0..triangles.len() as u32)
            .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
            .collect();
        // SAFETY: the device lives as long as `of`. Handles are used as the manual says: a geometry gets its buffers, is
        // committed, attached and released, the scene is committed last. Embree allocates count · stride bytes for a
        // buffer and returns them (null where there is no memory, which is checked); exactly as many are copied there.
        let scene = unsafe {
            let scene = (of.new_scene)(of.device);
            (of.set_scene_flags)(scene, if robust { ROBUST } else { 0 });
            let geometry = (of.new_geometry)(of.device, TRIANGLES);
            let vertices = (of.new_buffer)(geometry, VERTEX_BUFFER, 0, FLOAT3, 12, positions.len());
            let corners = (of.new_buffer)(geometry, INDEX_BUFFER, 0, UINT3, 12, indices.len());
            if !vertices.is_null() && !corners.is_null() {
                vertices
                    .cast::<[f32; 3]>()
                    .copy_from_nonoverlapping(positions.as_ptr(), positions.len());
                corners
                    .cast::<[u32; 3]>()
                    .copy_from_nonoverlapping(indices.as_ptr(), indices.len());
                (of.commit_geometry)(geometry);
                (of.attach_geometry)(scene, geometry);
            }
            (of.release_geometry)(geometry);
            (of.commit_scene)(scene);
            scene
        };
        Self { scene, of }
    }

    fn ask(&self, ray_hit: &mut RayHit, occluded: bool) {
        match self.of.queries {
            Queries::Version3 {
                intersect,
                occluded: any,
            } => {
                let mut context = Context::new(0);
                let query = if occluded { any } else { intersect };
                // SAFETY: the scene is committed. Context and ray are laid out and aligned (16 bytes) as version 3
                // declares them, and written to by this call only; an occlusion query uses the ray alone.
                unsafe { query(self.scene, &raw mut context, &raw mut *ray_hit) }
            }
            Queries::Version4 {
                intersect,
                occluded: any,
            } => {
                let query = if occluded { any } else { intersect };
                // SAFETY: as above; version 4 takes null for default arguments.
                unsafe { query(self.scene, &raw mut *ray_hit, std::ptr::null_mut()) }
            }
        }
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        // SAFETY: the scene was made by rtcNewScene of this library, which `of` still holds, and is released once.
        unsafe { (self.of.release_scene)(self.scene) }
    }
}

impl Kernel for Embree {
    fn closest(&self, rays: &[Ray], found: &mut Vec<Option<Found>>) {
        found.clear();
        found.extend(rays.iter().map(|ray| {
            let mut ray_hit = RayHit::new(ray);
            self.ask(&mut ray_hit, false);
            (ray_hit.geometry != INVALID).then_some(Found {
                t: ray_hit.t_far,
                triangle: ray_hit.primitive,
                u: ray_hit.u,
                v: ray_hit.v,
            })
        }));
    }

    fn occluded(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        occluded.clear();
        occluded.extend(rays.iter().map(|ray| {
            let mut ray_hit = RayHit::new(ray);
            self.ask(&mut ray_hit, true);
            // What is occluded ends at minus infinity.
            ray_hit.t_far < 0.0
        }));
    }
}
