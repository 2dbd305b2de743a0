//! What the tracer leaves out for a while.

use super::{app, exposure, object, problems};
use crate::scene::{NotTraced, Phong, PointLamp};
use bevy::ecs::entity_disabling::Disabled;
use bevy::light::NotShadowCaster;
use bevy::prelude::*;

/// One with an object and a lamp that the mapping has never met, or has met and knows well.
fn resting(rest: impl Fn(&mut EntityWorldMut), is_known: bool) -> (App, [Entity; 2]) {
    let mut app = app();
    let object = object(&mut app);
    let light = PointLight {
        shadow_maps_enabled: true,
        intensity: 100.0,
        ..default()
    };
    let light = app.world_mut().spawn((light, Transform::default())).id();
    if is_known {
        app.update();
    }
    for entity in [object, light] {
        rest(&mut app.world_mut().entity_mut(entity));
    }
    for _ in 0..3 {
        app.update();
    }
    (app, [object, light])
}

#[test]
fn what_was_spawned_or_edited_while_it_rested_is_traced_as_it_is_when_it_returns() {
    type Switch = fn(&mut EntityWorldMut);
    let switches: [(Switch, Switch); 2] = [
        (
            |entity| {
                entity.insert(Disabled);
            },
            |entity| {
                entity.remove::<Disabled>();
            },
        ),
        (
            |entity| {
                entity.insert(NotTraced);
            },
            |entity| {
                entity.remove::<NotTraced>();
            },
        ),
    ];
    for (how, (rest, wake)) in switches.into_iter().enumerate() {
        for is_known in [false, true] {
            let (mut app, [object, light]) = resting(rest, is_known);
            let worn = app.world().get::<MeshMaterial3d<StandardMaterial>>(object);
            let worn = worn.unwrap().0.id();
            let mut materials = app.world_mut().resource_mut::<Assets<StandardMaterial>>();
            materials
                .insert(worn, Color::linear_rgb(0.0, 0.5, 0.0).into())
                .unwrap();
            let mut theirs = app.world_mut().get_mut::<PointLight>(light).unwrap();
            theirs.intensity = 400.0;
            app.world_mut().entity_mut(object).insert(NotShadowCaster);
            for _ in 0..3 {
                app.update();
            }
            let case = format!("way {how}, known {is_known}");
            assert_eq!(problems(&mut app), Vec::<String>::new(), "{case}: it rests");
            for entity in [object, light] {
                wake(&mut app.world_mut().entity_mut(entity));
            }
            let named = problems(&mut app);
            assert!(
                named.len() == 1 && named[0].contains("NotShadowCaster"),
                "{case}: {named:#?}"
            );
            let phong = app.world().get::<Phong>(object);
            let green = phong.map(|phong| phong.diffuse.green);
            assert_eq!(green, Some(0.5), "{case}");
            let lamp = app.world().get::<PointLamp>(light);
            let strength = lamp.map(|lamp| lamp.intensity / exposure());
            let wanted = 400.0 / (4.0 * std::f32::consts::PI);
            let is_so = strength.is_some_and(|strength| (strength - wanted).abs() < 1e-3);
            assert!(is_so, "{case}: {strength:?}, not {wanted}");
            // Of what rests again nothing is said.
            for entity in [object, light] {
                rest(&mut app.world_mut().entity_mut(entity));
            }
            assert_eq!(
                problems(&mut app),
                Vec::<String>::new(),
                "{case}: it rests again"
            );
        }
    }
}
