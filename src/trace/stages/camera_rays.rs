//! The camera's rays of a batch, in columns.

use crate::bvh::{Ray, TriangleId};
use crate::instruction_sets::vectorized;
use crate::scene::{PixelSampling, RenderSettings};
use crate::trace::camera::{Camera, ImagePlane, Optics};
use crate::trace::math::vectors::Vectors;
use crate::trace::random::numbers::{Asking, Pairs};
use crate::trace::random::sampler::Purpose;
use crate::trace::{SampleId, World};
use glam::{Vec2, Vec3};

/// The columns from which a batch's rays are made. Kept from batch to batch, so that nothing is allocated once they have
/// grown to their size.
#[derive(Default)]
pub(in crate::trace) struct CameraRays {
    x: Vec<u32>,
    y: Vec<u32>,
    asking: Asking,
    places: Pairs,
    lens: Pairs,
    times: Vec<f32>,
    origins: Vectors,
    directions: Vectors,
}

impl CameraRays {
    /// Of each sample its ray: through its place in the pixel, from its place on the lens, at its shutter time where
    /// anything moves. Directions have unit length. Of what `rays` had before nothing is left.
    pub fn of(
        &mut self,
        world: &World,
        plane: &ImagePlane,
        settings: &RenderSettings,
        samples: &[SampleId],
        rays: &mut Vec<Ray>,
    ) {
        let count = samples.len();
        self.x.clear();
        self.x.extend(samples.iter().map(|id| id.pixel.x));
        self.y.clear();
        self.y.extend(samples.iter().map(|id| id.pixel.y));
        self.asking.all(samples, &self.x, &self.y, settings);
        let camera = plane.camera;
        let moves = settings.features.motion
            && (camera.optics.velocity != Vec3::ZERO || world.needs.motion_samples > 0);
        self.times.clear();
        if moves {
            self.places.draw(&self.asking, Purpose::Time, settings);
            (self.times).extend(self.places.u.iter().map(|&u| camera.time(u)));
        } else {
            self.times.resize(count, 0.0);
        }
        match settings.pixel {
            PixelSampling::Area => self.places.draw(&self.asking, Purpose::Camera, settings),
            PixelSampling::Center => self.places.fill(count, [0.5, 0.5]),
            PixelSampling::Corner => self.places.fill(count, [0.0, 1.0]),
        }
        if camera.has_lens() {
            (self.lens).draw_last(&self.asking, Purpose::Camera, settings);
        }
        self.origins.resize(count);
        self.directions.resize(count);
        let (origins, directions) = (&mut self.origins, &mut self.directions);
        let columns = [&self.x, &self.y].map(|column| &column[..]);
        let places = [&self.places.u, &self.places.v].map(|column| &column[..]);
        if camera.has_lens() {
            for i in 0..count {
                let ray = plane.ray(place(i, columns, places), self.lens.get(i), self.times[i]);
                origins.set(i, ray.origin);
                directions.set(i, ray.direction);
            }
        } else {
            rays_without_lens(
                plane,
                columns,
                places,
                &self.times,
                origins.slices(),
                directions.slices(),
            );
        }
        rays.resize(count, Ray::new(Vec3::ZERO, Vec3::ZERO));
        to_rays(
            self.origins.columns(),
            self.directions.columns(),
            &self.times,
            rays,
        );
    }

    /// Who asks for the camera's numbers: all samples.
    pub fn asking(&self) -> &Asking {
        &self.asking
    }
}

/// Where a sample lies in the picture, in pixels.
#[inline(always)]
fn place(i: usize, [x, y]: [&[u32]; 2], [u, v]: [&[f32]; 2]) -> Vec2 {
    Vec2::new(x[i] as f32 + u[i], y[i] as f32 + v[i])
}

/// So many rays are written at a time.
const ROWS: usize = 64;

