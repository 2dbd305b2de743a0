//! What is wrong with a line of an OBJ: [`first_fault`] finds the line of an error that tobj reports without
//! one, after the failure; [`unbounded`] sees beforehand what tobj would take for something else.

use super::super::error::{FileError, Place, Problem};
use std::io::{BufRead, BufReader};
use std::num::IntErrorKind;
use std::path::Path;

/// The first line of an OBJ that names a number that is not one, or a corner that does not exist.
pub(super) fn first_fault(file: &Path) -> Option<FileError> {
    let mut reader = BufReader::new(super::super::open_regular(file).ok()?);
    let mut buffer = Vec::new();
    let mut counts = [0_usize; 3];
    for number in 1.. {
        buffer.clear();
        if reader.read_until(b'\n', &mut buffer).ok()? == 0 {
            break;
        }
        let line = String::from_utf8_lossy(&buffer);
        if let Some(problem) = fault_of(&line, &mut counts) {
            return Some(FileError::at(file, Place::Line(number), problem));
        }
    }
    None
}

fn fault_of(line: &str, counts: &mut [usize; 3]) -> Option<Problem> {
    let mut words = line.split_ascii_whitespace();
    let (kind, count, what) = match words.next()? {
        "v" => (0, 3, "a vertex"),
        "vt" => (1, 2, "a texture coordinate"),
        "vn" => (2, 3, "a normal"),
        "f" => return words.find_map(|corner| fault_of_corner(corner, counts)),
        _ => return None,
    };
    counts[kind] += 1;
    let given: Vec<&str> = words.collect();
    if given.len() < count {
        return Some(Problem::Truncated(format!(
            "{what} needs {count} numbers and has {}",
            given.len()
        )));
    }
    for word in &given {
        match word.parse::<f32>() {
            Err(_) => return Some(Problem::Malformed(format!("`{word}` is not a number"))),
            Ok(value) if !value.is_finite() => {
                return Some(Problem::NotFinite {
                    what: format!("{what}'s `{word}`"),
                });
            }
            Ok(_) => {}
        }
    }
    let w_is_zero = kind == 0 && given.len() == 4 && given[3].parse() == Ok(0.0_f32);
    if w_is_zero {
        return Some(Problem::Malformed("a vertex has w = 0".into()));
    }
    if kind == 0 && !matches!(given.len(), 3 | 4 | 6) {
        return Some(Problem::Malformed(format!(
            "a vertex has {} numbers; 3, 4 or 6 are possible",
            given.len()
        )));
    }
    None
}

fn fault_of_corner(corner: &str, counts: &[usize; 3]) -> Option<Problem> {
    for (kind, index) in corner.split('/').enumerate() {
        if kind >= counts.len() {
            return Some(Problem::Malformed(format!(
                "the corner `{corner}` has more than three indices"
            )));
        }
        if index.is_empty() && kind > 0 {
            continue;
        }
        match index.parse::<i64>() {
            Ok(i) if i != 0 && i.unsigned_abs() <= counts[kind] as u64 => {}
            Err(error)
                if !matches!(
                    error.kind(),
                    IntErrorKind::PosOverflow | IntErrorKind::NegOverflow
                ) =>
            {
                return Some(Problem::Malformed(format!(
                    "the corner `{corner}` of a face is not an index"
                )));
            }
            _ => return Some(out_of_range(kind, index, counts)),
        }
    }
    None
}

/// What is wrong with a corner that tobj would compute with beyond a number's range: an index that counts back
/// to before the first, or one with more digits than any count has.
pub(super) fn unbounded(corner: &str, counts: &[usize; 3]) -> Option<Problem> {
    const DIGITS: usize = 10;
    let mut indices = corner.split('/').zip(counts).enumerate();
    indices.find_map(|(kind, (index, &count))| {
        let digits = index.trim_start_matches(['+', '-']);
        let is_there = match index.starts_with('-') {
            true => digits.parse().is_ok_and(|back: usize| back <= count),
            false => digits.len() <= DIGITS,
        };
        // What is no number at all tobj sees itself.
        let is_number = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
        (is_number && !is_there).then(|| out_of_range(kind, index, counts))
    })
}

fn out_of_range(kind: usize, index: &str, counts: &[usize; 3]) -> Problem {
    const WHAT: [&str; 3] = ["vertex", "texture coordinate", "normal"];
    Problem::IndexOutOfRange {
        what: WHAT[kind],
        index: index.into(),
        count: counts[kind],
    }
}
