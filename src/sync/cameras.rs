use super::motions::{WorldMotion, WorldMotions};
use super::problem::Fault;
use super::reading::{Reader, Switched};
use super::traced::Draft;
use crate::scene::schema::quantity_of;
use crate::scene::{Lens, Projection, Quantity, RenderSettings, SceneCamera, SceneId};
use crate::trace::{Camera, Optics};
use bevy::ecs::change_detection::DetectChanges;
use bevy::ecs::entity::Entity;
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::name::Name;
use bevy::ecs::query::{Changed, Or, With};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, Res, ResMut};
use bevy::math::Vec3;
use bevy::transform::components::GlobalTransform;

/// The cameras of the scene, sorted by `SceneId`.
#[derive(Resource, Default)]
pub struct TracedCameras(pub Vec<TracedCamera>);

impl TracedCameras {
    /// The first of these that is a camera of the scene, else the scene's first.
    pub fn first_of(&self, wanted: impl IntoIterator<Item = SceneId>) -> Option<&TracedCamera> {
        let with = |id: SceneId| self.0.iter().find(|camera| camera.id == id);
        wanted.into_iter().find_map(with).or_else(|| self.0.first())
    }
}

/// One camera.
#[derive(Clone, Debug, PartialEq)]
pub struct TracedCamera {
    /// The entity's number.
    pub id: SceneId,
    /// The entity's name, or `camera-7` for the one with the number 7.
    pub name: String,
    /// What rays need of it.
    pub camera: Camera,
}

type Edited = (
    With<SceneCamera>,
    Or<(
        Changed<SceneCamera>,
        Changed<Lens>,
        Changed<GlobalTransform>,
        Changed<Name>,
        Changed<SceneId>,
    )>,
);

type CameraQuery<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static SceneId,
        &'static SceneCamera,
        &'static GlobalTransform,
        Option<&'static Lens>,
        Option<&'static Name>,
    ),
>;

/// Makes the cameras again where one changed, moved, appeared or went.
pub(super) fn sync_cameras(
    edited: Query<(), Edited>,
    mut no_camera: RemovedComponents<SceneCamera>,
    mut no_lens: RemovedComponents<Lens>,
    mut no_name: RemovedComponents<Name>,
    mut no_place: RemovedComponents<GlobalTransform>,
    all: Query<(), With<SceneCamera>>,
    mut switched: Switched,
    settings: Res<RenderSettings>,
    cameras: CameraQuery,
    motions: Res<WorldMotions>,
    mut traced: ResMut<TracedCameras>,
    draft: ResMut<Draft>,
) {
    // Not `||`: every reader has to be emptied.
    let unnamed = no_name.read().filter(|entity| cameras.contains(*entity));
    let bare = no_place.read().filter(|entity| all.contains(*entity));
    let gone = no_camera.read().count() + no_lens.read().count() + unnamed.count() + bare.count();
    let switched = switched.any() || motions.changed() || draft.anew;
    if gone == 0 && !switched && edited.is_empty() && !settings.is_changed() {
        return;
    }
    let draft = draft.into_inner();
    draft.problems.cameras.clear();
    draft.reread = true;
    let mut sorted: Vec<_> = cameras.iter().collect();
    sorted.sort_unstable_by_key(|(_, id, ..)| **id);
    let mut list = Vec::with_capacity(sorted.len());
    for (entity, &id, camera, transform, lens, name) in sorted {
        let mut reader = Reader {
            kind: "camera",
            id,
            name,
            problems: &mut draft.problems.cameras,
        };
        let lens = lens.filter(|_| settings.features.lens);
        let motion = motions.of(entity);
        let Some(mut camera) = read_camera(camera, transform, lens, motion, &mut reader) else {
            continue;
        };
        if let Some(lens) = lens {
            camera.optics.lens_samples = reader.samples(lens.samples);
        }
        list.push(TracedCamera {
            id,
            name: name.map_or_else(|| format!("camera-{}", id.0), |name| name.to_string()),
            camera,
        });
    }
    if list != traced.0 {
        traced.0 = list;
        draft.changes.cameras = true;
    }
}

