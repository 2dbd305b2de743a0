//! Normals from a picture, in tangent space.
//!
//! The tangent points where u grows, perpendicular to the shading normal; the bitangent to the picture's upper
//! edge, as glTF 2.0 has it (section 3.9.3). A mesh may have tangents at its vertices: those that a map was painted
//! for. Else both are the triangle's own: they follow from its corners and their texture coordinates (Lengyel 2001,
//! "Computing tangent space basis vectors for an arbitrary mesh").

use glam::{Vec2, Vec3, Vec4};

/// The least angle in radians between a mirror direction and the surface that a normal map may leave: rounding
/// does not reach it, and nobody sees it.
const LEAST_ELEVATION: f32 = 1e-3;

/// The square of the least sine of the angle between a mesh's normal and its tangent: rounding makes a millionth, and
/// what tools write lies far above.
const LEAST_SIDEWAYS: f32 = 1e-10;

/// Unit tangent and bitangent of a triangle around a unit normal; `None` where its texture coordinates have no
/// area. `edges` and `uvs` leave its first corner.
pub(in crate::trace) fn tangents_of_triangle(
    edges: [Vec3; 2],
    uvs: [Vec2; 2],
    normal: Vec3,
) -> Option<[Vec3; 2]> {
    let [a, b] = edges;
    let [d, e] = uvs;
    // Times the sign of the texture coordinates' area, which division by the area would give.
    let side = d.perp_dot(e);
    if side == 0.0 || !side.is_finite() {
        return None;
    }
    let along_u = (a * e.y - b * d.y) * side.signum();
    let along_v = (b * d.x - a * e.x) * side.signum();
    let tangent = (along_u - normal * normal.dot(along_u)).try_normalize()?;
    let bitangent = normal.cross(tangent);
    // v grows downwards.
    let upwards = if bitangent.dot(along_v) > 0.0 {
        -bitangent
    } else {
        bitangent
    };
    Some([tangent, upwards])
}

/// The same from a tangent that a mesh has there, with the sign of `w · normal × tangent`; `None` where it has no
/// direction beside the normal.
pub(in crate::trace) fn tangents_given(tangent: Vec4, normal: Vec3) -> Option<[Vec3; 2]> {
    let along_u = tangent.truncate();
    let across = along_u - normal * normal.dot(along_u);
    // Of a tangent along the normal rounding leaves some direction or other.
    if across.length_squared() < LEAST_SIDEWAYS * along_u.length_squared() {
        return None;
    }
    let across = across.try_normalize()?;
    let side = if tangent.w < 0.0 { -1.0 } else { 1.0 };
    Some([across, side * normal.cross(across)])
}

/// The unit normal that a map's texel makes of `normal`, whose mesh has it the other way around where it is
/// `turned`. Without tangents it stays as it is.
pub(in crate::trace) fn bent(
    normal: Vec3,
    turned: bool,
    texel: Vec3,
    scale: f32,
    tangents: Option<[Vec3; 2]>,
) -> Vec3 {
    let Some([tangent, bitangent]) = tangents else {
        return normal;
    };
    let local = 2.0 * texel - 1.0;
    // A normal that is turned around is turned as a whole.
    let scale = if turned { -scale } else { scale };
    let sideways = scale * (local.x * tangent + local.y * bitangent);
    (sideways + local.z.max(0.0) * normal)
        .try_normalize()
        .unwrap_or(normal)
}

