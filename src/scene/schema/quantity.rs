//! What a number of the scene may be, its unit, and how it is entered.

use bevy::reflect::Reflect;
use std::f64::consts::PI;

/// Coordinates and lengths that can be entered, in metres: up to here products of three of them, which a triangle's test
/// makes, stay far from the end of f32.
pub const FARTHEST: f32 = 1e12;

/// The unit of a number, as it is written behind it.
///
/// The scene keeps metres, radians and seconds; angles are shown in degrees.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unit(pub &'static str);

impl Unit {
    /// None: a plain number.
    pub const NONE: Self = Self("");
    /// Of a length.
    pub const METRE: Self = Self("m");
    /// Of an angle: radians are kept, degrees shown.
    pub const ANGLE: Self = Self("°");
    /// Of a time.
    pub const SECOND: Self = Self("s");
    /// Of a temperature.
    pub const KELVIN: Self = Self("K");
    /// Of a factor.
    pub const TIMES: Self = Self("×");
    /// Of what is measured on a screen or in a picture.
    pub const PIXEL: Self = Self("px");
    /// Of an exposure: a factor of two each.
    pub const STOP: Self = Self("EV");

    /// What may be typed behind a number, each with how many of the kept unit it is.
    pub fn words(self) -> &'static [(&'static str, f64)] {
        match self.0 {
            "m" => &[
                ("m", 1.0),
                ("mm", 1e-3),
                ("cm", 1e-2),
                ("km", 1e3),
                ("in", 0.0254),
                ("ft", 0.3048),
                ("\"", 0.0254),
                ("″", 0.0254),
                ("'", 0.3048),
                ("′", 0.3048),
            ],
            "°" => &[("°", PI / 180.0), ("deg", PI / 180.0), ("rad", 1.0)],
            "s" => &[("s", 1.0), ("ms", 1e-3), ("min", 60.0), ("h", 3600.0)],
            "K" => &[("K", 1.0)],
            "px" => &[("px", 1.0)],
            "EV" => &[("EV", 1.0)],
            "×" => &[("×", 1.0), ("%", 1e-2)],
            "" => &[("%", 1e-2)],
            _ => &[],
        }
    }

    /// How many of the kept unit the shown one is.
    pub fn kept_per_shown(self) -> f64 {
        match self {
            Self::ANGLE => PI / 180.0,
            _ => 1.0,
        }
    }

    /// As it follows a number: ` m`, `°`.
    pub fn suffix(self) -> String {
        match self.0 {
            "" | "°" => self.0.to_owned(),
            other => format!(" {other}"),
        }
    }
}

/// Attribute of a reflected number, or of a group of them such as a vector: what each may be, and how it is entered.
///
/// Numbers are in the unit that the scene keeps.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    /// The least that it may be.
    pub least: f64,
    /// The most that it may be. Only where this is infinite may the number be.
    pub most: f64,
    /// Neither end belongs to the range.
    pub is_open: bool,
    /// What it is measured in.
    pub unit: Unit,
    /// The ends of the slider it is entered with; none where it is dragged.
    pub slider: Option<[f64; 2]>,
    /// The slider's places go by the number's logarithm.
    pub is_logarithmic: bool,
    /// How much a drag of one point changes it, at least.
    pub step: f64,
    /// What a zero is called, where it is no amount.
    pub zero: Option<&'static str>,
}

impl Quantity {
    /// Every finite number.
    pub const ANY: Self = Self::within(f32::MIN as f64, f32::MAX as f64, "");
    /// A coordinate, or an extent with a sign.
    pub const COORDINATE: Self = Self::within(-FARTHEST as f64, FARTHEST as f64, "m");
    /// A length, zero or more.
    pub const LENGTH: Self = Self::within(0.0, FARTHEST as f64, "m");
    /// The extent of a thing that has one.
    pub const EXTENT: Self = Self::LENGTH.open();
    /// A part of a whole, 0 to 1: of what a surface reflects, too.
    pub const PART: Self = Self::slider(0.0, 1.0, "");
    /// What multiplies a light or a picture.
    pub const FACTOR: Self = Self::at_least_0("×");
    /// How many samples or rays are asked for, 1 to 1000.
    pub const SAMPLES: Self = Self::slider(1.0, 1000.0, "").logarithmic();

    /// Dragged, zero or more.
    pub const fn at_least_0(unit: &'static str) -> Self {
        Self::within(0.0, f32::MAX as f64, unit).step(0.02)
    }

    /// Dragged, between two ends.
    pub const fn within(least: f64, most: f64, unit: &'static str) -> Self {
        Self {
            least,
            most,
            is_open: false,
            unit: Unit(unit),
            slider: None,
            is_logarithmic: false,
            step: 0.01,
            zero: None,
        }
    }

    /// A slider between two ends.
    pub const fn slider(least: f64, most: f64, unit: &'static str) -> Self {
        Self::within(least, most, unit).shown(least, most)
    }

    /// An angle on a slider; the ends are in degrees.
    pub const fn degrees(least: f64, most: f64) -> Self {
        Self::slider(radians(least), radians(most), "°")
    }

    /// The same in another unit.
    pub const fn unit(self, unit: &'static str) -> Self {
        Self {
            unit: Unit(unit),
            ..self
        }
    }

