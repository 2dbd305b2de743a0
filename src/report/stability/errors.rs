//! Cases of the error that a picture tells of itself: what no sample has met, and lamps close by.

use super::scenes::{flat, quad, world};
use super::{Effort, Outcome};
use crate::film::{RELATIVE_FLOOR, Rendered, render};
use crate::scene::{RenderSettings, Sampling};
use crate::trace::{
    Camera, Environment, Lights, Material, ParallelogramLight, SegmentLight, World,
};
use glam::{UVec2, Vec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

/// A square of edge 2 m around the origin fills the picture.
fn facing_camera() -> Camera {
    Camera::looking_at(Vec3::Z, Vec3::ZERO, Vec3::Y, FRAC_PI_2 as f32)
}

/// Specks that glow before an even background.
struct Specks {
    /// Pixels along each side of the picture.
    side: u32,
    /// Where they are, in pixels: each covers the same part of another pixel.
    places: &'static [[u32; 2]],
    /// Of a pixel.
    covers: f32,
    glows: f32,
    background: f32,
}

impl Specks {
    fn world(&self) -> World {
        let pixel = 2.0 / self.side as f32;
        let edge = pixel * self.covers.sqrt();
        let corner = |i: u32| (i as f32 + 0.37) * pixel - 1.0;
        let squares: Vec<Vec3> = (self.places.iter())
            .flat_map(|&[x, y]| {
                let corner = Vec3::new(corner(x), corner(y), 0.0);
                quad(corner, Vec3::X * edge, Vec3::Y * edge)
            })
            .collect();
        let glowing = Material {
            diffuse: Vec3::ZERO,
            emission: Vec3::splat(self.glows),
            ..Material::default()
        };
        let mut scene = world(vec![flat(1, &squares, 0)], vec![glowing]);
        scene.environment = Environment {
            background: Vec3::splat(self.background),
            ..Environment::default()
        };
        scene
    }

    /// What they add to the picture's mean.
    fn light(&self) -> f64 {
        let part = self.places.len() as f64 * f64::from(self.covers) / f64::from(self.side).powi(2);
        part * f64::from(self.glows - self.background)
    }

    fn render(&self, world: &World, seed: u32) -> Rendered {
        let settings = RenderSettings {
            size: UVec2::splat(self.side),
            spp: 1 << 16,
            seed,
            sampling: Sampling {
                adaptive: true,
                error: 0.05,
                time: 0.0,
            },
            ..RenderSettings::default()
        };
        render(world, &facing_camera(), &settings, &|_, _| {})
    }
}

const SPECKS: [Specks; 3] = [
    Specks {
        side: 16,
        places: &[[3, 4], [9, 13], [12, 7]],
        covers: 0.025,
        glows: 30.0,
        background: 0.0,
    },
    Specks {
        side: 16,
        places: &[[5, 5], [11, 2]],
        covers: 0.04,
        glows: 20.0,
        background: 0.1,
    },
    Specks {
        side: 24,
        places: &[[4, 20]],
        covers: 0.09,
        glows: 40.0,
        background: 0.0,
    },
];

/// Pictures that end at an error of 5 %: whether the light of what few samples meet is all there on average.
pub(super) fn rare_features(effort: &Effort) -> Outcome {
    let seeds = (effort.rays / 400).clamp(50, 300) as u32;
    let (mut samples, mut figures, mut faults) = (0.0, Vec::new(), Vec::new());
    for specks in SPECKS {
        let world = specks.world();
        let (mut sum, mut squares, mut nothing) = (0.0, 0.0, 0);
        for i in 0..seeds {
            let rendered = specks.render(&world, effort.seed as u32 + i);
            let pixels = &rendered.picture.pixels;
            let mean = pixels.iter().map(|p| f64::from(p.x)).sum::<f64>() / pixels.len() as f64;
            let light = (mean - f64::from(specks.background)) / specks.light();
            sum += light;
            squares += light * light;
            samples += rendered.status.samples * pixels.len() as f64;
            let error = rendered.status.error();
            nothing += u32::from(error.is_none_or(|error| error.to_string() == "0.00 %"));
        }
        let n = f64::from(seeds);
        let mean = sum / n;
        let deviation = ((squares / n - mean * mean) / (n - 1.0)).sqrt();
        let z = (mean - 1.0) / deviation;
        figures.push(format!("{:.1} % of the light, z = {z:.1}", 100.0 * mean));
        if z.abs() >= 3.0 {
            faults.push(format!("z = {z:.1} over {seeds} seeds"));
        }
        if nothing > 0 {
            faults.push(format!("{nothing} pictures tell no error"));
        }
    }
    let blank = Specks {
        places: &[],
        ..SPECKS[1]
    };
    let error = blank.render(&blank.world(), 0).status.error();
    let told = error.map_or_else(String::new, |error| error.to_string());
    figures.push(format!("of an even picture: {told}"));
    let outcome = Outcome::new(samples as usize, figures.join("; "));
    let outcome = outcome.require(
        told.starts_with("at most"),
        "an even picture tells no bound",
    );
    (faults.into_iter()).fold(outcome, |outcome, fault| outcome.require(false, fault))
}

/// A lamp of radiance 1 W/(sr·m²), or of 1 W/(sr·m), 1 m long, so high above the middle of a floor.
#[derive(Clone, Copy)]
enum Lamp {
    Panel(f32),
    Segment(f32),
}

const LAMPS: [(&str, Lamp); 4] = [
    ("panel 1 mm", Lamp::Panel(1e-3)),
    ("1 cm", Lamp::Panel(1e-2)),
    ("10 cm", Lamp::Panel(0.1)),
    ("segment 2 mm", Lamp::Segment(2e-3)),
];

const KD: f64 = 0.8;
/// Pixels along each side of the picture, and the edge of what it shows, in metres.
const SIDE: u32 = 24;
const SHOWN: f64 = 0.2;

impl Lamp {
    fn world(self) -> World {
        let corner = Vec3::new(-5.0, 0.0, -5.0);
        let floor = quad(corner, Vec3::Z * 10.0, Vec3::X * 10.0);
        let mut scene = world(vec![flat(1, &floor, 0)], vec![Material::default()]);
        let mut lights = Lights::default();
        match self {
            Self::Panel(height) => lights.parallelograms.push(ParallelogramLight {
                id: 9,
                corner: Vec3::new(-0.5, height, -0.5),
                edges: [Vec3::X, Vec3::Z],
                colors: [Vec3::ONE; 4],
                two_sided: false,
                visible: false,
                samples: 1,
            }),
            Self::Segment(height) => lights.segments.push(SegmentLight {
                id: 9,
                ends: [-0.5, 0.5].map(|x| Vec3::new(x, height, 0.0)),
                colors: [Vec3::ONE; 2],
                samples: 1,
            }),
        }
        scene.lights = Arc::new(lights);
        scene.with_needs()
    }

    /// Radiance of a place of the floor. A panel's by the form factor of a parallel rectangle, from its
    /// four quarters (Siegel and Howell, "Thermal Radiation Heat Transfer", configuration B-3).
    fn radiance(self, x: f64, z: f64) -> f64 {
        let sides = |x: f64| [0.5 - x, 0.5 + x];
        match self {
            Self::Panel(height) => {
                let quarter = |x: f64, z: f64| {
                    let [a, b] = [x, z].map(|side| side / f64::from(height));
                    let part = |a: f64, b: f64| a / a.hypot(1.0) * (b / a.hypot(1.0)).atan();
                    (part(a, b) + part(b, a)) / TAU
                };
                let parts = sides(x).map(|x| sides(z).map(|z| quarter(x, z)));
                KD * parts.iter().flatten().sum::<f64>()
            }
            Self::Segment(height) => {
                let height = f64::from(height);
                let squared = height * height + z * z;
                let ends = sides(x).map(|end| end / (end * end + squared).sqrt());
                KD / PI * height / squared * (ends[0] + ends[1])
            }
        }
    }

    /// The mean over a pixel, along each line of it across a segment.
    fn pixel(self, x: u32, y: u32) -> f64 {
        const STEPS: u32 = 400;
        let size = SHOWN / f64::from(SIDE);
        let place = |i: f64| i * size - 0.5 * SHOWN;
        let across = (0..STEPS).map(|i| {
            let part = (f64::from(i) + 0.5) / f64::from(STEPS);
            self.radiance(place(f64::from(x) + 0.5), place(f64::from(y) + part))
        });
        across.sum::<f64>() / f64::from(STEPS)
    }
}

/// The error told against the true one where a lamp is close to what it shines on.
pub(super) fn near_lamps(effort: &Effort) -> Outcome {
    let seeds = (effort.rays / 5_000).clamp(4, 20) as u32;
    // From 1 m above, through the lamp, which is not to be seen.
    let angle = 2.0 * (0.5 * SHOWN).atan();
    let camera = Camera::looking_at(Vec3::Y, Vec3::ZERO, Vec3::NEG_Z, angle as f32);
    let (mut samples, mut figures, mut faults) = (0, Vec::new(), Vec::new());
    for (name, lamp) in LAMPS {
        let world = lamp.world();
        let truth: Vec<f64> = (0..SIDE * SIDE)
            .map(|i| lamp.pixel(i % SIDE, i / SIDE))
            .collect();
        let mut factors = Vec::new();
        for spp in [16, 64, 256] {
            let (mut least, mut most) = (f64::MAX, 0.0_f64);
            for i in 0..seeds {
                let settings = RenderSettings {
                    size: UVec2::splat(SIDE),
                    spp,
                    seed: effort.seed as u32 + i,
                    ..RenderSettings::default()
                };
                let rendered = render(&world, &camera, &settings, &|_, _| {});
                let square = |(pixel, truth): (&Vec3, &f64)| {
                    (f64::from(pixel.x) - truth).powi(2) / (truth * truth + RELATIVE_FLOOR)
                };
                let pixels = rendered.picture.pixels.iter().zip(&truth);
                let squares: f64 = pixels.map(square).sum();
                let true_error = (squares / truth.len() as f64).sqrt();
                let told = rendered
                    .status
                    .error()
                    .map_or(0.0, |error| error.relative());
                let factor = told / true_error;
                (least, most) = (least.min(factor), most.max(factor));
                samples += truth.len() * spp as usize;
            }
            if least < 0.5 || most > 2.0 {
                faults.push(format!("{name}, {spp} spp: {least:.2} to {most:.2}"));
            }
            factors.push(format!("{least:.2}–{most:.2}"));
        }
        figures.push(format!("{name}: {}", factors.join(", ")));
    }
    let outcome = Outcome::new(samples, figures.join("; "));
    (faults.into_iter()).fold(outcome, |outcome, fault| outcome.require(false, fault))
}
