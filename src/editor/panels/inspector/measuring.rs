//! A measurement's button, its progress, and what has to be said of it.

use super::super::says::Says;
use crate::editor::trees::measure::{Measurement, Measurements};
use bevy::ecs::world::{Mut, World};
use bevy_egui::egui::{Button, Label, ProgressBar, RichText, Ui};
use std::time::Duration;

/// How often the bar is drawn while something is measured.
const TICK: Duration = Duration::from_millis(100);

/// The button that begins it, or how far it is with a button that ends it; true where it shall begin.
pub(super) fn measure_ui<T: Send + 'static>(
    ui: &mut Ui,
    world: &mut World,
    name: &str,
    says: &str,
    of: fn(&mut Measurements) -> &mut Measurement<T>,
) -> bool {
    world.resource_scope(|world, mut all: Mut<Measurements>| {
        let busy = all.running();
        let measurement = of(&mut all);
        if let Some((what, part)) = measurement.progress() {
            ui.ctx().request_repaint_after(TICK);
            ui.horizontal(|ui| {
                let width = (ui.available_width() - 66.0).max(80.0);
                let bar = ProgressBar::new(part).desired_width(width).text(what);
                ui.add(bar).says("The traced view waits meanwhile");
                let cancel = ui.button("Cancel");
                if cancel
                    .says("Ends it; what was measured before stays")
                    .clicked()
                {
                    measurement.cancel();
                }
            });
            return false;
        }
        let begin = ui.add_enabled(!busy, Button::new(name)).says(match busy {
            true => "Another measurement is under way: the two would disturb each other",
            false => says,
        });
        if let Some(said) = measurement.said() {
            let color = ui.visuals().warn_fg_color;
            ui.add(Label::new(RichText::new(said).color(color)).wrap());
        }
        if let Some(stale) = measurement.stale(world) {
            let color = ui.visuals().warn_fg_color;
            ui.add(Label::new(RichText::new(stale.text()).color(color)).wrap());
        }
        begin.clicked()
    })
}
