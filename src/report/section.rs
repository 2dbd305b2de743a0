//! What a report is made of, and which parts are asked for.

use super::{Machine, Plot, Subject, Table, editing, features, kernels, sampling, stability};
use crate::film::views::Shown;

/// A part of the report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the modules of the same names say it all")]
pub enum Part {
    Kernels,
    Sampling,
    Features,
    Stability,
}

impl Part {
    /// All of them, in the report's order.
    pub const ALL: [Self; 4] = [
        Self::Kernels,
        Self::Sampling,
        Self::Features,
        Self::Stability,
    ];

    /// As the command line names it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kernels => "kernels",
            Self::Sampling => "sampling",
            Self::Features => "features",
            Self::Stability => "stability",
        }
    }
}

/// How a report is made.
#[derive(Clone, Debug)]
pub struct Options {
    /// What it holds.
    pub parts: Vec<Part>,
    /// Fewer rays, rounds and samples: 20 seconds to two minutes for a scene on two cores.
    pub quick: bool,
    /// Chooses all random numbers.
    pub seed: u32,
    /// The command that makes the same report again.
    pub command: String,
    /// What edits cost, where that was measured elsewhere: the figures of an editing benchmark.
    pub editing: Option<Table>,
}

/// One part's results.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// Its heading.
    pub title: String,
    /// What was found, a sentence each, the most important first.
    pub findings: Vec<String>,
    /// How it was measured, a paragraph each.
    pub method: Vec<String>,
    /// The figures.
    pub tables: Vec<Table>,
    /// The figures, drawn.
    pub plots: Vec<Plot>,
    /// Renderings: the name of the file without its extension, what it shows, and its pixels.
    pub pictures: Vec<(String, String, Shown)>,
    /// Which of the tables is shown on the terminal.
    pub summary: Option<usize>,
    /// What should hold and does not.
    pub failures: Vec<String>,
}

/// A whole report.
#[derive(Clone, Debug)]
pub struct Report {
    /// How it was made.
    pub options: Options,
    /// Where.
    pub machine: Machine,
    /// The scenes.
    pub scenes: Vec<String>,
    /// What came out.
    pub sections: Vec<Section>,
    /// Seconds that all of it took.
    pub seconds: f64,
}

impl Report {
    /// What was found, in three sentences (fewer where fewer parts were asked for).
    pub fn findings(&self) -> Vec<String> {
        let sections = || {
            self.sections
                .iter()
                .filter(|section| !section.findings.is_empty())
        };
        let found = |section: usize, sentence: usize| {
            let section = sections().nth(section)?;
            section.findings.get(sentence).cloned()
        };
        let chosen: &[(usize, usize)] = match sections().count() {
            1 => &[(0, 0), (0, 1), (0, 2)],
            2 => &[(0, 0), (0, 1), (1, 0)],
            _ => &[(0, 0), (1, 0), (2, 0)],
        };
        let mut sentences: Vec<String> =
            (chosen.iter()).filter_map(|&(s, i)| found(s, i)).collect();
        // The parts after the third share its sentence.
        for more in (3..sections().count()).filter_map(|section| found(section, 0)) {
            if let Some(last) = sentences.last_mut() {
                // What is found begins with a number or an ordinary word, which is no sentence's first here.
                let (first, rest) = more.split_at(more.chars().next().map_or(0, char::len_utf8));
                let (said, first) = (last.trim_end_matches('.'), first.to_lowercase());
                *last = format!("{said}; {first}{rest}");
            }
        }
        sentences
    }

    /// What should hold and does not, of all sections.
    pub fn failures(&self) -> impl Iterator<Item = &String> {
        self.sections.iter().flat_map(|section| &section.failures)
    }
}

/// Hears what is being done, and how much of how much of it.
pub type Watch<'a> = &'a (dyn Fn(&str, u64, u64) + Sync);

/// Measures what is asked for, on the current rayon pool.
pub fn run(subjects: &[Subject], options: &Options, watch: Watch) -> Report {
    let start = std::time::Instant::now();
    let machine = Machine::here();
    let mut sections: Vec<Section> = options
        .parts
        .iter()
        .map(|part| match part {
            Part::Kernels => kernels::measure(subjects, options, watch),
            Part::Sampling => sampling::measure(subjects, options, watch),
            Part::Features => features::measure(subjects, options, watch),
            Part::Stability => stability::measure(options, watch),
        })
        .collect();
    sections.extend(options.editing.clone().map(editing::section));
    Report {
        options: options.clone(),
        machine,
        scenes: subjects
            .iter()
            .map(|subject| subject.name.clone())
            .collect(),
        sections,
        seconds: start.elapsed().as_secs_f64(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_of_all_parts_says_what_it_found_in_three_sentences() {
        let section = |name: &str| Section {
            findings: (1..=4).map(|i| format!("{name} {i}.")).collect(),
            ..Section::default()
        };
        let report = |names: &[&str]| Report {
            options: Options {
                parts: Part::ALL.to_vec(),
                quick: true,
                seed: 0,
                command: String::new(),
                editing: None,
            },
            machine: Machine::here(),
            scenes: Vec::new(),
            sections: names.iter().map(|name| section(name)).collect(),
            seconds: 0.0,
        };
        assert_eq!(report(&["a"]).findings(), ["a 1.", "a 2.", "a 3."]);
        assert_eq!(report(&["a", "b"]).findings(), ["a 1.", "a 2.", "b 1."]);
        assert_eq!(
            report(&["a", "b", "c", "D", "e"]).findings(),
            ["a 1.", "b 1.", "c 1; d 1; e 1."]
        );
    }
}
