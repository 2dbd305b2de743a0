//! The debug ray: samples of one pixel, traced again by the very code that renders, with every ray
//! written down. It stays where it is when the view moves, and is shot again when the scene changes.

use super::view_of;
use crate::editor::background::{Background, Outcome, Watch};
use crate::editor::command::{Command, Over, State, commands};
use crate::editor::notice::Notices;
use crate::editor::pick;
use crate::editor::viewport::Viewport;
use crate::inspect::{Addition, Names};
use crate::scene::{Output, RenderSettings};
use crate::sync::Traced;
use crate::trace::{Camera, RayTree, Samples, World, probe_while, samples_per_pixel};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Res, ResMut};
use bevy::ecs::world;
use bevy::math::{UVec2, Vec2};
use std::ops::ControlFlow;
use std::sync::Arc;

/// Why nothing is shot where nothing is traced.
pub(super) const NO_VIEW: &str =
    "The debug ray is one of the traced view's pixels: show it (key 2) first";

/// Which of the pixel's samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::editor) enum Which {
    /// Sample 0.
    #[default]
    First,
    /// All that a render takes.
    All,
    /// This one.
    Number(u64),
}

impl Which {
    fn samples(self) -> Samples {
        match self {
            Self::First => Samples::One(0),
            Self::All => Samples::All,
            Self::Number(index) => Samples::One(index),
        }
    }
}

/// What is said where the thread that traced is gone.
const LOST: &str = "The pixel's rays could not be traced, by a bug that was reported where Glassbox was started: pick another pixel, or trace its first sample alone";

/// A pixel of a picture: all that is needed to trace it again.
#[derive(Clone)]
pub(in crate::editor) struct Shot {
    /// (0, 0) is the top left one.
    pub pixel: UVec2,
    /// From where. The view may have moved on since.
    pub camera: Camera,
    /// The picture's.
    pub size: UVec2,
}

/// The rays of the pixel that was picked.
#[derive(Resource, Default)]
pub(in crate::editor) struct DebugRay {
    /// Which of the samples are traced.
    pub which: Which,
    shot: Option<Shot>,
    rays: Option<Arc<RayTree>>,
    /// What `rays` were traced with.
    of: Option<Of>,
    problem: Option<String>,
    addition: Addition,
    /// Counts the trees of rays that there were, and the pixels that were picked.
    number: u64,
    shots: u64,
    /// What the first camera ray met, by number and name, when the pixel was picked.
    met: Option<(u64, String)>,
    lost: Option<String>,
    /// What is being traced on a thread of its own.
    under_way: Option<(Of, Background<Found>)>,
}

/// The rays, or why there are none.
type Found = Result<(RayTree, Addition), String>;

/// All that rays depend on.
#[derive(Clone)]
struct Of {
    world: Arc<World>,
    settings: RenderSettings,
    pixel: UVec2,
    camera: Camera,
    which: Which,
}

impl Of {
    fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.world, &other.world)
            && self.pixel == other.pixel
            && self.which == other.which
            && self.camera == other.camera
            && self.settings == other.settings
    }

    fn trace(&self, go_on: &mut dyn FnMut() -> ControlFlow<()>) -> Found {
        let (world, camera, settings) = (&self.world, &self.camera, &self.settings);
        let samples = self.which.samples();
        let rays = probe_while(world, camera, settings, self.pixel, &samples, go_on);
        let ControlFlow::Continue(rays) = rays else {
            // Who ended it does not listen any more.
            return Err(String::new());
        };
        let rays = rays.map_err(|problem| problem.to_string())?;
        let addition = Addition::of(world, camera, settings, &rays);
        Ok((rays, addition))
    }
}

impl DebugRay {
    /// The rays, where a pixel was picked and is in the picture.
    pub fn rays(&self) -> Option<&Arc<RayTree>> {
        self.rays.as_ref()
    }

    /// The pixel that was picked.
    pub fn shot(&self) -> Option<&Shot> {
        self.shot.as_ref()
    }

    /// The world and the settings that the rays were traced with.
    pub fn traced_with(&self) -> Option<(&Arc<World>, &RenderSettings)> {
        let of = self.of.as_ref()?;
        Some((&of.world, &of.settings))
    }

    /// What the rays add up to.
    pub fn addition(&self) -> &Addition {
        &self.addition
    }

    /// Differs from one tree of rays to the next.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Differs from one picked pixel to the next.
    pub fn shots(&self) -> u64 {
        self.shots
    }

    /// Many samples are being traced; what is shown is older.
    pub fn is_busy(&self) -> bool {
        self.under_way.is_some()
    }

    /// How many samples the picked pixel has.
    pub fn sample_count(&self) -> Option<u64> {
        let of = self.of.as_ref()?;
        Some(samples_per_pixel(&of.world, &of.camera, &of.settings).into())
    }

