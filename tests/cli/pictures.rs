//! Pictures that `glassbox render` writes.

use super::{files, glassbox, succeeds, texts};
use std::path::Path;

const SMALL: [&str; 4] = ["--size", "40x30", "--spp", "4"];

fn render(folder: &Path, scene: &str, output: &str, more: &[&str]) -> String {
    let arguments = [&["render", scene, "-o", output][..], &SMALL, more].concat();
    succeeds(folder, &arguments)
}

/// The pixels, to the bit: files also say what they were rendered with.
fn bits(folder: &Path, name: &str) -> Vec<u32> {
    let picture = image::open(folder.join(name)).unwrap().into_rgb32f();
    let values = picture.into_raw().into_iter();
    values.map(f32::to_bits).collect()
}

#[test]
fn a_picture_says_how_it_was_rendered_and_the_same_render_says_the_same() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.png", "a.exr"] {
        let render = || {
            render(folder.path(), "cornell-box", name, &["--seed", "7"]);
            std::fs::read(folder.path().join(name)).unwrap()
        };
        let bytes = render();
        let text = String::from_utf8_lossy(&bytes);
        for word in ["Glassbox", "size=40x30", "spp=4", "seed=7"] {
            assert!(text.contains(word), "{name} does not say {word}");
        }
        assert!(bytes == render(), "{name}: another file of the same render");
    }
}

#[test]
fn a_picture_has_the_size_that_was_asked_for_and_shows_something() {
    let folder = tempfile::tempdir().unwrap();
    let said = render(folder.path(), "cornell-box", "a.png", &[]);
    assert!(said.starts_with("a.png: 40x30, 4 spp"), "{said}");
    let picture = image::open(folder.path().join("a.png"))
        .unwrap()
        .into_rgb8();
    assert_eq!(picture.dimensions(), (40, 30));
    let lit = picture.pixels().filter(|pixel| pixel.0 != [0; 3]).count();
    assert!(lit > 600, "only {lit} of 1200 pixels are not black");
    assert_eq!(files(folder.path()), ["a.png"]);
}

#[test]
fn the_same_scene_gives_the_same_picture_for_1_2_and_7_threads() {
    let folder = tempfile::tempdir().unwrap();
    for scene in ["cornell-box-parallelogram-light", "spheres"] {
        let render = |threads: &str| {
            // Linear 32-bit values: nothing hides behind rounding to 8 bits.
            render(folder.path(), scene, "a.exr", &["--threads", threads]);
            bits(folder.path(), "a.exr")
        };
        let one = render("1");
        assert!(
            one == render("2"),
            "{scene}: 2 threads give another picture"
        );
        assert!(
            one == render("7"),
            "{scene}: 7 threads give another picture"
        );
    }
}

#[test]
fn the_seed_changes_the_picture_and_the_builder_does_not() {
    let folder = tempfile::tempdir().unwrap();
    let render = |more: &[&str]| {
        render(
            folder.path(),
            "cornell-box-parallelogram-light",
            "a.exr",
            more,
        );
        bits(folder.path(), "a.exr")
    };
    let plain = render(&[]);
    assert!(
        plain == render(&["--seed", "0"]),
        "the default seed is not 0"
    );
    assert!(
        plain != render(&["--seed", "1"]),
        "another seed gives the same picture"
    );
    for builder in ["none", "median", "sah", "ploc"] {
        assert!(
            plain == render(&["--builder", builder]),
            "{builder} gives another picture"
        );
    }
    let one_level = render(&["--set", "tree.levels=One", "--builder", "sah"]);
    assert!(plain == one_level, "one level gives another picture");
}

#[test]
fn settings_reach_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let mean = |more: &[&str]| {
        render(folder.path(), "cornell-box", "a.png", more);
        let picture = image::open(folder.path().join("a.png"))
            .unwrap()
            .into_rgb8();
        let sum: u64 = picture.as_raw().iter().map(|&v| u64::from(v)).sum();
        sum as f64 / picture.as_raw().len() as f64
    };
    let plain = mean(&[]);
    let bright = mean(&["--set", "output.exposure=2"]);
    let unshadowed = mean(&["--set", "features.shadows=false"]);
    assert!(
        bright > plain * 1.1,
        "{plain} with 0 stops, {bright} with 2"
    );
    assert!(
        unshadowed > plain * 1.02,
        "{plain} with shadows, {unshadowed} without"
    );
}

