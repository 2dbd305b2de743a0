use super::control::Signal;
use super::engine::{Engine, Mode};
use super::status::{Ending, Status};
use crate::film::subject::Subject;
use crate::film::{Film, Picture};
use crate::scene::RenderSettings;
use crate::trace::{Camera, World, samples_per_pixel};
use std::ops::Range;

/// A finished picture, and what it took.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// Linear, scene-referred.
    pub picture: Picture,
    /// The sums behind the picture.
    pub film: Film,
    /// Why it ended.
    pub ending: Ending,
    /// Its last numbers: rays traced by kind, seconds of wall-clock time and more.
    pub status: Status,
}

/// Renders every pixel with as many samples as the scene and its settings ask for
/// ([`samples_per_pixel`]), or fewer where `settings.sampling` says so, on the current rayon pool.
///
/// `progress` is told, from any thread, how many samples of how many are done.
pub fn render(
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> Rendered {
    let spp = u64::from(samples_per_pixel(world, camera, settings));
    let pixels = u64::from(settings.size.x) * u64::from(settings.size.y);
    render_samples(world, camera, settings, 0..spp, &|status| {
        progress(
            (status.samples * pixels as f64).round() as u64,
            pixels * spp,
        );
    })
}

/// Renders the samples with these indices of every pixel, or fewer where `settings.sampling` says so,
/// on the current rayon pool. `progress` is called from any thread.
pub fn render_samples(
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
    samples: Range<u64>,
    progress: &(dyn Fn(&Status) + Sync),
) -> Rendered {
    run(world, camera, settings, samples, &|engine| {
        progress(&engine.status());
    })
}

/// What [`render`] renders, for as long as `go_on` says so, which is asked from any thread after
/// every piece of a tile. A render that was ended so has [`Ending::Cancelled`].
pub fn render_while(
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
    go_on: &(dyn Fn(&Status) -> bool + Sync),
) -> Rendered {
    let spp = u64::from(samples_per_pixel(world, camera, settings));
    run(world, camera, settings, 0..spp, &|engine| {
        if !go_on(&engine.status()) {
            engine.control.tell(Signal::Cancel);
        }
    })
}

fn run(
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
    samples: Range<u64>,
    told: &(dyn Fn(&Engine) + Sync),
) -> Rendered {
    let engine = Engine::new(
        Subject::new(world.clone(), camera.clone(), settings.clone(), false),
        Mode {
            watched: false,
            samples,
            region: None,
        },
        None,
    );
    let ending = engine.run(told);
    finish(engine, ending)
}

/// What a render has when it has ended.
pub(super) fn finish(engine: Engine, ending: Ending) -> Rendered {
    let status = engine.status();
    Rendered {
        picture: engine.picture(),
        film: engine.into_film(),
        ending,
        status,
    }
}
