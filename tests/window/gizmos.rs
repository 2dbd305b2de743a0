//! Every system's gizmo is seen in the window: lines of the expected colour where arithmetic puts
//! them, which are not there while the gizmo is off.
//!
//! The scripts and their scenes lie in `tests/window/gizmos`. They look along an axis through a
//! field of view whose half has the tangent 0.5: at 640 x 480 pixels a metre in the distance d is
//! 480 / d pixels, so 100 pixels in the distance 4.8 of most views. `GLASSBOX_KEEP_PICTURES=FOLDER`
//! keeps the pictures.

use super::Display;
use super::marks::{Line, Pictures, apart, is_mixed, pixels};
use super::pictures::Shot;
use std::path::{Path, PathBuf};

const WHITE: [u8; 3] = [255, 255, 255];
/// (1, 0.02, 0.02) in linear RGB.
const RED: [u8; 3] = [255, 39, 39];
/// (0.05, 0.8, 0.9).
const CYAN: [u8; 3] = [63, 231, 243];
/// (1, 0.4, 0.02).
const ORANGE: [u8; 3] = [255, 170, 39];
/// (0.45, 0.12, 0.02): on the way to a light, up to what is in it.
const BLOCKED: [u8; 3] = [179, 97, 39];
/// (0.03, 0.03, 0.04): beyond.
const DARK: [u8; 3] = [48, 48, 56];
/// Where viridis ends.
const DEEPEST: [u8; 3] = [253, 231, 37];

/// Plays one of the scripts and returns the folder of its pictures.
fn played(scene: &str, script: &str) -> Option<Pictures> {
    let display = Display::open()?;
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/window/gizmos");
    let kept = std::env::var_os("GLASSBOX_KEEP_PICTURES").map(PathBuf::from);
    let folder = tempfile::tempdir().unwrap();
    let scene = from.join(scene);
    let script = std::fs::read_to_string(from.join(script)).unwrap();
    display.plays(folder.path(), &[scene.to_str().unwrap()], &script);
    if let Some(kept) = kept {
        std::fs::create_dir_all(&kept).unwrap();
        for name in crate::cli::files(folder.path()) {
            if name.ends_with(".png") {
                std::fs::copy(folder.path().join(&name), kept.join(&name)).unwrap();
            }
        }
    }
    Some(Pictures(folder))
}

