//! A number that is dragged, or typed as a sum, with a unit, as a change of what it was. What is typed counts when the
//! field is left, and only as a whole: where it cannot be read the old value stays, the field is marked, and its tooltip
//! says why. Click it again to mend what was typed.

use super::says::{Says, name_control};
use crate::scene::schema::Quantity;
use bevy_egui::egui::{
    self, Align2, Button, CursorIcon, Id, Key, Modifiers, Order, Response, RichText, Sense, Slider,
    SliderClamping, Stroke, TextEdit, TextWrapMode, Ui, WidgetInfo, accesskit, vec2,
};
use std::ops::Range;

/// What is shown in place of a value in which several entities differ.
pub(super) const MIXED: &str = "mixed";
/// How wide a number is beside its slider, in points.
const BESIDE_SLIDER: f32 = 60.0;

/// How one number is shown and entered.
#[derive(Clone, Copy)]
pub(super) struct NumberField<'a> {
    pub quantity: Quantity,
    /// Without decimals.
    pub is_whole: bool,
    /// Several entities differ in it.
    pub is_mixed: bool,
    /// What it does.
    pub says: &'a str,
}

/// What is being typed into a field.
#[derive(Clone)]
struct Typing {
    text: String,
    /// As the field was opened; left so, nothing was entered.
    opened: String,
    /// The number before.
    before: f64,
    /// Whose number it is.
    owner: Id,
    /// The pass in which it was seen last.
    pass: u64,
}

/// What was typed last and not taken as it was.
#[derive(Clone)]
struct Refused {
    text: String,
    why: String,
    /// It was brought into the range.
    is_taken: bool,
    /// The number that the field was left with: another one has nothing to do with it.
    number: f64,
    owner: Id,
}

/// Says whose numbers the fields below show. What is typed for one owner never reaches another that is shown in the
/// same place.
pub(super) fn set_owner(context: &egui::Context, owner: impl std::hash::Hash) {
    context.data_mut(|data| data.insert_temp(owner_id(), Id::new(owner)));
}

fn owner_id() -> Id {
    Id::new("whose numbers are shown")
}

