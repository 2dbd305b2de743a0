//! A sample's value, worked out again in f64 from the JSON of its rays by the formulas of the model;
//! and the sample evaluated alone against what the film adds.

use super::Scene;
use crate::analytic::Numbers;
use glam::{DVec3, UVec2, Vec3};
use glassbox::film::{Sum, render_samples};
use glassbox::inspect::Document;
use glassbox::io::builtin::SCENES;
use glassbox::scene::Lighting;
use glassbox::trace::{Environment, Lights, MovingLight, PointLight, Samples, probe};
use serde_json::Value;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

const SIZE: UVec2 = UVec2::new(40, 30);

/// The document of one sample, read back.
struct Recomputed {
    json: Value,
    children: BTreeMap<usize, Vec<usize>>,
    has_map: bool,
}

fn vector(value: &Value) -> DVec3 {
    let number = |i: usize| value[i].as_f64().unwrap_or(f64::INFINITY);
    DVec3::new(number(0), number(1), number(2))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::INFINITY)
}

impl Recomputed {
    fn new(text: &str, has_map: bool) -> Self {
        let json: Value = serde_json::from_str(text).unwrap();
        let mut children: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (i, ray) in json["rays"].as_array().unwrap().iter().enumerate() {
            if let Some(parent) = ray["parent"].as_u64() {
                children.entry(parent as usize).or_default().push(i);
            }
        }
        Self {
            json,
            children,
            has_map,
        }
    }

    fn setting(&self, path: &str) -> &str {
        self.json["settings"][path].as_str().unwrap()
    }

    fn physical(&self) -> bool {
        self.setting("lighting") == "Physical"
    }

    /// L along a ray, from what it met and from its children.
    fn radiance(&self, ray: usize) -> DVec3 {
        let of = &self.json["rays"][ray];
        match of["end"].as_str().unwrap() {
            "background" if self.has_map => vector(&of["radiance"]),
            "background" => vector(&self.json["background"]),
            "light" => self.seen_light(of),
            "surface" => self.surface(ray, &of["hit"]),
            other => panic!("a path ends at {other}"),
        }
    }

    fn surface(&self, ray: usize, hit: &Value) -> DVec3 {
        let d = number(&hit["opacity"]);
        let mut sum = DVec3::ZERO;
        if self.setting("features.shading") == "false" {
            sum += d * vector(&hit["diffuse"]);
        } else if self.physical() {
            sum += d * vector(&hit["emission"]);
        }
        for &child in self.children.get(&ray).map_or(&[][..], Vec::as_slice) {
            let of = &self.json["rays"][child];
            let share = 1.0 / (number(&of["count"]) * number(&of["chance"]));
            sum += match of["kind"].as_str().unwrap() {
                "mirror" | "gloss" => d * vector(&hit["mirror"]) * share * self.radiance(child),
                "transmission" | "translucency" => (1.0 - d) * share * self.radiance(child),
                "shadow" | "light-sample" => d * share * self.direct(of, hit),
                other => panic!("a {other} ray leaves a surface"),
            };
        }
        sum
    }

    /// One light sample: what arrives times what is reflected of it.
    fn direct(&self, ray: &Value, hit: &Value) -> DVec3 {
        let sample = &ray["light"];
        let through = self.transmittance(ray);
        let (l, n, v) = (
            vector(&sample["direction"]),
            vector(&hit["normal"]),
            vector(&hit["to_viewer"]),
        );
        let (cosine, lobe) = (number(&sample["n_dot_l"]), number(&sample["r_dot_v"]));
        // The cosines of the document are those of its vectors; taken as they are, since a power of
        // hundreds multiplies their last digit.
        assert!(
            (n.dot(l) - cosine).abs() < 1e-6,
            "n·l {} and {cosine}",
            n.dot(l)
        );
        let r = 2.0 * n.dot(l) * n - l;
        assert!(
            (r.dot(v) - lobe).abs() < 2e-6,
            "r·v {} and {lobe}",
            r.dot(v)
        );
        let (kd, ks) = (vector(&hit["diffuse"]), vector(&hit["specular"]));
        let s = number(&hit["shininess"]);
        let arriving = self.arriving(ray, hit);
        let lobe = lobe.max(0.0).powf(s);
        if !self.physical() {
            let lights: usize = ["points", "directionals", "segments", "parallelograms"]
                .iter()
                .map(|kind| self.json["lights"][kind].as_array().unwrap().len())
                .sum();
            return arriving * through * (kd * cosine.max(0.0) + ks * lobe) / lights as f64;
        }
        if cosine <= 0.0 || vector(&hit["geometric_normal"]).dot(l) <= 0.0 {
            return DVec3::ZERO;
        }
        arriving * through * cosine * (kd / PI + ks * ((s + 2.0) / (2.0 * PI)) * lobe)
    }