#[test]
fn the_rays_of_a_picked_pixel_show_what_each_system_did() {
    let Some(pictures) = played("bench.scn.ron", "rays.ron") else {
        return;
    };
    // From (0, 1.3, 4.8) along -Z: in the plane z = 0 a metre is 100 pixels, and (0, 0) is at
    // (320, 240 + 130).
    let at = |x: f32, y: f32| [320.0 + 100.0 * x, 370.0 - 100.0 * y];
    let (camera, floor) = (at(-2.5, 1.0), at(1.5, 0.0));
    // The floor, which has the ray's own colour, begins 339 pixels from the top; the lamp's symbol, as
    // white as what it sends, ends at 221.
    let (above_floor, below_lamp) = (at(0.2, 0.325), at(1.5, 1.4));

    // S1. The lamp stands 2 m above the floor: 3.6 π W/sr / 4 m² · kd / π = 0.9 kd, which is
    // (0.72, 0.36, 0.18); on the screen (221, 162, 118).
    pictures
        .pair("s01", "s01-off")
        .shows(&[Line(camera, above_floor, [221, 162, 118])])
        // Shadow rays are switched off.
        .leaves(&[[430.0, 190.0, 500.0, 330.0]]);

    // S2. The plate (ks 0.9) sees the wall (ks 1, 0.5, 0.25), the wall the background (0.4, 0.7, 1):
    // the last ray carries that, the one before it (0.4, 0.35, 0.25), the first (0.36, 0.315, 0.225).
    // With the slope 0.4 the way goes from (-2.5, 1) to (0, 0), (2, 0.8) and, after 3.8 m more, (-1.8, 2.32).
    let (plate, wall, away) = (at(0.0, 0.0), at(2.0, 0.8), at(-1.8, 2.32));
    let first = [
        Line(camera, plate, [162, 152, 130]),
        Line(plate, wall, [170, 160, 137]),
    ];
    pictures
        .pair("s02", "s02-off")
        .shows(&first)
        .shows(&[Line(wall, away, [170, 218, 255])]);
    pictures
        .pair("s02-red", "s02-off")
        .shows(&first)
        .shows(&[Line(wall, away, RED)]);

    // S3. Nothing is in the lamp's way. Towards (-1, 2.4) the slope is -0.96: at x = 0.4 the block
    // begins, at a height of 1.056 (it reaches from 0.85 to 1.15); seen again from (0.1, 1.344) on.
    pictures.pair("s03", "s03-off").shows(&[
        Line(floor, below_lamp, WHITE),
        Line(floor, at(0.4, 1.056), BLOCKED),
        Line(at(0.1, 1.344), at(-0.9, 2.304), DARK),
    ]);

    // S4. The tube is (0.5 .. 2, 2.4), red to blue: at a tenth, the middle and nine tenths of it
    // (0.9, 0, 0.1), (0.5, 0, 0.5), (0.1, 0, 0.9). Its 8 samples' rays pass the height 1.2 between
    // x = 1 and 1.75, each in an eighth of that.
    let tube = |t: f32| at(0.5 + 1.5 * t, 2.4);
    // The panel's front edge is 4.4 m away: 480 / 4.4 = 109.1 pixels a metre, its height 0.9 m above
    // the view's axis: y = 240 - 98.2, x from 320 - 1.5 · 109.1 on. Magenta to cyan; the
    // legend lies over all but its end, (0.03, 0.97, 1).
    let front = |t: f32| [320.0 - 109.1 * (1.5 - t), 141.8];
    // Its back edge is 5.2 m away, 92.3 pixels a metre: yellow to green.
    let back = |t: f32| [320.0 - 92.3 * (1.5 - t), 156.9];
    // The lights' own lines are always there, as the editor's handles: before the lights are, nothing is.
    pictures.pair("s04", "s03-off").shows(&[
        Line(tube(0.1), tube(0.1), [243, 0, 89]),
        Line(tube(0.5), tube(0.5), [188, 0, 188]),
        Line(tube(0.9), tube(0.9), [89, 0, 243]),
        Line(front(0.97), front(0.97), [48, 252, 255]),
        Line(back(0.1), back(0.1), [243, 255, 0]),
        Line(back(0.9), back(0.9), [89, 255, 0]),
    ]);
    pictures
        .pair("s04", "s04-off")
        .is_crossed([419.0, 250.0, 497.0, 251.0], 6)
        .leaves(&[[380.0, 245.0, 416.0, 255.0], [499.0, 245.0, 540.0, 255.0]]);

    // S8. Two texels, at the heights 1 + 3.5 · 0.1 and 1 - 3.5 · 0.1 of the poster at x = 1.
    pictures
        .pair("s08", "s08-off")
        .shows(&[Line(camera, at(1.0, 1.35), [230, 120, 30])]);
    pictures.pair("s08-lower", "s08-lower-off").shows(&[Line(
        camera,
        at(1.0, 0.65),
        [60, 190, 90],
    )]);

    // S9. With the slope 0.3 the ray leaves over the wall, at (2, 2.35), into the stripe of the map
    // that lies towards +X.
    pictures
        .pair("s09", "s09-off")
        .shows(&[Line(camera, at(2.8, 2.59), [230, 60, 160])]);

    // S13. From a distance of 0.2 m a metre is 2400 pixels; the middle of the view is (1.45, 0.03).
    // The pixel's slopes are 0.25 to 0.25 + 1/480, its rays arrive from 1.4669 to 1.5; at x = 1.36,
    // 216 pixels left of the middle, they are 0.107 · 0.252 to 0.14 · 0.25 high: 0.027 to 0.035, seen
    // from 228 to 247. The frame of the pattern is 163 pixels wide, 12 from the right and 44 from the top.
    let pattern = pictures.pair("s13", "s13-off");
    pattern
        .is_crossed([104.0, 220.0, 105.0, 256.0], 4)
        .leaves(&[[60.0, 262.0, 220.0, 300.0], [60.0, 170.0, 150.0, 205.0]]);
    // One sample in each of the 4 x 4 cells.
    for cell in 0..16 {
        let (column, row) = ((cell % 4) as f32, (cell / 4) as f32);
        let [left, top] = [465.0 + 40.75 * column, 44.0 + 40.75 * row];
        let inside = [left - 1.0, top - 1.0, left + 42.0, top + 42.0];
        let is_point =
            |&(x, y): &(u32, u32)| is_mixed(pattern.on.pixel(x, y), [30; 3], [255, 243, 124]);
        assert!(
            pixels(inside).any(|at| is_point(&at)),
            "no sample in the cell {column}, {row}"
        );
    }

    // S14. The mirror direction is (1, 0.4) / 1.077; the disc stands 0.15 times the distance from the
    // viewer, 0.15 · √(1.3² + 4.8²) = 0.746 m, along it: at (0.6925, 0.277). Its radius is a fourth:
    // its ends lie 0.1865 m across, at (0.623, 0.450) and (0.762, 0.104). The rays leave within
    // atan(1/4) = 14° of 21.8°, and pass x = 1.5 at heights of 0.20 to 1.09.
    let (top, bottom) = (at(0.623, 0.450), at(0.762, 0.104));
    pictures
        .pair("s14", "s14-off")
        .shows(&[
            // Nearer to the plate the rays lie over it.
            Line(at(0.277, 0.111), at(0.6925, 0.277), CYAN),
            Line(top, top, CYAN),
            Line(bottom, bottom, CYAN),
        ])
        .is_crossed([470.0, 250.0, 471.0, 362.0], 6)
        .leaves(&[[440.0, 180.0, 472.0, 246.0]]);

    // S15. At (-1, 0.625) the ray goes through a pane with d = 0.2, unlit from its side. The filter
    // over the floor (d = 0.5, kd 0.1, 0.2, 1) lets 0.5 · (0.55, 0.6, 1) = (0.275, 0.3, 0.5) through: the
    // floor is (0.198, 0.108, 0.09), and before the pane 0.8 of that arrives, (0.158, 0.086, 0.072).
    let (pane, filter) = (at(-1.0, 0.625), at(1.5, 1.0));
    pictures.pair("s15", "s15-off").shows(&[
        Line(camera, pane, [111, 83, 76]),
        Line(pane, above_floor, [123, 92, 85]),
        Line(floor, filter, [143, 149, 188]),
        Line(filter, below_lamp, WHITE),
    ]);

    // S16. Seen from x = -0.8. The aperture has a radius of 0.3; all rays meet 2.5 m before it, at
    // (0, 0.375), and half way there are 0.15 m around 0.6875. The focus plane is 2 · 2.5 · 0.5 high and 4/3
    // as wide; its near edge, 1.667 m this side of z = 0, is 153.2 pixels a metre: x = 320 + 0.8 · 153.2.
    let at = |x: f32, y: f32| [400.0 + 100.0 * x, 370.0 - 100.0 * y];
    let [x, y] = at(0.0, 0.375);
    pictures
        .pair("s16", "s16-off")
        .shows(&[
            Line([442.6, 110.0], [442.6, 400.0], CYAN),
            Line(at(-2.5, 1.3), at(-2.5, 1.3), CYAN),
            Line(at(-2.5, 0.7), at(-2.5, 0.7), CYAN),
        ])
        .is_crossed([275.0, 280.0, 276.0, 322.0], 4)
        // Where they meet they are no wider than one line.
        .leaves(&[
            [x - 3.0, y - 30.0, x, y - 5.0],
            [x - 3.0, y + 5.0, x, y + 20.0],
        ]);
}

