use super::arrays::{Mesh, Object, World};
use crate::bvh::Instance;
use crate::scene::{Output, RenderSettings, Sampling, Sequence, TreeSettings};
use crate::trace::{Camera, Texels, Texture};
use std::collections::HashMap;
use std::fmt::{self, Debug, Write};
use std::sync::Arc;

/// Tells pictures apart whose samples differ: all that a sample's value depends on, but for its pixel
/// and its index. Not how trees are built, how many samples there are, or what happens to the picture
/// afterwards.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Digest(u128);

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

impl Debug for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// The digest of a world, a camera and settings.
pub fn digest(world: &World, camera: &Camera, settings: &RenderSettings) -> Digest {
    let mut hash = Hash::new();
    // Another version may compute other values from the same scene.
    hash.text(&env!("CARGO_PKG_VERSION"));
    let mut camera = camera.clone();
    (camera.optics.lens_samples, camera.optics.motion_samples) = (0, 0);
    hash.text(&camera);
    hash.text(&RenderSettings {
        spp: 0,
        // It asks for samples; of one sequence it also decides where they lie.
        jitter: match settings.sequence {
            Sequence::Jittered => settings.jitter,
            _ => 0,
        },
        sampling: Sampling::default(),
        tree: TreeSettings::default(),
        output: Output::default(),
        ..settings.clone()
    });
    let mut meshes = HashMap::new();
    for (object, instance) in world.objects.iter().zip(world.aggregate.instances()) {
        hash.object(object, instance, &mut meshes);
    }
    hash.text(&*world.materials);
    let mut lights = (*world.lights).clone();
    lights.moving.iter_mut().for_each(|light| light.samples = 0);
    hash.text(&lights);
    for texture in world.textures.iter() {
        hash.texture(texture);
    }
    let environment = &world.environment;
    hash.text(&(
        environment.background,
        environment.rotation,
        environment.intensity,
    ));
    if environment.lights {
        hash.text(&("dome", environment.samples));
    }
    if let Some(backdrop) = environment.backdrop {
        hash.text(&("backdrop", backdrop));
    }
    if let Some(map) = &environment.map {
        hash.texture(map);
    }
    Digest(hash.0)
}

/// FNV-1a with 128 bits (Fowler, Noll, Vo; constants of the IETF draft of 2019, section 5): short,
/// and the same on every machine. It guards against mistakes, not against forgers.
struct Hash(u128);

const OFFSET: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;

impl Write for Hash {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.bytes(text.as_bytes().iter().copied());
        Ok(())
    }
}

impl Hash {
    fn new() -> Self {
        Self(OFFSET)
    }

    fn bytes(&mut self, bytes: impl IntoIterator<Item = u8>) {
        for byte in bytes {
            self.0 = (self.0 ^ u128::from(byte)).wrapping_mul(PRIME);
        }
    }

    /// What a small value says of itself; floats are written so that they can be read back exactly.
    fn text(&mut self, value: &dyn Debug) {
        // Writing to a hash cannot fail.
        let _ = write!(self, "{value:?};");
    }

    /// Numbers of a large array, after how many they are.
    fn words(&mut self, words: impl ExactSizeIterator<Item = u32>) {
        self.bytes((words.len() as u64).to_le_bytes());
        for word in words {
            self.bytes(word.to_le_bytes());
        }
    }

    fn object(
        &mut self,
        object: &Object,
        instance: &Instance,
        meshes: &mut HashMap<*const Mesh, usize>,
    ) {
        self.text(&(object.id, object.material, instance.velocity()));
        self.text(instance.world_from_object());
        // A mesh that several objects share is looked at once.
        let next = meshes.len();
        let mesh = *meshes.entry(Arc::as_ptr(&object.mesh)).or_insert(next);
        self.text(&mesh);
        if mesh == next {
            self.mesh(&object.mesh);
        }
    }

    fn mesh(&mut self, mesh: &Mesh) {
        let triangles = mesh.tree.triangles();
        let positions = glam_words(triangles.positions());
        self.words(positions.into_iter());
        self.words(triangles.indices().as_flattened().iter().copied());
        self.words(glam_words(&mesh.normals).into_iter());
        let uvs: Vec<u32> = mesh
            .uvs
            .iter()
            .flat_map(|uv| uv.to_array().map(f32::to_bits))
            .collect();
        self.words(uvs.into_iter());
        self.words(glam_words(&mesh.colors).into_iter());
        self.words(mesh.alphas.iter().map(|alpha| alpha.to_bits()));
        if !mesh.tangents.is_empty() {
            let tangents: Vec<[f32; 4]> = mesh.tangents.iter().map(|t| t.to_array()).collect();
            self.words(tangents.as_flattened().iter().map(|part| part.to_bits()));
        }
    }

