//! scratch
use glassbox::film::*;
use glassbox::io::{OpenOptions, SceneSource, open, builtin};
use glassbox::scene::RenderSettings;
use glassbox::sync::{Traced, TracedCameras};
use std::io::Write;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let size: u32 = a[1].parse().unwrap();
    let top: u64 = a[2].parse().unwrap();
    let seed: u32 = a[3].parse().unwrap();
    for scene in builtin::SCENES {
        let mut app = glassbox::app::headless_app();
        open(app.world_mut(), &SceneSource::named(std::path::Path::new(scene.name)), OpenOptions::default()).unwrap();
        app.update();
        let world = app.world().resource::<Traced>().world.clone();
        let camera = app.world().resource::<TracedCameras>().0[0].camera.clone();
        let mut settings = app.world().resource::<RenderSettings>().clone();
        settings.size = glam::UVec2::splat(size);
        settings.seed = seed;
        let t = std::time::Instant::now();
        let mut film = Film::new(settings.size);
        let mut f = std::io::BufWriter::new(std::fs::File::create(format!("/tmp/film-scratch/dumpb/{}-{seed}.bin", scene.name)).unwrap());
        let (mut from, mut to, mut rays) = (0u64, 1u64, 0);
        while to <= top {
            let r = render_samples(&world, &camera, &settings, from..to, &|_| {});
            rays += r.rays.total();
            film.merge(&r.film);
            for p in film.picture().pixels { for c in p.to_array() { f.write_all(&c.to_le_bytes()).unwrap(); } }
            from = to; to *= 2;
        }
        println!("{} {:.1}s {:.2} Mray/s {:.1} rays/sample lens {} glossy {}", scene.name, t.elapsed().as_secs_f64(), rays as f64 / t.elapsed().as_secs_f64() * 1e-6, rays as f64 / (top as f64 * (size * size) as f64), camera.has_lens(), settings.features.glossy);
    }
}
