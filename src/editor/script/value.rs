//! Fields of components by their paths.

use super::super::edits::scene_entity;
use super::spot::named;
use super::step::Value;
use bevy::ecs::entity::Entity;
use bevy::ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy::ecs::world::World;
use bevy::reflect::enums::{DynamicEnum, DynamicVariant, VariantType};
use bevy::reflect::{GetPath, PartialReflect, Reflect, ReflectRef};

/// What the path leads to, as a script writes it.
pub(super) fn read(world: &mut World, of: Option<&str>, path: &str) -> Result<Value, String> {
    let (entity, reflect, field) = find(world, of, path)?;
    let component = reflect
        .reflect(world.entity(entity))
        .ok_or_else(|| lacks(of, path))?;
    Ok(value(at(component, &field, path)?))
}

/// Writes what the path leads to.
pub(super) fn write(
    world: &mut World,
    of: Option<&str>,
    path: &str,
    to: &Value,
) -> Result<(), String> {
    let (entity, reflect, field) = find(world, of, path)?;
    // Bevy panics where a component can only be replaced.
    let kind = path.split('.').next().unwrap_or(path);
    if !is_mutable(world, kind) {
        return Err(format!("{kind:?} cannot be written"));
    }
    let mut component = reflect
        .reflect_mut(world.entity_mut(entity))
        .ok_or_else(|| lacks(of, path))?;
    let place = component
        .reflect_path_mut(field.as_str())
        .map_err(|_| format!("there is no field {path:?}"))?;
    assign(place, to).map_err(|wanted| format!("{path:?} wants {wanted}"))
}

fn is_mutable(world: &World, kind: &str) -> bool {
    let registry = world.resource::<AppTypeRegistry>().read();
    let id = registry.get_with_short_type_path(kind).map(|r| r.type_id());
    let info = id
        .and_then(|id| world.components().get_id(id))
        .and_then(|id| world.components().get_info(id));
    info.is_none_or(|info| info.mutable())
}

fn lacks(of: Option<&str>, path: &str) -> String {
    format!(
        "{} has no such component: {path:?}",
        of.unwrap_or("the scene")
    )
}

/// The entity (that of a resource where no other is named), how to reach its component, and the
/// path within that.
fn find(
    world: &mut World,
    of: Option<&str>,
    path: &str,
) -> Result<(Entity, ReflectComponent, String), String> {
    let (kind, field) = path.split_once('.').unwrap_or((path, ""));
    let registration = {
        let registry = world.resource::<AppTypeRegistry>().read();
        registry
            .get_with_short_type_path(kind)
            .ok_or_else(|| format!("there is no type {kind:?}"))?
            .clone()
    };
    let entity = match of {
        Some(name) => {
            let id = named(world, name)?;
            scene_entity(world, id).ok_or_else(|| format!("there is no entity {name:?}"))?
        }
        None => world
            .components()
            .get_id(registration.type_id())
            .and_then(|id| world.resource_entities().get(id))
            .ok_or_else(|| format!("there is no resource {kind:?}"))?,
    };
    let reflect = registration
        .data::<ReflectComponent>()
        .ok_or_else(|| format!("{kind:?} is no component and no resource"))?;
    Ok((entity, reflect.clone(), field.to_owned()))
}

fn at<'a>(
    component: &'a dyn Reflect,
    field: &str,
    path: &str,
) -> Result<&'a dyn PartialReflect, String> {
    component
        .reflect_path(field)
        .map_err(|_| format!("there is no field {path:?}"))
}

fn number(field: &dyn PartialReflect) -> Option<f64> {
    macro_rules! any {
        ($($kind:ty)*) => {
            None$(.or_else(|| field.try_downcast_ref::<$kind>().map(|x| *x as f64)))*
        };
    }
    any!(f32 f64 u32 u64 i32 i64 usize u8)
}

fn value(field: &dyn PartialReflect) -> Value {
    if let Some(switch) = field.try_downcast_ref::<bool>() {
        return Value::Switch(*switch);
    }
    if let Some(number) = number(field) {
        return Value::Number(number);
    }
    if let Some(text) = field.try_downcast_ref::<String>() {
        return Value::Text(text.clone());
    }
    let numbers = |fields: &mut dyn Iterator<Item = &dyn PartialReflect>| {
        fields.map(number).collect::<Option<Vec<f64>>>()
    };
    let list = match field.reflect_ref() {
        ReflectRef::Enum(choice) if choice.variant_type() == VariantType::Unit => {
            return Value::Text(choice.variant_name().to_owned());
        }
        ReflectRef::Struct(fields) => {
            let mut fields = (0..fields.field_len()).filter_map(|i| fields.field_at(i));
            numbers(&mut fields)
        }
        ReflectRef::Array(list) => numbers(&mut list.iter()),
        ReflectRef::List(list) => numbers(&mut list.iter()),
        ReflectRef::TupleStruct(fields) => numbers(&mut fields.iter_fields()),
        _ => None,
    };
    list.map_or_else(|| Value::Text(format!("{field:?}")), Value::Numbers)
}

