//! What a Bevy app mostly names of Glassbox: `use glassbox::prelude::*;` beside Bevy's own, which has none of these names.

#[cfg(feature = "editor")]
pub use crate::editor::{Action, Editing, EditorPlugins, Selection, in_editor};
pub use crate::film::views::View;
pub use crate::film::{Ending, LightMix};
pub use crate::io::KeepInSceneFiles;
pub use crate::scene::{
    DirectionalLamp, Environment, EnvironmentMap, Features, Lens, MeshSource, Motion, NotTraced,
    Output, ParallelogramLamp, Phong, PhongMaps, PointLamp, Quantity, RenderSettings, Sampling,
    SceneCamera, SceneId, SegmentLamp, Shape, TextureSource, UsesMaterial, ViewTransform,
};
pub use crate::sync::{Traced, TracedCameras};
#[cfg(feature = "view")]
pub use crate::view::{
    AddTracedMaterial, Converged, Failed, GlassboxPlugins, Picked, ReferenceRendered,
    ShowsPictureOf, StandardMappingPlugin, TracedAs, TracedPicture, TracedRender, TracedView,
    ViewSettings, render_reference, traced_camera,
};

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::prelude::*;

    #[test]
    fn bevys_prelude_and_this_one_are_used_together() {
        // A name that both had would not compile here.
        let settings = RenderSettings {
            output: Output {
                view_transform: ViewTransform::AgX,
                ..default()
            },
            features: Features {
                textures: false,
                ..default()
            },
            sampling: Sampling::default(),
            ..default()
        };
        let mut world = World::new();
        world.insert_resource(settings);
        world.init_resource::<Environment>();
        world.init_resource::<EnvironmentMap>();
        world.spawn((SceneId(1), DirectionalLamp::default(), Motion::default()));
        world.spawn((SceneId(2), SegmentLamp::default(), NotTraced));
        world.spawn((PointLamp::default(), ParallelogramLamp::default()));
        let phong = Phong {
            diffuse_map: Some(TextureSource::new("builtin:checker")),
            ..default()
        };
        let shared = world.spawn((phong, PhongMaps::default())).id();
        let shape = MeshSource::Shape(Shape::Cuboid { size: Vec3::ONE });
        world.spawn((shape, UsesMaterial(shared)));
        let camera = world.spawn((SceneCamera::default(), Lens::default())).id();
        let (view, mix, ending) = (View::Normal, LightMix::default(), Ending::Samples);
        assert_ne!((view, ending), (View::default(), Ending::Time));
        #[cfg(feature = "view")]
        {
            let settings = ViewSettings {
                mix: mix.clone(),
                ..default()
            };
            let done = Converged {
                entity: camera,
                ending,
            };
            let twin = ShowsPictureOf(done.entity);
            let view = TracedView { view, ..default() };
            world.entity_mut(camera).insert((view, settings, twin));
            let as_grey: TracedAs = Phong::default().into();
            assert!(matches!(as_grey, TracedAs::Phong(..)));
        }
        assert!(mix == LightMix::default() && world.get::<Lens>(camera).is_some());
    }
}
