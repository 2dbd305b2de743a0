//! Where the samples of the picked pixel lie: an inset over the picture.

use crate::editor::inspection::DebugRay;
use crate::editor::selection::Selection;
use crate::inspect::{
    Dimension, InspectSettings, Pattern, PatternSettings, Thinned, counted, pattern,
};
use crate::scene::RenderSettings;
use crate::trace::{DOME, Lights, World, samples_per_pixel};
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World as Scene;
use bevy::math::UVec2;
use bevy_egui::egui::{Align2, Color32, FontId, Pos2, Rect, Stroke, StrokeKind, Ui, pos2, vec2};
use std::sync::Arc;

/// Of the picture's shorter side.
const PART: f32 = 0.34;
/// Points of a side at most.
const LARGEST: f32 = 260.0;
/// Points that are drawn at most: more would fill the square.
const MOST: u64 = 4096;
/// Room for the two lines of text above, in points.
const TEXT: f32 = 32.0;
const INK: Color32 = Color32::from_rgb(220, 220, 220);
/// The same yellow that the command line draws with.
const POINT: Color32 = Color32::from_rgb(255, 243, 124);

/// Where the picked pixel's samples lie.
#[derive(Resource, Default)]
pub(super) struct ShownPattern(Option<PatternOf>);

/// A pattern, and of what it is.
struct PatternOf {
    /// The world is held, so that no other one takes its place in memory.
    of: (Arc<World>, RenderSettings, PatternSettings, UVec2, u64),
    pattern: Pattern,
}

/// What the points are: those of all of the pixel's samples, or the first.
fn heading(points: usize, thinned: Option<&Thinned>, pixel: UVec2) -> String {
    let UVec2 { x, y } = pixel;
    match thinned {
        Some(Thinned { drawn, of, .. }) => {
            format!("the first {drawn} of {of} samples of pixel {x}, {y}")
        }
        None => format!("{} of pixel {x}, {y}", counted(points as u64, "sample")),
    }
}

/// Draws it, where it is switched on and a pixel is picked.
pub(super) fn pattern_ui(ui: &Ui, free: Rect, scene: &Scene, shown: &mut ShownPattern) {
    let inspect = scene.get_resource::<InspectSettings>();
    let Some(choice) = inspect.filter(|i| i.on && i.pattern.on).map(|i| &i.pattern) else {
        shown.0 = None;
        return;
    };
    let ray = scene.get_resource::<DebugRay>();
    let picked = ray.and_then(|ray| Some((ray.shot()?, ray.traced_with()?)));
    let Some((shot, (world, settings))) = picked else {
        shown.0 = None;
        return;
    };
    let pixel = shot.pixel;
    let selected = scene.get_resource::<Selection>();
    let selected: Vec<u64> =
        selected.map_or_else(Vec::new, |s| s.ids().iter().map(|id| id.0).collect());
    let choice = PatternSettings {
        light: light_of(&world.lights, choice, &selected),
        ..choice.clone()
    };
    let count = u64::from(samples_per_pixel(world, &shot.camera, settings));
    let of = (world.clone(), settings.clone(), choice, pixel, count);
    let same = shown.0.as_ref().is_some_and(|known| {
        Arc::ptr_eq(&known.of.0, &of.0)
            && (&known.of.1, &known.of.2, known.of.3, known.of.4) == (&of.1, &of.2, of.3, of.4)
    });
    if !same {
        let pattern = pattern(world, settings, &of.2, pixel, count, MOST);
        shown.0 = Some(PatternOf { of, pattern });
    }
    let Some(PatternOf { pattern, .. }) = &shown.0 else {
        return;
    };
    let heading = heading(pattern.points.len(), pattern.thinned.as_ref(), pixel);
    inset_ui(ui, free, pattern, heading);
}

/// The light that is asked for; else a selected one, else the first one that has an extent, else the dome.
fn light_of(lights: &Lights, choice: &PatternSettings, selected: &[u64]) -> u64 {
    let segments = lights.segments.iter().map(|light| light.id);
    let parallelograms = lights.parallelograms.iter().map(|light| light.id);
    let suns = lights.directionals.iter().map(|light| light.id);
    let mut all = parallelograms.chain(segments).chain(suns);
    let chosen = all.clone().find(|id| *id == choice.light);
    let chosen = chosen.or_else(|| all.clone().find(|id| selected.contains(id)));
    chosen.or_else(|| all.next()).unwrap_or(DOME)
}

/// The square's side, in points.
fn side(free: Rect) -> f32 {
    (PART * free.size().min_elem()).min(LARGEST).floor()
}