#[test]
fn every_camera_writes_a_picture_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), "showcase", "a.png", &["--all-cameras"]);
    let all = files(folder.path());
    assert_eq!(all.len(), 2, "{all:?}");
    assert!(
        all.iter()
            .all(|name| name.starts_with("a-") && name.ends_with(".png")),
        "{all:?}"
    );
    let name = all[1].trim_start_matches("a-").trim_end_matches(".png");
    render(folder.path(), "showcase", "one.png", &["--camera", name]);
    let (one, same) = (bits(folder.path(), "one.png"), bits(folder.path(), &all[1]));
    assert!(
        one == same,
        "the same camera gives another picture by itself"
    );
    assert!(
        one != bits(folder.path(), &all[0]),
        "both cameras see the same"
    );
}

#[test]
fn every_picture_format_is_written() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.png", "a.jpg", "a.jpeg", "a.exr", "a.hdr"] {
        render(folder.path(), "triangle", name, &[]);
        let picture = image::open(folder.path().join(name)).unwrap();
        assert_eq!((picture.width(), picture.height()), (40, 30), "{name}");
    }
}

#[test]
fn a_converted_scene_gives_the_same_picture() {
    let folder = tempfile::tempdir().unwrap();
    for scene in ["cornell-box", "textured-cube"] {
        render(folder.path(), scene, "built-in.exr", &[]);
        succeeds(folder.path(), &["convert", scene, "saved.scn.ron"]);
        render(folder.path(), "saved.scn.ron", "saved.exr", &[]);
        let same = bits(folder.path(), "built-in.exr") == bits(folder.path(), "saved.exr");
        assert!(
            same,
            "{scene}: saved and opened again it gives another picture"
        );
    }
}

/// A model of so many sheets of this opacity, one behind the other.
fn write_sheets(folder: &Path, count: usize, opacity: f32) {
    let material = format!("newmtl faint\nKd 1 1 1\nd {opacity}\n");
    std::fs::write(folder.join("sheets.mtl"), material).unwrap();
    let mut model = "mtllib sheets.mtl\no pages\nusemtl faint\n".to_owned();
    for i in 0..count {
        let z = -0.001 * i as f32;
        model += &format!("v -1 -1 {z}\nv 1 -1 {z}\nv 1 1 {z}\nv -1 1 {z}\nf -4 -3 -2 -1\n");
    }
    std::fs::write(folder.join("sheets.obj"), model).unwrap();
}

#[test]
fn a_picture_whose_rays_go_through_hundreds_of_surfaces_says_so_and_of_what_before_it_is_traced() {
    let folder = tempfile::tempdir().unwrap();
    let tiny = [
        "render",
        "sheets.obj",
        "-o",
        "a.png",
        "--size",
        "4x4",
        "--spp",
        "1",
    ];
    for (count, opacity, is_told) in [(400, 0.0005, true), (40, 0.0005, false), (400, 0.9, false)] {
        write_sheets(folder.path(), count, opacity);
        let output = glassbox(folder.path(), &tiny);
        let (_, err) = texts(&output);
        assert_eq!(output.status.code(), Some(0), "{err}");
        let told = err
            .lines()
            .find(|line| line.contains("surfaces each, most of them of"));
        assert_eq!(told.is_some(), is_told, "{count} of {opacity}: {err}");
        let told = told.unwrap_or("note: sheets.obj: \"pages\"");
        assert!(
            told.starts_with("note: sheets.obj: ") && told.contains("\"pages\""),
            "{told}"
        );
    }
    write_sheets(folder.path(), 400, 0.0005);
    let output = glassbox(folder.path(), &[&tiny[..], &["--quiet"]].concat());
    assert_eq!(texts(&output).1, "");
}

#[test]
fn a_model_without_camera_and_light_is_framed_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::fs::write(folder.path().join("a.obj"), triangle).unwrap();
    let arguments = [&["render", "a.obj", "-o", "a.png"][..], &SMALL].concat();
    let output = glassbox(folder.path(), &arguments);
    let (_, err) = texts(&output);
    assert_eq!(output.status.code(), Some(0), "{err}");
    assert!(
        err.contains("note: ") && err.contains("camera") && err.contains("light"),
        "{err}"
    );
    let picture = image::open(folder.path().join("a.png"))
        .unwrap()
        .into_rgb8();
    let first = picture.get_pixel(0, 0);
    assert!(
        picture.pixels().any(|pixel| pixel != first),
        "the picture is of one colour"
    );

    let arguments = [&arguments[..], &["--quiet"]].concat();
    let (out, err) = texts(&glassbox(folder.path(), &arguments));
    assert_eq!((out.as_str(), err.as_str()), ("", ""));
}