#[test]
fn trees_normals_and_motion_are_drawn_where_they_are() {
    let Some(pictures) = played("balls.scn.ron", "trees.ron") else {
        return;
    };
    // S6 and S7 are seen from (-0.4, 0.5, 4.8) along -Z. The near faces of the boxes, at z = 0.4, are
    // 4.4 m away: 109.1 pixels a metre. The boxes' heights are 0.5 ± 0.4, so y = 240 ± 43.6.
    let near = |x: f32| 320.0 + 109.1 * (x + 0.4);
    let upright = |x: f32, color| Line([near(x), 202.0], [near(x), 278.0], color);
    // S6. Entered: the first ball's node, whose right end is -1.1. Pruned: the second ball's, from -0.9
    // on, and the node of the other two, from 0.1 on.
    pictures.pair("s06", "s06-off").shows(&[
        upright(-1.1, WHITE),
        upright(-0.9, RED),
        upright(0.1, RED),
    ]);

    // S7. At z = 0 a metre is 100 pixels; normals are 30 pixels long. The poles are at the height 0.9,
    // the last ball ends at 1.9. The ray, with the slope 0.05 from (-3.2, 0.5), meets the first ball at
    // (-1.895, 0.565), where the normal is (-0.987, 0.163); it is drawn 0.05 · 5.03 m long, to (-2.143, 0.606).
    let at = |x: f32, y: f32| [360.0 + 100.0 * x, 290.0 - 100.0 * y];
    let pole = |x: f32| Line(at(x, 0.92), at(x, 1.18), [94, 201, 98]);
    pictures.pair("s07", "s07-off").shows(&[
        pole(-1.5),
        pole(-0.5),
        pole(0.5),
        pole(1.5),
        Line(at(1.92, 0.5), at(2.18, 0.5), [94, 201, 98]),
        Line(at(-2.0, 0.583), at(-2.14, 0.606), [63, 243, 108]),
    ]);

    // S5 and S10: turned by 30 degrees, from 20 degrees above, without perspective. To the right of the
    // picture goes (cos 30°, 0, -sin 30°), 150 pixels a metre, upwards (-sin 30° sin 20°, cos 20°, -cos 30° sin 20°).
    let turned = |[x, y, z]: [f32; 3]| {
        [
            320.0 + 150.0 * (0.866 * x - 0.5 * z),
            240.0 - 150.0 * (-0.171 * x + 0.9397 * (y - 0.5) - 0.2962 * z),
        ]
    };
    let edge = |from, to, color| Line(turned(from), turned(to), color);
    // Level 1: two boxes, each over two balls.
    let one = pictures.pair("s05-one", "s05-off");
    one.shows(&[
        edge([-1.9, 0.9, 0.4], [-0.1, 0.9, 0.4], DEEPEST),
        edge([-0.1, 0.9, 0.4], [-0.1, 0.1, 0.4], DEEPEST),
        edge([0.1, 0.9, 0.4], [1.9, 0.9, 0.4], DEEPEST),
        edge([1.9, 0.9, 0.4], [1.9, 0.9, -0.4], DEEPEST),
    ]);
    // Nothing between two balls of a box: that is the next level.
    let [x, y] = turned([-1.0, 0.5, 0.4]);
    one.leaves(&[[x - 8.0, y - 30.0, x + 8.0, y + 2.0]]);
    pictures.pair("s05", "s05-off").shows(&[
        edge([-1.1, 0.9, 0.4], [-1.1, 0.1, 0.4], DEEPEST),
        edge([0.9, 0.9, 0.4], [0.9, 0.1, 0.4], DEEPEST),
    ]);
    // The first leaf belongs to the first ball.
    let leaf = pictures.pair("s05-leaf", "s05-off");
    let [left, _] = turned([-1.9, 0.5, 0.4]);
    let [right, _] = turned([-1.1, 0.5, -0.4]);
    let drawn = pixels([left, 120.0, right, 400.0]).filter(|&(x, y)| leaf.has_changed(x, y));
    assert!(drawn.count() > 60, "the leaf is not seen");
    leaf.leaves(&[[right + 4.0, 140.0, 630.0, 470.0]]);

    // S10. Between the middles: x = 0 for the root, -1 and 1 below it. Red is across x.
    let across = [255, 89, 89];
    let plane = |x: f32| {
        [
            edge([x, 0.88, 0.4], [x, 0.12, 0.4], across),
            edge([x, 0.9, 0.38], [x, 0.9, -0.38], across),
        ]
    };
    let planes = pictures.pair("s10", "s05-off");
    for x in [-1.0, 0.0, 1.0] {
        planes.shows(&plane(x));
    }

    // S11. Seen from (0.4, 0.9, 4.8): the middle of the ball goes from (1.5, 0.5) to (1.5, 1.7), of which the
    // ball where it starts hides the part below 0.9. Its box at the end: 480 / 4.4 pixels a metre.
    let at = |x: f32, y: f32| [280.0 + 100.0 * x, 330.0 - 100.0 * y];
    let near = |x: f32, y: f32| [320.0 + 109.1 * (x - 0.4), 240.0 - 109.1 * (y - 0.9)];
    pictures.pair("s11", "s11-off").shows(&[
        Line(at(1.5, 1.0), at(1.5, 1.7), ORANGE),
        Line(near(1.1, 2.1), near(1.9, 2.1), ORANGE),
        Line(near(1.1, 2.1), near(1.1, 1.3), ORANGE),
    ]);
}

