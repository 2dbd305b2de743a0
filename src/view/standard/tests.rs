//! Scenes of Bevy's own components, in an app without a renderer.

mod poses;
mod rest;
mod sky;

use super::derived::DerivedPictures;
use super::{AddTracedMaterial, StandardMappingPlugin};
use crate::app::headless_app_with;
use crate::scene::{Alpha, Environment, Phong, PhongMaps};
use crate::sync::{LeftOut, Traced};
use crate::view::TracedView;
use bevy::asset::{Asset, AssetApp, RenderAssetUsages, uuid_handle};
use bevy::color::LinearRgba;
use bevy::ecs::entity_disabling::Disabled;
use bevy::light::{AmbientLight, GlobalAmbientLight, NotShadowCaster};
use bevy::pbr::{
    DistanceFog, ExtendedMaterial, Lightmap, Material, MaterialExtension, MeshMaterial3d,
    StandardMaterial,
};
use bevy::prelude::*;
use bevy::reflect::TypePath;
use bevy::render::render_resource::{AsBindGroup, Extent3d, TextureDimension, TextureFormat};

#[derive(Asset, AsBindGroup, TypePath, Clone, Debug)]
struct Water {
    depth: f32,
}

impl Material for Water {}

/// A picture of the app's.
const RIPPLES: Handle<Image> = uuid_handle!("0c3f6a52-6f0e-4a1f-9a54-7a5a1b7d9d6e");

#[derive(Asset, AsBindGroup, TypePath, Clone, Debug)]
struct Salty {}

impl MaterialExtension for Salty {}

fn app() -> App {
    let mut app = headless_app_with(StandardMappingPlugin);
    app.init_asset::<Water>()
        .register_type::<MeshMaterial3d<Water>>();
    app
}

fn add<A: Asset>(app: &mut App, asset: impl Into<A>) -> Handle<A> {
    app.world_mut().resource_mut::<Assets<A>>().add(asset)
}

fn object(app: &mut App) -> Entity {
    let mesh = add::<Mesh>(app, Cuboid::default());
    let material = add::<StandardMaterial>(app, Color::WHITE);
    let object = (Mesh3d(mesh), MeshMaterial3d(material), Transform::default());
    app.world_mut().spawn(object).id()
}

fn exposure() -> f32 {
    super::lights::ViewExposure::default().0
}

fn problems(app: &mut App) -> Vec<String> {
    app.update();
    app.update();
    let problems = &app.world().resource::<Traced>().problems;
    problems.iter().map(ToString::to_string).collect()
}

#[test]
fn what_objects_have_that_the_tracer_does_not_follow_is_named_while_they_have_it() {
    let mut app = app();
    let object = object(&mut app);
    assert_eq!(problems(&mut app), Vec::<String>::new());
    let flags = (NotShadowCaster, Lightmap::default());
    app.world_mut().entity_mut(object).insert(flags);
    let named = problems(&mut app);
    assert_eq!(named.len(), 2, "{named:#?}");
    assert!(
        named[0].starts_with("object 1: its NotShadowCaster"),
        "{named:#?}"
    );
    let mut flagged = app.world_mut().entity_mut(object);
    flagged.remove::<(NotShadowCaster, Lightmap)>();
    assert_eq!(problems(&mut app), Vec::<String>::new());
    app.world_mut().entity_mut(object).insert(NotShadowCaster);
    app.update();
    app.world_mut().entity_mut(object).despawn();
    assert_eq!(problems(&mut app), Vec::<String>::new());
}

#[test]
fn a_material_of_the_apps_own_is_named_until_a_function_says_how_it_is_traced() {
    let mut app = app();
    let mesh = add::<Mesh>(&mut app, Cuboid::default());
    let water = add::<Water>(&mut app, Water { depth: 0.25 });
    let object = (
        Mesh3d(mesh),
        MeshMaterial3d(water.clone()),
        Name::new("Sea"),
    );
    let object = app.world_mut().spawn(object).id();
    let named = problems(&mut app);
    assert_eq!(named.len(), 1, "{named:#?}");
    assert!(
        named[0].contains("\"Sea\"") && named[0].contains("Water"),
        "{named:#?}"
    );
    app.add_traced_material(|water: &Water| Phong {
        diffuse: LinearRgba::rgb(0.0, 0.0, water.depth),
        ..Phong::default()
    });
    assert_eq!(problems(&mut app), Vec::<String>::new());
    let blue = |app: &App| {
        app.world()
            .get::<Phong>(object)
            .map(|phong| phong.diffuse.blue)
    };
    assert_eq!(blue(&app), Some(0.25));
    let mut waters = app.world_mut().resource_mut::<Assets<Water>>();
    waters.get_mut(&water).unwrap().depth = 0.5;
    app.update();
    app.update();
    assert_eq!(blue(&app), Some(0.5));
}

