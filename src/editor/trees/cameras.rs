//! The two cameras that draw a pair of trees: each sees what the editor's camera sees in one half of
//! the view, over its picture and against its depth.

use super::pair::LAYERS;
use crate::editor::viewport::{EditorCamera, Viewport};
use crate::inspect::InspectSettings;
use crate::scene::NotTraced;
use crate::view::{draws_handles, lines_camera};
use bevy::camera::visibility::RenderLayers;
use bevy::camera::{Camera, Projection, SubCameraView, Viewport as Part};
use bevy::ecs::component::Component;
use bevy::ecs::entity::Entity;
use bevy::ecs::hierarchy::ChildOf;
use bevy::ecs::query::{Has, With, Without};
use bevy::ecs::system::{Commands, Local, Query, Res, Single};
use bevy::math::{UVec2, Vec2};
use bevy_egui::PrimaryEguiContext;

/// The first one's place among the cameras of the window: next after the editor's.
const ORDER: isize = 1;

/// A camera that draws one side, 0 or 1 from the left.
#[derive(Component)]
pub(super) struct SideCamera(usize);

/// Where the view is divided: pixels of its width that are on the left.
fn left_width(width: u32, divider: f32) -> u32 {
    ((width as f32 * divider.clamp(0.0, 1.0)).round() as u32).min(width)
}

/// Those that may draw over the sides: the handles' and the panels'. Others are the app's own.
type Others<'w, 's> = Query<
    'w,
    's,
    (
        &'static mut Camera,
        Option<&'static RenderLayers>,
        Has<PrimaryEguiContext>,
    ),
    (Without<SideCamera>, Without<EditorCamera>),
>;

fn comes_later(layers: Option<&RenderLayers>, shows_panels: bool) -> bool {
    shows_panels || draws_handles(layers)
}

/// Two cameras while there is a pair to be seen, and none else: a camera costs time even where it
/// draws nothing.
pub(super) fn fit_cameras(
    mut commands: Commands,
    inspect: Res<InspectSettings>,
    viewport: Res<Viewport>,
    editor: Single<(Entity, &Camera, &Projection), With<EditorCamera>>,
    mut sides: Query<(Entity, &SideCamera, &mut Camera, &mut Projection), Without<EditorCamera>>,
    mut others: Others,
    mut moved: Local<isize>,
) {
    let (parent, editor, seen) = editor.into_inner();
    if !(inspect.on && inspect.pair.on) {
        for (entity, ..) in &sides {
            commands.entity(entity).despawn();
        }
        let back = std::mem::take(&mut *moved);
        if back != 0 {
            for (mut camera, layers, shows_panels) in &mut others {
                if comes_later(layers, shows_panels) && camera.order >= ORDER + back {
                    camera.order -= back;
                }
            }
        }
        return;
    }
    // Those of the handles, which begin with an empty depth, and of the panels come later.
    let ours = ORDER..ORDER + LAYERS.len() as isize;
    let is_in_the_way = |(camera, layers, shows_panels): (&Camera, Option<&RenderLayers>, bool)| {
        comes_later(layers, shows_panels) && ours.contains(&camera.order)
    };
    if others.iter().any(is_in_the_way) {
        let room = LAYERS.len() as isize;
        *moved += room;
        for (mut camera, layers, shows_panels) in &mut others {
            if comes_later(layers, shows_panels) && camera.order >= ORDER {
                camera.order += room;
            }
        }
    }
    if sides.is_empty() {
        for (side, layer) in LAYERS.into_iter().enumerate() {
            commands.spawn((
                SideCamera(side),
                NotTraced,
                lines_camera(ORDER + side as isize, layer),
                seen.clone(),
                ChildOf(parent),
            ));
        }
        return;
    }
    let whole = editor.viewport.as_ref();
    for (_, side, mut camera, mut projection) in &mut sides {
        let part = whole.and_then(|whole| part(whole, viewport.divider, side.0));
        let is_active = editor.is_active && part.is_some();
        if camera.is_active != is_active {
            camera.is_active = is_active;
        }
        let Some((part, sub_view)) = part else {
            continue;
        };
        let same = camera.viewport.as_ref().is_some_and(|known| {
            known.physical_position == part.physical_position
                && known.physical_size == part.physical_size
        });
        if !same || camera.sub_camera_view != Some(sub_view) {
            camera.viewport = Some(part);
            camera.sub_camera_view = Some(sub_view);
        }
        if !same_projection(&projection, seen) {
            *projection = seen.clone();
        }
    }
}