    fn texture(&mut self, texture: &Texture) {
        self.text(&(texture.width(), texture.height()));
        match texture.texels() {
            Texels::Srgb8(texels) => {
                self.text(&"sRGB");
                self.bytes(texels.as_flattened().iter().copied());
            }
            Texels::Linear8(texels) => {
                self.text(&"linear");
                self.bytes(texels.as_flattened().iter().copied());
            }
            Texels::Srgb16(texels) => {
                self.text(&"sRGB 16");
                self.words(texels.as_flattened().iter().map(|&c| u32::from(c)));
            }
            Texels::Linear16(texels) => {
                self.text(&"linear 16");
                self.words(texels.as_flattened().iter().map(|&c| u32::from(c)));
            }
            Texels::Linear32(texels) => {
                self.text(&"float");
                self.words(texels.as_flattened().iter().map(|c| c.to_bits()));
            }
            Texels::LinearAlpha32(texels) => {
                self.text(&"float with alpha");
                self.words(texels.as_flattened().iter().map(|c| c.to_bits()));
            }
        }
    }
}

fn glam_words(vectors: &[glam::Vec3]) -> Vec<u32> {
    vectors
        .iter()
        .flat_map(|v| v.to_array().map(f32::to_bits))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::lights::{Lights, MovingLight, PointLight};
    use super::super::material::Material;
    use super::*;
    use crate::scene::Features;
    use glam::Vec3;

    fn world() -> World {
        World {
            materials: Arc::new(vec![Material::default()]),
            ..World::default()
        }
    }

    fn camera() -> Camera {
        Camera::looking_at(Vec3::Z, Vec3::ZERO, Vec3::Y, 1.0)
    }

    #[test]
    fn the_hash_is_fnv_1a() {
        let mut hash = Hash::new();
        hash.bytes(*b"foobar");
        assert_eq!(hash.0, 0x343e_1662_793c_64bf_6f0d_3597_ba44_6f18);
    }

    #[test]
    fn whatever_changes_samples_changes_the_digest() {
        let settings = RenderSettings::default();
        let base = digest(&world(), &camera(), &settings);
        assert_eq!(base, digest(&world(), &camera(), &settings));
        let mut lit = world();
        lit.lights = Arc::new(Lights {
            points: vec![PointLight {
                id: 1,
                position: Vec3::ONE,
                color: Vec3::ONE,
                cone: None,
            }],
            ..Lights::default()
        });
        let mut painted = world();
        painted.materials = Arc::new(vec![Material {
            diffuse: Vec3::splat(0.800_000_1),
            ..Material::default()
        }]);
        let moved = Camera {
            position: Vec3::Z * 1.000_000_1,
            ..camera()
        };
        let seeded = RenderSettings {
            seed: 1,
            ..settings.clone()
        };
        let features = Features {
            shadows: false,
            ..settings.features
        };
        let switched = RenderSettings {
            features,
            ..settings.clone()
        };
        let mut all = vec![
            base,
            digest(&lit, &camera(), &settings),
            digest(&painted, &camera(), &settings),
            digest(&world(), &moved, &settings),
            digest(&world(), &camera(), &seeded),
            digest(&world(), &camera(), &switched),
        ];
        all.sort_by_key(Digest::to_string);
        all.dedup();
        assert_eq!(all.len(), 6, "{all:?}");
    }

    #[test]
    fn how_many_samples_how_trees_are_built_and_how_it_is_shown_do_not() {
        let settings = RenderSettings::default();
        let mut other = RenderSettings {
            spp: 999,
            tree: TreeSettings::SIMPLE,
            ..settings.clone()
        };
        other.output.exposure = 2.0;
        let mut seen = camera();
        seen.optics.lens_samples += 7;
        seen.optics.motion_samples += 7;
        let moving = |samples| {
            let lights = Lights {
                moving: vec![MovingLight {
                    id: 1,
                    velocity: Vec3::X,
                    samples,
                }],
                ..Lights::default()
            };
            World {
                lights: Arc::new(lights),
                ..world()
            }
        };
        assert_eq!(
            digest(&moving(1), &camera(), &settings),
            digest(&moving(9), &seen, &other)
        );
    }
}
