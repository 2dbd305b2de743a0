//! Parts of pictures, by the program as people run it.

use crate::cli::{PROGRAM, files, glassbox, succeeds, texts, without_display};
use exr::prelude::{
    AnyChannel, Blocks, Compression, Encoding, FlatSamples, LineOrder, ReadChannels, ReadLayers,
    Vec2, WritableImage, read,
};
use glassbox::io::{Budget, Limits, read_part, write_part};
use std::path::Path;
use std::process::Command;

const SCENE: &str = "cornell-box-parallelogram-light";

fn part(folder: &Path, samples: &str, file: &str) {
    let what = ["render", SCENE, "--size", "48x36", "--quiet"];
    let how = ["--samples", samples, "-o", file];
    succeeds(folder, &[&what[..], &how].concat());
}

fn pixels(folder: &Path, file: &str) -> image::RgbImage {
    image::open(folder.join(file)).unwrap().into_rgb8()
}

fn bytes(folder: &Path, file: &str) -> Vec<u8> {
    std::fs::read(folder.join(file)).unwrap()
}

#[test]
fn parts_merge_into_what_one_run_renders_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    part(folder, "0..5", "a.exr");
    part(folder, "5..12", "b.exr");
    part(folder, "12..16", "c.exr");
    part(folder, "0..16", "whole.exr");
    succeeds(folder, &["merge", "c.exr", "a.exr", "-o", "ca.exr"]);
    let said = succeeds(folder, &["merge", "ca.exr", "b.exr", "-o", "merged.exr"]);
    assert!(said.contains("samples 0..16"), "{said}");
    assert!(bytes(folder, "merged.exr") == bytes(folder, "whole.exr"));
    succeeds(
        folder,
        &["merge", "a.exr", "b.exr", "c.exr", "-o", "merged.png"],
    );
    let what = ["render", SCENE, "--size", "48x36", "--spp", "16"];
    succeeds(folder, &[&what[..], &["-o", "whole.png"]].concat());
    assert!(pixels(folder, "merged.png") == pixels(folder, "whole.png"));
    // Every program that reads OpenEXR sees the mean.
    let linear = image::open(folder.join("merged.exr"))
        .unwrap()
        .into_rgb32f();
    succeeds(folder, &[&what[..], &["-o", "plain.exr"]].concat());
    let plain = image::open(folder.join("plain.exr")).unwrap().into_rgb32f();
    assert!(linear == plain);
}

#[test]
fn a_part_shows_as_its_scene_was_to_be_shown() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let what = ["render", SCENE, "--size", "24x18", "--quiet"];
    let shown = [
        "--set",
        "output.exposure=1.5",
        "--set",
        "output.view_transform=AgX",
        "--set",
        "output.bloom.intensity=0.5",
    ];
    let run = |more: &[&str]| succeeds(folder, &[&what[..], &shown, more].concat());
    run(&["--samples", "0..4", "-o", "part.exr"]);
    run(&["--spp", "4", "-o", "whole.png"]);
    succeeds(folder, &["merge", "part.exr", "-o", "merged.png"]);
    assert!(pixels(folder, "merged.png") == pixels(folder, "whole.png"));
    // One that was to be shown in another way has the same samples: which way is taken is said.
    succeeds(
        folder,
        &[&what[..], &["--samples", "4..8", "-o", "other.exr"]].concat(),
    );
    let merged = glassbox(
        folder,
        &["merge", "part.exr", "other.exr", "-o", "both.png"],
    );
    let (_, said) = texts(&merged);
    assert!(merged.status.success(), "{said}");
    assert!(
        said.contains("other.exr") && said.contains("those of part.exr"),
        "{said}"
    );
    let merged = glassbox(folder, &["merge", "part.exr", "part.exr", "-o", "both.png"]);
    assert!(!texts(&merged).1.contains("those of"));
}

