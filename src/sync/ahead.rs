//! What of textures is made before rays ask for it, on threads of their own: smaller copies where mipmaps are read, and the
//! table of a sky that lights. Else the first tracing thread that needs one made it, while all others waited.

use super::tree_building::Threads;
use crate::scene::{Environment, RenderSettings, TextureFilter};
use crate::trace::Texture;
use bevy::asset::AssetId;
use bevy::image::Image;
use bevy::platform::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// Texels of which all is made in no time.
const FEW: u64 = 1 << 16;

/// What rays are going to ask for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Wanted {
    /// Smaller copies of pictures.
    levels: bool,
    /// Where light comes from around a sky.
    table: bool,
}

impl Wanted {
    pub fn of(settings: &RenderSettings, environment: &Environment) -> Self {
        let features = &settings.features;
        Self {
            levels: features.textures && settings.texture_filter == TextureFilter::Mipmap,
            table: features.environment && environment.lights,
        }
    }

    /// Makes it, of a picture that is all around where it `is_around`.
    pub fn make(self, texture: &Texture, is_around: bool) {
        if is_around {
            texture.prepare_as_environment(self.table);
        } else if self.levels {
            texture.prepare_levels();
        }
    }

    /// Makes what is wanted of a map of colours that is cut out.
    pub fn make_cut_out(self, texture: &Texture) {
        if self.levels {
            texture.prepare_cut_out_levels();
        }
    }

    /// Whether nothing is missing of it that takes long.
    fn is_made(self, texture: &Texture, is_around: bool) -> bool {
        let is_small = u64::from(texture.width()) * u64::from(texture.height()) <= FEW;
        let has_all = if is_around {
            !self.table || texture.has_dome_table()
        } else {
            !self.levels || texture.has_levels()
        };
        is_small || has_all
    }
}

/// What is being made.
#[derive(Default)]
pub(super) struct Ahead {
    threads: Threads<(AssetId<Image>, u64)>,
    /// By the number of the work: what was begun earlier of another picture counts no more.
    under_way: HashMap<AssetId<Image>, u64>,
    begun: u64,
}

impl Ahead {
    /// How many are under way.
    pub fn len(&self) -> usize {
        self.under_way.len()
    }

    /// Whether something of this picture is under way.
    pub fn is_awaited(&self, id: AssetId<Image>) -> bool {
        self.under_way.contains_key(&id)
    }

    /// Begins with what is missing.
    pub fn begin(
        &mut self,
        id: AssetId<Image>,
        texture: &Arc<Texture>,
        is_around: bool,
        wanted: Wanted,
    ) {
        if wanted.is_made(texture, is_around) {
            return;
        }
        self.begun += 1;
        let number = self.begun;
        self.under_way.insert(id, number);
        let texture = texture.clone();
        self.threads.run(move || {
            // A panic would be a bug; it must not take the app with it, nor keep it waiting.
            let _ = catch_unwind(AssertUnwindSafe(|| wanted.make(&texture, is_around)));
            (id, number)
        });
    }

    /// Nobody waits for it any more.
    pub fn forget(&mut self, id: AssetId<Image>) {
        self.under_way.remove(&id);
    }

    /// Nothing is waited for any more.
    pub fn stop(&mut self) {
        self.under_way.clear();
    }

    /// What is there since this was asked last.
    pub fn finished(&mut self) -> Vec<AssetId<Image>> {
        let mut finished = Vec::new();
        for (id, number) in self.threads.finished() {
            if self.under_way.get(&id) == Some(&number) {
                self.under_way.remove(&id);
                finished.push(id);
            }
        }
        finished
    }
}
