//! The window that compares two pictures.

use super::difference::{Figures, How, difference, figures, pixels};
use super::histogram::{Histogram, histogram_ui};
use super::zoom::{Zoom, channels};
use super::{KeptPictures, PIXELS, color_image, picture_now};
use crate::editor::inspection::column::color_text;
use crate::editor::panels::fields::number;
use crate::editor::panels::says::Says;
use crate::film::Picture;
use crate::scene::Quantity;
use crate::view::TracedPicture;
use bevy::ecs::world::{Mut, World};
use bevy::math::{UVec2, Vec3};
use bevy_egui::egui::{self, Color32, ColorImage, ComboBox, RichText, TextureHandle, Ui, vec2};
use std::time::{Duration, Instant};

/// How often the view's picture is looked at again: developing it takes milliseconds.
const AGAIN: Duration = Duration::from_millis(400);
/// Points of what stands below the picture.
const BELOW: f32 = 90.0;
const GAIN: Quantity = Quantity::within(0.01, 10_000.0, "×").step(0.1);
const INKS: [Color32; 2] = [
    Color32::from_rgb(240, 170, 60),
    Color32::from_rgb(79, 150, 240),
];

/// One side of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    /// A kept picture, by its number.
    Kept(u32),
    /// What the view shows.
    Now,
}

/// What is compared, and how it is looked at.
pub(super) struct Comparison {
    sides: [Side; 2],
    how: How,
    gain: f32,
    zoom: Zoom,
    now: Option<Now>,
    drawn: Option<Drawn>,
}

/// The view's picture a moment ago.
struct Now {
    picture: TracedPicture,
    samples: f64,
    taken: Instant,
    /// Counts the pictures that were taken.
    number: u32,
}

/// Of what something was computed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Of {
    sides: [Side; 2],
    now: u32,
    how: How,
    gain: f32,
}

/// What was computed of two pictures.
struct Drawn {
    of: Of,
    texture: Option<TextureHandle>,
    figures: Option<Figures>,
    histograms: [Histogram; 2],
}

impl Comparison {
    /// Of a kept picture with the view's.
    pub fn new(number: u32) -> Self {
        Self {
            sides: [Side::Kept(number), Side::Now],
            how: How::default(),
            gain: 4.0,
            zoom: Zoom::default(),
            now: None,
            drawn: None,
        }
    }
}

/// The window, where it is open.
pub(in crate::editor::panels) fn window_ui(
    context: &egui::Context,
    free: egui::Rect,
    world: &mut World,
) {
    if world.resource::<KeptPictures>().comparison.is_none() {
        return;
    }
    world.resource_scope(|world, mut kept: Mut<KeptPictures>| {
        let Some(mut comparison) = kept.comparison.take() else {
            return;
        };
        look_again(world, &mut comparison);
        let mut is_open = true;
        let most = (free.size() - vec2(20.0, 50.0)).max(vec2(320.0, 260.0));
        egui::Window::new("Compare")
            .id(egui::Id::new("compare pictures"))
            .open(&mut is_open)
            .default_size(vec2(640.0, 560.0).min(most))
            .default_pos(free.min + vec2(12.0, 12.0))
            .min_size(vec2(320.0, 260.0))
            .max_size(most)
            .show(context, |ui| {
                crate::editor::panels::contained(ui, |ui| {
                    inner_ui(ui, &kept, &mut comparison);
                });
            });
        kept.comparison = is_open.then_some(comparison);
    });
}

/// Takes the view's picture, where that is wanted and has become another.
fn look_again(world: &mut World, comparison: &mut Comparison) {
    if !comparison.sides.contains(&Side::Now) {
        return;
    }
    let before = comparison.now.as_ref();
    if before.is_some_and(|now| now.taken.elapsed() < AGAIN) {
        return;
    }
    let Some((picture, samples)) = picture_now(world) else {
        return;
    };
    let is_same = before.is_some_and(|now| now.picture == picture);
    let number = before.map_or(0, |now| now.number) + u32::from(!is_same);
    comparison.now = Some(Now {
        picture,
        samples,
        taken: Instant::now(),
        number,
    });
}

