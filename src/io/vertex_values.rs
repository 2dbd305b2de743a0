//! Numbers of vertices as files have them, brought to what can be used: what is not finite, and colours up to 1, or up to
//! 255, which files do not say.

/// Light that is brighter than white reaches so far in files; numbers beyond are counted to 255.
const BRIGHTEST: f32 = 16.0;

/// The most that is counted to. One number beyond, or an infinite one, says nothing of how the others are meant.
const MOST: f32 = 255.0;

/// Brings colours, with alpha where they have a fourth number, into [0, 1]. What was the matter and what was done
/// instead, where not all of them were there.
pub(super) fn to_unit<const N: usize>(
    colors: &mut [[f32; N]],
) -> Option<(&'static str, &'static str)> {
    let numbers = || colors.as_flattened().iter();
    if numbers().all(|number| (0.0..=1.0).contains(number)) {
        return None;
    }
    // What is not a number is smaller than any.
    let largest = |from: usize, to: usize| {
        let channels = colors.iter().flat_map(|color| color[from..to].iter());
        let meant = channels.filter(|number| **number <= MOST);
        meant.fold(0.0, |most: f32, &number| most.max(number))
    };
    let (of_color, of_alpha) = (largest(0, N.min(3)), largest(N.min(3), N));
    let is_whole = |number: &f32| number.fract() == 0.0;
    let is_counted = of_color > BRIGHTEST || (of_color > 1.0 && numbers().all(is_whole));
    let of_255 = |is_so: bool| if is_so { MOST } else { 1.0 };
    let (whole, whole_alpha) = (of_255(is_counted), of_255(is_counted && of_alpha > 1.0));
    for color in colors {
        for (channel, number) in color.iter_mut().enumerate() {
            let whole = if channel < 3 { whole } else { whole_alpha };
            *number = (*number / whole).clamp(0.0, 1.0).max(0.0);
        }
    }
    Some(match is_counted {
        true => ("vertex colours above 1", "read as numbers up to 255"),
        false => ("vertex colours outside 0 to 1", "clamped"),
    })
}

/// Puts 0 in the place of what is not finite; true where there was any.
pub(super) fn clear<const N: usize>(values: &mut [[f32; N]]) -> bool {
    let mut any = false;
    for value in values {
        if !value.iter().all(|value| value.is_finite()) {
            *value = [0.0; N];
            any = true;
        }
    }
    any
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_up_to_1_stay_those_up_to_255_are_divided_and_others_are_clamped() {
        let mut colors = [[0.0, 0.5, 1.0]];
        assert_eq!(to_unit(&mut colors), None);
        assert_eq!(colors, [[0.0, 0.5, 1.0]]);
        for (mut colors, brought, instead) in [
            (
                [[255.0, 51.0, 0.0]],
                [1.0, 0.2, 0.0],
                "read as numbers up to 255",
            ),
            (
                [[63.75, 0.5, 0.0]],
                [0.25, 0.5 / 255.0, 0.0],
                "read as numbers up to 255",
            ),
            ([[1.000_001, 0.5, -0.1]], [1.0, 0.5, 0.0], "clamped"),
            ([[f32::NAN, 4.5, 1.0]], [0.0, 1.0, 1.0], "clamped"),
        ] {
            assert_eq!(
                to_unit(&mut colors).map(|(_, instead)| instead),
                Some(instead)
            );
            assert_eq!(colors, [brought]);
        }
    }

    #[test]
    fn a_number_that_no_colour_has_does_not_make_the_others_dark() {
        for wrong in [f32::INFINITY, 3e38, 256.0] {
            let mut colors = [[wrong, 1.0, 0.5], [1.0, 0.5, 0.0]];
            assert_eq!(
                to_unit(&mut colors).map(|(_, instead)| instead),
                Some("clamped")
            );
            assert_eq!(colors, [[1.0, 1.0, 0.5], [1.0, 0.5, 0.0]], "{wrong}");
            let mut colors = [[wrong, 255.0, 51.0], [255.0, 0.0, 0.0]];
            to_unit(&mut colors);
            assert_eq!(colors, [[1.0, 1.0, 0.2], [1.0, 0.0, 0.0]], "{wrong}");
            let mut colors = [[255.0, 0.0, 51.0, wrong], [0.0, 0.0, 0.0, 1.0]];
            to_unit(&mut colors);
            assert_eq!(
                colors,
                [[1.0, 0.0, 0.2, 1.0], [0.0, 0.0, 0.0, 1.0]],
                "{wrong}"
            );
        }
    }

    #[test]
    fn alpha_up_to_1_beside_colors_up_to_255_stays() {
        let mut colors = [[255.0, 0.0, 51.0, 1.0], [0.0, 0.0, 0.0, 0.0]];
        to_unit(&mut colors);
        assert_eq!(colors, [[1.0, 0.0, 0.2, 1.0], [0.0; 4]]);
    }
}
