use super::*;
use crate::trace::SunDisc;

/// What a floor 3 m below the origin sends back from there.
fn below(lights: Lights) -> f64 {
    let corner = Vec3::new(-9.0, -3.0, -9.0);
    let floor = quad(corner, Vec3::Z * 18.0, Vec3::X * 18.0);
    let mut scene = world(vec![flat(1, &floor, 0)], vec![Material::default()]);
    scene.lights = Arc::new(lights);
    let eye = Vec3::new(0.0, -1.0, 2.0);
    let camera = Camera::looking_at(eye, Vec3::NEG_Y * 3.0, Vec3::Y, 0.1);
    let settings = RenderSettings {
        spp: 16,
        ..RenderSettings::default()
    };
    f64::from(
        central_radiance(&scene.with_needs(), &camera, &settings)
            .0
            .x,
    )
}

#[test]
fn the_least_lights_give_what_a_point_of_their_power_does() {
    let point = below((*point_light(Vec3::ZERO)).clone());
    // Shorter ones are left out, with a word: squares of their length are nothing.
    for length in [1e-22_f32, 1e-20, 1e-18, 1e-14, 1e-12, 1e-10, 1e-6, 1e-3] {
        let color = (1.0 / length).min(1e20);
        let segment = SegmentLight {
            id: 9,
            ends: [Vec3::X * -0.5 * length, Vec3::X * 0.5 * length],
            colors: [Vec3::splat(color); 2],
            samples: 1,
        };
        let lights = Lights {
            segments: vec![segment],
            ..Lights::default()
        };
        let power = f64::from(length * color);
        let ratio = below(lights) / (point * power);
        assert!((ratio - 1.0).abs() < 0.01, "{length:e} m: {ratio}");
    }
    for edge in [1e-11_f32, 1e-10, 1e-8, 1e-6, 1e-3] {
        let color = 1.0 / (edge * edge);
        let panel = ParallelogramLight {
            id: 9,
            corner: Vec3::new(-0.5 * edge, 0.0, -0.5 * edge),
            edges: [Vec3::X * edge, Vec3::Z * edge],
            colors: [Vec3::splat(color); 4],
            two_sided: true,
            visible: false,
            samples: 1,
        };
        let lights = Lights {
            parallelograms: vec![panel],
            ..Lights::default()
        };
        let ratio = below(lights) / point;
        assert!((ratio - 1.0).abs() < 0.01, "{edge:e} m: {ratio}");
    }
    let sun = |diameter: f32| Lights {
        directionals: vec![DirectionalLight {
            id: 9,
            to_light: Vec3::Y,
            color: Vec3::ONE,
            disc: SunDisc::of_diameter(diameter),
            samples: 1,
        }],
        ..Lights::default()
    };
    let middle = below(sun(0.0));
    for diameter in [1e-45, 1e-30, 1e-20, 1e-10, 1e-5] {
        let ratio = below(sun(diameter)) / middle;
        assert!((ratio - 1.0).abs() < 1e-5, "{diameter:e} rad: {ratio}");
    }
}
