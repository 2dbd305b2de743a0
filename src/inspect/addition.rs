//! What the rays add up to, bit for bit: against the samples' values, against the same samples traced
//! without being watched, and against the film.

use super::column::color_text;
use crate::film::Sum;
use crate::scene::RenderSettings;
use crate::trace::{Camera, RayTree, SampleId, Workspace, World, radiance};
use glam::Vec3;

/// What was found when the rays were traced.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Addition {
    /// The first sample whose rays add up to something else than its value, with the sum.
    unequal: Option<(u64, Vec3)>,
    /// The first sample that is another one when nobody watches, with its value then.
    unlike: Option<(u64, Vec3)>,
}

/// What stands below the list.
#[derive(Clone, Debug, PartialEq)]
pub struct Statement {
    /// One line.
    pub text: String,
    /// Two numbers that ought to be the same are not.
    pub is_fault: bool,
}

impl Addition {
    /// Adds up the rays of each sample, and traces the samples once more.
    pub fn of(world: &World, camera: &Camera, settings: &RenderSettings, rays: &RayTree) -> Self {
        // All samples' sums in one go, each in its own order.
        let mut sums = vec![Vec3::ZERO; rays.samples.len()];
        for &index in &rays.order {
            let ray = &rays.rays[index as usize];
            sums[ray.sample as usize] += ray.added;
        }
        let mut found = Self::default();
        let ids: Vec<SampleId> = rays
            .samples
            .iter()
            .map(|sample| SampleId {
                pixel: rays.pixel,
                index: sample.index,
            })
            .collect();
        let mut values = vec![Vec3::ZERO; ids.len()];
        let mut workspace = Workspace::default();
        radiance(world, camera, settings, &ids, &mut values, &mut workspace);
        for ((sample, sum), value) in rays.samples.iter().zip(sums).zip(values) {
            if found.unequal.is_none() && !is_same(sum, sample.value) {
                found.unequal = Some((sample.index, sum));
            }
            if found.unlike.is_none() && !is_same(value, sample.value) {
                found.unlike = Some((sample.index, value));
            }
        }
        found
    }

    /// What the rays add up to.
    pub fn says_of_rays(&self, rays: &RayTree) -> Statement {
        let mean = color_text(rays.mean());
        if let Some((index, sum)) = self.unequal {
            return Statement {
                text: format!(
                    "Sample {index}: its rays add up to {}, WHICH IS NOT ITS VALUE",
                    color_text(sum)
                ),
                is_fault: true,
            };
        }
        let text = match &rays.samples[..] {
            [] => "No sample was traced".into(),
            [one] => format!(
                "Sum of the tree {mean} = the value of sample {}, bit for bit",
                one.index
            ),
            all => format!(
                "The rays of each of {} samples add up to its value, bit for bit; mean {mean}",
                all.len()
            ),
        };
        Statement {
            text,
            is_fault: false,
        }
    }

    /// How that stands to what the film of the picture has of the pixel: the exact sum of its samples,
    /// and their number. `None`: the view shows another picture.
    pub fn says_of_film(&self, rays: &RayTree, film: Option<(Sum, u32)>) -> Statement {
        let fine = |text: String| Statement {
            text,
            is_fault: false,
        };
        if let Some((index, value)) = self.unlike {
            return Statement {
                text: format!(
                    "Sample {index} is {} when nobody watches, WHICH IS ANOTHER VALUE",
                    color_text(value)
                ),
                is_fault: true,
            };
        }
        let again = "traced once more without being watched, it is the same bit for bit";
        let Some((sum, count)) = film else {
            return fine(format!(
                "the view shows another picture by now, so its film is not compared; {again}"
            ));
        };
        if count == 0 {
            return fine(format!("the film has no sample of this pixel yet; {again}"));
        }
        let mean = color_text(sum.mean(count));
        // The film has a pixel's samples from the first one on.
        let first = rays.samples.iter().enumerate();
        let known = first.take_while(|(i, sample)| sample.index == *i as u64);
        let known = known.count();
        if known < count as usize {
            return fine(format!(
                "the film has {count} samples of this pixel, their mean is {mean}; {again}"
            ));
        }
        let mut own = Sum::default();
        for sample in &rays.samples[..count as usize] {
            own.add(sample.value);
        }
        let samples = match count {
            1 => "one sample".to_owned(),
            count => format!("{count} samples, mean {mean}"),
        };
        if own == sum {
            return fine(format!("the film added the same, bit for bit ({samples})"));
        }
        let means = [own.mean(count), sum.mean(count)];
        if (means[0] - means[1]).abs().max_element() <= ROUNDING * means[0].abs().max_element() {
            return fine(format!(
                "the film added the same, light by light, and so but for the rounding of its last digit ({samples})"
            ));
        }
        Statement {
            text: format!(
                "THE FILM HAS ANOTHER SUM ({samples}; the rays' is {})",
                color_text(own.mean(count))
            ),
            is_fault: true,
        }
    }
}

/// What a view adds up light by light differs by from what is added sample by sample, each rounded to f32, relatively: a
/// handful of its units.
const ROUNDING: f32 = 1e-6;

/// Bit for bit, so that what is not a number is itself.
fn is_same(a: Vec3, b: Vec3) -> bool {
    a.to_array().map(f32::to_bits) == b.to_array().map(f32::to_bits)
}
