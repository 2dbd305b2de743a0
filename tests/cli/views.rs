//! `glassbox render --view NAME` from a scene file to a picture file, against closed forms.
//!
//! Pixels are squares of 0.1 m that an orthographic camera sees straight on: a wall 2 m away on the
//! left (object 9), one that recedes by 45° from 5 m on the right (object 7), nothing in the five
//! rows at the top.

use super::succeeds;
use bevy::color::LinearRgba;
use bevy::math::Vec3;
use glassbox::app::headless_app;
use glassbox::film::FirstHits;
use glassbox::film::views::{object_color, viridis};
use glassbox::io::{OpenOptions, SceneSource, open, save};
use glassbox::scene::*;
use glassbox::sync::{Traced, TracedCameras};
use std::path::Path;

const SIZE: [u32; 2] = [40, 30];
/// kd of the wall on the left, and of the one on the right.
const COLORS: [[f32; 3]; 2] = [[0.5, 0.25, 0.125], [0.1, 0.9, 0.3]];
/// The left wall ends within this column, 3 cm after its beginning.
const EDGE: u32 = 20;
/// Rows with nothing in them.
const EMPTY: u32 = 5;

fn write_scene(file: &Path) {
    let mut app = headless_app();
    let world = app.world_mut();
    let corners = [Vec3::new(-10.0, -10.0, -2.0), Vec3::new(0.0, -10.0, -5.0)];
    let across = [Vec3::X * 10.03, Vec3::new(10.0, 0.0, -10.0)];
    for i in 0..2 {
        let shape = Shape::Quad {
            corner: corners[i],
            edges: [across[i], Vec3::Y * 11.0],
        };
        let [r, g, b] = COLORS[i];
        let phong = Phong {
            diffuse: LinearRgba::rgb(r, g, b),
            ..Phong::default()
        };
        world.spawn((SceneId([9, 7][i]), MeshSource::Shape(shape), phong));
    }
    let projection = Projection::Orthographic { height: 3.0 };
    world.spawn((
        SceneId(1),
        SceneCamera {
            projection,
            ..SceneCamera::default()
        },
    ));
    let lost = save(world, file).unwrap();
    assert!(lost.is_empty(), "{lost:?}");
}

struct Shown {
    picture: image::RgbImage,
}

impl Shown {
    /// What the program writes for a view.
    fn render(view: &str, more: &[&str]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        write_scene(&folder.path().join("walls.scn.ron"));
        let size = format!("{}x{}", SIZE[0], SIZE[1]);
        let arguments = ["render", "walls.scn.ron", "-o", "v.png", "--size", &size];
        let shading = ["--set", "features.shading=false", "--view", view];
        let arguments = [&arguments[..], &shading, more].concat();
        succeeds(folder.path(), &arguments);
        let picture = image::open(folder.path().join("v.png"))
            .unwrap()
            .into_rgb8();
        assert_eq!(picture.dimensions(), (SIZE[0], SIZE[1]));
        Self { picture }
    }

    /// Checks every pixel whose colour is known; 1/255 is a rounding.
    fn is(&self, expected: impl Fn(u32, u32) -> Option<[f32; 3]>) {
        let mut checked = 0;
        for (x, y, pixel) in self.picture.enumerate_pixels() {
            let Some(color) = expected(x, y) else {
                continue;
            };
            let bytes = color.map(|c| (255.0 * c).round() as i32);
            for (byte, found) in bytes.into_iter().zip(pixel.0) {
                let found = i32::from(found);
                assert!(
                    (byte - found).abs() <= 1,
                    "pixel {x}, {y}: {:?} for {bytes:?}",
                    pixel.0
                );
            }
            checked += 1;
        }
        assert!(checked >= 500, "only {checked} pixels have a known colour");
    }

    fn pixel(&self, x: u32, y: u32) -> [u8; 3] {
        self.picture.get_pixel(x, y).0
    }
}

/// One of `walls` by the pixel's wall, black where there is none, nothing where both meet.
fn by_wall(x: u32, y: u32, walls: [[f32; 3]; 2]) -> Option<[f32; 3]> {
    match (x, y) {
        (_, y) if y < EMPTY => Some([0.0; 3]),
        (EDGE, _) => None,
        (x, _) => Some(walls[usize::from(x > EDGE)]),
    }
}

/// The curve of IEC 61966-2-1.
fn srgb(color: [f32; 3]) -> [f32; 3] {
    color.map(|c| {
        if c <= 0.003_130_8 {
            12.92 * c
        } else {
            1.055 * c.powf(1.0 / 2.4) - 0.055
        }
    })
}