#[test]
fn a_material_of_the_apps_own_is_traced_with_its_pictures_or_as_the_one_that_it_extends() {
    type Foam = ExtendedMaterial<StandardMaterial, Salty>;
    let mut app = app();
    app.init_asset::<Foam>()
        .register_type::<MeshMaterial3d<Foam>>();
    let picture = add::<Image>(&mut app, Image::default());
    let foam = Foam {
        base: StandardMaterial {
            base_color: Color::linear_rgb(0.0, 0.5, 0.0),
            base_color_texture: Some(picture),
            alpha_mode: AlphaMode::Mask(0.25),
            clearcoat: 1.0,
            ..default()
        },
        extension: Salty {},
    };
    let mesh = add::<Mesh>(&mut app, Cuboid::default());
    let foamy = MeshMaterial3d(add::<Foam>(&mut app, foam.clone()));
    let plain = MeshMaterial3d(add::<StandardMaterial>(&mut app, foam.base));
    let wet = MeshMaterial3d(add::<Water>(&mut app, Water { depth: 0.5 }));
    let objects = [
        app.world_mut().spawn((Mesh3d(mesh.clone()), foamy)).id(),
        app.world_mut().spawn((Mesh3d(mesh.clone()), plain)).id(),
        app.world_mut().spawn((Mesh3d(mesh), wet)).id(),
    ];
    app.add_traced_material(|foam: &Foam| foam.base.clone())
        .add_traced_material(|_: &Water| {
            let maps = PhongMaps {
                normal: Some(RIPPLES),
                ..default()
            };
            (Phong::default(), maps)
        });
    let named = problems(&mut app);
    let coats = named.iter().filter(|line| line.contains("clearcoat"));
    assert_eq!(coats.count(), 2, "{named:#?}");
    let world = app.world();
    let look = |object: Entity| {
        let phong = world.get::<Phong>(object).unwrap();
        (
            phong.clone(),
            world.get::<PhongMaps>(object).unwrap().clone(),
        )
    };
    let [foamy, plain, wet] = objects.map(look);
    assert_eq!(foamy, plain);
    assert_eq!(foamy.0.alpha, Alpha::Mask { cutoff: 0.25 });
    assert_eq!(wet.1.normal, Some(RIPPLES));
}

#[test]
fn a_mesh_of_the_gpu_alone_is_named_at_once() {
    let mut app = app();
    let mut mesh = Mesh::from(Cuboid::default());
    mesh.asset_usage = RenderAssetUsages::RENDER_WORLD;
    let mesh = add::<Mesh>(&mut app, mesh);
    app.world_mut().spawn(Mesh3d(mesh));
    app.update();
    let problems = &app.world().resource::<Traced>().problems;
    let named = problems.iter().map(ToString::to_string).collect::<String>();
    assert!(named.contains("MAIN_WORLD"), "{named}");
}

#[test]
fn a_views_surroundings_are_named() {
    let mut app = app();
    object(&mut app);
    app.insert_resource(GlobalAmbientLight::default());
    let view = (
        TracedView::default(),
        DistanceFog::default(),
        Name::new("Eye"),
    );
    app.world_mut().spawn(view);
    let named = problems(&mut app);
    assert_eq!(named.len(), 2, "{named:#?}");
    assert!(
        named[0].contains("Eye") && named[0].contains("fog"),
        "{named:#?}"
    );
    assert!(named[1].contains("GlobalAmbientLight"), "{named:#?}");
    // A camera's own takes the place of that of all.
    app.insert_resource(GlobalAmbientLight::NONE);
    let mut view = app
        .world_mut()
        .query_filtered::<Entity, With<DistanceFog>>();
    let view = view.single(app.world()).unwrap();
    let own = |brightness| AmbientLight {
        brightness,
        ..default()
    };
    app.world_mut().entity_mut(view).insert(own(50.0));
    let named = problems(&mut app);
    assert!(named[1].contains("its AmbientLight of 50"), "{named:#?}");
    app.insert_resource(GlobalAmbientLight::default());
    app.world_mut().entity_mut(view).insert(own(0.0));
    assert_eq!(problems(&mut app).len(), 1);
}

