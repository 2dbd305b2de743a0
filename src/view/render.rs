//! The render behind a traced view: begun, directed, replaced, and what it says of its picture.

use super::darkroom::{Darkroom, Order, Subject};
use super::reference::TracedPicture;
use super::traced::TracedView;
use crate::film::views::Scale;
use crate::film::{LightMix, Progressive, State, Status};
use crate::scene::{Output, RenderSettings, SceneId};
use crate::trace;
use bevy::asset::Handle;
use bevy::image::Image;
use bevy::log::error;
use bevy::math::{URect, UVec2, Vec2};
use bevy::prelude::Component;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A render that is to be replaced may take so long to its first picture.
const LONGEST_WAIT: Duration = Duration::from_millis(100);
/// How long until what could not begin, for want of threads, is tried again.
const RETRY: Duration = Duration::from_secs(2);

/// The render that a [`TracedView`] shows.
#[derive(Component, Default)]
#[component(clone_behavior = Ignore)]
pub struct TracedRender {
    pub(super) running: Option<Running>,
    pub(super) darkroom: Option<Darkroom>,
    /// What the print on the screen says of itself.
    pub(super) shown: Option<PrintInfo>,
    /// Why it could not begin, and when that was found.
    failed: Option<(String, Instant)>,
    /// Why it does not render as things are.
    pub(super) refused: Option<String>,
    /// Of which render it was said that it has ended.
    pub(super) told: Option<u64>,
    /// Whose backs it sees, of all that there are.
    pub(super) backs: Vec<SceneId>,
}

/// What stands on the screen.
#[derive(Clone, Debug)]
pub struct PrintInfo {
    /// Pixels of the film.
    pub size: UVec2,
    /// What a heatmap's colours mean.
    pub scale: Option<Scale>,
    /// As it stands on the screen, encoded. It stays as it is while the handle is held.
    pub picture: Handle<Image>,
    /// From the edit to this render's first picture on the screen.
    pub first_picture: Duration,
    /// The render's number.
    pub(super) of: u64,
}

/// A render that goes on, and what it is of.
pub(super) struct Running {
    pub(super) render: Arc<Progressive>,
    world: Arc<trace::World>,
    camera: trace::Camera,
    settings: RenderSettings,
    region: Option<URect>,
    mix: LightMix,
    order: Order,
    pub(super) started: Instant,
    paused: bool,
    focus: Vec2,
}

impl TracedRender {
    /// The render's numbers now; `None` while there is none.
    pub fn status(&self) -> Option<Status> {
        Some(self.running.as_ref()?.render.status())
    }

    /// The render itself.
    pub fn render(&self) -> Option<&Arc<Progressive>> {
        Some(&self.running.as_ref()?.render)
    }

    /// What it renders: world, camera and settings, the film's size among them.
    pub fn subject(&self) -> Option<(&Arc<trace::World>, &trace::Camera, &RenderSettings)> {
        let running = self.running.as_ref()?;
        Some((&running.world, &running.camera, &running.settings))
    }

    /// The picture as it is now, linear and as shown; `None` while there is no render. It takes some
    /// milliseconds a megapixel.
    pub fn picture(&self) -> Option<TracedPicture> {
        Some(self.picture_later()?())
    }

    /// What makes the picture, as it is when that is called, on any thread.
    pub fn picture_later(&self) -> Option<impl FnOnce() -> TracedPicture + Send + 'static + use<>> {
        let running = self.running.as_ref()?;
        let (render, output) = (running.render.clone(), running.order.output);
        Some(move || TracedPicture::of(&render, &output))
    }

    /// How its picture is made of what it renders.
    pub fn output(&self) -> Option<&Output> {
        Some(&self.running.as_ref()?.order.output)
    }

    /// What stands on the screen.
    pub fn shown(&self) -> Option<&PrintInfo> {
        self.shown.as_ref()
    }

    /// Starts over with the next frame.
    pub fn restart(&mut self) {
        self.retire();
    }

    /// Whether a render that has just begun shall show its first picture before another takes its
    /// place: while something is dragged every frame begins one, and none would ever be seen.
    pub(super) fn is_awaited(&self, size: UVec2) -> bool {
        let Some(running) = &self.running else {
            return false;
        };
        let of = running.render.number();
        !running.paused
            && running.settings.size == size
            && running.started.elapsed() < LONGEST_WAIT
            && self.shown.as_ref().is_none_or(|shown| shown.of != of)
            && !matches!(running.render.status().state, State::Ended(_))
    }

    /// Whether it could not begin a moment ago.
    pub(super) fn has_just_failed(&self) -> bool {
        let failed = self.failed.as_ref();
        failed.is_some_and(|(_, since)| since.elapsed() < RETRY)
    }

    /// Nothing is rendered for a while. Returns the problem where it is another one than before.
    pub(super) fn fail(&mut self, problem: String) -> Option<String> {
        let is_known = (self.failed.as_ref()).is_some_and(|(known, _)| *known == problem);
        self.failed = Some((problem.clone(), Instant::now()));
        if is_known {
            return None;
        }
        error!("{problem}");
        Some(problem)
    }

    pub(super) fn retire(&mut self) {
        if let Some(running) = self.running.take() {
            running.render.cancel();
            if let Some(darkroom) = &self.darkroom {
                darkroom.retire(running.render);
            }
        }
    }
}

