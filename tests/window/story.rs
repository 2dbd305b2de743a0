//! The story of a first session: open, select the light, drag it, see the picture change, undo, add
//! a sphere, make it a mirror, save, quit, reopen.

use super::Display;
use super::pictures::Shot;

/// The middle of the window, where the scene is seen whatever the panels take.
const VIEW: [f32; 4] = [0.32, 0.2, 0.62, 0.85];
/// Left and right in the picture of the box.
const LEFT: [f32; 4] = [0.33, 0.4, 0.38, 0.7];
const RIGHT: [f32; 4] = [0.56, 0.4, 0.61, 0.7];

#[test]
fn a_first_session_from_opening_to_reopening() {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let script = r#"[
        Wait(Samples(1e9)),
        Screenshot("before.png"),

        // The light is selected by clicking on it, and dragged by its arrow.
        Click(On("Lamp")),
        Selected(["Lamp"]),
        Drag(Handle(X), By(Handle(X), 60, 0)),
        AssertNot(of: Some("Lamp"), path: "Transform.translation.x", is: 0, within: 0.02),
        Undoes("Move Lamp"),
        Run("select.none"),
        Wait(Samples(1e9)),
        Screenshot("moved.png"),

        Key("Ctrl+Z"),
        Assert(of: Some("Lamp"), path: "Transform.translation.x", is: 0, within: 1e-6),
        // Undo selects what it changed, and handles and outlines are part of a screenshot.
        Run("select.none"),
        Wait(Samples(1e9)),
        Screenshot("undone.png"),

        Run("add.sphere"),
        Exists("Sphere"),
        Selected(["Sphere"]),
        Set(of: Some("Sphere"), path: "Transform.translation", to: [0, 0.25, 0.1]),
        Set(of: Some("Sphere"), path: "Transform.scale", to: [0.2, 0.2, 0.2]),
        Run("select.none"),
        Wait(Samples(1e9)),
        Screenshot("sphere.png"),

        Select(["Sphere"]),
        Set(of: Some("Sphere"), path: "Phong.diffuse", to: [0, 0, 0, 1]),
        Set(of: Some("Sphere"), path: "Phong.mirror", to: [0.9, 0.9, 0.9, 1]),
        Run("select.none"),
        Wait(Samples(1e9)),
        Screenshot("mirror.png"),

        Action(SaveAs("story.scn.ron")),
        Wait(Seconds(1)),
        Run("file.quit"),
        Wait(Seconds(60)),
    ]"#;
    display.plays(folder.path(), &["cornell-box"], script);
    let reopen = r#"[
        Exists("Sphere"),
        Assert(of: Some("Sphere"), path: "Phong.mirror.red", is: 0.9, within: 1e-6),
        Wait(Samples(1e9)),
        Screenshot("reopened.png"),
        Quit,
    ]"#;
    display.plays(folder.path(), &["story.scn.ron"], reopen);

    let shot = |name: &str| Shot::open(&at(name));
    let [before, moved, undone] = ["before.png", "moved.png", "undone.png"].map(shot);
    let [sphere, mirror, reopened] = ["sphere.png", "mirror.png", "reopened.png"].map(shot);

    assert!(before.colors(VIEW) > 1000, "nothing was drawn");
    let changed = before.difference(&moved, VIEW);
    assert!(changed > 2.0, "the light moved, the picture by {changed}");
    // To the right: what is there is lit more than what is left, compared with before.
    let balance = |shot: &Shot| shot.brightness(RIGHT) / shot.brightness(LEFT);
    let (was, is) = (balance(&before), balance(&moved));
    assert!(is > 1.05 * was, "right against left: {was}, then {is}");
    let back = before.difference(&undone, VIEW);
    // Where lines of a symbol cross, the order in which they are drawn may be another: some 20 pixels.
    assert!(back < 0.05, "undone, and another picture, by {back}");

    let appeared = undone.difference(&sphere, VIEW);
    assert!(
        appeared > 2.0,
        "the sphere appeared, the picture by {appeared}"
    );
    let mirrored = sphere.difference(&mirror, VIEW);
    assert!(mirrored > 0.5, "a mirror, the picture by {mirrored}");
    let again = mirror.difference(&reopened, VIEW);
    assert!(again < 0.05, "reopened, and another picture, by {again}");
}
