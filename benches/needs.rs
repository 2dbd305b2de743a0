//! Only what a scene needs: what each effect costs where a scene does not use it, and where it does.
//!
//! `cargo bench --bench needs`: for each effect the same picture with the effect switched off, on
//! but absent from a scene that can be without it, and on and used. The first two must not differ. `glassbox report features`
//! makes a table of the same scenes. Instructions are repeatable where times are not:
//!
//! ```sh
//! for on in false true; do
//!     valgrind --tool=callgrind --callgrind-out-file=/dev/null target/release/glassbox render head \
//!         -o h.png --size 64x64 --spp 16 --threads 1 --quiet --set features.transparency=$on
//! done
//! ```

use divan::Bencher;
use glam::UVec2;
use glassbox::app::headless_app;
use glassbox::io::builtin;
use glassbox::report::features::{EFFECTS, Specimen, State};
use glassbox::scene::{Alpha, PhongMap, RenderSettings, TextureFilter};
use glassbox::sync::{Traced, TracedCameras};
use glassbox::trace::{Map, World};

fn main() {
    divan::main();
}

fn names() -> impl Iterator<Item = &'static str> {
    EFFECTS.iter().map(|effect| effect.name)
}

/// Of what a scene can be without: others there are in every scene, and on they are used.
fn names_of_absent() -> impl Iterator<Item = &'static str> {
    let absent = EFFECTS.iter().filter(|effect| effect.can_lack);
    absent.map(|effect| effect.name)
}

fn bench(bencher: Bencher, name: &str, state: State) {
    let effect = EFFECTS.iter().find(|effect| effect.name == name);
    let mut specimen = effect.expect("one of the names").specimen(state);
    specimen.settings.size = UVec2::splat(128);
    specimen.settings.spp = 4;
    bencher.bench_local(|| specimen.picture());
}

#[divan::bench(args = names(), sample_count = 20)]
fn off(bencher: Bencher, effect: &str) {
    bench(bencher, effect, State::Off);
}

#[divan::bench(args = names_of_absent(), sample_count = 20)]
fn on_but_absent(bencher: Bencher, effect: &str) {
    bench(bencher, effect, State::Absent);
}

#[divan::bench(args = names(), sample_count = 20)]
fn on_and_used(bencher: Bencher, effect: &str) {
    bench(bencher, effect, State::Used);
}

/// What a material may have beside its numbers: none of it costs anything where it is absent.
#[divan::bench(args = MATERIALS.iter().map(|(name, _)| *name), sample_count = 20)]
fn materials(bencher: Bencher, name: &str) {
    let bring_in = MATERIALS.iter().find(|(other, _)| *other == name);
    let (_, bring_in) = bring_in.expect("one of the names");
    let mut specimen = Specimen::plain();
    bring_in(&mut specimen);
    specimen.settings.size = UVec2::splat(128);
    specimen.settings.spp = 4;
    bencher.bench_local(|| specimen.picture());
}

/// What is done to a scene.
type Change = fn(&mut Specimen);

const MATERIALS: [(&str, Change); 6] = [
    ("plain", |_| {}),
    ("diffuse map", Specimen::texture),
    ("normal map", |specimen| {
        specimen.texture();
        specimen.material(|material| material.maps = vec![Map::new(PhongMap::Normal, 0)]);
    }),
    ("all maps", |specimen| {
        specimen.texture();
        let all = || PhongMap::ALL.map(|map| Map::new(map, 0)).to_vec();
        specimen.material(|material| material.maps = all());
    }),
    ("mask", |specimen| {
        specimen.texture();
        specimen.material(|material| {
            material.alpha = Alpha::Mask { cutoff: 0.5 };
            material.maps = vec![Map::new(PhongMap::Opacity, 0)];
        });
    }),
    ("vertex colours", Specimen::vertex_colors),
];

/// Filters of a texture look-up, on a scene that has textures: mipmaps cost only who asks for them.
#[divan::bench(args = [TextureFilter::Nearest, TextureFilter::Bilinear, TextureFilter::Mipmap], sample_count = 20)]
fn textures(bencher: Bencher, filter: TextureFilter) {
    let mut app = headless_app();
    (builtin::find("textured-cube")
        .expect("a built-in scene")
        .spawn)(app.world_mut());
    app.update();
    let specimen = Specimen {
        world: World::clone(&app.world().resource::<Traced>().world),
        camera: app.world().resource::<TracedCameras>().0[0].camera.clone(),
        settings: RenderSettings {
            size: UVec2::splat(128),
            spp: 4,
            texture_filter: filter,
            ..app.world().resource::<RenderSettings>().clone()
        },
    };
    bencher.bench_local(|| specimen.picture());
}
