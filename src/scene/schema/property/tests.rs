use super::super::Unit;
use super::*;
use crate::scene::{Lens, MeshSource, PointLamp, RenderSettings, SceneCamera, SegmentLamp, Shape};
use bevy::math::{Vec2, Vec3};

#[test]
fn parts_are_found_by_their_paths_and_inherit_what_is_said_of_the_whole() {
    let of = |path| Property::of(SegmentLamp::type_info(), path).unwrap();
    assert_eq!(of("ends[1]").label, "End B");
    assert_eq!(of("ends[0].y").quantity, Some(Quantity::COORDINATE));
    let angle = Property::of(PointLamp::type_info(), "cone.0.inner").unwrap();
    assert_eq!(angle.quantity, Some(Quantity::degrees(0.0, 90.0)));
    let fov = quantity_of::<SceneCamera>("projection.fov_y");
    assert!(fov.is_open && fov.unit == Unit::ANGLE);
    assert!(Property::of(Lens::type_info(), "focus").is_none());
}

#[test]
fn of_parts_of_the_same_name_that_of_the_variant_is_meant_which_a_value_is() {
    let corners = |shape| {
        let source = MeshSource::Shape(shape);
        let property = Property::of_value(source.as_partial_reflect(), "0.corners").unwrap();
        match property.kind {
            TypeInfo::Array(info) => info.capacity(),
            _ => panic!("{property:?}"),
        }
    };
    let flat = |count| [Vec3::ZERO, Vec3::X, Vec3::ONE, Vec3::Y][count];
    let triangle = corners(Shape::Triangle {
        corners: [0, 1, 2].map(flat),
    });
    let quadrilateral = corners(Shape::Quadrilateral {
        corners: [0, 1, 2, 3].map(flat),
    });
    assert_eq!([triangle, quadrilateral], [3, 4]);
    let size = |shape: Shape| {
        let source = MeshSource::Shape(shape);
        Property::of_value(source.as_partial_reflect(), "0.size").unwrap()
    };
    let cuboid = size(Shape::Cuboid { size: Vec3::ONE });
    assert!(cuboid.kind.is::<Vec3>(), "{:?}", cuboid.kind);
    assert_eq!(cuboid.says, "Edge lengths");
    let ground = size(Shape::Ground {
        size: Vec2::ONE,
        tile: Vec2::ONE,
    });
    assert!(ground.kind.is::<Vec2>(), "{:?}", ground.kind);
    let lamp = PointLamp::default();
    let angle = Property::of_value(lamp.as_partial_reflect(), "cone.0.inner");
    assert!(angle.is_none(), "a lamp without a cone has no angle");
}

#[test]
fn all_that_can_be_set_is_found_in_order() {
    let paths = |kind| {
        let all = Property::all(kind).into_iter();
        all.map(|property| property.path).collect::<Vec<_>>()
    };
    assert_eq!(
        paths(PointLamp::type_info()),
        ["color", "intensity", "cone", "cone.0.inner", "cone.0.outer"]
    );
    let settings = paths(RenderSettings::type_info());
    assert_eq!(
        (&*settings[0], &*settings[5]),
        ("size", "sampling.adaptive")
    );
}

#[test]
fn the_number_that_was_not_set_gives_way() {
    let camera = |shutter_open, shutter_close| SceneCamera {
        shutter_open,
        shutter_close,
        ..SceneCamera::default()
    };
    for (set, left) in [("shutter_open", [0.8, 0.8]), ("shutter_close", [0.2, 0.2])] {
        let mut late = camera(0.8, 0.2);
        keep_order(&mut late, set);
        assert_eq!([late.shutter_open, late.shutter_close], left, "{set}");
    }
    let mut other = camera(0.1, 0.9);
    keep_order(&mut other, "shutter_open");
    assert_eq!(other, camera(0.1, 0.9));
}