fn inner_ui(ui: &mut Ui, kept: &KeptPictures, comparison: &mut Comparison) {
    choices_ui(ui, kept, comparison);
    let Comparison {
        sides,
        how,
        gain,
        zoom,
        now,
        drawn,
    } = comparison;
    let picture_of = |side: Side| match side {
        Side::Kept(number) => kept.find(number).map(|kept| &kept.picture),
        Side::Now => now.as_ref().map(|now| &now.picture),
    };
    let [Some(first), Some(second)] = sides.map(picture_of) else {
        ui.weak("One of the pictures is not there.");
        return;
    };
    let of = Of {
        sides: *sides,
        now: now.as_ref().map_or(0, |now| now.number),
        how: *how,
        gain: *gain,
    };
    if drawn.as_ref().is_none_or(|drawn| drawn.of != of) {
        let before = drawn.take();
        *drawn = Some(Drawn::new(ui.ctx(), of, [first, second], before));
    }
    let Some(drawn) = drawn else {
        return;
    };
    figures_ui(ui, drawn.figures);
    let Some(texture) = &drawn.texture else {
        ui.weak("The pictures have different sizes, so there is no difference to show.");
        return;
    };
    let pair = [&first.linear, &second.linear];
    let size = pair[usize::from(*how == How::Second)].size();
    let height = (ui.available_height() - BELOW).max(80.0);
    let pixel = zoom.ui(ui, height, (texture.id(), size), |pixel| {
        let [a, b] = pair.map(|picture| at(picture, pixel));
        channels(match *how {
            How::First => a,
            How::Second => b,
            How::Signed => b - a,
            How::Relative => Vec3::splat(difference(a, b, true)),
        })
    });
    pixel_ui(ui, pixel, pair);
    let [a, b] = &drawn.histograms;
    histogram_ui(ui, &[(a, INKS[0]), (b, INKS[1])]);
}

/// Black outside of it.
fn at(picture: &Picture, pixel: UVec2) -> Vec3 {
    match pixel.cmplt(picture.size()).all() {
        true => picture.pixel(pixel.x, pixel.y),
        false => Vec3::ZERO,
    }
}

impl Drawn {
    fn new(
        context: &egui::Context,
        of: Of,
        [first, second]: [&TracedPicture; 2],
        before: Option<Self>,
    ) -> Self {
        let pair = [&first.linear, &second.linear];
        let size = pair[0].size();
        let difference = |is_relative| {
            let pixels = pixels(pair[0], pair[1], is_relative, of.gain)?;
            Some(ColorImage::new([size.x as usize, size.y as usize], pixels))
        };
        let image = match of.how {
            How::First => Some(color_image(first)),
            How::Second => Some(color_image(second)),
            How::Signed => difference(false),
            How::Relative => difference(true),
        };
        let is_of_the_same = |before: &Self| before.of.sides == of.sides && before.of.now == of.now;
        let (held, known) = match before {
            Some(before) if is_of_the_same(&before) => {
                let known = Some((before.figures, before.histograms));
                (before.texture, known)
            }
            Some(before) => (before.texture, None),
            None => (None, None),
        };
        let (figures, histograms) =
            known.unwrap_or_else(|| (figures(pair[0], pair[1]), pair.map(Histogram::of)));
        let texture = image.map(|image| match held {
            Some(mut texture) => {
                texture.set(image, PIXELS);
                texture
            }
            None => context.load_texture("compared pictures", image, PIXELS),
        });
        Self {
            of,
            texture,
            figures,
            histograms,
        }
    }
}

/// Which two, and how they are shown.
fn choices_ui(ui: &mut Ui, kept: &KeptPictures, comparison: &mut Comparison) {
    let samples = comparison.now.as_ref().map(|now| now.samples);
    let name = |side: Side| match side {
        Side::Kept(number) => kept
            .find(number)
            .map_or("–".into(), |kept| kept.name.clone()),
        Side::Now => samples.map_or("the view".into(), |spp| {
            format!("the view: {} spp", spp.floor())
        }),
    };
    ui.horizontal_wrapped(|ui| {
        for (i, label) in ["First", "Second"].into_iter().enumerate() {
            ui.label(RichText::new(label).color(INKS[i]));
            let side = &mut comparison.sides[i];
            ComboBox::from_id_salt(label)
                .selected_text(name(*side))
                .show_ui(ui, |ui| {
                    let all = kept.all.iter().map(|kept| Side::Kept(kept.number));
                    for choice in all.chain([Side::Now]) {
                        ui.selectable_value(side, choice, name(choice));
                    }
                })
                .response
                .says("Which picture: one that was kept, or what the view shows");
        }
    });
    ui.horizontal_wrapped(|ui| {
        for (how, text, says) in [
            (How::First, "First only", "The first picture as it is shown"),
            (
                How::Second,
                "Second only",
                "The second picture as it is shown",
            ),
            (
                How::Signed,
                "Difference",
                "Orange where the second is brighter, blue where it is darker",
            ),
            (
                How::Relative,
                "Relative",
                "The difference as a part of the first's brightness",
            ),
        ] {
            ui.selectable_value(&mut comparison.how, how, text)
                .says(says);
        }
        number(
            ui,
            "How many times the difference is shown",
            &mut comparison.gain,
            GAIN,
        );
    });
}

