//! `glassbox report`: speed against error, measured on this machine.

use super::Failure;
use super::memory::MemoryArgs;
use super::output::say;
use super::progress::Progress;
use super::settings::check_scene;
use super::stage::{SceneArgs, Stage, with_threads};
use crate::io::{
    FileError, SceneSource, TEXT_BYTES, check_outputs, check_room, check_writable, read_text,
};
use crate::report::{self, Options, Part, Subject, Table, is_report_file, write_report};
use clap::Args;
use std::path::{Path, PathBuf};

/// Scenes that are measured where none is named: built-in ones that differ in what is hard about them.
const DEFAULT_SCENES: [&str; 5] = [
    "cube-segment-light",
    "cornell-box-parallelogram-light",
    "teapot",
    "knot",
    "showcase",
];

#[derive(Args)]
pub(super) struct Report {
    /// Parts: kernels, sampling, features, stability (the hard cases) or all (default: all); then
    /// scenes, files or built-in ones (default: five built-in ones). A file that is called like a part
    /// is ./NAME
    #[arg(value_name = "PART|SCENE")]
    what: Vec<PathBuf>,
    /// Folder for report.md, its tables (CSV) and its plots (SVG and PNG); or a file NAME.md
    #[arg(short, long, value_name = "DIR", default_value = "report")]
    output: PathBuf,
    /// Folder for tables and plots, where they are not to lie beside the report
    #[arg(long, value_name = "DIR")]
    files: Option<PathBuf>,
    /// Fewer rays, rounds and samples: 20 seconds to two minutes for a scene on two cores
    #[arg(long)]
    quick: bool,
    /// Chooses the random numbers
    #[arg(
        long,
        value_name = "N",
        default_value_t = 0,
        allow_negative_numbers = true
    )]
    seed: u32,
    /// Threads to render pictures on (default: all of the machine's); kernels are timed on one
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024), allow_negative_numbers = true)]
    threads: Option<u32>,
    /// Table of edit latencies for the report: `cargo bench --bench edits -- --csv FILE.csv` writes it
    #[arg(long, value_name = "FILE.csv")]
    editing: Option<PathBuf>,
    /// Let scenes refer to files outside their own folder
    #[arg(long)]
    allow_outside: bool,
    #[command(flatten)]
    memory: MemoryArgs,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
}

pub(super) fn run(args: Report) -> Result<(), Failure> {
    let (parts, scenes) = split(&args.what);
    with_threads(args.threads, || measure(&args, parts, &scenes))
}

/// What comes first are parts, the rest are scenes.
fn split(what: &[PathBuf]) -> (Vec<Part>, Vec<PathBuf>) {
    let part = |path: &PathBuf| -> Option<Vec<Part>> {
        if path == Path::new("all") {
            return Some(Part::ALL.to_vec());
        }
        let part = Part::ALL
            .into_iter()
            .find(|part| path == Path::new(part.name()));
        part.map(|part| vec![part])
    };
    let named: Vec<Vec<Part>> = what.iter().map_while(part).collect();
    let scenes = what[named.len()..].to_vec();
    let asked = |part: &Part| named.is_empty() || named.iter().flatten().any(|n| n == part);
    let parts = Part::ALL.into_iter().filter(asked).collect();
    (parts, scenes)
}

fn measure(args: &Report, parts: Vec<Part>, scenes: &[PathBuf]) -> Result<(), Failure> {
    let scenes = if scenes.is_empty() {
        DEFAULT_SCENES.map(PathBuf::from).to_vec()
    } else {
        scenes.to_vec()
    };
    let (file, folder) = places(args);
    let outputs = outputs(&file, &folder);
    if let Some(table) = &args.editing {
        check_outputs(outputs.iter().map(PathBuf::as_path), [&**table])?;
    }
    let mut subjects = scenes
        .iter()
        .map(|scene| subject(scene, args, &outputs))
        .collect::<Result<Vec<Subject>, Failure>>()?;
    Subject::tell_apart(&mut subjects);
    let editing = args.editing.as_deref().map(table).transpose()?;
    if parts.contains(&Part::Kernels) {
        report::kernels::check_embree().map_err(Failure::System)?;
    }
    check_places(&file, &folder)?;
    let options = Options {
        editing,
        parts,
        quick: args.quick,
        seed: args.seed,
        command: command(),
    };
    let progress = Progress::of_steps(args.quiet, "report");
    let report = report::run(&subjects, &options, &|what, done, all| {
        progress.show_step(what, done, all);
    });
    drop(progress);
    write_report(&report, &file, &folder)?;
    if !args.quiet {
        say(report.findings().join("\n"))?;
        for section in &report.sections {
            if let Some(table) = section.summary.and_then(|i| section.tables.get(i)) {
                say(format_args!(
                    "\n{}\n{}",
                    section.title,
                    table.plain().trim_end()
                ))?;
            }
        }
        say(format_args!(
            "\n{}: {:.0} s",
            file.display(),
            report.seconds
        ))?;
    }
    let failures: Vec<&str> = report.failures().map(String::as_str).collect();
    if failures.is_empty() {
        Ok(())
    } else {
        let failures = failures.join("; ");
        Err(Failure::Scene(format!(
            "what should hold does not: {failures}"
        )))
    }
}

