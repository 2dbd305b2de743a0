//! Groups: putting entities below one, and taking it away again.

use super::parents::ancestors;
use super::{AddAt, add, delete, reparent, roots_of, scene_entity, set_visible};
use crate::editor::action::Addition;
use crate::editor::extent::{Extent, extent_of};
use crate::editor::history::LaidAside;
use crate::io::place::world_from;
use crate::scene::{
    DirectionalLamp, MeshSource, Motion, ParallelogramLamp, Phong, PointLamp, SceneCamera, SceneId,
    SegmentLamp,
};
use bevy::camera::visibility::Visibility;
use bevy::ecs::entity::Entity;
use bevy::ecs::hierarchy::{ChildOf, Children};
use bevy::ecs::world::World;
use bevy::math::Vec3;
use bevy::mesh::Mesh3d;
use bevy::transform::components::Transform;

/// Whether it is a place for others and nothing besides.
pub(in crate::editor) fn is_group(world: &World, entity: Entity) -> bool {
    let entity = world.entity(entity);
    entity.contains::<Transform>()
        && !entity.contains::<Mesh3d>()
        && !entity.contains::<MeshSource>()
        && !entity.contains::<Phong>()
        && !entity.contains::<PointLamp>()
        && !entity.contains::<DirectionalLamp>()
        && !entity.contains::<SegmentLamp>()
        && !entity.contains::<ParallelogramLamp>()
        && !entity.contains::<SceneCamera>()
}

/// Puts entities below a new group, where all of them were below the same before; it stands in the middle of the room that
/// they take, and they stay where they are. `None` where none of them stands anywhere.
pub fn group(world: &mut World, ids: &[SceneId]) -> Option<SceneId> {
    let stands = |id: &SceneId| {
        let entity = scene_entity(world, *id)?;
        world.get::<Transform>(entity).map(|_| (*id, entity))
    };
    let (ids, entities): (Vec<SceneId>, Vec<Entity>) =
        roots_of(world, ids).iter().filter_map(stands).unzip();
    let parent = shared_parent(world, &entities)?;
    let middle = middle(world, &ids, &entities);
    let at = AddAt {
        place: middle,
        ..AddAt::default()
    };
    let group = add(world, &Addition::Group, at)?;
    if let (Some(parent), Some(entity)) = (parent, scene_entity(world, group)) {
        // As its parent is turned and scaled: so it adds no shear to what is below it.
        let place = world_from(world, parent).inverse().transform_point3(middle);
        let place = if place.is_finite() { place } else { Vec3::ZERO };
        let place = Transform::from_translation(place);
        world.entity_mut(entity).insert((ChildOf(parent), place));
    }
    reparent(world, &ids, Some(group));
    Some(group)
}

/// What all of these are below and that can have children; none above all of them is `Some(None)`, and `None` is that
/// there are none of these.
fn shared_parent(world: &World, entities: &[Entity]) -> Option<Option<Entity>> {
    let (first, others) = entities.split_first()?;
    let is_above = |above: &Entity| {
        world.get::<SceneId>(*above).is_some()
            && world.get::<Transform>(*above).is_some()
            && (others.iter()).all(|&other| ancestors(world, other).any(|known| known == *above))
    };
    Some(ancestors(world, *first).find(is_above))
}

fn middle(world: &World, ids: &[SceneId], entities: &[Entity]) -> Vec3 {
    let places = || {
        let places = entities.iter().map(|&entity| world_from(world, entity));
        Extent::of_points(places.map(|place| place.translation.into()))
    };
    // What was added in this frame has no measured room yet.
    let extent = extent_of(world, ids).or_else(places);
    extent.map_or(Vec3::ZERO, Extent::centre)
}

/// What became of groups that were taken away.
pub struct Ungrouped {
    /// What stood right below them.
    pub freed: Vec<SceneId>,
    /// One of them moved while the shutter is open, and carried what was below it.
    pub lost_motion: bool,
}

