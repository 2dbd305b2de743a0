//! Cases of the error that a picture tells of itself: what no sample has met, and lamps close by.

use super::scenes::{flat, quad, world};
use super::{Effort, Outcome};
use crate::film::{RELATIVE_FLOOR, Rendered, render};
use crate::scene::{RenderSettings, Sampling};
use crate::trace::{
    Camera, Environment, Lights, Material, ParallelogramLight, PointLight, SegmentLight, World,
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

/// A lamp of radiance 1 W/(sr·m²), or of 1 W/(sr·m), 1 m long, or of 1 W/sr, so high above the middle of a floor.
#[derive(Clone, Copy)]
enum Lamp {
    Panel(f32),
    Segment(f32),
    Point(f32),
}

const LAMPS: [(&str, Lamp); 5] = [
    ("panel 1 mm", Lamp::Panel(1e-3)),
    ("1 cm", Lamp::Panel(1e-2)),
    ("10 cm", Lamp::Panel(0.1)),
    ("segment 2 mm", Lamp::Segment(2e-3)),
    ("point 1 cm", Lamp::Point(1e-2)),
];

/// Most of whose light falls into one pixel, which is then most of the picture's error. What that pixel errs by and what
/// it moved by are two numbers of chance, so their ratio is any (`film/errors/error.rs`); on average over many pictures it is not.
const IN_ONE_PIXEL: Lamp = Lamp::Point(1e-3);
const SEEDS_OF_ONE_PIXEL: u32 = 64;
/// 1.9 to 2.2 with 16 and 64 samples: what moved a pixel far is taken for rare.
const MOST_OF_ONE_PIXEL: f64 = 3.0;

/// Where a point lamp stands, in metres along x and z: not where pixels meet.
const ASIDE: [f32; 2] = [0.0025, 0.0037];

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
            Self::Point(height) => lights.points.push(PointLight {
                id: 9,
                position: Vec3::new(ASIDE[0], height, ASIDE[1]),
                color: Vec3::ONE,
                cone: None,
            }),
        }
        scene.lights = Arc::new(lights);
        scene.with_needs()
    }

    /// Radiance of a place of the floor, but for a point's. A panel's by the form factor of a parallel rectangle, from its
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
            Self::Point(_) => f64::NAN,
        }
    }

    /// The mean over a pixel: along each line of it across a segment, and below a point by the solid angle of the pixel.
    fn pixel(self, x: u32, y: u32) -> f64 {
        const STEPS: u32 = 400;
        let size = SHOWN / f64::from(SIDE);
        let place = |i: f64| i * size - 0.5 * SHOWN;
        if let Self::Point(height) = self {
            let height = f64::from(height);
            let corner = |x: f64, z: f64| {
                let [x, z] = [x - f64::from(ASIDE[0]), z - f64::from(ASIDE[1])];
                (x * z).atan2(height * (height * height + x * x + z * z).sqrt())
            };
            let [x, z] = [x, y].map(|i| [place(f64::from(i)), place(f64::from(i) + 1.0)]);
            let angle =
                corner(x[1], z[1]) - corner(x[0], z[1]) - corner(x[1], z[0]) + corner(x[0], z[0]);
            return KD / PI * angle / (size * size);
        }
        let across = (0..STEPS).map(|i| {
            let part = (f64::from(i) + 0.5) / f64::from(STEPS);
            self.radiance(place(f64::from(x) + 0.5), place(f64::from(y) + part))
        });
        across.sum::<f64>() / f64::from(STEPS)
    }
}

/// A lamp's floor, seen from 1 m above, through the lamp, which is not to be seen.
struct Floor {
    world: World,
    camera: Camera,
    truth: Vec<f64>,
}

