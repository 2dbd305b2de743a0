//! Numbers with what they count, in words.

use crate::trace::RayCost;

/// `1 object`, `2 boxes`, `0 leaves`.
pub fn counted(number: u64, one: &str) -> String {
    format!("{number} {}", plural(number, one))
}

/// What so many are called, each being called `one`.
pub fn plural(number: u64, one: &str) -> String {
    if number == 1 {
        return one.to_owned();
    }
    match one {
        "leaf" => "leaves".to_owned(),
        "entity" => "entities".to_owned(),
        "box" => "boxes".to_owned(),
        one => format!("{one}s"),
    }
}

/// What finding something took.
pub fn cost_text(cost: &RayCost) -> String {
    let counts = [
        (cost.nodes, "node"),
        (cost.boxes, "box"),
        (cost.triangles, "triangle"),
    ];
    counts
        .map(|(number, what)| counted(number, what))
        .join(", ")
}

/// Why there are fewer samples than were asked for.
pub fn left_out_text(samples: u64) -> String {
    let were = if samples == 1 { "was" } else { "were" };
    format!(
        "{} of the pixel {were} left out: there would have been too many rays",
        counted(samples, "sample")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_counted_has_the_plural_that_it_asks_for() {
        assert_eq!(counted(1, "leaf"), "1 leaf");
        assert_eq!(counted(2, "leaf"), "2 leaves");
        assert_eq!(counted(0, "box"), "0 boxes");
        assert_eq!(counted(3, "ray"), "3 rays");
        assert_eq!(counted(3, "entity"), "3 entities");
        let cost = RayCost {
            nodes: 1,
            boxes: 2,
            triangles: 1,
        };
        assert_eq!(cost_text(&cost), "1 node, 2 boxes, 1 triangle");
        assert!(left_out_text(1).starts_with("1 sample of the pixel was"));
    }
}