    /// Picks a pixel.
    pub fn shoot(&mut self, shot: Shot) {
        self.shot = Some(shot);
        self.shots += 1;
        self.of = None;
        self.met = None;
        self.lost = None;
    }

    /// Takes the rays away.
    pub fn clear(&mut self) {
        *self = Self {
            which: self.which,
            number: self.number + 1,
            shots: self.shots + 1,
            ..Self::default()
        };
    }

    /// Why there is nothing to see, or less than expected; `None` where all is as asked for.
    pub fn says(&self) -> Option<String> {
        if self.problem.is_some() {
            return self.problem.clone();
        }
        if self.shot.is_none() {
            return Some(
                "No pixel was picked yet: point at the traced picture and press R, click it with Alt, or enter a pixel"
                    .into(),
            );
        }
        let of = self.of.as_ref()?;
        if of.world.objects.is_empty() {
            return Some("The scene has no object that is traced: rays meet lights at most".into());
        }
        self.lost.clone()
    }

    /// Traces the pixel again where anything that rays depend on is another.
    pub fn bring_up_to_date(
        &mut self,
        world: &Arc<World>,
        settings: &RenderSettings,
        names: &Names,
    ) {
        if let Some((of, work)) = self.under_way.take() {
            // Rays of a pixel that is picked no more are not waited for: dropped, the work ends.
            if self.asks_for(&of) {
                let found = match work.take() {
                    Outcome::Pending => {
                        self.under_way = Some((of, work));
                        return;
                    }
                    Outcome::Done(found) => found,
                    // Not tried again until something else is asked for: it would end so in every frame.
                    Outcome::Lost => Err(LOST.into()),
                };
                // Shown even where the scene has moved on: the next ones follow.
                self.take(of, found, names);
            }
        }
        let Some(shot) = &self.shot else {
            return;
        };
        let of = Of {
            world: world.clone(),
            settings: RenderSettings {
                size: shot.size,
                // Only developing depends on it.
                output: Output::default(),
                ..settings.clone()
            },
            pixel: shot.pixel,
            camera: shot.camera.clone(),
            which: self.which,
        };
        if self.of.as_ref().is_some_and(|known| known.is(&of)) {
            return;
        }
        let mut to_the_end = || ControlFlow::Continue(());
        if of.which != Which::All {
            let found = of.trace(&mut to_the_end);
            self.take(of, found, names);
            return;
        }
        // Thousands of samples may take seconds, and no frame waits for them; the pool's threads belong to the picture,
        // which may keep them for long.
        let traces = of.clone();
        let work = move |watch: &Watch| traces.trace(&mut || watch.tell("rays", 0.0));
        match Background::start("debug ray", work) {
            Ok(work) => self.under_way = Some((of, work)),
            // A system without another thread: then a frame has to wait.
            Err(_) => {
                let found = of.trace(&mut to_the_end);
                self.take(of, found, names);
            }
        }
    }

    /// Whether these are rays of the pixel that is picked now, and those of its samples.
    fn asks_for(&self, of: &Of) -> bool {
        let is_of = |shot: &Shot| {
            shot.pixel == of.pixel && shot.size == of.settings.size && shot.camera == of.camera
        };
        self.which == of.which && self.shot.as_ref().is_some_and(is_of)
    }

    fn take(&mut self, of: Of, found: Found, names: &Names) {
        self.number += 1;
        (self.rays, self.addition, self.problem) = match found {
            Ok((rays, addition)) => (Some(Arc::new(rays)), addition, None),
            Err(problem) => (None, Addition::default(), Some(problem)),
        };
        let objects = &of.world.objects;
        let first = self.rays.as_ref().and_then(|rays| rays.rays.first()?.hit);
        let gone = |id: u64| !objects.iter().any(|object| object.id == id);
        self.lost = match &self.met {
            Some((id, name)) if gone(*id) => Some(format!(
                "{name}, which the ray met, is deleted or hidden: these are the rays without it"
            )),
            _ => None,
        };
        if self.met.is_none() {
            self.met = first.map(|hit| (hit.object, names.of(hit.object)));
        }
        self.of = Some(of);
    }
}

pub(super) fn commands() -> Vec<Command> {
    commands! {
        "rays.shoot" "Debug ray" ["R"] "Traces the pixel under the pointer again and draws its rays, as a click with Alt does; beside the picture it takes them away"
            => shoot_at_pointer,
        "rays.all-samples" "Rays of all samples" ["Ctrl+Shift+R"] "Draws the debug rays of all samples of the picked pixel, or again those of its first one"
            => toggle_all_samples; menu("View/Rays and trees", 0); over(&[Over::Ray]); state(|world| State::switch(world.resource::<DebugRay>().which == Which::All)),
    }
}

