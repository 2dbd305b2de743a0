//! `glassbox inspect`: why a pixel has its colour, as text, JSON or lines over a picture.

use super::Failure;
use super::gizmos::{Gizmos, PresetArg, gizmo_list};
use super::output::{check_room, say, tell};
use super::progress::Progress;
use super::set::{Assignment, parse_size};
use super::settings::{BuilderArg, SettingArgs, check_scene};
use super::stage::{SceneArgs, Stage, with_threads};
use crate::film::{FirstHits, develop, render};
use crate::inspect::{
    Document, InspectSettings, LineSet, MOST_POINTS, Overlay, Pattern, RayLine, StepKind, Subject,
    Traversal, aligned, counted, draw_over, draw_pattern, explanation, lines, pattern, sources,
};
use crate::io::{PictureFormat, check_picture, check_writable, write_picture};
use crate::scene::RenderSettings;
use crate::sync::TracedCamera;
use crate::trace::{Camera, RayTree, Samples, World, probe};
use bevy::math::{UVec2, Vec3};
use clap::Args;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::str::FromStr;

#[derive(Args)]
#[command(after_help = gizmo_list())]
pub(super) struct Inspect {
    #[command(flatten)]
    scene: SceneArgs,
    /// Pixel whose samples are evaluated again, with every ray; 0,0 is the top left one
    #[arg(long, value_name = "X,Y", value_parser = parse_pixel, allow_hyphen_values = true)]
    pixel: Option<UVec2>,
    /// Which of the pixel's samples: a number from 0, or all
    #[arg(
        long,
        value_name = "N|all",
        default_value = "all",
        requires = "pixel",
        allow_negative_numbers = true
    )]
    sample: SampleArg,
    /// Print all that is known as JSON: samples, rays, lights, lines
    #[arg(long)]
    json: bool,
    /// Write the picture with lines drawn over it: .png or .jpg
    #[arg(long, value_name = "OUT.png")]
    picture: Option<PathBuf>,
    /// Print this ray's way through the trees, step by step with the stack (with --json: add it)
    #[arg(long, value_name = "RAY", requires = "pixel")]
    steps: Option<u32>,
    /// Ready-made choice of what is drawn
    #[arg(long, value_enum)]
    preset: Option<PresetArg>,
    /// What is drawn, one setting of the list below; may be given several times
    #[arg(long, value_name = "KEY=VALUE")]
    gizmo: Vec<Assignment>,
    /// Camera to look through, by its name (default: the first)
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,
    /// Draw the picture from here instead of from the camera, to see its rays from the side
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, requires = "target", allow_hyphen_values = true)]
    eye: Option<Vec3>,
    /// With --eye: where to look
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, requires = "eye", allow_hyphen_values = true)]
    target: Option<Vec3>,
    /// How trees are built
    #[arg(long, value_enum)]
    builder: Option<BuilderArg>,
    #[command(flatten)]
    settings: SettingArgs,
    /// Print nothing but errors, and what was asked for
    #[arg(long)]
    quiet: bool,
}

/// `3` or `all`.
#[derive(Clone, Debug)]
struct SampleArg(Samples);

impl FromStr for SampleArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "all" => Ok(Self(Samples::All)),
            _ => text
                .parse()
                .map(|index| Self(Samples::One(index)))
                .map_err(|_| "a sample's number, counted from 0, or `all`".into()),
        }
    }
}

fn parse_pixel(text: &str) -> Result<UVec2, String> {
    parse_size(text).map_err(|_| "column,row of a pixel, for example 400,300".into())
}

fn parse_point(text: &str) -> Result<Vec3, String> {
    let numbers: Option<Vec<f32>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) if [x, y, z].iter().all(|n| n.is_finite()) => Ok(Vec3::new(x, y, z)),
        _ => Err("three numbers, for example 0,1.5,4".into()),
    }
}

pub(super) fn run(args: Inspect) -> Result<(), Failure> {
    args.settings.check()?;
    (args.settings).check_said_once(&[("--builder", "tree.builder", args.builder.is_some())])?;
    let gizmos = Gizmos::new(args.preset, &args.gizmo)?;
    if args.pixel.is_none() && args.picture.is_none() {
        return Err(Failure::Usage(
            "nothing is asked for: give --pixel X,Y or --picture OUT.png".into(),
        ));
    }
    let chooses_lines = args.preset.is_some() || !args.gizmo.is_empty();
    if chooses_lines && args.picture.is_none() && !args.json {
        return Err(Failure::Usage(
            "--preset and --gizmo choose lines: give --picture OUT.png or --json, which show them"
                .into(),
        ));
    }
    if args.eye.is_some() && args.picture.is_none() {
        return Err(Failure::Usage(
            "--eye is where the picture is drawn from: give --picture OUT.png".into(),
        ));
    }
    if let Some(file) = &args.picture {
        let format = PictureFormat::of(file).map_err(Failure::of_output)?;
        if format.is_linear() {
            return Err(Failure::Usage(format!(
                "{}: lines are drawn for screens: write a .png or .jpg",
                file.display()
            )));
        }
        check_writable(file)?;
    }
    with_threads(args.settings.threads, || inspect(&args, &gizmos.0))
}

