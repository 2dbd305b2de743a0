//! What is around a scene of Bevy's: its background, and light from all around.

use super::Mapped;
use crate::scene::{Environment, Phong, PhongMaps};
use crate::sync::LeftOut;
use crate::view::TracedView;
use bevy::camera::{Camera, ClearColor, ClearColorConfig, Projection};
use bevy::color::LinearRgba;
use bevy::light::{
    AtmosphereEnvironmentMapLight, EnvironmentMapLight, GeneratedEnvironmentMapLight,
    GlobalAmbientLight, IrradianceVolume, Skybox,
};
use bevy::pbr::DistanceFog;
use bevy::prelude::{Entity, Has, Local, Query, Res, ResMut, With};

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

type Around = (
    Has<Skybox>,
    Has<EnvironmentMapLight>,
    Has<GeneratedEnvironmentMapLight>,
    Has<AtmosphereEnvironmentMapLight>,
    Has<DistanceFog>,
    Has<IrradianceVolume>,
);

/// Names what surrounds a scene of Bevy's in its raster picture alone.
pub(super) fn name_surroundings(
    views: Query<(Entity, &Camera, &Projection, Around), With<TracedView>>,
    ambient: Option<Res<GlobalAmbientLight>>,
    mapped: OfBevy,
    mut left_out: ResMut<LeftOut>,
) {
    let is_of_bevy = !mapped.is_empty();
    let ambient = ambient.map_or(0.0, |ambient| ambient.brightness);
    let first = views.iter().map(|(view, ..)| view);
    let first = first.min_by_key(|view| view.index_u32());
    for (view, camera, projection, around) in &views {
        let (skybox, map, generated, of_atmosphere, fog, volume) = around;
        let notes = [
            (
                skybox,
                "its skybox is left out: set the map of `Environment`",
            ),
            (
                map || generated || of_atmosphere,
                "the light of its environment map is left out",
            ),
            (volume, "the light of its irradiance volume is left out"),
            (fog, "its fog is left out"),
            (
                matches!(projection, Projection::Custom(_)),
                "its projection is its own, which cannot be traced",
            ),
            (
                camera.sub_camera_view.is_some(),
                "its sub_camera_view is left out: the whole view is traced",
            ),
        ];
        let notes = notes.into_iter().filter(|(is_so, _)| *is_so);
        let mut notes: Vec<String> = notes.map(|(_, note)| note.into()).collect();
        if is_of_bevy && ambient > 0.0 && Some(view) == first {
            notes.push(format!(
                "the GlobalAmbientLight of {ambient} cd/m² is left out: what no light reaches is black"
            ));
        }
        LeftOut::note(&mut left_out, "view", view, notes);
    }
}
