//! Handles as text: what an app's component has one of is named, and stays as it is.

use bevy::asset::{ReflectHandle, UntypedHandle};
use bevy::reflect::{PartialReflect, TypeRegistry};

/// The path of a handle's asset, or what there is to say of one without; `None` of what is no handle.
pub(super) fn asset_text(value: &dyn PartialReflect, registry: &TypeRegistry) -> Option<String> {
    let value = value.try_as_reflect()?.as_any();
    let kind = registry.get_type_data::<ReflectHandle>((*value).type_id())?;
    let handle = kind.downcast_handle_untyped(value)?;
    if let Some(path) = handle.path() {
        return Some(path.to_string());
    }
    let none = UntypedHandle::default_for_type(kind.asset_type_id());
    Some(match handle {
        handle if handle == none => "none".into(),
        UntypedHandle::Strong(_) => "made by the app".into(),
        UntypedHandle::Uuid { uuid, .. } => uuid.to_string(),
    })
}
