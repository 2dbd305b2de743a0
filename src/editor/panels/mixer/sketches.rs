//! The lights' own pictures, small: made of the view's planes on a thread of their own, and only while they are looked at.

use crate::editor::background::{Background, Outcome};
use crate::film::{Picture, Progressive, develop_rgba8};
use crate::scene::{Bloom, Output, SceneId};
use bevy::math::{UVec2, Vec3};
use bevy_egui::egui::{self, ColorImage, TextureHandle, TextureOptions};
use std::collections::HashMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Pixels along the longer side of a sketch.
const SIDE: f32 = 96.0;
/// How long one stands at least: making them takes some milliseconds of a core.
const STANDS: Duration = Duration::from_millis(150);

/// The newest sketches.
#[derive(Default)]
pub(super) struct Sketches {
    shown: Vec<Sketch>,
    /// Of what they are.
    of: Option<Of>,
    under_way: Option<Background<Option<Vec<Made>>>>,
    /// Of what those under way will be.
    next: Option<Of>,
    begun: Option<Instant>,
}

/// What a light, or several that share a plane, add to the picture.
pub(super) struct Sketch {
    /// None: what shines by itself.
    pub ids: Vec<SceneId>,
    /// The mean of its picture, linear RGB: without the light's gain where it is one light's.
    pub mean: Vec3,
    pub texture: TextureHandle,
}

/// What sketches depend on.
#[derive(Clone, Debug, PartialEq)]
struct Of {
    /// The render, and its edit.
    number: u64,
    samples: f64,
    output: Output,
}

/// A sketch that waits to be shown.
struct Made {
    ids: Vec<SceneId>,
    mean: Vec3,
    image: ColorImage,
}

impl Sketches {
    /// That of a light.
    pub fn of(&self, id: SceneId) -> Option<&Sketch> {
        self.shown.iter().find(|sketch| sketch.ids.contains(&id))
    }

    /// That of what shines by itself.
    pub fn own(&self) -> Option<&Sketch> {
        self.shown.iter().find(|sketch| sketch.ids.is_empty())
    }

    /// All of them.
    pub fn all(&self) -> &[Sketch] {
        &self.shown
    }

    /// Takes those that are done, and begins others where the render has become another. `factors` multiply the pictures of
    /// single lights.
    pub fn update(
        &mut self,
        context: &egui::Context,
        render: &Arc<Progressive>,
        output: &Output,
        factors: impl FnOnce() -> HashMap<u64, Vec3>,
    ) {
        self.take(context);
        let now = Of {
            number: render.number(),
            samples: render.status().samples,
            output: Output {
                // What spills over in a large picture covers all of a small one.
                bloom: Bloom {
                    enabled: false,
                    ..output.bloom
                },
                ..*output
            },
        };
        let stands = self.begun.is_some_and(|begun| begun.elapsed() < STANDS);
        if self.under_way.is_some() || stands || self.of.as_ref() == Some(&now) {
            return;
        }
        self.begun = Some(Instant::now());
        let (render, factors, output) = (render.clone(), factors(), now.output);
        let work = move |_: &_| sketch(&render, &output, &factors);
        self.next = Some(now);
        // Without a thread there are no sketches; everything else is there.
        self.under_way = Background::start("light sketches", work).ok();
    }

    fn take(&mut self, context: &egui::Context) {
        let Some(outcome) = self.under_way.as_ref().map(Background::take) else {
            return;
        };
        let made = match outcome {
            Outcome::Pending => return,
            Outcome::Done(made) => made,
            Outcome::Lost => None,
        };
        self.under_way = None;
        let Some(made) = made else { return };
        self.of = self.next.take();
        let mut before = std::mem::take(&mut self.shown);
        for Made { ids, mean, image } in made {
            let known = before.iter().position(|sketch| sketch.ids == ids);
            let texture = match known.map(|at| before.swap_remove(at).texture) {
                Some(mut texture) => {
                    texture.set(image, TextureOptions::LINEAR);
                    texture
                }
                None => {
                    let name = format!("light {}", ids.first().map_or(0, |id| id.0));
                    context.load_texture(name, image, TextureOptions::LINEAR)
                }
            };
            self.shown.push(Sketch { ids, mean, texture });
        }
    }
}

/// Pixels of a sketch of a picture.
fn size_of(picture: UVec2) -> UVec2 {
    let size = picture.max(UVec2::ONE).as_vec2();
    let size = size * (SIDE / size.max_element());
    size.round().as_uvec2().max(UVec2::ONE)
}

/// `None` while some light is missing, or is not kept apart.
fn sketch(
    render: &Progressive,
    output: &Output,
    factors: &HashMap<u64, Vec3>,
) -> Option<Vec<Made>> {
    let pictures = render.light_sketches(size_of(render.size()))?;
    let lights = pictures.lights.into_iter();
    let all = std::iter::once((Vec::new(), pictures.own))
        .chain(lights.map(|light| (light.ids, light.picture)));
    let made = all.map(|(ids, mut picture)| {
        let mean = mean(&picture);
        if let [id] = ids[..]
            && let Some(factor) = factors.get(&id)
        {
            picture
                .pixels
                .iter_mut()
                .for_each(|pixel| *pixel *= *factor);
        }
        let bytes = develop_rgba8(&picture, output);
        let size = [picture.width as usize, picture.height as usize];
        Made {
            ids: ids.into_iter().map(SceneId).collect(),
            mean,
            image: ColorImage::from_rgba_unmultiplied(size, &bytes),
        }
    });
    Some(made.collect())
}

fn mean(picture: &Picture) -> Vec3 {
    picture.pixels.iter().sum::<Vec3>() / picture.pixels.len().max(1) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sketch_has_the_picture_s_shape() {
        assert_eq!(size_of(UVec2::new(1280, 720)), UVec2::new(96, 54));
        assert_eq!(size_of(UVec2::new(3, 9)), UVec2::new(32, 96));
        assert_eq!(size_of(UVec2::new(60_000, 1)), UVec2::new(96, 1));
        assert_eq!(size_of(UVec2::ZERO), UVec2::splat(96));
    }
}