    /// The same with another step.
    pub const fn step(self, step: f64) -> Self {
        Self { step, ..self }
    }

    /// The same with a word for a zero, which is no amount.
    pub const fn zero_is(self, word: &'static str) -> Self {
        Self {
            zero: Some(word),
            ..self
        }
    }

    /// The same by the logarithm.
    pub const fn logarithmic(self) -> Self {
        Self {
            is_logarithmic: true,
            ..self
        }
    }

    /// The same with a slider between these ends, which a typed number may leave.
    pub const fn shown(self, least: f64, most: f64) -> Self {
        Self {
            slider: Some([least, most]),
            ..self
        }
    }

    /// The same without its ends.
    pub const fn open(self) -> Self {
        Self {
            is_open: true,
            ..self
        }
    }

    /// Whether a number may be this. NaN may not.
    pub fn allows(&self, number: f64) -> bool {
        match self.is_open {
            true => number > self.least && (number < self.most || self.most == f64::INFINITY),
            false => number >= self.least && number <= self.most,
        }
    }

    /// The nearest that the number may be; NaN stays.
    pub fn nearest(&self, number: f64) -> f64 {
        let (mut least, mut most) = (self.least, self.most);
        if self.is_open {
            // The neighbours that f32 has, as what is kept does.
            least = f64::from((least as f32).next_up());
            if most.is_finite() {
                most = f64::from((most as f32).next_down());
            }
        }
        number.clamp(least, most)
    }

    /// The range in words: `0 to 1`, `at least 1`, `greater than 0`; angles as parts of π.
    pub fn range_text(&self) -> String {
        self.range_by(|end| end_text(end, self.unit))
    }

    /// The same in the unit that is shown: angles in degrees.
    pub fn shown_range_text(&self) -> String {
        let kept = self.unit.kept_per_shown();
        // The ends are kept in f32, so that more digits would not be theirs.
        let round = |end: f64| (end / kept * 1e4).round() / 1e4;
        self.range_by(|end| end_text(round(end), Unit::NONE) + &self.unit.suffix())
    }

    fn range_by(&self, text: impl Fn(f64) -> String) -> String {
        let has_least = self.least > f64::from(f32::MIN);
        let has_most = self.most < f64::from(f32::MAX);
        let [least, most] = [self.least, self.most].map(text);
        match (has_least, has_most, self.is_open) {
            (false, false, _) => "a finite number".into(),
            (true, false, false) => format!("at least {least}"),
            (true, false, true) => format!("greater than {least}"),
            (false, true, false) => format!("at most {most}"),
            (false, true, true) => format!("less than {most}"),
            (true, true, false) => format!("{least} to {most}"),
            (true, true, true) => format!("between {least} and {most}"),
        }
    }
}

/// Rounded as what is kept is, so that an angle that is exactly at an end is within.
const fn radians(degrees: f64) -> f64 {
    (degrees * PI / 180.0) as f32 as f64
}

fn end_text(end: f64, unit: Unit) -> String {
    if unit == Unit::ANGLE && end != 0.0 {
        let sign = if end < 0.0 { "-" } else { "" };
        let parts = PI / end.abs();
        for (number, text) in [(parts, "π/"), (1.0 / parts, "π·")] {
            let whole = number.round();
            if (number - whole).abs() < 1e-6 && whole >= 1.0 {
                return match whole == 1.0 {
                    true => format!("{sign}π"),
                    false => format!("{sign}{text}{whole}"),
                };
            }
        }
    }
    match end.abs() {
        // What is kept is an f32, and has no more digits.
        large if large >= 1e9 && large != f64::from(u32::MAX) => format!("{:e}", end as f32),
        _ => end.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_said_in_words_and_angles_as_parts_of_pi() {
        for (quantity, text) in [
            (Quantity::PART, "0 to 1"),
            (Quantity::at_least_0("m"), "at least 0"),
            (Quantity::at_least_0("m").open(), "greater than 0"),
            (Quantity::degrees(0.0, 180.0), "0 to π"),
            (Quantity::degrees(-180.0, 90.0), "-π to π/2"),
            (Quantity::degrees(0.0, 180.0).open(), "between 0 and π"),
            (
                Quantity::within(0.0, f64::from(u32::MAX), ""),
                "0 to 4294967295",
            ),
            (
                Quantity::within(f64::from(f32::MIN), f64::from(f32::MAX), ""),
                "a finite number",
            ),
        ] {
            assert_eq!(quantity.range_text(), text);
        }
    }

    #[test]
    fn the_nearest_number_is_one_that_is_allowed() {
        let focus = Quantity::within(0.0, f64::INFINITY, "m").open();
        for quantity in [Quantity::PART, Quantity::degrees(0.0, 180.0).open(), focus] {
            for number in [-3.0, 0.0, 0.5, 9.0, f64::INFINITY] {
                let nearest = quantity.nearest(number);
                assert!(
                    quantity.allows(nearest),
                    "{number} to {nearest}: {quantity:?}"
                );
                assert!(!quantity.allows(number) || nearest == number, "{number}");
            }
            assert!(!quantity.allows(f64::NAN));
        }
        assert!(focus.allows(f64::INFINITY));
        let quarter = Quantity::degrees(0.0, 90.0);
        assert!(quarter.allows(f64::from(std::f32::consts::FRAC_PI_2)));
    }
}
