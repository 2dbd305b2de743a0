use super::{InspectSettings, LineSet, Subject};
use super::{boxes, lens, lights, lobes, motion, normals, rays, visits};
use crate::trace::RayTree;
use serde::Serialize;
use std::fmt::Debug;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

/// What is drawn apart from the rest: each has its own switch, and is made anew by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
#[expect(missing_docs, reason = "the module's table says what each is")]
pub enum System {
    Boxes,
    Visits,
    Rays,
    Lobes,
    Normals,
    Lights,
    Lens,
    Motion,
}

/// Everything that the settings ask for, in the systems' order.
pub fn lines(subject: &Subject) -> Vec<LineSet> {
    System::ALL
        .into_iter()
        .filter(|system| system.is_on(subject.inspect))
        .map(|system| system.lines(subject))
        .collect()
}

impl System {
    /// All of them, in the order in which they are drawn.
    pub const ALL: [Self; 8] = [
        Self::Boxes,
        Self::Visits,
        Self::Normals,
        Self::Lights,
        Self::Lens,
        Self::Motion,
        Self::Lobes,
        Self::Rays,
    ];

    /// Whether the settings ask for it.
    pub fn is_wanted(self, inspect: &InspectSettings) -> bool {
        let rays = &inspect.rays;
        inspect.on
            && match self {
                Self::Boxes => inspect.boxes.on,
                Self::Visits => rays.on && (rays.visited || rays.pruned),
                Self::Rays => rays.on,
                Self::Lobes => inspect.lobes,
                Self::Normals => inspect.normals.on,
                Self::Lights => inspect.lights,
                Self::Lens => inspect.lens,
                Self::Motion => inspect.motion,
            }
    }

    /// Whether the settings ask for it of the trees that are traced: where there is a pair of trees,
    /// what is of trees is drawn of those.
    pub fn is_on(self, inspect: &InspectSettings) -> bool {
        let in_pair = inspect.pair.on && matches!(self, Self::Boxes | Self::Visits);
        self.is_wanted(inspect) && !in_pair
    }

    /// Whether there is nothing to show without the rays of a pixel.
    pub fn needs_rays(self) -> bool {
        matches!(self, Self::Visits | Self::Rays | Self::Lobes)
    }

    /// What it shows, whether it is on or not.
    pub fn lines(self, subject: &Subject) -> LineSet {
        let mut set = match self {
            Self::Boxes => boxes::boxes(subject),
            Self::Visits => visits::visits(subject),
            Self::Rays => rays::rays(subject),
            Self::Lobes => lobes::lobes(subject),
            Self::Normals => normals::normals(subject),
            Self::Lights => lights::lights(subject),
            Self::Lens => lens::lens(subject),
            Self::Motion => motion::motion(subject),
        };
        set.say_what_is_left_out();
        set
    }

    /// A number that differs where the lines may: made of all that the system reads, and of nothing
    /// else. Parts of the world, and the debug rays, are told apart by where they are in memory, so
    /// the snapshot and the rays from which a set was made have to be kept for as long as its key is
    /// compared.
    pub fn key(self, subject: &Subject) -> u64 {
        let mut key = Key::default();
        let inspect = subject.inspect;
        key.add(&(self, inspect.max_lines));
        match self {
            Self::Boxes => {
                key.add_text(&inspect.boxes);
                key.add_objects(subject);
                if inspect.boxes.color == super::BoxColor::Visits {
                    key.add_rays(subject.rays);
                }
            }
            Self::Visits => {
                key.add_text(&inspect.rays);
                key.add_objects(subject);
                key.add_rays(subject.rays);
            }
            Self::Rays | Self::Lobes => {
                key.add_text(&inspect.rays);
                key.add_objects(subject);
                key.add_rays(subject.rays);
                key.add_text(subject.camera);
                key.add_text(&subject.settings.output.exposure);
            }
            Self::Normals => {
                key.add_text(&inspect.normals);
                key.add_objects(subject);
                key.add_text(&(subject.camera, subject.settings.size));
            }
            Self::Lights => {
                key.add(&(Arc::as_ptr(&subject.world.lights) as usize));
                key.add_dome(subject);
                key.add_objects(subject);
                key.add_text(subject.camera);
            }
            Self::Lens => key.add_text(&(
                subject.photographer,
                subject.settings.size,
                subject.settings.features.lens,
            )),
            Self::Motion => {
                key.add(&(Arc::as_ptr(&subject.world.lights) as usize));
                key.add_objects(subject);
                key.add_text(&(subject.photographer, subject.settings.features.motion));
            }
        }
        key.0.finish()
    }
}

#[derive(Default)]
struct Key(DefaultHasher);

impl Key {
    fn add(&mut self, value: &impl Hash) {
        value.hash(&mut self.0);
    }

    /// For what holds floats, which have no hash: their text tells any two apart.
    fn add_text(&mut self, value: &impl Debug) {
        self.add(&format!("{value:?}"));
    }

    fn add_objects(&mut self, subject: &Subject) {
        let world = subject.world;
        self.add(&(Arc::as_ptr(&world.aggregate) as usize));
        self.add(&(Arc::as_ptr(&world.objects) as usize));
    }

    /// What an environment that is a light is drawn by.
    fn add_dome(&mut self, subject: &Subject) {
        let environment = &subject.world.environment;
        self.add(&environment.lights);
        if environment.lights {
            let map = environment.map.as_ref().map(Arc::as_ptr);
            self.add(&map.map(|map| map as usize));
            self.add_text(&(
                environment.background,
                environment.rotation,
                environment.intensity,
            ));
            let settings = subject.settings;
            self.add_text(&(settings.lighting, settings.features.environment));
            self.add_text(&settings.output.exposure);
        }
    }

    /// By where they are in memory, as parts of the world: a pixel's samples may have half a million.
    fn add_rays(&mut self, rays: Option<&RayTree>) {
        let Some(rays) = rays else { return };
        self.add(&(rays.pixel, rays.rays.len(), rays.rays.as_ptr() as usize));
    }
}
