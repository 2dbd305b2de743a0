//! Which pixels of a target a view has, and which of them show its picture.

use bevy::math::{URect, UVec2};
use bevy::render::camera::ExtractedCamera;

/// The pixels of the target that show the picture; `None` where there are none.
pub(super) fn traced_part(camera: &ExtractedCamera, divider: f32) -> Option<URect> {
    right_of(whole_part(camera)?, divider, camera.physical_target_size?)
}

/// The pixels of the target that are a view's.
pub(super) fn whole_part(camera: &ExtractedCamera) -> Option<URect> {
    Some(match &camera.viewport {
        Some(viewport) => URect {
            min: viewport.physical_position,
            max: viewport.physical_position + viewport.physical_size,
        },
        None => URect {
            min: UVec2::ZERO,
            max: camera.physical_target_size?,
        },
    })
}

/// What is right of a part of the width, and inside the target.
fn right_of(mut part: URect, divider: f32, target: UVec2) -> Option<URect> {
    let left = (part.width() as f32 * divider.clamp(0.0, 1.0)).round() as u32;
    part.min.x += left;
    part.max = part.max.min(target);
    let any = part.min.cmplt(part.max).all();
    any.then_some(part)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_drawn_right_of_the_divider_in_its_own_viewport_alone() {
        let target = UVec2::new(200, 100);
        let right = URect::new(100, 0, 200, 100);
        let part = |divider| right_of(right, divider, target);
        assert_eq!(part(0.0), Some(right));
        assert_eq!(part(0.25), Some(URect::new(125, 0, 200, 100)));
        assert_eq!(part(1.0), None);
        let beyond = URect::new(150, 50, 300, 300);
        let inside = Some(URect::new(150, 50, 200, 100));
        assert_eq!(right_of(beyond, 0.0, target), inside);
        assert_eq!(right_of(URect::new(200, 0, 300, 9), 0.0, target), None);
        assert_eq!(right_of(URect::new(5, 5, 5, 9), 0.0, target), None);
    }
}
