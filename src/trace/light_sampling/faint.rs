//! Many lights: which of a vertex's shadow rays are left to chance.
//!
//! Up to [`FEW`] lights all get their shadow rays. Of more, a point that adds less than [`Needs::faint`](crate::trace::Needs) if
//! nothing is in the way is asked for by chance, with a probability in proportion to what it adds, and counts as
//! [`Needs::faint`](crate::trace::Needs) then: the mean is the same, and a vertex has about [`FEW`] rays however many lights there
//! are. What is cheap, looking how much each light could add, is done for all of them; what is dear, the rays, for those
//! that matter. (Cycles' *light threshold* is the same idea, with a threshold that the user finds.)
//!
//! Whether a light is asked for follows from that light alone, not from the others as where one of them is chosen (Conty and
//! Kulla, "Importance Sampling of Many Lights", 2018). So a light that is edited changes no other's samples, and they can be
//! kept.

use super::lamp::Lamp;
use crate::scene::Lighting;
use crate::trace::{Lights, World};
use glam::Vec3;

/// Lights of a scene that all get their shadow rays.
pub const FEW: usize = 32;

/// Places of the scene that say what lights usually add, and lights that are looked at from all of them together: about a
/// millisecond, since it is done at every edit.
const PLACES: usize = 64;
const LEAST_PLACES: usize = 8;
const LOOKS: usize = 1 << 16;
/// What a surface reflects of a light, about: half of what a white one would that faces it, 1/π.
const REFLECTED: f32 = 1.0 / 8.0;
/// Powers of two that an f32 may lie between.
const OCTAVES: usize = 256;

/// What a point of a light has to add so that it is always asked for; 0 where all always are. A power of two: it changes
/// seldom while a light is edited.
pub(in crate::trace) fn faint(world: &World) -> f32 {
    if world.lights.count() <= FEW {
        return 0.0;
    }
    let most = (LOOKS / world.lights.count()).clamp(LEAST_PLACES, PLACES);
    let mut thresholds: Vec<i32> = places(world, most)
        .filter_map(|place| threshold(&world.lights, place))
        .collect();
    let half = thresholds.len() / 2;
    if thresholds.is_empty() {
        return 0.0;
    }
    let (_, middle, _) = thresholds.select_nth_unstable(half);
    REFLECTED * (*middle as f32).exp2()
}

/// Middles of so many triangles of the scene, evenly by their numbers: what is made of many is what people look at.
fn places(world: &World, most: usize) -> impl Iterator<Item = Vec3> {
    let instances = world.aggregate.instances();
    let triangles = |of: usize| instances[of].mesh.triangles().len();
    let total: usize = (0..instances.len()).map(triangles).sum();
    let count = most.min(total);
    let (mut instance, mut before) = (0, 0);
    (0..count).map(move |i| {
        let number = (total as u128 * i as u128 / count as u128) as usize;
        while number - before >= triangles(instance) {
            before += triangles(instance);
            instance += 1;
        }
        let corners = (instances[instance].mesh.triangles()).corners((number - before) as u32);
        instances[instance].to_world_point((corners[0] + corners[1] + corners[2]) / 3.0)
    })
}

/// The least power of two, its exponent, so that at this place about [`FEW`] lights are asked for, where those that
/// shine less on it are asked in proportion. `None` where they are no more anyway.
fn threshold(lights: &Lights, place: Vec3) -> Option<i32> {
    let mut counts = [0_u32; OCTAVES];
    let mut sums = [0.0_f64; OCTAVES];
    for lamp in lights.all() {
        let arriving = irradiance(lamp, place);
        if arriving.is_normal() {
            let octave = (arriving.to_bits() >> 23) as usize % OCTAVES;
            counts[octave] += 1;
            sums[octave] += f64::from(arriving);
        }
    }
    let mut fainter: f64 = sums.iter().sum();
    let mut brighter = 0;
    let mut least = None;
    for octave in (0..OCTAVES).rev() {
        // Those of this octave and above are always asked for.
        brighter += counts[octave];
        fainter -= sums[octave];
        let exponent = octave as i32 - 127;
        let asked = f64::from(brighter) + fainter.max(0.0) / f64::from(exponent).exp2();
        if asked > FEW as f64 {
            break;
        }
        least = Some(exponent);
    }
    least.filter(|_| counts.iter().sum::<u32>() > FEW as u32)
}

