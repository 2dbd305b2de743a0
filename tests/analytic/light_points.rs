//! Points of lamps that are chosen for the surface that sees them: unbiased, finite, and nearly free of noise.

use super::{Numbers, even_pair};
use glam::{DVec3, Vec3};
use glassbox::scene::Lighting;
use glassbox::trace::shading::reflected;
use glassbox::trace::{LightPoint, ParallelogramLight, Receivers, SegmentLight, Surface};

fn panel(corner: Vec3, edges: [Vec3; 2], colors: [f32; 4]) -> ParallelogramLight {
    ParallelogramLight {
        id: 1,
        corner,
        edges,
        colors: colors.map(Vec3::splat),
        two_sided: true,
        visible: false,
        samples: 1,
    }
}

fn segment(ends: [Vec3; 2], colors: [f32; 2]) -> SegmentLight {
    SegmentLight {
        id: 1,
        ends,
        colors: colors.map(Vec3::splat),
        samples: 1,
    }
}

fn matt(normal: Vec3) -> Surface {
    Surface {
        diffuse: Vec3::ONE,
        ..Surface::flat(Vec3::ZERO, normal, normal)
    }
}

/// Mean and standard deviation of the mean of `n` values.
struct Mean {
    value: f64,
    error: f64,
}

impl Mean {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let (mut n, mut sum, mut squares) = (0.0, 0.0, 0.0);
        for value in values {
            n += 1.0;
            sum += value;
            squares += value * value;
        }
        let value = sum / n;
        Self {
            value,
            error: ((squares / n - value * value).max(0.0) / n).sqrt(),
        }
    }

    /// Standard deviation of a single value, as a part of the mean.
    fn relative_deviation(&self, n: u32) -> f64 {
        self.error * f64::from(n).sqrt() / self.value
    }
}

fn value(surface: &Surface, point: Option<LightPoint>) -> f64 {
    point.map_or(0.0, |point| {
        let value = reflected(surface, &point, Lighting::Physical);
        assert!(value.is_finite(), "{point:?}");
        f64::from(value.x)
    })
}

/// What the points of a panel that are chosen for a surface at the origin give.
fn chosen(light: &ParallelogramLight, surface: &Surface, n: u32) -> Mean {
    let frame = light.frame().unwrap();
    let mut numbers = Numbers(u64::from(n));
    Mean::of((0..n).map(|_| {
        let u = [numbers.unit(), numbers.unit()];
        value(surface, light.point_for(&frame, surface, Vec3::ZERO, u))
    }))
}

/// What its points give that are chosen evenly.
fn even(light: &ParallelogramLight, surface: &Surface, n: u32) -> Mean {
    let mut numbers = Numbers(u64::from(n) + 1);
    Mean::of((0..n).map(|_| {
        let u = [numbers.unit(), numbers.unit()];
        value(surface, light.point(Vec3::ZERO, u, Lighting::Physical))
    }))
}

#[test]
fn the_mean_over_a_panel_is_that_of_points_chosen_evenly_whatever_its_shape_size_and_side() {
    let mut numbers = Numbers(11);
    let (mut compared, mut worst) = (0, 0.0_f64);
    while compared < 150 {
        let scale = [1e-6_f32, 1e-3, 1.0, 1e3][compared % 4];
        let corner = scale * numbers.point(-1.5, 1.5);
        let edges = [
            scale * numbers.point(-1.0, 1.0),
            scale * numbers.point(-1.0, 1.0),
        ];
        let colors = [0, 1, 2, 3].map(|_| numbers.between(0.1, 4.0));
        let colors = if compared % 3 == 0 { [1.0; 4] } else { colors };
        let light = panel(corner, edges, colors);
        let mut surface = matt(numbers.direction());
        if compared % 2 == 0 {
            surface.specular = Vec3::splat(0.5);
            surface.shininess = numbers.between(1.0, 60.0);
            surface.to_viewer = (surface.normal + 0.8 * numbers.direction()).normalize();
        }
        let expected = even(&light, &surface, 40_000);
        // Evenly chosen points say little of a lamp close by: their own deviation must be known.
        if expected.value == 0.0 || expected.error > 0.02 * expected.value {
            continue;
        }
        let found = chosen(&light, &surface, 20_000);
        let z = (found.value - expected.value) / found.error.hypot(expected.error);
        worst = worst.max(z.abs());
        compared += 1;
    }
    assert!(worst < 4.0, "{worst:.2} standard deviations apart");
}

