//! Handles in components of an app's own: a scene file says the paths of their assets, as the app's `AssetServer` knows
//! them.

use bevy::asset::{AssetPath, AssetServer, LoadFromPath, ReflectHandle, UntypedHandle};
use bevy::reflect::{PartialReflect, ReflectMut, TypeRegistry};
use std::any::TypeId;

/// Loads what a scene file names: assets of the kinds that the app's components have handles of.
pub(super) struct AppAssets<'a> {
    /// An app without one has no assets to name.
    pub server: Option<&'a AssetServer>,
    pub registry: &'a TypeRegistry,
}

impl LoadFromPath for AppAssets<'_> {
    fn load_from_path_erased(&mut self, kind: TypeId, path: AssetPath<'static>) -> UntypedHandle {
        let mut handles = (self.registry.iter()).filter_map(|kind| kind.data::<ReflectHandle>());
        // Bevy panics where a file names a kind that is none of assets.
        let is_known = handles.any(|handle| handle.asset_type_id() == kind);
        match self.server {
            Some(server) if is_known => server.load_builder().load_erased(kind, path),
            _ => UntypedHandle::default_for_type(kind),
        }
    }
}

/// Puts the default in the place of each handle whose asset has no path; whether there is one. No file can say which it was.
pub(super) fn forget_nameless(value: &mut dyn PartialReflect, registry: &TypeRegistry) -> bool {
    if let Some(concrete) = value.try_as_reflect()
        && let Some(kind) = registry.get_type_data::<ReflectHandle>(concrete.as_any().type_id())
        && let Some(handle) = kind.downcast_handle_untyped(concrete.as_any())
    {
        let is_nameless = matches!(handle, UntypedHandle::Strong(_)) && handle.path().is_none();
        if is_nameless {
            let none = UntypedHandle::default_for_type(kind.asset_type_id());
            if let Some(place) = value.try_as_reflect_mut() {
                // It fails only for a value of another type.
                let _ = place.set(kind.typed(none));
            }
        }
        return is_nameless;
    }
    let mut any = false;
    let mut forget = |part: Option<&mut dyn PartialReflect>| {
        any |= part.is_some_and(|part| forget_nameless(part, registry));
    };
    match value.reflect_mut() {
        ReflectMut::Struct(parts) => {
            (0..parts.field_len()).for_each(|i| forget(parts.field_at_mut(i)));
        }
        ReflectMut::TupleStruct(parts) => {
            (0..parts.field_len()).for_each(|i| forget(parts.field_mut(i)));
        }
        ReflectMut::Tuple(parts) => {
            (0..parts.field_len()).for_each(|i| forget(parts.field_mut(i)));
        }
        ReflectMut::Enum(parts) => {
            (0..parts.field_len()).for_each(|i| forget(parts.field_at_mut(i)));
        }
        ReflectMut::List(parts) => (0..parts.len()).for_each(|i| forget(parts.get_mut(i))),
        ReflectMut::Array(parts) => (0..parts.len()).for_each(|i| forget(parts.get_mut(i))),
        ReflectMut::Map(parts) => parts.retain(&mut |_, part| {
            forget(Some(part));
            true
        }),
        _ => {}
    }
    any
}

#[cfg(test)]
mod tests {
    use crate::app::headless_app;
    use crate::io::{KeepInSceneFiles, OpenOptions, SceneSource, open, open_new, save};
    use crate::scene::{PointLamp, SceneId};
    use bevy::app::App;
    use bevy::asset::{Asset, AssetApp, AssetServer, Assets, Handle};
    use bevy::ecs::component::Component;
    use bevy::ecs::reflect::ReflectComponent;
    use bevy::image::Image;
    use bevy::reflect::{Reflect, TypePath};
    use std::collections::BTreeMap;
    use std::path::Path;

    #[derive(Asset, TypePath)]
    struct Tune;

    /// Handles wherever a value can have them.
    #[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
    #[reflect(Component)]
    #[type_path = "band"]
    struct Plays {
        tune: Handle<Tune>,
        cover: Option<Handle<Image>>,
        later: Vec<Handle<Tune>>,
        pair: (u32, Handle<Tune>),
        by_name: BTreeMap<String, Handle<Tune>>,
    }

    fn app() -> App {
        let mut app = headless_app();
        app.init_asset::<Tune>().keep_in_scene_files::<Plays>();
        app
    }

    /// Saved by an app, opened by another one; what saving says, and what the other one has.
    fn reopened(mut app: App, plays: Plays, file: &Path) -> (Vec<String>, App, Plays) {
        open_new(app.world_mut());
        let lamp = (SceneId(7), PointLamp::default(), plays);
        app.world_mut().spawn(lamp);
        let notes = save(app.world_mut(), file).unwrap();
        let mut other = self::app();
        let source = SceneSource::File(file.to_path_buf());
        open(other.world_mut(), &source, OpenOptions::default()).unwrap();
        let mut found = other.world_mut().query::<&Plays>();
        let found = found.single(other.world()).unwrap().clone();
        (notes.lines(), other, found)
    }

    #[test]
    fn handles_of_an_apps_own_components_come_back_from_a_file_by_their_paths() {
        let folder = tempfile::tempdir().unwrap();
        let app = app();
        let assets = app.world().resource::<AssetServer>();
        let plays = Plays {
            tune: assets.load("a.tune"),
            cover: Some(assets.load("cover.png")),
            later: vec![assets.load("b.tune"), Handle::default()],
            pair: (3, assets.load("c.tune#solo")),
            by_name: BTreeMap::from([("encore".into(), assets.load("a.tune"))]),
        };
        let (notes, app, found) = reopened(app, plays, &folder.path().join("band.scn.ron"));
        assert_eq!(notes, Vec::<String>::new());
        let assets = app.world().resource::<AssetServer>();
        let same = Plays {
            tune: assets.get_handle("a.tune").unwrap(),
            cover: Some(assets.get_handle("cover.png").unwrap()),
            later: vec![assets.get_handle("b.tune").unwrap(), Handle::default()],
            pair: (3, assets.get_handle("c.tune#solo").unwrap()),
            by_name: BTreeMap::from([("encore".into(), assets.get_handle("a.tune").unwrap())]),
        };
        assert_eq!(found, same);
    }

    #[test]
    fn handles_of_assets_without_a_file_are_left_out_and_told_once() {
        let folder = tempfile::tempdir().unwrap();
        let mut app = app();
        let made = |app: &mut App| app.world_mut().resource_mut::<Assets<Tune>>().add(Tune);
        let plays = Plays {
            tune: made(&mut app),
            later: vec![made(&mut app)],
            pair: (3, made(&mut app)),
            by_name: BTreeMap::from([("encore".into(), made(&mut app))]),
            ..Plays::default()
        };
        let (notes, _, found) = reopened(app, plays.clone(), &folder.path().join("band.scn.ron"));
        assert_eq!(notes.len(), 1, "{notes:?}");
        assert!(notes[0].contains("Plays"), "{notes:?}");
        let none = Handle::<Tune>::default;
        let left = Plays {
            tune: none(),
            later: vec![none()],
            pair: (3, none()),
            by_name: BTreeMap::from([("encore".into(), none())]),
            ..plays
        };
        assert_eq!(found, left);
    }
}