#[test]
fn what_does_not_belong_together_is_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    part(folder, "0..2", "a.exr");
    part(folder, "1..3", "overlapping.exr");
    let what = [
        "render",
        SCENE,
        "--size",
        "48x36",
        "--quiet",
        "--samples",
        "2..4",
        "-o",
    ];
    succeeds(folder, &[&what[..], &["seed.exr", "--seed", "7"]].concat());
    let size = [
        "render",
        SCENE,
        "--size",
        "36x48",
        "--quiet",
        "--samples",
        "2..4",
    ];
    succeeds(folder, &[&size[..], &["-o", "size.exr"]].concat());
    let other = [
        "render",
        "cornell-box",
        "--size",
        "48x36",
        "--quiet",
        "--samples",
        "2..4",
    ];
    succeeds(folder, &[&other[..], &["-o", "other.exr"]].concat());
    let plain = [
        "render",
        SCENE,
        "--size",
        "48x36",
        "--quiet",
        "--spp",
        "2",
        "-o",
        "plain.exr",
    ];
    succeeds(folder, &plain);
    std::fs::write(folder.join("text.exr"), "no picture").unwrap();
    let before = files(folder);
    for (file, said) in [
        ("overlapping.exr", "samples 1..2"),
        ("seed.exr", "another scene, camera or settings"),
        ("size.exr", "another scene, camera or settings"),
        ("other.exr", "another scene, camera or settings"),
        ("plain.exr", "no part"),
        ("text.exr", "no part"),
        ("none.exr", "no such file"),
    ] {
        let output = glassbox(folder, &["merge", "a.exr", file, "-o", "out.exr"]);
        let (_, err) = texts(&output);
        assert_eq!(output.status.code(), Some(1), "{file}: {err}");
        assert!(
            err.starts_with(&format!("error: {file}: ")) && err.contains(said),
            "{err}"
        );
        assert_eq!(err.lines().count(), 1, "{err}");
        assert_eq!(files(folder), before, "{file}");
    }
}

#[test]
fn stop_rules_that_make_no_sense_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, said) in [
        (&["--error", "0"][..], "--error is 0, and must be above 0"),
        (&["--error", "-0.1"], "--error is -0.1"),
        (&["--error", "NaN"], "--error is NaN"),
        (&["--time", "0"], "--time is 0, and must be above 0"),
        (&["--time", "inf"], "--time is inf"),
        (&["--adaptive", "maybe"], "on or off"),
        (&["--set", "sampling.error=NaN"], "sampling.error is NaN"),
        (&["--samples", "8..4"], "4..8"),
        (&["--samples", "4..4"], "no sample"),
        (&["--samples", "4"], "0..64"),
        (&["--samples", "0..4"], ".exr"),
        (&["--samples", "0..4", "--spp", "4"], "cannot be used with"),
        (
            &["--samples", "0..4", "--error", "0.1"],
            "cannot be used with",
        ),
    ] {
        let what = ["render", "triangle", "-o", "a.png"];
        let output = glassbox(folder.path(), &[&what[..], arguments].concat());
        let (_, err) = texts(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {err}");
        assert!(
            err.contains(said) && err.lines().count() == 1,
            "{arguments:?}: {err}"
        );
        assert_eq!(files(folder.path()), [""; 0], "{arguments:?}");
    }
}

#[test]
fn a_render_ends_at_the_first_of_error_time_and_samples() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let spp = |arguments: &[&str]| {
        let what = [
            "render", SCENE, "--size", "48x36", "-o", "a.png", "--stats", "a.json",
        ];
        succeeds(folder, &[&what[..], arguments].concat());
        let stats: serde_json::Value = serde_json::from_slice(&bytes(folder, "a.json")).unwrap();
        (
            stats["spp"].as_u64().unwrap(),
            stats["relative_error"].as_f64().unwrap(),
        )
    };
    let (samples, error) = spp(&["--error", "0.05"]);
    assert!(
        error <= 0.05 && (16..4096).contains(&samples),
        "{samples} spp, error {error}"
    );
    assert_eq!(spp(&["--error", "0.001", "--spp", "32"]).0, 32);
    let (samples, _) = spp(&["--time", "0.2"]);
    assert!((1..65_536).contains(&samples), "{samples} spp");
    assert_eq!(spp(&["--time", "1000", "--spp", "20"]).0, 20);
}

