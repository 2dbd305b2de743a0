use super::*;

#[test]
fn a_place_is_as_far_from_a_line_as_from_its_nearest_point() {
    let line = [Vec2::new(1.0, 1.0), Vec2::new(5.0, 1.0)];
    for (place, distance) in [
        (Vec2::new(3.0, 4.0), 3.0),
        (Vec2::new(-2.0, 5.0), 5.0),
        (Vec2::new(8.0, -3.0), 5.0),
    ] {
        assert_eq!(distance_to_segment(place, line), distance);
    }
    let point = [Vec2::ONE; 2];
    assert_eq!(distance_to_segment(Vec2::new(1.0, 3.0), point), 2.0);
}

/// What draws symbols, alone.
fn drawing() -> App {
    let mut app = App::new();
    app.init_resource::<Traced>()
        .init_resource::<Symbols>()
        .init_resource::<Outlined>()
        .init_resource::<SymbolsOf>()
        .add_systems(PostUpdate, draw_symbols);
    app
}

/// How many lines each symbol has, and whether it is picked by them.
fn drawn(app: &mut App) -> Vec<(usize, bool)> {
    app.update();
    let mut all = app.world_mut().query::<(&SymbolOf, &DrawnLines)>();
    let all = all.iter(app.world());
    all.map(|(symbol, drawn)| (drawn.lines.len(), symbol.is_picked))
        .collect()
}

#[test]
fn what_is_a_light_no_more_has_no_symbol_and_is_picked_by_none() {
    let mut app = drawing();
    let place = GlobalTransform::IDENTITY;
    let id = SceneId(7);
    let lamp = (PointLamp::default(), InheritedVisibility::VISIBLE);
    let entity = app.world_mut().spawn((id, place, lamp)).id();
    let [(lines, true)] = drawn(&mut app)[..] else {
        panic!("a light has a symbol");
    };
    assert!(lines > 0);
    app.world_mut().entity_mut(entity).remove::<PointLamp>();
    assert_eq!(drawn(&mut app), [(0, false)]);
    // What is selected has its axes then.
    app.world_mut().resource_mut::<Outlined>().0 = vec![id];
    let axes = drawn(&mut app);
    assert!(matches!(axes[..], [(1.., false)]), "{axes:?}");
    app.world_mut()
        .entity_mut(entity)
        .insert(PointLamp::default());
    let lamp = drawn(&mut app);
    assert!(matches!(lamp[..], [(_, true)]) && lamp != axes, "{lamp:?}");
    app.world_mut().entity_mut(entity).remove::<PointLamp>();
    assert_eq!(drawn(&mut app), axes);
    let unit = Aabb::from_min_max(Vec3::splat(-1.0), Vec3::splat(1.0));
    app.world_mut().entity_mut(entity).insert(unit);
    assert_eq!(drawn(&mut app), [(12, false)], "the box of an object");
    app.world_mut().entity_mut(entity).remove::<Aabb>();
    assert_eq!(drawn(&mut app), axes);
}

#[test]
fn of_thousands_of_outlined_groups_those_around_what_changed_are_made_again() {
    let mut app = drawing();
    let world = app.world_mut();
    let unit = Aabb::from_min_max(Vec3::splat(-1.0), Vec3::splat(1.0));
    let mut parts = Vec::new();
    let mut ids = Vec::new();
    for number in 1..=2000 {
        let id = SceneId(number);
        let outer = world.spawn((id, GlobalTransform::IDENTITY)).id();
        let below = (GlobalTransform::IDENTITY, ChildOf(outer));
        let inner = world.spawn((SceneId(10_000 + number), below)).id();
        ids.extend([id, SceneId(10_000 + number)]);
        // Not of the scene: a part of a model that an app has put there.
        let part = (GlobalTransform::IDENTITY, unit, ChildOf(inner));
        parts.push(world.spawn(part).id());
    }
    world.resource_mut::<Outlined>().0 = ids;
    let redone = |app: &mut App| {
        app.update();
        app.world().resource::<SymbolsOf>().redone
    };
    assert_eq!(redone(&mut app), 4000);
    assert_eq!(redone(&mut app), 0);
    let place = GlobalTransform::from_xyz(5.0, 0.0, 0.0);
    app.world_mut().entity_mut(parts[3]).insert(place);
    assert_eq!(redone(&mut app), 2, "the two groups around it");
    app.world_mut().despawn(parts[4]);
    assert_eq!(redone(&mut app), 2);
    let mut all = app.world_mut().query::<(&SymbolOf, &DrawnLines)>();
    let mut least: Vec<f32> = (all.iter(app.world()))
        .filter(|(symbol, _)| [4, 10_004].contains(&symbol.id.0))
        .flat_map(|(_, drawn)| drawn.lines.iter().map(|line| line.ends[0].x))
        .collect();
    least.sort_by(f32::total_cmp);
    assert_eq!(least[0], 4.0);
}
