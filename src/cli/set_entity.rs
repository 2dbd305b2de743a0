//! `--set Lamp/PointLamp.intensity=3`: a component of a named entity by its reflected path.

use super::Failure;
use super::set::{Assignment, set_value};
use super::similar::unknown;
use crate::scene::{Phong, Property, SceneId, UsesMaterial, range_problems};
use bevy::ecs::entity::Entity;
use bevy::ecs::name::Name;
use bevy::ecs::query::With;
use bevy::ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy::ecs::world::World;
use bevy::reflect::{Access, ParsedPath, PartialReflect, ReflectPath, ReflectRef, TypeInfo};
use std::any::TypeId;

/// Writes the value into the component of every entity of that name.
///
/// # Errors
/// Says which entities, components or fields there are, or what the value may be.
pub(super) fn set_on_entity(world: &mut World, assignment: &Assignment) -> Result<(), Failure> {
    let (key, value) = assignment.parts();
    let usage = |why: String| Failure::Usage(format!("--set {assignment}: {why}"));
    let Some((name, path)) = key.rsplit_once('/') else {
        return Err(usage("it is written Entity/Component.field=value".into()));
    };
    let (component, path) = path.split_once('.').unwrap_or((path, ""));
    let entities = named(world, name)?;
    for entity in entities {
        set_one(world, entity, [name, component, path], value).map_err(usage)?;
    }
    Ok(())
}

fn named(world: &mut World, name: &str) -> Result<Vec<Entity>, Failure> {
    let mut all = world.query_filtered::<(Entity, &Name), With<SceneId>>();
    let found: Vec<Entity> = all
        .iter(world)
        .filter(|(_, other)| other.as_str() == name)
        .map(|(entity, _)| entity)
        .collect();
    if !found.is_empty() {
        return Ok(found);
    }
    let names = all.iter(world).map(|(_, name)| name.as_str());
    Err(Failure::Usage(unknown(
        &format!("--set {name}/…"),
        "entity",
        name,
        names,
    )))
}

fn set_one(
    world: &mut World,
    entity: Entity,
    [name, component, path]: [&str; 3],
    value: &str,
) -> Result<(), String> {
    let registry = world.resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let of_entity = world.entity(entity);
    let carried: Vec<_> = registry
        .iter()
        .filter_map(|kind| {
            let data = kind.data::<ReflectComponent>()?;
            data.reflect(of_entity).map(|_| (kind.type_info(), data))
        })
        .collect();
    let short = |info: &TypeInfo| info.type_path_table().short_path();
    let Some(&(info, data)) = carried.iter().find(|(info, _)| short(info) == component) else {
        let names = carried.iter().map(|(info, _)| short(info));
        let what = format!("component of {name}");
        return Err(unknown(component, &what, component, names));
    };
    if info.type_id() == TypeId::of::<Phong>()
        && let Some(UsesMaterial(material)) = world.get::<UsesMaterial>(entity)
    {
        let shared = world
            .get::<Name>(*material)
            .map_or("another entity's", Name::as_str);
        return Err(format!(
            "it shows the shared material `{shared}`: set {shared}/Phong.{path}"
        ));
    }
    let mut of_entity = world.entity_mut(entity);
    let Some(mut place) = data.reflect_mut(&mut of_entity) else {
        return Err(format!("{component} cannot be changed"));
    };
    let before = range_problems(place.as_partial_reflect());
    let path = through_variants(place.as_partial_reflect(), path);
    let property = Property::of_value(place.as_partial_reflect(), &path);
    let property = property.filter(|_| !path.is_empty());
    let root = place.as_partial_reflect_mut();
    let (Some(property), Ok(field)) = (property, path.as_str().reflect_element_mut(root)) else {
        let all = Property::all(info);
        let names = all.iter().map(|property| property.path.as_str());
        return Err(unknown(
            &path,
            &format!("field of {component}"),
            &path,
            names,
        ));
    };
    set_value(field, &property, value)?;
    let problems = range_problems(place.as_partial_reflect());
    match problems
        .into_iter()
        .find(|problem| !before.contains(problem))
    {
        Some(problem) => Err(problem.to_string()),
        None => Ok(()),
    }
}