fn inset_ui(ui: &Ui, free: Rect, pattern: &Pattern, heading: String) {
    let side = side(free);
    if side < 40.0 {
        return;
    }
    let corner = free.right_top() + vec2(-side - 12.0, 12.0 + TEXT);
    let square = Rect::from_min_size(corner, vec2(side, side));
    let painter = ui.painter().with_clip_rect(free);
    let around = Rect::from_min_max(corner - vec2(6.0, TEXT), square.max + vec2(6.0, 6.0));
    painter.rect_filled(around, 4.0, Color32::from_black_alpha(215));
    let count = pattern.points.len();
    for cell in 1..cells(count, side) {
        let part = cell as f32 / cells(count, side) as f32;
        let line = Stroke::new(1.0, Color32::from_gray(70));
        painter.vline(corner.x + part * side, square.y_range(), line);
        painter.hline(square.x_range(), corner.y + part * side, line);
    }
    let radius = (side / 110.0).clamp(1.0, 2.0);
    for point in &pattern.points {
        let at = Pos2::new(corner.x + point.x * side, corner.y + point.y * side);
        painter.circle_filled(at, radius, POINT);
    }
    painter.rect_stroke(square, 0.0, Stroke::new(1.0, INK), StrokeKind::Outside);
    for (row, text) in [
        heading,
        format!("across: {}   down: {}", name(pattern.x), name(pattern.y)),
    ]
    .into_iter()
    .enumerate()
    {
        let at = pos2(corner.x, around.min.y + 3.0 + 14.0 * row as f32);
        painter.text(at, Align2::LEFT_TOP, text, FontId::proportional(11.0), INK);
    }
}

/// Along each side, where the samples have a whole root and the cells can be told apart.
fn cells(count: usize, side: f32) -> usize {
    let root = (count as f64).sqrt().round() as usize;
    if root * root == count && root as f32 * 6.0 <= side {
        root.max(1)
    } else {
        1
    }
}

fn name(dimension: Dimension) -> &'static str {
    match dimension {
        Dimension::PixelX => "pixel x",
        Dimension::PixelY => "pixel y",
        Dimension::LensU => "lens u",
        Dimension::LensV => "lens v",
        Dimension::Time => "time",
        Dimension::LightU => "light u",
        Dimension::LightV => "light v",
        Dimension::GlossU => "blur u",
        Dimension::GlossV => "blur v",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::ParallelogramLight;

    #[test]
    fn there_are_as_many_cells_as_samples_where_these_have_a_root_and_room() {
        assert_eq!(cells(16, 160.0), 4);
        assert_eq!(cells(17, 160.0), 1);
        assert_eq!(cells(1024, 160.0), 1);
        assert_eq!(cells(0, 160.0), 1);
    }

    #[test]
    fn the_heading_says_how_many_samples_there_are_and_how_many_of_them_are_shown() {
        let pixel = UVec2::new(3, 7);
        // Of a light's points each sample may have several.
        assert_eq!(heading(64, None, pixel), "64 samples of pixel 3, 7");
        assert_eq!(heading(1, None, pixel), "1 sample of pixel 3, 7");
        let thinned = Thinned {
            what: "points",
            drawn: 4096,
            of: 9000,
            rule: "the first",
        };
        assert_eq!(
            heading(4096, Some(&thinned), pixel),
            "the first 4096 of 9000 samples of pixel 3, 7"
        );
    }

    #[test]
    fn the_light_is_the_one_asked_for_or_selected_or_the_first() {
        let light = |id| ParallelogramLight {
            id,
            ..PARALLELOGRAM
        };
        let lights = Lights {
            parallelograms: vec![light(4), light(9)],
            ..Lights::default()
        };
        let asked = |light| PatternSettings {
            light,
            ..PatternSettings::default()
        };
        assert_eq!(light_of(&lights, &asked(9), &[4]), 9);
        assert_eq!(light_of(&lights, &asked(0), &[2, 9]), 9);
        assert_eq!(light_of(&lights, &asked(0), &[]), 4);
        assert_eq!(light_of(&Lights::default(), &asked(3), &[3]), 0);
    }

    const PARALLELOGRAM: ParallelogramLight = ParallelogramLight {
        id: 0,
        corner: bevy::math::Vec3::ZERO,
        edges: [bevy::math::Vec3::X, bevy::math::Vec3::Z],
        colors: [bevy::math::Vec3::ONE; 4],
        two_sided: false,
        visible: true,
        samples: 1,
    };
}
