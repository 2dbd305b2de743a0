use crate::scene::RenderSettings;
use crate::trace::{
    Camera, FirstHit, SampleId, World, central_hits, first_hits, samples_per_pixel,
};
use glam::{UVec2, Vec3};
use rayon::prelude::*;

/// Samples of a pixel that are averaged at most: more do not show in 8 bits.
const MOST_SAMPLES: u32 = 64;

/// What the camera meets first, pixel by pixel, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstHits {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Of the ray through each pixel's middle and the lens' middle, when the shutter opens.
    pub centers: Vec<FirstHit>,
    /// kd, mean over the pixel's samples; a miss counts as black.
    pub albedo: Vec<Vec3>,
    /// Normal, mean over the pixel's samples; a miss counts as zero.
    pub normals: Vec<Vec3>,
    /// The part of the pixel's samples that meet anything, in [0, 1].
    pub coverage: Vec<f32>,
    /// Camera rays that were traced for all this.
    pub rays: u64,
}

impl FirstHits {
    /// Traces the camera rays of up to 64 samples a pixel, and a central one, on the current rayon
    /// pool.
    pub fn trace(world: &World, camera: &Camera, settings: &RenderSettings) -> Self {
        let UVec2 {
            x: width,
            y: height,
        } = settings.size;
        let samples = samples_per_pixel(world, camera, settings).clamp(1, MOST_SAMPLES);
        let rows: Vec<Row> = (0..height)
            .into_par_iter()
            .map(|y| Row::trace(world, camera, settings, y, samples))
            .collect();
        let mut all = Self {
            width,
            height,
            centers: Vec::new(),
            albedo: Vec::new(),
            normals: Vec::new(),
            coverage: Vec::new(),
            rays: u64::from(width) * u64::from(height) * u64::from(samples + 1),
        };
        for row in rows {
            all.centers.extend(row.centers);
            for mean in row.means {
                all.albedo.push(mean.albedo);
                all.normals.push(mean.normal);
                all.coverage.push(mean.coverage);
            }
        }
        all
    }

    /// Columns and rows.
    pub fn size(&self) -> UVec2 {
        UVec2::new(self.width, self.height)
    }
}

/// Samples that are asked for at once.
const AT_ONCE: usize = 1024;

struct Row {
    centers: Vec<FirstHit>,
    means: Vec<Mean>,
}

struct Mean {
    albedo: Vec3,
    normal: Vec3,
    coverage: f32,
}

impl Row {
    fn trace(
        world: &World,
        camera: &Camera,
        settings: &RenderSettings,
        y: u32,
        samples: u32,
    ) -> Self {
        let pixels: Vec<UVec2> = (0..settings.size.x).map(|x| UVec2::new(x, y)).collect();
        let mut centers = vec![FirstHit::MISS; pixels.len()];
        central_hits(world, camera, settings, &pixels, &mut centers);
        let (mut ids, mut hits, mut means) = (Vec::new(), Vec::new(), Vec::new());
        let at_once = AT_ONCE / samples as usize;
        for pixels in pixels.chunks(at_once) {
            ids.clear();
            for &pixel in pixels {
                ids.extend((0..u64::from(samples)).map(|index| SampleId { pixel, index }));
            }
            hits.resize(ids.len(), FirstHit::MISS);
            first_hits(world, camera, settings, &ids, &mut hits);
            means.extend(hits.chunks(samples as usize).map(Mean::of));
        }
        Self { centers, means }
    }
}

impl Mean {
    fn of(hits: &[FirstHit]) -> Self {
        let part = 1.0 / hits.len() as f32;
        let covered = hits.iter().filter(|hit| hit.object.is_some()).count();
        Self {
            albedo: part * hits.iter().map(|hit| hit.albedo).sum::<Vec3>(),
            normal: part * hits.iter().map(|hit| hit.normal).sum::<Vec3>(),
            coverage: part * covered as f32,
        }
    }
}
