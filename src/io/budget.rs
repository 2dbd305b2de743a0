//! The memory that a scene may take, counted before it is asked for.
//!
//! A limit for each item says nothing of many items: five pictures that are allowed one by one fill a machine
//! together. So whatever grows with a file asks [`Budget::claim`] first, with what it will take at its most: meshes by
//! their counts, shapes by their numbers, pictures and parts by their headers, the film by its size. What is refused is
//! one line, where running out of memory would be the end of the program.
//!
//! The figures are rounded up from measurements; they count what lives beside one another while a scene is
//! opened, traced and shown, not what a single array takes.

use super::error::{FileError, Problem};
use super::model::MeshParts;
use super::sources::SceneFiles;
use crate::film::LightPictures;
use bevy::asset::Assets;
use bevy::ecs::world::World;
use bevy::image::Image;
use bevy::mesh::Mesh;
use glam::UVec2;
use std::fmt;
use std::path::Path;
use std::str::FromStr;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

/// Bytes that a scene may take, and how many of them are spoken for. Clones count together.
#[derive(Clone, Debug)]
pub struct Budget {
    bytes: u64,
    claimed: Arc<AtomicU64>,
}

/// The same where as much is allowed, whatever has been claimed.
impl PartialEq for Budget {
    fn eq(&self, other: &Self) -> bool {
        self.bytes == other.bytes
    }
}

impl Eq for Budget {}

impl Default for Budget {
    /// Three quarters of the memory that this process may use, so that the system keeps the rest; of 8 GiB where the
    /// system does not tell.
    fn default() -> Self {
        static MACHINE: OnceLock<u64> = OnceLock::new();
        const UNKNOWN: u64 = 8 << 30;
        let machine = *MACHINE.get_or_init(|| machine_bytes().unwrap_or(UNKNOWN));
        Self::of(machine / 4 * 3)
    }
}

impl Budget {
    /// Of so many bytes.
    pub fn of(bytes: u64) -> Self {
        Self {
            bytes,
            claimed: Arc::default(),
        }
    }

    /// A count of its own, of which so many bytes are taken from the start.
    pub(crate) fn holding(&self, bytes: u64) -> Self {
        Self {
            bytes: self.bytes,
            claimed: Arc::new(AtomicU64::new(bytes)),
        }
    }

    /// A count of its own, of which is taken what has been claimed so far.
    pub(crate) fn apart(&self) -> Self {
        self.holding(self.claimed.load(Ordering::Relaxed))
    }

    /// Bytes that nothing has spoken for.
    pub(crate) fn left(&self) -> u64 {
        let claimed = self.claimed.load(Ordering::Relaxed);
        self.bytes.saturating_sub(claimed)
    }

    /// Speaks for so many bytes, or says that they are not there.
    pub(crate) fn claim(&self, bytes: u64) -> Result<(), Problem> {
        let with_these = |claimed: u64| {
            let sum = claimed.checked_add(bytes);
            sum.filter(|sum| *sum <= self.bytes)
        };
        let relaxed = Ordering::Relaxed;
        let claimed = self.claimed.fetch_update(relaxed, relaxed, with_these);
        claimed.map(|_| ()).map_err(|claimed| Problem::OutOfMemory {
            needs: Size(bytes),
            left: Size(self.bytes.saturating_sub(claimed)),
            whole: Size(self.bytes),
        })
    }
}

impl FromStr for Budget {
    type Err = String;

    /// `6G`, `1.5G`, `800M`: G is 2^30 bytes, M 2^20.
    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        let (number, unit) = text.split_at(text.len() - usize::from(text.ends_with(['G', 'M'])));
        let scale = match unit {
            "G" => 2_f64.powi(30),
            "M" => 2_f64.powi(20),
            _ => return Err("it is a number with M or G behind it, for example 6G".into()),
        };
        match number.parse::<f64>() {
            // What is larger than a number of bytes can be is as much as there can be.
            Ok(number) if number.is_finite() && number > 0.0 => {
                Ok(Self::of((number * scale) as u64))
            }
            _ => Err("it is a number above 0 with M or G behind it, for example 6G".into()),
        }
    }
}

/// A number of bytes, told as a person would.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size(pub u64);

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let megabytes = self.0 as f64 / 2_f64.powi(20);
        match megabytes {
            0.0..1.0 => write!(f, "{:.0} kB", megabytes * 1024.0),
            1.0..1000.0 => write!(f, "{megabytes:.0} MB"),
            _ => write!(f, "{:.1} GB", megabytes / 1024.0),
        }
    }
}