#[test]
fn without_shading_the_shaded_view_and_albedo_are_each_walls_colour() {
    let colors = COLORS.map(srgb);
    Shown::render("shaded", &["--spp", "4"]).is(|x, y| by_wall(x, y, colors));
    Shown::render("albedo", &["--spp", "4"]).is(|x, y| by_wall(x, y, colors));
}

#[test]
fn depth_is_each_walls_distance() {
    let view = Shown::render("depth", &["--range", "0..10", "--spp", "1"]);
    view.is(|x, y| {
        // The distance grows along x as the wall recedes.
        let right = 5.0 + 0.1 * (x as f32 + 0.5 - 20.0);
        let colors = [2.0, right].map(|metres| viridis(1.0 - metres / 10.0));
        by_wall(x, y, colors)
    });
}

#[test]
fn normals_are_the_walls_in_world_space() {
    let half = 0.5_f32.sqrt();
    let normals = [Vec3::Z, Vec3::new(half, 0.0, half)];
    let colors = normals.map(|n| (0.5 * n + Vec3::splat(0.5)).to_array());
    Shown::render("normal", &["--spp", "4"]).is(|x, y| by_wall(x, y, colors));
}

#[test]
fn objects_have_the_colours_of_their_numbers() {
    let colors = [SceneId(9), SceneId(7)].map(object_color);
    Shown::render("object", &["--spp", "1"]).is(|x, y| by_wall(x, y, colors));
}

#[test]
fn nodes_and_triangles_are_what_the_traversal_counts() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("walls.scn.ron");
    write_scene(&file);
    let mut app = headless_app();
    let source = SceneSource::File(file);
    open(app.world_mut(), &source, OpenOptions::default()).unwrap();
    app.update();
    let camera = &app.world().resource::<TracedCameras>().0[0].camera;
    let settings = RenderSettings {
        size: SIZE.into(),
        spp: 1,
        ..RenderSettings::default()
    };
    let world = &app.world().resource::<Traced>().world;
    let hits = FirstHits::trace(world, camera, &settings);
    let cost = |x: u32, y: u32| hits.centers[(y * SIZE[0] + x) as usize].cost;
    let range = ["--range", "0..16", "--spp", "1"];
    let place = |count: u32| viridis(count as f32 / 16.0);
    Shown::render("nodes", &range).is(|x, y| Some(place(cost(x, y).nodes as u32)));
    Shown::render("triangles", &range).is(|x, y| Some(place(cost(x, y).triangles as u32)));
    // A ray that meets a wall has tested one of its two triangles at least, and no more than all four.
    for y in EMPTY..SIZE[1] {
        for x in 0..SIZE[0] {
            let triangles = cost(x, y).triangles;
            assert!((1..=4).contains(&triangles), "{triangles} at {x}, {y}");
        }
    }
}

#[test]
fn every_pixel_shows_the_samples_that_it_has() {
    let view = Shown::render("samples", &["--range", "0..16", "--spp", "8"]);
    view.is(|_, _| Some(viridis(0.5)));
}

#[test]
fn the_error_is_nothing_but_where_pixels_see_two_walls() {
    let view = Shown::render("error", &["--range", "0..1", "--spp", "16"]);
    // Squares of 4 × 4 pixels are estimated together; one column of them holds the edge.
    view.is(|x, y| {
        let at_edge = x / 4 == EDGE / 4;
        // Where the walls end at the top depends on the last bit.
        let known = y < 4 || (y >= 8 && !at_edge);
        known.then_some(viridis(0.0))
    });
    for y in 8..SIZE[1] {
        let (edge, beside) = (view.pixel(EDGE, y), view.pixel(EDGE - 1, y));
        assert_ne!(edge, beside, "row {y}");
    }
}

#[test]
fn blooms_threshold_passes_the_brighter_wall_and_its_layer_is_that_blurred() {
    let bloom = [
        "output.bloom.enabled=true",
        "output.bloom.threshold=0.6",
        "output.bloom.intensity=0.5",
        "output.bloom.sigma=1",
    ];
    let mut more = vec!["--spp", "4"];
    for setting in bloom {
        more.extend(["--set", setting]);
    }
    let passing = srgb(COLORS[1]);
    Shown::render("bloom-threshold", &more).is(|x, y| by_wall(x, y, [[0.0; 3], passing]));
    let layer = srgb(COLORS[1].map(|c| 0.5 * c));
    Shown::render("bloom-layer", &more).is(|x, y| match x {
        // Six sigma from the edge.
        0..14 => Some([0.0; 3]),
        27..34 if (EMPTY + 6..24).contains(&y) => Some(layer),
        _ => None,
    });
}
