//! A number with the digits that say something.

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
}
