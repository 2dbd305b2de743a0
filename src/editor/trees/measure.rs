//! Measurements that a person asks for: the builders compared, and the performance test. Each runs
//! on a thread of its own, shows how far it is, and can be ended; the traced view waits meanwhile,
//! so that the figures are theirs alone.
//!
//! The figures are those of `glassbox bvh` and `glassbox bench`: the same code makes them.

use crate::bvh::{BuildOptions, Builder, Levels};
use crate::editor::background::{Background, Outcome, Watch};
use crate::editor::document::{Document, SceneOpened};
use crate::editor::viewport::{traced_render, traced_view_mut};
use crate::inspect::{BuilderFigures, compare_builders_told, same_geometry};
use crate::report::performance::{Performance, PerformanceError, PerformanceTest, performance};
use crate::scene::{RenderSettings, Sampling};
use crate::sync::{Traced, TracedCameras};
use crate::trace::{self, Camera};
use crate::view::TracedRender;
use bevy::ecs::observer::On;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::ResMut;
use bevy::ecs::world::{Mut, World};
use std::ops::ControlFlow;
use std::sync::Arc;

/// The builders in the order of all tables.
pub(in crate::editor) const BUILDERS: [Builder; 4] =
    [Builder::None, Builder::Median, Builder::Sah, Builder::Ploc];

/// Measurements that are under way, and what was measured.
#[derive(Resource, Default)]
pub(in crate::editor) struct Measurements {
    pub comparison: Measurement<Vec<BuilderFigures>>,
    pub performance: Measurement<Performance>,
    /// The traced view was going on, and waits for them.
    holds_view: bool,
}

/// One kind of them.
pub(in crate::editor) struct Measurement<T> {
    running: Option<(Background<Result<T, String>>, Subject)>,
    /// Figures outlive their subject, which goes with its scene.
    done: Option<(T, Option<Subject>)>,
    said: Option<String>,
}

impl<T> Default for Measurement<T> {
    fn default() -> Self {
        Self {
            running: None,
            done: None,
            said: None,
        }
    }
}

/// What is measured.
#[derive(Clone)]
struct Subject {
    world: Arc<trace::World>,
    camera: Camera,
    settings: RenderSettings,
}

/// Why figures are not those of the scene as it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::editor) enum Stale {
    /// Other triangles, or at other places.
    Scene,
    /// Trees are built with other settings than then; the builder itself does not count.
    Trees,
    /// The view stands elsewhere, or is of another size.
    View,
}

impl Stale {
    /// A sentence.
    pub fn text(self) -> &'static str {
        match self {
            Self::Scene => "The scene changed since: these figures are of how it was.",
            Self::Trees => "The trees' settings changed since: these figures are of the old ones.",
            Self::View => "The view changed since: rays a second are those of how it was.",
        }
    }
}

impl<T: Send + 'static> Measurement<T> {
    /// What it does now, and which part is done; `None` where it does nothing.
    pub fn progress(&self) -> Option<(String, f32)> {
        let (work, _) = self.running.as_ref()?;
        Some(work.progress())
    }

    /// What was measured last.
    pub fn done(&self) -> Option<&T> {
        self.done.as_ref().map(|(done, _)| done)
    }

    /// Why there is nothing new: it was ended, or could not be done.
    pub fn said(&self) -> Option<&str> {
        self.said.as_deref()
    }

    /// Ends it. What was measured before stays.
    pub fn cancel(&mut self) {
        if self.running.take().is_some() {
            self.said = Some("Cancelled: nothing new was measured.".into());
        }
    }

    /// Why what was measured is not of the scene as it is now.
    pub fn stale(&self, world: &World) -> Option<Stale> {
        let (_, then) = self.done.as_ref()?;
        let Some(then) = then else {
            return Some(Stale::Scene);
        };
        let now = subject(world)?;
        let options = |subject: &Subject| BuildOptions {
            builder: Builder::None,
            levels: Levels::Two,
            ..*subject.world.aggregate.options()
        };
        if !same_geometry(&then.world, &now.world) {
            Some(Stale::Scene)
        } else if options(then) != options(&now) {
            Some(Stale::Trees)
        } else if then.camera != now.camera || then.settings.size != now.settings.size {
            Some(Stale::View)
        } else {
            None
        }
    }

    fn start(
        &mut self,
        name: &str,
        subject: Subject,
        work: impl FnOnce(&Subject, &Watch) -> Result<T, String> + Send + 'static,
    ) {
        self.said = None;
        let of = subject.clone();
        match Background::start(name, move |watch| work(&subject, watch)) {
            Ok(work) => self.running = Some((work, of)),
            Err(error) => self.said = Some(format!("The system has no more threads: {error}")),
        }
    }

    /// Another scene was opened. What is being measured of the one before is of no more use, and would keep this one waiting;
    /// what was measured does not hold its world.
    fn forget_scene(&mut self) {
        self.cancel();
        if let Some((_, of)) = &mut self.done {
            *of = None;
        }
    }

    fn carry_on(&mut self) {
        let Some((work, of)) = &self.running else {
            return;
        };
        match work.take() {
            Outcome::Pending => return,
            Outcome::Done(Ok(done)) => self.done = Some((done, Some(of.clone()))),
            Outcome::Done(Err(why)) => self.said = Some(why),
            Outcome::Lost => self.said = Some("It ended by a bug of Glassbox.".into()),
        }
        self.running = None;
    }
}

