//! The systems that can be switched, and how each is brought into a scene.

use super::{Specimen, State};
use crate::scene::{PixelSampling, RenderSettings};
use glam::Vec3;

/// A system of the picture.
pub struct Effect {
    /// Its number in the README's table of systems.
    pub row: &'static str,
    /// What it is called.
    pub name: &'static str,
    /// Switches it.
    pub switch: fn(&mut RenderSettings, bool),
    /// Puts into the scene what it shows itself on.
    pub bring_in: fn(&mut Specimen),
    /// Takes out of the scene what it shows itself on, where the plain scene has it.
    pub take_out: fn(&mut Specimen),
    /// Whether a scene can be without it.
    pub can_lack: bool,
}

impl Effect {
    /// The scene in one of the three states.
    pub fn specimen(&self, state: State) -> Specimen {
        let mut specimen = Specimen::plain();
        match state {
            State::Used => (self.bring_in)(&mut specimen),
            State::Off | State::Absent => (self.take_out)(&mut specimen),
        }
        (self.switch)(&mut specimen.settings, state != State::Off);
        specimen
    }
}

const fn effect(
    row: &'static str,
    name: &'static str,
    switch: fn(&mut RenderSettings, bool),
    bring_in: fn(&mut Specimen),
) -> Effect {
    Effect {
        row,
        name,
        switch,
        bring_in,
        take_out: |_| {},
        can_lack: true,
    }
}

/// One that the plain scene has, as every scene does.
const fn always(
    row: &'static str,
    name: &'static str,
    switch: fn(&mut RenderSettings, bool),
) -> Effect {
    Effect {
        can_lack: false,
        ..effect(row, name, switch, |_| {})
    }
}

/// All of them, in the order of the systems' numbers.
pub static EFFECTS: [Effect; 15] = [
    always("S1", "shading", |s, on| s.features.shading = on),
    effect("S2", "mirrors", |s, on| s.features.mirrors = on, shine),
    always("S3", "shadows", |s, on| s.features.shadows = on),
    effect(
        "S4",
        "area light",
        |s, on| s.features.soft_shadows = on,
        Specimen::area_light,
    ),
    Effect {
        take_out: Specimen::without_normals,
        ..effect(
            "S7",
            "normal interpolation",
            |s, on| s.features.normal_interpolation = on,
            |_| {},
        )
    },
    effect(
        "S8",
        "textures",
        |s, on| s.features.textures = on,
        Specimen::texture,
    ),
    effect(
        "S9",
        "environment map",
        |s, on| s.features.environment = on,
        Specimen::environment_map,
    ),
    effect(
        "S11",
        "motion of the camera",
        |s, on| s.features.motion = on,
        |specimen| {
            specimen.camera.optics.velocity = Vec3::X * 0.1;
            specimen.camera.optics.motion_samples = 4;
        },
    ),
    effect(
        "S11",
        "motion of objects",
        |s, on| s.features.motion = on,
        |specimen| specimen.moving(Vec3::X * 0.1, 4),
    ),
    // Bloom has no scene that lacks it: it is applied to every picture where it is on.
    Effect {
        bring_in: |specimen| specimen.settings.output.bloom.threshold = 0.0,
        ..always("S12", "bloom", |s, on| s.output.bloom.enabled = on)
    },
    always("S13", "smooth edges", |s, on| {
        s.pixel = if on {
            PixelSampling::Area
        } else {
            PixelSampling::Center
        };
    }),
    effect("S14", "gloss", |s, on| s.features.glossy = on, shine),
    effect(
        "S15",
        "transparency",
        |s, on| s.features.transparency = on,
        let_through,
    ),
    effect(
        "S15",
        "translucency",
        |s, on| s.features.translucency = on,
        let_through,
    ),
    effect(
        "S16",
        "lens",
        |s, on| s.features.lens = on,
        |specimen| {
            specimen.camera.optics.aperture_radius = 0.02;
            specimen.camera.optics.lens_samples = 4;
        },
    ),
];

fn shine(specimen: &mut Specimen) {
    specimen.material(|material| {
        material.specular = Vec3::splat(0.3);
        material.mirror = Vec3::splat(0.3);
    });
}

fn let_through(specimen: &mut Specimen) {
    specimen.material(|material| material.opacity = 0.5);
}