vectorized! {
    /// Sets rays without an end, of columns; they start on no triangle.
    fn to_rays(origins: [&[f32]; 3], directions: [&[f32]; 3], times: &[f32], rays: &mut [Ray]) {
        let count = rays.len();
        let [ox, oy, oz] = origins.map(|column| &column[..count]);
        let [dx, dy, dz] = directions.map(|column| &column[..count]);
        let times = &times[..count];
        let nowhere: [f32; 2] = bytemuck::cast(TriangleId::NONE);
        for start in (0..count).step_by(ROWS) {
            // Rows of eight are a transposition in registers; a ray has ten numbers, of which the last two are the same in all.
            let some = ROWS.min(count - start);
            let mut rows = [[0.0; 8]; ROWS];
            let [ox, oy, oz] = [ox, oy, oz].map(|column| &column[start..start + some]);
            let [dx, dy, dz] = [dx, dy, dz].map(|column| &column[start..start + some]);
            let times = &times[start..start + some];
            for (i, row) in rows[..some].iter_mut().enumerate() {
                *row = [ox[i], oy[i], oz[i], dx[i], dy[i], dz[i], f32::INFINITY, times[i]];
            }
            let rays: &mut [[f32; 10]] = bytemuck::cast_slice_mut(&mut rays[start..start + some]);
            for (ray, row) in rays.iter_mut().zip(&rows) {
                ray[..8].copy_from_slice(row);
                ray[8..].copy_from_slice(&nowhere);
            }
        }
    }

    /// [`ImagePlane::ray`] of each place, of a camera without a lens.
    fn rays_without_lens(
        plane: &ImagePlane,
        columns: [&[u32]; 2],
        places: [&[f32]; 2],
        times: &[f32],
        origins: [&mut [f32]; 3],
        directions: [&mut [f32]; 3],
    ) {
        // A copy that the loop has in registers, and in which nothing of a lens is left.
        let optics = Optics {
            aperture_radius: 0.0,
            ..plane.camera.optics
        };
        let camera = Camera { optics, ..*plane.camera };
        let plane = plane.of_camera(&camera);
        let count = times.len();
        let columns = columns.map(|column| &column[..count]);
        let places = places.map(|column| &column[..count]);
        let [ox, oy, oz] = origins.map(|column| &mut column[..count]);
        let [dx, dy, dz] = directions.map(|column| &mut column[..count]);
        for i in 0..count {
            let ray = plane.ray(place(i, columns, places), [0.0; 2], times[i]);
            [ox[i], oy[i], oz[i]] = ray.origin.to_array();
            [dx[i], dy[i], dz[i]] = ray.direction.to_array();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Projection, Sequence};
    use crate::trace::random::sampler::Sampler;
    use glam::UVec2;

    const SIZE: UVec2 = UVec2::new(640, 480);
    const SEQUENCES: [Sequence; 3] = [Sequence::Sobol, Sequence::Independent, Sequence::Jittered];

    fn rays(camera: &Camera, settings: &RenderSettings, samples: &[SampleId]) -> Vec<Ray> {
        let mut rays = Vec::new();
        let plane = camera.image_plane(settings.size);
        CameraRays::default().of(&World::default(), &plane, settings, samples, &mut rays);
        rays
    }

    fn samples() -> Vec<SampleId> {
        let pixels = (0..SIZE.element_product()).step_by(997);
        pixels
            .map(|i| SampleId {
                pixel: UVec2::new(i % SIZE.x, i / SIZE.x),
                index: u64::from(i % 300),
            })
            .collect()
    }

    #[test]
    fn each_sample_has_the_ray_that_its_own_numbers_give() {
        let pinhole = Camera::looking_at(Vec3::new(1.0, 2.0, 3.0), Vec3::ZERO, Vec3::Y, 0.9);
        let with = |optics| Camera {
            optics,
            ..pinhole.clone()
        };
        let cameras = [
            pinhole.clone(),
            with(Optics {
                aperture_radius: 0.1,
                focus_distance: 3.0,
                ..Optics::default()
            }),
            with(Optics {
                velocity: Vec3::new(0.2, -0.1, 0.3),
                shutter: [0.25, 0.75],
                ..Optics::default()
            }),
            Camera {
                projection: Projection::Orthographic { height: 2.0 },
                ..pinhole.clone()
            },
        ];
        for (camera, sequence) in cameras
            .iter()
            .flat_map(|camera| SEQUENCES.map(|sequence| (camera, sequence)))
        {
            let settings = RenderSettings {
                size: SIZE,
                sequence,
                seed: 5,
                jitter: 4,
                ..RenderSettings::default()
            };
            let plane = camera.image_plane(SIZE);
            let samples = samples();
            for (ray, id) in rays(camera, &settings, &samples).into_iter().zip(&samples) {
                let sampler = Sampler::new(id.pixel.x, id.pixel.y, 5, sequence).on_grid(4);
                let [x, y, u, v] = sampler.block(id.index, Purpose::Camera, 0);
                let time = if camera.optics.velocity == Vec3::ZERO {
                    0.0
                } else {
                    camera.time(sampler.block(id.index, Purpose::Time, 0)[0])
                };
                let place = id.pixel.as_vec2() + Vec2::new(x, y);
                assert_eq!(ray, plane.ray(place, [u, v], time), "{id:?} {sequence:?}");
            }
        }
    }

    #[test]
    fn the_corner_of_a_pixel_is_its_lower_left_one() {
        let camera = Camera::looking_at(Vec3::new(1.0, 2.0, 3.0), Vec3::ZERO, Vec3::Y, 0.9);
        let settings = RenderSettings {
            size: SIZE,
            pixel: PixelSampling::Corner,
            ..RenderSettings::default()
        };
        let sample = SampleId {
            pixel: UVec2::new(10, 20),
            index: 0,
        };
        let expected = camera.ray(Vec2::new(10.0, 21.0), SIZE, [0.0; 2], 0.0);
        assert_eq!(rays(&camera, &settings, &[sample]), [expected]);
    }
}
