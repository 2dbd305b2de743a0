//! Every control says what it does: in a tooltip, and in the status bar while the pointer is over it.

use bevy_egui::egui::{self, Id, Response};

/// Adds the explanation to a control.
pub(super) trait Says {
    /// What the control does to the picture or the scene, as one phrase.
    fn says(self, what: &str) -> Self;
}

impl Says for Response {
    fn says(self, what: &str) -> Self {
        if what.is_empty() {
            return self;
        }
        if self.hovered() {
            note_hint(&self.ctx, what.to_owned());
        }
        self.on_hover_ui(|ui| {
            ui.label(what);
        })
        .on_disabled_hover_text(what)
    }
}

/// Puts a text into the status bar until the next frame.
pub(super) fn note_hint(context: &egui::Context, text: String) {
    context.data_mut(|data| data.insert_temp(hint_id(), text));
}

/// What the control under the pointer said since it was last asked.
pub(super) fn take_hint(context: &egui::Context) -> Option<String> {
    context.data_mut(|data| data.remove_temp::<String>(hint_id()))
}

fn hint_id() -> Id {
    Id::new("hint-of-hovered-control")
}
