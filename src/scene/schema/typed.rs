//! A number as a person types it: `10cm`, `2*3`, `(1+2)/3`, `+=.1`, `0,5`.

use super::Unit;

/// How deep parentheses and signs may nest. Nobody types more, and each level takes room on the stack.
const DEEPEST: u32 = 32;

/// What stands for more than any number.
const INFINITE: [&str; 2] = ["inf", "∞"];

/// What a text means as a number of this unit, in the unit that the scene keeps: metres, radians, seconds.
///
/// Understood are `+ - * / ^`, parentheses, a comma or a point before decimals, `inf` or `∞`, `pi` or `π`, and the
/// unit's names behind a number. A number without a name counts `plain`: π/180 where degrees are typed and radians are
/// kept. `+=`, `-=`, `*=` and `/=` begin a change of `before`.
///
/// # Errors
/// Says what is wrong with the text. No result is NaN; it is infinite only where the text says so.
pub fn typed_number(text: &str, unit: Unit, plain: f64, before: f64) -> Result<f64, String> {
    let text = text.trim();
    let change = ["+=", "-=", "*=", "/="]
        .into_iter()
        .find_map(|sign| Some((sign, text.strip_prefix(sign)?)));
    let number = match change {
        None => whole(text, unit, plain)?.kept(plain),
        Some(("+=", by)) => before + whole(by, unit, plain)?.kept(plain),
        Some(("-=", by)) => before - whole(by, unit, plain)?.kept(plain),
        Some(("*=", by)) => before * whole(by, unit, plain)?.factor()?,
        Some((_, by)) => before / whole(by, unit, plain)?.factor()?,
    };
    match number {
        number if number.is_nan() => Err("this is no number".into()),
        number if number.is_infinite() && !INFINITE.iter().any(|name| text.contains(name)) => {
            Err("this is larger than any number".into())
        }
        number => Ok(number),
    }
}

/// A part of what was typed: a number, and whether it has a unit and is in the scene's.
#[derive(Clone, Copy)]
struct Value {
    number: f64,
    has_unit: bool,
}

impl Value {
    fn plain(number: f64) -> Self {
        Self {
            number,
            has_unit: false,
        }
    }

    fn kept(self, plain: f64) -> f64 {
        match self.has_unit {
            true => self.number,
            false => self.number * plain,
        }
    }

    fn factor(self) -> Result<f64, String> {
        match self.has_unit {
            true => Err("a factor has no unit".into()),
            false => Ok(self.number),
        }
    }
}

fn whole(text: &str, unit: Unit, plain: f64) -> Result<Value, String> {
    let mut rest = text.trim();
    // Units such as W/(sr·m²) are no words that could be read inside.
    if unit.words().is_empty()
        && let Some(number) = rest.strip_suffix(unit.0)
    {
        rest = number.trim_end();
    }
    let mut reader = Reader {
        rest,
        unit,
        plain,
        depth: 0,
    };
    if reader.rest.is_empty() {
        return Err("there is no number".into());
    }
    let value = reader.sum()?;
    match reader.rest.chars().next() {
        None => Ok(value),
        Some(next) => Err(format!("“{next}” is not expected there")),
    }
}

/// What is still to be read.
struct Reader<'a> {
    rest: &'a str,
    unit: Unit,
    plain: f64,
    depth: u32,
}

