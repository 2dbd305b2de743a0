//! Files that were damaged at random: whatever they are, reading them ends in a scene or in one line.
//!
//! `fuzz/` has targets for cargo-fuzz with the same entry point; this drives it on any compiler.

#[path = "../../fuzz/src/lib.rs"]
mod reader;

use crate::analytic::Numbers;
use reader::{KINDS, read};
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

fn corpus() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_input/corpus")
}

/// The corpus' files of a kind, good and broken.
fn seeds(kind: &str) -> Vec<Vec<u8>> {
    let of_kind = |path: &PathBuf| {
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let extension = if kind == "scene" { "scn.ron" } else { kind };
        name.ends_with(&format!(".{extension}"))
    };
    let mut files: Vec<PathBuf> = fs::read_dir(corpus())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(of_kind)
        .collect();
    files.sort();
    files.iter().map(|file| fs::read(file).unwrap()).collect()
}

/// What parsers trip over.
const TOKENS: [&str; 20] = [
    "0",
    "-1",
    "1e39",
    "nan",
    "inf",
    "-0.0",
    "4294967296",
    "2147483648",
    "-9223372036854775808",
    "\0",
    "\u{feff}",
    "\n",
    "\"",
    "(((((((((",
    "[[[[[[[[[",
    "{{{{{{{{{",
    "//",
    "é",
    "null",
    "999999999999999999999999",
];

fn below(numbers: &mut Numbers, count: usize) -> usize {
    ((numbers.unit() * count as f32) as usize).min(count.saturating_sub(1))
}

/// One to eight changes: bits, bytes, pieces that go, come twice, come from another file or swap, numbers, tokens.
fn mutated(seeds: &[Vec<u8>], numbers: &mut Numbers) -> Vec<u8> {
    let mut bytes = seeds[below(numbers, seeds.len())].clone();
    for _ in 0..=below(numbers, 8) {
        let at = below(numbers, bytes.len() + 1);
        let end = (at + 1 + below(numbers, 24)).min(bytes.len());
        match below(numbers, 9) {
            0 if at < bytes.len() => bytes[at] ^= 1 << below(numbers, 8),
            1 if at < bytes.len() => bytes[at] = below(numbers, 256) as u8,
            2 if at < end => drop(bytes.drain(at..end)),
            3 if at < end => {
                let piece = bytes[at..end].to_vec();
                let to = below(numbers, bytes.len());
                bytes.splice(to..to, piece);
            }
            4 => {
                let other = &seeds[below(numbers, seeds.len())];
                let from = below(numbers, other.len() + 1);
                let until = (from + below(numbers, 200)).min(other.len());
                bytes.splice(at..at, other[from..until].iter().copied());
            }
            5 => {
                let token = TOKENS[below(numbers, TOKENS.len())];
                bytes.splice(at..at, token.bytes());
            }
            6 => {
                // A number is replaced by another token.
                let digit = (at..bytes.len()).find(|&i| bytes[i].is_ascii_digit());
                if let Some(first) = digit {
                    let part = |b: &u8| b.is_ascii_digit() || b".-e".contains(b);
                    let last = (first..bytes.len())
                        .find(|&i| !part(&bytes[i]))
                        .unwrap_or(bytes.len());
                    let token = TOKENS[below(numbers, TOKENS.len())];
                    bytes.splice(first..last, token.bytes());
                }
            }
            7 => bytes.truncate(at.max(bytes.len() / 2)),
            _ if bytes.len() > 8 => {
                // Four bytes become a count or an offset.
                let at = below(numbers, bytes.len() - 4);
                let value: u32 = [0, 1, u32::MAX, 1 << 31, 0x7f7f_ffff, 12][below(numbers, 6)];
                bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
            }
            _ => {}
        }
    }
    bytes
}

/// Reads mutations until enough of them were read or the time is up; returns how many were, and how many opened.
fn mutate(kind: &str, most: usize, time: Duration, seed: u64) -> (usize, usize) {
    let seeds = seeds(kind);
    assert!(
        seeds.len() >= 2,
        "the corpus has {} files for {kind}",
        seeds.len()
    );
    let folder = tempfile::tempdir().unwrap();
    let mut numbers = Numbers(seed);
    let (mut opened, start) = (0, Instant::now());
    for count in 0..most {
        if start.elapsed() > time {
            return (count, opened);
        }
        let bytes = mutated(&seeds, &mut numbers);
        let result = catch_unwind(AssertUnwindSafe(|| read(kind, &bytes, folder.path())));
        match result {
            Ok(did) => opened += usize::from(did),
            Err(_) => {
                let kept = std::env::temp_dir().join(format!("glassbox-finding.{kind}"));
                fs::write(&kept, &bytes).unwrap();
                panic!(
                    "{kind}: mutation {count} of seed {seed} panics, kept as {}",
                    kept.display()
                );
            }
        }
    }
    (most, opened)
}

#[test]
fn every_file_of_the_corpus_ends_in_a_scene_or_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    for (kind, ..) in KINDS {
        let seeds = seeds(kind);
        let opened = seeds
            .iter()
            .filter(|seed| read(kind, seed, folder.path()))
            .count();
        assert!(opened > 0, "{kind}: none of {} files opens", seeds.len());
        // What an MTL or a picture holds is no reason to refuse the OBJ that names it.
        assert!(
            opened < seeds.len() || kind == "mtl" || kind == "picture",
            "{kind}: none of {} files is refused",
            seeds.len()
        );
    }
}

#[test]
fn a_few_hundred_mutations_of_every_kind_end_in_a_scene_or_in_one_line() {
    for (kind, ..) in KINDS {
        let (read, opened) = mutate(kind, 300, Duration::MAX, 7);
        println!("{kind}: {read} read, {opened} opened");
        // What is behind a reader's first check is met, too.
        assert!(opened > 0, "{kind}: none of {read} opens");
    }
}

/// All kinds at once, a thread each, for `GLASSBOX_MUTATE_SECONDS`; 600 where it is not set.
#[test]
#[ignore = "takes ten minutes"]
fn ten_minutes_of_mutations_of_every_kind_end_in_a_scene_or_in_one_line() {
    let seconds = std::env::var("GLASSBOX_MUTATE_SECONDS").ok();
    let seconds = seconds.and_then(|text| text.parse().ok()).unwrap_or(600);
    thread::scope(|scope| {
        for (kind, ..) in KINDS {
            scope.spawn(move || {
                let (read, opened) = mutate(kind, usize::MAX, Duration::from_secs(seconds), 1);
                println!("{kind}: {read} read in {seconds} s, {opened} opened");
            });
        }
    });
}
