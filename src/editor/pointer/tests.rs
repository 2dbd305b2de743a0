use super::*;
use crate::editor::embed::Editing;
use crate::editor::schedule;
use crate::editor::selection::Selection;

#[test]
fn a_drag_ends_where_the_editor_is_switched_off_and_the_pointer_is_where_it_is_then() {
    let mut app = App::new();
    app.add_message::<WindowEvent>()
        .insert_resource(Editing(true))
        .init_resource::<Selection>()
        .init_resource::<Viewport>();
    schedule::add_to(&mut app);
    app.init_resource::<PointerUse>()
        .init_resource::<Pointer>()
        .add_observer(take_over)
        .add_systems(EditorUpdate, use_pointer);
    let mut window = Window::default();
    window.resolution.set(800.0, 600.0);
    let window = app.world_mut().spawn((window, PrimaryWindow)).id();
    app.update();
    let world = app.world_mut();
    let mut pointer = world.resource_mut::<Pointer>();
    pointer.at = Some(Vec2::ZERO);
    pointer.held = Some(MouseButton::Left);
    pointer.inbox.modifiers.ctrl = true;
    world.insert_resource(PointerUse::Click { at: Vec2::ZERO });
    world.insert_resource(Editing(false));
    app.update();
    let world = app.world_mut();
    let used = world.resource::<PointerUse>();
    assert!(matches!(used, PointerUse::Free), "{used:?}");
    let pointer = world.resource::<Pointer>();
    assert_eq!(pointer.held, None);
    assert!(!pointer.inbox.modifiers.ctrl);
    let at = Vec2::new(40.0, 30.0);
    let mut window = world.get_mut::<Window>(window).unwrap();
    window.set_cursor_position(Some(at));
    world.insert_resource(Editing(true));
    app.update();
    assert_eq!(app.world().resource::<Pointer>().at, Some(at));
}

#[test]
fn a_right_press_that_moves_nothing_is_a_click_however_long_a_frame_takes() {
    let mut world = World::new();
    world.init_resource::<Eye>();
    let press = Press::of(&world, Vec2::new(40.0, 30.0));
    std::thread::sleep(DOUBLE + Duration::from_millis(10));
    assert!(press.has_stayed(&world), "nothing happened");
    // A hand that trembles looks around by some pixels.
    world.resource_mut::<Eye>().look(Vec2::new(3.0, -2.0));
    assert!(press.has_stayed(&world), "it trembled");
    let step = 0.01 * Vec3::NEG_Z;
    world.resource_mut::<Eye>().fly(step);
    assert!(!press.has_stayed(&world), "it flew");
    // An editor without a view of its own has none that moves.
    let world = World::new();
    assert!(Press::of(&world, Vec2::ZERO).has_stayed(&world));
}

#[test]
fn one_thing_is_waited_for_at_a_time_and_none_that_another_scene_was_asked_about() {
    let mut app = App::new();
    app.init_resource::<Armed>()
        .init_resource::<RegionDrag>()
        .add_observer(disarm);
    let world = app.world_mut();
    let region = |world: &mut World| {
        world.resource_mut::<RegionDrag>().is_armed = true;
    };
    region(world);
    arm(world, Armed::Aim);
    assert!(!world.resource::<RegionDrag>().is_armed);
    assert_eq!(*world.resource::<Armed>(), Armed::Aim);
    region(world);
    world.trigger(SceneOpened);
    world.flush();
    assert!(!world.resource::<RegionDrag>().is_armed);
    assert_eq!(*world.resource::<Armed>(), Armed::No);
}
