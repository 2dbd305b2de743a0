//! `glassbox render`: a scene to picture files.

use super::Failure;
use super::output::{check_room, say, tell};
use super::progress::Progress;
use super::settings::{BuilderArg, SettingArgs, check_scene, list};
use super::shown::output_text;
use super::stage::{SceneArgs, Stage, with_threads};
use super::stats::{Stats, mrays_per_second, triangles};
use super::stop::{SampleRange, StopArgs};
use super::view::ViewArgs;
use crate::film::views::View;
use crate::film::{Ending, FirstHits, LightPictures, Status, render_lights, render_samples};
use crate::inspect::{build_time, builder_name};
use crate::io::{
    FileError, Part, PictureFormat, check_outputs, check_picture, check_writable, part_bytes,
    picture_notes, replace_file, write_lights, write_part, write_rendered,
};
use crate::sync::TracedCamera;
use crate::trace::{Crossings, RayCounts, digest, samples_per_pixel};
use clap::Args;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Args)]
#[command(after_help = list())]
pub(super) struct Render {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Picture file: .png or .jpg as a screen shows it, .exr or .hdr as linear light, before bloom,
    /// exposure and view transform; with several cameras OUT-CAMERA.png and so on
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    #[command(flatten)]
    pub settings: SettingArgs,
    #[command(flatten)]
    pub stop: StopArgs,
    #[command(flatten)]
    pub view: ViewArgs,
    /// Besides the picture write what each light adds to it, as layers of the .exr named after the lights
    #[arg(long, conflicts_with = "samples")]
    pub lights_separately: bool,
    /// Camera to render from, by its name; may be given several times (default: the first)
    #[arg(long, value_name = "NAME", conflicts_with = "all_cameras")]
    pub camera: Vec<String>,
    /// Render from every camera of the scene
    #[arg(long)]
    pub all_cameras: bool,
    /// How trees are built
    #[arg(long, value_enum)]
    pub builder: Option<BuilderArg>,
    /// Write what the rendering took to a file, as JSON
    #[arg(long, value_name = "FILE.json")]
    pub stats: Option<PathBuf>,
    /// Print nothing but errors
    #[arg(long)]
    pub quiet: bool,
}

/// A picture that ends so many seconds after its time says why: what began before is done within some milliseconds.
const LATE: f64 = 1.0;

pub(super) fn run(args: Render) -> Result<(), Failure> {
    args.settings.check()?;
    args.settings.check_said_once(&[
        ("--error", "sampling.error", args.stop.error.is_some()),
        ("--time", "sampling.time", args.stop.time.is_some()),
        (
            "--adaptive",
            "sampling.adaptive",
            args.stop.adaptive.is_some(),
        ),
        ("--builder", "tree.builder", args.builder.is_some()),
        // A part has all of its samples.
        ("--samples", "spp", args.stop.samples.is_some()),
        ("--samples", "sampling.error", args.stop.samples.is_some()),
        ("--samples", "sampling.time", args.stop.samples.is_some()),
    ])?;
    args.stop.check()?;
    let format = PictureFormat::of(&args.output).map_err(Failure::of_output)?;
    if args.stop.samples.is_some() && format != PictureFormat::Exr {
        return Err(Failure::Usage(format!(
            "{}: --samples writes parts of pictures, and they are .exr; `glassbox merge` makes others of them",
            args.output.display()
        )));
    }
    if args.stop.samples.is_some() && args.view.view != View::Shaded {
        return Err(Failure::Usage(format!(
            "--samples writes parts of shaded pictures, not of the view `{}`",
            args.view.view
        )));
    }
    let ends_early = args.stop.error.is_some() || args.stop.time.is_some();
    if ends_early && args.view.is_of_first_hits() {
        return Err(Failure::Usage(format!(
            "--error and --time end renderings: the view `{}` is made of camera rays alone, and has no samples",
            args.view.view
        )));
    }
    if args.lights_separately && args.view.view != View::Shaded {
        return Err(Failure::Usage(format!(
            "--lights-separately writes layers of a shaded picture: the view `{}` has no lights",
            args.view.view
        )));
    }
    if args.lights_separately && format != PictureFormat::Exr {
        return Err(Failure::Usage(format!(
            "{}: --lights-separately writes layers of a shaded picture, and only an .exr has layers",
            args.output.display()
        )));
    }
    args.view.check(&args.output)?;
    if let Some(file) = &args.stats {
        check_writable(file)?;
    }
    with_threads(args.settings.threads, || render_scene(&args))
}