fn read_camera(
    camera: &SceneCamera,
    transform: &GlobalTransform,
    lens: Option<&Lens>,
    motion: Option<WorldMotion>,
    reader: &mut Reader,
) -> Option<Camera> {
    let affine = transform.affine();
    if !affine.is_finite() {
        reader.note(Fault::NotFinite { field: "transform" });
        return None;
    }
    let motion = match motion {
        Some(motion) => reader.motion(motion)?,
        None => WorldMotion::default(),
    };
    let allows = |path, number: f32| quantity_of::<SceneCamera>(path).allows(number.into());
    let projection = match camera.projection {
        Projection::Perspective { fov_y } if allows("projection.fov_y", fov_y) => camera.projection,
        Projection::Perspective { .. } => {
            reader.note(Fault::Degenerate {
                field: "field of view (which must lie between 0 and pi)",
            });
            return None;
        }
        Projection::Orthographic { height } if allows("projection.height", height) => {
            camera.projection
        }
        Projection::Orthographic { .. } => {
            reader.note(Fault::Degenerate {
                field: "height (which must be above 0)",
            });
            return None;
        }
    };
    // Scale and shear of the parents do not distort the picture: the axes are made unit vectors,
    // the view axis first.
    let axis = |axis: bevy::math::Vec3A| Vec3::from(axis).try_normalize();
    let axes = (|| {
        let forward = -axis(affine.matrix3.z_axis)?;
        let up = axis(affine.matrix3.y_axis)?;
        let right = forward.cross(up).try_normalize()?;
        Some((right, right.cross(forward), forward))
    })();
    let Some((right, up, forward)) = axes else {
        reader.note(Fault::Degenerate { field: "direction" });
        return None;
    };
    let opening = quantity_of::<SceneCamera>("shutter_open");
    let open = reader.number("shutter's opening", camera.shutter_open, opening)?;
    let closing = Quantity {
        least: open.into(),
        ..quantity_of::<SceneCamera>("shutter_close")
    };
    let close = reader.number("shutter's closing", camera.shutter_close, closing)?;
    let mut optics = Optics {
        shutter: [open, close],
        velocity: motion.velocity,
        motion_samples: motion.samples,
        ..Optics::default()
    };
    if let Some(lens) = lens {
        let aperture = quantity_of::<Lens>("aperture_radius");
        optics.aperture_radius =
            reader.number("aperture radius", lens.aperture_radius, aperture)?;
        let focus = quantity_of::<Lens>("focus_distance");
        optics.focus_distance = reader.number("focus distance", lens.focus_distance, focus)?;
    }
    Some(Camera {
        position: transform.translation(),
        right,
        up,
        forward,
        projection,
        optics,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::{Affine3A, Mat3, Quat};
    use bevy::transform::components::Transform;
    use std::f32::consts::PI;

    fn read(transform: GlobalTransform, camera: &SceneCamera) -> (Option<Camera>, usize) {
        let mut problems = Vec::new();
        let mut reader = Reader {
            kind: "camera",
            id: SceneId(1),
            name: None,
            problems: &mut problems,
        };
        let camera = read_camera(camera, &transform, None, None, &mut reader);
        (camera, problems.len())
    }

    #[test]
    fn scale_shear_and_mirroring_of_a_parent_do_not_distort_the_picture() {
        let transform = Transform::from_rotation(Quat::from_rotation_y(0.7));
        let (plain, _) = read(GlobalTransform::from(transform), &SceneCamera::default());
        let plain = plain.unwrap();
        let sheared = Affine3A::from_mat3(
            Mat3::from(transform.compute_affine().matrix3)
                * Mat3::from_cols(Vec3::X * -3.0, Vec3::Y * 2.0, Vec3::Z * 0.5),
        );
        let (other, _) = read(GlobalTransform::from(sheared), &SceneCamera::default());
        let other = other.unwrap();
        for (a, b) in [
            (plain.right, other.right),
            (plain.up, other.up),
            (plain.forward, other.forward),
        ] {
            assert!((a - b).length() < 1e-6, "{a} and {b}");
        }
    }

    #[test]
    fn a_camera_that_sees_nothing_is_left_out_and_named() {
        for fov_y in [0.0, -1.0, PI, f32::NAN, f32::INFINITY] {
            let camera = SceneCamera {
                projection: Projection::Perspective { fov_y },
                ..SceneCamera::default()
            };
            let (camera, problems) = read(GlobalTransform::IDENTITY, &camera);
            assert!(camera.is_none() && problems == 1, "field of view {fov_y}");
        }
        let flat = GlobalTransform::from(Transform::from_scale(Vec3::ZERO));
        let (camera, problems) = read(flat, &SceneCamera::default());
        assert!(camera.is_none() && problems == 1);
    }
}