fn toggle_all_samples(world: &mut world::World) {
    let mut ray = world.resource_mut::<DebugRay>();
    ray.which = match ray.which {
        Which::All => Which::First,
        _ => Which::All,
    };
}

/// The pixel under the pointer. Beside the picture it takes the rays away.
fn shoot_at_pointer(world: &mut world::World) {
    let pointer = pick::cursor(world);
    let viewport = world.resource::<Viewport>();
    match pointer.filter(|&at| is_inside(viewport.place(at))) {
        // A panel lies over that place of the picture.
        Some(_) if !viewport.hovered => {}
        Some(at) => {
            shoot_at(world, at);
        }
        None => world.resource_mut::<DebugRay>().clear(),
    }
}

fn is_inside(place: Vec2) -> bool {
    place.min_element() >= 0.0 && place.max_element() < 1.0
}

/// The pixel at a place of the window, in logical pixels. `false` where none is traced there.
pub(in crate::editor) fn shoot_at(world: &mut world::World, at: Vec2) -> bool {
    let place = world.resource::<Viewport>().place(at);
    if !is_inside(place) {
        return false;
    }
    let Some((camera, size)) = view_of(world) else {
        world.resource_mut::<Notices>().tell(NO_VIEW);
        return false;
    };
    let pixel = (place * size.as_vec2()).as_uvec2().min(size - 1);
    world.resource_mut::<DebugRay>().shoot(Shot {
        pixel,
        camera,
        size,
    });
    true
}

/// The picked pixel, whenever the scene is another.
pub(super) fn trace_again(
    traced: Res<Traced>,
    settings: Res<RenderSettings>,
    names: Res<Names>,
    mut ray: ResMut<DebugRay>,
) {
    if ray.shot.is_some() || ray.under_way.is_some() {
        ray.bring_up_to_date(&traced.world, &settings, &names);
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Bench, SIZE};
    use super::*;
    use crate::sync::TracedCameras;
    use std::sync::mpsc::channel;
    use std::thread;
    use std::time::{Duration, Instant};

    #[test]
    fn rays_of_a_pixel_that_is_picked_no_more_are_not_taken() {
        let mut bench = Bench::open("cornell-box");
        bench.ray().which = Which::All;
        bench.shoot([300, 240]);
        let camera = bench.app.world().resource::<TracedCameras>().0[0]
            .camera
            .clone();
        let pixel = UVec2::new(10, 12);
        bench.ray().shoot(Shot {
            pixel,
            camera,
            size: SIZE,
        });
        let start = Instant::now();
        loop {
            assert!(start.elapsed() < Duration::from_secs(60), "no rays came");
            bench.app.update();
            let ray = bench.ray();
            if let Some(rays) = ray.rays() {
                assert_eq!(rays.pixel, pixel);
                return;
            }
            thread::sleep(Duration::from_millis(2));
        }
    }

    #[test]
    fn rays_of_another_pixel_or_of_one_sample_do_not_wait_for_those_that_are_under_way() {
        let mut bench = Bench::open("cornell-box");
        bench.ray().which = Which::All;
        bench.shoot([300, 240]);
        bench.wait();
        for of_one_sample in [false, true] {
            // It never ends by itself, and says when it was told to.
            let (told, hears) = channel();
            let work = Background::start("test", move |watch| {
                while watch.tell("on and on", 0.0).is_continue() {
                    thread::sleep(Duration::from_millis(1));
                }
                told.send(()).map_err(|gone| gone.to_string())?;
                Err(String::new())
            });
            let mut ray = bench.ray();
            let of = ray.of.take().unwrap();
            ray.under_way = Some((of, work.unwrap()));
            bench.app.update();
            assert!(bench.ray().is_busy());
            if of_one_sample {
                bench.ray().which = Which::First;
                bench.app.update();
            } else {
                bench.shoot([10, 12]);
                bench.wait();
            }
            hears.recv_timeout(Duration::from_secs(60)).unwrap();
            let rays = bench.ray().rays().unwrap().clone();
            assert_eq!(rays.pixel, UVec2::new(10, 12));
            assert_eq!(rays.samples.len() == 1, of_one_sample);
        }
    }

    #[test]
    fn a_thread_that_is_lost_is_said_and_not_started_anew_in_every_frame() {
        let mut bench = Bench::open("cornell-box");
        bench.ray().which = Which::All;
        bench.shoot([300, 240]);
        bench.wait();
        let mut ray = bench.ray();
        let of = ray.of.take().unwrap();
        ray.under_way = Some((of, Background::sent().1));
        for _ in 0..3 {
            bench.app.update();
            let ray = bench.ray();
            assert_eq!(ray.says().as_deref(), Some(LOST));
            assert!(!ray.is_busy() && ray.rays().is_none());
        }
        bench.shoot([10, 10]);
        bench.wait();
        assert_eq!(bench.ray().says(), None);
    }
}