fn render_scene(args: &Render) -> Result<(), Failure> {
    // Where nothing can be written nothing needs to be rendered.
    let outputs = || [&args.output].into_iter().chain(&args.stats);
    check_outputs(outputs().map(PathBuf::as_path), [&*args.scene.scene])?;
    check_writable(&args.output)?;
    let mut stage = Stage::open(&args.scene, args.quiet)?;
    args.settings.apply(stage.app.world_mut())?;
    let settings = stage.settings();
    args.stop.apply(settings, args.settings.give_spp());
    if let Some(builder) = args.builder {
        settings.tree.builder = builder.builder();
    }
    let settings = settings.clone();
    check_scene(&stage.name, &settings)?;
    let size = settings.size;
    let [width, height] = size.to_array().map(u64::from);
    let format = check_picture(&args.output, width, height).map_err(Failure::of_output)?;
    stage.check_film(size)?;
    let world = stage.sync().world.clone();
    if args.lights_separately {
        stage.check_film_of_lights(size, world.lights.count())?;
    }
    let cameras = chosen(&stage, args)?;
    let files = file_names(&args.output, &cameras);
    stage.check_outputs(files.iter().chain(&args.stats).map(PathBuf::as_path))?;
    for file in &files {
        check_writable(file)?;
    }
    let bytes = if args.stop.samples.is_some() {
        part_bytes(width, height)
    } else {
        // Those that each light adds, and what shines by itself.
        let layers = if args.lights_separately {
            LightPictures::planes(world.lights.count()) as u64
        } else {
            0
        };
        format.picture_bytes(width, height) * (1 + layers)
    };
    let bytes = bytes.saturating_mul(files.len() as u64);
    check_room(&args.output, bytes, args.quiet)?;

    let mut stats = Stats {
        scene: args.scene.scene.display().to_string(),
        triangles: triangles(&world),
        instances: world.objects.len() as u64,
        width: settings.size.x,
        height: settings.size.y,
        spp: 0,
        relative_error: None,
        relative_error_is_bound: false,
        threads: rayon::current_num_threads(),
        builder: builder_name(world.aggregate.options().builder),
        build_ms: build_time(&world).as_secs_f64() * 1e3,
        render_ms: 0.0,
        rays: RayCounts::default(),
        mrays_per_s: 0.0,
    };
    for (camera, file) in cameras.iter().zip(&files) {
        if args.view.is_of_first_hits() {
            let start = Instant::now();
            let hits = FirstHits::trace(&world, &camera.camera, &settings);
            let seconds = start.elapsed().as_secs_f64();
            stats.render_ms += seconds * 1e3;
            stats.rays.camera += hits.rays;
            args.view.write_first_hits(file, &hits, &settings.output)?;
            if !args.quiet {
                say(format_args!(
                    "{}: {}x{}, {}, {seconds:.2} s",
                    file.display(),
                    settings.size.x,
                    settings.size.y,
                    args.view.view,
                ))?;
            }
            continue;
        }
        if !args.quiet
            && let Some(crossings) = Crossings::many(&world, &camera.camera, &settings)
        {
            let names = stage.names();
            let name = names.get(&crossings.object.0).map(String::as_str);
            let text = crossings.text(name);
            tell("note", format_args!("{}: {text}", stage.name));
        }
        let progress = Progress::new(args.quiet, &camera.name);
        let samples = match &args.stop.samples {
            Some(SampleRange(samples)) => samples.clone(),
            None => 0..samples_per_pixel(&world, &camera.camera, &settings).into(),
        };
        let show = |status: &Status| progress.show_status(status);
        let (rendered, lights) = if args.lights_separately {
            let (rendered, lights) = render_lights(&world, &camera.camera, &settings, &show);
            (rendered, Some(lights))
        } else {
            let rendered =
                render_samples(&world, &camera.camera, &settings, samples.clone(), &show);
            (rendered, None)
        };
        drop(progress);
        if rendered.ending == Ending::Time && !args.quiet {
            let limit = f64::from(settings.sampling.time);
            if rendered.status.seconds > limit + LATE {
                let file = file.display();
                tell(
                    "note",
                    format_args!(
                        "{file}: the first sample of each pixel took {:.1} s, longer than the {limit} s asked for",
                        rendered.status.seconds
                    ),
                );
            }
        }
        // Fewer than asked for where an error or a time ended it.
        let spp = rendered.status.samples.round() as u32;
        if args.stop.samples.is_some() {
            let part = Part {
                digest: digest(&world, &camera.camera, &settings).to_string(),
                samples: vec![samples],
                uniform: true,
                output: output_text(&settings),
                film: rendered.film,
            };
            write_part(file, &part)?;
        } else if args.view.view == View::Shaded {
            let notes = picture_notes(&camera.name, &settings, &rendered.status);
            match &lights {
                Some(lights) => {
                    let names = stage.names();
                    let name = |id: u64| names.get(&id).cloned().unwrap_or(format!("light {id}"));
                    write_lights(file, &rendered.picture, lights, name, &notes)?;
                }
                None => write_rendered(file, &rendered.picture, &settings.output, &notes)?,
            }
        } else {
            args.view
                .write_rendered(file, &rendered, &settings.output)?;
        }
        if !args.quiet {
            let error = match rendered.status.error() {
                Some(error) => format!(", error {error}"),
                None => String::new(),
            };
            say(format_args!(
                "{}: {}x{}, {spp} spp, {:.2} s, {:.2} million rays/s{error}",
                file.display(),
                settings.size.x,
                settings.size.y,
                rendered.status.seconds,
                mrays_per_second(rendered.status.rays.total(), rendered.status.seconds),
            ))?;
        }
        stats.spp = stats.spp.max(spp);
        if let Some(error) = rendered.status.error()
            && stats
                .relative_error
                .is_none_or(|most| error.relative() > most)
        {
            stats.relative_error = Some(error.relative());
            stats.relative_error_is_bound = error.is_bound;
        }
        stats.render_ms += rendered.status.seconds * 1e3;
        stats.rays += rendered.status.rays;
    }
    stats.mrays_per_s = mrays_per_second(stats.rays.total(), stats.render_ms / 1e3);
    if let Some(file) = &args.stats {
        write_stats(file, &stats)?;
    }
    Ok(())
}