#[test]
fn a_one_sided_panel_shines_to_its_front_alone() {
    let light = ParallelogramLight {
        two_sided: false,
        ..panel(Vec3::new(-0.5, 1.0, -0.5), [Vec3::X, Vec3::Z], [1.0; 4])
    };
    let frame = light.frame().unwrap();
    let at = |y: f32, normal| light.point_for(&frame, &matt(normal), Vec3::Y * y, [0.3, 0.6]);
    // X × Z points down: the front is below.
    assert!(at(0.0, Vec3::Y).is_some());
    assert!(at(2.0, Vec3::NEG_Y).is_none());
    assert!(at(1.0, Vec3::Y).is_none(), "in its plane");
}

#[test]
fn the_density_integrates_to_one_over_what_is_above_the_horizon() {
    let mut numbers = Numbers(12);
    let (mut compared, mut worst) = (0, 0.0_f64);
    while compared < 40 {
        let edges = [numbers.point(-1.0, 1.0), numbers.point(-1.0, 1.0)];
        let light = panel(numbers.point(-1.5, 1.5), edges, [1.0, 3.0, 0.5, 2.0]);
        let surface = matt(numbers.direction());
        let frame = light.frame().unwrap();
        // The part of the light above the horizon, by a grid.
        let n = 300;
        let above = (0..n * n).filter(|i| {
            let [u, v] = [i % n, i / n].map(|i| (i as f32 + 0.5) / n as f32);
            let at = light.corner + u * edges[0] + v * edges[1];
            at.dot(surface.normal) > 0.0
        });
        let part = above.count() as f64 / f64::from(n * n);
        let normal = light.area_normal().normalize();
        if part < 0.1 || light.corner.dot(normal).abs() < 0.2 {
            continue;
        }
        // One over the density, on average over points chosen by it.
        let inverse = Mean::of((0..40_000).map(|i| {
            let point = light.point_for(&frame, &surface, Vec3::ZERO, even_pair(i));
            point.map_or(0.0, |point| 1.0 / f64::from(point.density))
        }));
        let off = (inverse.value - part).abs();
        worst = worst.max(off / (4.0 * inverse.error + 0.005));
        compared += 1;
    }
    assert!(worst < 1.0, "{worst:.2} of what is allowed");
}

#[test]
fn a_matt_floor_under_a_panel_gets_nearly_the_same_from_every_point() {
    // Few nodes follow the cosines less well the more of the sky the panel fills: 0.11 and 0.23 measured.
    for (height, most) in [
        (0.5, 0.05),
        (1.0, 0.02),
        (3.0, 0.005),
        (0.1, 0.15),
        (1e-3, 0.3),
    ] {
        for x in [0.0, 0.2, 0.45] {
            let corner = Vec3::new(-0.5 - x, height, -0.5);
            let light = panel(corner, [Vec3::X, Vec3::Z], [1.0; 4]);
            let n = 20_000;
            let found = chosen(&light, &matt(Vec3::Y), n).relative_deviation(n);
            assert!(found < most, "{height} m above, {x} m aside: {found:.3}");
        }
    }
}

#[test]
fn corner_colours_and_highlights_add_little_noise() {
    let corner = Vec3::new(-0.5, 1.0, -0.5);
    let n = 20_000;
    let gradient = panel(corner, [Vec3::X, Vec3::Z], [20.0, 8.0, 8.0, 0.5]);
    let found = chosen(&gradient, &matt(Vec3::Y), n).relative_deviation(n);
    assert!(found < 0.03, "gradient: {found:.3}");
    let glossy = Surface {
        specular: Vec3::splat(0.3),
        shininess: 50.0,
        to_viewer: Vec3::new(0.1, 0.99, 0.0).normalize(),
        ..matt(Vec3::Y)
    };
    let light = panel(corner, [Vec3::X, Vec3::Z], [1.0; 4]);
    let [found, before] = [chosen(&light, &glossy, n), even(&light, &glossy, n)]
        .map(|mean| mean.relative_deviation(n));
    assert!(
        found < 0.4 * before,
        "highlight: {found:.3} instead of {before:.3}"
    );
}

