//! Pictures of what a window shows.

use bevy::ecs::component::Mutable;
use bevy::ecs::observer::On;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::ResMut;
use bevy::ecs::world::World;
use bevy::image::Image;
use bevy::render::view::window::screenshot::{Screenshot, ScreenshotCaptured};

/// Gives a resource what the primary window shows with the next frame, as soon as the renderer has
/// brought it back: some frames later, and never where nothing is drawn.
pub fn shoot_window<R: Resource<Mutability = Mutable>>(
    world: &mut World,
    take: impl Fn(&mut R, &Image) + Send + Sync + 'static,
) {
    world.spawn(Screenshot::primary_window()).observe(
        move |captured: On<ScreenshotCaptured>, mut taker: ResMut<R>| {
            take(&mut taker, &captured.image);
        },
    );
}