impl Drop for TracedRender {
    fn drop(&mut self) {
        self.retire();
    }
}

/// What a view shall show.
pub(super) struct Wanted {
    pub world: Arc<trace::World>,
    pub camera: trace::Camera,
    pub settings: RenderSettings,
    /// In pixels; all where that is `None`.
    pub region: Option<URect>,
    pub mix: LightMix,
    pub order: Order,
}

impl TracedRender {
    /// Whether it is what is being rendered.
    pub(super) fn renders(&self, wanted: &Wanted) -> bool {
        self.running.as_ref().is_some_and(|running| {
            Arc::ptr_eq(&running.world, &wanted.world)
                && running.camera == wanted.camera
                && running.settings == wanted.settings
                && running.region == wanted.region
                && running.mix == wanted.mix
        })
    }

    /// Prints are made in this way from now on.
    pub(super) fn develop(&mut self, order: Order) {
        if let Self {
            running: Some(running),
            darkroom: Some(darkroom),
            ..
        } = self
            && running.order != order
        {
            running.order = order.clone();
            darkroom.develop(&running.render, &running.subject(), order);
        }
    }

    /// Renders this instead of what was rendered before: edits that render where what it has stays true for the most
    /// part, and begins another one elsewhere.
    pub(super) fn begin(&mut self, wanted: Wanted) -> Option<String> {
        let started = Instant::now();
        if let Self {
            running: Some(running),
            darkroom: Some(darkroom),
            ..
        } = self
            && running.takes(&wanted)
        {
            running.started = started;
            darkroom.develop(&running.render, &running.subject(), wanted.order);
            return None;
        }
        self.retire();
        let Wanted {
            world,
            camera,
            settings,
            region,
            mix,
            order,
        } = wanted;
        let (scene, seen_from, how) = ((*world).clone(), camera.clone(), settings.clone());
        let render = match Progressive::start_region(scene, seen_from, how, region, &mix) {
            Ok(render) => Arc::new(render),
            Err(problem) => {
                return self.fail(format!("the traced view cannot render: {problem}"));
            }
        };
        self.failed = None;
        let running = Running {
            render,
            world,
            camera,
            settings,
            region,
            mix,
            order: order.clone(),
            started,
            paused: false,
            focus: Vec2::splat(0.5),
        };
        if let Some(darkroom) = &self.darkroom {
            darkroom.develop(&running.render, &running.subject(), order);
        }
        self.running = Some(running);
        None
    }
}

impl Running {
    /// Makes the render one of what is wanted, where it can be edited so.
    fn takes(&mut self, wanted: &Wanted) -> bool {
        let same_view = self.camera == wanted.camera
            && self.settings == wanted.settings
            && self.region == wanted.region
            && self.mix.apart == wanted.mix.apart;
        let gains = &wanted.mix.gains;
        if !(same_view && self.render.edit((*wanted.world).clone(), gains)) {
            return false;
        }
        self.world = wanted.world.clone();
        self.mix = wanted.mix.clone();
        self.order = wanted.order.clone();
        true
    }

    fn subject(&self) -> Subject {
        Subject {
            world: self.world.clone(),
            camera: self.camera.clone(),
            settings: self.settings.clone(),
            region: self.region,
        }
    }

    pub(super) fn direct(&mut self, view: &TracedView) {
        if self.paused != view.paused {
            self.paused = view.paused;
            if view.paused {
                self.render.pause();
            } else {
                self.render.resume();
            }
        }
        if self.focus != view.focus && view.focus.is_finite() {
            self.focus = view.focus;
            self.render
                .set_focus(view.focus * self.settings.size.as_vec2());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Ending;
    use bevy::math::{Quat, Vec3};
    use bevy::prelude::default;

    fn wanted(region: Option<URect>) -> Wanted {
        let camera = trace::Camera::new(Vec3::ZERO, Quat::IDENTITY, default(), default());
        let settings = RenderSettings {
            size: UVec2::new(64, 48),
            spp: 2,
            ..RenderSettings::default()
        };
        Wanted {
            world: Arc::default(),
            camera,
            order: Order {
                output: settings.output,
                view: crate::film::views::View::Shaded,
                range: None,
            },
            settings,
            region,
            mix: LightMix::default(),
        }
    }

    #[test]
    fn of_a_region_only_the_pixels_in_it_are_rendered_and_another_one_is_another_render() {
        let region = Some(URect::new(16, 16, 32, 32));
        let mut view = TracedRender::default();
        let wanted = wanted(region);
        let world = wanted.world.clone();
        view.begin(wanted);
        let render = view.render().unwrap();
        assert_eq!(render.wait(), Ending::Samples);
        let film = render.film();
        assert_eq!((film.count(20, 20), film.count(40, 20)), (2, 0));
        for (other, same) in [(region, true), (None, false)] {
            let mut wanted = super::tests::wanted(other);
            wanted.world = world.clone();
            assert_eq!(view.renders(&wanted), same);
        }
    }
}