#[test]
fn the_recipe_for_gnu_parallel_gives_what_one_run_gives() {
    let found = Command::new("parallel").arg("--version").output();
    if !found
        .is_ok_and(|output| String::from_utf8_lossy(&output.stdout).starts_with("GNU parallel"))
    {
        println!("SKIPPED: GNU parallel is not installed (Debian package `parallel`)");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    // As in README.md, with two of four jobs at a time and a small picture.
    let recipe = format!(
        "parallel -j2 '{PROGRAM} render {SCENE} --size 48x36 --quiet --threads 1 \
         --samples {{}}..$(({{}} + 4)) -o part-{{}}.exr' ::: 0 4 8 12"
    );
    let status = without_display("sh", folder.path())
        .args(["-c", &recipe])
        .status()
        .unwrap();
    assert!(status.success(), "{recipe}: {status}");
    let parts = files(folder.path());
    assert_eq!(
        parts,
        ["part-0.exr", "part-12.exr", "part-4.exr", "part-8.exr"]
    );
    let mut merge = vec!["merge", "-o", "merged.exr"];
    merge.extend(parts.iter().map(String::as_str));
    succeeds(folder.path(), &merge);
    part(folder.path(), "0..16", "whole.exr");
    assert!(bytes(folder.path(), "merged.exr") == bytes(folder.path(), "whole.exr"));
}

/// The part with a thousand channels more than it should have, all zeros, in blocks of this kind.
fn swollen(part: &Path, blocks: Blocks, to: &Path) {
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(part);
    let mut image = image.unwrap();
    let layer = &mut image.layer_data;
    let pixels = layer.size.area();
    let mut list = layer.channel_data.list.clone();
    for i in 0..1000 {
        let zeros = FlatSamples::U32(vec![0; pixels]);
        list.push(AnyChannel::new(format!("extra.{i:04}").as_str(), zeros));
    }
    layer.channel_data = exr::prelude::AnyChannels::sort(list);
    layer.encoding = Encoding {
        compression: Compression::RLE,
        blocks,
        line_order: LineOrder::Increasing,
    };
    image.write().to_file(to).unwrap();
}

#[test]
fn channels_that_are_not_ours_take_no_memory_and_blocks_that_would_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let size = ["--size", "96x64", "--spp", "1"];
    let render = [
        "render",
        "triangle",
        "--quiet",
        "--samples",
        "0..1",
        "-o",
        "a.exr",
    ];
    succeeds(folder.path(), &[&render[..], &size[..2]].concat());
    swollen(&at("a.exr"), Blocks::ScanLines, &at("lines.exr"));
    swollen(&at("a.exr"), Blocks::Tiles(Vec2(96, 64)), &at("tile.exr"));
    let limits = Limits {
        memory: Budget::of(6 << 20),
        ..Limits::default()
    };
    let whole = read_part(&at("a.exr"), &Limits::default()).unwrap();
    assert!(read_part(&at("lines.exr"), &limits).unwrap() == whole);
    let error = read_part(&at("tile.exr"), &limits).unwrap_err().to_string();
    assert!(
        error.contains("tile.exr") && error.contains("--memory"),
        "{error}"
    );
    assert!(read_part(&at("tile.exr"), &Limits::default()).unwrap() == whole);
}

#[test]
fn a_forged_part_is_refused_whatever_is_to_be_written() {
    let folder = tempfile::tempdir().unwrap();
    part(folder.path(), "0..2", "a.exr");
    let mut forged = read_part(&folder.path().join("a.exr"), &Limits::default()).unwrap();
    forged.output = "output.exposure=NaN".into();
    write_part(&folder.path().join("forged.exr"), &forged).unwrap();
    for to in ["b.png", "b.exr", "b.hdr"] {
        let output = glassbox(folder.path(), &["merge", "forged.exr", "-o", to]);
        let (_, err) = texts(&output);
        assert_eq!(output.status.code(), Some(1), "{err}");
        assert!(
            err.lines().count() == 1 && err.contains("forged.exr"),
            "{err}"
        );
        assert!(err.contains("exposure"), "{err}");
    }
    assert_eq!(files(folder.path()), ["a.exr", "forged.exr"]);
}

#[test]
fn the_same_picture_is_the_same_file() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let render = |threads: &str, file: &str| {
        let what = [
            "render", "triangle", "--size", "700x500", "--spp", "1", "--quiet",
        ];
        succeeds(
            folder,
            &[&what[..], &["--threads", threads, "-o", file]].concat(),
        );
        bytes(folder, file)
    };
    for format in ["png", "jpg", "hdr", "exr"] {
        let first = render("1", &format!("first.{format}"));
        for threads in ["2", "3", "4"] {
            assert!(
                render(threads, &format!("again.{format}")) == first,
                "{format}"
            );
        }
    }
}
