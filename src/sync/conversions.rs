//! Large pictures on their way to the threads that make textures of them.

use super::ahead::Wanted;
use super::image_sampler::sampler_of;
use super::panorama::{is_cube, trace_cube};
use super::texture_data::{TextureFault, trace_texture};
use super::textures::TracedTexture;
use super::tree_building::Threads;
use bevy::asset::{AssetId, Assets};
use bevy::image::Image;
use bevy::platform::collections::HashMap;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// Bytes of pictures that are converted within a frame: about a millisecond's.
pub(super) const AT_ONCE: usize = 1 << 20;
/// Bytes that are copied for the threads within a frame: about a millisecond's, too. Some pictures have
/// a hundred million.
const COPIED: usize = 4 << 20;

/// What became of a picture.
pub(super) type TextureResult = Result<TracedTexture, TextureFault>;

/// The texture of a picture, of one all around where it `is_around`.
pub(super) fn convert(image: &Image, is_around: bool) -> TextureResult {
    let converted = if is_around && is_cube(image) {
        trace_cube(image)?
    } else {
        trace_texture(image)?
    };
    Ok(TracedTexture {
        texture: Arc::new(converted.texture),
        sampler: sampler_of(image),
        replaced: converted.replaced,
    })
}

/// How long that takes, as the bytes of a flat picture that takes as long.
pub(super) fn cost(image: &Image, is_around: bool) -> usize {
    let bytes = image.data.as_ref().map_or(0, Vec::len);
    // A panorama's pixels are put together one by one; measured, about so much slower.
    let times = if is_around && is_cube(image) { 16 } else { 1 };
    bytes.saturating_mul(times)
}

/// Pictures that are being converted.
#[derive(Default)]
pub(super) struct Conversions {
    threads: Threads<Finished>,
    /// First come, first copied.
    copies: VecDeque<Copy>,
    under_way: HashMap<AssetId<Image>, UnderWay>,
    /// How many were begun.
    begun: u64,
}

struct UnderWay {
    /// What of the same picture was begun earlier counts no more.
    number: u64,
    /// Whether it was edited since.
    edited: bool,
}

/// A picture of which a part is copied.
struct Copy {
    id: AssetId<Image>,
    number: u64,
    is_around: bool,
    pixels: Vec<u8>,
}

struct Finished {
    id: AssetId<Image>,
    number: u64,
    texture: TextureResult,
}

impl Conversions {
    /// How many are under way.
    pub fn len(&self) -> usize {
        self.under_way.len()
    }

    /// Which are under way.
    pub fn pictures(&self) -> impl Iterator<Item = AssetId<Image>> + '_ {
        self.under_way.keys().copied()
    }

    /// Begins with a picture, or notes that one with which it was begun is another now: it is converted
    /// again after that, because where one is edited in every frame none would ever be done.
    pub fn begin(&mut self, id: AssetId<Image>, is_around: bool) {
        if let Some(known) = self.under_way.get_mut(&id) {
            known.edited = true;
            return;
        }
        self.begun += 1;
        let number = self.begun;
        let edited = false;
        self.under_way.insert(id, UnderWay { number, edited });
        self.copies.push_back(Copy {
            id,
            number,
            is_around,
            pixels: Vec::new(),
        });
    }

    /// Nobody wants it any more.
    pub fn forget(&mut self, id: AssetId<Image>) {
        if self.under_way.remove(&id).is_some() {
            self.copies.retain(|copy| copy.id != id);
        }
    }

    /// Goes on copying, and gives to the threads what is copied; what is `wanted` of it is made there too.
    pub fn go_on(&mut self, assets: &Assets<Image>, wanted: Wanted) {
        let mut left = COPIED;
        while let Some(copy) = self.copies.front_mut() {
            let image = assets.get(copy.id);
            let pixels = image.and_then(|image| image.data.as_deref());
            let (Some(image), Some(pixels)) = (image, pixels) else {
                // It went, which is an event of its own.
                let id = copy.id;
                self.forget(id);
                continue;
            };
            if copy.pixels.len() > pixels.len() {
                copy.pixels.clear();
            }
            copy.pixels.reserve_exact(pixels.len() - copy.pixels.len());
            let from = copy.pixels.len();
            let to = pixels.len().min(from + left);
            copy.pixels.extend_from_slice(&pixels[from..to]);
            left -= to - from;
            if to < pixels.len() {
                return;
            }
            let Some(Copy {
                id,
                number,
                is_around,
                pixels,
            }) = self.copies.pop_front()
            else {
                return;
            };
            let image = Image {
                data: Some(pixels),
                data_order: image.data_order,
                texture_descriptor: image.texture_descriptor.clone(),
                sampler: image.sampler.clone(),
                texture_view_descriptor: None,
                asset_usage: image.asset_usage,
                copy_on_resize: image.copy_on_resize,
            };
            self.threads.run(move || {
                // A panic would be a bug; it must not take the app with it, nor keep it waiting.
                let converted = || {
                    let converted = convert(&image, is_around)?;
                    wanted.make(&converted.texture, is_around);
                    Ok(converted)
                };
                let texture = catch_unwind(AssertUnwindSafe(converted));
                let broken = |_| Err(TextureFault::Broken("it could not be converted".into()));
                let texture = texture.unwrap_or_else(broken);
                Finished {
                    id,
                    number,
                    texture,
                }
            });
        }
    }

    /// What was done since this was asked last, and whether each was edited meanwhile.
    pub fn finished(&mut self) -> Vec<(AssetId<Image>, TextureResult, bool)> {
        let mut finished = Vec::new();
        for done in self.threads.finished() {
            let known = self.under_way.get(&done.id);
            if known.is_some_and(|known| known.number == done.number)
                && let Some(known) = self.under_way.remove(&done.id)
            {
                finished.push((done.id, done.texture, known.edited));
            }
        }
        finished
    }
}
