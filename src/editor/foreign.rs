//! Components that an app brings along: registered for reflection, and neither the scene's nor Bevy's.
//!
//! The editor shows and edits them by reflection alone, keeps them in its history and copies them. What goes into scene
//! files says [`KeepInSceneFiles`](crate::io::KeepInSceneFiles).

use bevy::ecs::reflect::{AppTypeRegistry, ReflectComponent, ReflectFromWorld};
use bevy::ecs::world::{EntityWorldMut, World};
use bevy::reflect::std_traits::ReflectDefault;
use bevy::reflect::{
    PartialReflect, Reflect, ReflectFromReflect, ReflectRef, TypeInfo, TypeRegistration,
    TypeRegistry,
};

/// Bevy's crates that register components, without `bevy_`: there are others that begin so.
const ENGINE: &str = "a11y animation anti_alias app asset audio camera clipboard color core_pipeline dev_tools ecs \
    feathers gizmos gizmos_render gltf image input input_focus light material mesh pbr picking post_process render \
    scene solari sprite sprite_render state text time transform ui ui_render ui_widgets window winit \
    world_serialization";

/// Whose component a type is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::editor) enum Origin {
    /// Of the scene, or of what draws and edits it.
    Glassbox,
    /// Derived by Bevy's own systems, or read by them.
    Engine,
    /// Of the app, or of another library.
    App,
}

/// Whose type it is, by the crate that it stands in.
pub(in crate::editor) fn origin(info: &TypeInfo) -> Origin {
    let name = info.type_path_table().crate_name().unwrap_or_default();
    let of_bevy = |name| ENGINE.split(' ').any(|engine| engine == name);
    match name.strip_prefix("bevy_") {
        _ if name == "glassbox" => Origin::Glassbox,
        Some(name) if of_bevy(name) => Origin::Engine,
        _ => Origin::App,
    }
}

/// The app's component types that an entity can be given a value of, in the order of their names.
pub(in crate::editor) fn foreign_kinds(world: &World) -> Vec<TypeRegistration> {
    let Some(registry) = world.get_resource::<AppTypeRegistry>() else {
        return Vec::new();
    };
    let registry = registry.read();
    let is_foreign = |kind: &&TypeRegistration| {
        kind.contains::<ReflectComponent>()
            && origin(kind.type_info()) == Origin::App
            && can_be_made(kind)
    };
    let mut kinds: Vec<TypeRegistration> = registry.iter().filter(is_foreign).cloned().collect();
    kinds.sort_by_key(|kind| kind.type_info().type_path());
    kinds
}

/// Whether a value that is reflected can become one of the type: Bevy panics where nothing can.
pub(in crate::editor) fn can_be_made(kind: &TypeRegistration) -> bool {
    kind.contains::<ReflectFromReflect>()
        || kind.contains::<ReflectDefault>()
        || kind.contains::<ReflectFromWorld>()
}

/// What a component of a type begins as; `None` where neither `Default` nor `FromWorld` is reflected.
pub(in crate::editor) fn first_value(
    world: &mut World,
    kind: &TypeRegistration,
) -> Option<Box<dyn Reflect>> {
    if let Some(default) = kind.data::<ReflectDefault>() {
        return Some(default.default());
    }
    let from_world = kind.data::<ReflectFromWorld>()?.clone();
    Some(from_world.from_world(world))
}

/// Gives an entity a component, in place where it has one that can be changed: what is not reflected of it stays.
pub(in crate::editor) fn put(
    entity: &mut EntityWorldMut,
    kind: &ReflectComponent,
    value: &dyn Reflect,
    registry: &TypeRegistry,
) {
    let id = value.as_any().type_id();
    let components = entity.world().components();
    let is_mutable = components
        .get_id(id)
        .and_then(|id| components.get_info(id))
        .is_some_and(|info| info.mutable());
    if is_mutable
        && let Some(mut place) = kind.reflect_mut(&mut *entity)
        && let Ok(copy) = value.reflect_clone()
    {
        // It fails only for a value of another type.
        let _ = place.set(copy);
        return;
    }
    // Bevy panics where it cannot make one.
    let value = value.as_partial_reflect();
    let can_be_made =
        registry
            .get(id)
            .is_some_and(|kind| match kind.data::<ReflectFromReflect>() {
                Some(make) if make.from_reflect(value).is_some() => true,
                _ => kind.contains::<ReflectDefault>() || kind.contains::<ReflectFromWorld>(),
            });
    if can_be_made {
        kind.insert(entity, value, registry);
    }
}

/// Whether two values of a type are the same to whoever edits them. A number that is none is the same as itself, or it
/// would change in every frame; of what cannot be compared nothing is known, and it counts as the same.
pub(in crate::editor) fn is_same(a: &dyn PartialReflect, b: &dyn PartialReflect) -> bool {
    match a.reflect_partial_eq(b) {
        Some(true) => true,
        // What a type says of itself holds, but for such numbers: its parts may know less.
        Some(false) => holds_nan(a) && are_parts_same(a, b),
        None => are_parts_same(a, b),
    }
}

