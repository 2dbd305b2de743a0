//! The tab Render: every setting of the render, in groups.

use super::super::fields::{properties_ui, row, section, switch};
use super::super::says::Says;
use super::environment::environment_ui;
use super::maps::Thumbnails;
use crate::editor::background::{Background, Outcome, Watch};
use crate::editor::edits::scene_entity;
use crate::editor::preferences::Preferences;
use crate::editor::viewport::traced_render;
use crate::io::Size;
use crate::scene::{RenderSettings, range_problems};
use crate::trace::Crossings;
use crate::view::TracedRender;
use bevy::ecs::name::Name;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy::math::UVec2;
use bevy_egui::egui::Ui;
use std::time::Duration;

/// A group of settings: its title, whether it is open at first, and the paths in it.
type Group = (&'static str, bool, &'static [&'static str]);

/// The groups in their order. The trees are in a tab of their own.
const GROUPS: &[Group] = &[
    (
        "Features",
        true,
        &[
            "features.shading",
            "features.mirrors",
            "max_depth",
            "features.shadows",
            "features.soft_shadows",
            "features.scale_light_samples",
            "features.normal_interpolation",
            "features.textures",
            "texture_filter",
            "features.environment",
            "features.glossy",
            "gloss_samples",
            "features.transparency",
            "features.translucency",
            "translucency_samples",
            "features.lens",
            "features.motion",
            "lighting",
        ],
    ),
    (
        "Sampling",
        true,
        &[
            "spp",
            "jitter",
            "pixel",
            "sequence",
            "seed",
            "sampling.adaptive",
            "sampling.error",
            "sampling.time",
        ],
    ),
    (
        "Output",
        true,
        &[
            "size",
            "output.exposure",
            "output.view_transform",
            "output.bloom.enabled",
            "output.bloom.threshold",
            "output.bloom.intensity",
            "output.bloom.sigma",
        ],
    ),
];

/// Sizes of pictures, and what they are for.
const SIZES: [(&str, UVec2, &str); 5] = [
    (
        "Square",
        UVec2::new(800, 800),
        "As wide as high: quick to render",
    ),
    (
        "HD",
        UVec2::new(1280, 720),
        "16 to 9, as small as videos are",
    ),
    (
        "Full HD",
        UVec2::new(1920, 1080),
        "16 to 9, as most screens have it",
    ),
    (
        "Square, large",
        UVec2::new(2048, 2048),
        "As wide as high, for prints and textures",
    ),
    (
        "4K",
        UVec2::new(3840, 2160),
        "16 to 9, four times the pixels of Full HD",
    ),
];

pub(super) fn render_ui(ui: &mut Ui, world: &mut World, thumbnails: &mut Thumbnails) {
    environment_ui(ui, world, thumbnails);
    let before = world.resource::<RenderSettings>().clone();
    let mut settings = before.clone();
    for &(title, open, paths) in GROUPS {
        section(ui, title, open, |ui| {
            properties_ui(ui, &mut settings, paths);
            if paths.contains(&"size") {
                sizes_ui(ui, &mut settings);
            }
        });
    }
    film_ui(ui, world);
    for problem in range_problems(&settings) {
        ui.colored_label(ui.visuals().warn_fg_color, problem.to_string());
    }
    ui.horizontal(|ui| {
        let says =
            "Sets features, sampling and output, but not the size, to what they are in a new scene";
        if ui.button("Reset").says(says).clicked() {
            settings = RenderSettings {
                size: settings.size,
                tree: settings.tree,
                ..RenderSettings::default()
            };
        }
    });
    if settings != before {
        *world.resource_mut::<RenderSettings>() = settings;
    }
}

/// What the view's film takes, and whether it keeps lights apart: of the view, not of the scene.
fn film_ui(ui: &mut Ui, world: &mut World) {
    let render = traced_render(world).and_then(TracedRender::render);
    let film = render.map(|render| render.memory());
    section(ui, "Film", true, |ui| {
        let mut is_apart = world.resource::<Preferences>().lights_apart;
        let says = "What each light adds is kept by itself: another colour, intensity or mix of lights costs no ray, and one that moves only its own. Off, the picture is the same and takes less memory, and each edit renders all of it again. Of the view: scenes and pictures do not keep it";
        if switch(ui, "Keep lights apart", says, &mut is_apart, false) {
            world.resource_mut::<Preferences>().lights_apart = is_apart;
        }
        let Some(film) = film else { return };
        let says = "Memory of the view's film when every pixel has samples: the picture, and what is kept apart. Up to eight lights have a plane each, and the others and what shines by itself one each, as far as 1 GB goes; a light that is edited has its own";
        let planes = match film.planes {
            0 => "no planes".to_owned(),
            planes => format!("{planes} × {}", Size(film.plane)),
        };
        row(ui, "Planes", says, |ui| ui.label(planes).says(says));
        if film.hits > 0 {
            let says = "What camera rays and the mirrored ones after them hit, of each pixel's first sample from the start and of others once something is edited, and while materials are edited what hides lights from there: those rays are not traced again. As far as 128 MB go for each";
            row(ui, "First hits", says, |ui| {
                ui.label(Size(film.hits).to_string()).says(says)
            });
        }
        row(ui, "Whole film", says, |ui| {
            ui.label(Size(film.total).to_string()).says(says)
        });
        if let Some(text) = crossings_text(ui, world) {
            ui.colored_label(ui.visuals().warn_fg_color, text);
        }
    });
}

/// How often what is being counted is looked for.
const TICK: Duration = Duration::from_millis(50);

/// What the view's rays go through, where that is so much that it takes long: asked once for each render, on a thread of
/// its own, since it takes longer than a frame just where there is something to say.
#[derive(Resource, Default)]
struct ViewCrossings {
    /// Of which render it is.
    of: Option<u64>,
    found: Option<Crossings>,
    under_way: Option<(u64, Background<Option<Crossings>>)>,
}

impl ViewCrossings {
    fn take(&mut self) {
        let Some((of, work)) = &self.under_way else {
            return;
        };
        self.found = match work.take() {
            Outcome::Pending => return,
            Outcome::Done(found) => found,
            Outcome::Lost => None,
        };
        self.of = Some(*of);
        self.under_way = None;
    }

    /// What was found of the render of this number; where that is not known yet, it is looked for.
    fn of(
        &mut self,
        number: u64,
        look: impl FnOnce() -> Option<Crossings> + Send + 'static,
    ) -> Option<Crossings> {
        self.take();
        // One at a time: in a drag every frame asks for another.
        if self.under_way.is_none() && self.of != Some(number) {
            match Background::start("crossings", |_: &Watch| look()) {
                Ok(work) => self.under_way = Some((number, work)),
                // Without a thread nothing is said.
                Err(_) => (self.of, self.found) = (Some(number), None),
            }
        }
        // What was found of another render is nothing of this one.
        self.found.filter(|_| self.of == Some(number))
    }
}

fn crossings_text(ui: &Ui, world: &mut World) -> Option<String> {
    world.init_resource::<ViewCrossings>();
    let render = traced_render(world)?;
    let number = render.render()?.number();
    let (traced, camera, settings) = render.subject()?;
    if !traced.needs.transparency {
        return None;
    }
    let subject = (traced.clone(), camera.clone(), settings.clone());
    let mut kept = world.resource_mut::<ViewCrossings>();
    let found = kept.of(number, move || {
        let (world, camera, settings) = subject;
        Crossings::many(&world, &camera, &settings)
    });
    if kept.under_way.is_some() {
        ui.ctx().request_repaint_after(TICK);
    }
    let found = found?;
    let entity = scene_entity(world, found.object);
    let name = entity.and_then(|entity| world.get::<Name>(entity));
    Some(found.text(name.map(Name::as_str)))
}

/// Sizes that are often wanted, beside the field for the size.
fn sizes_ui(ui: &mut Ui, settings: &mut RenderSettings) {
    let says = "Sizes that are often wanted; the view has its own";
    row(ui, "", says, |ui| {
        ui.menu_button("Usual sizes…", |ui| {
            for (name, size, says) in SIZES {
                let text = format!("{name}: {} × {}", size.x, size.y);
                if ui.button(text).says(says).clicked() {
                    settings.size = size;
                    ui.close();
                }
            }
        })
        .response
        .says(says);
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{SETTINGS, SceneId};
    use std::sync::mpsc::channel;
    use std::time::Instant;

    #[test]
    fn what_rays_of_one_render_go_through_is_not_said_of_the_next() {
        let mut kept = ViewCrossings::default();
        let leaf = Crossings {
            a_ray: 40.0,
            object: SceneId(7),
        };
        let start = Instant::now();
        while kept.of(1, move || Some(leaf)).is_none() {
            assert!(start.elapsed() < Duration::from_secs(60), "never found");
            std::thread::sleep(Duration::from_millis(1));
        }
        let (go, waits) = channel::<()>();
        let look = move || {
            let _ = waits.recv();
            None
        };
        assert_eq!(kept.of(2, look), None, "it is being looked for");
        drop(go);
        while kept.of != Some(2) {
            assert!(start.elapsed() < Duration::from_secs(60), "never found");
            assert_eq!(kept.of(2, || None), None);
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn every_setting_of_the_table_has_its_field_in_this_tab_or_in_that_of_the_trees() {
        let shown: Vec<&str> = GROUPS
            .iter()
            .flat_map(|group| group.2)
            .chain(super::super::bvh::SETTINGS_OF_TREES)
            .copied()
            .collect();
        for setting in SETTINGS.iter() {
            let count = shown.iter().filter(|&&path| path == setting.path).count();
            assert_eq!(count, 1, "{}", setting.path);
        }
        assert_eq!(shown.len(), SETTINGS.len());
    }
}
