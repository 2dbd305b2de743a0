//! A model in a scene that is there already: how large it becomes, what it stands on, and what comes along with it.

use super::parents::with_descendants;
use super::plugin::step;
use super::selecting::select;
use super::{AddAt, add_model, name_of, scene_entity};
use crate::editor::command::{Command, State, commands, flip};
use crate::editor::extent::{Extent, extent_now, scene_extent};
use crate::editor::notice::Notices;
use crate::editor::pick;
use crate::editor::preferences::{ImportPlace, Preferences};
use crate::editor::texts::{counted, file_name};
use crate::editor::viewport::Viewport;
use crate::io::FileError;
use crate::scene::{
    DirectionalLamp, ParallelogramLamp, PointLamp, SceneCamera, SceneId, SegmentLamp,
};
use bevy::ecs::entity::Entity;
use bevy::ecs::event::Event;
use bevy::ecs::hierarchy::Children;
use bevy::ecs::query::With;
use bevy::ecs::world::World;
use bevy::math::{Vec2, Vec3};
use bevy::mesh::Mesh3d;
use bevy::transform::components::Transform;
use std::path::Path;

/// How steep a surface may be that a model is put on: the cosine of its slope.
const LEVEL: f32 = 0.7;

/// A model was added and stands somewhere.
#[derive(Event, Clone, Copy, Debug)]
pub(in crate::editor) struct ModelAdded {
    /// The room that it takes.
    pub extent: Extent,
    /// It was fitted to the view, and is seen.
    pub is_fitted: bool,
}

pub(super) fn commands() -> Vec<Command> {
    commands! {
        "import.fitted" "Fitted to the view" [] "Models that are imported become about a quarter as high as the view, and stand on what is dropped on or looked at"
            => |world| put(world, ImportPlace::Fitted); menu("Add/Imported models", 1); state(|world| is(world, ImportPlace::Fitted)),
        "import.file-scale" "As large as the file has them" [] "Models that are imported keep their size, and stand on what is dropped on or looked at"
            => |world| put(world, ImportPlace::FileScale); menu("Add/Imported models", 1); state(|world| is(world, ImportPlace::FileScale)),
        "import.file-place" "Where the file has them" [] "Models that are imported keep their size and their place"
            => |world| put(world, ImportPlace::FilePlace); menu("Add/Imported models", 1); state(|world| is(world, ImportPlace::FilePlace)),
        "import.lights" "Lights and cameras come along" [] "What a model file has besides its objects is added too"
            => |world| flip(&mut world.resource_mut::<Preferences>().import_lights); menu("Add/Imported models", 2); state(|world| State::switch(world.get_resource::<Preferences>().is_some_and(|all| all.import_lights))),
    }
}

fn put(world: &mut World, place: ImportPlace) {
    world.resource_mut::<Preferences>().import_place = place;
}

fn is(world: &World, place: ImportPlace) -> State {
    let now = world.get_resource::<Preferences>();
    State::switch(now.is_some_and(|now| now.import_place == place))
}

/// Adds a model's content to the scene, as a step, and selects it. `at` is where in the window it was dropped, in logical
/// pixels; the middle of the view where it was not.
pub(in crate::editor) fn import(
    world: &mut World,
    file: &Path,
    at: Option<Vec2>,
) -> Result<(), FileError> {
    let mut result = Ok(());
    step(world, |world| match add_file(world, file, at) {
        Ok(name) => Some(name),
        Err(error) => {
            result = Err(error);
            None
        }
    });
    result
}

fn add_file(world: &mut World, file: &Path, at: Option<Vec2>) -> Result<String, FileError> {
    let mut objects = world.query_filtered::<(), With<Mesh3d>>();
    let is_first = objects.iter(world).next().is_none();
    let (root, imported) = add_model(world, file)?;
    let name = file_name(file);
    let (place, with_lights) = match world.get_resource::<Preferences>() {
        // What is alone stands where it stands: there is nothing that it could stand on.
        Some(all) if !is_first => (all.import_place, all.import_lights),
        Some(all) => (ImportPlace::FilePlace, all.import_lights),
        None => (ImportPlace::FilePlace, true),
    };
    let mut says = Vec::new();
    if let Some(root) = root.and_then(|root| scene_entity(world, root)) {
        let along = lights_and_cameras(world, root);
        if !along.is_empty() {
            let what = along_text(world, &along);
            let verb = if with_lights {
                "came along"
            } else {
                "were left out"
            };
            says.push(format!("{what} {verb} (Add, Imported models)"));
        }
        if !with_lights {
            leave_out(world, &along);
        }
        if let Some(extent) = extent_now(world, root) {
            says.extend(put_down(world, root, extent, place, at));
            let extent = extent_now(world, root).unwrap_or(extent);
            let is_fitted = place == ImportPlace::Fitted;
            world.trigger(ModelAdded { extent, is_fitted });
        }
    }
    let mut notices = world.resource_mut::<Notices>();
    notices.notes(&name, imported.notes.lines());
    if !says.is_empty() {
        notices.tell(format!("{name}: {}", says.join("; ")));
    }
    select(world, root.into_iter().collect());
    Ok(format!("Import {name}"))
}

