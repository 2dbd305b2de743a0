//! The window that compares two pictures.

use super::computed::{Look, Pair, Source};
use super::difference::{Figures, How, difference};
use super::histogram::histogram_ui;
use super::zoom::Zoom;
use super::{KeptPictures, PIXELS};
use crate::editor::background::{Background, Outcome};
use crate::editor::panels::fields::number;
use crate::editor::panels::save_form::{SaveForm, save_ui};
use crate::editor::panels::says::Says;
use crate::editor::panels::status::count;
use crate::editor::viewport::traced_render;
use crate::film::{Picture, State};
use crate::inspect::color_text;
use crate::scene::{Output, Quantity};
use crate::view::TracedRender;
use bevy::ecs::world::{Mut, World};
use bevy::math::{UVec2, Vec3};
use bevy_egui::egui::{self, Color32, ColorImage, ComboBox, RichText, TextureHandle, Ui, vec2};
use std::io::Cursor;
use std::time::{Duration, Instant};

/// How often the view's picture is looked at again: it is compared on one core for some hundredths of a second.
const AGAIN: Duration = Duration::from_millis(400);
/// Points of what stands below the picture.
const BELOW: f32 = 120.0;
const GAIN: Quantity = Quantity::within(0.01, 10_000.0, "×").step(0.1);
/// Of the first picture and of the second, on dark surfaces and on light ones.
const INKS: [[Color32; 2]; 2] = [
    [
        Color32::from_rgb(240, 170, 60),
        Color32::from_rgb(96, 160, 244),
    ],
    [
        Color32::from_rgb(150, 84, 0),
        Color32::from_rgb(24, 88, 190),
    ],
];

fn inks(ui: &Ui) -> [Color32; 2] {
    INKS[usize::from(!ui.visuals().dark_mode)]
}

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
    look: Look,
    zoom: Zoom,
    save: SaveForm,
    drawn: Option<Drawn>,
    under_way: Option<Background<Drawn>>,
    /// When that which is under way, or drawn, was begun.
    begun: Instant,
}

/// What was computed, and of what.
struct Drawn {
    sides: [Side; 2],
    look: Look,
    pair: Pair,
    /// When the view's picture was taken.
    of: Option<Moment>,
    /// Taken by the texture as soon as it is there.
    image: Option<ColorImage>,
    texture: Option<TextureHandle>,
}

/// What the view's picture depends on: another one is not looked for until some of it is different.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Moment {
    /// The render's.
    number: u64,
    /// Of each pixel.
    samples: f64,
    /// How coarse it is.
    divider: Option<u32>,
    state: State,
    output: Output,
}

impl Moment {
    fn of(render: &TracedRender) -> Option<Self> {
        // First: what comes in meanwhile is then another moment's.
        let number = render.render()?.number();
        let status = render.status()?;
        Some(Self {
            number,
            samples: status.samples,
            divider: status.divider,
            state: status.state,
            output: *render.output()?,
        })
    }
}

impl Comparison {
    /// Of a kept picture with the view's.
    pub fn new(number: u32) -> Self {
        Self {
            sides: [Side::Kept(number), Side::Now],
            look: Look {
                how: How::default(),
                gain: 4.0,
            },
            zoom: Zoom::default(),
            save: SaveForm::default(),
            drawn: None,
            under_way: None,
            begun: Instant::now(),
        }
    }

    /// Takes what has been computed.
    fn take(&mut self, context: &egui::Context) {
        let Some(outcome) = self.under_way.as_ref().map(Background::take) else {
            return;
        };
        let mut drawn = match outcome {
            Outcome::Pending => return,
            Outcome::Done(drawn) => drawn,
            Outcome::Lost => {
                self.under_way = None;
                return;
            }
        };
        self.under_way = None;
        let held = self.drawn.take().and_then(|before| before.texture);
        drawn.texture = drawn.image.take().map(|image| match held {
            Some(mut texture) => {
                texture.set(image, PIXELS);
                texture
            }
            None => context.load_texture("compared pictures", image, PIXELS),
        });
        self.drawn = Some(drawn);
    }

