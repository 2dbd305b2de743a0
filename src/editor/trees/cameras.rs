//! The camera of the right view of a pair: it sees what the editor's camera sees, in a view beside that one's, with the
//! other trees over it.

use super::pair::LAYERS;
use crate::editor::cameras::draw_into;
use crate::editor::viewport::{EditorCamera, Viewport};
use crate::scene::NotTraced;
use crate::view::{draws_handles, see_as, twin_camera};
use bevy::camera::visibility::RenderLayers;
use bevy::camera::{Camera, Projection, Viewport as Part};
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::component::Component;
use bevy::ecs::entity::Entity;
use bevy::ecs::hierarchy::ChildOf;
use bevy::ecs::query::{Has, With, Without};
use bevy::ecs::system::{Commands, Local, Query, Res, Single};
use bevy::math::{UVec2, Vec2};
use bevy::window::{PrimaryWindow, Window};
use bevy_egui::PrimaryEguiContext;

/// Its place among the cameras of the window: next after the editor's, which clears the window.
const ORDER: isize = 1;

/// The camera that draws the right view.
#[derive(Component)]
pub(super) struct Twin;

/// Those that come after it: the handles' and the panels'. Others are the app's own.
type Others<'w, 's> = Query<
    'w,
    's,
    (
        &'static mut Camera,
        Option<&'static RenderLayers>,
        Has<PrimaryEguiContext>,
    ),
    (Without<Twin>, Without<EditorCamera>),
>;

type Twins<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static mut Camera,
        &'static mut Projection,
        &'static mut RenderLayers,
    ),
    (With<Twin>, Without<EditorCamera>),
>;

fn comes_later(layers: Option<&RenderLayers>, shows_panels: bool) -> bool {
    shows_panels || draws_handles(layers)
}

/// It is there while there is a second view, and not else: a camera costs time even where it draws nothing.
pub(super) fn fit_twin(
    mut commands: Commands,
    viewport: Res<Viewport>,
    window: Option<Single<&Window, With<PrimaryWindow>>>,
    editor: Single<(Entity, &Camera, &Projection, &RenderLayers), With<EditorCamera>>,
    mut twins: Twins,
    mut others: Others,
    mut moved: Local<bool>,
) {
    let (of, editor, seen, layers) = editor.into_inner();
    let Some(place) = viewport.twin else {
        for (entity, ..) in &twins {
            commands.entity(entity).despawn();
        }
        if std::mem::take(&mut *moved) {
            for (mut camera, layers, shows_panels) in &mut others {
                if comes_later(layers, shows_panels) && camera.order > ORDER {
                    camera.order -= 1;
                }
            }
        }
        return;
    };
    let is_in_the_way = |(camera, layers, shows_panels): (&Camera, Option<&RenderLayers>, bool)| {
        comes_later(layers, shows_panels) && camera.order == ORDER
    };
    if others.iter().any(is_in_the_way) {
        *moved = true;
        for (mut camera, layers, shows_panels) in &mut others {
            if comes_later(layers, shows_panels) && camera.order >= ORDER {
                camera.order += 1;
            }
        }
    }
    if twins.is_empty() {
        commands.spawn((
            Twin,
            NotTraced,
            twin_camera(of, ORDER),
            with_right(layers),
            seen.clone(),
            ChildOf(of),
        ));
        return;
    }
    let window = window.map(|window| (window.scale_factor(), window.physical_size()));
    let whole = editor.viewport.as_ref().zip(window);
    let part = whole.and_then(|(whole, window)| part(whole, place.min, window));
    for (_, mut camera, mut projection, mut own_layers) in &mut twins {
        let is_active = editor.is_active && part.is_some();
        if camera.is_active != is_active {
            camera.is_active = is_active;
        }
        own_layers.set_if_neq(with_right(layers));
        see_as(&mut projection, seen);
        if part.is_some() {
            draw_into(&mut camera, part.clone());
        }
    }
}

/// What the editor's camera shows, with the right view's trees in place of the left one's.
fn with_right(layers: &RenderLayers) -> RenderLayers {
    layers.clone().without(LAYERS[0]).with(LAYERS[1])
}

/// As large as the left view, at that place of the window; `None` where the window has no room for it.
fn part(left: &Part, at: Vec2, (scale, window): (f32, UVec2)) -> Option<Part> {
    let size = left.physical_size;
    let last = window.checked_sub(size)?;
    let at = (at * scale).round().max(Vec2::ZERO).as_uvec2().min(last);
    (at.x >= left.physical_position.x + size.x).then_some(Part {
        physical_position: at,
        physical_size: size,
        depth: 0.0..1.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::ecs::world::World;
    use bevy::math::Rect;

    #[test]
    fn handles_and_panels_make_room_for_the_right_view_and_go_back_and_no_other_camera_moves() {
        let mut world = World::new();
        world.init_resource::<Viewport>();
        world.spawn((
            EditorCamera,
            Camera::default(),
            Projection::default(),
            RenderLayers::from_layers(&[0, LAYERS[0]]),
        ));
        let camera = |order| Camera {
            order,
            ..Camera::default()
        };
        let panels = world.spawn((PrimaryEguiContext, camera(1))).id();
        let of_the_app = world.spawn(camera(1)).id();
        let fit = world.register_system(fit_twin);
        for (is_on, order) in [(true, 2), (true, 2), (false, 1), (true, 2)] {
            let twin = is_on.then(|| Rect::new(100.0, 0.0, 200.0, 80.0));
            world.resource_mut::<Viewport>().twin = twin;
            world.run_system(fit).unwrap();
            let order_of = |entity| world.get::<Camera>(entity).unwrap().order;
            assert_eq!((order_of(panels), order_of(of_the_app)), (order, 1));
            let mut twins = world.query_filtered::<&RenderLayers, (With<Twin>, With<NotTraced>)>();
            let layers: Vec<_> = twins.iter(&world).collect();
            assert_eq!(layers.len(), usize::from(is_on));
            for layers in layers {
                assert_eq!(*layers, RenderLayers::from_layers(&[0, LAYERS[1]]));
            }
        }
    }

    #[test]
    fn the_right_view_has_the_left_ones_pixels_and_lies_beside_it_in_the_window() {
        let left = Part {
            physical_position: UVec2::new(221, 60),
            physical_size: UVec2::new(379, 630),
            depth: 0.0..1.0,
        };
        let window = UVec2::new(1280, 720);
        let at = Vec2::new(602.0 / 1.25, 60.0 / 1.25);
        let right = part(&left, at, (1.25, window)).unwrap();
        assert_eq!(right.physical_size, left.physical_size);
        assert_eq!(right.physical_position, UVec2::new(602, 60));
        // A place that rounds to one beyond the window.
        let right = part(&left, Vec2::new(1300.0, 0.0), (1.0, window)).unwrap();
        assert_eq!(right.physical_position.x + 379, window.x);
        assert!(part(&left, Vec2::new(500.0, 60.0), (1.0, window)).is_none());
        assert!(part(&left, at, (1.0, UVec2::new(300, 720))).is_none());
    }
}
