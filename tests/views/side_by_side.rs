//! What Bevy draws and what is traced of the same scene, by the same camera, region by region.

mod gltf;
mod named;
mod rows;
mod skies;

use super::{Game, SIZE, Shot};
use bevy::camera::Exposure;
use bevy::core_pipeline::tonemapping::{DebandDither, Tonemapping};
use bevy::light::Skybox;
use bevy::prelude::*;
use glassbox::prelude::*;

/// Pixels, as parts of a picture's width and height: left, top, right, bottom.
pub(super) type Part = [f32; 4];

/// Of two things side by side.
pub(super) const LEFT: Part = [0.1, 0.2, 0.42, 0.8];
pub(super) const RIGHT: Part = [0.58, 0.2, 0.9, 0.8];
pub(super) const ALL: Part = [0.05, 0.1, 0.95, 0.9];

/// A scene, which parts of its pictures are alike and how closely, and what is said to be left out.
struct Row {
    name: &'static str,
    build: fn(&mut Stage),
    alike: &'static [(Part, f32)],
    named: &'static [&'static str],
}

/// As bright but for samples and rounding.
const SAME: f32 = 1.04;

/// Each row's two pictures, and what is said of it.
fn compare(rows: &[Row]) {
    let Some(mut stage) = Stage::open(AssetPlugin::default()) else {
        return;
    };
    let mut faults = Vec::new();
    for row in rows {
        (row.build)(&mut stage);
        let (shots, problems) = stage.both();
        let parts = row.alike.iter();
        let others = parts.filter_map(|&(part, factor)| unlike(&shots, part, factor));
        faults.extend(others.map(|what| format!("{}: {what}", row.name)));
        let is_known = |problem: &&String| row.named.iter().any(|named| problem.contains(named));
        let unknown = problems.iter().filter(|problem| !is_known(problem));
        faults.extend(unknown.map(|problem| format!("{}: said {problem}", row.name)));
        for named in row.named {
            if !problems.iter().any(|problem| problem.contains(named)) {
                faults.push(format!("{}: nothing said {named:?}", row.name));
            }
        }
        stage.clear();
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

/// Darker than this is black: two levels of 255.
const BLACK: f32 = 0.0006;

/// A camera at the origin that looks down -Z at what rows of a test put up, and takes it away again.
pub(super) struct Stage {
    pub game: Game,
    pub camera: Entity,
}

/// What was put up.
#[derive(Component)]
struct Prop;

impl Stage {
    pub fn open(assets: AssetPlugin) -> Option<Self> {
        let mut game = Game::without_walls(assets)?;
        game.app.insert_resource(GlobalAmbientLight::NONE);
        let camera = game.camera(Dir3::NEG_Z, None, 0);
        let plain = (Tonemapping::None, DebandDither::Disabled, Msaa::Off);
        game.app.world_mut().entity_mut(camera).insert(plain);
        Some(Self { game, camera })
    }

    pub fn world(&mut self) -> &mut World {
        self.game.app.world_mut()
    }

    pub fn add<A: Asset>(&mut self, asset: impl Into<A>) -> Handle<A> {
        self.world().resource_mut::<Assets<A>>().add(asset)
    }

    pub fn put(&mut self, what: impl Bundle) -> Entity {
        self.world().spawn((Prop, what)).id()
    }

    /// Takes everything away that was put up.
    pub fn clear(&mut self) {
        let world = self.world();
        let mut props = world.query_filtered::<Entity, With<Prop>>();
        let props: Vec<Entity> = props.iter(world).collect();
        for prop in props {
            world.despawn(prop);
        }
        let camera = self.camera;
        let world = self.world();
        world.insert_resource(GlobalAmbientLight::NONE);
        world.insert_resource(ClearColor(Color::BLACK));
        let mut camera = world.entity_mut(camera);
        camera.remove::<(TracedView, Skybox, EnvironmentMapLight)>();
        camera.insert(Exposure::default());
    }

    /// What Bevy draws, and what is traced, and what is said to be left out.
    pub fn both(&mut self) -> ([Shot; 2], Vec<String>) {
        // Textures and shadows need some frames to reach the card.
        for _ in 0..8 {
            self.game.app.update();
        }
        let drawn = self.game.shot();
        let camera = self.camera;
        let how = ViewSettings {
            spp: Some(32),
            ..default()
        };
        self.world()
            .entity_mut(camera)
            .insert((TracedView::default(), how));
        self.game.wait_for_pictures();
        let traced = self.game.shot();
        let problems = &self.game.app.world().resource::<Traced>().problems;
        let problems = problems.iter().map(ToString::to_string).collect();
        ([drawn, traced], problems)
    }
}

impl Shot {
    /// The mean of a part, linear.
    pub fn mean(&self, [left, top, right, bottom]: Part) -> Vec3 {
        let x = |part: f32| (part * SIZE.x as f32).round() as u32;
        let y = |part: f32| (part * SIZE.y as f32).round() as u32;
        let places = (y(top)..y(bottom)).flat_map(|y| (x(left)..x(right)).map(move |x| (x, y)));
        let linear = |(x, y)| {
            let [r, g, b] = self.pixel(x, y);
            LinearRgba::from(Srgba::rgb_u8(r, g, b)).to_vec3()
        };
        let all: Vec<Vec3> = places.map(linear).collect();
        all.iter().sum::<Vec3>() / all.len() as f32
    }
}

/// How two pictures of a part differ, where it is not in samples and rounding alone, or by more than a
/// factor of brightness; of hue where that is larger, a share of all light that goes with it.
pub(super) fn unlike([drawn, traced]: &[Shot; 2], part: Part, factor: f32) -> Option<String> {
    let [a, b] = [drawn, traced].map(|shot| shot.mean(part));
    let [bright_a, bright_b] = [a, b].map(|c| c.element_sum() / 3.0);
    let is_alike = if bright_a < BLACK || bright_b < BLACK {
        bright_a.max(bright_b) < BLACK
    } else {
        let ratio = bright_b / bright_a;
        let hue = (a / bright_a - b / bright_b).abs().max_element() / 3.0;
        hue < 0.04 * factor && ratio < factor && ratio > 1.0 / factor
    };
    (!is_alike).then(|| format!("{part:?}: drawn {a:.3}, traced {b:.3}"))
}
