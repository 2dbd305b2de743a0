//! Bevy's lights as ours.

use super::Mapped;
use super::returned::Returned;
use crate::scene::{Cone, DirectionalLamp, NotTraced, ParallelogramLamp, PointLamp};
use crate::sync::LeftOut;
use crate::view::TracedView;
use crate::view::raster::RasterTwin;
use bevy::camera::Exposure;
use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::query::QueryFilter;
use bevy::ecs::schedule::ScheduleConfigs;
use bevy::ecs::system::ScheduleSystem;
use bevy::light::{DirectionalLight, PointLight, RectLight, SpotLight};
use bevy::math::Vec3;
use bevy::prelude::{
    Commands, Component, DetectChanges, DetectChangesMut, Entity, IntoScheduleConfigs, Or, Query,
    Ref, RemovedComponents, Res, ResMut, Resource, With, Without,
};
use bevy::transform::components::GlobalTransform;
use std::f32::consts::PI;

/// What is left at the end of a light's range is named where it is more than this radiance of a white
/// surface: a level of 255 or two.
const SEEN: f32 = 0.005;

/// What the cameras multiply light by.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub(super) struct ViewExposure(pub f32);

impl Default for ViewExposure {
    fn default() -> Self {
        Self(Exposure::default().exposure())
    }
}

/// Of several views the first counts: there is one light for all.
pub(super) fn read_exposure(
    views: Query<(Entity, &Exposure), With<TracedView>>,
    mut exposure: ResMut<ViewExposure>,
    mut left_out: ResMut<LeftOut>,
) {
    let first = views.iter().min_by_key(|(view, _)| view.index_u32());
    let first = first.map(|(_, exposure)| ViewExposure(exposure.exposure()));
    let wanted = first.unwrap_or_default();
    exposure.set_if_neq(wanted);
    for (view, exposure) in &views {
        let other = exposure.exposure() != wanted.0;
        let what = "its exposure is left out: light is as bright as in the first view";
        let what = other.then(|| what.to_owned());
        LeftOut::note(&mut left_out, "exposure", view, what.into_iter().collect());
    }
}

/// One for each kind of light.
pub(super) fn systems() -> ScheduleConfigs<ScheduleSystem> {
    (
        map_lights::<PointLight, PointLamp>,
        map_lights::<SpotLight, PointLamp>,
        map_lights::<DirectionalLight, DirectionalLamp>,
        map_lights::<RectLight, ParallelogramLamp>,
    )
        .chain()
}

/// A light of Bevy's that one of ours can stand for.
trait Maps<Ours>: Component {
    /// Who has one of those that ours stands for.
    type Kept: QueryFilter + 'static;

    /// With what light is multiplied by, and by how much its transform enlarges what lies in its XY plane.
    fn lamp(&self, exposure: f32, enlarged: f32) -> Ours;

    /// What the tracer has nothing for.
    fn left_out(&self, exposure: f32) -> Vec<String>;
}

/// W/sr for the lumens of a light that shines all around.
fn intensity(lumens: f32, exposure: f32) -> f32 {
    lumens / (4.0 * PI) * exposure
}

/// What is said of shadows that Bevy would not draw, and of a light that ends where it would be seen.
fn named(shadows: bool, range: Option<(f32, f32)>) -> Vec<String> {
    let mut named = Vec::new();
    if !shadows {
        named.push("its shadow_maps_enabled is left out: everything casts shadows".into());
    }
    if let Some((range, intensity)) = range
        && intensity / (PI * range * range) > SEEN
    {
        named.push(format!(
            "its range of {range} m is left out: light has no end"
        ));
    }
    named
}

type PointOrSpot = Or<(With<PointLight>, With<SpotLight>)>;

impl Maps<PointLamp> for PointLight {
    type Kept = PointOrSpot;

    fn lamp(&self, exposure: f32, _: f32) -> PointLamp {
        PointLamp {
            color: self.color.into(),
            intensity: intensity(self.intensity, exposure),
            cone: None,
        }
    }

    fn left_out(&self, exposure: f32) -> Vec<String> {
        let end = (self.range, intensity(self.intensity, exposure));
        named(self.shadow_maps_enabled, Some(end))
    }
}

impl Maps<PointLamp> for SpotLight {
    type Kept = PointOrSpot;