/// Whether a number in a value is none.
fn holds_nan(value: &dyn PartialReflect) -> bool {
    match value.reflect_ref() {
        ReflectRef::Struct(fields) => fields.iter_fields().any(|(_, field)| holds_nan(field)),
        ReflectRef::TupleStruct(fields) => fields.iter_fields().any(holds_nan),
        ReflectRef::Tuple(fields) => fields.iter_fields().any(holds_nan),
        ReflectRef::List(items) => items.iter().any(holds_nan),
        ReflectRef::Array(items) => items.iter().any(holds_nan),
        ReflectRef::Enum(variant) => variant.iter_fields().any(|field| holds_nan(field.value())),
        ReflectRef::Map(map) => map.iter().any(|(_, value)| holds_nan(value)),
        _ => is_nan(value),
    }
}

fn is_nan(value: &dyn PartialReflect) -> bool {
    let of_f32 = value.try_downcast_ref::<f32>().is_some_and(|x| x.is_nan());
    of_f32 || value.try_downcast_ref::<f64>().is_some_and(|x| x.is_nan())
}

fn are_parts_same(a: &dyn PartialReflect, b: &dyn PartialReflect) -> bool {
    match (a.reflect_ref(), b.reflect_ref()) {
        (ReflectRef::Struct(a), ReflectRef::Struct(b)) => {
            let mut fields = a.iter_fields().zip(b.iter_fields());
            fields.all(|((_, a), (_, b))| is_same(a, b))
        }
        (ReflectRef::TupleStruct(a), ReflectRef::TupleStruct(b)) => {
            let mut fields = a.iter_fields().zip(b.iter_fields());
            fields.all(|(a, b)| is_same(a, b))
        }
        (ReflectRef::Tuple(a), ReflectRef::Tuple(b)) => {
            let mut fields = a.iter_fields().zip(b.iter_fields());
            fields.all(|(a, b)| is_same(a, b))
        }
        (ReflectRef::List(a), ReflectRef::List(b)) => {
            a.len() == b.len() && a.iter().zip(b.iter()).all(|(a, b)| is_same(a, b))
        }
        (ReflectRef::Array(a), ReflectRef::Array(b)) => {
            a.iter().zip(b.iter()).all(|(a, b)| is_same(a, b))
        }
        (ReflectRef::Enum(a), ReflectRef::Enum(b)) => {
            let mut fields = a.iter_fields().zip(b.iter_fields());
            a.variant_index() == b.variant_index()
                && fields.all(|(a, b)| is_same(a.value(), b.value()))
        }
        (ReflectRef::Map(a), ReflectRef::Map(b)) => {
            let is_in_b =
                |(key, a): (&dyn PartialReflect, _)| b.get(key).is_some_and(|b| is_same(a, b));
            a.len() == b.len() && a.iter().all(is_in_b)
        }
        // A set's items are found by their values.
        (ReflectRef::Set(a), ReflectRef::Set(b)) => {
            a.len() == b.len() && a.iter().all(|item| b.contains(item))
        }
        (ReflectRef::Opaque(_), ReflectRef::Opaque(_)) => {
            a.reflect_partial_eq(b).is_none() || (is_nan(a) && is_nan(b))
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::ecs::name::Name;
    use bevy::math::Vec3;
    use bevy::reflect::Reflect;
    use bevy::transform::components::Transform;
    use std::collections::HashMap;

    #[derive(Reflect, Clone, Default)]
    #[type_path = "bevy_orchard"]
    struct Mixed {
        place: Vec3,
        words: Vec<String>,
        by_name: HashMap<String, f64>,
        either: Option<(u8, f32)>,
    }

    #[test]
    fn other_names_differ_though_bevy_hides_their_letters() {
        let [a, b] = ["Lamp", "Sun"].map(Name::new);
        assert!(!is_same(&a, &b) && is_same(&a, &a.clone()));
    }

    #[test]
    fn what_holds_no_number_is_the_same_as_itself_and_any_other_value_is_another() {
        let mixed = Mixed {
            place: Vec3::new(1.0, f32::NAN, 2.0),
            words: vec!["a".into()],
            by_name: HashMap::from([("x".into(), f64::NAN)]),
            either: Some((1, f32::NAN)),
        };
        assert!(is_same(&mixed, &mixed.clone()));
        let others: [fn(&mut Mixed); 6] = [
            |mixed| mixed.place.y = 0.0,
            |mixed| mixed.words.push("b".into()),
            |mixed| mixed.words[0].push('b'),
            |mixed| *mixed.by_name.get_mut("x").unwrap() = 1.0,
            |mixed| mixed.either = None,
            |mixed| mixed.either = Some((2, f32::NAN)),
        ];
        for (i, change) in others.iter().enumerate() {
            let mut other = mixed.clone();
            change(&mut other);
            assert!(!is_same(&mixed, &other), "change {i}");
        }
    }

    #[test]
    fn whose_a_type_is_says_its_crate() {
        use bevy::reflect::Typed;
        assert_eq!(origin(Transform::type_info()), Origin::Engine);
        assert_eq!(origin(crate::scene::Motion::type_info()), Origin::Glassbox);
        assert_eq!(origin(Mixed::type_info()), Origin::App);
    }
}