fn is_camera(world: &World, entity: Entity) -> bool {
    world.get::<SceneCamera>(entity).is_some()
}

fn lights_and_cameras(world: &World, root: Entity) -> Vec<Entity> {
    let is_one = |entity: &Entity| {
        let entity = world.entity(*entity);
        entity.contains::<SceneCamera>()
            || entity.contains::<PointLamp>()
            || entity.contains::<DirectionalLamp>()
            || entity.contains::<SegmentLamp>()
            || entity.contains::<ParallelogramLamp>()
    };
    let all = with_descendants(world, root).into_iter();
    all.filter(is_one).collect()
}

fn along_text(world: &World, along: &[Entity]) -> String {
    let cameras = along.iter().filter(|one| is_camera(world, **one)).count();
    let lights = along.len() - cameras;
    let parts = [(lights, "light"), (cameras, "camera")];
    let parts = parts.into_iter().filter(|(count, _)| *count > 0);
    let parts: Vec<String> = parts
        .map(|(count, what)| counted(count as u64, what))
        .collect();
    parts.join(" and ")
}

/// Takes lights and cameras away; what others hang on stays as a place.
fn leave_out(world: &mut World, along: &[Entity]) {
    for &entity in along.iter().rev() {
        let mut entity = world.entity_mut(entity);
        match entity.get::<Children>().is_some_and(|all| !all.is_empty()) {
            false => entity.despawn(),
            true => {
                entity.remove::<(
                    SceneCamera,
                    PointLamp,
                    DirectionalLamp,
                    SegmentLamp,
                    ParallelogramLamp,
                )>();
            }
        }
    }
}

/// Puts a model where it is wanted, and says so.
fn put_down(
    world: &mut World,
    root: Entity,
    extent: Extent,
    place: ImportPlace,
    at: Option<Vec2>,
) -> Option<String> {
    let sides = extent.most - extent.least;
    let factor = match place {
        ImportPlace::FilePlace => return None,
        ImportPlace::FileScale => 1.0,
        ImportPlace::Fitted => world.resource::<AddAt>().size / sides.max_element(),
    };
    if !(factor.is_finite() && factor > 0.0) {
        return None;
    }
    let reach = 0.5 * factor * sides.x.max(sides.z);
    let (target, on) = landing(world, at, reach)?;
    let base = extent.centre().with_y(extent.least.y);
    let mut own = world.get_mut::<Transform>(root)?;
    let moved = Transform {
        translation: target + factor * (own.translation - base),
        rotation: own.rotation,
        scale: factor * own.scale,
    };
    if !moved.is_finite() {
        return None;
    }
    *own = moved;
    let on = on.map_or_else(String::new, |id| format!(" on {}", name_of(world, id)));
    Some(match place {
        ImportPlace::Fitted => format!("scaled by {} to fit, and put down{on}", digits(factor)),
        _ => format!("put down{on}"),
    })
}

