//! The dome: an environment that lights, as one more light with points of its own.
//!
//! # Which directions
//! Some are chosen where the map is brighter than its mean (`dome_table`), all others where the surface reflects from:
//! by the cosine at a matt one, and by Phong's lobe about the mirrored viewer as often as ks counts beside kd. A
//! direction's density is the sum of all ways in which it may have been chosen, each times its share (the balance
//! heuristic of one sample: Veach 1997, "Robust Monte Carlo Methods for Light Transport Simulation", 9.2.4), so whatever
//! shines is counted once, and what one way seldom finds the other finds. A dome of one colour has no table: what it
//! gives to a matt surface in the open is the same from every direction.
//!
//! # What sees it besides
//! Camera, mirror and transmitted rays that meet nothing carry its radiance, whether it lights or not; of one that is hidden
//! from the camera mirrored ones alone, the others what is to be seen in its place. kd and ks get
//! theirs from here alone and km its from mirrored rays alone, as of every other light: nothing is counted twice.

use crate::scene::{Lighting, RenderSettings};
use crate::trace::math::disc::concentric;
use crate::trace::surfaces::shading::cosines;
use crate::trace::textures::dome_table::DomeTable;
use crate::trace::world::environment::{direction_at, equirectangular};
use crate::trace::{Environment, LightPoint, Surface, Texture};
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, PI, TAU};

/// The number by which the dome goes among lights: no entity has it.
pub const DOME: u64 = 0;

/// The whole sphere, in sr.
const SPHERE: f32 = 4.0 * PI;

/// An environment that lights.
#[derive(Clone, Copy, Debug)]
pub struct Dome<'a> {
    environment: &'a Environment,
    /// In use, and not the same everywhere.
    map: Option<(&'a Texture, &'a DomeTable)>,
    map_in_use: bool,
}

impl<'a> Dome<'a> {
    /// `None` where the environment lights nothing: where it is not to, or is black, or the lighting is Classic.
    pub fn of(environment: &'a Environment, settings: &RenderSettings) -> Option<Self> {
        let map_in_use = settings.features.environment;
        let lights = environment.lights
            && settings.lighting == Lighting::Physical
            && environment.brightest(map_in_use) != Vec3::ZERO;
        let map = environment.map.as_deref().filter(|_| map_in_use);
        lights.then(|| Self {
            environment,
            map: map.and_then(|map| Some((map, map.dome_table()?))),
            map_in_use,
        })
    }

    /// Shadow rays that it asks for at a first hit, per sr of [`Self::solid_angle`] where they are scaled by size.
    pub fn samples(&self) -> u32 {
        self.environment.samples
    }

    /// That of the whole sphere.
    pub fn solid_angle(&self) -> f32 {
        SPHERE
    }

    /// What arrives from a direction, of any length.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        if self.map_in_use {
            self.environment.radiance(direction)
        } else {
            self.environment.background
        }
    }

    /// The direction that the numbers `u` in [0, 1)² choose for a surface; `None` where that reflects nothing.
    pub fn point_for(&self, surface: &Surface, u: [f32; 2]) -> Option<LightPoint> {
        let specular_share = specular_share(surface)?;
        let share = self.map.map_or(0.0, |(_, table)| table.share);
        let direction = match self.map {
            Some((map, table)) if u[0] < share => {
                let place = table.place(map, [below_one(u[0] / share), u[1]]);
                direction_at(place, self.environment.rotation)
            }
            _ => {
                let number = below_one((u[0] - share) / (1.0 - share));
                reflected_from(surface, specular_share, [number, u[1]])
            }
        };
        let of_surface = reflection_density(surface, specular_share, direction);
        let density = share * self.density(direction) + (1.0 - share) * of_surface;
        let arriving = self.radiance(direction) / density;
        (density > 0.0 && arriving.is_finite()).then(|| LightPoint {
            direction,
            distance: f32::INFINITY,
            arriving,
            place: equirectangular(direction, self.environment.rotation).to_array(),
            density: density * SPHERE,
        })
    }

    /// The direction that the numbers `u` in [0, 1)² choose by what shines alone: where the map is brighter than its mean
    /// as often as that counts, else anywhere.
    pub fn direction(&self, u: [f32; 2]) -> Vec3 {
        let share = self.map.map_or(0.0, |(_, table)| table.share);
        let place = match self.map {
            Some((map, table)) if u[0] < share => table.place(map, [below_one(u[0] / share), u[1]]),
            _ => {
                let number = below_one((u[0] - share) / (1.0 - share));
                Vec2::new(number, (1.0 - 2.0 * u[1]).clamp(-1.0, 1.0).acos() / PI)
            }
        };
        direction_at(place, self.environment.rotation)
    }

    /// How likely the table chooses a direction, per sr.
    fn density(&self, direction: Vec3) -> f32 {
        let Some((map, table)) = self.map else {
            return 0.0;
        };
        let sine = direction.x.hypot(direction.z);
        if sine == 0.0 {
            return 0.0;
        }
        let place = equirectangular(direction, self.environment.rotation);
        // An area du dv of the map is 2π du · π dv · sin θ sr.
        table.density(map, place) / (TAU * PI * sine)
    }
}

/// Which part of a surface's directions the lobe chooses; `None` of a surface that reflects nothing.
fn specular_share(surface: &Surface) -> Option<f32> {
    let [diffuse, specular] = [surface.diffuse, surface.specular].map(|color| color.element_sum());
    let sum = diffuse + specular;
    (sum > 0.0).then(|| specular / sum)
}

/// A direction by the cosine about the normal, or by Phong's lobe about the mirrored viewer.
fn reflected_from(surface: &Surface, specular_share: f32, [u, v]: [f32; 2]) -> Vec3 {
    let n = surface.normal;
    if u < specular_share {
        let mirrored = 2.0 * n.dot(surface.to_viewer) * n - surface.to_viewer;
        let number = below_one(u / specular_share);
        // cos α = (1 - number)^(1/(s+1)), by its versine: near the axis a cosine has no digits left.
        let versine = -((-number).ln_1p() / (surface.shininess + 1.0)).exp_m1();
        let (sin, cos) = (TAU * v).sin_cos();
        let lateral = (versine * (2.0 - versine)).max(0.0).sqrt();
        let (x, y) = mirrored.any_orthonormal_pair();
        return (1.0 - versine) * mirrored + lateral * (cos * x + sin * y);
    }
    let number = below_one((u - specular_share) / (1.0 - specular_share));
    let p = concentric([number, v]);
    let (x, y) = n.any_orthonormal_pair();
    (1.0 - p.length_squared()).max(0.0).sqrt() * n + p.x * x + p.y * y
}

/// How likely [`reflected_from`] chooses a direction, per sr.
fn reflection_density(surface: &Surface, specular_share: f32, direction: Vec3) -> f32 {
    let [cosine, lobe] = cosines(surface, direction).map(|cosine| cosine.clamp(0.0, 1.0));
    let mut density = (1.0 - specular_share) * FRAC_1_PI * cosine;
    if specular_share > 0.0 {
        let s = surface.shininess;
        density += specular_share * (s + 1.0) / TAU * lobe.powf(s);
    }
    density
}

/// Divisions of numbers below 1 may round to 1.
fn below_one(number: f32) -> f32 {
    number.clamp(0.0, 1.0 - 0.5 * f32::EPSILON)
}