/// The scene as it is traced, from where the view stands; from its first camera where the view
/// traces nothing. `None` where there is neither.
fn subject(world: &World) -> Option<Subject> {
    let scene = world.resource::<RenderSettings>().clone();
    let traced = world.resource::<Traced>().world.clone();
    let view = traced_render(world).and_then(TracedRender::subject);
    if let Some((_, camera, settings)) = view {
        return Some(Subject {
            world: traced,
            camera: camera.clone(),
            settings: RenderSettings {
                size: settings.size,
                ..scene
            },
        });
    }
    let cameras = &world.get_resource::<TracedCameras>()?.0;
    Some(Subject {
        world: traced,
        camera: cameras.first()?.camera.clone(),
        settings: scene,
    })
}

/// Begins to compare the builders.
pub(in crate::editor) fn compare(world: &mut World) {
    let of = subject(world);
    world.resource_scope(|world, mut all: Mut<Measurements>| {
        let Some(of) = checked(of, &mut all.comparison) else {
            return;
        };
        all.comparison.start("compare builders", of, |of, watch| {
            let view = Some((&of.camera, &of.settings));
            let mut tell = |what: &str, part: f32| watch.tell(what, part);
            match compare_builders_told(&of.world, &BUILDERS, view, &mut tell) {
                ControlFlow::Continue(figures) => Ok(figures),
                // Who broke it does not listen any more.
                ControlFlow::Break(()) => Err(PerformanceError::Stopped.to_string()),
            }
        });
        all.hold_view(world);
    });
}

/// Begins the performance test: so many renderings of the view with each builder, with so many
/// samples of each pixel.
pub(in crate::editor) fn test_performance(world: &mut World, runs: u32, spp: u32) {
    let of = subject(world);
    let scene = world
        .get_resource::<Document>()
        .map_or_else(|| "scene".to_owned(), |document| document.name.clone());
    world.resource_scope(|world, mut all: Mut<Measurements>| {
        let Some(mut of) = checked(of, &mut all.performance) else {
            return;
        };
        of.settings.spp = spp;
        // As many samples in every rendering, whatever the view stops at.
        of.settings.sampling = Sampling {
            error: 0.0,
            time: 0.0,
            ..of.settings.sampling
        };
        let test = PerformanceTest {
            scene,
            builders: BUILDERS.to_vec(),
            runs,
            with_none: false,
        };
        all.performance
            .start("performance test", of, move |of, watch| {
                let mut tell = |what: &str, part: f32| watch.tell(what, part);
                performance(&test, &of.world, &of.camera, &of.settings, &mut tell)
                    .map_err(|problem| problem.to_string())
            });
        all.hold_view(world);
    });
}

/// What can be measured; what cannot is said.
fn checked<T>(of: Option<Subject>, measurement: &mut Measurement<T>) -> Option<Subject> {
    let Some(of) = of else {
        let text = "There is no view to measure: show the traced view, or add a camera.";
        measurement.said = Some(text.into());
        return None;
    };
    if of.world.objects.is_empty() {
        let text = "There is nothing to measure: the scene has no triangles that are traced.";
        measurement.said = Some(text.into());
        return None;
    }
    Some(of)
}

impl Measurements {
    /// Whether anything is being measured.
    pub fn running(&self) -> bool {
        self.comparison.running.is_some() || self.performance.running.is_some()
    }

    /// The traced view waits from now on.
    fn hold_view(&mut self, world: &mut World) {
        if let Some(mut view) = traced_view_mut(world)
            && self.running()
            && !view.paused
        {
            view.paused = true;
            self.holds_view = true;
        }
    }

    /// It goes on when nothing is measured any more, where it did before.
    fn let_view_go(&mut self, world: &mut World) {
        if self.running() || !std::mem::take(&mut self.holds_view) {
            return;
        }
        if let Some(mut view) = traced_view_mut(world)
            && view.paused
        {
            view.paused = false;
        }
    }
}

pub(super) fn forget_scene(_: On<SceneOpened>, mut all: ResMut<Measurements>) {
    all.comparison.forget_scene();
    all.performance.forget_scene();
}

/// Carries [`Measurements`] on.
pub(super) fn carry_on(world: &mut World) {
    let all = world.resource::<Measurements>();
    if !all.running() && !all.holds_view {
        return;
    }
    world.resource_scope(|world, mut all: Mut<Measurements>| {
        all.comparison.carry_on();
        all.performance.carry_on();
        all.let_view_go(world);
    });
}
