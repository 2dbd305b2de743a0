//! Two trees side by side: two views of one scene that are one in everything but the boxes over them.

use super::Display;
use super::pictures::Shot;

/// The left view between its heading and its counts, in parts of a window of 1280 by 720 with its panels.
const LEFT: [f32; 4] = [0.19, 0.25, 0.45, 0.75];

/// From a pixel of the left view to that of the right one, with the panels' first widths.
const TO_THE_RIGHT: u32 = 381;

#[test]
fn two_views_of_one_scene_turn_together_and_a_click_in_either_means_what_is_seen_there() {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let script = r#"[
        Wait(Frames(5)),
        Run("help.first-steps"),
        Run("lines.pair"),
        // Levels that no tree has: nothing is drawn over the pictures.
        Set(path: "InspectSettings.boxes.to_level", to: 60),
        Set(path: "InspectSettings.boxes.from_level", to: 60),
        Wait(Frames(5)),
        Wait(Samples(16)),
        Move(Window(20, 5)),
        Wait(Seconds(1)),
        Screenshot("same.png"),

        Click(By(On("Short block"), 381, 0)),
        Selected(["Short block"]),
        Run("select.none"),
        DragWith(Middle, View(1.4, 0.5), View(1.6, 0.5)),
        AssertNot(path: "Eye.yaw", is: 0, within: 0.05),
        Move(Window(20, 5)),
        Wait(Samples(16)),
        Wait(Seconds(1)),
        Screenshot("turned.png"),

        Set(path: "InspectSettings.boxes.from_level", to: 0),
        Wait(Seconds(1)),
        Screenshot("boxes.png"),
        Run("lines.pair"),
        Wait(Frames(5)),
        Wait(Samples(16)),
        Screenshot("one.png"),
        Quit,
    ]"#;
    display.plays(folder.path(), &["cornell-box"], script);
    let shot = |name: &str| Shot::open(&folder.path().join(name));
    let [same, turned, boxes, one] = ["same.png", "turned.png", "boxes.png", "one.png"].map(shot);
    for (name, shot) in [("same", &same), ("turned", &turned)] {
        assert!(shot.colors(LEFT) > 500, "{name}: nothing is seen");
        let off = shot.difference_to_the_right(TO_THE_RIGHT, LEFT);
        assert!(off < 0.05, "{name}: the views differ by {off}");
    }
    let moved = same.difference(&turned, LEFT);
    assert!(moved > 2.0, "the view was turned, the picture by {moved}");
    let off = boxes.difference_to_the_right(TO_THE_RIGHT, LEFT);
    assert!(off > 0.3, "two builders' boxes differ by {off}");
    let off = one.difference_to_the_right(TO_THE_RIGHT, LEFT);
    assert!(
        off > 2.0,
        "there is one view again, and its halves differ by {off}"
    );
}
