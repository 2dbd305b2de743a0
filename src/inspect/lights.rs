//! The lights themselves, in their colours.

use super::color::of_radiance;
use super::line_set::{LineSet, Stands};
use super::{Subject, System};
use crate::trace::{DOME, Dome, ParallelogramLight, PointLight};
use bevy::color::LinearRgba;
use glam::Vec3;

/// Pieces of a gradient; between them colours are linear.
const PIECES: usize = 8;

/// A light without extent is drawn as large as this part of the distance to it.
const POINT_SIZE: f32 = 0.02;

/// A directional light's arrows are as long as this part of the distance to the scene's middle.
const ARROW_SIZE: f32 = 0.25;

/// Directions of a dome that are drawn: so many that a sun stands out from the sky.
const DOME_DIRECTIONS: u32 = 128;

/// Lights as lines: what has an extent with its gradient, a spot with its cone, a dome with directions that it is sampled
/// in.
pub(super) fn lights(subject: &Subject) -> LineSet {
    let mut set = LineSet::of(System::Lights, subject.inspect);
    let lights = &subject.world.lights;
    let dome = Dome::of(&subject.world.environment, subject.settings);
    if lights.count() == 0 && dome.is_none() {
        set.notes.push("there is no light".into());
    }
    let size = subject.distance(subject.middle());
    for light in &lights.points {
        draw_point(
            &mut set,
            light,
            POINT_SIZE * subject.distance(light.position),
        );
    }
    for light in &lights.directionals {
        // Three parallel arrows through the middle of the scene.
        let stands = Stands::Light(light.id);
        let color = color(light.color);
        let (x, y) = light.to_light.any_orthonormal_pair();
        let middle = subject.middle();
        for offset in [Vec3::ZERO, x, y] {
            let to = middle + offset * (POINT_SIZE * size);
            let from = to + light.to_light * (ARROW_SIZE * size);
            set.line([from, to], color, stands);
            for side in [x, -x] {
                let barb = to + (light.to_light + 0.5 * side) * (POINT_SIZE * size);
                set.line([to, barb], color, stands);
            }
        }
    }
    for light in &lights.segments {
        let along = |i: usize| i as f32 / PIECES as f32;
        let shown = one_scale(&light.colors);
        for i in 0..PIECES {
            let ends = [i, i + 1].map(|i| light.ends[0].lerp(light.ends[1], along(i)));
            let colors = [i, i + 1].map(|i| shown(light.colors[0].lerp(light.colors[1], along(i))));
            set.gradient(ends, colors, Stands::Light(light.id));
        }
    }
    for light in &lights.parallelograms {
        draw_parallelogram(&mut set, light);
    }
    if let Some(dome) = &dome {
        draw_dome(&mut set, subject, dome);
    }
    set
}

/// A short line for each direction, on a sphere around the scene, in the colour of what comes from there: many where it is
/// bright.
fn draw_dome(set: &mut LineSet, subject: &Subject, dome: &Dome) {
    let stands = Stands::Light(DOME);
    let (middle, far) = (subject.middle(), subject.far());
    let exposure = subject.settings.output.exposure;
    for i in 0..DOME_DIRECTIONS {
        // The golden ratio's multiples beside an even sequence: Fibonacci's lattice.
        let u = [
            (f64::from(i) * 0.618_033_988_749_894_9).fract() as f32,
            (i as f32 + 0.5) / DOME_DIRECTIONS as f32,
        ];
        let direction = dome.direction(u);
        let color = of_radiance(dome.radiance(direction), exposure);
        let ends = [1.0, 1.0 - POINT_SIZE].map(|part| middle + far * part * direction);
        set.line(ends, color, stands);
        set.dot(ends[1], color, stands);
    }
}

/// Colours of one light, so that its ends or corners can be compared.
fn one_scale(colors: &[Vec3]) -> impl Fn(Vec3) -> LinearRgba + use<> {
    let brightest = colors
        .iter()
        .fold(0.0_f32, |most, color| most.max(color.max_element()));
    let scale = if brightest > 0.0 {
        1.0 / brightest
    } else {
        1.0
    };
    move |color| of_radiance(scale * color, 0.0)
}

/// A light's hue, as bright as a screen shows it: strengths of lights have different units.
fn color(strength: Vec3) -> LinearRgba {
    one_scale(&[strength])(strength)
}

fn draw_point(set: &mut LineSet, light: &PointLight, size: f32) {
    let stands = Stands::Light(light.id);
    let color = color(light.color);
    for axis in Vec3::AXES {
        let ends = [light.position - size * axis, light.position + size * axis];
        set.line(ends, color, stands);
    }
    set.dot(light.position, color, stands);
    let Some(cone) = &light.cone else { return };
    let length = 6.0 * size;
    let (x, y) = cone.axis.any_orthonormal_pair();
    for versine in [cone.versine_inner, cone.versine_outer] {
        let (cosine, sine) = (1.0 - versine, (versine * (2.0 - versine)).sqrt());
        let center = light.position + length * cosine * cone.axis;
        set.circle(center, [x, y], length * sine, color, stands);
        for side in [x, -x, y, -y] {
            set.line(
                [light.position, center + length * sine * side],
                color,
                stands,
            );
        }
    }
}

/// A grid over the light, each line with its gradient, and its front's normal.
fn draw_parallelogram(set: &mut LineSet, light: &ParallelogramLight) {
    let stands = Stands::Light(light.id);
    let shown = one_scale(&light.colors);
    let place = |i: usize| i as f32 / PIECES as f32;
    let at = |u: f32, v: f32| light.corner + u * light.edges[0] + v * light.edges[1];
    for line in (0..=PIECES).step_by(2) {
        let fixed = place(line);
        for i in 0..PIECES {
            let (from, to) = (place(i), place(i + 1));
            for [a, b] in [[(from, fixed), (to, fixed)], [(fixed, from), (fixed, to)]] {
                let colors = [a, b].map(|(u, v)| shown(light.color(u, v)));
                set.gradient([at(a.0, a.1), at(b.0, b.1)], colors, stands);
            }
        }
    }
    let middle = at(0.5, 0.5);
    let normal = light.area_normal();
    let reach = 0.25 * normal.length().sqrt();
    let tip = middle + reach * normal.normalize_or_zero();
    set.line([middle, tip], shown(light.color(0.5, 0.5)), stands);
}
