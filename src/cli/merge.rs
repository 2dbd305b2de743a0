//! `glassbox merge`: parts of a picture to a picture, or another mix of its lights.

use super::Failure;
use super::memory::MemoryArgs;
use super::mix::{self, Gain};
use super::output::{check_room, say, tell};
use super::shown::read_output;
use crate::io::{
    self, Limits, PictureFormat, check_outputs, check_picture, check_writable, film_bytes,
    part_bytes, read_part, write_part, write_rendered,
};
use crate::scene::Output;
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct Merge {
    /// Parts that `glassbox render --samples A..B` wrote; with --gain one picture that `--lights-separately` wrote
    #[arg(required = true, value_name = "PART.exr")]
    pub parts: Vec<PathBuf>,
    /// Picture file; an .exr is a part again, with the samples of all
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Multiply a light, by its name, as often as there are lights; `Own` is what shines by itself
    #[arg(long, value_name = "LIGHT=FACTOR")]
    pub gain: Vec<Gain>,
    #[command(flatten)]
    pub memory: MemoryArgs,
    /// Print nothing but errors
    #[arg(long)]
    pub quiet: bool,
}

pub(super) fn run(args: Merge) -> Result<(), Failure> {
    let format = PictureFormat::of(&args.output).map_err(Failure::of_output)?;
    check_outputs([&*args.output], args.parts.iter().map(PathBuf::as_path))?;
    check_writable(&args.output)?;
    if !args.gain.is_empty() {
        return mix::run(&args, format);
    }
    let mut merge = io::Merge::default();
    let mut output: Option<Output> = None;
    // Those that were to be shown in another way.
    let mut others = Vec::new();
    for file in &args.parts {
        let limits = Limits {
            // Beside what the parts before it have become.
            memory: (args.memory.budget()).holding(merge.size().map_or(0, film_bytes)),
            ..Limits::default()
        };
        let part = read_part(file, &limits)?;
        let size = part.film.size();
        let [width, height] = size.to_array().map(u64::from);
        check_picture(&args.output, width, height).map_err(Failure::of_output)?;
        let shown = read_output(file, &part.output)?;
        match &output {
            None => {
                let bytes = match format {
                    PictureFormat::Exr => part_bytes(width, height),
                    _ => format.picture_bytes(width, height),
                };
                check_room(&args.output, bytes, args.quiet)?;
                output = Some(shown);
            }
            Some(first) if *first != shown => others.push(file.display().to_string()),
            Some(_) => {}
        }
        merge.add(file, part)?;
    }
    let part = merge.finish()?;
    if format == PictureFormat::Exr {
        write_part(&args.output, &part)?;
    } else {
        let output = output.unwrap_or_default();
        write_rendered(&args.output, &part.film.picture(), &output, &[])?;
    }
    if args.quiet {
        return Ok(());
    }
    if let (Some(other), Some(first)) = (others.first(), args.parts.first()) {
        let more = match others.len() - 1 {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        tell(
            "note",
            format_args!(
                "{other}{more}: rendered with other settings of exposure or view transform; the picture has those of {}",
                first.display()
            ),
        );
    }
    for pair in part.samples.windows(2) {
        if let [before, after] = pair {
            let (start, end) = (before.end, after.start);
            tell(
                "note",
                format_args!("samples {start}..{end} are in none of the parts"),
            );
        }
    }
    let ranges: Vec<String> = part
        .samples
        .iter()
        .map(|range| format!("{}..{}", range.start, range.end))
        .collect();
    let (size, file) = (part.film.size(), args.output.display());
    say(format_args!(
        "{file}: {}x{}, samples {}",
        size.x,
        size.y,
        ranges.join(" and ")
    ))
}