    fn transmittance(&self, ray: &Value) -> DVec3 {
        match ray["end"].as_str().unwrap() {
            "blocked" | "left-out" => DVec3::ZERO,
            "arrived" => ray["crossings"]
                .as_array()
                .unwrap()
                .iter()
                .map(|crossing| {
                    let d = number(&crossing["opacity"]);
                    (1.0 - d) * DVec3::ONE.lerp(vector(&crossing["diffuse"]), d)
                })
                .product(),
            _ => DVec3::ONE,
        }
    }

    fn light(&self, kind: &str, id: &Value) -> &Value {
        let all = self.json["lights"][kind].as_array().unwrap();
        all.iter().find(|light| light["id"] == *id).unwrap()
    }

    /// How far a light has come by the time of a ray.
    fn way(&self, ray: &Value, id: &Value) -> DVec3 {
        let all = self.json["lights"]["moving"].as_array().unwrap();
        let light = all.iter().find(|light| light["id"] == *id);
        light.map_or(DVec3::ZERO, |light| {
            number(&ray["time"]) * vector(&light["velocity"])
        })
    }

    /// What arrives of a light point: MODEL's table of lights.
    fn arriving(&self, ray: &Value, hit: &Value) -> DVec3 {
        let sample = &ray["light"];
        let kind = sample["kind"].as_str().unwrap();
        if kind == "dome" {
            return self.arriving_from_dome(sample, hit);
        }
        let light = self.light(&format!("{kind}s"), &sample["id"]);
        let (u, v) = (number(&sample["place"][0]), number(&sample["place"][1]));
        // As seen by one who moves with the light.
        let from = vector(&hit["position"]) - self.way(ray, &sample["id"]);
        let physical = self.physical();
        // A likelier place counts less.
        let density = number(&sample["density"]);
        // What would arrive inside the cone, or from straight before the light.
        let mut full = 0.0_f64;
        let arriving = match kind {
            "point" => {
                let way = vector(&light["position"]) - from;
                let fall_off = if physical {
                    1.0 / way.length_squared()
                } else {
                    1.0
                };
                let color = vector(&light["color"]) * fall_off;
                full = color.max_element();
                color * cone(&light["cone"], -way.normalize())
            }
            "directional" => {
                let counts = disc(&light["disc"], &light["to_light"], &sample["direction"]);
                vector(&light["color"]) * if physical { counts } else { 1.0 }
            }
            "segment" => {
                let [a, b] = [0, 1].map(|i| vector(&light["ends"][i]));
                let way = a.lerp(b, u) - from;
                let color = vector(&light["colors"][0]).lerp(vector(&light["colors"][1]), u);
                if physical {
                    color * (b - a).length() / (way.length_squared() * density)
                } else {
                    color
                }
            }
            _ => {
                let [a, b] = [0, 1].map(|i| vector(&light["edges"][i]));
                let way = vector(&light["corner"]) + u * a + v * b - from;
                let color = bilinear(light, u, v);
                if physical {
                    let squared = way.length_squared() * density;
                    full = color.max_element() * a.cross(b).length() / squared;
                    let cosine = -way.normalize().dot(a.cross(b));
                    let cosine = if light["two_sided"] == true {
                        cosine.abs()
                    } else {
                        cosine
                    };
                    color * cosine / squared
                } else {
                    color
                }
            }
        };
        let said = vector(&sample["arriving"]);
        let error = (arriving - said).abs().max_element();
        assert!(
            error <= 1e-5 * said.abs().max_element().max(full) + 1e-12,
            "{kind}: {arriving} arrives, the document says {said}"
        );
        // Taken as the document has it: at the rim of a spot, and along a light's own plane, f32 cancels.
        said
    }