#[test]
fn what_passes_blooms_threshold_and_what_bloom_adds_can_be_looked_at() {
    let Some(pictures) = played("glow.scn.ron", "bloom.ron") else {
        return;
    };
    // The squares reach from -1.3 to -0.3 and from 0.3 to 1.3: their middles are at 240 and 400.
    let (bright, dim, edge) = ((240, 240), (400, 240), (190, 240));
    let near = |shot: &Shot, (x, y), wanted: [u8; 3]| {
        let found = shot.pixel(x, y);
        assert!(
            apart(found, wanted) <= 6.0,
            "({x}, {y}) is {found:?}, not {wanted:?}"
        );
    };
    // (0.2, 0.4, 0.6) is below the threshold of 0.8, (1.6, 0.8, 0.2) above it.
    near(&pictures.open("s12-off"), dim, [124, 170, 203]);
    let passes = pictures.open("s12-bright");
    near(&passes, bright, [255, 231, 124]);
    near(&passes, dim, [0, 0, 0]);
    // Half of it comes back, all around: in the middle of the square 0.5 · (1.6, 0.8, 0.2), and a
    // straight edge sees half of that. Two sigma outside, 24 pixels, 0.0228 of it.
    let added = pictures.open("s12");
    near(&added, bright, [231, 170, 89]);
    near(&added, edge, [171, 125, 64]);
    near(&added, (165, 240), [36, 24, 9]);
    near(&added, dim, [0, 0, 0]);
}
