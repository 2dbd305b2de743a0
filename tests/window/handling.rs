//! Moving the view, and taking hold of things in it.

use super::Display;

fn plays(scene: &str, script: &str) {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    display.plays(folder.path(), &[scene], script);
}

#[test]
fn the_view_is_turned_moved_and_looked_through_cameras_with() {
    let script = r#"[
        Wait(Frames(10)),
        Assert(path: "Eye.yaw", is: 0, within: 1e-4),

        // Turning leaves the camera, which stays where it was.
        DragWith(Middle, View(0.5, 0.5), View(0.6, 0.45)),
        AssertNot(path: "Eye.yaw", is: 0, within: 0.05),
        Assert(of: Some("Camera"), path: "Transform.rotation", is: [0, 0, 0, 1], within: 1e-5),

        // Along an axis, without perspective; a key toggles that.
        Key("Numpad7"),
        Assert(path: "Eye.orthographic", is: true),
        Assert(path: "Eye.pitch", is: -1.5708, within: 1e-3),
        Key("5"),
        Assert(path: "Eye.orthographic", is: false),

        // Through the camera again.
        Key("0"),
        Assert(path: "Eye.yaw", is: 0, within: 1e-4),
        Assert(path: "Eye.pitch", is: 0, within: 1e-4),

        // Locked, the camera comes along, and that is one step.
        Key("Ctrl+Shift+L"),
        DragWith(Middle, View(0.5, 0.5), View(0.6, 0.5)),
        AssertNot(of: Some("Camera"), path: "Transform.rotation", is: [0, 0, 0, 1], within: 0.01),
        Undoes("Move Camera"),
        Key("Ctrl+Z"),
        Assert(of: Some("Camera"), path: "Transform.rotation", is: [0, 0, 0, 1], within: 1e-5),
        Key("Ctrl+Shift+L"),

        // The wheel goes nearer.
        Action(LookThrough(None)),
        Move(View(0.5, 0.5)),
        Wheel(3),
        Run("view.keep"),
        Exists("Camera 2"),
        Selected(["Camera 2"]),
        AssertNot(of: Some("Camera 2"), path: "Transform.translation.z", is: 1.0796, within: 0.05),
        Quit,
    ]"#;
    plays("cornell-box", script);
}

#[test]
fn corners_of_a_light_are_dragged_one_by_one() {
    let script = r#"[
        Wait(Frames(10)),
        Click(On("Ceiling light")),
        Selected(["Ceiling light"]),
        Drag(Grip("Ceiling light", 0), By(Grip("Ceiling light", 0), -30, 0)),
        Undoes("Move a corner of Ceiling light"),
        AssertNot(of: Some("Ceiling light"), path: "ParallelogramLamp.corner.x", is: -0.065, within: 0.01),
        Assert(of: Some("Ceiling light"), path: "Transform.translation", is: [0, 0, 0]),
        Key("Ctrl+Z"),
        Assert(of: Some("Ceiling light"), path: "ParallelogramLamp.corner.x", is: -0.065, within: 1e-5),

        // Escape takes a drag back before it ends.
        Move(Grip("Ceiling light", 3)),
        Press(Left),
        Move(By(Grip("Ceiling light", 3), 40, 0)),
        AssertNot(of: Some("Ceiling light"), path: "ParallelogramLamp.edges[1].x", is: 0.13, within: 0.005),
        Key("Escape"),
        Release(Left),
        Assert(of: Some("Ceiling light"), path: "ParallelogramLamp.edges[1].x", is: 0.13, within: 1e-5),
        Quit,
    ]"#;
    plays("cornell-box-parallelogram-light", script);
}

#[test]
fn things_are_selected_by_clicks_and_boxes_and_moved_together() {
    let script = r#"[
        Wait(Frames(10)),
        Click(On("Short block")),
        Selected(["Short block"]),
        Hold("Ctrl"),
        Click(On("Mirror block")),
        LetGo("Ctrl"),
        Selected(["Short block", "Mirror block"]),

        // Both at once, one step.
        Drag(Handle(Y), By(Handle(Y), 0, -40)),
        Undoes("Move 2 objects"),
        AssertNot(of: Some("Short block"), path: "Transform.translation.y", is: 0, within: 0.01),
        AssertNot(of: Some("Mirror block"), path: "Transform.translation.y", is: 0, within: 0.01),
        Assert(of: Some("Mirror block"), path: "Transform.translation.x", is: 0, within: 1e-5),
        Key("Ctrl+Z"),
        Assert(of: Some("Short block"), path: "Transform.translation.y", is: 0),
        Assert(of: Some("Mirror block"), path: "Transform.translation.y", is: 0),

        // Turning and scaling.
        Click(On("Short block")),
        Key("E"),
        Drag(Handle(Y), By(Handle(Y), 30, 0)),
        Undoes("Turn Short block"),
        Key("T"),
        Drag(Handle(Y), By(Handle(Y), 0, -30)),
        Undoes("Scale Short block"),
        AssertNot(of: Some("Short block"), path: "Transform.scale.y", is: 1, within: 0.05),
        Assert(of: Some("Short block"), path: "Transform.scale.x", is: 1, within: 1e-5),

        Key("Escape"),
        Selected([]),
        Quit,
    ]"#;
    plays("cornell-box", script);
}