    /// Of a dome of one colour, whose directions are chosen by the cosine at a matt surface.
    fn arriving_from_dome(&self, sample: &Value, hit: &Value) -> DVec3 {
        let density = number(&sample["density"]);
        let said = vector(&sample["arriving"]);
        let arriving = vector(&self.json["background"]) * (4.0 * PI / density);
        let error = (arriving - said).abs().max_element();
        assert!(
            self.json["environment_lights"] == true
                && error <= 1e-5 * said.abs().max_element() + 1e-12,
            "{arriving} arrives from the dome, the document says {said}"
        );
        if vector(&hit["specular"]) == DVec3::ZERO {
            let expected = 4.0 * number(&sample["n_dot_l"]);
            // Along the surface f32 cancels.
            let error = (density - expected).abs();
            assert!(error <= 1e-4 * expected + 1e-5, "{density}, not {expected}");
        }
        said
    }

    /// Radiance of a light that a path met.
    fn seen_light(&self, ray: &Value) -> DVec3 {
        let light = self.light("parallelograms", &ray["met_light"]);
        let [a, b] = [0, 1].map(|i| vector(&light["edges"][i]));
        let at = vector(&ray["origin"]) + number(&ray["t"]) * vector(&ray["direction"]);
        let at = at - self.way(ray, &ray["met_light"]) - vector(&light["corner"]);
        let normal = a.cross(b);
        let u = at.cross(b).dot(normal) / normal.length_squared();
        let v = a.cross(at).dot(normal) / normal.length_squared();
        bilinear(light, u, v)
    }
}

fn bilinear(light: &Value, u: f64, v: f64) -> DVec3 {
    let c = [0, 1, 2, 3].map(|i| vector(&light["colors"][i]));
    c[0].lerp(c[1], u).lerp(c[2].lerp(c[3], u), v)
}

/// Radiance over density of a direction of a sun, its irradiance on a facing surface being 1: trace/sun_disc.rs.
fn disc(disc: &Value, to_light: &Value, direction: &Value) -> f64 {
    if disc.is_null() {
        return 1.0;
    }
    let cosine = number(&disc["cos_half_angle"]);
    let k = (0.125 - cosine).max(0.0);
    (1.0 + 2.0 * k / (1.0 + cosine)) / (vector(to_light).dot(vector(direction)) + k)
}

