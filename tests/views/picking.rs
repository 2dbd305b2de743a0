//! Pointers over traced pictures, without the editor.

use super::{GREEN, Game, RED};
use bevy::camera::{NormalizedRenderTarget, RenderTarget};
use bevy::picking::events::{Click, Out, Over, Pointer};
use bevy::picking::pointer::{Location, PointerAction, PointerButton, PointerId, PointerInput};
use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use glassbox::prelude::*;

/// What an app's observers hear, in order.
#[derive(Resource, Default)]
struct Heard(Vec<(&'static str, Entity)>);

fn listen(game: &mut Game) {
    // Bevy asks which window is meant by none, whatever pointers point at.
    game.app
        .world_mut()
        .spawn((Window::default(), PrimaryWindow));
    game.app
        .init_resource::<Heard>()
        .add_observer(|over: On<Pointer<Over>>, mut heard: ResMut<Heard>| {
            heard.0.push(("over", over.original_event_target()));
        })
        .add_observer(|out: On<Pointer<Out>>, mut heard: ResMut<Heard>| {
            heard.0.push(("out", out.original_event_target()));
        })
        .add_observer(|click: On<Pointer<Click>>, mut heard: ResMut<Heard>| {
            heard.0.push(("click", click.original_event_target()));
        });
}

/// The pointer does something at this place of the image; what observers of walls have heard of it.
fn point(game: &mut Game, position: Vec2, action: PointerAction) -> Vec<(&'static str, Entity)> {
    let target = RenderTarget::Image(game.image.clone().into());
    let target = target.normalize(None);
    let target: NormalizedRenderTarget = target.expect("an image");
    let location = Location { target, position };
    let world = game.app.world_mut();
    world.write_message(PointerInput::new(PointerId::Mouse, location, action));
    for _ in 0..2 {
        game.app.update();
    }
    let world = game.app.world_mut();
    let heard = std::mem::take(&mut world.resource_mut::<Heard>().0);
    let is_wall = |(_, entity): &(&str, Entity)| game.app.world().get::<Mesh3d>(*entity).is_some();
    heard.into_iter().filter(is_wall).collect()
}

#[test]
fn observers_of_pointers_hear_of_what_is_traced_under_them_and_of_nothing_else() {
    let Some(mut game) = Game::open() else {
        return;
    };
    listen(&mut game);
    let view = game.view(RED, None, 0);
    game.wait_for_pictures();
    let world = game.app.world_mut();
    let mut walls = world.query_filtered::<(Entity, &Transform), With<Phong>>();
    let ahead = |direction: Dir3| {
        move |(wall, place): (Entity, &Transform)| {
            (place.translation.dot(*direction) > 1.0).then_some(wall)
        }
    };
    let red = walls.iter(world).find_map(ahead(RED)).expect("a wall");
    let green = walls.iter(world).find_map(ahead(GREEN)).expect("a wall");
    let middle = Vec2::new(48.0, 32.0);
    let still = PointerAction::Move { delta: Vec2::ONE };
    let click = |game: &mut Game| {
        let press = PointerAction::Press(PointerButton::Primary);
        let release = PointerAction::Release(PointerButton::Primary);
        let mut heard = point(game, middle, press);
        heard.extend(point(game, middle, release));
        heard
    };
    // The blue wall before it, which Bevy alone draws, is not seen.
    assert_eq!(point(&mut game, middle, still), [("over", red)]);
    assert_eq!(click(&mut game), [("click", red)]);
    let mut place = game.app.world_mut().get_mut::<Transform>(view).unwrap();
    place.look_to(GREEN, Vec3::Y);
    game.wait_for_pictures();
    let turned = point(&mut game, middle, still);
    assert_eq!(turned, [("out", red), ("over", green)]);
    game.app.world_mut().entity_mut(green).insert(NotTraced);
    game.wait_for_pictures();
    assert_eq!(point(&mut game, middle, still), [("out", green)]);
    assert_eq!(click(&mut game), []);
    game.app.world_mut().entity_mut(green).remove::<NotTraced>();
    game.wait_for_pictures();
    assert_eq!(point(&mut game, middle, still), [("over", green)]);
    // A camera that is no view any more has Bevy's picking alone.
    game.app.world_mut().entity_mut(view).remove::<TracedView>();
    assert_eq!(point(&mut game, middle, still), [("out", green)]);
    assert_eq!(click(&mut game), []);
}
