//! What is known of each property of the scene beside its value: what it may be, its unit, how it is entered, what it
//! does, and where alone it is read.
//!
//! It stands at the fields themselves, as attributes of their reflection and as their documentation. Panels, tooltips,
//! the check of scene files, the clamping before tracing, `--set` and its help read it there, and nothing of it stands
//! anywhere else.

mod documented;
mod property;
mod quantity;
mod range;
mod typed;

pub use documented::Says;
pub(crate) use documented::{documentation, documented};
pub use property::{
    Choice, Label, MostPixels, Needs, NotAbove, Property, about_choice, about_type, choice_name,
    keep_order, quantity_of,
};
pub use quantity::{FARTHEST, Quantity, Unit};
pub use range::{RangeProblem, range_problems};
pub use typed::typed_number;
