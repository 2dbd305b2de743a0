//! The ranges that the components' documentation states, checked where a file is read, so that no
//! other room meets a value that cannot be meant.

use super::super::error::Problem;
use crate::scene::{
    Alpha, Cone, DirectionalLamp, Environment, Lens, Motion, ParallelogramLamp, Phong, PointLamp,
    Projection, RenderSettings, SceneCamera, SegmentLamp, setting_problems,
};
use bevy::reflect::{PartialReflect, ReflectRef};
use std::f32::consts::{FRAC_PI_2, PI};
use std::fmt::Display;

type Checked = Result<(), Problem>;

/// Checks a component or a resource: every number finite, and those with a range inside it.
pub(super) fn check_value(value: &dyn PartialReflect) -> Checked {
    check_finite(value, value.reflect_short_type_path())?;
    macro_rules! check_as {
        ($($kind:ty => $check:expr),* $(,)?) => {
            $(if let Some(value) = value.try_downcast_ref::<$kind>() {
                let check: fn(&$kind) -> Checked = $check;
                return check(value);
            })*
        };
    }
    check_as! {
        RenderSettings => settings,
        Phong => phong,
        SceneCamera => camera,
        Environment => |e| {
            at_least_0("Environment.intensity", e.intensity)?;
            samples("Environment.samples", e.samples)
        },
        Lens => |l| {
            at_least_0("Lens.aperture_radius", l.aperture_radius)?;
            above_0("Lens.focus_distance", l.focus_distance)?;
            samples("Lens.samples", l.samples)
        },
        Motion => |m| samples("Motion.samples", m.samples),
        PointLamp => |l| {
            at_least_0("PointLamp.intensity", l.intensity)?;
            l.cone.as_ref().map_or(Ok(()), cone)
        },
        DirectionalLamp => |l| {
            at_least_0("DirectionalLamp.intensity", l.intensity)?;
            within("DirectionalLamp.angular_diameter", l.angular_diameter, 0.0, PI, "0 to π")?;
            samples("DirectionalLamp.samples", l.samples)
        },
        SegmentLamp => |l| {
            at_least_0("SegmentLamp.intensity", l.intensity)?;
            samples("SegmentLamp.samples", l.samples)
        },
        ParallelogramLamp => |l| {
            at_least_0("ParallelogramLamp.intensity", l.intensity)?;
            samples("ParallelogramLamp.samples", l.samples)
        },
    }
    Ok(())
}

fn settings(s: &RenderSettings) -> Checked {
    match setting_problems(s).into_iter().next() {
        Some(problem) => Err(Problem::Setting(problem)),
        None => Ok(()),
    }
}

fn phong(p: &Phong) -> Checked {
    const UNIT: &str = "0 to 1";
    let channels = |c: bevy::color::LinearRgba| [c.red, c.green, c.blue];
    for value in channels(p.diffuse) {
        within("Phong.diffuse", value, 0.0, 1.0, UNIT)?;
    }
    for value in channels(p.specular) {
        within("Phong.specular", value, 0.0, 1.0, UNIT)?;
    }
    for value in channels(p.mirror) {
        within("Phong.mirror", value, 0.0, 1.0, UNIT)?;
    }
    for value in channels(p.emission) {
        at_least_0("Phong.emission", value)?;
    }
    within("Phong.shininess", p.shininess, 1.0, f32::MAX, "at least 1")?;
    if let Alpha::Mask { cutoff } = p.alpha {
        at_least_0("Phong.alpha.cutoff", cutoff)?;
    }
    within("Phong.opacity", p.opacity, 0.0, 1.0, UNIT)
}

fn camera(c: &SceneCamera) -> Checked {
    match c.projection {
        Projection::Perspective { fov_y } if fov_y > 0.0 && fov_y < PI => {}
        Projection::Perspective { fov_y } => {
            return Err(out_of_range("SceneCamera.fov_y", fov_y, "between 0 and π"));
        }
        Projection::Orthographic { height } => above_0("SceneCamera.height", height)?,
    }
    within(
        "SceneCamera.shutter_close",
        c.shutter_close,
        0.0,
        1.0,
        "0 to 1",
    )?;
    const OPEN: &str = "0 to shutter_close";
    within(
        "SceneCamera.shutter_open",
        c.shutter_open,
        0.0,
        c.shutter_close,
        OPEN,
    )
}

fn cone(c: &Cone) -> Checked {
    within("PointLamp.cone.outer", c.outer, 0.0, FRAC_PI_2, "0 to π/2")?;
    within("PointLamp.cone.inner", c.inner, 0.0, c.outer, "0 to outer")
}

fn samples(what: &str, value: u32) -> Checked {
    within(what, value, 1, 1000, "1 to 1000")
}

fn at_least_0(what: &str, value: f32) -> Checked {
    within(what, value, 0.0, f32::MAX, "at least 0")
}

fn above_0(what: &str, value: f32) -> Checked {
    if value > 0.0 {
        Ok(())
    } else {
        Err(out_of_range(what, value, "greater than 0"))
    }
}

fn within<T: PartialOrd + Display>(
    what: &str,
    value: T,
    least: T,
    most: T,
    range: &'static str,
) -> Checked {
    if value >= least && value <= most {
        Ok(())
    } else {
        Err(out_of_range(what, value, range))
    }
}

fn out_of_range(what: &str, value: impl Display, range: &'static str) -> Problem {
    Problem::OutOfRange {
        what: what.to_owned(),
        value: value.to_string(),
        range,
    }
}

/// Walks through all fields. One number may be infinite: the distance of a lens's focus plane.
fn check_finite(value: &dyn PartialReflect, path: &str) -> Checked {
    if let Some(number) = value.try_downcast_ref::<f32>() {
        let endless_focus = *number == f32::INFINITY && path == "Lens.focus_distance";
        return if number.is_finite() || endless_focus {
            Ok(())
        } else {
            Err(Problem::OutOfRange {
                what: path.to_owned(),
                value: number.to_string(),
                range: "a finite number",
            })
        };
    }
    let child =
        |name: &str, field: &dyn PartialReflect| check_finite(field, &format!("{path}.{name}"));
    match value.reflect_ref() {
        ReflectRef::Struct(fields) => {
            for index in 0..fields.field_len() {
                if let (Some(name), Some(field)) = (fields.name_at(index), fields.field_at(index)) {
                    child(name, field)?;
                }
            }
        }
        ReflectRef::TupleStruct(fields) => {
            for field in fields.iter_fields() {
                check_finite(field, path)?;
            }
        }
        ReflectRef::Array(items) => {
            for (index, field) in items.iter().enumerate() {
                child(&index.to_string(), field)?;
            }
        }
        ReflectRef::List(items) => {
            for (index, field) in items.iter().enumerate() {
                child(&index.to_string(), field)?;
            }
        }
        ReflectRef::Enum(variant) => {
            for field in variant.iter_fields() {
                match field.name() {
                    Some(name) => child(name, field.value())?,
                    None => check_finite(field.value(), path)?,
                }
            }
        }
        // What scenes keep has no other shapes with numbers in them.
        _ => {}
    }
    Ok(())
}
