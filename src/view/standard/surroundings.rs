//! What is around a scene of Bevy's: its background, and light from all around.

use super::Mapped;
use crate::scene::{Environment, Phong, PhongMaps};
use crate::sync::LeftOut;
use crate::view::TracedView;
use bevy::camera::{Camera, ClearColor, ClearColorConfig, Projection, ScalingMode};
use bevy::color::LinearRgba;
use bevy::light::{AmbientLight, AtmosphereEnvironmentMapLight, GlobalAmbientLight, LightProbe};
use bevy::pbr::DistanceFog;
use bevy::prelude::{Added, Entity, Has, Local, Query, RemovedComponents, Res, ResMut, With};
use bevy::transform::components::GlobalTransform;

/// Some object has a material of the app's: the scene is one of Bevy's.
type OfBevy<'w, 's> = Query<'w, 's, (), With<Mapped<(Phong, PhongMaps)>>>;

/// The colour that a view is cleared with is what stands behind the scene, unless the app has set
/// another background.
pub(super) fn map_background(
    clear: Option<Res<ClearColor>>,
    views: Query<(Entity, &Camera), With<TracedView>>,
    mapped: OfBevy,
    mut environment: ResMut<Environment>,
    mut last: Local<Option<LinearRgba>>,
) {
    let first = views.iter().min_by_key(|(view, _)| view.index_u32());
    let Some((_, camera)) = first.filter(|_| !mapped.is_empty()) else {
        return;
    };
    let color = match camera.clear_color {
        ClearColorConfig::Custom(color) => color,
        ClearColorConfig::Default => match clear {
            Some(clear) => clear.0,
            None => return,
        },
        ClearColorConfig::None => return,
    };
    let color = LinearRgba {
        alpha: 1.0,
        ..color.into()
    };
    if *last == Some(color) {
        return;
    }
    let ours = last.unwrap_or(Environment::default().background);
    if environment.background == ours && environment.map.is_none() {
        environment.background = color;
    }
    *last = Some(color);
}

/// Names views that lack what a view is looked through with, and says nothing more of those that are gone.
pub(super) fn name_incomplete(
    views: Query<(Entity, Has<Camera>, Has<GlobalTransform>, Has<Projection>), With<TracedView>>,
    mut gone: RemovedComponents<TracedView>,
    mut left_out: ResMut<LeftOut>,
) {
    for view in gone.read().filter(|view| !views.contains(*view)) {
        for kind in [
            "exposure",
            "picture of view",
            "film of view",
            "place of view",
            "sky of view",
            "view",
            "traced camera",
        ] {
            LeftOut::note(&mut left_out, kind, view, Vec::new());
        }
    }
    for (view, camera, place, projection) in &views {
        let lacks = [
            (camera, "its Camera is gone"),
            (place, "its place is gone: it has no GlobalTransform"),
            (projection, "its Projection is gone"),
        ];
        let lacks = lacks.into_iter().filter(|(is_there, _)| !is_there);
        let lacks = lacks.map(|(_, what)| format!("{what}; nothing is traced for it"));
        LeftOut::note(&mut left_out, "traced camera", view, lacks.collect());
    }
}

type Around = (
    Has<AtmosphereEnvironmentMapLight>,
    Has<DistanceFog>,
    Option<&'static AmbientLight>,
);

/// Names light of a part of the scene alone.
pub(super) fn name_probes(
    probes: Query<Entity, Added<LightProbe>>,
    mut gone: RemovedComponents<LightProbe>,
    mut left_out: ResMut<LeftOut>,
) {
    for probe in gone.read() {
        LeftOut::note(&mut left_out, "light probe", probe, Vec::new());
    }
    for probe in &probes {
        let what = "its light is left out: a sky is around all".to_owned();
        LeftOut::note(&mut left_out, "light probe", probe, vec![what]);
    }
}

/// Whether what a camera sees fills its viewport only by being stretched, by more than a pixel in a thousand.
fn is_stretched(camera: &Camera, projection: &Projection) -> bool {
    let Projection::Orthographic(projection) = projection else {
        return false;
    };
    let ScalingMode::Fixed { width, height } = projection.scaling_mode else {
        return false;
    };
    let viewport = camera.physical_viewport_size().map(|size| size.as_vec2());
    viewport.is_some_and(|viewport| {
        (width * viewport.y - height * viewport.x).abs() > 1e-3 * (height * viewport.x).abs()
    })
}

/// Names what surrounds a scene of Bevy's in its raster picture alone.
pub(super) fn name_surroundings(
    views: Query<(Entity, &Camera, &Projection, Around), With<TracedView>>,
    ambient: Option<Res<GlobalAmbientLight>>,
    mapped: OfBevy,
    mut left_out: ResMut<LeftOut>,
) {
    let is_of_bevy = !mapped.is_empty();
    let all_around = ambient.map_or(0.0, |ambient| ambient.brightness);
    let everywhere = |own: Option<&AmbientLight>| own.is_none() && all_around > 0.0;
    let first = views.iter().filter(|(.., around)| everywhere(around.2));
    let first = first
        .map(|(view, ..)| view)
        .min_by_key(|view| view.index_u32());
    for (view, camera, projection, around) in &views {
        let (of_atmosphere, fog, ambient) = around;
        let notes = [
            (of_atmosphere, "the light of its atmosphere is left out"),
            (fog, "its fog is left out"),
            (
                matches!(projection, Projection::Custom(_)),
                "its projection is its own, which cannot be traced",
            ),
            (
                is_stretched(camera, projection),
                "its ScalingMode::Fixed has other proportions than its viewport: it is traced as high as that says, and not stretched",
            ),
            (
                camera.sub_camera_view.is_some(),
                "its sub_camera_view is left out: the whole view is traced",
            ),
        ];
        let notes = notes.into_iter().filter(|(is_so, _)| *is_so);
        let mut notes: Vec<String> = notes.map(|(_, note)| note.into()).collect();
        let unlit = "is left out: what no light reaches is black";
        match ambient {
            Some(own) if is_of_bevy && own.brightness > 0.0 => {
                notes.push(format!(
                    "its AmbientLight of {} cd/m² {unlit}",
                    own.brightness
                ));
            }
            // It is one for all.
            None if is_of_bevy && Some(view) == first => {
                notes.push(format!(
                    "the GlobalAmbientLight of {all_around} cd/m² {unlit}"
                ));
            }
            _ => {}
        }
        LeftOut::note(&mut left_out, "view", view, notes);
    }
}