    /// Begins to compute what is wanted and not there yet; and again what the view shows, from time to time, where that is
    /// another picture by then.
    fn begin(&mut self, world: &World, kept: &KeptPictures) {
        if self.under_way.is_some() {
            return;
        }
        let (sides, look) = (self.sides, self.look);
        let before = self.drawn.as_ref().filter(|drawn| drawn.sides == sides);
        let render = traced_render(world);
        let now = render.and_then(Moment::of);
        let is_other = before.is_some_and(|before| before.of != now);
        let looks_again = is_other && sides.contains(&Side::Now) && self.begun.elapsed() >= AGAIN;
        if !looks_again && before.is_some_and(|before| before.look == look) {
            return;
        }
        let source = |number: usize| match sides[number] {
            Side::Kept(kept_number) => {
                let kept = kept.find(kept_number)?;
                Some(Source::There(kept.picture.clone()))
            }
            Side::Now => match before.filter(|_| !looks_again) {
                Some(before) => Some(Source::There(before.pair.pictures[number].clone())),
                None => Some(Source::Later(Box::new(render?.picture_later()?))),
            },
        };
        let [Some(first), Some(second)] = [source(0), source(1)] else {
            self.drawn = None;
            return;
        };
        let of = before
            .filter(|_| !looks_again)
            .map_or(now, |before| before.of);
        let before = before.map(|before| before.pair.clone());
        let work = move |_: &_| {
            let pair = Pair::of([first, second], before);
            Drawn {
                image: pair.image(look),
                sides,
                look,
                pair,
                of,
                texture: None,
            }
        };
        self.begun = Instant::now();
        // Without a thread nothing is compared; everything else is there.
        self.under_way = Background::start("comparison", work).ok();
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
        comparison.take(context);
        comparison.begin(world, &kept);
        let mut is_open = true;
        // Beside what is in it there are its title and its frame.
        let most = (free.size() - vec2(40.0, 80.0)).max(vec2(320.0, 260.0));
        egui::Window::new("Compare pictures")
            .id(egui::Id::new("compare pictures"))
            .open(&mut is_open)
            .default_size(vec2(640.0, 560.0).min(most))
            .default_pos(free.min + vec2(12.0, 12.0))
            .min_size(vec2(320.0, 260.0))
            .max_size(most)
            .constrain_to(free)
            .show(context, |ui| {
                crate::editor::panels::contained(ui, |ui| {
                    inner_ui(ui, world, &kept, &mut comparison);
                });
            });
        kept.comparison = is_open.then_some(comparison);
    });
}

fn inner_ui(ui: &mut Ui, world: &mut World, kept: &KeptPictures, comparison: &mut Comparison) {
    choices_ui(ui, kept, comparison);
    let is_under_way = comparison.under_way.is_some();
    let Some(drawn) = &comparison.drawn else {
        ui.weak(match is_under_way {
            true => "Compared in a moment.",
            false => "One of the pictures is not there.",
        });
        return;
    };
    figures_ui(ui, drawn.pair.figures);
    let Some(texture) = &drawn.texture else {
        ui.weak("The pictures have different sizes, so there is no difference to show.");
        return;
    };
    let how = drawn.look.how;
    let pair = drawn
        .pair
        .pictures
        .each_ref()
        .map(|picture| &picture.linear);
    let size = pair[usize::from(how == How::Second)].size();
    let height = (ui.available_height() - BELOW).max(80.0);
    let zoom = &mut comparison.zoom;
    let pixel = zoom.ui(ui, height, (texture.id(), size), |pixel| {
        let [a, b] = pair.map(|picture| at(picture, pixel));
        let shown = match how {
            How::First => a,
            How::Second => b,
            How::Signed => b - a,
            How::Relative => Vec3::splat(difference(a, b, true)),
        };
        shown.to_array()
    });
    pixel_ui(ui, pixel, pair);
    let [a, b] = &drawn.pair.histograms;
    let inks = inks(ui);
    histogram_ui(ui, &[(a, inks[0]), (b, inks[1])]);
    let seen = comparison.zoom.seen;
    let kinds = ".png, the part that is seen, pixel by pixel";
    save_ui(
        ui,
        world,
        &mut comparison.save,
        ("compared.png", kinds),
        |file| {
            let is_png = file
                .extension()
                .is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
            if !is_png {
                return Err(format!("{}: call it .png", file.display()));
            }
            let image = drawn.pair.image(drawn.look).ok_or("there is no picture")?;
            png_of(&image, seen.ok_or("nothing of the picture is seen")?)
        },
    );
}

/// A part of a picture, its first and its last pixel included, as a file.
fn png_of(image: &ColorImage, [first, last]: [UVec2; 2]) -> Result<Vec<u8>, String> {
    let size = last + UVec2::ONE - first;
    let pixel = |x, y| {
        let at = (first.y + y) as usize * image.size[0] + (first.x + x) as usize;
        image::Rgba(image.pixels[at].to_srgba_unmultiplied())
    };
    let part = image::RgbaImage::from_fn(size.x, size.y, pixel);
    let mut bytes = Vec::new();
    part.write_to(&mut Cursor::new(&mut bytes), image::ImageFormat::Png)
        .map_err(|why| why.to_string())?;
    Ok(bytes)
}

/// Black outside of it.
fn at(picture: &Picture, pixel: UVec2) -> Vec3 {
    match pixel.cmplt(picture.size()).all() {
        true => picture.pixel(pixel.x, pixel.y),
        false => Vec3::ZERO,
    }
}

/// Which two, and how they are shown.
fn choices_ui(ui: &mut Ui, kept: &KeptPictures, comparison: &mut Comparison) {
    let of = comparison.drawn.as_ref().and_then(|drawn| drawn.of);
    let name = |side: Side| match side {
        Side::Kept(number) => kept
            .find(number)
            .map_or("–".into(), |kept| kept.name.clone()),
        Side::Now => of.map_or("the view".into(), |of| {
            format!("the view: {} spp", count(of.samples))
        }),
    };
    ui.horizontal_wrapped(|ui| {
        for (i, label) in ["First", "Second"].into_iter().enumerate() {
            ui.label(RichText::new(label).color(inks(ui)[i]));
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
            ui.selectable_value(&mut comparison.look.how, how, text)
                .says(says);
        }
        number(
            ui,
            "How many times the difference is shown",
            &mut comparison.look.gain,
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
        let word = if brighter < 0.0 { "darker" } else { "brighter" };
        ui.label(format!("{:.3} % {word}", 100.0 * brighter.abs()))
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
mod tests;
