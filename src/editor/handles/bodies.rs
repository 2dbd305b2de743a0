//! What a selection does when its stand-in is moved, turned or scaled.

use bevy::math::{Quat, Vec3};
use bevy::transform::components::{GlobalTransform, Transform};

/// What was done to the stand-in since a drag began.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Change {
    /// In metres of the world.
    Move(Vec3),
    /// In the world's axes.
    Turn(Quat),
    /// Along the axes that `rotation` turns the world's into.
    Scale { rotation: Quat, factor: Vec3 },
}

/// An entity as it was when a drag began.
#[derive(Clone, Debug)]
pub(super) struct Body {
    /// In its parent's space.
    pub own: Transform,
    /// From its parent's space to the world's.
    pub world_from_parent: GlobalTransform,
}

impl Body {
    /// Where it stood in the world.
    pub fn place(&self) -> Vec3 {
        self.world_from_parent.transform_point(self.own.translation)
    }

    /// Its own transform after the change around `pivot`. What the change does not concern stays as
    /// it was, bit for bit. `None` where its parent's scale leaves no way to do it.
    pub fn changed(&self, change: Change, pivot: Vec3) -> Option<Transform> {
        let parent = self.world_from_parent.affine();
        let (_, parent_rotation, _) = self.world_from_parent.to_scale_rotation_translation();
        let mut own = self.own;
        let arm = self.place() - pivot;
        let moved = match change {
            Change::Move(by) => by,
            Change::Turn(turn) => {
                let in_parent = parent_rotation.inverse() * turn * parent_rotation;
                own.rotation = (in_parent * own.rotation).normalize();
                turn * arm - arm
            }
            Change::Scale { rotation, factor } => {
                let stretch = |v: Vec3| rotation * (factor * (rotation.inverse() * v));
                let turned = parent_rotation * own.rotation;
                let along = |axis: Vec3| stretch(turned * axis).length();
                own.scale *= Vec3::new(along(Vec3::X), along(Vec3::Y), along(Vec3::Z));
                stretch(arm) - arm
            }
        };
        if moved != Vec3::ZERO {
            let in_parent = parent.matrix3.inverse() * bevy::math::Vec3A::from(moved);
            own.translation += Vec3::from(in_parent);
        }
        own.is_finite().then_some(own)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::FRAC_PI_2;

    fn body(own: Transform, parent: Transform) -> Body {
        Body {
            own,
            world_from_parent: GlobalTransform::from(parent),
        }
    }

    fn in_world(body: &Body, own: Transform) -> GlobalTransform {
        body.world_from_parent * own
    }

    fn parent() -> Transform {
        Transform::from_xyz(1.0, -2.0, 0.5)
            .with_rotation(Quat::from_rotation_z(0.7))
            .with_scale(Vec3::splat(3.0))
    }

    #[test]
    fn moving_moves_in_the_world_whatever_the_parent_is() {
        let body = body(Transform::from_xyz(0.3, 0.0, 1.0), parent());
        let by = Vec3::new(0.0, 2.0, -1.0);
        let own = body.changed(Change::Move(by), Vec3::ZERO).unwrap();
        let moved = in_world(&body, own).translation() - body.place();
        assert!((moved - by).length() < 1e-5, "{moved}");
        assert_eq!(own.rotation, body.own.rotation);
        assert_eq!(own.scale, body.own.scale);
    }

    #[test]
    fn turning_turns_places_about_the_pivot_and_objects_about_themselves() {
        let body = body(Transform::from_xyz(0.3, 0.0, 1.0), parent());
        let pivot = body.place() + Vec3::X;
        let turn = Quat::from_rotation_y(FRAC_PI_2);
        let own = body.changed(Change::Turn(turn), pivot).unwrap();
        let now = in_world(&body, own);
        let wanted = pivot + turn * Vec3::NEG_X;
        assert!((now.translation() - wanted).length() < 1e-5);
        let before = in_world(&body, body.own);
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            let wanted = turn * before.affine().transform_vector3(axis);
            let turned = now.affine().transform_vector3(axis);
            assert!((turned - wanted).length() < 1e-5, "{axis}");
        }
    }

    #[test]
    fn scaling_along_an_objects_own_axes_is_exact() {
        let rotation = Quat::from_rotation_y(0.4) * Quat::from_rotation_x(0.9);
        let body = body(
            Transform::from_rotation(rotation).with_scale(Vec3::new(1.0, 2.0, 3.0)),
            Transform::IDENTITY,
        );
        let factor = Vec3::new(1.0, 0.5, 1.0);
        let own = body
            .changed(Change::Scale { rotation, factor }, body.place())
            .unwrap();
        assert!((own.scale - Vec3::new(1.0, 1.0, 3.0)).length() < 1e-5);
        assert_eq!(own.translation, body.own.translation);
        assert_eq!(own.rotation, body.own.rotation);
    }

    #[test]
    fn scaling_several_spreads_their_places() {
        let factor = Vec3::splat(2.0);
        let rotation = Quat::IDENTITY;
        let body = body(Transform::from_xyz(1.0, 0.0, 0.0), Transform::IDENTITY);
        let own = body
            .changed(Change::Scale { rotation, factor }, Vec3::new(3.0, 0.0, 0.0))
            .unwrap();
        assert_eq!(own.translation, Vec3::new(-1.0, 0.0, 0.0));
        assert!((own.scale - factor).length() < 1e-6);
    }

    #[test]
    fn a_parent_of_no_size_leaves_things_alone() {
        let flat = Transform::from_scale(Vec3::new(1.0, 0.0, 1.0));
        let body = body(Transform::IDENTITY, flat);
        assert_eq!(body.changed(Change::Move(Vec3::Y), Vec3::ZERO), None);
    }
}