/// What arrives at a place that faces the light, about: the mean of its colour.
fn irradiance(lamp: Lamp, place: Vec3) -> f32 {
    let of_point = match lamp {
        Lamp::Point(light) => light.point(place, Lighting::Physical),
        Lamp::Directional(light) => Some(light.middle()),
        Lamp::Segment(light) => light.point(place, 0.5, Lighting::Physical),
        Lamp::Parallelogram(light) => light.point(place, [0.5; 2], Lighting::Physical),
        Lamp::Dome(_) => None,
    };
    of_point.map_or(0.0, |point| mean(point.arriving))
}

/// Of the channels.
#[inline(always)]
pub(in crate::trace) fn mean(color: Vec3) -> f32 {
    (color.x + color.y + color.z) * (1.0 / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::RenderSettings;
    use crate::trace::{
        Camera, ParallelogramLight, PointLight, RayEnd, SampleId, Samples, SegmentLight, Workspace,
        probe, radiance, test_scene,
    };
    use glam::{DVec3, UVec2};
    use std::sync::Arc;

    /// The test scene under so many lamps, scattered above it, of very different strengths.
    fn under(count: u64) -> World {
        let mut numbers = test_scene::Numbers(3);
        let points = (1..=count).map(|id| PointLight {
            id,
            position: 3.0 * numbers.in_cube(),
            color: Vec3::new(1.0, 0.8, 0.6) * (-6.0 * numbers.next()).exp2(),
            cone: None,
        });
        let lights = Lights {
            points: points.collect(),
            ..Lights::default()
        };
        World {
            lights: Arc::new(lights),
            ..test_scene::world()
        }
        .with_needs()
    }

    fn camera() -> Camera {
        Camera::looking_at(Vec3::new(0.5, 2.0, 6.0), Vec3::ZERO, Vec3::Y, 0.9)
    }

    /// Of a small picture.
    fn settings(spp: u64) -> RenderSettings {
        RenderSettings {
            size: UVec2::splat(8),
            spp: spp as u32,
            ..RenderSettings::default()
        }
    }

    /// Some samples of all pixels of the small picture, traced together: which, their values, and their shadow rays.
    fn trace(world: &World, samples: u64) -> (Vec<SampleId>, Vec<Vec3>, u64) {
        let settings = settings(samples);
        let size = settings.size;
        let pixels = (0..size.element_product()).map(|i| UVec2::new(i % size.x, i / size.x));
        let ids: Vec<SampleId> = pixels
            .flat_map(|pixel| (0..samples).map(move |index| SampleId { pixel, index }))
            .collect();
        let mut values = vec![Vec3::ZERO; ids.len()];
        let mut workspace = Workspace::default();
        let rays = radiance(
            world,
            &camera(),
            &settings,
            &ids,
            &mut values,
            &mut workspace,
        );
        (ids, values, rays.shadow)
    }

    /// The mean of those samples, and their shadow rays.
    fn render(world: &World, samples: u64) -> (DVec3, u64) {
        let (_, values, rays) = trace(world, samples);
        let sum: DVec3 = values.iter().map(|value| value.as_dvec3()).sum();
        (sum / values.len() as f64, rays)
    }

    #[test]
    fn few_lights_are_all_asked_for_and_many_change_no_mean() {
        assert_eq!(under(FEW as u64).needs.faint, 0.0);
        let many = under(400);
        assert!(many.needs.faint > 0.0);
        let mut all = many.clone();
        all.needs.faint = 0.0;
        let [some, all] = [many, all].map(|world| render(&world, 512));
        let ratio = some.0 / all.0;
        assert!((ratio - 1.0).abs().max_element() < 0.01, "{ratio}");
        assert!(4 * some.1 < all.1, "{} rays instead of {}", some.1, all.1);
    }

    /// Lights of every kind, and so many of them that most are left to chance.
    fn under_all_kinds() -> World {
        let world = under(200);
        let mut numbers = test_scene::Numbers(11);
        let mut lights = (*world.lights).clone();
        for id in 201..=240 {
            let (place, color) = (3.0 * numbers.in_cube(), Vec3::splat(0.3 * numbers.next()));
            lights.segments.push(SegmentLight {
                id,
                ends: [place, place + numbers.in_cube()],
                colors: [color; 2],
                samples: 3,
            });
            lights.parallelograms.push(ParallelogramLight {
                id: id + 100,
                corner: -place,
                edges: [0.2 * numbers.in_cube(), 0.2 * numbers.in_cube()],
                colors: [color; 4],
                two_sided: true,
                visible: false,
                samples: 2,
            });
        }
        World {
            lights: Arc::new(lights),
            ..world
        }
        .with_needs()
    }

    #[test]
    fn of_many_lights_a_probed_sample_is_the_samples_value_bit_for_bit() {
        let world = under_all_kinds();
        let (camera, settings) = (camera(), settings(2));
        let (ids, values, _) = trace(&world, 2);
        let mut left_out = 0;
        for (id, value) in ids.iter().zip(values) {
            let samples = Samples::One(id.index);
            let tree = probe(&world, &camera, &settings, id.pixel, &samples).unwrap();
            let bits = |color: Vec3| color.to_array().map(f32::to_bits);
            let probed = tree.samples[0].value;
            assert_eq!(bits(probed), bits(value), "{id:?}: {probed} and {value}");
            assert_eq!(bits(tree.sums()[0]), bits(value), "{id:?}");
            let is_left_out = |end: RayEnd| usize::from(end == RayEnd::LeftOut);
            left_out += tree.rays.iter().map(|r| is_left_out(r.end)).sum::<usize>();
        }
        assert!(left_out > 1000, "{left_out}");
    }

    #[test]
    fn rays_to_faint_lights_tell_the_chance_with_which_they_are_asked_for() {
        let world = under_all_kinds();
        let (camera, settings) = (camera(), settings(4));
        // How many are asked for, how many should be, and the variance of that.
        let (mut asked, mut expected, mut variance) = (0.0, 0.0, 0.0);
        for i in 0..settings.size.element_product() {
            let pixel = UVec2::new(i % settings.size.x, i / settings.size.x);
            let tree = probe(&world, &camera, &settings, pixel, &Samples::All).unwrap();
            for ray in &tree.rays {
                let Some(light) = ray.light.filter(|_| tree.leaves_first(ray)) else {
                    continue;
                };
                let is_asked = ray.end != RayEnd::LeftOut;
                if !is_asked {
                    assert!(ray.chance < 1.0, "{ray:?}");
                    let nothing = [ray.added, ray.carried, ray.radiance, ray.transmittance];
                    assert_eq!(nothing, [Vec3::ZERO; 4], "{ray:?}");
                    assert_eq!(ray.cost, Default::default(), "{ray:?}");
                }
                if ray.chance < 1.0 {
                    // What it would add, as a part of what is always asked for.
                    let weight = ray.weight * if is_asked { ray.chance } else { 1.0 };
                    let part = mean(weight * light.reflected) / world.needs.faint;
                    // Of light that grazes a surface the cosine has few digits.
                    let off = (part - ray.chance).abs();
                    assert!(off < 1e-4 + 1e-3 * ray.chance, "{part}, {ray:?}");
                    let chance = f64::from(ray.chance);
                    asked += f64::from(u8::from(is_asked));
                    expected += chance;
                    variance += chance * (1.0 - chance);
                }
            }
        }
        assert!(variance > 100.0, "{variance}");
        let off = (asked - expected) / variance.sqrt();
        assert!(off.abs() < 4.0, "{asked} instead of {expected}: {off} σ");
    }

    #[test]
    fn a_light_that_moves_a_little_or_shines_a_little_brighter_leaves_the_threshold_as_it_is() {
        let world = under(400);
        let mut changed = 0;
        for light in 0..40 {
            let mut lights = (*world.lights).clone();
            lights.points[light].position += Vec3::new(0.1, -0.2, 0.1);
            lights.points[light].color *= 1.2;
            let edited = World {
                lights: Arc::new(lights),
                ..world.clone()
            }
            .with_needs();
            changed += u32::from(edited.needs.faint != world.needs.faint);
        }
        assert!(changed <= 1, "{changed} of 40");
    }

    #[test]
    fn what_no_number_is_and_a_scene_of_nothing_leave_everything_asked_for() {
        let mut world = under(100);
        let mut lights = (*world.lights).clone();
        for light in &mut lights.points {
            light.color = Vec3::ZERO;
        }
        lights.points[3].color = Vec3::NAN;
        lights.points[4].color = Vec3::MAX;
        world.lights = Arc::new(lights);
        assert_eq!(faint(&world), 0.0);
        let nothing = World {
            lights: under(100).lights,
            ..World::default()
        };
        assert_eq!(faint(&nothing), 0.0);
    }
}