fn subject(scene: &Path, args: &Report, outputs: &[PathBuf]) -> Result<Subject, Failure> {
    let source = SceneArgs {
        scene: scene.to_path_buf(),
        allow_outside: args.allow_outside,
        memory: args.memory.clone(),
    };
    let mut stage = Stage::open(&source, args.quiet)?;
    stage.check_outputs(outputs.iter().map(PathBuf::as_path))?;
    let settings = stage.settings().clone();
    check_scene(&stage.name, &settings)?;
    stage.check_film(settings.size)?;
    let world = stage.sync().world.clone();
    let camera = stage.cameras().0.first().cloned();
    let camera = camera.ok_or_else(|| {
        Failure::Scene(format!("{}: has no camera; add a SceneCamera", stage.name))
    })?;
    let name = match SceneSource::named(scene) {
        SceneSource::Builtin(scene) => scene.name.to_owned(),
        SceneSource::File(_) => stage.name.clone(),
    };
    Ok(Subject {
        name,
        world,
        camera: camera.camera,
        settings,
    })
}

/// The Markdown file, and the folder of everything else.
fn places(args: &Report) -> (PathBuf, PathBuf) {
    let is_file = args
        .output
        .extension()
        .is_some_and(|extension| extension == "md");
    let (file, beside) = if is_file {
        let folder = args.output.parent().unwrap_or(Path::new(""));
        (args.output.clone(), folder.to_path_buf())
    } else {
        (args.output.join("report.md"), args.output.clone())
    };
    (file, args.files.clone().unwrap_or(beside))
}

/// Where nothing can be written nothing needs to be measured. Folders that do not exist are made in the end,
/// so until then the nearest one that does exist stands for them.
fn check_places(file: &Path, folder: &Path) -> Result<(), Failure> {
    /// What a report of five scenes takes, and half of that again.
    const BYTES: u64 = 4 << 20;
    let home = file.parent().unwrap_or(Path::new(""));
    for folder in [home, folder] {
        let exists = |part: &&Path| part.as_os_str().is_empty() || part.exists();
        let there = folder.ancestors().find(exists).unwrap_or(Path::new(""));
        if there == home {
            check_writable(file)?;
        } else {
            check_writable(&there.join("report"))
                .map_err(|error| FileError::new(folder, error.problem))?;
        }
        check_room(&there.join("report"), BYTES)
            .map_err(|error| FileError::new(folder, error.problem))?;
    }
    Ok(())
}

/// The Markdown file, and what is there already of all that the report may replace.
fn outputs(file: &Path, folder: &Path) -> Vec<PathBuf> {
    let here = Path::new(".");
    let folder = if folder.as_os_str().is_empty() {
        here
    } else {
        folder
    };
    let there = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let own = there.filter(|entry| entry.file_name().to_str().is_some_and(is_report_file));
    own.map(|entry| entry.path())
        .chain([file.to_path_buf()])
        .collect()
}

/// A table that another program wrote.
fn table(file: &Path) -> Result<Table, Failure> {
    let text = read_text(file, TEXT_BYTES)?;
    Table::from_csv("editing", "Edits", &text)
        .map_err(|error| Failure::System(format!("{}: {error}", file.display())))
}

/// This process' own command line, as one would type it.
fn command() -> String {
    let words = std::env::args_os().skip(1);
    let words = words.map(|word| quoted(&word.to_string_lossy()));
    std::iter::once("glassbox".to_owned())
        .chain(words)
        .collect::<Vec<_>>()
        .join(" ")
}

/// As a shell takes it for one word.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./=+,:@%".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_with_spaces_and_quotes_are_one_word_to_a_shell() {
        for (word, shown) in [
            ("--files=a/b-1.5.md", "--files=a/b-1.5.md"),
            ("my room.obj", "'my room.obj'"),
            ("it's", r"'it'\''s'"),
            ("", "''"),
            ("$HOME", "'$HOME'"),
        ] {
            assert_eq!(quoted(word), shown);
        }
    }

    #[test]
    fn parts_come_first_and_everything_else_is_a_scene() {
        let split = |words: &[&str]| {
            let words: Vec<PathBuf> = words.iter().map(PathBuf::from).collect();
            let (parts, scenes) = split(&words);
            let scenes: Vec<String> = scenes.iter().map(|s| s.display().to_string()).collect();
            (parts, scenes)
        };
        assert_eq!(split(&[]), (Part::ALL.to_vec(), vec![]));
        assert_eq!(split(&["all"]), (Part::ALL.to_vec(), vec![]));
        let one = vec![Part::Kernels];
        assert_eq!(split(&["kernels", "teapot"]), (one, vec!["teapot".into()]));
        let two = vec![Part::Kernels, Part::Sampling];
        assert_eq!(split(&["sampling", "kernels"]), (two, vec![]));
        let scenes = vec!["a.obj".to_owned(), "sampling".to_owned()];
        assert_eq!(split(&["a.obj", "sampling"]), (Part::ALL.to_vec(), scenes));
    }
}