fn assign(field: &mut dyn PartialReflect, to: &Value) -> Result<(), String> {
    match to {
        Value::Switch(on) => match field.try_downcast_mut::<bool>() {
            Some(place) => *place = *on,
            None => return Err("no switch".into()),
        },
        Value::Number(number) => {
            if let Some(place) = field.try_downcast_mut::<f32>() {
                *place = *number as f32;
            } else if let Some(place) = field.try_downcast_mut::<u32>() {
                *place = *number as u32;
            } else {
                return Err("no number".into());
            }
        }
        Value::Text(text) => {
            if let Some(place) = field.try_downcast_mut::<String>() {
                text.clone_into(place);
            } else {
                let choice = DynamicEnum::new(text.clone(), DynamicVariant::Unit);
                field
                    .try_apply(&choice)
                    .map_err(|error| format!("something else: {error}"))?;
            }
        }
        Value::Numbers(numbers) => {
            let count = match field.reflect_mut() {
                bevy::reflect::ReflectMut::Struct(fields) => {
                    for (i, number) in numbers.iter().enumerate() {
                        let place = fields.field_at_mut(i).ok_or("fewer numbers")?;
                        assign(place, &Value::Number(*number))?;
                    }
                    fields.field_len()
                }
                bevy::reflect::ReflectMut::Array(list) => {
                    for (i, number) in numbers.iter().enumerate() {
                        let place = list.get_mut(i).ok_or("fewer numbers")?;
                        assign(place, &Value::Number(*number))?;
                    }
                    list.len()
                }
                _ => return Err("no list of numbers".into()),
            };
            if count != numbers.len() {
                return Err(format!("{count} numbers"));
            }
        }
    }
    Ok(())
}

impl Value {
    /// The same, numbers but for `within`.
    pub(super) fn is(&self, other: &Self, within: f64) -> bool {
        let near = |a: &f64, b: &f64| (a - b).abs() <= within;
        match (self, other) {
            (Self::Number(a), Self::Number(b)) => near(a, b),
            (Self::Numbers(a), Self::Numbers(b)) => {
                a.len() == b.len() && a.iter().zip(b).all(|(a, b)| near(a, b))
            }
            (a, b) => a == b,
        }
    }
}

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Self::Switch(on) => write!(f, "{on}"),
            Self::Number(number) => write!(f, "{number}"),
            Self::Text(text) => write!(f, "{text:?}"),
            Self::Numbers(numbers) => write!(f, "{numbers:?}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{PointLamp, SceneId};
    use bevy::ecs::name::Name;
    use bevy::transform::components::Transform;

    fn world() -> bevy::app::App {
        let mut app = crate::editor::headless_editor();
        app.world_mut().spawn((
            Name::new("Lamp"),
            SceneId(3),
            PointLamp::default(),
            Transform::from_xyz(1.0, 2.0, 3.0),
        ));
        app.update();
        app
    }

    #[test]
    fn fields_of_components_and_resources_are_read_and_written() {
        let mut app = world();
        let world = app.world_mut();
        let lamp = Some("Lamp");
        let place = read(world, lamp, "Transform.translation").unwrap();
        assert!(
            place.is(&Value::Numbers(vec![1.0, 2.0, 3.0]), 0.0),
            "{place}"
        );
        write(world, lamp, "PointLamp.intensity", &Value::Number(7.5)).unwrap();
        let intensity = read(world, lamp, "PointLamp.intensity").unwrap();
        assert!(intensity.is(&Value::Number(7.5), 0.0), "{intensity}");
        let path = "RenderSettings.lighting";
        write(world, None, path, &Value::Text("Classic".into())).unwrap();
        assert_eq!(read(world, None, path), Ok(Value::Text("Classic".into())));
        let path = "RenderSettings.size";
        write(world, None, path, &Value::Numbers(vec![64.0, 32.0])).unwrap();
        assert_eq!(
            read(world, None, path),
            Ok(Value::Numbers(vec![64.0, 32.0]))
        );
    }

    #[test]
    fn what_is_not_there_is_named() {
        let mut app = world();
        let world = app.world_mut();
        for (of, path, named) in [
            (Some("Nobody"), "Transform.scale", "Nobody"),
            (Some("Lamp"), "SegmentLamp.ends", "SegmentLamp"),
            (Some("Lamp"), "Transform.weight", "weight"),
            (None, "Nonsense.x", "Nonsense"),
            (None, "Transform.scale", "Transform"),
        ] {
            let error = read(world, of, path).unwrap_err();
            assert!(error.contains(named), "{error}");
        }
        let error = write(world, Some("Lamp"), "ChildOf.0", &Value::Number(1.0)).unwrap_err();
        assert!(error.contains("cannot be written"), "{error}");
        let wrong = Value::Text("Lunar".into());
        assert!(write(world, None, "RenderSettings.lighting", &wrong).is_err());
        assert!(write(world, Some("Lamp"), "Transform.scale", &Value::Switch(true)).is_err());
    }
}
