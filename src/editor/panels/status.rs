//! The line below: what the traced view has, how fast it gets on, and what is under the pointer.

use super::says::{Says, take_hint};
use crate::editor::action::Action;
use crate::editor::edits::name_of;
use crate::editor::navigation::LookThrough;
use crate::editor::notice::Notices;
use crate::editor::render_job::RenderJob;
use crate::editor::texts::counted;
use crate::editor::viewport::traced_render;
use crate::film::{Ending, ErrorEstimate, State};
use crate::io::LoadProblems;
use crate::sync::Traced;
use crate::trace;
use crate::view::TracedRender;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy_egui::egui::{self, Button, Label, Popup, PopupCloseBehavior, RichText, ScrollArea, Ui};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How often the memory is asked for.
const MEMORY_INTERVAL: Duration = Duration::from_secs(1);
/// Points of the list of notes.
const NOTES_WIDTH: f32 = 480.0;
const NOTES_HEIGHT: f32 = 320.0;
/// Lines of one kind that are laid out in every frame while the list is open.
const MOST_LINES: usize = 200;

/// What the line remembers between two frames.
#[derive(Resource, Default)]
pub(super) struct StatusBar {
    numbers: Numbers,
    memory: Memory,
}

pub(super) fn status_ui(ui: &mut Ui, world: &mut World, bar: &mut StatusBar) {
    let hint = take_hint(ui.ctx());
    let render = traced_render(world);
    let status = render.and_then(TracedRender::status);
    let shown = render.and_then(TracedRender::shown);
    let (mut opens, mut forgets) = (false, false);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 14.0;
        forgets = notes_ui(ui, world);
        if let Some(status) = &status {
            let state = match status.state {
                State::Running => "",
                State::Paused => " paused",
                State::Ended(Ending::Cancelled) => " stopped",
                State::Ended(_) => " done",
            };
            let wanted = count(status.samples_wanted);
            figure(
                ui,
                &format!("{} / {wanted} spp{state}", count(status.samples)),
                "Samples of each pixel so far, on average, and how many there shall be",
            );
            let error = status.error().map_or_else(
                || "error –".to_owned(),
                |error| {
                    let slope = status.decline();
                    let trend = slope.map_or_else(String::new, |slope| format!(" ~ t^-{slope:.2}"));
                    format!("error {}{trend}", error_text(&error))
                },
            );
            figure(
                ui,
                &error,
                "Estimated relative error of the picture, and how it falls with time: t^-0.5 is plain random sampling. At most: what may hide that no sample has met, where the samples themselves differ by less",
            );
            figure(
                ui,
                &format!("{:.2} Mrays/s", status.mrays_per_s()),
                "Million rays of all kinds a second, all threads together",
            );
        } else {
            figure(ui, "not tracing", "The view shows no traced picture");
        }
        if let Some(shown) = shown {
            let ms = shown.first_picture.as_secs_f64() * 1e3;
            figure(
                ui,
                &format!("{ms:.0} ms to picture"),
                "From the last edit to the first picture of it on the screen",
            );
        }
        let numbers = bar.numbers.of(world.resource::<Traced>());
        figure(
            ui,
            &counted(numbers.triangles, "triangle"),
            "Triangles of all objects; a mesh that two objects share counts twice",
        );
        figure(
            ui,
            &counted(numbers.lights as u64, "light"),
            "Lights that are traced: hidden ones are not",
        );
        if let Some(bytes) = bar.memory.bytes() {
            figure(
                ui,
                &memory_text(bytes),
                "Memory of the whole program",
            );
        }
        camera_ui(ui, world);
        opens = job_ui(ui, world);
        if let Some(hint) = hint {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.add(egui::Label::new(RichText::new(hint).weak()).truncate());
            });
        }
    });
    if forgets {
        world.resource_mut::<Notices>().forget_kept();
    }
    if opens {
        world.write_message(Action::run("file.render"));
    }
}

fn figure(ui: &mut Ui, text: &str, says: &str) {
    ui.label(text).says(says);
}

/// Which of the scene's cameras is looked through.
fn camera_ui(ui: &mut Ui, world: &World) {
    let through = world.get_resource::<LookThrough>();
    if let Some(camera) = through.and_then(|through| through.camera) {
        let says = "The camera that the view looks through: moving the view leaves it (0)";
        figure(ui, &format!("through {}", name_of(world, camera)), says);
    }
}

/// How far a render to a file is; true where its dialog is asked for.
fn job_ui(ui: &mut Ui, world: &World) -> bool {
    let progress = world
        .get_resource::<RenderJob>()
        .and_then(RenderJob::progress);
    let Some(progress) = progress else {
        return false;
    };
    let text = format!("rendering {:.0} %", progress.fraction * 100.0);
    let says = "A picture is being rendered to a file; click to see it, or to stop it";
    ui.add(egui::Button::new(text).small()).says(says).clicked()
}