/// `normal`, but no farther from the geometric normal than a mirror direction above the surface allows.
///
/// With `n = cos α g + sin α h`, `h` perpendicular to `g` in the plane of both, the mirror direction of `v` rises
/// by `r·g = 2 (n·v)(n·g) - v·g = ρ cos(2α - φ)`, where `(ρ, φ)` are `(v·g, v·h)` in polar coordinates: it lies
/// above the surface up to `α = (φ + π/2) / 2`.
pub(in crate::trace) fn above_surface(
    normal: Vec3,
    geometric_normal: Vec3,
    to_viewer: Vec3,
) -> Vec3 {
    let rise = normal.dot(geometric_normal);
    let mirrored = 2.0 * normal.dot(to_viewer) * rise - to_viewer.dot(geometric_normal);
    if rise > 0.0 && mirrored > LEAST_ELEVATION {
        return normal;
    }
    let Some(sideways) = (normal - rise * geometric_normal).try_normalize() else {
        return geometric_normal;
    };
    let angle = rise.clamp(-1.0, 1.0).acos();
    let to_viewer = Vec2::new(to_viewer.dot(geometric_normal), to_viewer.dot(sideways));
    let most = (to_viewer.to_angle() + std::f32::consts::FRAC_PI_2 - LEAST_ELEVATION) / 2.0;
    if angle <= most {
        return normal;
    }
    let (sine, cosine) = most.max(0.0).sin_cos();
    cosine * geometric_normal + sine * sideways
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flat triangle in the plane of x and z, whose picture's right is x and whose up is -z.
    const EDGES: [Vec3; 2] = [Vec3::X, Vec3::Z];
    const UVS: [Vec2; 2] = [Vec2::X, Vec2::Y];

    fn encoded(normal: Vec3) -> Vec3 {
        (normal + 1.0) / 2.0
    }

    #[test]
    fn red_bends_to_the_right_of_the_picture_and_green_to_its_upper_edge() {
        let (right, up) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.6, 0.8));
        let of = |uvs| tangents_of_triangle(EDGES, uvs, Vec3::Y);
        let bend = |texel, scale| bent(Vec3::Y, false, encoded(texel), scale, of(UVS));
        assert!(bend(right, 1.0).abs_diff_eq(Vec3::new(0.6, 0.8, 0.0), 1e-6));
        assert!(bend(up, 1.0).abs_diff_eq(Vec3::new(0.0, 0.8, -0.6), 1e-6));
        assert_eq!(bend(right, 0.0), Vec3::Y);
        let twice = Vec3::new(1.2, 0.8, 0.0).normalize();
        assert!(bend(right, 2.0).abs_diff_eq(twice, 1e-6));
        // The picture is mirrored: its right is where it was, its up is not.
        let mirrored = [Vec2::X, Vec2::NEG_Y];
        let bend = |texel| bent(Vec3::Y, false, encoded(texel), 1.0, of(mirrored));
        assert!(bend(right).abs_diff_eq(Vec3::new(0.6, 0.8, 0.0), 1e-6));
        assert!(bend(up).abs_diff_eq(Vec3::new(0.0, 0.8, 0.6), 1e-6));
    }

    #[test]
    fn from_behind_a_bent_normal_is_the_opposite_one() {
        let texel = encoded(Vec3::new(0.3, -0.5, 0.7));
        let of = |normal| tangents_of_triangle(EDGES, UVS, normal);
        let front = bent(Vec3::Y, false, texel, 1.0, of(Vec3::Y));
        let back = bent(Vec3::NEG_Y, true, texel, 1.0, of(Vec3::NEG_Y));
        assert!(back.abs_diff_eq(-front, 1e-6), "{front} {back}");
    }

    #[test]
    fn where_texture_coordinates_say_nothing_a_normal_stays() {
        for uvs in [[Vec2::ZERO; 2], [Vec2::X, 2.0 * Vec2::X]] {
            let texel = encoded(Vec3::X);
            let none = tangents_of_triangle(EDGES, uvs, Vec3::Y);
            assert_eq!(bent(Vec3::Y, false, texel, 1.0, none), Vec3::Y);
        }
    }

    #[test]
    fn a_given_tangent_is_made_perpendicular_and_its_sign_turns_the_bitangent() {
        let leaning = Vec3::new(3.0, 4.0, 0.0);
        for side in [1.0, -1.0] {
            let found = tangents_given(leaning.extend(side), Vec3::Y);
            assert_eq!(found, Some([Vec3::X, side * Vec3::NEG_Z]));
        }
        for useless in [Vec3::ZERO, Vec3::NEG_Y, Vec3::splat(f32::NAN), Vec3::MAX] {
            assert_eq!(tangents_given(useless.extend(1.0), Vec3::Y), None);
        }
    }

    #[test]
    fn no_mirror_direction_goes_below_the_surface_and_no_normal_is_moved_without_need() {
        let g = Vec3::Y;
        let (mut kept, mut moved) = (0, 0);
        let turn = |i: u16, of: u16| f32::from(i) / f32::from(of);
        for i in 0..60 {
            for j in 0..60 {
                let tilt = turn(i, 60) * std::f32::consts::PI;
                let n = Vec3::new(tilt.sin(), tilt.cos(), 0.0);
                let elevation = (turn(j, 60) + 0.004) * std::f32::consts::FRAC_PI_2;
                for around in 0..12 {
                    let (s, c) = (turn(around, 12) * std::f32::consts::TAU).sin_cos();
                    let (e_s, e_c) = elevation.sin_cos();
                    let v = Vec3::new(c * e_c, e_s, s * e_c);
                    let mirrored = |n: Vec3| 2.0 * n.dot(v) * n - v;
                    let found = above_surface(n, g, v);
                    let rise = mirrored(found).dot(g);
                    assert!(rise > 0.0, "tilt {tilt}, v {v}: {rise}");
                    assert!((found.length() - 1.0).abs() < 1e-5, "{found}");
                    if n.dot(g) > 0.0 && mirrored(n).dot(g) > 1e-3 {
                        assert_eq!(found, n, "tilt {tilt}, v {v}");
                        kept += 1;
                    } else {
                        // It lies where the mirror direction grazes.
                        assert!(rise < 2e-3, "tilt {tilt}, v {v}: {rise}");
                        moved += 1;
                    }
                }
            }
        }
        assert!(kept > 1000 && moved > 1000, "{kept} kept, {moved} moved");
    }
}
