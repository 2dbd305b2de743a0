//! What a mirror sees, for the answer about one of its pixels: the scene from the point where the view's ray meets the
//! mirror, rendered small on a thread of its own.

use crate::editor::background::{Background, Outcome, Watch};
use crate::editor::inspection::DebugRay;
use crate::film::{Ending, develop_rgba8, render_while};
use crate::inspect::mirror_ray;
use crate::scene::{Bloom, Output, RenderSettings, Sampling};
use crate::trace::{Camera, RayTree, World};
use bevy::math::{UVec2, Vec3};
use bevy_egui::egui::{
    self, ColorImage, Image, TextureHandle, TextureOptions, Ui, WidgetInfo, WidgetType, vec2,
};
use std::time::Duration;

/// Pixels of the picture, and points that it takes on the screen.
const SIZE: UVec2 = UVec2::new(240, 160);
/// From its lower to its upper edge: wide enough to show what is beside the thing in question.
const FIELD: f32 = 50_f32.to_radians();
const SAMPLES: u32 = 16;
/// Seconds of tracing: where lamps have hundreds of samples it stays coarse.
const MOST: f32 = 1.0;
/// How far off the mirror it is seen from, as a part of the way from the eye: no ray of the picture meets the mirror where
/// it starts.
const OFF: f32 = 1e-4;
/// How often it is looked for while it is rendered.
const TICK: Duration = Duration::from_millis(50);

/// The newest picture.
#[derive(Default)]
pub(super) struct MirrorPicture {
    texture: Option<TextureHandle>,
    /// Of what it is.
    of: Option<Of>,
    under_way: Option<(Of, Background<Option<ColorImage>>)>,
}

/// Of which rays, developed how.
#[derive(Clone, Copy, PartialEq)]
struct Of {
    rays: u64,
    output: Output,
}

impl MirrorPicture {
    /// Takes the picture that is done, and begins another where the rays have become others. Without a mirror there is
    /// none.
    pub fn update(&mut self, context: &egui::Context, ray: &DebugRay, output: &Output) {
        self.take(context);
        let seen = ray
            .rays()
            .zip(ray.shot())
            .and_then(|(rays, shot)| camera_of(rays, shot.camera.up));
        let (Some(camera), Some((world, settings))) = (seen, ray.traced_with()) else {
            *self = Self::default();
            return;
        };
        let now = Of {
            rays: ray.number(),
            output: Output {
                // What spills over in a large picture covers all of a small one.
                bloom: Bloom {
                    enabled: false,
                    ..output.bloom
                },
                ..*output
            },
        };
        // One at a time: in a drag another is asked for in every frame, and none would be finished.
        if self.under_way.is_none() && self.of != Some(now) {
            let (world, settings) = (world.clone(), settings.clone());
            let work = move |watch: &Watch| {
                // The pool's threads belong to the view.
                let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
                pool.ok()?
                    .install(|| picture_of(&world, &camera, &settings, &now.output, watch))
            };
            match Background::start("mirror picture", work) {
                Ok(work) => self.under_way = Some((now, work)),
                // Without a thread there is no picture; the sentence is there.
                Err(_) => self.of = Some(now),
            }
        }
        if self.under_way.is_some() {
            context.request_repaint_after(TICK);
        }
    }

    fn take(&mut self, context: &egui::Context) {
        let Some((of, work)) = &self.under_way else {
            return;
        };
        let image = match work.take() {
            Outcome::Pending => return,
            Outcome::Done(image) => image,
            Outcome::Lost => None,
        };
        self.of = Some(*of);
        self.under_way = None;
        self.texture =
            image.map(|image| context.load_texture("mirror", image, TextureOptions::LINEAR));
    }

    /// The picture, or its place while it is rendered; nothing where there is none.
    pub fn show(&self, ui: &mut Ui) {
        let size = vec2(SIZE.x as f32, SIZE.y as f32);
        let room = ui.available_width().min(size.x);
        let size = size * (room / size.x);
        let (rect, response) = match (&self.texture, &self.under_way) {
            (None, None) => return,
            _ => ui.allocate_exact_size(size, egui::Sense::hover()),
        };
        let name = "What the mirror sees there";
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Image, true, name));
        match &self.texture {
            Some(texture) => Image::new(texture).corner_radius(3.0).paint_at(ui, rect),
            None => {
                let well = ui.visuals().extreme_bg_color;
                ui.painter().rect_filled(rect, 3.0, well);
            }
        }
    }
}