#[test]
fn a_press_takes_the_handle_under_it_even_where_the_pointer_came_there_in_the_same_frame() {
    let script = r#"[
        Wait(Frames(10)),
        Click(On("Short block")),
        // The pointer rests over one handle, jumps to another and presses before a frame is drawn.
        Move(Handle(X)),
        PressAt(Left, Handle(Y)),
        Move(By(Handle(Y), 0, -40)),
        Release(Left),
        Undoes("Move Short block"),
        Assert(of: Some("Short block"), path: "Transform.translation.x", is: 0, within: 1e-5),
        AssertNot(of: Some("Short block"), path: "Transform.translation.y", is: 0, within: 0.01),
        Key("Ctrl+Z"),

        // It rests beside all of them.
        Move(View(0.9, 0.1)),
        PressAt(Left, Handle(X)),
        Move(By(Handle(X), 40, 0)),
        Release(Left),
        Undoes("Move Short block"),
        AssertNot(of: Some("Short block"), path: "Transform.translation.x", is: 0, within: 0.01),
        Key("Ctrl+Z"),

        // It rests over a handle, and is gone when the button goes down.
        Move(Handle(X)),
        PressAt(Left, On("Green wall")),
        Release(Left),
        Selected(["Green wall"]),
        Assert(of: Some("Short block"), path: "Transform.translation", is: [0, 0, 0]),
        Quit,
    ]"#;
    plays("cornell-box", script);
}

#[test]
fn a_number_that_is_typed_while_a_handle_is_dragged_says_how_far_it_goes() {
    let script = r#"[
        Wait(Frames(10)),
        Click(On("Short block")),
        PressAt(Left, Handle(Y)),
        Move(By(Handle(Y), 0, -15)),
        Type("10cm"),
        Shows("Move along y: 10cm"),
        Assert(of: Some("Short block"), path: "Transform.translation.y", is: 0.1, within: 1e-6),
        // The pointer says no more now.
        Move(By(Handle(Y), 0, -30)),
        Release(Left),
        Assert(of: Some("Short block"), path: "Transform.translation", is: [0, 0.1, 0], within: 1e-6),
        Undoes("Move Short block"),
        Key("Ctrl+Z"),
        Key("E"),
        PressAt(Left, Handle(Y)),
        Move(By(Handle(Y), 10, 0)),
        Type("90"),
        Key("Enter"),
        Release(Left),
        Assert(of: Some("Short block"), path: "Transform.rotation", is: [0, 0.70710677, 0, 0.70710677], within: 1e-5),
        Undoes("Turn Short block"),
        Quit,
    ]"#;
    plays("cornell-box", script);
}

#[test]
fn keys_that_are_typed_into_a_field_are_not_meant_for_the_scene() {
    let script = r#"[
        Wait(Frames(10)),
        Select(["Short block"]),
        Click(Text("Search")),
        Type("xh"),
        Exists("Short block"),
        Assert(of: Some("Short block"), path: "Visibility", is: "Inherited"),
        Key("Delete"),
        Exists("Short block"),
        Quit,
    ]"#;
    plays("cornell-box", script);
}

#[test]
fn the_window_takes_other_sizes_and_says_nothing_of_the_machine() {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let script = r#"[
        Wait(Frames(5)),
        Size(900, 500),
        Wait(Frames(5)),
        Size(1280, 720),
        Wait(Frames(5)),
        Size(700, 420),
        Wait(Frames(5)),
        Click(On("Red wall")),
        Selected(["Red wall"]),
        Quit,
    ]"#;
    let output = display.play(folder.path(), &["cornell-box"], script);
    let (_, err) = crate::cli::texts(&output);
    assert_eq!(output.status.code(), Some(0), "{err}");
    assert!(!err.contains("INFO") && !err.contains("WARN"), "{err}");
}

#[test]
fn ctrl_and_the_wheel_change_the_field_of_view() {
    let script = r#"[
        Wait(Frames(10)),
        // Of the camera that is looked through: a step.
        Move(View(0.5, 0.5)),
        Hold("Ctrl"),
        Wheel(-2),
        LetGo("Ctrl"),
        Undoes("Change the field of view"),
        Key("Ctrl+Z"),
        // Of the view itself: none.
        Action(LookThrough(None)),
        Hold("Ctrl"),
        Wheel(4),
        LetGo("Ctrl"),
        AssertNot(path: "Eye.fov_y", is: 0.6867, within: 0.05),
        Quit,
    ]"#;
    plays("cornell-box", script);
}
