//! How many rays there were.

/// Rays traced, by what they were for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[expect(missing_docs, reason = "the names say it all")]
pub struct RayCounts {
    pub camera: u64,
    pub mirror: u64,
    pub transmission: u64,
    pub shadow: u64,
}

impl RayCounts {
    /// All of them.
    pub fn total(&self) -> u64 {
        self.camera + self.mirror + self.transmission + self.shadow
    }
}

impl std::ops::AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.camera += other.camera;
        self.mirror += other.mirror;
        self.transmission += other.transmission;
        self.shadow += other.shadow;
    }
}