#[test]
fn what_is_derived_and_said_is_of_what_there_is_whatever_has_come_and_gone() {
    let mut app = app();
    let mut there = Vec::new();
    for i in 0..200_u8 {
        let picture = Image::new(
            Extent3d::default(),
            TextureDimension::D2,
            vec![i, i, i, 100],
            TextureFormat::Rgba8Unorm,
            RenderAssetUsages::default(),
        );
        let picture = Some(add(&mut app, picture));
        let material = StandardMaterial {
            base_color_texture: picture.clone(),
            metallic_roughness_texture: picture,
            alpha_mode: AlphaMode::Mask(0.5),
            ..default()
        };
        let material = add::<StandardMaterial>(&mut app, material);
        let mesh = add::<Mesh>(&mut app, Cuboid::default());
        let world = app.world_mut();
        let object = (Mesh3d(mesh), MeshMaterial3d(material), NotShadowCaster);
        there.push(world.spawn(object).id());
        there.push(world.spawn(PointLight::default()).id());
        there.push(
            world
                .spawn((TracedView::default(), DistanceFog::default()))
                .id(),
        );
        if i >= 10 {
            for entity in there.drain(..3) {
                world.despawn(entity);
            }
        }
        app.update();
    }
    // What a handle let go of is gone some frames later.
    problems(&mut app);
    let kept = |app: &App| {
        let world = app.world();
        let derived = world.resource::<DerivedPictures>().kept();
        [derived, world.resource::<LeftOut>().kept()]
    };
    // A mean and an alpha each; of an object its flag and its material, of a lamp and of a view one note.
    assert_eq!(kept(&app), [20, 40]);
    for entity in there {
        app.world_mut().despawn(entity);
    }
    problems(&mut app);
    problems(&mut app);
    assert_eq!(kept(&app), [0, 0]);
}

#[test]
fn of_a_view_or_a_light_that_is_gone_or_disabled_nothing_is_said_any_more() {
    let mut app = app();
    object(&mut app);
    let spawn = |app: &mut App| {
        let view = (TracedView::default(), DistanceFog::default());
        let light = (PointLight::default(), Transform::default());
        let world = app.world_mut();
        [world.spawn(view).id(), world.spawn(light).id()]
    };
    for how in ["despawned", "disabled", "removed"] {
        let [view, light] = spawn(&mut app);
        // The lamp's range and its lack of shadows, and the view's fog.
        let named = problems(&mut app);
        assert_eq!(named.len(), 3, "{named:#?}");
        let world = app.world_mut();
        match how {
            "despawned" => {
                world.despawn(view);
                world.despawn(light);
            }
            "disabled" => {
                world.entity_mut(view).insert(Disabled);
                world.entity_mut(light).insert(Disabled);
            }
            _ => {
                world.entity_mut(view).remove::<TracedView>();
                world.entity_mut(light).remove::<PointLight>();
            }
        }
        assert_eq!(problems(&mut app), Vec::<String>::new(), "{how}");
    }
}

#[test]
fn the_clear_colour_is_the_background_until_the_app_sets_another() {
    let mut app = app();
    let color = |app: &App| app.world().resource::<Environment>().background;
    app.insert_resource(ClearColor(Color::linear_rgb(0.0, 0.5, 1.0)));
    app.world_mut().spawn(TracedView::default());
    app.update();
    assert_eq!(
        color(&app),
        LinearRgba::BLACK,
        "a scene of ours has its own"
    );
    object(&mut app);
    app.update();
    app.update();
    assert_eq!(color(&app), LinearRgba::rgb(0.0, 0.5, 1.0));
    app.insert_resource(ClearColor(Color::linear_rgb(0.25, 0.0, 0.0)));
    app.update();
    assert_eq!(color(&app), LinearRgba::rgb(0.25, 0.0, 0.0));
    app.world_mut().resource_mut::<Environment>().background = LinearRgba::WHITE;
    app.insert_resource(ClearColor(Color::linear_rgb(0.5, 0.0, 0.0)));
    app.update();
    assert_eq!(color(&app), LinearRgba::WHITE);
}

#[test]
fn a_material_that_is_not_loaded_or_goes_is_named_and_what_wears_it_is_drawn_without() {
    let mut app = app();
    let object = object(&mut app);
    let worn = app.world().get::<MeshMaterial3d<StandardMaterial>>(object);
    let worn = worn.unwrap().0.clone();
    assert_eq!(problems(&mut app), Vec::<String>::new());
    assert!(app.world().get::<Phong>(object).is_some());
    let mut materials = app.world_mut().resource_mut::<Assets<StandardMaterial>>();
    let material = materials.remove(&worn).unwrap();
    let named = problems(&mut app);
    assert_eq!(
        named,
        ["material 1: its material is not loaded; drawn without it"]
    );
    assert!(app.world().get::<Phong>(object).is_none());
    let materials = app.world_mut().resource_mut::<Assets<StandardMaterial>>();
    let waits = materials.reserve_handle();
    let other = MeshMaterial3d(waits.clone());
    app.world_mut().entity_mut(object).insert(other);
    assert_eq!(problems(&mut app), named);
    let mut materials = app.world_mut().resource_mut::<Assets<StandardMaterial>>();
    materials.insert(waits.id(), material).unwrap();
    assert_eq!(problems(&mut app), Vec::<String>::new());
    assert!(app.world().get::<Phong>(object).is_some());
}
