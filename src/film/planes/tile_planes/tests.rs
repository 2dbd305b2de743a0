//! A tile's picture against that of all its planes, after anything.

use super::*;
use crate::film::sums::sum_columns::SumColumns;
use proptest::prelude::*;

const PLANES: usize = 4;

/// What happens to a tile between two pictures.
#[derive(Clone, Copy, Debug)]
enum Step {
    Tint(usize, f32),
    Samples,
    /// Another light, with as many samples as there are.
    Moved(usize, f32),
    Swapped(usize, usize),
    Nothing,
}

fn step() -> impl Strategy<Value = Step> {
    let plane = || 0..PLANES;
    prop_oneof![
        4 => (1..PLANES, 0.0..4_f32).prop_map(|(plane, tint)| Step::Tint(plane, tint)),
        1 => Just(Step::Samples),
        4 => (1..PLANES, 0.0..9_f32).prop_map(|(plane, value)| Step::Moved(plane, value)),
        1 => (plane(), plane()).prop_map(|(a, b)| Step::Swapped(a, b)),
        1 => Just(Step::Nothing),
    ]
}

/// `value` in every pixel of so many planes, a little more from pixel to pixel.
fn sums(planes: usize, value: f32) -> SumColumns {
    let mut sums = SumColumns::default();
    sums.reset(planes * TILE_PIXELS);
    let values: Vec<Vec3> = (0..planes * TILE_PIXELS)
        .map(|i| value * Vec3::new(1.0, 0.3, 1e-4 * i as f32))
        .collect();
    sums.add(0, &values);
    sums
}

proptest! {
    #[test]
    fn a_picture_is_that_of_all_planes_whatever_is_kept_of_the_last_one(
        steps in prop::collection::vec(step(), 1..40),
    ) {
        let mut tile = TilePlanes {
            planes: (0..PLANES).map(|_| Plane::empty(Vec3::ONE)).collect(),
            keeps_moves: true,
            ..TilePlanes::default()
        };
        let all = PlaneSet::ALL;
        tile.add(Pixels::All, all, (all, sums(PLANES, 0.7).all()), 1, 1);
        for step in steps {
            let count = tile.counts()[0];
            match step {
                Step::Tint(plane, tint) => {
                    let mut tints: Vec<Vec3> = tile.planes.iter().map(|p| p.tint).collect();
                    tints[plane] = Vec3::new(tint, 1.0, 0.5 * tint);
                    tile.retint(&tints);
                }
                Step::Samples if count < 1 << 20 => {
                    tile.add(Pixels::All, all, (all, sums(PLANES, 0.3).all()), count, 2);
                }
                Step::Moved(plane, value) => {
                    let mut from: Vec<_> = (0..PLANES).map(Some).collect();
                    from[plane] = None;
                    tile.rearrange(&from);
                    prop_assert!(tile.lacks_light());
                    let plane = PlaneSet::NONE.with(plane);
                    tile.add(Pixels::All, plane, (plane, sums(1, value).all()), count, u64::from(count));
                }
                Step::Swapped(a, b) if a != OWN && b != OWN => {
                    let mut from: Vec<_> = (0..PLANES).map(Some).collect();
                    from.swap(a, b);
                    tile.rearrange(&from);
                }
                _ => {}
            }
            let mut whole = Blend::new();
            tile.blend_into(|_| true, &mut whole);
            let whole = whole.sums().means(tile.counts());
            prop_assert_eq!(tile.means(), whole, "after {:?}", step);
        }
    }
}