/// Takes those of these away that are groups. What is below one stays where it is in the world, below what the group was
/// below; hidden, if the group was.
pub fn ungroup(world: &mut World, ids: &[SceneId]) -> Ungrouped {
    let mut ungrouped = Ungrouped {
        freed: Vec::new(),
        lost_motion: false,
    };
    for &id in ids {
        let group = scene_entity(world, id).filter(|&group| is_group(world, group));
        let Some(group) = group else {
            continue;
        };
        let of_scene = |entity: &Entity| {
            let is_there = world.get::<LaidAside>(*entity).is_none();
            world.get::<SceneId>(*entity).copied().filter(|_| is_there)
        };
        let children = world.get::<Children>(group).into_iter().flatten();
        let children: Vec<SceneId> = children.filter_map(of_scene).collect();
        let parent = world.get::<ChildOf>(group).map(ChildOf::parent);
        let parent = parent.and_then(|parent| world.get::<SceneId>(parent).copied());
        ungrouped.lost_motion |= world.get::<Motion>(group).is_some() && !children.is_empty();
        if world.get::<Visibility>(group) == Some(&Visibility::Hidden) {
            set_visible(world, &children, false);
        }
        reparent(world, &children, parent);
        delete(world, &[id]);
        ungrouped.freed.retain(|freed| *freed != id);
        ungrouped.freed.extend(children);
    }
    ungrouped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::action::Action;
    use crate::editor::edits::select;
    use crate::editor::headless_editor;
    use crate::editor::history::History;
    use crate::editor::selection::Selection;
    use bevy::app::App;
    use bevy::math::Quat;

    /// House 1, turned and scaled { Roof 2, Door 3 { Knob 4 } }, Tree 5, and a material 6.
    fn village() -> App {
        let mut app = headless_editor();
        let world = app.world_mut();
        let at = |x: f32| Transform::from_xyz(x, 0.5, 2.0);
        let turned = at(10.0)
            .with_rotation(Quat::from_rotation_y(0.7))
            .with_scale(Vec3::new(2.0, 1.0, 3.0));
        let house = world.spawn((SceneId(1), turned)).id();
        world.spawn((SceneId(2), at(1.0), PointLamp::default(), ChildOf(house)));
        let door = world.spawn((SceneId(3), at(-1.0), ChildOf(house))).id();
        world.spawn((SceneId(4), at(0.25), PointLamp::default(), ChildOf(door)));
        world.spawn((SceneId(5), at(-4.0), PointLamp::default()));
        world.spawn((SceneId(6), Phong::default()));
        app.update();
        app
    }

    fn run(app: &mut App, ids: &[u64], command: &'static str) {
        let world = app.world_mut();
        select(world, ids.iter().copied().map(SceneId).collect());
        world.write_message(Action::run(command));
        app.update();
    }

    /// Of those that are there.
    fn places(app: &App) -> Vec<Option<Vec3>> {
        let world = app.world();
        let place = |id| {
            let entity = scene_entity(world, SceneId(id))?;
            Some(world_from(world, entity).translation.into())
        };
        (1..=5).map(place).collect()
    }

    fn parent(app: &App, id: SceneId) -> Option<SceneId> {
        let entity = scene_entity(app.world(), id)?;
        let parent = app.world().get::<ChildOf>(entity)?.parent();
        app.world().get::<SceneId>(parent).copied()
    }

    fn assert_places(app: &App, before: &[Option<Vec3>]) {
        for (place, before) in places(app).into_iter().zip(before) {
            let (Some(place), Some(before)) = (place, before) else {
                continue;
            };
            assert!(place.distance(*before) < 1e-5, "{before}: {place}");
        }
    }

    #[test]
    fn a_group_is_one_step_below_what_its_members_were_below_and_moves_none_of_them() {
        let mut app = village();
        let before = places(&app);
        // The knob comes along with its door, and is no member itself.
        run(&mut app, &[4, 2, 3], "edit.group");
        let group = app.world().resource::<Selection>().active().unwrap();
        assert_eq!(parent(&app, group), Some(SceneId(1)));
        let parents = [2, 3, 4].map(|id| parent(&app, SceneId(id)).unwrap());
        assert_eq!(parents, [group, group, SceneId(3)]);
        assert_places(&app, &before);
        let text = |app: &App| {
            app.world()
                .resource::<History>()
                .undo_text()
                .map(str::to_owned)
        };
        assert_eq!(text(&app).as_deref(), Some("Group 2 entities"));
        run(&mut app, &[], "edit.undo");
        assert!(scene_entity(app.world(), group).is_none());
        assert_eq!(parent(&app, SceneId(2)), Some(SceneId(1)));
        assert_places(&app, &before);
        // Of what has nothing above all of it the group is at the top.
        run(&mut app, &[2, 5, 6], "edit.group");
        let group = app.world().resource::<Selection>().active().unwrap();
        assert_eq!(parent(&app, group), None);
        assert_eq!(parent(&app, SceneId(6)), None, "a material stands nowhere");
        assert_places(&app, &before);
    }

    #[test]
    fn what_was_grouped_is_as_before_once_it_is_ungrouped() {
        let mut app = village();
        let before = places(&app);
        run(&mut app, &[2, 3], "edit.group");
        let group = app.world().resource::<Selection>().active().unwrap();
        run(&mut app, &[group.0], "edit.ungroup");
        assert!(scene_entity(app.world(), group).is_none());
        let selected = app.world().resource::<Selection>().ids();
        assert_eq!(selected, [SceneId(2), SceneId(3)]);
        assert_eq!(parent(&app, SceneId(2)), Some(SceneId(1)));
        assert_places(&app, &before);
        run(&mut app, &[], "edit.undo");
        assert_eq!(parent(&app, SceneId(2)), Some(group));
        // A group in a group: both go, and what is hidden with one stays hidden.
        let house = scene_entity(app.world(), SceneId(1)).unwrap();
        app.world_mut().entity_mut(house).insert(Visibility::Hidden);
        run(&mut app, &[1, group.0], "edit.ungroup");
        assert!(scene_entity(app.world(), SceneId(1)).is_none());
        assert_eq!(parent(&app, SceneId(2)), None);
        let roof = scene_entity(app.world(), SceneId(2)).unwrap();
        let visibility = app.world().get::<Visibility>(roof);
        assert_eq!(visibility, Some(&Visibility::Hidden));
        assert_places(&app, &before);
    }

    #[test]
    fn what_can_be_neither_grouped_nor_ungrouped_says_why_and_stays() {
        let mut app = village();
        for (ids, command, why) in [
            (&[][..], "edit.group", "Nothing is selected."),
            (&[6], "edit.group", "A material stands nowhere"),
            (&[5, 6], "edit.ungroup", "No group is selected."),
        ] {
            run(&mut app, ids, command);
            let state = crate::editor::command::find(app.world(), command).unwrap();
            let state = state.state_in(app.world());
            assert!(state.why_not.unwrap().starts_with(why), "{command}");
            assert_eq!(app.world().resource::<History>().undo_text(), None);
        }
        assert!(group(app.world_mut(), &[SceneId(6)]).is_none());
    }
}