impl Floor {
    fn below(lamp: Lamp) -> Self {
        let angle = 2.0 * (0.5 * SHOWN).atan();
        Self {
            world: lamp.world(),
            camera: Camera::looking_at(Vec3::Y, Vec3::ZERO, Vec3::NEG_Z, angle as f32),
            truth: (0..SIDE * SIDE)
                .map(|i| lamp.pixel(i % SIDE, i / SIDE))
                .collect(),
        }
    }

    /// What a picture says of the floor.
    fn seen(&self, spp: u32, seed: u32) -> Seen {
        let settings = RenderSettings {
            size: UVec2::splat(SIDE),
            spp,
            seed,
            ..RenderSettings::default()
        };
        let rendered = render(&self.world, &self.camera, &settings, &|_, _| {});
        let square = |(pixel, truth): (&Vec3, &f64)| {
            (f64::from(pixel.x) - truth).powi(2) / (truth * truth + RELATIVE_FLOOR)
        };
        let pixels = &rendered.picture.pixels;
        let squares: f64 = pixels.iter().zip(&self.truth).map(square).sum();
        let light: f64 = pixels.iter().map(|pixel| f64::from(pixel.x)).sum();
        let told = rendered.status.error();
        Seen {
            told: told.map_or(0.0, |error| error.relative()),
            error: (squares / self.truth.len() as f64).sqrt(),
            light: light / self.truth.iter().sum::<f64>(),
        }
    }
}

/// What a picture of a floor says.
struct Seen {
    /// The relative error that it tells.
    told: f64,
    /// The true one.
    error: f64,
    /// The light that is seen, as a part of all there is.
    light: f64,
}

/// The error told against the true one where a lamp is close to what it shines on.
pub(super) fn near_lamps(effort: &Effort) -> Outcome {
    let seeds = (effort.rays / 5_000).clamp(4, 20) as u32;
    let (mut samples, mut figures, mut faults) = (0, Vec::new(), Vec::new());
    let mut count = |spp: u32| samples += (SIDE * SIDE * spp) as usize;
    for (name, lamp) in LAMPS {
        let floor = Floor::below(lamp);
        let mut factors = Vec::new();
        for spp in [16, 64, 256] {
            let (mut least, mut most) = (f64::MAX, 0.0_f64);
            for i in 0..seeds {
                let seen = floor.seen(spp, effort.seed as u32 + i);
                let factor = seen.told / seen.error;
                (least, most) = (least.min(factor), most.max(factor));
                if (seen.light - 1.0).abs() > 0.02 {
                    let light = 100.0 * seen.light;
                    faults.push(format!("{name}, {spp} spp: {light:.1} % of the light"));
                }
                count(spp);
            }
            if least < 0.5 || most > 2.0 {
                faults.push(format!("{name}, {spp} spp: {least:.2} to {most:.2}"));
            }
            factors.push(format!("{least:.2}–{most:.2}"));
        }
        figures.push(format!("{name}: {}", factors.join(", ")));
    }
    let floor = Floor::below(IN_ONE_PIXEL);
    let factors = [16, 64].map(|spp| {
        let mut squares = [0.0; 2];
        for i in 0..SEEDS_OF_ONE_PIXEL {
            let seen = floor.seen(spp, effort.seed as u32 + i);
            squares[0] += seen.told * seen.told;
            squares[1] += seen.error * seen.error;
            count(spp);
        }
        (squares[0] / squares[1]).sqrt()
    });
    for factor in factors {
        if !(0.5..MOST_OF_ONE_PIXEL).contains(&factor) {
            faults.push(format!("point 1 mm, root mean square: {factor:.2}"));
        }
    }
    let factors = factors.map(|factor| format!("{factor:.2}"));
    figures.push(format!(
        "point 1 mm, in one pixel, root mean square over {SEEDS_OF_ONE_PIXEL} pictures of 16 and 64: {}",
        factors.join(", ")
    ));
    let outcome = Outcome::new(samples, figures.join("; "));
    (faults.into_iter()).fold(outcome, |outcome, fault| outcome.require(false, fault))
}