#[test]
fn points_are_finite_on_in_and_beside_a_lamp_and_far_away() {
    let light = panel(Vec3::new(-0.5, 0.0, -0.5), [Vec3::X, Vec3::Z], [1.0; 4]);
    let line = segment([Vec3::X * -0.5, Vec3::X * 0.5], [1.0, 2.0]);
    let (frame, line_frame) = (light.frame().unwrap(), line.frame().unwrap());
    let mut numbers = Numbers(13);
    let offsets = [
        0.0, 1e-30, 1e-12, 1e-6, 1e-3, 0.5, 1.0, 1e3, 1e9, 1e20, 3e38,
    ];
    for height in offsets {
        for aside in offsets {
            for _ in 0..20 {
                let mut surface = matt(numbers.direction());
                surface.specular = Vec3::splat(0.5 * numbers.unit().round());
                surface.shininess = 10.0_f32.powf(numbers.between(0.0, 30.0));
                let from = Vec3::new(aside, -height, 0.3 * aside);
                let u = [numbers.unit(), numbers.unit()];
                for point in [
                    light.point_for(&frame, &surface, from, u),
                    line.point_for(&line_frame, &surface, from, u[0]),
                ] {
                    value(&surface, point);
                    let place = point.map_or([0.5; 2], |point| point.place);
                    assert!(place.iter().all(|x| (0.0..=1.0).contains(x)), "{point:?}");
                }
            }
        }
    }
}

/// Simpson's rule over the logarithm of the distance to the nearest place of a line, on both sides of it.
fn line_irradiance(ends: [Vec3; 2], normal: Vec3) -> f64 {
    let [a, b] = ends.map(Vec3::as_dvec3);
    let (length, along) = ((b - a).length(), (b - a).normalize());
    let foot = (-a).dot(along);
    let gives = |t: f64| {
        let r: DVec3 = a + t * along;
        r.dot(normal.as_dvec3()).max(0.0) / r.length().powi(3)
    };
    // t = foot + d sinh s takes the peak's width out.
    let d = (a + foot * along).length().max(1e-9);
    let to = |t: f64| ((t - foot) / d).asinh();
    let (from, end) = (to(0.0), to(length));
    let n = 200_000;
    let step = (end - from) / f64::from(n);
    let at = |i: i32| {
        let s = from + step * f64::from(i);
        gives(foot + d * s.sinh()) * d * s.cosh()
    };
    let sum: f64 = (1..n)
        .map(|i| at(i) * if i % 2 == 0 { 2.0 } else { 4.0 })
        .sum();
    (sum + at(0) + at(n)) * step / 3.0
}

#[test]
fn every_point_of_a_segment_gives_a_matt_surface_its_closed_form() {
    let mut numbers = Numbers(14);
    let (mut compared, mut worst) = (0, 0.0_f64);
    while compared < 100 {
        let scale = [1e-6_f32, 1e-2, 1.0, 1e3][compared % 4];
        let ends = [0, 1].map(|_| scale * numbers.point(-1.0, 1.0));
        let surface = matt(numbers.direction());
        let expected = line_irradiance(ends, surface.normal) / std::f64::consts::PI;
        let light = segment(ends, [1.0; 2]);
        // A sliver at the horizon has few digits.
        if expected * f64::from(scale) < 0.05 {
            continue;
        }
        let frame = light.frame().unwrap();
        for i in 0..64 {
            let u = (i as f32 + 0.5) / 64.0;
            let found = value(&surface, light.point_for(&frame, &surface, Vec3::ZERO, u));
            worst = worst.max((found / expected - 1.0).abs());
        }
        compared += 1;
    }
    assert!(worst < 1e-4, "worst single point {worst:e}");
}

