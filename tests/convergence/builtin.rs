//! The built-in scenes with Owen-scrambled Sobol points and with independent random numbers.

use glam::UVec2;
use glassbox::app::headless_app;
use glassbox::film::{Picture, render};
use glassbox::io::builtin;
use glassbox::scene::{RenderSettings, Sequence};
use glassbox::sync::{Traced, TracedCameras};

#[test]
fn sixty_four_samples_have_at_most_two_thirds_of_the_error_of_random_numbers() {
    for (name, glossy) in [
        ("cube-segment-light", false),
        ("cornell-box-parallelogram-light", false),
        ("textured-cube", false),
        ("teapot", false),
        ("knot", false),
        ("spheres", false),
        ("spheres", true),
        ("marbles", true),
        ("showcase", true),
    ] {
        let mut app = headless_app();
        (builtin::find(name).unwrap().spawn)(app.world_mut());
        app.update();
        let world = app.world().resource::<Traced>().world.clone();
        let camera = app.world().resource::<TracedCameras>().0[0].camera.clone();
        let settings = app.world().resource::<RenderSettings>().clone();
        let picture = |spp, seed, sequence| -> Picture {
            let mut settings = RenderSettings {
                size: UVec2::splat(24),
                spp,
                seed,
                sequence,
                ..settings.clone()
            };
            settings.features.glossy = glossy;
            render(&world, &camera, &settings, &|_, _| {}).picture
        };
        let reference = picture(2048, 999, Sequence::Sobol);
        // A few pixels with rare, bright samples carry most of the error: one seed says little.
        let rmse = |sequence| {
            let square = |seed| {
                picture(64, seed, sequence)
                    .rmse(&reference)
                    .unwrap()
                    .powi(2)
            };
            ((1..=6).map(square).sum::<f64>() / 6.0).sqrt()
        };
        let (ours, random) = (rmse(Sequence::Sobol), rmse(Sequence::Independent));
        println!(
            "{name}: {:.3} of the error of random numbers",
            ours / random
        );
        assert!(
            ours <= 0.65 * random,
            "{name}: RMSE {ours:.5} against {random:.5} of random numbers"
        );
    }
}
