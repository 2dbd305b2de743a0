//! The debug ray, from the key to its lines in the view and its rows in the inspector.
//!
//! In the scene `triangle` the camera stands at (0, 0, 3.2), looks along -Z and sees 45° upright. The
//! middle of the picture is the triangle's point (0, 0, 0), and the lamp at (-0.6, 0.7, 1.3) is 1.9 m
//! before the camera: half the picture's height there is 1.9 · tan 22.5° = 0.787 m, so the lamp is seen
//! 0.6 / 0.787 = 0.762 half heights left of the middle and 0.7 / 0.787 = 0.889 above it. The shadow
//! ray from the middle to the lamp is the straight line between the two.

use super::Display;
use super::pictures::Shot;

/// Where the lamp is seen from the picture's middle, to the right and down, in half heights.
const LAMP: [f32; 2] = [-0.7624, -0.8894];
/// What the panels are filled with.
const PANEL: [u8; 3] = [29, 31, 35];
/// Neither list nor properties: the picture is as wide as the window.
const PREFERENCES: &str = "(show_hierarchy: false, show_inspector: false, hint_seen: true)";

/// The middle of the picture and half its height, in pixels of the window.
struct Picture {
    middle: [f32; 2],
    half: f32,
}

impl Picture {
    /// By where the panels begin above and below the background at the window's left side.
    fn find(shot: &Shot) -> Self {
        let [width, height] = shot.size();
        let is_panel = |y: u32| {
            let pixel = shot.pixel(12, y);
            (pixel.iter().zip(PANEL)).all(|(a, b)| a.abs_diff(b) <= 2)
        };
        let start = height / 3;
        assert!(!is_panel(start), "a panel at row {start}");
        let top = (0..start).rev().find(|&y| is_panel(y)).unwrap() + 1;
        let bottom = (start..height).find(|&y| is_panel(y)).unwrap();
        let half = (bottom - top) as f32 / 2.0;
        Self {
            middle: [width as f32 / 2.0, top as f32 + half],
            half,
        }
    }

    /// A place of the shadow ray: 0 at the surface, 1 at the lamp.
    fn on_ray(&self, part: f32) -> [f32; 2] {
        [0, 1].map(|axis| self.middle[axis] + part * LAMP[axis] * self.half)
    }
}

/// The pixels around a place, no further than `reach` away.
fn around(shot: &Shot, [x, y]: [f32; 2], reach: i32) -> Vec<[u8; 3]> {
    let at = |dx: i32, dy: i32| shot.pixel((x as i32 + dx) as u32, (y as i32 + dy) as u32);
    let range = -reach..=reach;
    let offsets = range
        .clone()
        .flat_map(|dy| range.clone().map(move |dx| (dx, dy)));
    offsets.map(|(dx, dy)| at(dx, dy)).collect()
}

/// White light that arrives is drawn white: all three channels are bright.
fn is_white(shot: &Shot, at: [f32; 2]) -> bool {
    let pixels = around(shot, at, 3);
    pixels.iter().any(|pixel| pixel.iter().all(|&c| c > 200))
}

/// What is chosen is drawn in a colour that nothing else has.
fn is_chosen(shot: &Shot, at: [f32; 2]) -> bool {
    let pixels = around(shot, at, 3);
    pixels
        .iter()
        .any(|&[r, g, b]| r > 200 && g < 100 && b > 150)
}

#[test]
fn a_debug_ray_is_drawn_where_it_is_and_chosen_in_the_list_and_in_the_view() {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let settings = folder.path().join("settings");
    std::fs::create_dir_all(&settings).unwrap();
    std::fs::write(settings.join("preferences.ron"), PREFERENCES).unwrap();
    let script = r#"[
        Wait(Frames(10)),
        Key("Shift+R"),
        Wait(Samples(16)),
        Move(View(0.9, 0.5)),
        Screenshot("before.png"),

        Move(View(0.5, 0.5)),
        Key("R"),
        Shows("camera 0"),
        Shows("shadow 1"),
        Move(View(0.9, 0.5)),
        Screenshot("shot.png"),

        Click(Text("shadow 1")),
        Shows("shadow ray 1"),
        Move(View(0.9, 0.5)),
        Screenshot("chosen.png"),

        // The same pixel by a click with Alt, with all its samples.
        Click(Text("all 16")),
        Hold("Alt"),
        Click(View(0.5, 0.5)),
        LetGo("Alt"),
        Wait(Seconds(1)),
        Shows("camera 0"),

        // Beside the picture it takes the rays away.
        Move(Text("View")),
        Key("R"),
        Move(View(0.9, 0.5)),
        Screenshot("away.png"),
        Quit,
    ]"#;
    display.plays(folder.path(), &["triangle"], script);
    let shot = |name: &str| Shot::open(&folder.path().join(name));
    let [before, rays, chosen, away] =
        ["before.png", "shot.png", "chosen.png", "away.png"].map(shot);
    let picture = Picture::find(&before);
    for part in [0.15, 0.3, 0.45, 0.6, 0.75] {
        let at = picture.on_ray(part);
        assert!(!is_white(&before, at), "at {part} there was white before");
        assert!(is_white(&rays, at), "at {part}, {at:?}, there is no ray");
        assert!(
            is_chosen(&chosen, at),
            "at {part}, {at:?}, it is not lit up"
        );
        assert!(!is_chosen(&rays, at) && !is_white(&away, at));
        // Beside it nothing changed.
        let beside = [at[0] + 20.0, at[1]];
        let (was, is) = (around(&before, beside, 3), around(&rays, beside, 3));
        assert_eq!(was, is, "beside the ray at {part}");
    }

    // A click on its line chooses it.
    let [x, y] = picture.on_ray(0.5);
    let script = format!(
        r#"[
        Wait(Frames(10)),
        Wait(Samples(16)),
        Move(View(0.5, 0.5)),
        Key("R"),
        Click(Window({x}, {y})),
        Shows("shadow ray 1"),
        Click(Text("Steps")),
        Key("."),
        Shows("triangle 0 of Triangle: no hit"),
        Quit,
    ]"#
    );
    // The inspector is open, as it was left.
    display.plays(folder.path(), &["triangle"], &script);
}
