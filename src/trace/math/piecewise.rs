//! Choosing places on lines by densities that are linear between evenly spaced nodes, in columns.

use glam::Vec3;

/// The least that a node counts, as a part of the largest: where the true density is not linear between nodes, a
/// sample then counts at most 50 times what it should.
const LEAST_NODE: f32 = 0.02;

/// What a node counts at least where all are nothing: its square is a float.
const LEAST: f32 = 1e-18;

/// Places on lines, and the densities there.
pub(in crate::trace) struct Chosen<const N: usize> {
    /// In [0, 1].
    pub place: [f32; N],
    /// 1 on average over the line.
    pub density: [f32; N],
}

/// The places that `numbers` in [0, 1) choose on N lines of `NODES` nodes, which are not negative and below 1e18. Nodes much below the
/// largest are raised; where all are zero, all places are alike.
///
/// Within a cell between nodes a and b the share ξ of its density ends at ξ (a + b) / (a + √((1-ξ) a² + ξ b²)), where
/// the density is that root: the quadratic's root that loses no digits.
#[inline(always)]
pub(in crate::trace) fn choose<const NODES: usize, const N: usize>(
    nodes: &[[f32; N]; NODES],
    numbers: &[f32; N],
) -> Chosen<N> {
    let cells = (NODES - 1) as f32;
    let (mut place, mut density) = ([0.0; N], [0.0; N]);
    // Lane by lane, so that all choices are between numbers at hand: stores that depend on one would keep the loop from being
    // vectorised.
    for i in 0..N {
        let mut least = LEAST;
        for node in nodes {
            least = larger(least, LEAST_NODE * node[i]);
        }
        let mut total = 0.0;
        for (k, node) in nodes.iter().enumerate() {
            let weight = if k == 0 || k == NODES - 1 { 1.0 } else { 2.0 };
            total += weight * larger(node[i], least);
        }
        let (mut sum, mut before, mut cell) = (0.0, 0.0, 0.0);
        let (mut a, mut b) = (nodes[0][i], nodes[1][i]);
        for k in 1..NODES - 1 {
            sum += larger(nodes[k - 1][i], least) + larger(nodes[k][i], least);
            let beyond = numbers[i] * total >= sum;
            before = if beyond { sum } else { before };
            cell = if beyond { k as f32 } else { cell };
            a = if beyond { nodes[k][i] } else { a };
            b = if beyond { nodes[k + 1][i] } else { b };
        }
        let [a, b] = [larger(a, least), larger(b, least)];
        let share = within_one((numbers[i] * total - before) / (a + b));
        let root = ((1.0 - share) * (a * a) + share * (b * b)).sqrt();
        place[i] = smaller((cell + share * (a + b) / (a + root)) / cells, 1.0);
        density[i] = 2.0 * cells * root / total;
    }
    Chosen { place, density }
}

/// As vector units have it: the second where one is not a number.
#[inline(always)]
pub(in crate::trace) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The same of the smaller one.
#[inline(always)]
pub(in crate::trace) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The nearest number in [0, 1]; 0 for what is none.
#[inline(always)]
pub(in crate::trace) fn within_one(x: f32) -> f32 {
    smaller(larger(x, 0.0), 1.0)
}

/// How bright colours are, as parts of the brightest: linear RGB with Rec. 709's weights.
pub(in crate::trace) fn relative_luminances<const N: usize>(colors: &[Vec3; N]) -> [f32; N] {
    let luminances = colors.map(|color| color.dot(Vec3::new(0.2126, 0.7152, 0.0722)));
    let brightest = luminances.into_iter().fold(0.0, f32::max);
    // Exactly 1 where all are alike, whatever the colour: the same places are chosen then.
    luminances.map(|luminance| {
        if brightest > 0.0 && brightest < f32::INFINITY {
            luminance / brightest
        } else {
            1.0
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_come_as_often_as_their_density_says() {
        let nodes = [0.0, 3.0, 1.0, 1.0, 0.5].map(|node| [node]);
        let steps = 100_000;
        let (mut first, mut one) = (0.0_f64, 0.0_f64);
        for i in 0..steps {
            let chosen = choose(&nodes, &[(i as f32 + 0.5) / steps as f32]);
            let ([place], [density]) = (chosen.place, chosen.density);
            assert!((0.0..=1.0).contains(&place) && density > 0.0);
            // The integrals of 1 and of x over the line.
            one += 1.0 / f64::from(density) / f64::from(steps);
            first += f64::from(place) / f64::from(density) / f64::from(steps);
        }
        assert!((one - 1.0).abs() < 1e-4, "{one}");
        assert!((first - 0.5).abs() < 1e-4, "{first}");
    }

    #[test]
    fn a_node_of_zero_is_chosen_now_and_then_and_counts_no_more_than_fifty_times() {
        let chosen = choose(&[[0.0], [1.0], [1.0]], &[0.0]);
        assert_eq!(chosen.place, [0.0]);
        assert!(
            (0.02..0.03).contains(&chosen.density[0]),
            "{:?}",
            chosen.density
        );
    }

    #[test]
    fn nodes_that_are_all_zero_choose_evenly() {
        for i in 0..8 {
            let number = i as f32 / 8.0;
            let chosen = choose(&[[0.0]; 3], &[number]);
            assert!((chosen.place[0] - number).abs() < 1e-6, "{number}");
            assert!((chosen.density[0] - 1.0).abs() < 1e-6, "{number}");
        }
    }
}
