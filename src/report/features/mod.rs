//! Only what a scene needs: what each system costs unused, on but absent, and used; and what it changes.

mod effects;
mod specimen;
mod trees;

pub use effects::{EFFECTS, Effect};
pub use specimen::Specimen;

use super::table::digits;
use super::timing::{median, take_turns};
use super::{Cell, Options, Section, Subject, Table, Watch};
use crate::film::{Picture, develop, render};
use crate::scene::{Features, RenderSettings, Sampling};
use crate::trace::Camera;
use glam::UVec2;
use std::hint::black_box;

/// The three states in which a system is timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Switched off, in a scene that does not use it.
    Off,
    /// Switched on, in a scene that does not use it.
    Absent,
    /// Switched on, in a scene that uses it.
    Used,
}

/// Pixels a side, and samples of each.
fn effort(options: &Options) -> (u32, u32) {
    if options.quick { (64, 4) } else { (128, 4) }
}

fn rounds(options: &Options) -> usize {
    if options.quick { 3 } else { 9 }
}

/// Measures every effect on the specimen, and every switch on every scene.
pub fn measure(subjects: &[Subject], options: &Options, watch: Watch) -> Section {
    // One thread, so that no picture waits for another thread's last tile.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let work = || measure_alone(subjects, options, watch);
    match pool {
        Ok(pool) => pool.install(work),
        Err(_) => work(),
    }
}

fn measure_alone(subjects: &[Subject], options: &Options, watch: Watch) -> Section {
    let (side, spp) = effort(options);
    let mut section = Section {
        title: "Features: what each costs, and what it changes".into(),
        method: vec![format!(
            "Each system is rendered in three states that take turns on one thread, {side}x{side} pixels, {spp} samples, {} \
             rounds: off in a scene without it, on in the same scene (absent), and on in a scene that uses it. Absent must cost \
             what off costs. Change is the RMSE of the scene that uses it with the switch on and off, over the root mean \
             square of the picture. Where every scene uses a system there is no absent. The systems are numbered as in the \
             README's table of systems.",
            rounds(options)
        )],
        ..Section::default()
    };
    let mut table = Table::new(
        "features",
        "Systems: milliseconds for a picture, and how it changes",
        &[
            "number",
            "system",
            "off",
            "absent",
            "used",
            "absent / off",
            "used / off",
            "change",
        ],
    );
    let mut ratios = Vec::new();
    for (number, effect) in EFFECTS.iter().enumerate() {
        watch("features", number as u64, EFFECTS.len() as u64);
        let measured = measure_effect(effect, options);
        ratios.extend(
            measured
                .absent
                .map(|absent| (absent / measured.off, effect.name)),
        );
        let used = measured.used / measured.off;
        table.push([
            effect.row.into(),
            effect.name.into(),
            (1e3 * measured.off).into(),
            measured.absent.map(|absent| 1e3 * absent).into(),
            (1e3 * measured.used).into(),
            measured.absent.map(|absent| absent / measured.off).into(),
            used.into(),
            measured.change.into(),
        ]);
        if measured.change == 0.0 {
            section.failures.push(format!(
                "{} ({}) changes nothing where it is used",
                effect.name, effect.row
            ));
        }
    }
    section.findings.push(finding(&ratios));
    section.tables.push(table);
    section.summary = Some(0);
    section
        .tables
        .push(trees::measure(options, &mut section.failures));
    for subject in subjects {
        watch(&format!("features of {}", subject.name), 0, 1);
        section.tables.push(switches(subject, options));
    }
    section
}

struct Measured {
    off: f64,
    absent: Option<f64>,
    used: f64,
    change: f64,
}

fn measure_effect(effect: &Effect, options: &Options) -> Measured {
    let (side, spp) = effort(options);
    let states = [State::Off, State::Absent, State::Used].map(|state| {
        let mut specimen = effect.specimen(state);
        specimen.settings.size = UVec2::splat(side);
        specimen.settings.spp = spp;
        specimen.settings.seed = options.seed;
        specimen
    });
    let times = take_turns(states.len(), rounds(options), |i| {
        black_box(states[i].picture());
    });
    let mut without = states[2].clone();
    (effect.switch)(&mut without.settings, false);
    let (on, off) = (states[2].developed(), without.developed());
    Measured {
        off: times[0],
        absent: effect.can_lack.then_some(times[1]),
        used: times[2],
        change: on.rmse(&off).unwrap_or(f64::NAN) / root_mean_square(&off),
    }
}

fn root_mean_square(picture: &Picture) -> f64 {
    let black = Picture::black(picture.size());
    picture.rmse(&black).unwrap_or(f64::NAN).max(1e-12)
}