/// A path as it is reflected: `cone.outer` goes through the option, `cone.0.outer`.
fn through_variants(root: &dyn PartialReflect, path: &str) -> String {
    let Ok(steps) = ParsedPath::parse(path) else {
        return path.to_owned();
    };
    let mut whole = Vec::new();
    for step in steps.0 {
        let here = ParsedPath(whole.clone());
        let is_tuple = here.reflect_element(root).is_ok_and(|value| {
            matches!(value.reflect_ref(), ReflectRef::Enum(value) if value.field_at(0).is_some()
                && value.name_at(0).is_none())
        });
        if is_tuple && matches!(step.access, Access::Field(_)) {
            whole.push(Access::TupleIndex(0).into());
        }
        whole.push(step);
    }
    ParsedPath(whole)
        .to_string()
        .trim_start_matches('.')
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::headless_app;
    use crate::scene::{Cone, MeshSource, PointLamp, Shape};
    use bevy::math::Vec3;
    use bevy::transform::components::Transform;

    #[test]
    fn a_component_of_a_named_entity_is_set_and_what_is_wrong_is_named() {
        let mut app = headless_app();
        let world = app.world_mut();
        let spot = PointLamp {
            cone: Some(Cone::default()),
            ..PointLamp::default()
        };
        let lamp = world.spawn((SceneId(1), Name::new("Lamp"), spot)).id();
        let ball = MeshSource::Shape(Shape::Sphere {
            radius: 1.0,
            segments: 8,
            rings: 4,
        });
        let ball = world.spawn((SceneId(2), Name::new("a/b=c"), ball)).id();
        let mut set = |text: &str| {
            let assignment: Assignment = text.parse().unwrap();
            let set = set_on_entity(world, &assignment);
            (
                set.map_err(|failure| failure.to_string()),
                world.entity(lamp).get().cloned(),
            )
        };
        assert_eq!(set("Lamp/PointLamp.intensity=3").0, Ok(()));
        assert_eq!(set("Lamp/PointLamp.color=1,.5,0").0, Ok(()));
        assert_eq!(set("Lamp/Transform.translation.x=10cm").0, Ok(()));
        assert_eq!(set("a/b=c/MeshSource.radius*=2").0, Ok(()));
        let (done, lamp_now) = set("Lamp/PointLamp.cone.outer=45deg");
        let lamp_now: PointLamp = lamp_now.unwrap();
        assert_eq!(done, Ok(()));
        assert_eq!(lamp_now.intensity, 3.0);
        assert_eq!(lamp_now.color.green, 0.5);
        assert_eq!(lamp_now.cone.unwrap().outer, std::f32::consts::FRAC_PI_4);
        for (text, part) in [
            (
                "Lmp/PointLamp.intensity=3",
                "no such entity; did you mean Lamp?",
            ),
            ("Lamp/Lens.samples=3", "no such component of Lamp"),
            ("Lamp/PointLamp.intensty=3", "did you mean intensity?"),
            ("Lamp/PointLamp.intensity=-1", "must be at least 0"),
            ("Lamp/PointLamp.cone.outer=2", "0 to π/2"),
            ("Lamp/PointLamp.color=1,2", "wanted 3 numbers"),
            ("Lamp/PointLamp=1", "no such field"),
        ] {
            let why = set(text).0.unwrap_err();
            assert!(why.contains(part), "`{text}` gives `{why}`");
        }
        let place = world.get::<Transform>(lamp).unwrap().translation;
        assert_eq!(place, Vec3::new(0.1, 0.0, 0.0));
        let MeshSource::Shape(Shape::Sphere { radius, .. }) = *world.get(ball).unwrap() else {
            panic!("it is a sphere");
        };
        assert_eq!(radius, 2.0);
    }
}