fn figures_ui(ui: &mut Ui, figures: Option<Figures>) {
    let Some(Figures {
        rmse,
        relative,
        brighter,
    }) = figures
    else {
        return;
    };
    ui.horizontal_wrapped(|ui| {
        ui.label(format!("RMSE {rmse:.5}"))
            .says("Root of the mean squared difference over all pixels and channels");
        ui.label(format!("relative {:.3} %", 100.0 * relative))
            .says("Root of the mean squared difference of the brightness, as parts of the first's");
        ui.label(format!("{:+.3} % brighter", 100.0 * brighter))
            .says("How much more light the second has in all: noise leaves it, an edit or an error does not");
    });
}

/// The pixel under the pointer in numbers.
fn pixel_ui(ui: &mut Ui, pixel: Option<UVec2>, pair: [&Picture; 2]) {
    let Some(pixel) = pixel else {
        ui.weak("Point at a pixel to read its numbers.");
        return;
    };
    let [a, b] = pair.map(|picture| at(picture, pixel));
    ui.label(format!(
        "{}, {}:  {}   {}   {:+.2} %",
        pixel.x,
        pixel.y,
        color_text(a),
        color_text(b),
        100.0 * difference(a, b, true)
    ));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::action::Action;
    use crate::editor::document::adopt;
    use crate::editor::panels::tests::Desk;

    fn picture(level: f32) -> TracedPicture {
        let mut linear = Picture::black(UVec2::new(8, 4));
        linear.pixels.fill(Vec3::splat(level));
        let shown = vec![128; 4 * linear.pixels.len()];
        TracedPicture { linear, shown }
    }

    #[test]
    fn two_kept_pictures_are_compared_in_figures_and_another_scene_forgets_them() {
        let mut desk = Desk::open("cornell-box");
        adopt(desk.world(), "cornell-box", None);
        desk.world().write_message(Action::run("compare.open"));
        desk.settle();
        assert!(desk.find("Difference").is_none(), "nothing was kept");
        let mut kept = desk.world().resource_mut::<KeptPictures>();
        kept.add(picture(1.0), 16.0);
        kept.add(picture(1.1), 64.0);
        desk.settle();
        desk.click_on("Compare");
        // A window that appears is measured before it is drawn.
        desk.settle();
        desk.place_of("One of the pictures is not there.");
        let mut kept = desk.world().resource_mut::<KeptPictures>();
        let comparison = kept.comparison.as_mut().unwrap();
        assert_eq!(comparison.sides, [Side::Kept(2), Side::Now]);
        comparison.sides = [Side::Kept(1), Side::Kept(2)];
        desk.settle();
        desk.place_of("1: 16 spp");
        desk.place_of("2: 64 spp");
        desk.place_of("RMSE 0.10000");
        desk.place_of("+10.000 % brighter");
        desk.click_on("Relative");
        let kept = desk.world().resource::<KeptPictures>();
        assert_eq!(kept.comparison.as_ref().unwrap().how, How::Relative);
        desk.world().write_message(Action::Open("triangle".into()));
        desk.settle();
        assert!(desk.find("Difference").is_none());
        assert!(desk.world().resource::<KeptPictures>().all.is_empty());
    }

    #[test]
    fn more_than_a_few_kept_pictures_drop_the_oldest() {
        let mut kept = KeptPictures::default();
        for _ in 0..=super::super::MOST {
            kept.add(picture(1.0), 1.0);
        }
        assert_eq!(kept.all.len(), super::super::MOST);
        assert!(kept.find(1).is_none() && kept.find(2).is_some());
    }
}
