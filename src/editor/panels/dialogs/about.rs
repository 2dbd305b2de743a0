//! What this is, and what it is made with.

use crate::inspect::counted;
use bevy_egui::egui::Ui;

pub(super) fn about_ui(ui: &mut Ui) {
    ui.label(concat!("Glassbox ", env!("CARGO_PKG_VERSION")));
    ui.label("A scene editor whose ray tracer you can see into.");
    ui.add_space(6.0);
    ui.label("Licensed under MIT or Apache 2.0, as you choose.");
    ui.label("Made with Bevy, egui, obvhs, rayon and glam.");
    ui.add_space(6.0);
    let threads = rayon::current_num_threads();
    ui.weak(format!(
        "Tracing on {}; this machine is {} {}.",
        counted(threads as u64, "thread"),
        std::env::consts::OS,
        std::env::consts::ARCH
    ));
}