#[test]
fn without_a_command_it_says_what_it_can_do_and_renders_the_default_scene() {
    let folder = tempfile::tempdir().unwrap();
    let output = glassbox(folder.path(), &[]);
    let (out, err) = texts(&output);
    assert_eq!(output.status.code(), Some(0), "{err}");
    let parts: &[&str] = if cfg!(feature = "editor") {
        assert_eq!(err.lines().count(), 1, "{err}");
        assert!(
            err.contains("no window") && err.contains("`glassbox render`"),
            "{err}"
        );
        &["cornell-box.png"]
    } else {
        &[
            "render",
            "scenes",
            "bvh",
            "convert",
            "bench",
            "cornell-box.png",
        ]
    };
    for part in parts {
        assert!(out.contains(part), "`{part}` is missing: {out}");
    }
    assert_eq!(files(folder.path()), ["cornell-box.png"]);
}

#[test]
fn with_lights_separately_an_exr_has_a_layer_for_each_light_and_they_add_up_to_the_picture() {
    use exr::prelude::*;
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), "showcase", "a.exr", &["--lights-separately"]);
    render(folder.path(), "showcase", "b.exr", &[]);
    let pictures = ["a.exr", "b.exr"].map(|name| bits(folder.path(), name));
    for (apart, whole) in pictures[0].iter().zip(&pictures[1]) {
        // Samples are rounded to f32 light by light.
        let [apart, whole] = [apart, whole].map(|bits| f32::from_bits(*bits));
        assert!((apart - whole).abs() <= 1e-6 * whole, "{apart}, {whole}");
    }
    let file = read_first_flat_layer_from_file(folder.path().join("a.exr")).unwrap();
    let channels = &file.layer_data.channel_data.list;
    let values = |name: &str| {
        let channel = channels
            .iter()
            .find(|channel| channel.name.to_string() == name);
        let channel = channel.unwrap_or_else(|| panic!("no channel {name}"));
        channel.sample_data.values_as_f32().collect::<Vec<f32>>()
    };
    let names = channels.iter().map(|channel| channel.name.to_string());
    let layers: Vec<String> = names.filter(|name| name.ends_with(".R")).collect();
    assert!(layers.contains(&"Combined_Own.R".to_owned()), "{layers:?}");
    assert!(layers.len() > 2, "{layers:?}");
    let parts: Vec<Vec<f32>> = layers.iter().map(|name| values(name)).collect();
    for (i, whole) in values("R").into_iter().enumerate() {
        let sum: f32 = parts.iter().map(|part| part[i]).sum();
        assert!(
            (sum - whole).abs() <= 1e-5 * whole.max(1e-3),
            "pixel {i}: {sum}, {whole}"
        );
    }
    let refused = glassbox(
        folder.path(),
        &["render", "showcase", "-o", "a.png", "--lights-separately"],
    );
    assert_eq!(refused.status.code(), Some(2));
}

/// A picture's values.
fn values(folder: &Path, name: &str) -> Vec<f32> {
    let bits = bits(folder, name).into_iter();
    bits.map(f32::from_bits).collect()
}

