//! Pictures of the panels that are kept beside this file, and what they look like now: whoever changes a panel sees what
//! became of it, and a change that nobody meant is found.
//!
//! Drawn without a graphics card: egui says in triangles what is to be seen, and what these cover is the same on every
//! machine. The scene's own picture is none of it. `GLASSBOX_KEEP_PICTURES=1` writes them anew.

use super::super::dialogs::{Dialog, Dialogs};
use super::super::inspector::{Inspector, Tab};
use super::{Desk, SMALL};
use crate::editor::inspection::debug_ray::Shot;
use crate::editor::inspection::{DebugRay, Which};
use crate::editor::preferences::{Preferences, ThemeChoice};
use crate::sync::TracedCameras;
use bevy::math::UVec2;
use bevy_egui::egui::epaint::{ClippedPrimitive, Primitive, Vertex};
use bevy_egui::egui::{Color32, ColorImage, Pos2, Rect, TextureId, pos2};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{Rgb, RgbImage};
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

/// Writes the pictures where it is 1.
const KEEP: &str = "GLASSBOX_KEEP_PICTURES";
/// What egui leaves free.
const FREE: Color32 = Color32::from_gray(96);
/// Levels by which a pixel may differ: the last digits of sines and roots are the machine's own, and a shape's soft edge
/// is some levels off with them.
const LEVELS: u8 = 24;
/// Pixels that may differ by more. A word that is another has some hundred.
const MOST: usize = 20;

#[test]
fn panels_look_as_in_the_pictures_that_are_kept_of_them() {
    let mut desk = Desk::open("cornell-box");
    let (_, block) = desk.named("Short block");
    desk.select([block]);
    let mut found = Vec::new();
    for (theme, name) in [
        (ThemeChoice::Dark, "object-dark"),
        (ThemeChoice::Light, "object-light"),
    ] {
        desk.world().resource_mut::<Preferences>().theme = theme;
        // Without the line below, which says how much memory is taken.
        found.extend(differs(&mut desk, name, [0.0, 0.0, 1280.0, 680.0]));
    }
    desk.world().resource_mut::<Preferences>().theme = ThemeChoice::Dark;
    desk.world().resource_mut::<Dialogs>().open = Some(Dialog::Preferences);
    // Without its last line, which says where they are kept.
    found.extend(differs(
        &mut desk,
        "preferences",
        [440.0, 250.0, 840.0, 438.0],
    ));
    desk.world().resource_mut::<Dialogs>().open = None;

    let camera = desk.world().resource::<TracedCameras>().0[0].camera.clone();
    desk.world().resource_mut::<Preferences>().show_rays = true;
    let mut ray = desk.world().resource_mut::<DebugRay>();
    ray.which = Which::First;
    ray.shoot(Shot {
        pixel: UVec2::new(225, 220),
        camera,
        size: UVec2::new(600, 480),
    });
    found.extend(differs(&mut desk, "rays", [0.0, 456.0, 1280.0, 680.0]));
    desk.world().resource_mut::<Preferences>().show_rays = false;

    desk.size = SMALL;
    desk.world().resource_mut::<Inspector>().tab = Tab::Render;
    found.extend(differs(
        &mut desk,
        "render-small",
        [720.0, 50.0, 1024.0, 610.0],
    ));
    assert!(
        found.is_empty(),
        "{}. If that is meant, {KEEP}=1 keeps them anew.",
        found.join("; ")
    );
}

/// Draws until nothing moves any more, and compares a part of the screen, from its left top to its right bottom, with what
/// is kept; what is different, if it is.
fn differs(desk: &mut Desk, name: &str, [left, top, right, bottom]: [f32; 4]) -> Option<String> {
    desk.settle();
    desk.wait(3.0);
    desk.settle();
    let part = Rect::from_min_max(pos2(left, top), pos2(right, bottom));
    let shown = painted(desk, part);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/editor/panels/tests/kept");
    let file = folder.join(format!("{name}.png"));
    if std::env::var(KEEP).is_ok_and(|value| value == "1") {
        std::fs::create_dir_all(&folder).unwrap();
        let out = BufWriter::new(File::create(&file).unwrap());
        let smallest = CompressionType::Best;
        let encoder = PngEncoder::new_with_quality(out, smallest, FilterType::Adaptive);
        shown.write_with_encoder(encoder).unwrap();
        return None;
    }
    let kept = image::open(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    let kept = kept.to_rgb8();
    let off =
        |(a, b): (&Rgb<u8>, &Rgb<u8>)| a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > LEVELS);
    let count = match kept.dimensions() == shown.dimensions() {
        true => kept
            .pixels()
            .zip(shown.pixels())
            .filter(|&pair| off(pair))
            .count(),
        false => usize::MAX,
    };
    if count <= MOST {
        return None;
    }
    let now = std::env::temp_dir().join(format!("glassbox-{name}-now.png"));
    shown.save(&now).unwrap();
    Some(format!(
        "{count} pixels of {} are not those of {}",
        now.display(),
        file.display()
    ))
}

