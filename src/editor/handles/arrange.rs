//! Several objects in one line, at equal distances, or on what is below them.

use super::super::command::{Command, State};
use super::super::edits::{name_of, roots_of, scene_entity, step};
use super::super::extent::{Extent, extent_of, world_from_parent};
use super::super::notice::Notices;
use super::super::pick;
use super::super::selection::Selection;
use super::bodies::{Body, Change};
use super::snap::hangs_on;
use crate::scene::SceneId;
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy::math::{Dir3, Vec3};
use bevy::transform::components::Transform;
use std::collections::HashSet;

const AXES: [(&str, Vec3); 3] = [("x", Vec3::X), ("y", Vec3::Y), ("z", Vec3::Z)];

/// Commands for each axis, and one for the floor.
pub(super) fn commands() -> Vec<Command> {
    let mut all = vec![
        Command::new(
            "arrange.put-down",
            "Put on what is below",
            "The selected objects go down, or up, until they stand on what is below their middle",
            put_down,
        )
        .keys(&["End"])
        .menu("Edit/Arrange", 2)
        .state(|world| ready(world, 1)),
    ];
    for (name, axis) in AXES {
        let id = format!("arrange.align-{name}");
        let title = format!("Align in {name}");
        let help = format!("The middles of the selected objects get the active one's {name}");
        let run = move |world: &mut World| align(world, name, axis);
        let row = Command::new(id, title, help, run).menu("Edit/Arrange", 3);
        all.push(row.state(|world| ready(world, 2)));
    }
    for (name, axis) in AXES {
        let id = format!("arrange.distribute-{name}");
        let title = format!("Distribute in {name}");
        let help = format!(
            "The middles of the selected objects get equal distances in {name}; the first and the last stay"
        );
        let run = move |world: &mut World| distribute(world, name, axis);
        let row = Command::new(id, title, help, run).menu("Edit/Arrange", 4);
        all.push(row.state(|world| ready(world, 3)));
    }
    all
}

fn ready(world: &World, least: usize) -> State {
    let enough = standing(world).take(least).count() >= least;
    let why_not = match least {
        1 => "Nothing that stands somewhere is selected.",
        2 => "Two objects have to be selected of which neither hangs on the other.",
        _ => "Three objects have to be selected of which none hangs on another.",
    };
    State::when(enough, why_not)
}

/// The selected objects that do not hang on others of them, and the room that each takes; the active one is the last.
fn selected(world: &World) -> Vec<(SceneId, Extent)> {
    standing(world).collect()
}

/// The same, one after the other.
fn standing(world: &World) -> impl Iterator<Item = (SceneId, Extent)> {
    let roots = roots_of(world, world.resource::<Selection>().ids());
    let with_extent = |id| {
        world.get::<Transform>(scene_entity(world, id)?)?;
        Some((id, extent_of(world, &[id])?))
    };
    roots.into_iter().filter_map(with_extent)
}

/// Moves it in the world; `false` where it stays.
fn shift(world: &mut World, id: SceneId, by: Vec3) -> bool {
    let Some(entity) = scene_entity(world, id) else {
        return false;
    };
    let Some(&own) = world.get::<Transform>(entity) else {
        return false;
    };
    let world_from_parent = world_from_parent(world, entity);
    let body = Body {
        own,
        world_from_parent,
    };
    let moved = body.changed(Change::Move(by), Vec3::ZERO);
    let Some(moved) = moved.filter(|moved| *moved != own) else {
        return false;
    };
    if let Some(mut own) = world.get_mut::<Transform>(entity) {
        *own = moved;
    }
    true
}

/// Moves all, as one step.
fn shift_all(world: &mut World, verb: &str, moves: Vec<(SceneId, Vec3)>) {
    step(world, |world| {
        let moved = moves.into_iter().filter(|(id, by)| shift(world, *id, *by));
        let moved: Vec<(SceneId, Vec3)> = moved.collect();
        match moved.as_slice() {
            [] => None,
            [(one, _)] => Some(format!("{verb}: {}", name_of(world, *one))),
            several => Some(format!("{verb}: {} objects", several.len())),
        }
    });
}

fn align(world: &mut World, name: &str, axis: Vec3) {
    let all = selected(world);
    let Some((_, active)) = all.last() else {
        return;
    };
    let wanted = active.centre();
    let moves = all
        .iter()
        .map(|(id, own)| (*id, axis * (wanted - own.centre())));
    let moves = moves.collect();
    shift_all(world, &format!("Align in {name}"), moves);
}

fn distribute(world: &mut World, name: &str, axis: Vec3) {
    let mut all = selected(world);
    let at = |extent: &Extent| extent.centre().dot(axis);
    all.sort_by(|(_, a), (_, b)| at(a).total_cmp(&at(b)));
    let ([(_, first), .., (_, last)], count) = (all.as_slice(), all.len()) else {
        return;
    };
    let (from, to) = (at(first), at(last));
    let moves = all.iter().enumerate().map(|(i, (id, own))| {
        let wanted = from + (to - from) * i as f32 / (count - 1) as f32;
        (*id, axis * (wanted - at(own)))
    });
    // The first and the last stay, bit for bit.
    let moves = moves.skip(1).take(count - 2).collect();
    shift_all(world, &format!("Distribute in {name}"), moves);
}