    fn lamp(&self, exposure: f32, _: f32) -> PointLamp {
        PointLamp {
            color: self.color.into(),
            intensity: intensity(self.intensity, exposure),
            cone: Some(Cone {
                inner: self.inner_angle,
                outer: self.outer_angle,
            }),
        }
    }

    fn left_out(&self, exposure: f32) -> Vec<String> {
        let end = (self.range, intensity(self.intensity, exposure));
        named(self.shadow_maps_enabled, Some(end))
    }
}

impl Maps<DirectionalLamp> for DirectionalLight {
    type Kept = With<Self>;

    fn lamp(&self, exposure: f32, _: f32) -> DirectionalLamp {
        DirectionalLamp {
            color: self.color.into(),
            intensity: self.illuminance * exposure,
            ..DirectionalLamp::default()
        }
    }

    fn left_out(&self, _: f32) -> Vec<String> {
        named(self.shadow_maps_enabled, None)
    }
}

impl Maps<ParallelogramLamp> for RectLight {
    type Kept = With<Self>;

    fn lamp(&self, exposure: f32, enlarged: f32) -> ParallelogramLamp {
        // The lumens are those of the light as it stands, however large.
        let area = (self.width * self.height * enlarged).max(f32::MIN_POSITIVE);
        // It faces -Z, and ours faces where the product of its edges points.
        ParallelogramLamp {
            corner: Vec3::new(0.5 * self.width, -0.5 * self.height, 0.0),
            edges: [Vec3::NEG_X * self.width, Vec3::Y * self.height],
            colors: [self.color.into(); 4],
            intensity: self.intensity / (PI * area) * exposure,
            visible: false,
            ..ParallelogramLamp::default()
        }
    }

    fn left_out(&self, exposure: f32) -> Vec<String> {
        // A cosine emitter is π times as strong along its axis as its flux says.
        let end = (self.range, self.intensity / PI * exposure);
        let mut named = named(true, Some(end));
        named.push("Bevy draws its light without shadows: here everything casts them".into());
        named
    }
}

type Unmapped = (Without<RasterTwin>, Without<NotTraced>);

type Lights<'w, 's, Theirs, Ours> = Query<
    'w,
    's,
    (
        Entity,
        Ref<'static, Theirs>,
        Option<Ref<'static, GlobalTransform>>,
        Option<&'static Mapped<Ours>>,
    ),
    Unmapped,
>;

