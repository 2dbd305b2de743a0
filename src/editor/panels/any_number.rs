//! Numbers of every type, as the fields show and enter them.

use super::number_field::NumberField;
use crate::scene::schema::Quantity;
use bevy::reflect::PartialReflect;
use bevy_egui::egui::Ui;

/// The largest whole number up to which each is one of the fields' own.
const EXACT: f64 = (1_u64 << 53) as f64;

/// A number that was found in a value.
#[derive(Clone, Copy)]
pub(super) struct AnyNumber {
    value: f64,
    is_whole: bool,
    /// The ends of its type.
    ends: [f64; 2],
}

macro_rules! for_each_type {
    ($call:ident) => {
        $call! {
            f32 false, f64 false, u8 true, u16 true, u32 true, u64 true, usize true,
            i8 true, i16 true, i32 true, i64 true, isize true
        }
    };
}

impl AnyNumber {
    /// The number that a value is; `None` where it is none.
    pub fn of(value: &dyn PartialReflect) -> Option<Self> {
        macro_rules! read {
            ($($kind:ident $is_whole:literal),*) => { $(
                if let Some(&number) = value.try_downcast_ref::<$kind>() {
                    return Some(Self {
                        value: number as f64,
                        is_whole: $is_whole,
                        ends: [<$kind>::MIN as f64, <$kind>::MAX as f64],
                    });
                }
            )* };
        }
        for_each_type!(read);
        None
    }

    /// The field for it: as the schema says, or what its type can hold.
    pub fn field(self, says: &str, quantity: Option<Quantity>) -> NumberField<'_> {
        let [least, most] = match self.is_whole {
            true => self.ends.map(|end| end.clamp(-EXACT, EXACT)),
            false => self.ends,
        };
        NumberField {
            quantity: quantity.unwrap_or(Quantity::within(least, most, "")),
            is_whole: self.is_whole,
            is_mixed: false,
            says,
        }
    }

    /// Draws the field; true where a person changed the number, and then `place` has it.
    pub fn ui(self, ui: &mut Ui, field: NumberField, place: &mut dyn PartialReflect) -> bool {
        let mut number = self.value;
        let changed = field.ui(ui, &mut number);
        if changed {
            macro_rules! write {
                ($($kind:ident $is_whole:literal),*) => { $(
                    if let Some(place) = place.try_downcast_mut::<$kind>() {
                        *place = number as $kind;
                    }
                )* };
            }
            for_each_type!(write);
        }
        changed
    }
}
