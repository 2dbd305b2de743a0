//! Samples evaluated again, with every ray written down, by the very code that renders.

use super::ray_tree::{ProbedSample, RayTree};
use super::recording::Recording;
use crate::scene::RenderSettings;
use crate::trace::stages::radiance::radiance_with;
use crate::trace::{Camera, SampleId, Workspace, World, samples_per_pixel};
use glam::{UVec2, Vec3};
use std::ops::{ControlFlow, Range};

/// No more samples are evaluated once there are this many rays: some hundred megabytes.
pub const MOST_RAYS: usize = 1 << 19;

/// Which samples of a pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Samples {
    /// This one.
    One(u64),
    /// All that a render takes.
    All,
}

/// Why there is nothing to see.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ProbeError {
    /// The picture has no such pixel.
    #[error(
        "pixel {},{} is outside the picture: columns go from 0 to {}, rows from 0 to {}",
        pixel.x, pixel.y, size.x.saturating_sub(1), size.y.saturating_sub(1)
    )]
    Outside {
        /// What was asked for.
        pixel: UVec2,
        /// Columns and rows.
        size: UVec2,
    },
    /// The pixel has no such sample.
    #[error("there is no sample {index}: a pixel has {count}, counted from 0")]
    NoSuchSample {
        /// What was asked for.
        index: u64,
        /// How many there are.
        count: u64,
    },
}

/// Evaluates samples of a pixel again and writes down every ray. The values are those that the film
/// adds, bit for bit: it is the same function, and a sample depends on nothing but itself.
pub fn probe(
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
    pixel: UVec2,
    samples: &Samples,
) -> Result<RayTree, ProbeError> {
    let mut go_on = || ControlFlow::Continue(());
    match probe_while(world, camera, settings, pixel, samples, &mut go_on) {
        ControlFlow::Continue(rays) => rays,
        // It is never told to end.
        ControlFlow::Break(()) => Ok(RayTree::default()),
    }
}

/// The same, asking before each sample whether it shall go on.
pub fn probe_while(
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
    pixel: UVec2,
    samples: &Samples,
    go_on: &mut dyn FnMut() -> ControlFlow<()>,
) -> ControlFlow<(), Result<RayTree, ProbeError>> {
    let size = settings.size;
    let refused = |why| ControlFlow::Continue(Err(why));
    if pixel.cmpge(size).any() {
        return refused(ProbeError::Outside { pixel, size });
    }
    let count = u64::from(samples_per_pixel(world, camera, settings));
    let indices: Range<u64> = match *samples {
        Samples::All => 0..count,
        Samples::One(index) if index < count => index..index + 1,
        Samples::One(index) => return refused(ProbeError::NoSuchSample { index, count }),
    };
    let mut recording = Recording::new(world, settings);
    let mut workspace = Workspace::default();
    let mut tree = RayTree {
        pixel,
        has_lens: camera.has_lens(),
        ..RayTree::default()
    };
    for index in indices.clone() {
        go_on()?;
        if recording.rays.len() > MOST_RAYS {
            tree.left_out = indices.end - index;
            break;
        }
        recording.start_sample(tree.samples.len() as u32);
        let mut value = [Vec3::ZERO];
        let sample = [SampleId { pixel, index }];
        radiance_with(
            world,
            camera,
            settings,
            &sample,
            &mut value,
            &mut workspace,
            &mut recording,
        );
        let [value] = value;
        tree.samples.push(ProbedSample { index, value });
    }
    ControlFlow::Continue(Ok(recording.finish(tree)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::test_scene;
    use glam::Quat;

    #[test]
    fn no_sample_is_evaluated_after_it_was_told_to_end() {
        let world = test_scene::world();
        let eye = Vec3::new(0.0, 0.0, 4.0);
        let camera = Camera::new(eye, Quat::IDENTITY, Default::default(), Default::default());
        let settings = RenderSettings {
            size: UVec2::splat(16),
            spp: 8,
            ..RenderSettings::default()
        };
        let count = u64::from(samples_per_pixel(&world, &camera, &settings));
        let tell = |most: u64| {
            let mut asked = 0;
            let mut go_on = || {
                asked += 1;
                match asked <= most {
                    true => ControlFlow::Continue(()),
                    false => ControlFlow::Break(()),
                }
            };
            let (pixel, all) = (UVec2::splat(8), Samples::All);
            let rays = probe_while(&world, &camera, &settings, pixel, &all, &mut go_on);
            (rays.is_continue(), asked)
        };
        assert_eq!(tell(3), (false, 4));
        assert_eq!(tell(count), (true, count));
    }
}