fn map_lights<Theirs: Maps<Ours>, Ours: Component + Clone + PartialEq>(
    mut commands: Commands,
    exposure: Res<ViewExposure>,
    lights: Lights<Theirs, Ours>,
    mut gone: RemovedComponents<Theirs>,
    kept: Query<(), Or<(With<RasterTwin>, Theirs::Kept)>>,
    mut returned: Returned,
    mut left_out: ResMut<LeftOut>,
) {
    for entity in gone.read() {
        if kept.contains(entity) {
            continue;
        }
        LeftOut::note(&mut left_out, "light", entity, Vec::new());
        if let Ok(mut entity) = commands.get_entity(entity) {
            entity.try_remove::<(Ours, Mapped<Ours>)>();
        }
    }
    for entity in returned.no_longer() {
        LeftOut::note(&mut left_out, "light", entity, Vec::new());
    }
    let returned: EntityHashSet = returned.read().collect();
    for (entity, theirs, place, mapped) in &lights {
        let has_moved = place.as_ref().is_some_and(|place| place.is_changed());
        let is_known = !theirs.is_changed() && !exposure.is_changed() && !has_moved;
        if is_known && !returned.contains(&entity) {
            continue;
        }
        LeftOut::note(&mut left_out, "light", entity, theirs.left_out(exposure.0));
        let enlarged = place.map_or(1.0, |place| {
            let axes = place.affine().matrix3;
            axes.x_axis.cross(axes.y_axis).length()
        });
        let ours = theirs.lamp(exposure.0, enlarged);
        if mapped.is_none_or(|mapped| mapped.0 != ours) {
            commands.entity(entity).insert((ours.clone(), Mapped(ours)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::StandardMappingPlugin;
    use super::*;
    use bevy::image::Image;
    use bevy::pbr::StandardMaterial;
    use bevy::prelude::{App, ClearColor, Transform};

    fn exposure() -> f32 {
        ViewExposure::default().0
    }

    #[test]
    fn a_rectangle_faces_where_bevys_does_and_sends_out_all_its_lumens() {
        let light = RectLight {
            width: 2.0,
            height: 3.0,
            intensity: 600.0,
            ..RectLight::default()
        };
        let lamp = light.lamp(exposure(), 1.0);
        let normal = lamp.edges[0].cross(lamp.edges[1]).normalize();
        assert_eq!(normal, Vec3::NEG_Z);
        let middle = lamp.corner + 0.5 * (lamp.edges[0] + lamp.edges[1]);
        assert_eq!(middle, Vec3::ZERO);
        // A cosine emitter's flux is π · radiance · area.
        let flux = PI * lamp.intensity * 6.0 / exposure();
        assert!((flux - 600.0).abs() < 1e-3, "{flux} lumens");
    }

    #[test]
    fn a_rectangle_that_its_transform_enlarges_sends_out_the_same_lumens() {
        let mut app = app();
        app.add_plugins(bevy::transform::TransformPlugin);
        let place = Transform::from_scale(Vec3::new(2.0, 3.0, 7.0));
        let light = (RectLight::default(), place);
        let light = app.world_mut().spawn(light).id();
        app.update();
        let strength = |app: &App| {
            app.world()
                .get::<ParallelogramLamp>(light)
                .unwrap()
                .intensity
        };
        let large = strength(&app);
        let mut place = app.world_mut().get_mut::<Transform>(light).unwrap();
        place.scale = Vec3::ONE;
        app.update();
        let ratio = strength(&app) / large;
        assert!((ratio - 6.0).abs() < 1e-4, "{ratio} times as bright");
    }

    fn app() -> App {
        let mut app = App::new();
        app.add_plugins((bevy::asset::AssetPlugin::default(), StandardMappingPlugin))
            .init_resource::<ClearColor>()
            .init_resource::<crate::scene::Environment>()
            .init_resource::<crate::scene::EnvironmentMap>();
        bevy::asset::AssetApp::init_asset::<StandardMaterial>(&mut app);
        bevy::asset::AssetApp::init_asset::<Image>(&mut app);
        bevy::asset::AssetApp::init_asset::<bevy::mesh::Mesh>(&mut app);
        app
    }

    fn strength(app: &App, lamp: Entity) -> f32 {
        app.world().get::<PointLamp>(lamp).unwrap().intensity
    }

    #[test]
    fn an_edit_of_ours_stays_until_bevys_is_edited_too() {
        let mut app = app();
        let lamp = app.world_mut().spawn(PointLight::default()).id();
        app.update();
        let mut ours = app.world_mut().get_mut::<PointLamp>(lamp).unwrap();
        ours.intensity = 7.0;
        // What the lamp does not depend on.
        let mut light = app.world_mut().get_mut::<PointLight>(lamp).unwrap();
        light.shadow_maps_enabled = true;
        app.update();
        assert_eq!(strength(&app, lamp), 7.0);
        let mut light = app.world_mut().get_mut::<PointLight>(lamp).unwrap();
        light.intensity = 4.0 * PI / exposure();
        app.update();
        let now = strength(&app, lamp);
        assert!((now - 1.0).abs() < 1e-5, "{now} W/sr");
    }

    #[test]
    fn light_is_as_bright_as_the_first_views_exposure_makes_it() {
        let mut app = app();
        let lamp = app.world_mut().spawn(PointLight::default()).id();
        app.update();
        let before = strength(&app, lamp);
        let darker = Exposure {
            ev100: Exposure::default().ev100 + 1.0,
        };
        app.world_mut().spawn((TracedView::default(), darker));
        app.update();
        let now = strength(&app, lamp);
        assert!((before / now - 2.0).abs() < 1e-4, "{before} to {now}");
    }

    #[test]
    fn a_range_is_named_where_the_light_would_still_be_seen_beyond_it() {
        let faint = PointLight {
            intensity: 1000.0,
            shadow_maps_enabled: true,
            ..PointLight::default()
        };
        assert!(faint.left_out(exposure()).is_empty());
        let bright = PointLight {
            intensity: 10_000_000.0,
            ..faint
        };
        assert_eq!(bright.left_out(exposure()).len(), 1);
        let shadowless = DirectionalLight {
            shadow_maps_enabled: false,
            ..DirectionalLight::default()
        };
        assert_eq!(shadowless.left_out(exposure()).len(), 1);
        let rectangle = RectLight {
            intensity: 100.0,
            ..RectLight::default()
        };
        let named = rectangle.left_out(exposure());
        assert!(
            named.len() == 1 && named[0].contains("shadows"),
            "{named:?}"
        );
    }
}