#[test]
fn a_gain_makes_the_picture_that_a_render_with_the_light_so_bright_is_but_for_rounding() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    render(folder, "showcase", "a.exr", &["--lights-separately"]);
    for (gain, property) in [
        ("Spot=2.5", "Spot/PointLamp.intensity*=2.5"),
        ("Sun=0", "Sun/DirectionalLamp.intensity=0"),
        ("Neon tube=0.5", "Neon tube/SegmentLamp.intensity*=0.5"),
    ] {
        let said = succeeds(folder, &["merge", "a.exr", "--gain", gain, "-o", "b.exr"]);
        assert!(said.contains(gain), "{said}");
        render(folder, "showcase", "c.exr", &["--set", property]);
        let [mixed, rendered] = ["b.exr", "c.exr"].map(|name| values(folder, name));
        let brightest = rendered.iter().copied().fold(0.0, f32::max);
        for (mixed, rendered) in mixed.iter().zip(&rendered) {
            // Samples are rounded to f32 light by light, and so is each light's layer.
            let difference = (mixed - rendered).abs();
            assert!(
                difference <= 2e-6 * rendered.max(1e-3 * brightest),
                "{gain}: {mixed}, {rendered}"
            );
        }
    }
    // A mix of a mix is that of both; with a gain of 1 nothing changes, bit for bit.
    let mix = |from: &str, gain: &str, to: &str| {
        succeeds(folder, &["merge", from, "--gain", gain, "-o", to]);
    };
    mix("a.exr", "Spot=4,2,1", "b.exr");
    mix("b.exr", "Spot=.25,.5,1", "c.exr");
    let [whole, back] = ["a.exr", "c.exr"].map(|name| values(folder, name));
    for (whole, back) in whole.iter().zip(&back) {
        assert!((whole - back).abs() <= 1e-6 * whole, "{whole}, {back}");
    }
    mix("a.exr", "Sun=1", "b.exr");
    assert!(bits(folder, "a.exr") == bits(folder, "b.exr"));
    // A picture for a screen is developed as the file says that it was to be.
    let dark = ["--lights-separately", "--set", "output.exposure=-3"];
    render(folder, "showcase", "dark.exr", &dark);
    let png = |name: &str| {
        image::open(folder.join(name))
            .unwrap()
            .into_rgb8()
            .into_raw()
    };
    let mean = |bytes: Vec<u8>| bytes.iter().map(|b| f64::from(*b)).sum::<f64>();
    mix("a.exr", "Sun=1", "a.png");
    mix("dark.exr", "Sun=1", "dark.png");
    assert!(mean(png("dark.png")) < 0.6 * mean(png("a.png")));
}

#[test]
fn a_gain_that_is_none_or_is_for_nobody_is_refused_and_says_what_there_is() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    render(folder, "showcase", "a.exr", &["--lights-separately"]);
    render(folder, "showcase", "plain.exr", &[]);
    let before = files(folder);
    let cases: &[(&[&str], i32, &[&str])] = &[
        (
            &["a.exr", "--gain", "Lamp=2"][..],
            2,
            &["`Lamp`", "Spot", "Own"][..],
        ),
        (&["a.exr", "--gain", "Spot=NaN"], 2, &["NaN", "0 to"]),
        (&["a.exr", "--gain", "Spot=-1"], 2, &["-1", "0 to"]),
        (&["a.exr", "--gain", "Spot"], 2, &["LIGHT=FACTOR"]),
        (
            &["a.exr", "--gain", "Spot=1", "--gain", "Spot=2"],
            2,
            &["twice"],
        ),
        (&["a.exr", "a.exr", "--gain", "Spot=2"], 2, &["one picture"]),
        (
            &["plain.exr", "--gain", "Spot=2"],
            1,
            &["--lights-separately"],
        ),
        (&["none.exr", "--gain", "Spot=2"], 1, &["none.exr"]),
        (
            &["a.exr", "--gain", "Spot=2", "--memory", "0.1M"],
            1,
            &["a.exr"],
        ),
    ];
    for &(more, code, words) in cases {
        let arguments = [&["merge", "-o", "b.exr"][..], more].concat();
        let output = glassbox(folder, &arguments);
        let (_, said) = texts(&output);
        assert_eq!(output.status.code(), Some(code), "{more:?}: {said}");
        for word in words {
            assert!(said.contains(word), "{more:?}: {said}");
        }
        assert_eq!(files(folder), before, "{more:?}");
    }
    let bright = ["merge", "a.exr", "--gain", "Sun=1e38", "-o", "b.exr"];
    let (_, said) = texts(&glassbox(folder, &bright));
    assert!(said.contains("brighter than a file can say"), "{said}");
    assert!(
        values(folder, "b.exr")
            .iter()
            .all(|value| value.is_finite())
    );
}

#[test]
fn lights_that_are_kept_apart_are_refused_where_the_picture_alone_has_room() {
    let folder = tempfile::tempdir().unwrap();
    let render = ["render", "showcase", "-o", "a.exr", "--spp", "1"];
    let size = ["--size", "700x700", "--memory", "250M"];
    let whole = glassbox(folder.path(), &[&render[..], &size].concat());
    assert_eq!(whole.status.code(), Some(0), "{:?}", texts(&whole));
    let apart = [&render[..], &size, &["--lights-separately"]].concat();
    let refused = glassbox(folder.path(), &apart);
    let (_, said) = texts(&refused);
    assert_eq!(refused.status.code(), Some(1), "{said}");
    assert!(
        said.contains("--memory") || said.contains("memory"),
        "{said}"
    );
}