fn inspect(args: &Inspect, gizmos: &InspectSettings) -> Result<(), Failure> {
    let mut stage = Stage::open(&args.scene, args.quiet || args.json)?;
    stage.check_outputs(args.picture.as_deref())?;
    args.settings.apply(stage.app.world_mut())?;
    let settings = stage.settings();
    if let Some(builder) = args.builder {
        settings.tree.builder = builder.builder();
    }
    let settings = settings.clone();
    check_scene(&stage.name, &settings)?;
    if let Some(file) = &args.picture {
        let [width, height] = settings.size.to_array().map(u64::from);
        let format = check_picture(file, width, height).map_err(Failure::of_output)?;
        check_room(file, format.picture_bytes(width, height), args.quiet)?;
        stage.check_film(settings.size)?;
    }
    let world = stage.sync().world.clone();
    let names = stage.names();
    let camera = stage.camera(args.camera.as_deref())?;
    let usage = |error: crate::trace::ProbeError| {
        Failure::Usage(format!("{}: {error}", args.scene.scene.display()))
    };
    let rays = match args.pixel {
        None => None,
        Some(pixel) => {
            let tree = probe(&world, &camera.camera, &settings, pixel, &args.sample.0);
            Some(tree.map_err(usage)?)
        }
    };
    let picked = Picked {
        world: &world,
        camera: &camera,
        settings: &settings,
        names: &names,
        rays: rays.as_ref(),
    };
    let traversal = picked.traversal(args.steps)?;
    let eye = args.eye.zip(args.target);
    let watching = eye.map(|(eye, target)| watching(&camera.camera, eye, target));
    let subject = Subject::new(&world, &camera.camera, &settings, gizmos, rays.as_ref());
    let subject = match &watching {
        Some(watching) => subject.seen_by(watching),
        None => subject,
    };
    let sets = lines(&subject);
    let pattern = picked.pattern(gizmos);
    if let Some(file) = &args.picture {
        draw(
            file,
            &subject,
            &sets,
            pattern.as_ref(),
            args.quiet || args.json,
        )?;
    }
    if args.json {
        let empty = RayTree::default();
        let scene = args.scene.scene.display().to_string();
        let rays = picked.rays.unwrap_or(&empty);
        let document = Document {
            lines: &sets,
            pattern: pattern.as_ref(),
            traversal: traversal.as_ref(),
            ..Document::new((&scene, &camera.name), &world, &settings, rays, &names)
        };
        let text =
            serde_json::to_string(&document).map_err(|error| Failure::System(error.to_string()))?;
        return say(text);
    }
    if !args.quiet {
        tell_of_lines(&sets);
        match &pattern {
            Some(pattern) => {
                if let Some(thinned) = pattern.thinned {
                    tell("note", thinned);
                }
            }
            None if gizmos.on && gizmos.pattern.on => {
                tell("note", "Pattern: no pixel was picked");
            }
            None => {}
        }
    }
    match traversal {
        Some(traversal) => say(steps_text(&traversal).trim_end()),
        None => picked.print(),
    }
}

/// A pixel that was picked, and what it is part of.
struct Picked<'a> {
    world: &'a World,
    camera: &'a TracedCamera,
    settings: &'a RenderSettings,
    names: &'a BTreeMap<u64, String>,
    rays: Option<&'a RayTree>,
}

impl Picked<'_> {
    fn traversal(&self, ray: Option<u32>) -> Result<Option<Traversal>, Failure> {
        let (Some(index), Some(rays)) = (ray, self.rays) else {
            return Ok(None);
        };
        if index as usize >= rays.rays.len() {
            return Err(Failure::Usage(format!(
                "--steps {index}: there is no such ray; there are {}, counted from 0",
                rays.rays.len()
            )));
        }
        Ok(Some(Traversal::of(self.world, self.settings, rays, index)))
    }

    fn pattern(&self, gizmos: &InspectSettings) -> Option<Pattern> {
        let choice = &gizmos.pattern;
        if !(gizmos.on && choice.on) {
            return None;
        }
        let pixel = self.rays?.pixel;
        let count = crate::trace::samples_per_pixel(self.world, &self.camera.camera, self.settings);
        Some(pattern(
            self.world,
            self.settings,
            choice,
            pixel,
            count.into(),
            MOST_POINTS,
        ))
    }

    /// What the pixel is made of, and the rays of its first sample.
    fn print(&self) -> Result<(), Failure> {
        let Some(rays) = self.rays else { return Ok(()) };
        let value = rays.mean();
        say(format_args!(
            "pixel {},{} of `{}`: {:.5} {:.5} {:.5}, the mean of {}",
            rays.pixel.x,
            rays.pixel.y,
            self.camera.name,
            value.x,
            value.y,
            value.z,
            counted(rays.samples.len() as u64, "sample")
        ))?;
        for sentence in explanation(rays, self.names) {
            say(format_args!("  {sentence}"))?;
        }
        let mut rows =
            vec![["from", "mean r", "g", "b", "deviation", "share of variance"].map(String::from)];
        rows.extend(sources(rays).iter().map(|source| {
            let [r, g, b] = source
                .mean
                .to_array()
                .map(|channel| format!("{channel:.5}"));
            [
                source.cause.name(self.names),
                r,
                g,
                b,
                format!("{:.5}", source.deviation),
                format!("{:.1} %", 100.0 * source.share),
            ]
        }));
        let rows: Vec<Vec<String>> = rows.into_iter().map(Vec::from).collect();
        say(format_args!("\n{}", aligned(&rows)))?;
        let mut samples = rays.sums().into_iter().zip(&rays.samples);
        let equal = samples.all(|(sum, sample)| sum == sample.value);
        let first = rays.samples.first().map_or(0, |sample| sample.index);
        say(format_args!(
            "rays of sample {first} (for every sample, what its rays add sums to its value, bit for \
             bit: {}; node and triangle counts are those of the walk that traces pictures):",
            if equal { "yes" } else { "NO" },
        ))?;
        let mut rows = vec![RayLine::HEADER.map(String::from).to_vec()];
        rows.extend(
            RayLine::of(rays, 0, self.names)
                .into_iter()
                .map(|line| line.cells.to_vec()),
        );
        say(aligned(&rows).trim_end())
    }
}

