//! Every control says what it does: in a tooltip, in the status bar while the pointer is over it, and to screen readers.

use bevy_egui::egui::{self, Id, Response, Ui};

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
        name_control(&self, what);
        self.on_hover_ui(|ui| {
            ui.label(what);
        })
        .on_disabled_hover_text(what)
    }
}

/// Tells screen readers what a control does. One without a text of its own is called as the row that it stands in, or else
/// by what it does, and so is one whose text is a picture: ⏸ is no word.
pub(super) fn name_control(control: &Response, what: &str) {
    if !control.sense.interactive() {
        return;
    }
    let context = &control.ctx;
    let row: Option<String> = context.data(|data| data.get_temp(row_id()));
    context.accesskit_node_builder(control.id, |node| {
        let label = node.label().unwrap_or_default();
        if label.is_empty() {
            node.set_label(row.as_deref().unwrap_or(what));
        } else if !can_be_told(label) {
            node.set_label(what);
        }
        node.set_description(what);
    });
}

/// Whether there is a word or a number in it.
pub(super) fn can_be_told(name: &str) -> bool {
    name.chars().any(char::is_alphanumeric)
}

/// Draws the controls of a row that is called so.
pub(super) fn in_row<R>(ui: &mut Ui, label: &str, controls: impl FnOnce(&mut Ui) -> R) -> R {
    ui.data_mut(|data| data.insert_temp(row_id(), label.to_owned()));
    let result = controls(ui);
    ui.data_mut(|data| data.remove::<String>(row_id()));
    result
}

fn row_id() -> Id {
    Id::new("label-of-the-row")
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