/// Of a mesh: Bevy's and the tracer's copy of each vertex, and for each triangle its indices twice and its tree in
/// both forms, with what building that takes. Measured with three million triangles: 348 bytes each, of which half a
/// vertex is 32.
pub(crate) fn mesh_bytes(vertices: u64, triangles: u64) -> u64 {
    const VERTEX: u64 = 2 * (12 + 12 + 8);
    const TRIANGLE: u64 = 300;
    MESH.saturating_add(vertices.saturating_mul(VERTEX))
        .saturating_add(triangles.saturating_mul(TRIANGLE))
}

/// What has been claimed of a file whose counts are known only when its end is reached.
pub(crate) struct Growing<'a> {
    budget: &'a Budget,
    claimed: u64,
    /// Bytes of names.
    names: u64,
}

impl<'a> Growing<'a> {
    pub fn of(budget: &'a Budget) -> Self {
        Self {
            budget,
            claimed: 0,
            names: 0,
        }
    }

    /// A name that is kept, to look it up and by its number; claimed with the rest.
    pub fn named(&mut self, name: &str) {
        self.names += NAME + 2 * name.len() as u64;
    }

    /// Claims what all of it takes so far, at least a megabyte more than before.
    pub fn reach(&mut self, vertices: u64, triangles: u64, meshes: u64) -> Result<(), Problem> {
        const STEP: u64 = 1 << 20;
        let needed = mesh_bytes(vertices, triangles) + meshes.saturating_mul(MESH) + self.names;
        if needed > self.claimed {
            let step = (needed - self.claimed).max(STEP);
            self.budget.claim(step)?;
            self.claimed += step;
        }
        Ok(())
    }
}

/// Of a name in a list and in a table, beside its letters. Measured with three million groups of an OBJ: 150 bytes each.
const NAME: u64 = 200;

/// Of an entity with its name.
pub(crate) const ENTITY: u64 = 1500;

/// Of a mesh's asset and tree, however small, with an entity that shows it. Measured with 300,000 triangles in as many
/// groups of an OBJ: 4.6 kB each.
const MESH: u64 = 4500;

/// Of a picture with so many bytes a channel, as it is decoded and kept: by Bevy with four channels, by the tracer,
/// and a third more for mipmaps. What has more than 8 bits may become floats.
pub(crate) fn picture_bytes(width: u32, height: u32, channel_bytes: u64) -> u64 {
    let pixels = u64::from(width) * u64::from(height);
    let pixel = if channel_bytes > 1 { 48 } else { 12 };
    pixels.saturating_mul(pixel)
}

/// Of a film, with the picture that is made of it: sums with their errors, of 60 bytes a pixel, while they are added up and
/// again afterwards, and pixels of three floats before and after they are developed. Measured: 125 to 152 bytes a pixel.
pub(crate) fn film_bytes(size: UVec2) -> u64 {
    const PIXEL: u64 = 160;
    (u64::from(size.x) * u64::from(size.y)).saturating_mul(PIXEL)
}

/// What the meshes and pictures of the open scene take.
pub(crate) fn held_bytes(meshes: &Assets<Mesh>, images: &Assets<Image>) -> u64 {
    let meshes = meshes.iter().filter_map(|(_, mesh)| {
        let parts = MeshParts::of(mesh)?;
        let vertices = parts.positions.len() as u64;
        Some(mesh_bytes(vertices, parts.indices.len() as u64 / 3))
    });
    // Kept twice, and decoding is over.
    let images = images.iter().filter_map(|(_, image)| image.data.as_ref());
    meshes.sum::<u64>() + images.map(|data| 3 * data.len() as u64).sum::<u64>()
}

/// A count of its own for what is added to a world: the assets that are there are taken from the start.
pub(crate) fn beside(budget: &Budget, world: &World) -> Budget {
    match (
        world.get_resource::<Assets<Mesh>>(),
        world.get_resource::<Assets<Image>>(),
    ) {
        (Some(meshes), Some(images)) => budget.holding(held_bytes(meshes, images)),
        _ => budget.holding(0),
    }
}

/// Of a film that keeps this many lights apart, besides: for each sums with their errors, of 60 bytes a pixel, the picture of
/// them, and its channels before they are written.
fn light_bytes(size: UVec2, lights: usize) -> u64 {
    const PIXEL: u64 = 84;
    let planes = LightPictures::planes(lights) as u64;
    (u64::from(size.x) * u64::from(size.y) * PIXEL).saturating_mul(planes)
}

