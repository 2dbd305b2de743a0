//! A number as text: what a field shows of it, and what is read of what was typed.

use super::number_field::{MIXED, NumberField};
use crate::scene::schema::typed_number;
use bevy_egui::egui::{self, Ui};

/// Ends of ranges up to this are meant, and what is typed beyond is brought to them. Farther ones only keep numbers
/// from what cannot be computed with.
const MEANT: f64 = 1e9;

/// What was typed, as it is taken.
pub(super) struct Entered {
    pub number: f64,
    /// Where it is not what was typed.
    pub note: Option<String>,
}

impl NumberField<'_> {
    /// The number that a text means here.
    pub(super) fn read(self, text: &str, before: f64) -> Result<Entered, String> {
        let unit = self.quantity.unit;
        let number = match self.quantity.zero {
            Some(word) if text.trim().eq_ignore_ascii_case(word) => 0.0,
            _ => typed_number(text, unit, unit.kept_per_shown(), before)?,
        };
        if self.is_whole && number.fract() != 0.0 {
            return Err("a whole number is wanted".into());
        }
        let number = match self.is_whole {
            true => number,
            false => f64::from(number as f32),
        };
        if self.quantity.allows(number) {
            return Ok(Entered { number, note: None });
        }
        let range = self.quantity.shown_range_text();
        let nearest = self.quantity.nearest(number);
        if number.is_infinite() || nearest.abs() > MEANT {
            return Err(format!("it has to be {range}"));
        }
        let taken = self.text_with_unit(nearest);
        Ok(Entered {
            number: nearest,
            note: Some(format!("it has to be {range}: {taken} is taken")),
        })
    }

    /// As many digits as there is room for.
    pub(super) fn text_that_fits(self, ui: &Ui, number: f64) -> String {
        if self.is_mixed {
            return MIXED.into();
        }
        if let Some(word) = self.word(number) {
            return word.into();
        }
        let room = ui.spacing().interact_size.x - 2.0 * ui.spacing().button_padding.x;
        let font = ui.style().drag_value_text_style.resolve(ui.style());
        let with_unit = |digits| self.text(number, digits) + &self.quantity.unit.suffix();
        let texts = [with_unit(5), with_unit(4), with_unit(3)];
        let bare = [5, 4, 3, 2].map(|digits| self.text(number, digits));
        let shortest = format!("{:.1e}", number / self.quantity.unit.kept_per_shown());
        let mut last = String::new();
        for text in texts.into_iter().chain(bare).chain([shortest]) {
            let width = ui.fonts_mut(|fonts| {
                let galley = fonts.layout_no_wrap(text.clone(), font.clone(), egui::Color32::WHITE);
                galley.size().x
            });
            last = text;
            if width <= room {
                break;
            }
        }
        last
    }

    pub(super) fn text_with_unit(self, number: f64) -> String {
        match self.word(number) {
            Some(word) => word.into(),
            None => self.text(number, 6) + &self.quantity.unit.suffix(),
        }
    }

    /// What a number is called that is no amount.
    fn word(self, number: f64) -> Option<&'static str> {
        self.quantity.zero.filter(|_| number == 0.0)
    }

    fn text(self, number: f64, digits: usize) -> String {
        let shown = number / self.quantity.unit.kept_per_shown();
        match self.is_whole {
            true => format!("{shown}"),
            false => significant(shown, digits),
        }
    }

    /// All of its digits that are meant: in the eighth of a computed one there is only what rounding left.
    pub(super) fn text_to_edit(self, number: f64) -> String {
        let unit = self.quantity.unit.kept_per_shown();
        match (unit == 1.0, number.abs()) {
            (false, _) => significant(number / unit, 7),
            (true, size) if size == 0.0 || (1e-5..1e9).contains(&size) || self.is_whole => {
                match self.is_whole {
                    true => format!("{number}"),
                    false if (1e-4..1e7).contains(&size) => significant(number, 7),
                    false => format!("{}", number as f32),
                }
            }
            (true, _) => format!("{:e}", number as f32),
        }
    }
}

/// At most so many digits that say something, with an exponent where it would take many zeros.
pub(super) fn significant(number: f64, digits: usize) -> String {
    let size = number.abs();
    if number == 0.0 || !number.is_finite() {
        // -0 is nothing that anyone entered.
        return (number + 0.0).to_string();
    }
    if !(1e-4..1e7).contains(&size) {
        let text = format!("{number:.*e}", digits.min(4) - 1);
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        let mantissa = match mantissa.contains('.') {
            true => mantissa.trim_end_matches('0').trim_end_matches('.'),
            false => mantissa,
        };
        return format!("{mantissa}e{exponent}");
    }
    let whole_digits = size.log10().floor() as i32 + 1;
    let decimals = (digits as i32 - whole_digits).clamp(0, 7) as usize;
    let text = format!("{number:.decimals$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Quantity;

    #[test]
    fn a_number_is_shown_with_the_digits_that_say_something() {
        for (number, digits, text) in [
            (0.0, 5, "0"),
            (-0.0, 5, "0"),
            (1.0 / 3.0, 4, "0.3333"),
            (1234.56, 5, "1234.6"),
            (1234.56, 3, "1235"),
            (0.5, 5, "0.5"),
            (100.0, 3, "100"),
            (3.402_823_5e38, 5, "3.403e38"),
            (1e20, 5, "1e20"),
            (-1.5e-7, 5, "-1.5e-7"),
            (f64::INFINITY, 3, "inf"),
        ] {
            assert_eq!(significant(number, digits), text);
        }
    }

    #[test]
    fn a_zero_that_is_no_amount_is_called_so_and_may_be_typed_as_a_word() {
        let field = NumberField {
            quantity: Quantity::within(0.0, 10.0, "s").zero_is("never"),
            is_whole: false,
            is_mixed: false,
            says: "",
        };
        assert_eq!(
            [0.0, 1.5].map(|x| field.text_with_unit(x)),
            ["never", "1.5 s"]
        );
        let read = |text| field.read(text, 3.0).ok().map(|entered| entered.number);
        assert_eq!([" Never ", "0", "2"].map(read), [0.0, 0.0, 2.0].map(Some));
        assert_eq!(read("nevermore"), None);
        let plain = NumberField {
            quantity: Quantity::within(0.0, 10.0, "s"),
            ..field
        };
        assert_eq!(plain.text_with_unit(0.0), "0 s");
        assert!(plain.read("never", 3.0).is_err());
    }
}
