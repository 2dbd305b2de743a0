//! A report as files: Markdown, CSV, and plots and pictures that the Markdown shows.

use super::{Report, Section};
use crate::io::{FileError, Folder, Staged, stage_picture};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

/// Writes the report as Markdown into `file`, and what that shows and refers to into a folder, which is made where it
/// does not exist. All of it is complete on the disk before any of it takes its place, the Markdown last: where
/// that fails the old report is whole.
pub fn write_report(report: &Report, file: &Path, folder: &Path) -> Result<(), FileError> {
    for folder in file.parent().into_iter().chain([folder]) {
        std::fs::create_dir_all(folder).map_err(|error| FileError::writing(folder, &error))?;
    }
    let mut staged = Vec::new();
    for section in &report.sections {
        for table in &section.tables {
            let file = folder.join(format!("{}.csv", table.file));
            staged.push(stage_text(&file, &table.csv())?);
        }
        for plot in &section.plots {
            let file = folder.join(format!("{}.svg", plot.file));
            staged.push(stage_text(&file, &plot.svg())?);
            let file = folder.join(format!("{}.png", plot.file));
            let shown = plot.raster();
            let picture = stage_picture(&file, shown.width, shown.height, &shown.pixels)?;
            staged.push(picture);
        }
        for (name, _, shown) in &section.pictures {
            let file = folder.join(format!("{name}.png"));
            let picture = stage_picture(&file, shown.width, shown.height, &shown.pixels)?;
            staged.push(picture);
        }
    }
    staged.push(stage_text(file, &markdown(report, &way(file, folder)))?);
    staged.into_iter().try_for_each(Staged::commit)
}

/// What the names of a report's tables, plots and pictures are, or begin with before a dash.
const FILES: [&str; 10] = [
    "kernels",
    "arrangements",
    "leaks",
    "builders",
    "sampling",
    "slopes",
    "features",
    "trees",
    "stability",
    "editing",
];

/// Whether a report may write a file of this name beside its Markdown.
pub fn is_report_file(name: &str) -> bool {
    let Some((stem, "csv" | "svg" | "png")) = name.rsplit_once('.') else {
        return false;
    };
    let first = stem.split('-').next();
    first.is_some_and(|first| FILES.contains(&first))
}

/// What comes before a file's name in a link from the report to the folder.
fn way(file: &Path, folder: &Path) -> String {
    match Folder::of(file, true).name_of(folder) {
        here if here.is_empty() => here,
        // A space would end the link.
        there => format!("{}/", there.replace(' ', "%20")),
    }
}

fn stage_text(file: &Path, text: &str) -> Result<Staged, FileError> {
    Staged::new(file, |writer| writer.write_all(text.as_bytes()))
}

/// The whole report as Markdown; `way` leads to its tables, plots and pictures.
fn markdown(report: &Report, way: &str) -> String {
    let mut text = String::from("# Speed against error\n\n");
    text += &report.findings().join("\n");
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "\n\n`{}` made this report in {:.0} s on {}.\nSeed {}; scenes: {}. Times are medians of rounds in which everything \
         that is compared takes turns.",
        report.options.command,
        report.seconds,
        report.machine,
        report.options.seed,
        report.scenes.join(", "),
    );
    let failures: Vec<&String> = report.failures().collect();
    if !failures.is_empty() {
        text += "\n**What should hold and does not:**\n\n";
        for failure in failures {
            let _ = writeln!(text, "- {failure}");
        }
    }
    for section in &report.sections {
        text += &section_text(section, way);
    }
    text
}

fn section_text(section: &Section, way: &str) -> String {
    let mut text = format!("\n## {}\n\n", section.title);
    text += &section.findings.join("\n");
    text.push('\n');
    for paragraph in &section.method {
        let _ = write!(text, "\n{paragraph}\n");
    }
    for plot in &section.plots {
        let _ = write!(text, "\n![{}]({way}{}.svg)\n", plot.title, plot.file);
    }
    for (name, caption, _) in &section.pictures {
        let _ = write!(text, "\n![{caption}]({way}{name}.png)\n\n{caption}\n");
    }
    for table in &section.tables {
        let _ = write!(
            text,
            "\n### {}\n\n[{}.csv]({way}{}.csv)\n\n{}",
            table.title,
            table.file,
            table.file,
            table.markdown()
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::{Axis, Marker, Options, Part, Plot, Series, Table};
    use super::*;

    #[test]
    fn links_lead_from_the_report_to_its_files_wherever_they_lie() {
        for (file, folder, shown) in [
            ("R.md", "assets/report", "assets/report/"),
            ("out/R.md", "out", ""),
            ("docs/R.md", "assets/r", "../assets/r/"),
            ("/a/R.md", "/b/my files", "../b/my%20files/"),
        ] {
            assert_eq!(way(Path::new(file), Path::new(folder)), shown);
        }
    }

    #[test]
    fn every_file_that_the_report_refers_to_is_there() {
        let mut table = Table::new("speeds", "Speeds", &["kernel", "Mray/s"]);
        table.push(["ours".into(), 3.5.into()]);
        let series = Series::new("ours", vec![(1.0, 1e-7), (3.5, 1e-3)]).marked(Marker::Circle);
        let plot = Plot {
            file: "front".into(),
            title: "Speed against error".into(),
            x: Axis::linear("Mray/s"),
            y: Axis::logarithmic("relative error"),
            series: vec![series],
        };
        let report = Report {
            options: Options {
                parts: vec![Part::Kernels],
                quick: true,
                seed: 7,
                command: "glassbox report kernels".into(),
                editing: None,
            },
            machine: super::super::Machine::here(),
            scenes: vec!["teapot".into()],
            sections: vec![Section {
                title: "Kernels".into(),
                findings: vec!["Ours is fast.".into()],
                tables: vec![table],
                plots: vec![plot],
                failures: vec!["something".into()],
                ..Section::default()
            }],
            seconds: 1.0,
        };
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().join("new");
        let file = folder.join("REPORT.md");
        write_report(&report, &file, &folder.join("assets/report")).unwrap();
        let text = std::fs::read_to_string(file).unwrap();
        for part in [
            "Ours is fast.",
            "Seed 7",
            "glassbox report kernels",
            "- something",
            "rustc",
        ] {
            assert!(text.contains(part), "`{part}` is not in:\n{text}");
        }
        let links: Vec<&str> = text
            .split("](")
            .skip(1)
            .filter_map(|rest| rest.split(')').next())
            .collect();
        assert_eq!(
            links,
            ["assets/report/front.svg", "assets/report/speeds.csv"]
        );
        for link in links.into_iter().chain(["assets/report/front.png"]) {
            let size = std::fs::metadata(folder.join(link)).unwrap().len();
            assert!(size > 10, "{link} has {size} bytes");
        }
    }
}