/// Refuses a film of this size that does not fit beside the open scene, before it is rendered.
pub fn check_film(world: &World, file: &Path, size: UVec2) -> Result<(), FileError> {
    check_bytes(world, file, film_bytes(size))
}

/// The same of one that keeps the light of so many lights apart ([`render_lights`](crate::film::render_lights)).
pub fn check_film_of_lights(
    world: &World,
    file: &Path,
    size: UVec2,
    lights: usize,
) -> Result<(), FileError> {
    let bytes = film_bytes(size).saturating_add(light_bytes(size, lights));
    check_bytes(world, file, bytes)
}

fn check_bytes(world: &World, file: &Path, bytes: u64) -> Result<(), FileError> {
    let files = world.get_resource::<SceneFiles>();
    let budget = files.map_or_else(Budget::default, |files| files.limits.memory.clone());
    beside(&budget, world)
        .claim(bytes)
        .map_err(|problem| FileError::new(file, problem))
}

/// The least of what the machine has, what its control group allows and what the shell's limit on addresses leaves.
/// `None` where no system tells.
#[cfg(target_os = "linux")]
fn machine_bytes() -> Option<u64> {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let number = |text: &str, unit: u64| text.trim().parse::<u64>().ok()?.checked_mul(unit);
    // "MemTotal:       24600128 kB"
    let memory = read("/proc/meminfo").and_then(|text| {
        let line = text
            .lines()
            .find_map(|line| line.strip_prefix("MemTotal:"))?;
        number(line.trim_end_matches("kB"), 1024)
    });
    // "Max address space         unlimited            unlimited            bytes". The program itself and its threads'
    // stacks have some of them already: "VmSize:   329420 kB".
    let mapped = read("/proc/self/status").and_then(|text| {
        let line = text.lines().find_map(|line| line.strip_prefix("VmSize:"))?;
        number(line.trim_end_matches("kB"), 1024)
    });
    let addresses = read("/proc/self/limits").and_then(|text| {
        let mut lines = text.lines();
        let line = lines.find_map(|line| line.strip_prefix("Max address space"))?;
        let limit = number(line.split_whitespace().next()?, 1)?;
        Some(limit.saturating_sub(mapped.unwrap_or(0)))
    });
    // Version 2, then version 1; "max" or a number near 2^63 is no limit.
    let group = [
        "/sys/fs/cgroup/memory.max",
        "/sys/fs/cgroup/memory/memory.limit_in_bytes",
    ];
    let group = group.iter().find_map(|path| number(&read(path)?, 1));
    [memory, addresses, group].into_iter().flatten().min()
}

#[cfg(not(target_os = "linux"))]
fn machine_bytes() -> Option<u64> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_claimed_adds_up_until_nothing_is_left_and_a_refusal_takes_nothing() {
        let budget = Budget::of(100 << 20);
        let copy = budget.clone();
        budget.claim(60 << 20).unwrap();
        let text = copy.claim(50 << 20).unwrap_err().to_string();
        for part in ["50 MB", "40 MB", "100 MB", "--memory"] {
            assert!(text.contains(part), "`{part}` is missing: {text}");
        }
        assert!(budget.apart().claim(40 << 20).is_ok());
        copy.claim(40 << 20).unwrap();
        assert!(budget.claim(1).is_err());
        assert!(budget.apart().claim(1).is_err());
        assert!(budget.holding(0).claim(100 << 20).is_ok());
        assert!(budget.holding(u64::MAX).claim(1).is_err());
    }

    #[test]
    fn sizes_are_written_with_their_unit_and_read_back() {
        for (text, bytes) in [("6G", 6 << 30), ("1.5G", 3 << 29), ("800M", 800 << 20)] {
            assert_eq!(text.parse(), Ok(Budget::of(bytes)), "{text}");
        }
        for text in ["", "G", "6", "6K", "-1G", "0M", "nanG", "infG", "6 G B"] {
            assert!(text.parse::<Budget>().is_err(), "{text}");
        }
        assert_eq!(Size(1 << 30).to_string(), "1.0 GB");
        assert_eq!(Size(999 << 20).to_string(), "999 MB");
        assert_eq!(Size(3 << 10).to_string(), "3 kB");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_machine_says_how_much_memory_it_has() {
        let bytes = machine_bytes().unwrap();
        assert!((1 << 26..1 << 50).contains(&bytes), "{}", Size(bytes));
    }
}