/// What the screen shows there, of letters and of shapes; pictures are left out.
fn painted(desk: &Desk, part: Rect) -> RgbImage {
    let letters = desk.context.fonts(|fonts| fonts.image());
    let shapes = desk.output.shapes.clone();
    let mut screen = Screen::new(part);
    for ClippedPrimitive {
        clip_rect,
        primitive,
    } in desk.context.tessellate(shapes, 1.0)
    {
        let Primitive::Mesh(mesh) = primitive else {
            continue;
        };
        if mesh.texture_id != TextureId::default() {
            continue;
        }
        for corners in mesh.indices.as_chunks::<3>().0 {
            let corners = corners.map(|i| mesh.vertices[i as usize]);
            screen.fill(corners, clip_rect, &letters);
        }
    }
    screen.picture
}

struct Screen {
    part: Rect,
    picture: RgbImage,
}

impl Screen {
    fn new(part: Rect) -> Self {
        let (width, height) = (part.width() as u32, part.height() as u32);
        let free = Rgb([FREE.r(), FREE.g(), FREE.b()]);
        let picture = RgbImage::from_pixel(width, height, free);
        Self { part, picture }
    }

    /// A triangle, where the middles of pixels lie in it; of two that share an edge one has those on it.
    fn fill(&mut self, [a, mut b, mut c]: [Vertex; 3], clip: Rect, letters: &ColorImage) {
        let mut area = side(a.pos, b.pos, c.pos);
        if area < 0.0 {
            std::mem::swap(&mut b, &mut c);
            area = -area;
        }
        let bounds = Rect::from_points(&[a.pos, b.pos, c.pos]);
        let bounds = bounds.intersect(clip).intersect(self.part);
        if area == 0.0 || !bounds.is_positive() {
            return;
        }
        let edges = [(b.pos, c.pos), (c.pos, a.pos), (a.pos, b.pos)];
        for y in bounds.min.y.floor() as u32..bounds.max.y.ceil() as u32 {
            for x in bounds.min.x.floor() as u32..bounds.max.x.ceil() as u32 {
                let at = pos2(x as f32 + 0.5, y as f32 + 0.5);
                let parts = edges.map(|(from, to)| side(from, to, at));
                let is_in = |((from, to), part): ((Pos2, Pos2), f32)| {
                    let has_edge = to.y < from.y || to.y == from.y && to.x > from.x;
                    part > 0.0 || part == 0.0 && has_edge
                };
                if !bounds.contains(at) || !edges.into_iter().zip(parts).all(is_in) {
                    continue;
                }
                let [wa, wb, wc] = parts.map(|part| part / area);
                let mean = |of: fn(&Vertex) -> f32| wa * of(&a) + wb * of(&b) + wc * of(&c);
                let [width, height] = letters.size;
                let texel = |uv: f32, size: usize| ((uv * size as f32) as usize).min(size - 1);
                let column = texel(mean(|v| v.uv.x), width);
                let row = texel(mean(|v| v.uv.y), height);
                let letter = letters.pixels[row * width + column].to_array();
                let ink: [fn(&Vertex) -> f32; 4] = [
                    |v| f32::from(v.color.r()),
                    |v| f32::from(v.color.g()),
                    |v| f32::from(v.color.b()),
                    |v| f32::from(v.color.a()),
                ];
                // Both are multiplied by their opacity already.
                let ink: [f32; 4] =
                    std::array::from_fn(|i| mean(ink[i]) * f32::from(letter[i]) / 255.0);
                let [left, top] = [self.part.min.x as u32, self.part.min.y as u32];
                let below = self.picture.get_pixel_mut(x - left, y - top);
                for (below, ink_of) in below.0.iter_mut().zip(ink) {
                    let left = 1.0 - ink[3] / 255.0;
                    *below = (ink_of + f32::from(*below) * left + 0.5).clamp(0.0, 255.0) as u8;
                }
            }
        }
    }
}

/// Twice the area of the triangle, positive where it turns from x to y.
fn side(a: Pos2, b: Pos2, c: Pos2) -> f32 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}
