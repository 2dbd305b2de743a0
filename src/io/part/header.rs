//! The attribute that makes a picture a part.

use super::{MOST_SAMPLES, Part};
use std::ops::Range;

pub(super) const ATTRIBUTE: &str = "glassbox";
const KIND: &str = "part";
const VERSION: u32 = 2;

/// What the attribute says.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    pub digest: String,
    pub samples: Vec<Range<u64>>,
    pub uniform: bool,
    pub output: String,
}

impl Header {
    pub fn of(part: &Part) -> Self {
        Self {
            digest: part.digest.clone(),
            samples: part.samples.clone(),
            uniform: part.uniform,
            output: part.output.clone(),
        }
    }

    /// What the checksum is of, beside the sums.
    pub fn to_text(&self) -> String {
        let ranges: Vec<String> = self
            .samples
            .iter()
            .map(|range| format!("{}..{}", range.start, range.end))
            .collect();
        let sampling = if self.uniform { "uniform" } else { "adaptive" };
        format!(
            "{KIND} {VERSION}\ndigest {}\nsamples {}\nsampling {sampling}\noutput {}",
            self.digest,
            ranges.join(" "),
            self.output
        )
    }

    /// The attribute.
    pub fn with_checksum(&self, checksum: u64) -> String {
        format!("{}\nchecksum {checksum:016x}", self.to_text())
    }

    /// Reads the attribute, with the checksum that it has; what is wrong with it where it is none.
    pub fn parse(text: &str) -> Result<(Self, u64), String> {
        let mut lines = text.lines();
        let said = lines.next().unwrap_or_default();
        let version = said.strip_prefix(KIND).map(|number| number.trim().parse());
        match version {
            Some(Ok(VERSION)) => {}
            Some(Ok(0..VERSION)) => {
                return Err(format!(
                    "is `{said}`, and this program reads `{KIND} {VERSION}`; render it again"
                ));
            }
            _ => {
                return Err(format!(
                    "is `{said}`, and this program reads `{KIND} {VERSION}`; update Glassbox"
                ));
            }
        }
        let mut line = |key: &str| {
            let line = lines.next().unwrap_or_default();
            let value = line.strip_prefix(key).map(str::trim_start);
            value.map(str::to_owned).ok_or_else(|| damaged(key))
        };
        let digest = line("digest")?;
        let samples = parse_ranges(&line("samples")?).ok_or_else(|| damaged("samples"))?;
        let uniform = match line("sampling")?.as_str() {
            "uniform" => true,
            "adaptive" => false,
            _ => return Err(damaged("sampling")),
        };
        let output = line("output")?;
        let checksum = line("checksum")?;
        let checksum = u64::from_str_radix(&checksum, 16).map_err(|_| damaged("checksum"))?;
        let header = Self {
            digest,
            samples,
            uniform,
            output,
        };
        Ok((header, checksum))
    }
}

fn damaged(key: &str) -> String {
    format!("is a part whose `{key}` cannot be read; render it again")
}

fn parse_ranges(text: &str) -> Option<Vec<Range<u64>>> {
    let mut ranges: Vec<Range<u64>> = Vec::new();
    for word in text.split_whitespace() {
        let (start, end) = word.split_once("..")?;
        let range = start.parse().ok()?..end.parse().ok()?;
        let apart = ranges.last().is_none_or(|last| last.end < range.start);
        if range.is_empty() || !apart {
            return None;
        }
        ranges.push(range);
    }
    let count: u64 = ranges.iter().map(|range| range.end - range.start).sum();
    (1..=MOST_SAMPLES).contains(&count).then_some(ranges)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_comes_back_as_it_was() {
        for (samples, uniform) in [(vec![0..64, 128..129], true), (vec![5..6, 9..12], false)] {
            let header = Header {
                digest: "00ff".into(),
                samples,
                uniform,
                output: "output.exposure=1.5 a=b".into(),
            };
            let text = header.with_checksum(0x0123);
            assert_eq!(Header::parse(&text), Ok((header, 0x0123)));
        }
    }

    #[test]
    fn ranges_that_make_no_sense_are_no_ranges() {
        for text in [
            "",
            "3..3",
            "5..2",
            "0..4 4..8",
            "0..8 2..4",
            "0..",
            "..",
            "a..b",
            "0..99999999999",
            "18446744073709551615..0",
        ] {
            assert_eq!(parse_ranges(text), None, "{text}");
        }
        for (said, then) in [
            ("part 3", "update"),
            ("film 2", "update"),
            ("part 1", "render it again"),
        ] {
            let error = Header::parse(said).unwrap_err();
            assert!(
                error.contains(&format!("`{said}`")) && error.contains(then),
                "{error}"
            );
        }
    }
}
