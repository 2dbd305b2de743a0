use super::{MOST_SAMPLES, Part};
use glam::UVec2;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Why parts do not add up.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MergeError {
    /// There is none.
    #[error("no part to merge")]
    Nothing,
    /// Samples of something else.
    #[error(
        "{}: holds samples of another scene, camera or settings than {}; render both with the same",
        file.display(),
        first.display()
    )]
    OtherScene {
        /// The part.
        file: PathBuf,
        /// What it was to be added to.
        first: PathBuf,
    },
    /// The pixels have different numbers of samples, chosen by what was found.
    #[error("{}: was sampled adaptively, so it cannot be added to; render it without --error and --time", .0.display())]
    Adaptive(PathBuf),
    /// The same samples twice.
    #[error(
        "{}: holds samples {}..{}, which {} holds too; leave one of them out",
        file.display(),
        range.start,
        range.end,
        other.display()
    )]
    Overlap {
        /// The part.
        file: PathBuf,
        /// The other one that has them.
        other: PathBuf,
        /// What both have.
        range: Range<u64>,
    },
    /// More than a sum holds.
    #[error("{0} samples of each pixel, and the limit is {MOST_SAMPLES}")]
    TooMany(u64),
}

/// Parts that are added up one after the other, so that two of them are in memory, however many
/// there are.
#[derive(Debug, Default)]
pub struct Merge {
    sum: Option<Part>,
    /// What has been added, and from which file, in the order of the samples.
    held: Vec<(Range<u64>, PathBuf)>,
    first: PathBuf,
}

impl Merge {
    /// Pixels of the picture; `None` before the first part.
    pub fn size(&self) -> Option<UVec2> {
        self.sum.as_ref().map(|part| part.film.size())
    }

    /// Adds a part, or says why it does not belong to those before; then nothing has changed.
    pub fn add(&mut self, file: &Path, part: Part) -> Result<(), MergeError> {
        if !part.uniform {
            return Err(MergeError::Adaptive(file.to_path_buf()));
        }
        let Some(sum) = &mut self.sum else {
            self.first = file.to_path_buf();
            self.hold(file, &part);
            self.sum = Some(part);
            return Ok(());
        };
        if part.digest != sum.digest || part.film.size() != sum.film.size() {
            return Err(MergeError::OtherScene {
                file: file.to_path_buf(),
                first: self.first.clone(),
            });
        }
        for range in &part.samples {
            for (held, other) in &self.held {
                let both = range.start.max(held.start)..range.end.min(held.end);
                if !both.is_empty() {
                    return Err(MergeError::Overlap {
                        file: file.to_path_buf(),
                        other: other.clone(),
                        range: both,
                    });
                }
            }
        }
        let count = length(&sum.samples) + length(&part.samples);
        if count > MOST_SAMPLES {
            return Err(MergeError::TooMany(count));
        }
        // Sizes were compared above.
        sum.film.merge(&part.film);
        self.hold(file, &part);
        Ok(())
    }

    fn hold(&mut self, file: &Path, part: &Part) {
        let ranges = part.samples.iter();
        self.held
            .extend(ranges.map(|range| (range.clone(), file.to_path_buf())));
        self.held.sort_by_key(|(range, _)| range.start);
        if let Some(sum) = &mut self.sum {
            sum.samples = joined(self.held.iter().map(|(range, _)| range));
        }
    }

    /// The part that one run would have rendered with all these samples.
    pub fn finish(self) -> Result<Part, MergeError> {
        self.sum.ok_or(MergeError::Nothing)
    }
}

fn length(ranges: &[Range<u64>]) -> u64 {
    ranges.iter().map(|range| range.end - range.start).sum()
}

/// Ranges in order; those that touch become one.
fn joined<'a>(ranges: impl Iterator<Item = &'a Range<u64>>) -> Vec<Range<u64>> {
    let mut joined: Vec<Range<u64>> = Vec::new();
    for range in ranges {
        match joined.last_mut() {
            Some(last) if last.end == range.start => last.end = range.end,
            _ => joined.push(range.clone()),
        }
    }
    joined
}
