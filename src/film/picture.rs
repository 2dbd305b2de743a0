use glam::{UVec2, Vec3};

/// Linear, scene-referred RGB, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width · height` pixels.
    pub pixels: Vec<Vec3>,
}

impl Picture {
    /// A black picture.
    pub fn black(size: UVec2) -> Self {
        Self {
            width: size.x,
            height: size.y,
            pixels: vec![Vec3::ZERO; size.x as usize * size.y as usize],
        }
    }

    /// Columns and rows.
    pub fn size(&self) -> UVec2 {
        UVec2::new(self.width, self.height)
    }

    /// The pixel in column x of row y.
    pub fn pixel(&self, x: u32, y: u32) -> Vec3 {
        self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// Root of the mean squared difference over all pixels and channels; `None` for another size.
    pub fn rmse(&self, other: &Self) -> Option<f64> {
        if (self.width, self.height) != (other.width, other.height) {
            return None;
        }
        let sum: f64 = self
            .pixels
            .iter()
            .zip(&other.pixels)
            .map(|(a, b)| (*a - *b).as_dvec3().length_squared())
            .sum();
        Some((sum / (3 * self.pixels.len()).max(1) as f64).sqrt())
    }
}