fn finding(ratios: &[(f64, &'static str)]) -> String {
    let typical = median(ratios.iter().map(|ratio| ratio.0).collect());
    let worst = ratios.iter().max_by(|a, b| a.0.total_cmp(&b.0));
    let (most, name) = worst.copied().unwrap_or((f64::NAN, "none"));
    format!(
        "Switching on a system that the scene does not use changes the render time by {} % (median of {} systems), at most \
         {} % ({name}).",
        signed_percent(typical),
        ratios.len(),
        signed_percent(most),
    )
}

fn signed_percent(ratio: f64) -> String {
    let percent = 100.0 * (ratio - 1.0);
    if percent < 0.0 {
        format!("−{}", digits(-percent, 2))
    } else {
        digits(percent, 2)
    }
}

/// A switch's name, and where it is.
type Switch = (&'static str, fn(&mut Features) -> &mut bool);

const SWITCHES: [Switch; 12] = [
    ("shading", |f| &mut f.shading),
    ("mirrors", |f| &mut f.mirrors),
    ("shadows", |f| &mut f.shadows),
    ("soft shadows", |f| &mut f.soft_shadows),
    ("normal interpolation", |f| &mut f.normal_interpolation),
    ("textures", |f| &mut f.textures),
    ("environment", |f| &mut f.environment),
    ("gloss", |f| &mut f.glossy),
    ("transparency", |f| &mut f.transparency),
    ("translucency", |f| &mut f.translucency),
    ("lens", |f| &mut f.lens),
    ("motion", |f| &mut f.motion),
];

/// Each switch of a scene, turned to its other side.
fn switches(subject: &Subject, options: &Options) -> Table {
    let (side, _) = effort(options);
    let base = RenderSettings {
        size: UVec2::splat(side),
        spp: 1,
        seed: options.seed,
        sampling: Sampling::default(),
        ..subject.settings.clone()
    };
    let mut variants = vec![base.clone()];
    variants.extend(SWITCHES.iter().map(|(_, switch)| {
        let mut settings = base.clone();
        let on = switch(&mut settings.features);
        *on = !*on;
        settings
    }));
    let picture = |settings: &RenderSettings| {
        let camera = through_lens(&subject.camera, settings);
        render(&subject.world, &camera, settings, &|_, _| {}).picture
    };
    let rounds = rounds(options).div_ceil(2);
    let times = take_turns(variants.len(), rounds, |i| {
        black_box(picture(&variants[i]));
    });
    let as_it_is = picture(&base);
    let mut table = Table::new(
        &format!("features-{}", subject.file()),
        &format!(
            "{}: what each switch costs and changes in this scene",
            subject.name
        ),
        &[
            "switch",
            "is",
            "ms as it is",
            "ms turned",
            "time turned / as it is",
            "change when turned",
        ],
    );
    for (number, (name, switch)) in SWITCHES.iter().enumerate() {
        let mut features = base.features;
        let change = picture(&variants[number + 1])
            .rmse(&as_it_is)
            .unwrap_or(f64::NAN);
        table.push([
            (*name).into(),
            (if *switch(&mut features) { "on" } else { "off" }).into(),
            (1e3 * times[0]).into(),
            (1e3 * times[number + 1]).into(),
            (times[number + 1] / times[0]).into(),
            Cell::from(change / root_mean_square(&as_it_is)),
        ]);
    }
    table
}

/// The camera as the settings want it: a lens that is switched off is a pinhole. (In an app the sync sees to that.)
fn through_lens(camera: &Camera, settings: &RenderSettings) -> Camera {
    let mut camera = camera.clone();
    if !settings.features.lens {
        camera.optics.aperture_radius = 0.0;
    }
    camera
}

/// A picture as a screen shows it, as numbers to compare.
fn shown(picture: &Picture, settings: &RenderSettings) -> Picture {
    let pixels = develop(picture, &settings.output);
    Picture {
        pixels: pixels.into_iter().map(Into::into).collect(),
        ..picture.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_absent_changes_no_bit_of_the_picture_and_what_is_used_does() {
        for effect in &EFFECTS {
            let [off, absent, used] = [State::Off, State::Absent, State::Used].map(|state| {
                let mut specimen = effect.specimen(state);
                specimen.settings.size = UVec2::splat(24);
                specimen.settings.spp = 2;
                specimen
            });
            if effect.can_lack {
                assert_eq!(
                    off.developed(),
                    absent.developed(),
                    "{} absent",
                    effect.name
                );
            }
            let mut without = used.clone();
            (effect.switch)(&mut without.settings, false);
            assert_ne!(
                used.developed(),
                without.developed(),
                "{} used",
                effect.name
            );
        }
    }
}
