//! Names that do not exist, and those that were perhaps meant.

/// So many names are told where none is similar.
const FEW: usize = 16;

/// Says that there is no such thing, and which ones have a similar name; where there are few, and none of them has, all.
pub(super) fn unknown<'a>(
    where_from: &str,
    what: &str,
    key: &str,
    names: impl Iterator<Item = &'a str>,
) -> String {
    let distance = |path: &str| {
        let last = path.rsplit('.').next().unwrap_or(path);
        edit_distance(key, path).min(edit_distance(key, last))
    };
    let mut near: Vec<(usize, &str)> = names.map(|path| (distance(path), path)).collect();
    near.sort_by_key(|(distance, _)| *distance);
    // The nearest where half of its letters are right, two more where they are mistakes of a few.
    let letters = key.chars().count();
    let close = |i: usize, distance: usize| match i {
        0 => distance <= letters / 2,
        _ => i < 3 && distance <= letters / 3,
    };
    let similar: Vec<&str> = (near.iter().enumerate())
        .filter(|(i, (distance, _))| close(*i, *distance))
        .map(|(_, (_, path))| *path)
        .collect();
    let all = || near.iter().map(|(_, path)| *path).collect::<Vec<_>>();
    let none = format!("{where_from}: no such {what}");
    match (similar.is_empty(), near.len()) {
        (false, _) => format!("{none}; did you mean {}?", similar.join(" or ")),
        (true, 1..=FEW) => format!("{none}; there is {}", all().join(", ")),
        _ => none,
    }
}

/// Levenshtein's distance: letters to insert, remove or replace.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(from != *to);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_levenshteins() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("", "abc"), 3);
        assert_eq!(edit_distance("abc", ""), 3);
    }

    #[test]
    fn only_names_that_are_similar_are_suggested_and_a_few_are_all_told() {
        let told = |key: &str, names: &[&str]| unknown("here", "name", key, names.iter().copied());
        let settings = ["spp", "features.shadows", "size"];
        assert_eq!(
            told("shadow", &settings),
            "here: no such name; did you mean features.shadows?"
        );
        assert_eq!(
            told("foo", &settings),
            "here: no such name; there is spp, size, features.shadows"
        );
        assert_eq!(told("foo", &["spp"; FEW + 1]), "here: no such name");
        assert_eq!(told("foo", &[]), "here: no such name");
    }
}