impl Reader<'_> {
    /// Goes past one of the signs, if it is next.
    fn sign(&mut self, signs: &[char]) -> Option<char> {
        let next = self
            .rest
            .chars()
            .next()
            .filter(|next| signs.contains(next))?;
        self.rest = self.rest[next.len_utf8()..].trim_start();
        Some(next)
    }

    fn sum(&mut self) -> Result<Value, String> {
        let mut sum = self.product()?;
        while let Some(sign) = self.sign(&['+', '-', '−']) {
            let mut next = self.product()?;
            // A number alone is in the field's unit: 1 + 10cm.
            if sum.has_unit != next.has_unit {
                sum = self.united(sum);
                next = self.united(next);
            }
            sum.number += if sign == '+' {
                next.number
            } else {
                -next.number
            };
        }
        Ok(sum)
    }

    fn united(&self, value: Value) -> Value {
        Value {
            number: value.kept(self.plain),
            has_unit: true,
        }
    }

    fn product(&mut self) -> Result<Value, String> {
        let mut product = self.signed()?;
        while let Some(sign) = self.sign(&['*', '×', '·', '/', '÷', ':']) {
            let next = self.signed()?;
            product = if matches!(sign, '*' | '×' | '·') {
                if product.has_unit && next.has_unit {
                    return Err("one of two factors has a unit, not both".into());
                }
                Value {
                    number: product.number * next.number,
                    has_unit: product.has_unit || next.has_unit,
                }
            } else {
                if next.number == 0.0 {
                    return Err("nothing can be divided by 0".into());
                }
                if next.has_unit && !product.has_unit {
                    return Err("what is divided by a unit needs one itself".into());
                }
                Value {
                    number: product.number / next.number,
                    has_unit: product.has_unit && !next.has_unit,
                }
            };
        }
        Ok(product)
    }

    fn signed(&mut self) -> Result<Value, String> {
        let Some(sign) = self.sign(&['+', '-', '−']) else {
            return self.power();
        };
        let value = self.deeper(Self::signed)?;
        Ok(Value {
            number: if sign == '+' {
                value.number
            } else {
                -value.number
            },
            ..value
        })
    }

    fn power(&mut self) -> Result<Value, String> {
        let base = self.one()?;
        if self.sign(&['^']).is_none() {
            return Ok(base);
        }
        let exponent = self.deeper(Self::signed)?;
        Ok(Value::plain(base.factor()?.powf(exponent.factor()?)))
    }

    fn deeper(
        &mut self,
        read: impl FnOnce(&mut Self) -> Result<Value, String>,
    ) -> Result<Value, String> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err("this is nested too deep".into());
        }
        let value = read(self);
        self.depth -= 1;
        value
    }

    /// A number, a constant or what stands in parentheses, with its unit.
    fn one(&mut self) -> Result<Value, String> {
        let value = if self.sign(&['(']).is_some() {
            let inside = self.deeper(Self::sum)?;
            if self.sign(&[')']).is_none() {
                return Err("a parenthesis is not closed".into());
            }
            inside
        } else {
            Value::plain(self.number()?)
        };
        let word = self.word();
        if word.is_empty() {
            return Ok(value);
        }
        let known = self.unit.words();
        let Some((_, factor)) = known.iter().find(|(name, _)| *name == word) else {
            let is_mark = |name: &str| name.contains(['"', '″', '\'', '′']);
            let known = known.iter().map(|(name, _)| *name);
            let known: Vec<&str> = known.filter(|name| !is_mark(name)).collect();
            return Err(match known.is_empty() {
                true => format!("“{word}” is no unit here: a number stands alone"),
                false => format!("“{word}” is no unit here; there are {}", known.join(", ")),
            });
        };
        if value.has_unit {
            return Err(format!("“{word}” stands behind a number that has a unit"));
        }
        self.rest = self.rest[word.len()..].trim_start();
        Ok(Value {
            number: value.number * factor,
            has_unit: true,
        })
    }

    /// The letters that are next, or the sign of a unit.
    fn word(&self) -> String {
        let is_sign = |c: char| matches!(c, '°' | '%' | '″' | '′' | '"' | '\'');
        let rest = self.rest;
        match rest.chars().next() {
            Some(first) if is_sign(first) => first.into(),
            _ => rest.chars().take_while(|c| c.is_alphabetic()).collect(),
        }
    }

    fn number(&mut self) -> Result<f64, String> {
        let infinite = INFINITE.map(|name| (name, f64::INFINITY));
        let pi = ["pi", "π"].map(|name| (name, std::f64::consts::PI));
        for (name, value) in infinite.into_iter().chain(pi) {
            if let Some(rest) = self.rest.strip_prefix(name)
                && !rest.starts_with(char::is_alphabetic)
            {
                self.rest = rest.trim_start();
                return Ok(value);
            }
        }
        let bytes = self.rest.as_bytes();
        let digits = |from: usize| {
            let digits = bytes[from..]
                .iter()
                .take_while(|byte| byte.is_ascii_digit());
            from + digits.count()
        };
        let mut end = digits(0);
        if matches!(bytes.get(end), Some(b'.' | b',')) {
            end = digits(end + 1);
        }
        // An e is an exponent only with digits behind it.
        if matches!(bytes.get(end), Some(b'e' | b'E')) {
            let signed = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            let after = digits(end + 1 + signed);
            if after > end + 1 + signed {
                end = after;
            }
        }
        let text = self.rest[..end].replace(',', ".");
        let number = text.parse().map_err(|_| match self.rest.chars().next() {
            None => "a number is missing at the end".to_owned(),
            Some(next) => format!("a number is missing before “{next}”"),
        })?;
        self.rest = self.rest[end..].trim_start();
        Ok(number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn metres(text: &str) -> Result<f64, String> {
        typed_number(text, Unit::METRE, 1.0, 4.0)
    }

    #[test]
    fn numbers_arithmetic_and_units_are_understood() {
        for (text, meant) in [
            ("3", 3.0),
            (" -.5 ", -0.5),
            ("0,25", 0.25),
            ("1e3", 1000.0),
            ("2*3", 6.0),
            ("1/4", 0.25),
            ("1 + 2 * 3 - 4 / 8", 6.5),
            ("(1+2)*(3-5)", -6.0),
            ("-2^2", -4.0),
            ("2^-1", 0.5),
            ("10cm", 0.1),
            ("2 km", 2000.0),
            ("1in + 1ft", 0.3302),
            ("1 + 10cm", 1.1),
            ("6'", 1.8288),
            ("(1+2) mm", 0.003),
            ("3m/2m", 1.5),
            ("2*10cm", 0.2),
            ("+=.1", 4.1),
            ("-= 1/2", 3.5),
            ("*=2", 8.0),
            ("/=8", 0.5),
            ("+=10cm", 4.1),
            ("inf", f64::INFINITY),
            ("∞", f64::INFINITY),
            ("-∞ m", f64::NEG_INFINITY),
            ("*=∞", f64::INFINITY),
        ] {
            let found = metres(text);
            let is_close = |found: &f64| *found == meant || (found - meant).abs() < 1e-12;
            assert!(found.as_ref().is_ok_and(is_close), "`{text}` is {found:?}");
        }
        let angle = |text| typed_number(text, Unit::ANGLE, 1_f64.to_radians(), 0.0);
        assert_eq!(angle("90"), angle("(pi/2) rad"));
        assert_eq!(angle("180°"), Ok(std::f64::consts::PI));
        let watts = |text| typed_number(text, Unit("W/sr"), 1.0, 0.0);
        assert_eq!((watts("3 W/sr"), watts("2*3")), (Ok(3.0), Ok(6.0)));
    }

    #[test]
    fn what_is_no_number_is_refused_whole_and_says_why() {
        for (text, part) in [
            ("", "no number"),
            ("+=", "no number"),
            ("many", "missing before “m”"),
            ("10cc", "“cc” is no unit here; there are m, mm, cm"),
            ("10c", "“c” is no unit"),
            ("2*", "missing at the end"),
            ("0.1/", "missing at the end"),
            ("1..2", "“.” is not expected"),
            ("1 2", "“2” is not expected"),
            ("(1", "not closed"),
            ("1)", "“)” is not expected"),
            ("1/0", "divided by 0"),
            ("1e999", "larger than any number"),
            ("10^400", "larger than any number"),
            ("inf-inf", "no number"),
            ("∞-∞", "no number"),
            ("(-1)^.5", "no number"),
            ("2m*3m", "not both"),
            ("1/2m", "needs one itself"),
            ("*=2m", "a factor has no unit"),
            ("1e", "“e” is no unit"),
            ("NaN", "missing"),
        ] {
            let found = metres(text);
            let says = found.as_ref().err().is_some_and(|why| why.contains(part));
            assert!(says, "`{text}` gives {found:?}");
        }
        let deep = format!("{}1{}", "(".repeat(9999), ")".repeat(9999));
        assert!(metres(&deep).is_err());
        assert!(metres(&"-".repeat(99999)).is_err());
    }

    proptest! {
        #[test]
        fn what_a_number_is_written_as_is_that_number(number in any::<f32>()) {
            prop_assume!(number.is_finite());
            for text in [format!("{number}"), format!("{number:e}")] {
                let found = metres(&text).map(|found| found as f32);
                prop_assert_eq!(found, Ok(number), "{}", text);
            }
        }

        #[test]
        fn nothing_that_can_be_typed_panics_or_is_nan(
            letters in proptest::collection::vec(
                proptest::sample::select("0123456789.,+-*/^()=eE −×°%'\"abcdfgikmnoprstäπ∞".chars().collect::<Vec<_>>()),
                0..24,
            ),
            before in any::<f64>(),
        ) {
            let text: String = letters.into_iter().collect();
            for unit in [Unit::NONE, Unit::METRE, Unit::ANGLE, Unit("W/(sr·m²)")] {
                let found = typed_number(&text, unit, 1.0, before);
                prop_assert!(!found.is_ok_and(f64::is_nan), "{}", text);
            }
        }
    }
}
