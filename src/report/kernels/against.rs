//! Ours against Embree, in a sentence.

use super::Row;
use super::candidates::Candidate;
use super::rays::CLASSES;
use crate::report::Subject;
use crate::report::table::digits;

/// Our speed over Embree's, for each of its kinds and each kind of rays on one scene: its candidate, the ratio, and what
/// it is of.
pub(super) fn ratios(
    subject: &Subject,
    candidates: &[Candidate],
    rows: &[Row],
) -> Vec<(usize, (f64, String))> {
    let Some(ours) = rows.first() else {
        return Vec::new();
    };
    let theirs = rows
        .iter()
        .filter(|row| candidates[row.candidate].library.is_some());
    theirs
        .flat_map(|row| {
            let of_class = |class: usize| {
                let what = format!("{} rays, {}", CLASSES[class], subject.name);
                (
                    row.candidate,
                    (ours.speeds[class] / row.speeds[class], what),
                )
            };
            (0..CLASSES.len()).map(of_class)
        })
        .filter(|(_, (ratio, _))| ratio.is_finite())
        .collect()
}

/// What a report on kernels says first: ours against Embree's, ray by ray.
pub(super) fn embree(
    candidates: &[Candidate],
    ratios: &[(usize, (f64, String))],
) -> Option<String> {
    let sentences: Vec<String> = (0..candidates.len())
        .filter_map(|theirs| {
            let of = ratios.iter().filter(|(candidate, _)| *candidate == theirs);
            let of: Vec<(f64, String)> = of.map(|(_, ratio)| ratio.clone()).collect();
            sentence("single rays", &candidates[theirs].name(), &of)
        })
        .collect();
    (!sentences.is_empty()).then(|| sentences.join(" "))
}

/// The geometric mean of ratios of speeds, and the worst with its name; `None` where there is none.
pub(super) fn sentence(ours: &str, theirs: &str, ratios: &[(f64, String)]) -> Option<String> {
    let worst = ratios.iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
    let logarithms: f64 = ratios.iter().map(|(ratio, _)| ratio.ln()).sum();
    let mean = (logarithms / ratios.len() as f64).exp();
    Some(format!(
        "Glassbox's {ours} are {}x as fast as {theirs} (geometric mean of {}), at worst {}x ({}).",
        digits(mean, 3),
        ratios.len(),
        digits(worst.0, 3),
        worst.1,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_tells_the_geometric_mean_and_the_worst() {
        let ratios = [(2.0, "knot".to_owned()), (0.5, "teapot".to_owned())];
        let said = sentence("rays", "theirs", &ratios).unwrap_or_default();
        assert_eq!(
            said,
            "Glassbox's rays are 1.00x as fast as theirs (geometric mean of 2), at worst 0.500x (teapot)."
        );
        assert_eq!(sentence("rays", "theirs", &[]), None);
    }
}
