//! The pattern of a pixel's samples as a square in a picture's lower right corner.

use super::pattern::Pattern;
use glam::{IVec2, UVec2};

/// The square takes this part of the picture's shorter side.
const PART: f32 = 0.28;

/// What of the picture is left behind it.
const DIMMED: f32 = 0.12;

const FRAME: [f32; 3] = [0.7; 3];
const GRID: [f32; 3] = [0.3; 3];
const POINT: [f32; 3] = [1.0, 0.9, 0.2];

/// Draws frame, grid (as many cells as there are samples, where these have a whole root) and points.
pub fn draw_pattern(pixels: &mut [[f32; 3]], size: UVec2, pattern: &Pattern) {
    let side = (PART * size.min_element() as f32) as i32;
    let origin = size.as_ivec2() - IVec2::splat(side + side / 20 + 1);
    if side < 8 {
        return;
    }
    let mut set = |at: IVec2, change: &dyn Fn([f32; 3]) -> [f32; 3]| {
        let place = origin + at;
        if place.cmpge(IVec2::ZERO).all() && place.cmplt(size.as_ivec2()).all() {
            let index = place.y as usize * size.x as usize + place.x as usize;
            if let Some(pixel) = pixels.get_mut(index) {
                *pixel = change(*pixel);
            }
        }
    };
    let count = pattern.points.len();
    let cells = (count as f64).sqrt().round() as usize;
    let cells = if cells * cells == count && cells <= side as usize / 6 {
        cells as i32
    } else {
        1
    };
    for y in 0..=side {
        for x in 0..=side {
            let on_line = |i: i32| (0..=cells).any(|cell| cell * side / cells == i);
            let at = IVec2::new(x, y);
            if [0, side].contains(&x) || [0, side].contains(&y) {
                set(at, &|_| FRAME);
            } else if on_line(x) || on_line(y) {
                set(at, &|_| GRID);
            } else {
                set(at, &|pixel| pixel.map(|channel| DIMMED * channel));
            }
        }
    }
    let radius = (side / 120).max(1);
    for point in &pattern.points {
        let middle = (*point * side as f32).as_ivec2();
        for dy in -radius..=radius {
            for dx in -radius..=radius {
                let at = middle + IVec2::new(dx, dy);
                if dx * dx + dy * dy <= radius * radius && at.cmpge(IVec2::ZERO).all() {
                    set(at, &|_| POINT);
                }
            }
        }
    }
}
