use bevy::asset::{AssetId, Handle};
use bevy::ecs::component::Component;
use bevy::mesh::{Mesh, Mesh3d};

/// An object's mesh as it stands in this frame, where that is not as its asset has it: bent by a
/// skeleton, for example. It is traced in place of that of `Mesh3d`, in the same place.
#[derive(Component, Clone, Debug, PartialEq, Eq)]
#[component(clone_behavior = Ignore)]
pub struct PosedMesh(pub Handle<Mesh>);

/// Which mesh of an object is traced.
pub(super) fn traced_mesh((mesh, posed): (&Mesh3d, Option<&PosedMesh>)) -> AssetId<Mesh> {
    posed.map_or(mesh.id(), |posed| posed.0.id())
}
