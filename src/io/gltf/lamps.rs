//! Lights and cameras of glTF, in both directions.
//!
//! `KHR_lights_punctual` measures what the eye sees: candela (lm/sr) for point and spot lights, lux
//! (lm/m²) for directional ones. We measure power: W/sr and W/m². One watt of the light to which
//! the eye is most sensitive is 683 lumens, by the definition of the candela; everything is taken
//! as that light, which is also what Blender's exporter does in its standard mode.
//!
//! | glTF | here |
//! |---|---|
//! | point, intensity in cd | `PointLamp`, intensity / 683 W/sr |
//! | spot | the same with `cone` |
//! | directional, intensity in lx | `DirectionalLamp`, intensity / 683 W/m² |
//! | `range` | left out: light has none |
//! | perspective, `yfov` | `Projection::Perspective` |
//! | orthographic, `ymag` | `Projection::Orthographic`, height = 2 `ymag` |
//! | aspect, near, far | left out: the picture's size decides, and rays have no planes |

use super::json::Json;
use crate::scene::{Cone, DirectionalLamp, PointLamp, Projection, SceneCamera};
use bevy::color::LinearRgba;
use serde_json::{Value, json};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// lm/W at 540 THz (SI, ninth edition, 2.3.1).
pub(super) const LUMENS_PER_WATT: f32 = 683.0;

/// A light of a file.
pub(super) enum Lamp {
    Point(PointLamp),
    Directional(DirectionalLamp),
}

/// A light; `None` where it is of no kind that there is, or its numbers make no sense.
pub(super) fn lamp_of(light: Json) -> Option<Lamp> {
    let kind = light.text("type")?;
    let [r, g, b] = light.numbers("color").unwrap_or([1.0; 3]);
    let intensity = light.number("intensity").unwrap_or(1.0) / LUMENS_PER_WATT;
    let numbers = [r, g, b, intensity];
    if !numbers.iter().all(|n| n.is_finite() && *n >= 0.0) {
        return None;
    }
    let color = LinearRgba::rgb(r, g, b);
    let cone = match kind {
        "directional" => {
            return Some(Lamp::Directional(DirectionalLamp {
                color,
                intensity,
                ..DirectionalLamp::default()
            }));
        }
        "point" => None,
        "spot" => {
            let Cone { inner, outer } = cone_of(light);
            let outer = outer.clamp(0.0, FRAC_PI_2);
            let inner = inner.clamp(0.0, outer);
            Some(Cone { inner, outer })
        }
        _ => return None,
    };
    Some(Lamp::Point(PointLamp {
        color,
        intensity,
        cone,
    }))
}

/// The cone of a spot as the file says it, which may be none.
fn cone_of(light: Json) -> Cone {
    let spot = light.get("spot");
    let angle = |key| spot.and_then(|spot| spot.number(key));
    Cone {
        inner: angle("innerConeAngle").unwrap_or(0.0),
        outer: angle("outerConeAngle").unwrap_or(FRAC_PI_4),
    }
}

/// Whether a light is a spot whose angles are outside glTF's ranges. A right angle may be rounded up.
pub(super) fn has_no_cone(light: Json) -> bool {
    const ROUNDED: f32 = 1e-5;
    let Cone { inner, outer } = cone_of(light);
    let is_cone = 0.0 <= inner && inner <= outer && outer <= FRAC_PI_2 + ROUNDED;
    light.text("type") == Some("spot") && !is_cone
}

/// A camera; `None` where its numbers make no sense.
pub(super) fn camera_of(camera: Json) -> Option<SceneCamera> {
    let kind = camera.text("type")?;
    let numbers = camera.get(kind)?;
    // A picture's size decides about its sides, and rays have no planes.
    for unused in ["aspectRatio", "xmag", "znear", "zfar"] {
        numbers.get(unused);
    }
    let projection = match kind {
        "perspective" => {
            let fov_y = numbers.number("yfov")?;
            let is_open = fov_y > 0.0 && fov_y < PI;
            is_open.then_some(Projection::Perspective { fov_y })?
        }
        "orthographic" => {
            let ymag = numbers.number("ymag")?;
            let height = 2.0 * ymag.abs();
            let is_open = ymag.is_normal() && height.is_finite();
            is_open.then_some(Projection::Orthographic { height })?
        }
        _ => return None,
    };
    Some(SceneCamera {
        projection,
        ..SceneCamera::default()
    })
}

/// A point light as glTF says it. Where it has a cone it is a spot.
pub(super) fn point_json(lamp: &PointLamp) -> Value {
    let mut light = json!({
        "type": "point",
        "color": [lamp.color.red, lamp.color.green, lamp.color.blue],
        "intensity": lamp.intensity * LUMENS_PER_WATT,
    });
    if let Some(cone) = lamp.cone {
        light["type"] = json!("spot");
        light["spot"] = json!({ "innerConeAngle": cone.inner, "outerConeAngle": cone.outer });
    }
    light
}

/// A directional light as glTF says it.
pub(super) fn directional_json(lamp: &DirectionalLamp) -> Value {
    json!({
        "type": "directional",
        "color": [lamp.color.red, lamp.color.green, lamp.color.blue],
        "intensity": lamp.intensity * LUMENS_PER_WATT,
    })
}

/// A camera as glTF says it. glTF demands planes; these hold anything.
pub(super) fn camera_json(camera: &SceneCamera) -> Value {
    match camera.projection {
        Projection::Perspective { fov_y } => json!({
            "type": "perspective",
            "perspective": { "yfov": fov_y, "znear": 0.01 },
        }),
        Projection::Orthographic { height } => json!({
            "type": "orthographic",
            "orthographic": { "xmag": 0.5 * height, "ymag": 0.5 * height, "znear": 0.0, "zfar": 1e6 },
        }),
    }
}