impl NumberField<'_> {
    /// The field, with a slider before it where the quantity has one. True where a person changed the number; merely
    /// being drawn changes nothing, not even a number out of range.
    pub fn ui(self, ui: &mut Ui, number: &mut f64) -> bool {
        let Some([least, most]) = self.quantity.slider else {
            let width = ui.available_width().max(40.0);
            ui.spacing_mut().interact_size.x = width;
            return self.number_ui(ui, number).1;
        };
        let unit = self.quantity.unit.kept_per_shown();
        let gap = ui.spacing().item_spacing.x;
        let room = ui.available_width() - BESIDE_SLIDER - gap;
        let mut changed = false;
        if room >= 40.0 {
            ui.spacing_mut().slider_width = room;
            let mut place = *number / unit;
            let slider = Slider::new(&mut place, least / unit..=most / unit)
                .logarithmic(self.quantity.is_logarithmic)
                .clamping(SliderClamping::Edits)
                .show_value(false);
            let slider = if self.is_whole {
                slider.integer()
            } else {
                slider
            };
            if ui.add(slider).says(self.says).changed() && place.is_finite() {
                *number = self.quantity.nearest(place * unit);
                changed = true;
            }
        }
        ui.spacing_mut().interact_size.x = BESIDE_SLIDER;
        self.number_ui(ui, number).1 || changed
    }

    /// The number alone; and whether a person changed it, which the response does not say.
    pub fn number_ui(self, ui: &mut Ui, number: &mut f64) -> (Response, bool) {
        let id = ui.next_auto_id();
        let owner = ui.data(|data| data.get_temp(owner_id())).unwrap_or(id);
        let is_typing = ui.is_enabled()
            && ui.memory_mut(|memory| {
                memory.interested_in_focus(id, ui.layer_id());
                memory.has_focus(id)
            });
        let before = *number;
        let (response, entered) = if is_typing {
            self.typing_ui(ui, id, owner, number)
        } else {
            let entered = self.leave(ui, id, owner, number);
            (self.resting_ui(ui, id, owner, number), entered)
        };
        let is_changed = entered || *number != before && !number.is_nan();
        (response, is_changed)
    }

    /// The field while it has the keys.
    fn typing_ui(self, ui: &mut Ui, id: Id, owner: Id, number: &mut f64) -> (Response, bool) {
        let pass = ui.ctx().cumulative_pass_nr();
        let known = ui.data(|data| data.get_temp::<Typing>(id));
        let known = known.filter(|typing| typing.owner == owner && typing.pass + 1 >= pass);
        let is_new = known.is_none();
        let mut typing = known.unwrap_or_else(|| {
            let opened = match self.is_mixed {
                true => String::new(),
                false => self.text_to_edit(*number),
            };
            let refused = refused(ui, id, owner, *number).filter(|refused| !refused.is_taken);
            Typing {
                text: refused.map_or_else(|| opened.clone(), |refused| refused.text),
                opened,
                before: *number,
                owner,
                pass,
            }
        });
        typing.pass = pass;
        let steps = ui.input_mut(|input| {
            let mut steps = |key| input.count_and_consume_key(Modifiers::NONE, key) as f64;
            steps(Key::ArrowUp) - steps(Key::ArrowDown)
        });
        if steps != 0.0
            && let Ok(now) = self.read(&typing.text, typing.before)
        {
            let next = now.number + steps * self.step(now.number);
            typing.text = self.text_to_edit(self.quantity.nearest(next));
        }
        let read = self.read(&typing.text, typing.before);
        let ink = match &read {
            Err(_) => ui.visuals().error_fg_color,
            Ok(_) => ui.visuals().text_color(),
        };
        let padding = ui.spacing().button_padding;
        let width = ui.spacing().interact_size.x - 2.0 * padding.x;
        let field = TextEdit::singleline(&mut typing.text)
            .id(id)
            .char_limit(100)
            .clip_text(true)
            .margin(padding)
            .min_size(ui.spacing().interact_size)
            .desired_width(width)
            .text_color(ink)
            .font(ui.style().drag_value_text_style.clone());
        let response = ui.add(field);
        name_control(&response, self.says);
        if is_new {
            select_letters(ui, id, 0..typing.text.chars().count());
        }
        let text = match read {
            Err(why) => Some(why),
            Ok(entered) => entered.note.or_else(|| {
                let is_plain = typing.text.trim().parse::<f64>().is_ok();
                (!is_plain).then(|| format!("= {}", self.text_with_unit(entered.number)))
            }),
        };
        if let Some(text) = text.filter(|_| typing.text != typing.opened) {
            note_beside(ui, id, &response, &text);
        }
        ui.data_mut(|data| data.insert_temp(id, typing));
        let entered = response.lost_focus() && self.leave(ui, id, owner, number);
        (response, entered)
    }

    /// Takes over what was typed, once the field has lost the keys; true where it is a number. Escape leaves the old one.
    fn leave(self, ui: &Ui, id: Id, owner: Id, number: &mut f64) -> bool {
        let Some(typing) = ui.data(|data| data.get_temp::<Typing>(id)) else {
            return false;
        };
        ui.data_mut(|data| data.remove::<Typing>(id));
        let is_late = typing.pass + 1 < ui.ctx().cumulative_pass_nr();
        let is_cancelled = ui.input(|input| input.key_pressed(Key::Escape));
        if typing.owner != owner || is_late || is_cancelled || typing.text == typing.opened {
            return false;
        }
        let read = self.read(&typing.text, typing.before);
        let is_taken = read.is_ok();
        let (entered, why) = match read {
            Ok(entered) => (entered.number, entered.note),
            Err(why) => (*number, Some(why)),
        };
        *number = entered;
        ui.data_mut(|data| match why {
            None => data.remove::<Refused>(id),
            Some(why) => {
                let refused = Refused {
                    text: typing.text,
                    why,
                    is_taken,
                    number: entered,
                    owner,
                };
                data.insert_temp(id, refused);
            }
        });
        is_taken
    }

    /// The field while it has not: a button that is dragged.
    fn resting_ui(self, ui: &mut Ui, id: Id, owner: Id, number: &mut f64) -> Response {
        let refused = refused(ui, id, owner, *number);
        let style = ui.style().drag_value_text_style.clone();
        let text = RichText::new(self.text_that_fits(ui, *number)).text_style(style);
        let mut button = Button::new(text)
            .wrap_mode(TextWrapMode::Truncate)
            .sense(Sense::click_and_drag())
            .min_size(ui.spacing().interact_size);
        if refused.is_some() {
            button = button.stroke(Stroke::new(1.5, ui.visuals().error_fg_color));
        }
        let response = ui.add(button).on_hover_cursor(CursorIcon::ResizeHorizontal);
        if response.clicked() {
            ui.memory_mut(|memory| memory.request_focus(id));
        } else if response.dragged() {
            self.drag(ui, id, &response, number);
        }
        if response.drag_started() || response.drag_stopped() {
            ui.data_mut(|data| data.remove::<f64>(id));
        }
        self.follow_requests(ui, id, number);
        let response = match refused {
            None => response,
            Some(Refused { text, why, .. }) => response.on_hover_ui(|ui| {
                let ink = ui.visuals().error_fg_color;
                ui.colored_label(ink, format!("“{text}”: {why}"));
            }),
        };
        let response = response.says(self.says);
        let shown = *number / self.quantity.unit.kept_per_shown();
        response.widget_info(|| WidgetInfo::drag_value(ui.is_enabled(), shown));
        ui.ctx().accesskit_node_builder(response.id, |node| {
            node.clear_label();
            node.set_value(self.text_with_unit(*number));
            node.set_numeric_value_step(self.step(*number));
            for action in [
                accesskit::Action::SetValue,
                accesskit::Action::Increment,
                accesskit::Action::Decrement,
            ] {
                node.add_action(action);
            }
        });
        name_control(&response, self.says);
        response
    }

    fn drag(self, ui: &Ui, id: Id, response: &Response, number: &mut f64) {
        let moved = f64::from(response.drag_delta().x - response.drag_delta().y);
        if moved == 0.0 {
            return;
        }
        let slow = ui.input(|input| input.modifiers.shift_only());
        let step = self.step(*number) * if slow { 0.1 } else { 1.0 };
        // What is shown is a round number near the exact one.
        let exact = ui.data(|data| data.get_temp::<f64>(id)).unwrap_or(*number) + moved * step;
        ui.data_mut(|data| data.insert_temp(id, exact));
        let unit = self.quantity.unit.kept_per_shown();
        let around = f64::from(ui.input(|input| input.aim_radius())) * step;
        let [least, most] = [exact - around, exact + around].map(|end| end / unit);
        let round = egui::emath::smart_aim::best_in_range_f64(least, most) * unit;
        self.set(number, if round.is_finite() { round } else { exact });
    }

    /// What programs that read the screen aloud ask for.
    fn follow_requests(self, ui: &Ui, id: Id, number: &mut f64) {
        use accesskit::{Action, ActionData};
        let unit = self.quantity.unit.kept_per_shown();
        ui.input(|input| {
            let steps = input.num_accesskit_action_requests(id, Action::Increment) as f64
                - input.num_accesskit_action_requests(id, Action::Decrement) as f64;
            if steps != 0.0 {
                self.set(number, *number + steps * self.step(*number));
            }
            for request in input.accesskit_action_requests(id, Action::SetValue) {
                if let Some(ActionData::NumericValue(value)) = request.data {
                    self.set(number, value * unit);
                }
            }
        });
    }

    fn set(self, number: &mut f64, to: f64) {
        let to = if self.is_whole { to.round() } else { to };
        if to.is_finite() {
            *number = self.quantity.nearest(to);
        }
    }

    /// How much a drag of one point is: large numbers are dragged in larger steps.
    fn step(self, number: f64) -> f64 {
        let unit = self.quantity.unit.kept_per_shown();
        let least = self.quantity.step * if unit == 1.0 { 1.0 } else { 50.0 * unit };
        match number.abs() * 0.01 {
            larger if larger > least && larger.is_finite() => larger,
            _ => least,
        }
    }
}

