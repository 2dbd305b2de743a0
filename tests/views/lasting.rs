//! What is left of a view that is none any more: nothing.

use super::{Game, RED, Seen};
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use glassbox::view::{TracedRender, TracedView};

/// How many entities, meshes and pictures there are.
fn count(game: &mut Game) -> [usize; 3] {
    for _ in 0..5 {
        game.app.update();
    }
    let world = game.app.world_mut();
    let entities = world.query::<Entity>().iter(world).count();
    [
        entities,
        world.resource::<Assets<Mesh>>().len(),
        world.resource::<Assets<Image>>().len(),
    ]
}

fn renders(game: &mut Game) -> usize {
    let world = game.app.world_mut();
    let mut renders = world.query::<(&TracedRender, Option<&Disabled>)>();
    renders.iter(world).count()
}

#[test]
fn a_view_that_is_removed_and_inserted_again_leaves_nothing_behind() {
    let Some(mut game) = Game::open() else {
        return;
    };
    let camera = game.camera(RED, None, 0);
    assert_eq!(game.shot().seen(48, 32), Seen::Blue);
    let before = count(&mut game);
    for _ in 0..3 {
        let mut view = game.app.world_mut().entity_mut(camera);
        view.insert(TracedView::default());
        game.wait_for_pictures();
        assert_eq!(game.shot().seen(48, 32), Seen::Red);
        let mut view = game.app.world_mut().entity_mut(camera);
        view.remove::<TracedView>();
        assert_eq!(
            game.shot().seen(48, 32),
            Seen::Blue,
            "the picture is frozen"
        );
        assert_eq!(renders(&mut game), 0, "a render goes on");
        assert_eq!(count(&mut game), before, "something is left");
    }
}

#[test]
fn a_view_that_is_disabled_or_despawned_renders_no_more() {
    let Some(mut game) = Game::open() else {
        return;
    };
    game.camera(RED, None, 0);
    let mut left = Vec::new();
    for _ in 0..3 {
        let camera = game.view(RED, None, 1);
        game.wait_for_pictures();
        assert_eq!(game.shot().seen(48, 32), Seen::Red);
        game.app.world_mut().entity_mut(camera).insert(Disabled);
        game.app.update();
        assert_eq!(renders(&mut game), 0, "a render goes on");
        game.app.world_mut().entity_mut(camera).remove::<Disabled>();
        game.app.update();
        game.wait_for_pictures();
        assert_eq!(game.shot().seen(48, 32), Seen::Red);
        game.app.world_mut().entity_mut(camera).despawn();
        assert_eq!(game.shot().seen(48, 32), Seen::Blue);
        left.push(count(&mut game));
    }
    // What is made once, with the first view, stays.
    assert_eq!(left[1], left[0], "something is left");
    assert_eq!(left[2], left[0], "something is left");
}
