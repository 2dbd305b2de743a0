//! The points that no other beats in both speed and error.

/// Which of the points (speed, error) are on the front: none other is at least as fast with at most the error, and
/// better in one of the two. Points with a number that is not finite are not.
pub(super) fn front(points: &[(f64, f64)]) -> Vec<bool> {
    let beaten = |&(speed, error): &(f64, f64)| {
        let beats = |&(s, e): &(f64, f64)| s >= speed && e <= error && (s > speed || e < error);
        points.iter().any(beats)
    };
    let finite = |point: &(f64, f64)| point.0.is_finite() && point.1.is_finite();
    points.iter().map(|p| finite(p) && !beaten(p)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_on_the_front_unless_another_is_better_in_one_and_no_worse_in_the_other() {
        let points = [
            (1.0, 1.0),
            (2.0, 2.0),
            (1.5, 2.0),
            (2.0, 3.0),
            (f64::NAN, 0.0),
        ];
        assert_eq!(front(&points), [true, true, false, false, false]);
        assert_eq!(front(&[(1.0, 1.0), (1.0, 1.0)]), [true, true]);
    }
}
