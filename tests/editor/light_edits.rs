//! Five hundred random edits of a scene that is rendered meanwhile, some of them undone: as a view renders it.

use super::editor;
use bevy::app::App;
use bevy::color::LinearRgba;
use bevy::ecs::component::{Component, Mutable};
use bevy::ecs::entity::Entity;
use bevy::ecs::query::With;
use bevy::math::{UVec2, Vec3};
use bevy::mesh::Mesh3d;
use bevy::transform::components::Transform;
use glassbox::editor::history::undo;
use glassbox::film::{LightMix, Progressive};
use glassbox::scene::{Phong, PointLamp, RenderSettings, SceneId};
use glassbox::sync::{Traced, TracedCameras};
use glassbox::trace::{Camera, Gains, World};

/// Numbers below some other, always the same ones.
struct Numbers(u32);

impl Numbers {
    fn below(&mut self, most: usize) -> usize {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 16) as usize % most
    }

    fn between(&mut self, least: f32, most: f32) -> f32 {
        least + (most - least) * self.below(1000) as f32 * 1e-3
    }
}

/// A scene that is edited while it is rendered as a view renders it, and what the mixer makes of it.
struct Bench {
    app: App,
    numbers: Numbers,
    camera: Camera,
    gains: Gains,
    render: Progressive,
    taken: usize,
}

impl Bench {
    fn ids<C: Component>(&mut self) -> Vec<(Entity, SceneId)> {
        let world = self.app.world_mut();
        let mut found = world.query_filtered::<(Entity, &SceneId), With<C>>();
        let mut found: Vec<_> = found
            .iter(world)
            .map(|(entity, id)| (entity, *id))
            .collect();
        found.sort_unstable_by_key(|(_, id)| *id);
        found
    }

    fn any<C: Component>(&mut self) -> Option<Entity> {
        let all = self.ids::<C>();
        (!all.is_empty()).then(|| all[self.numbers.below(all.len())].0)
    }

    fn change<C: Component<Mutability = Mutable>>(
        &mut self,
        change: impl FnOnce(&mut C, &mut Numbers),
    ) {
        let Some(entity) = self.any::<C>() else {
            return;
        };
        let mut component = self.app.world_mut().get_mut::<C>(entity).unwrap();
        change(&mut component, &mut self.numbers);
    }

    fn place<C: Component>(&mut self, reach: f32) {
        let Some(entity) = self.any::<C>() else {
            return;
        };
        let offset = std::array::from_fn(|_| self.numbers.between(-reach, reach));
        let mut place = self.app.world_mut().get_mut::<Transform>(entity).unwrap();
        place.translation += Vec3::from_array(offset);
    }

    fn edit(&mut self) {
        match self.numbers.below(11) {
            0 | 1 => self.change::<PointLamp>(|lamp, numbers| {
                lamp.color = LinearRgba::rgb(numbers.between(0.0, 1.0), 0.5, 0.25);
                lamp.intensity *= numbers.between(0.5, 1.5);
            }),
            2 | 3 => self.place::<PointLamp>(0.2),
            4 => {
                let count = self.ids::<PointLamp>().len();
                // With more some would share a plane, and be added in f32.
                if count < 6 {
                    let at = Transform::from_xyz(self.numbers.between(-0.5, 0.5), 0.5, 0.3);
                    let lamp = PointLamp::default();
                    self.app.world_mut().spawn((lamp, at));
                }
            }
            5 => {
                if self.ids::<PointLamp>().len() > 2 {
                    let lamp = self.any::<PointLamp>().unwrap();
                    self.app.world_mut().despawn(lamp);
                }
            }
            6 => {
                let lamps = self.ids::<PointLamp>();
                let (_, id) = lamps[self.numbers.below(lamps.len())];
                let gain = [0.0, 1.0, 2.3][self.numbers.below(3)];
                self.gains = std::iter::once((id.0, Vec3::splat(gain))).collect();
            }
            7 => self.change::<Phong>(|phong, numbers| {
                phong.diffuse = LinearRgba::rgb(numbers.between(0.1, 0.9), 0.4, 0.3);
            }),
            8 => self.place::<Mesh3d>(0.05),
            9 => self.camera.position.x += self.numbers.between(-0.02, 0.02),
            _ => {
                undo(self.app.world_mut());
            }
        }
        self.app.update();
    }

    fn settings(&self) -> RenderSettings {
        RenderSettings {
            size: UVec2::new(24, 18),
            spp: 2,
            ..self.app.world().resource::<RenderSettings>().clone()
        }
    }

    fn world(&self) -> World {
        (*self.app.world().resource::<Traced>().world).clone()
    }

    fn fresh(&self, apart: bool) -> Progressive {
        let mix = LightMix {
            apart,
            gains: self.gains.clone(),
        };
        let (camera, settings) = (self.camera.clone(), self.settings());
        Progressive::start_region(self.world(), camera, settings, None, &mix).unwrap()
    }
}

#[test]
fn after_five_hundred_random_edits_the_picture_is_that_of_a_render_from_scratch() {
    let app = editor("cornell-box");
    let camera = app.world().resource::<TracedCameras>().0[0].camera.clone();
    let world = (*app.world().resource::<Traced>().world).clone();
    let mut bench = Bench {
        render: Progressive::start(world, camera.clone(), RenderSettings::default()).unwrap(),
        app,
        numbers: Numbers(3),
        camera,
        gains: Gains::default(),
        taken: 0,
    };
    bench.render = bench.fresh(true);
    let mut seen_from = bench.camera.clone();
    for step in 0..500 {
        if bench.numbers.below(3) == 0 {
            bench.render.wait();
        }
        bench.edit();
        let same_view = seen_from == bench.camera;
        if same_view && bench.render.edit(bench.world(), &bench.gains) {
            bench.taken += 1;
        } else {
            bench.render = bench.fresh(true);
            seen_from = bench.camera.clone();
        }
        if step % 5 != 4 {
            continue;
        }
        bench.render.wait();
        let [fresh, together] = [true, false].map(|apart| {
            let render = bench.fresh(apart);
            render.wait();
            render.snapshot().picture
        });
        let edited = bench.render.snapshot().picture;
        assert_eq!(edited, fresh, "step {step}");
        for (pixel, other) in edited.pixels.iter().zip(&together.pixels) {
            // Each sample is rounded to f32 light by light, or as a whole.
            let difference = (*pixel - *other).abs().max_element();
            let most = 2e-6 * other.max_element().max(1e-6);
            assert!(
                difference <= most,
                "step {step}: {pixel}, {other} in one plane"
            );
        }
    }
    assert!(bench.taken > 150, "only {} edits were taken", bench.taken);
}