/// With three digits that count.
fn digits(factor: f32) -> String {
    let after = (2.0 - factor.log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{factor:.after$}")
}

/// Where something stands that is put there in the window, or in the middle of the view, and on what. `reach` is how far it
/// stays away from a wall.
fn landing(world: &mut World, at: Option<Vec2>, reach: f32) -> Option<(Vec3, Option<SceneId>)> {
    let middle = world
        .get_resource::<Viewport>()
        .map(|view| view.rect.center());
    let ray = at.or(middle).and_then(|at| pick::ray(world, at));
    let seen = ray.and_then(|ray| pick::seen(world, ray.origin, *ray.direction));
    let above = match seen {
        Some(seen) if seen.normal.y >= LEVEL => return Some((seen.point, Some(seen.id))),
        Some(seen) => seen.point + reach * seen.normal,
        None => world.resource::<AddAt>().place,
    };
    if let Some(below) = pick::seen(world, above, Vec3::NEG_Y) {
        return Some((below.point, Some(below.id)));
    }
    let floor = scene_extent(world)?.least.y;
    Some((above.with_y(floor), None))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::headless_editor;
    use crate::editor::history::undo;
    use crate::io::{OpenOptions, SceneSource, builtin, open};
    use bevy::app::App;

    const MODEL: &str = "v 10 5 0\nv 14 5 0\nv 10 9 0\nv 10 5 2\nf 1 2 3\nf 1 2 4\n";

    fn with_model(place: ImportPlace) -> (App, tempfile::TempDir) {
        let mut app = headless_editor();
        let source = SceneSource::Builtin(builtin::find("cornell-box").unwrap());
        open(app.world_mut(), &source, OpenOptions::default()).unwrap();
        app.insert_resource(Preferences {
            import_place: place,
            ..Preferences::default()
        });
        // The view looks at the box from within, above the floor.
        app.insert_resource(AddAt {
            place: Vec3::new(-0.15, 0.4, 0.22),
            size: 0.1,
            ..AddAt::default()
        });
        app.update();
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("wedge.obj");
        std::fs::write(&file, MODEL).unwrap();
        import(app.world_mut(), &file, None).unwrap();
        (app, folder)
    }

    fn extent(app: &mut App) -> Extent {
        let selection = app
            .world()
            .resource::<crate::editor::selection::Selection>();
        let root = selection.active().expect("the model is selected");
        let root = scene_entity(app.world(), root).unwrap();
        extent_now(app.world(), root).unwrap()
    }

    #[test]
    fn a_model_is_fitted_to_the_view_and_stands_on_the_floor_below() {
        let (mut app, _folder) = with_model(ImportPlace::Fitted);
        let now = extent(&mut app);
        let sides = now.most - now.least;
        assert!((sides.max_element() - 0.1).abs() < 1e-4, "{now:?}");
        assert!(now.least.y.abs() < 1e-4, "{now:?}");
        let beside = (now.centre() - Vec3::new(-0.15, 0.4, 0.22))
            .with_y(0.0)
            .length();
        assert!(
            beside < 1e-3,
            "{now:?} is {beside} m beside what is looked at"
        );
        let objects = |app: &mut App| {
            let mut objects = app.world_mut().query::<&Mesh3d>();
            objects.iter(app.world()).count()
        };
        let with = objects(&mut app);
        assert!(undo(app.world_mut()).is_some(), "one step");
        assert_eq!(objects(&mut app), with - 1);
    }

    #[test]
    fn a_model_keeps_its_size_or_its_place_too_where_that_was_chosen() {
        let (mut app, _folder) = with_model(ImportPlace::FileScale);
        let now = extent(&mut app);
        assert!((now.most.x - now.least.x - 4.0).abs() < 1e-3, "{now:?}");
        assert!(now.least.y.abs() < 1e-3, "{now:?}");
        let (mut app, _folder) = with_model(ImportPlace::FilePlace);
        let now = extent(&mut app);
        let expected = [Vec3::new(10.0, 5.0, 0.0), Vec3::new(14.0, 9.0, 2.0)];
        assert_eq!([now.least, now.most], expected);
    }

    #[test]
    fn lights_and_cameras_are_counted_and_left_out_where_nobody_wants_them() {
        let mut world = World::new();
        let root = world.spawn(Transform::default()).id();
        let parent = (
            SceneId(1),
            PointLamp::default(),
            bevy::ecs::hierarchy::ChildOf(root),
        );
        let lamp = world.spawn(parent).id();
        let below = |world: &mut World, id, on| {
            let child = (SceneId(id), bevy::ecs::hierarchy::ChildOf(on));
            world.spawn(child).id()
        };
        let object = below(&mut world, 2, lamp);
        let camera = below(&mut world, 3, root);
        world.entity_mut(camera).insert(SceneCamera::default());
        let along = lights_and_cameras(&world, root);
        assert_eq!(along_text(&world, &along), "1 light and 1 camera");
        leave_out(&mut world, &along);
        assert!(world.get_entity(camera).is_err());
        assert!(
            world.get::<PointLamp>(lamp).is_none(),
            "what hangs on it stays"
        );
        assert!(world.get_entity(object).is_ok());
    }
}