/// A side's part of the view, in the window and in the whole picture; `None` where it has no width.
fn part(whole: &Part, divider: f32, side: usize) -> Option<(Part, SubCameraView)> {
    let size = whole.physical_size;
    let left = left_width(size.x, divider);
    let (offset, width) = match side {
        0 => (0, left),
        _ => (left, size.x - left),
    };
    if width == 0 || size.y == 0 {
        return None;
    }
    let part = Part {
        physical_position: whole.physical_position + UVec2::new(offset, 0),
        physical_size: UVec2::new(width, size.y),
        depth: 0.0..1.0,
    };
    let sub_view = SubCameraView {
        full_size: size,
        offset: Vec2::new(offset as f32, 0.0),
        size: UVec2::new(width, size.y),
    };
    Some((part, sub_view))
}

/// Whether both see the same but for the aspect, which Bevy sets by each camera's own part.
fn same_projection(a: &Projection, b: &Projection) -> bool {
    match (a, b) {
        (Projection::Perspective(a), Projection::Perspective(b)) => {
            a.fov == b.fov && a.near == b.near && a.far == b.far
        }
        (Projection::Orthographic(a), Projection::Orthographic(b)) => {
            a.scale == b.scale
                && a.near == b.near
                && a.far == b.far
                && a.area.height() == b.area.height()
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::ecs::world::World;

    #[test]
    fn handles_and_panels_make_room_for_the_sides_and_go_back_and_no_other_camera_moves() {
        let mut world = World::new();
        world.init_resource::<InspectSettings>();
        world.init_resource::<Viewport>();
        world.spawn((EditorCamera, Camera::default(), Projection::default()));
        let camera = |order| Camera {
            order,
            ..Camera::default()
        };
        let panels = world.spawn((PrimaryEguiContext, camera(2))).id();
        let of_the_app = world.spawn(camera(1)).id();
        let fit = world.register_system(fit_cameras);
        for (is_on, order) in [(true, 4), (true, 4), (false, 2), (true, 4)] {
            world.resource_mut::<InspectSettings>().pair.on = is_on;
            world.run_system(fit).unwrap();
            let order_of = |entity| world.get::<Camera>(entity).unwrap().order;
            assert_eq!((order_of(panels), order_of(of_the_app)), (order, 1));
            let mut sides = world.query_filtered::<&SideCamera, With<NotTraced>>();
            let count = if is_on { LAYERS.len() } else { 0 };
            assert_eq!(sides.iter(&world).count(), count);
        }
    }

    #[test]
    fn the_sides_make_up_the_view_wherever_it_is_divided() {
        let whole = Part {
            physical_position: UVec2::new(220, 60),
            physical_size: UVec2::new(761, 630),
            depth: 0.0..1.0,
        };
        for divider in [0.02, 0.5, 0.98] {
            let [(left, seen_left), (right, seen_right)] =
                [0, 1].map(|side| part(&whole, divider, side).unwrap());
            assert_eq!(left.physical_position, whole.physical_position);
            let end = left.physical_position.x + left.physical_size.x;
            assert_eq!(right.physical_position.x, end);
            assert_eq!(left.physical_size.x + right.physical_size.x, 761);
            assert_eq!(seen_right.offset.x, seen_left.size.x as f32);
            assert_eq!(seen_left.full_size, whole.physical_size);
        }
        assert!(part(&whole, 0.0, 0).is_none());
        assert!(part(&whole, 1.0, 1).is_none());
    }
}