/// Where the mirror's picture is seen from, if the rays show a mirror: where its ray leaves it, in that direction. What is
/// above in the view, is above.
fn camera_of(rays: &RayTree, up: Vec3) -> Option<Camera> {
    let mirrored = mirror_ray(rays)?;
    let before = rays.rays.get(mirrored.parent? as usize)?;
    let hit = before.hit?;
    // Of a lobe's samples each goes elsewhere: the mirror's own direction is in their middle.
    let (normal, back) = (hit.normal, hit.to_viewer);
    let ahead = 2.0 * normal.dot(back) * normal - back;
    let up = up - 2.0 * up.dot(normal) * normal;
    let off = OFF * before.t * before.direction.length();
    let from = mirrored.origin + off * hit.geometric_normal;
    let camera = Camera::looking_at(from, from + ahead, up, FIELD);
    (camera.position.is_finite() && camera.forward.is_finite()).then_some(camera)
}

/// `None` where it is wanted no more.
fn picture_of(
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
    output: &Output,
    watch: &Watch,
) -> Option<ColorImage> {
    let settings = RenderSettings {
        size: SIZE,
        spp: SAMPLES,
        jitter: 1,
        sampling: Sampling {
            time: MOST,
            ..Sampling::default()
        },
        ..settings.clone()
    };
    let go_on = |_: &_| watch.tell("the mirror", 0.0).is_continue();
    let rendered = render_while(world, camera, &settings, &go_on);
    if rendered.ending == Ending::Cancelled {
        return None;
    }
    let mut picture = rendered.picture;
    // As it is seen in the mirror: what is on the left of the view is on the left.
    for row in picture.pixels.chunks_exact_mut(SIZE.x as usize) {
        row.reverse();
    }
    let bytes = develop_rgba8(&picture, output);
    let size = [SIZE.x as usize, SIZE.y as usize];
    Some(ColorImage::from_rgba_unmultiplied(size, &bytes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::headless_app;
    use crate::scene::{Environment, MeshSource, Phong, SceneId, Shape};
    use crate::sync::Traced;
    use crate::trace::{Samples, probe};
    use bevy::color::LinearRgba;
    use bevy::transform::components::Transform;

    /// A mirror on the wall ahead; behind the eye a red block, at its left a green one and at its right a blue one. All
    /// of them glow, so that no lamp is needed.
    fn scene() -> bevy::app::App {
        let mut app = headless_app();
        let world = app.world_mut();
        world.insert_resource(Environment::default());
        let block = |size: Vec3| MeshSource::Shape(Shape::Cuboid { size });
        let glows = |r: f32, g: f32, b: f32| Phong {
            diffuse: LinearRgba::BLACK,
            emission: LinearRgba::rgb(r, g, b),
            ..Phong::default()
        };
        let mirror = Phong {
            diffuse: LinearRgba::BLACK,
            specular: LinearRgba::WHITE,
            mirror: LinearRgba::WHITE,
            ..Phong::default()
        };
        let cube = Vec3::splat(0.8);
        for (id, source, phong, at) in [
            (1, block(Vec3::new(2.0, 2.0, 0.1)), mirror, -2.0 * Vec3::Z),
            (2, block(cube), glows(1.0, 0.0, 0.0), 2.0 * Vec3::Z),
            (
                3,
                block(cube),
                glows(0.0, 1.0, 0.0),
                Vec3::new(-1.0, 0.0, 2.0),
            ),
            (
                4,
                block(cube),
                glows(0.0, 0.0, 1.0),
                Vec3::new(1.0, 0.0, 2.0),
            ),
        ] {
            let place = Transform::from_translation(at);
            world.spawn((SceneId(id), source, phong, place));
        }
        app.update();
        app.update();
        app
    }

    #[test]
    fn the_picture_shows_what_a_mirror_sees_as_it_is_seen_in_the_mirror() {
        let app = scene();
        let traced = &app.world().resource::<Traced>().world;
        let settings = RenderSettings {
            size: UVec2::new(90, 60),
            ..RenderSettings::default()
        };
        let eye = Camera::looking_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0);
        let rays = |pixel| probe(traced, &eye, &settings, pixel, &Samples::One(0)).unwrap();
        let middle = rays(UVec2::new(45, 30));
        let camera = camera_of(&middle, eye.up).expect("the mirror is in the middle");
        assert!(camera.position.distance(-1.95 * Vec3::Z) < 0.05);
        let output = Output::default();
        let picture = picture_of(traced, &camera, &settings, &output, &Watch::default()).unwrap();
        let [width, height] = picture.size;
        let strongest = |x: usize| {
            let [r, g, b, _] = picture.pixels[(height / 2) * width + x].to_array();
            let parts = [r, g, b];
            assert!(parts.iter().any(|&part| part > 100), "{x}: {parts:?}");
            (0..3).max_by_key(|&i| parts[i]).unwrap()
        };
        // Red in the middle, and on the left what is on the left of the view.
        let seen = [width / 2, width / 2 - 52, width / 2 + 52].map(strongest);
        assert_eq!(seen, [0, 1, 2], "of red, green and blue");
        assert!(
            camera_of(&rays(UVec2::new(1, 1)), eye.up).is_none(),
            "no mirror"
        );
    }
}
