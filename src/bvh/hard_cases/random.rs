//! Reproducible random numbers.

use glam::Vec3;

/// Xorshift (Marsaglia 2003), 64 bits.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1 << 33)
    }

    pub(crate) fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// In [0, 1).
    pub(crate) fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u32 << 24) as f32
    }

    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.bits() >> 16) as usize % count
    }

    /// In the cube [-1, 1)³.
    pub(crate) fn cube(&mut self) -> Vec3 {
        Vec3::new(
            self.between(-1.0, 1.0),
            self.between(-1.0, 1.0),
            self.between(-1.0, 1.0),
        )
    }

    /// A unit vector, every direction as likely.
    pub(crate) fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.cube();
            let length = v.length();
            if length > 0.1 && length < 1.0 {
                return v / length;
            }
        }
    }

    /// One of a few.
    pub(crate) fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }
}