fn write_stats(file: &Path, stats: &Stats) -> Result<(), FileError> {
    replace_file(file, |writer| {
        serde_json::to_writer_pretty(&mut *writer, stats)?;
        writeln!(writer)
    })
}

/// The cameras that the command line asks for.
fn chosen(stage: &Stage, args: &Render) -> Result<Vec<TracedCamera>, Failure> {
    if args.all_cameras && !stage.cameras().0.is_empty() {
        return Ok(stage.cameras().0.clone());
    }
    if args.camera.is_empty() {
        return Ok(vec![stage.camera(None)?]);
    }
    let names = args.camera.iter();
    names.map(|name| stage.camera(Some(name))).collect()
}

/// One camera writes the file itself, several write `out-NAME.png`. Names are made fit for files;
/// where two become the same, the later ones carry their number too.
fn file_names(output: &Path, cameras: &[TracedCamera]) -> Vec<PathBuf> {
    if cameras.len() == 1 {
        return vec![output.to_path_buf()];
    }
    let part = |part: Option<&std::ffi::OsStr>| {
        part.map_or_else(String::new, |part| part.to_string_lossy().into_owned())
    };
    let (stem, extension) = (part(output.file_stem()), part(output.extension()));
    let mut files: Vec<PathBuf> = Vec::with_capacity(cameras.len());
    for camera in cameras {
        let name: String = camera
            .name
            .chars()
            .map(|c| {
                if c.is_alphanumeric() || "-_.".contains(c) {
                    c
                } else {
                    '_'
                }
            })
            .collect();
        let mut file = output.with_file_name(format!("{stem}-{name}.{extension}"));
        if files.contains(&file) {
            let id = camera.id.0;
            file = output.with_file_name(format!("{stem}-{name}-{id}.{extension}"));
        }
        files.push(file);
    }
    files
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SceneId;
    use crate::trace::Camera;
    use bevy::math::Vec3;

    fn camera(id: u64, name: &str) -> TracedCamera {
        TracedCamera {
            id: SceneId(id),
            name: name.into(),
            camera: Camera::looking_at(Vec3::Z, Vec3::ZERO, Vec3::Y, 1.0),
        }
    }

    #[test]
    fn several_cameras_write_files_of_their_own_in_the_same_folder() {
        let cameras = [camera(1, "front"), camera(2, "a/b c"), camera(3, "front")];
        let files = file_names(Path::new("dir/out.png"), &cameras);
        let files: Vec<&str> = files.iter().map(|file| file.to_str().unwrap()).collect();
        assert_eq!(
            files,
            [
                "dir/out-front.png",
                "dir/out-a_b_c.png",
                "dir/out-front-3.png"
            ]
        );
        assert_eq!(
            file_names(Path::new("out.png"), &cameras[..1]),
            [PathBuf::from("out.png")]
        );
    }
}