/// What was left out of lines, and why there are none.
fn tell_of_lines(sets: &[LineSet]) {
    for set in sets {
        for text in set.says() {
            tell("note", format_args!("{:?}: {text}", set.system));
        }
    }
}

/// A pinhole with the camera's field of view, somewhere else.
fn watching(camera: &Camera, eye: Vec3, target: Vec3) -> Camera {
    Camera {
        projection: camera.projection,
        ..Camera::looking_at(eye, target, Vec3::Y, 1.0)
    }
}

fn draw(
    file: &Path,
    subject: &Subject,
    sets: &[LineSet],
    pattern: Option<&Pattern>,
    quiet: bool,
) -> Result<(), Failure> {
    let Subject {
        world,
        camera,
        settings,
        ..
    } = *subject;
    let progress = Progress::new(quiet, "picture");
    let rendered = render(world, camera, settings, &|done, all| {
        progress.show(done, all)
    });
    drop(progress);
    let mut pixels = develop(&rendered.picture, &settings.output);
    let hits = FirstHits::trace(
        world,
        camera,
        &RenderSettings {
            spp: 1,
            jitter: 1,
            ..settings.clone()
        },
    );
    let depths: Vec<f32> = hits.centers.iter().map(|hit| hit.depth).collect();
    let mut overlay = Overlay {
        camera,
        size: settings.size,
        depths: &depths,
        pixels: &mut pixels,
    };
    draw_over(&mut overlay, sets);
    if let Some(pattern) = pattern {
        draw_pattern(&mut pixels, settings.size, pattern);
    }
    write_picture(file, settings.size.x, settings.size.y, &pixels)?;
    Ok(())
}

fn steps_text(traversal: &Traversal) -> String {
    let node = |(instance, node): (Option<u32>, u32)| match instance {
        None => format!("top:{node}"),
        Some(instance) => format!("{instance}:{node}"),
    };
    let mut rows = vec![
        ["step", "what", "node", "t", "stack (next last)"]
            .map(String::from)
            .to_vec(),
    ];
    for (i, step) in traversal.steps.iter().enumerate() {
        let what = match step.triangle {
            Some([_, triangle]) => format!("{} triangle {triangle}", step.kind.name()),
            None => step.kind.name().into(),
        };
        let stack: Vec<String> = traversal.stack_after(i).iter().map(|&e| node(e)).collect();
        rows.push(vec![
            i.to_string(),
            what,
            node((step.instance, step.node)),
            step.t.map_or_else(String::new, |t| format!("{t:.4}")),
            stack.join(" "),
        ]);
    }
    let count = |kind: StepKind| {
        let of_kind = traversal.steps.iter().filter(|s| s.kind == kind);
        of_kind.count() as u64
    };
    format!(
        "{}{} entered, {} missed, {} pruned, {} tested; \
         the walk that traces pictures, through the trees' wide form\n",
        aligned(&rows),
        counted(count(StepKind::Entered), "node"),
        counted(count(StepKind::Missed), "box"),
        count(StepKind::Pruned),
        counted(count(StepKind::Hit) + count(StepKind::NotHit), "triangle"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_pixels_and_points_are_read_and_others_refused() {
        assert_eq!("all".parse::<SampleArg>().map(|s| s.0), Ok(Samples::All));
        assert_eq!("7".parse::<SampleArg>().map(|s| s.0), Ok(Samples::One(7)));
        assert!("-1".parse::<SampleArg>().is_err());
        assert_eq!(parse_pixel("3,4"), Ok(UVec2::new(3, 4)));
        assert!(parse_pixel("3").is_err());
        assert_eq!(parse_point("1, -2,3.5"), Ok(Vec3::new(1.0, -2.0, 3.5)));
        for text in ["1,2", "1,2,3,4", "1,2,nan", "a,b,c"] {
            assert!(parse_point(text).is_err(), "{text}");
        }
    }
}