/// What was typed last and not taken, where the number is still the one that it left.
fn refused(ui: &Ui, id: Id, owner: Id, number: f64) -> Option<Refused> {
    let refused = ui.data(|data| data.get_temp::<Refused>(id))?;
    (refused.owner == owner && refused.number == number).then_some(refused)
}

/// Chooses these letters of a field.
pub(super) fn select_letters(ui: &Ui, id: Id, letters: Range<usize>) {
    use egui::text::{CCursor, CCursorRange};
    let mut state = TextEdit::load_state(ui.ctx(), id).unwrap_or_default();
    let [start, end] = [letters.start, letters.end].map(CCursor::new);
    let range = CCursorRange::two(start, end);
    state.cursor.set_char_range(Some(range));
    state.store(ui.ctx(), id);
}

/// What the text means so far, below the field that has the keys.
fn note_beside(ui: &Ui, id: Id, response: &Response, text: &str) {
    egui::Area::new(id.with("meaning"))
        .order(Order::Tooltip)
        .interactable(false)
        .pivot(Align2::RIGHT_TOP)
        .fixed_pos(response.rect.right_bottom() + vec2(0.0, 3.0))
        .constrain(true)
        .show(ui.ctx(), |ui| {
            egui::Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_max_width(260.0);
                ui.label(text);
            });
        });
}
