//! Which films can be rendered and shown, of those that an app may ask for.

use crate::io::{Budget, Size, film_bytes};
use bevy::math::UVec2;

/// Why a film of so many pixels is not rendered, to follow a view's name; `None` where it is. `most` is the longest side of a
/// picture that can be drawn.
pub(super) fn refusal(size: UVec2, most: Option<u32>) -> Option<String> {
    let film = format!("its film of {} × {} pixels", size.x, size.y);
    if size.min_element() == 0 {
        return Some(format!("{film} has none; nothing is traced for it"));
    }
    if let Some(most) = most.filter(|most| size.max_element() > *most) {
        return Some(format!(
            "{film} is more than can be drawn, {most} on a side; nothing is traced for it"
        ));
    }
    let bytes = film_bytes(size);
    let fits = Budget::default().holding(0).claim(bytes).is_ok();
    (!fits).then(|| {
        let needs = Size(bytes);
        format!("{film} needs {needs} of memory, more than there is; nothing is traced for it")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_has_pixels_and_fits_into_memory_and_onto_the_card_is_rendered() {
        let most = Some(16_384);
        for (size, most, why) in [
            (UVec2::new(1920, 1080), most, None),
            (UVec2::new(20_000, 10), None, None),
            (UVec2::new(0, 1080), most, Some("has none")),
            (UVec2::new(20_000, 10), most, Some("16384 on a side")),
            (UVec2::splat(u32::MAX), None, Some("of memory")),
            // Their bytes are 0, as far as 64 bits can tell.
            (UVec2::splat(1 << 31), None, Some("of memory")),
        ] {
            let refused = refusal(size, most);
            let is_right = match (&refused, why) {
                (Some(said), Some(why)) => said.contains(why),
                (said, why) => said.is_none() && why.is_none(),
            };
            assert!(is_right, "{size}: {refused:?}");
        }
    }
}