/// What cannot be loaded or traced as it is, and what was said and mattered: closed messages are found again here.
///
/// True where the latter are to be forgotten.
fn notes_ui(ui: &mut Ui, world: &World) -> bool {
    let load = &world.resource::<LoadProblems>().problems;
    let sync = &world.resource::<Traced>().problems;
    let problems = load.len() + sync.len();
    let kept = world.resource::<Notices>().kept();
    if problems == 0 && kept.is_empty() {
        return false;
    }
    // What was said may be of another scene by now.
    let warns = problems > 0;
    let color = match warns {
        true => ui.visuals().warn_fg_color,
        false => ui.visuals().text_color(),
    };
    // As many as the cards say.
    let said: usize = kept.iter().map(|notice| notice.lines.len().max(1)).sum();
    let count = (problems + said) as u64;
    let text = format!(
        "{}{}",
        if warns { "⚠ " } else { "" },
        counted(count, "note")
    );
    let button = Button::new(RichText::new(text).color(color)).small();
    let response = ui
        .add(button)
        .says("What cannot be drawn as it is, what failed, and what files left out; click to read");
    let mut forgets = false;
    Popup::menu(&response)
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
        .show(|ui| {
            ui.set_width(NOTES_WIDTH.min(ui.ctx().content_rect().width() - 40.0));
            let area = ScrollArea::vertical().max_height(NOTES_HEIGHT);
            area.show(ui, |ui| {
                let load = load
                    .iter()
                    .map(|one| format!("{}: {}", one.what, one.error));
                let sync = sync.iter().map(ToString::to_string);
                lines_ui(ui, problems, load.chain(sync));
                for notice in kept.iter().rev() {
                    let text = RichText::new(&notice.text).strong();
                    ui.add(Label::new(text).wrap().selectable(true));
                    lines_ui(ui, notice.lines.len(), &notice.lines);
                }
            });
            if !kept.is_empty() {
                let forget = ui.small_button("Forget what was said");
                let says = "Empties this list but for what still cannot be drawn";
                forgets = forget.says(says).clicked();
            }
        });
    forgets
}

/// Lines to be read, as many as somebody reads.
fn lines_ui(
    ui: &mut Ui,
    count: usize,
    lines: impl IntoIterator<Item = impl Into<egui::WidgetText>>,
) {
    for line in lines.into_iter().take(MOST_LINES) {
        ui.add(Label::new(line).wrap().selectable(true));
    }
    if let Some(more) = count.checked_sub(MOST_LINES).filter(|more| *more > 0) {
        ui.weak(format!("and {more} more"));
    }
}

/// What is counted of a traced world; counted again only when it is another.
#[derive(Default)]
pub(super) struct Numbers {
    of: Option<Arc<trace::World>>,
    pub triangles: u64,
    pub lights: usize,
}

impl Numbers {
    /// Of this world.
    pub fn of(&mut self, traced: &Traced) -> &Self {
        let world = &traced.world;
        if self.of.as_ref().is_some_and(|of| Arc::ptr_eq(of, world)) {
            return self;
        }
        let objects = world.objects.iter();
        *self = Self {
            of: Some(world.clone()),
            triangles: objects
                .map(|object| object.mesh.tree.triangles().len() as u64)
                .sum(),
            lights: world.lights.count() + usize::from(world.environment.lights),
        };
        self
    }
}

/// The memory of this process, asked for now and then.
#[derive(Default)]
pub(super) struct Memory {
    known: Option<(u64, Instant)>,
}

impl Memory {
    /// Bytes that are in memory; `None` where the system does not say in a file.
    fn bytes(&mut self) -> Option<u64> {
        if self
            .known
            .is_none_or(|(_, when)| when.elapsed() > MEMORY_INTERVAL)
        {
            let text = std::fs::read_to_string("/proc/self/status").ok()?;
            let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
            let kib: u64 = line.split_whitespace().next()?.parse().ok()?;
            self.known = Some((kib * 1024, Instant::now()));
        }
        self.known.map(|(bytes, _)| bytes)
    }
}

/// `12`, `3.5`: an average that is whole is shown whole.
pub(super) fn count(samples: f64) -> String {
    if samples.fract() == 0.0 || samples >= 100.0 {
        format!("{samples:.0}")
    } else {
        format!("{samples:.1}")
    }
}

/// A picture's error; a bound is rounded up, so that it is not 0.
pub(super) fn error_text(error: &ErrorEstimate) -> String {
    if error.is_bound {
        error.to_string()
    } else {
        percent(error.relative())
    }
}

/// `12 %`, `0.34 %`, `< 0.01 %`.
pub(super) fn percent(part: f64) -> String {
    let percent = part * 100.0;
    match percent {
        p if !p.is_finite() => "–".into(),
        p if p >= 10.0 => format!("{p:.0} %"),
        p if p >= 1.0 => format!("{p:.1} %"),
        p if p > 0.0 && p < 0.005 => "< 0.01 %".into(),
        p => format!("{p:.2} %"),
    }
}

/// `12.3 MB`, `1.2 GB`.
pub(super) fn memory_text(bytes: u64) -> String {
    let mb = bytes as f64 * 1e-6;
    match mb {
        mb if mb >= 1000.0 => format!("{:.1} GB", mb * 1e-3),
        mb if mb >= 100.0 => format!("{mb:.0} MB"),
        mb if mb >= 0.1 => format!("{mb:.1} MB"),
        _ => format!("{:.1} kB", mb * 1e3),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_written_with_as_many_digits_as_mean_something() {
        assert_eq!([1.0, 3.25, 250.4].map(count), ["1", "3.2", "250"]);
        assert_eq!(
            [0.25, 0.034, 0.0012, 0.000_02, 0.0, f64::NAN].map(percent),
            ["25 %", "3.4 %", "0.12 %", "< 0.01 %", "0.00 %", "–"]
        );
        assert_eq!(
            [900, 4_560_000, 2_340_000_000].map(memory_text),
            ["0.9 kB", "4.6 MB", "2.3 GB"]
        );
    }
}