/// The height of what is below a point, of the objects that count.
fn below(world: &World, from: Vec3, counts: impl Fn(SceneId) -> bool) -> Option<f32> {
    let met = pick::past(world, from, Dir3::NEG_Y, |id| !counts(id))?;
    Some(met.point.y)
}

/// What was put down, or stays: others may stand on it.
struct Put {
    entity: Entity,
    /// As it was.
    extent: Extent,
    /// Metres.
    up: f32,
}

impl Put {
    /// The height of what is below a point once it has moved. What moves up takes along what stood on it, though its top
    /// is above that point then.
    fn below(&self, world: &World, from: Vec3) -> Option<f32> {
        let Extent { least, most } = self.extent;
        let [x, z] = [0, 2].map(|axis| (least[axis]..=most[axis]).contains(&from[axis]));
        // Most are beside it, and each costs a ray.
        if !(x && z) {
            return None;
        }
        let from = from + Vec3::Y * (-self.up).max(0.0);
        let is_its = |id| hangs_on(world, id, |entity| entity == self.entity);
        let height = below(world, from, is_its)?;
        Some(height + self.up)
    }
}

/// Lowest first: what stands on another one of them comes to stand where that has moved to, which no ray meets there yet.
fn put_down(world: &mut World) {
    let mut all = selected(world);
    all.sort_by(|(_, a), (_, b)| a.least.y.total_cmp(&b.least.y));
    let entities = all.iter().filter_map(|(id, _)| scene_entity(world, *id));
    let entities: HashSet<Entity> = entities.collect();
    let mut put: Vec<Put> = Vec::new();
    let mut moves = Vec::new();
    for (id, extent) in &all {
        let Some(entity) = scene_entity(world, *id) else {
            continue;
        };
        let from = extent.centre();
        let is_other = |id| !hangs_on(world, id, |entity| entities.contains(&entity));
        let mut floor = below(world, from, is_other);
        for put in put.iter().rev() {
            // A ray for those alone that may be higher.
            if floor.is_none_or(|floor| floor < put.extent.most.y + put.up) {
                floor = floor
                    .into_iter()
                    .chain(put.below(world, from))
                    .reduce(f32::max);
            }
        }
        let up = floor.map(|floor| floor - extent.least.y);
        moves.extend(up.map(|up| (*id, Vec3::Y * up)));
        put.push(Put {
            entity,
            extent: *extent,
            up: up.unwrap_or(0.0),
        });
    }
    if moves.is_empty() && !all.is_empty() {
        let text = "There is nothing below what is selected.";
        world.resource_mut::<Notices>().tell(text);
        return;
    }
    shift_all(world, "Put down", moves);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::action::Addition;
    use crate::editor::command::find;
    use crate::editor::edits::{AddAt, add};
    use crate::editor::headless_editor;
    use crate::editor::history::undo;
    use crate::io::{OpenOptions, SceneSource, builtin, open};
    use crate::scene::PointLamp;
    use bevy::app::App;
    use bevy::ecs::name::Name;

    #[test]
    fn arranging_stands_in_the_menu_with_what_else_is_done_to_the_selection() {
        let app = headless_editor();
        let delete = find(app.world(), "edit.delete").unwrap();
        let all = commands();
        let first = all
            .iter()
            .flat_map(|row| &row.menus)
            .map(|(_, group)| group);
        assert_eq!(first.min(), Some(&delete.menus[0].1));
    }

    fn lamps(places: &[Vec3]) -> App {
        let mut app = headless_editor();
        for (i, place) in places.iter().enumerate() {
            let lamp = (SceneId(1 + i as u64), PointLamp::default());
            app.world_mut()
                .spawn((lamp, Transform::from_translation(*place)));
        }
        app.update();
        let ids = (1..=places.len() as u64).map(SceneId);
        app.world_mut().resource_mut::<Selection>().set(ids);
        app
    }

    #[test]
    fn what_would_do_nothing_is_not_offered() {
        let mut app = lamps(&[Vec3::ZERO, Vec3::ONE]);
        let world = app.world_mut();
        let material = SceneId(7);
        world.spawn((material, crate::scene::Phong::default()));
        let (parent, child) = (SceneId(8), SceneId(9));
        let above = world.spawn((parent, PointLamp::default())).id();
        let hangs = bevy::ecs::hierarchy::ChildOf(above);
        world.spawn((child, PointLamp::default(), hangs));
        app.update();
        for (ids, least, enough) in [
            (vec![material], 1, false),
            (vec![material, SceneId(1)], 1, true),
            (vec![material, SceneId(1)], 2, false),
            (vec![parent, child], 2, false),
            (vec![SceneId(1), SceneId(2)], 2, true),
            (vec![SceneId(1), parent, child], 3, false),
        ] {
            let world = app.world_mut();
            world.resource_mut::<Selection>().set(ids.iter().copied());
            let state = ready(world, least);
            assert_eq!(state.why_not.is_none(), enough, "{ids:?} of {least}");
        }
    }

    fn places(app: &App, count: u64) -> Vec<Vec3> {
        let place = |id| {
            let entity = scene_entity(app.world(), SceneId(id)).unwrap();
            app.world().get::<Transform>(entity).unwrap().translation
        };
        (1..=count).map(place).collect()
    }

    #[test]
    fn objects_get_the_active_ones_coordinate_and_undo_gives_it_back() {
        let before = [Vec3::new(1.0, 2.0, 3.0), Vec3::new(-4.0, 5.0, 6.0)];
        let mut app = lamps(&before);
        align(app.world_mut(), "y", Vec3::Y);
        let expected = [Vec3::new(1.0, 5.0, 3.0), before[1]];
        assert_eq!(places(&app, 2), expected);
        assert!(undo(app.world_mut()).is_some());
        assert_eq!(places(&app, 2), before);
    }

    #[test]
    fn those_between_the_first_and_the_last_get_equal_distances() {
        let before = [9.0, 0.0, 1.0, 8.0].map(|x| Vec3::new(x, x, 0.0));
        let mut app = lamps(&before);
        distribute(app.world_mut(), "x", Vec3::X);
        let after = places(&app, 4);
        let xs: Vec<f32> = after.iter().map(|place| place.x).collect();
        assert_eq!(xs, [9.0, 0.0, 3.0, 6.0]);
        assert!(
            after
                .iter()
                .zip(before)
                .all(|(now, before)| now.y == before.y)
        );
    }

    #[test]
    fn a_block_in_the_air_and_one_sunk_into_the_floor_are_put_onto_it() {
        let mut app = headless_editor();
        let source = SceneSource::Builtin(builtin::find("cornell-box").unwrap());
        open(app.world_mut(), &source, OpenOptions::default()).unwrap();
        app.update();
        let mut named = app.world_mut().query::<(Entity, &SceneId, &Name)>();
        let found = named
            .iter(app.world())
            .find(|(_, _, name)| name.as_str() == "Short block");
        let (block, id, _) = found.unwrap();
        let id = *id;
        app.world_mut().resource_mut::<Selection>().set([id]);
        for height in [0.2, -0.05] {
            app.world_mut()
                .get_mut::<Transform>(block)
                .unwrap()
                .translation
                .y = height;
            app.update();
            app.update();
            put_down(app.world_mut());
            let now = app.world().get::<Transform>(block).unwrap().translation.y;
            assert!(now.abs() < 1e-4, "from {height} m to {now} m");
        }
    }

    #[test]
    fn a_stack_in_the_air_or_in_the_floor_is_put_down_as_one_whatever_was_selected_first() {
        let mut app = headless_editor();
        let world = app.world_mut();
        let floor = add_cube(world, Vec3::new(0.0, -0.5, 0.0));
        let scale = Vec3::new(20.0, 1.0, 20.0);
        let entity = scene_entity(world, floor).unwrap();
        world.get_mut::<Transform>(entity).unwrap().scale = scale;
        // The third one stands beside the stack, and the fourth upon what stays where it is.
        let stack = [0.0, 1.0, 0.2, 0.4];
        let ids = stack.map(|_| add_cube(world, Vec3::ZERO));
        let stays = add_cube(world, Vec3::new(-5.0, 0.5, 0.0));
        let xs = [0.0, 0.25, 5.0, -5.0];
        for above in [1.5, -0.3] {
            let world = app.world_mut();
            for ((id, x), y) in ids.into_iter().zip(xs).zip(stack) {
                let entity = scene_entity(world, id).unwrap();
                let mut place = world.get_mut::<Transform>(entity).unwrap();
                let on = if x < 0.0 { 1.0 } else { 0.0 };
                place.translation = Vec3::new(x, 0.5 + on + y + above, 0.0);
            }
            app.update();
            app.update();
            for selected in [[0, 1, 2, 3], [1, 3, 0, 2]] {
                let world = app.world_mut();
                world
                    .resource_mut::<Selection>()
                    .set(selected.map(|i| ids[i]));
                put_down(world);
                let heights = ids.map(|id| {
                    let entity = scene_entity(world, id).unwrap();
                    world.get::<Transform>(entity).unwrap().translation.y
                });
                for (height, expected) in heights.into_iter().zip([0.5, 1.5, 0.5, 1.5]) {
                    let text = format!("{heights:?} from {above}, {selected:?}");
                    assert!((height - expected).abs() < 1e-4, "{text}");
                }
                assert!(undo(world).is_some());
                app.update();
                app.update();
            }
        }
        let entity = scene_entity(app.world(), stays).unwrap();
        let place = app.world().get::<Transform>(entity).unwrap();
        assert_eq!(place.translation.y, 0.5);
    }

    /// A cube whose sides are 1 m.
    fn add_cube(world: &mut World, place: Vec3) -> SceneId {
        let cube = Addition::Shape("Cuboid".into());
        let at = AddAt {
            place,
            ..AddAt::default()
        };
        add(world, &cube, at).unwrap()
    }
}