/// A spot's share: a smoothstep of the cosine between its two half-angles.
fn cone(cone: &Value, leaving: DVec3) -> f64 {
    if cone.is_null() {
        return 1.0;
    }
    let [inner, outer] = ["versine_inner", "versine_outer"].map(|name| number(&cone[name]));
    let versine = 1.0 - vector(&cone["axis"]).dot(leaving);
    let x = ((outer - versine) / (outer - inner)).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// Compares `count` random samples of a scene; the largest relative error.
fn check(scene: &Scene, name: &str, count: usize) -> f64 {
    let names = BTreeMap::new();
    let mut numbers = Numbers(count as u64 + name.len() as u64);
    let mut worst = 0.0_f64;
    let samples = u64::from(glassbox::trace::samples_per_pixel(
        &scene.world,
        &scene.camera,
        &scene.settings,
    ));
    for _ in 0..count {
        let size = scene.settings.size.as_vec2();
        let pixel = UVec2::new(
            (numbers.unit() * size.x) as u32,
            (numbers.unit() * size.y) as u32,
        );
        let index = (numbers.unit() * samples as f32) as u64;
        let (world, camera, settings) = (&scene.world, &scene.camera, &scene.settings);
        let rays = probe(world, camera, settings, pixel, &Samples::One(index)).unwrap();
        let value = rays.samples[0].value;
        assert_eq!(
            rays.sums()[0],
            value,
            "{name}: the rays of sample {index} of {pixel}"
        );
        let document = Document::new((name, ""), world, settings, &rays, &names);
        let text = serde_json::to_string(&document).unwrap();
        let found = Recomputed::new(&text, world.environment.map.is_some()).radiance(0);
        let value = value.as_dvec3();
        let error = (found - value).abs().max_element() / value.abs().max_element().max(1e-9);
        assert!(
            error <= 1e-5,
            "{name}: sample {index} of pixel {pixel} is {value}, by its rays {found}: {error:.1e}"
        );
        worst = worst.max(error);
    }
    worst
}

#[test]
fn values_recomputed_from_the_exported_rays_are_the_samples_on_every_built_in_scene() {
    for scene in SCENES {
        let worst = check(&Scene::open(scene.name, SIZE), scene.name, 200);
        println!("{}: largest relative error {worst:.1e}", scene.name);
    }
}

#[test]
fn so_they_are_with_every_effect_and_with_the_classic_lighting() {
    let open = || Scene::open("showcase", SIZE);
    let glass = |scene: &mut Scene, opacity: f32| {
        let mut materials = Vec::clone(&scene.world.materials);
        materials.iter_mut().for_each(|m| m.opacity = opacity);
        scene.world.materials = Arc::new(materials);
        scene.world = scene.world.clone().with_needs();
    };
    let mut scene = open();
    scene.settings.features.glossy = true;
    scene.settings.gloss_samples = 3;
    check(&scene, "gloss", 60);
    scene = open();
    scene.settings.lighting = Lighting::Classic;
    check(&scene, "classic", 60);
    scene = open();
    scene.settings.features.shadows = false;
    check(&scene, "no shadows", 60);
    scene = open();
    scene.settings.features.soft_shadows = false;
    check(&scene, "no soft shadows", 30);
    scene = open();
    scene.settings.features.shading = false;
    check(&scene, "no shading", 30);
    scene = open();
    glass(&mut scene, 0.6);
    scene.settings.max_depth = 3;
    check(&scene, "transparency", 60);
    scene.settings.features.translucency = true;
    scene.settings.translucency_samples = 2;
    check(&scene, "translucency", 20);
    scene = open();
    scene.camera.optics.aperture_radius = 0.05;
    scene.camera.optics.focus_distance = 6.0;
    scene.camera.optics.velocity = Vec3::X * 0.3;
    scene.camera.optics.motion_samples = 8;
    check(&scene, "lens and motion", 60);
    scene = open();
    scene.world.environment = Environment {
        background: Vec3::new(0.4, 0.6, 0.9),
        lights: true,
        samples: 3,
        ..Environment::default()
    };
    check(&scene, "a dome that lights", 60);
    scene = open();
    let mut lights = Lights::clone(&scene.world.lights);
    let ids = (lights.points.iter().map(|light| light.id))
        .chain(lights.segments.iter().map(|light| light.id))
        .chain(lights.parallelograms.iter().map(|light| light.id));
    lights.moving = (ids.zip(1..))
        .map(|(id, speed)| MovingLight {
            id,
            velocity: Vec3::new(0.2, 0.1, -0.1) * speed as f32,
            samples: 8,
        })
        .collect();
    lights.moving.sort_by_key(|light| light.id);
    assert!(!lights.moving.is_empty());
    scene.world.lights = Arc::new(lights);
    scene.world = scene.world.clone().with_needs();
    check(&scene, "moving lights", 60);
    scene = open();
    let mut lights = Lights::clone(&scene.world.lights);
    let mut numbers = Numbers(9);
    lights.points.extend((0..300).map(|i| PointLight {
        id: 1000 + i,
        position: numbers.point(-5.0, 5.0),
        color: Vec3::splat(numbers.unit()),
        cone: None,
    }));
    scene.world.lights = Arc::new(lights);
    scene.world = scene.world.clone().with_needs();
    check(&scene, "many lights, most left to chance", 60);
}

#[test]
fn a_sample_evaluated_alone_is_what_the_film_adds_bit_for_bit() {
    for name in SCENES.iter().map(|scene| scene.name) {
        let scene = Scene::open(name, SIZE);
        let (world, camera, settings) = (&scene.world, &scene.camera, &scene.settings);
        let index = 3;
        let film = render_samples(world, camera, settings, index..index + 1, &|_| {}).film;
        let mut numbers = Numbers(5);
        for _ in 0..200 {
            let pixel = UVec2::new(
                (numbers.unit() * SIZE.x as f32) as u32,
                (numbers.unit() * SIZE.y as f32) as u32,
            );
            let rays = probe(world, camera, settings, pixel, &Samples::One(index)).unwrap();
            let mut sum = Sum::default();
            sum.add(rays.samples[0].value);
            assert_eq!(sum, film.sum(pixel.x, pixel.y), "{name}, pixel {pixel}");
        }
    }
}