#[test]
fn the_mean_over_a_segment_is_the_integral_over_it_whatever_its_colours_and_the_highlight() {
    let mut numbers = Numbers(15);
    let (mut compared, mut worst) = (0, 0.0_f64);
    while compared < 60 {
        let ends = [0, 1].map(|_| numbers.point(-1.0, 1.0));
        let light = segment(ends, [numbers.between(0.1, 4.0), numbers.between(0.1, 4.0)]);
        let mut surface = matt(numbers.direction());
        if compared % 2 == 0 {
            surface.specular = Vec3::splat(0.5);
            surface.shininess = numbers.between(1.0, 60.0);
            surface.to_viewer = (surface.normal + 0.8 * numbers.direction()).normalize();
        }
        let frame = light.frame().unwrap();
        let n = 100_000;
        let mean = |point: &dyn Fn(f32) -> Option<LightPoint>| {
            let values = (0..n).map(|i| value(&surface, point((i as f32 + 0.5) / n as f32)));
            values.sum::<f64>() / f64::from(n)
        };
        let expected = mean(&|u| light.point(Vec3::ZERO, u, Lighting::Physical));
        if expected < 0.01 {
            continue;
        }
        let found = mean(&|u| light.point_for(&frame, &surface, Vec3::ZERO, u));
        worst = worst.max((found / expected - 1.0).abs());
        compared += 1;
    }
    assert!(worst < 1e-4, "{worst:e}");
}

#[test]
fn points_for_many_receivers_together_are_those_for_each_alone() {
    const N: usize = 64;
    let mut numbers = Numbers(16);
    let colors = [Vec3::ONE, Vec3::X, Vec3::Y, Vec3::Z];
    let edges = [numbers.point(-1.0, 1.0), numbers.point(-1.0, 1.0)];
    let light = ParallelogramLight {
        colors,
        ..panel(Vec3::ZERO, edges, [1.0; 4])
    };
    let line = segment([Vec3::ZERO, edges[0]], [1.0, 2.0]);
    let (frame, line_frame) = (light.frame().unwrap(), line.frame().unwrap());
    let mut columns = |low: f32, high: f32| [(); N].map(|()| numbers.between(low, high));
    let many = Receivers {
        from: [(); 3].map(|()| columns(-2.0, 2.0)),
        normal: [(); 3].map(|()| columns(-0.6, 0.6)),
        mirrored: [(); 3].map(|()| columns(-0.6, 0.6)),
        diffuse: columns(0.0, 1.0),
        specular: columns(0.0, 1.0),
        shininess: columns(1.0, 100.0),
    };
    let u = [columns(0.0, 1.0), columns(0.0, 1.0)];
    let panels = [frame.matt_places(&many, &u), frame.glossy_places(&many, &u)];
    let lines = [
        line_frame.matt_places(&many, &u[0]),
        line_frame.glossy_places(&many, &u[0]),
    ];
    for i in 0..N {
        let alone = |column: &[f32; N]| [column[i]];
        let one = Receivers {
            from: many.from.each_ref().map(alone),
            normal: many.normal.each_ref().map(alone),
            mirrored: many.mirrored.each_ref().map(alone),
            diffuse: alone(&many.diffuse),
            specular: alone(&many.specular),
            shininess: alone(&many.shininess),
        };
        let u = u.each_ref().map(alone);
        let of_one = [frame.matt_places(&one, &u), frame.glossy_places(&one, &u)];
        for (many, one) in panels.iter().zip(&of_one) {
            let found = [many.uv[0][i], many.uv[1][i], many.solid_angle[i]];
            let expected = [one.uv[0][0], one.uv[1][0], one.solid_angle[0]];
            assert_eq!(found.map(f32::to_bits), expected.map(f32::to_bits));
        }
        let of_one = [
            line_frame.matt_places(&one, &u[0]),
            line_frame.glossy_places(&one, &u[0]),
        ];
        for (many, one) in lines.iter().zip(&of_one) {
            let found = [many.u[i], many.arriving[i]].map(f32::to_bits);
            assert_eq!(found, [one.u[0], one.arriving[0]].map(f32::to_bits));
        }
    }
}
