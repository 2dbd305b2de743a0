//! `glassbox inspect` and the tables of `glassbox bvh`, run as people run them.

use crate::cli::{files, glassbox, succeeds, texts};
use serde_json::Value;
use std::path::Path;

fn run(folder: &Path, line: &str) -> String {
    succeeds(folder, &line.split(' ').collect::<Vec<_>>())
}

#[test]
fn a_pixel_is_explained_as_text_and_as_json_and_both_say_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let line = "inspect cornell-box --size 40x40 --spp 4 --pixel 12,30";
    let text = run(folder.path(), line);
    assert!(text.contains("the mean of 4 samples"), "{text}");
    assert!(text.contains("bit for bit: yes"), "{text}");
    assert!(
        text.contains("camera 0") && text.contains("  shadow"),
        "{text}"
    );
    let json: Value = serde_json::from_str(&run(folder.path(), &format!("{line} --json"))).unwrap();
    assert_eq!(json["samples"].as_array().unwrap().len(), 4);
    let value = json["value"][0].as_f64().unwrap();
    assert!(
        text.contains(&format!("{value:.5}")),
        "{value} is not in\n{text}"
    );
    for (sample, sum) in json["samples"]
        .as_array()
        .unwrap()
        .iter()
        .zip(json["sums"].as_array().unwrap())
    {
        assert_eq!(sample["value"], *sum);
    }
    let rays = json["rays"].as_array().unwrap();
    assert!(rays.iter().all(|ray| ray["cost"]["boxes"].is_u64()));
    assert!(json["counters"].as_str().unwrap().contains("ray by ray"));
    assert_eq!(json["lines"][0]["system"], "rays");
    let one: Value =
        serde_json::from_str(&run(folder.path(), &format!("{line} --json --sample 2"))).unwrap();
    assert_eq!(one["samples"][0], json["samples"][2]);
}

#[test]
fn a_picture_shows_lines_where_a_plain_one_does_not() {
    let folder = tempfile::tempdir().unwrap();
    let base = "inspect cornell-box --size 60x60 --spp 1 --quiet --picture";
    run(folder.path(), &format!("{base} plain.png --gizmo on=false"));
    run(folder.path(), &format!("{base} tree.png --preset tree"));
    run(
        folder.path(),
        &format!("{base} rays.png --pixel 30,40 --preset noise --eye 5,3,8 --target 2.7,2.7,2.7"),
    );
    assert_eq!(files(folder.path()), ["plain.png", "rays.png", "tree.png"]);
    let pixels = |name: &str| {
        let file = std::fs::read(folder.path().join(name)).unwrap();
        image::load_from_memory(&file).unwrap().to_rgb8()
    };
    run(
        folder.path(),
        "render cornell-box --size 60x60 --spp 1 --quiet -o render.png",
    );
    assert_eq!(pixels("plain.png"), pixels("render.png"));
    let (plain, tree) = (pixels("plain.png"), pixels("tree.png"));
    let changed = plain
        .pixels()
        .zip(tree.pixels())
        .filter(|(a, b)| a != b)
        .count();
    assert!(changed > 300, "{changed} of 3600 pixels have lines");
}

#[test]
fn the_steps_of_a_ray_are_printed_with_the_stack() {
    let folder = tempfile::tempdir().unwrap();
    let line = "inspect head --size 40x40 --spp 1 --pixel 20,20 --sample 0 --steps 0";
    let text = run(folder.path(), line);
    assert!(
        text.lines().next().unwrap().contains("stack (next last)"),
        "{text}"
    );
    assert!(text.lines().nth(1).unwrap().contains("enter"), "{text}");
    assert!(text.contains("triangles tested"), "{text}");
    let json: Value = serde_json::from_str(&run(folder.path(), &format!("{line} --json"))).unwrap();
    let steps = json["traversal"]["steps"].as_array().unwrap();
    let cost = &json["rays"][0]["cost"];
    let sum = cost["boxes"].as_u64().unwrap() + cost["triangles"].as_u64().unwrap();
    assert_eq!(steps.len() as u64, sum);
}

#[test]
fn what_cannot_be_inspected_ends_with_one_line_and_no_file() {
    let folder = tempfile::tempdir().unwrap();
    for (line, code, parts) in [
        ("inspect triangle", 2, vec!["--pixel", "--picture"]),
        (
            "inspect triangle --pixel 900,1",
            2,
            vec!["pixel 900,1", "0 to 799"],
        ),
        (
            "inspect triangle --pixel 1,1 --sample 99",
            2,
            vec!["no sample 99"],
        ),
        ("inspect triangle --pixel 1", 2, vec!["400,300"]),
        ("inspect triangle --pixel 1,1 --sample x", 2, vec!["all"]),
        (
            "inspect triangle --pixel 1,1 --steps 99999",
            2,
            vec!["no such ray"],
        ),
        ("inspect triangle --picture a.exr", 2, vec!["a.exr", ".png"]),
        (
            "inspect triangle --picture a.png --gizmo boxs.on=1",
            2,
            vec!["--gizmo boxs.on", "boxes.on"],
        ),
        (
            "inspect triangle --pixel 1,1 --preset black",
            2,
            vec!["--preset", "--picture", "--json"],
        ),
        (
            "inspect triangle --pixel 1,1 --eye 0,0,1 --target 0,0,0",
            2,
            vec!["--picture"],
        ),
        (
            "inspect triangle --pixel 1,1 --camera top",
            2,
            vec!["no camera `top`"],
        ),
        ("inspect nothing.glb --pixel 1,1", 1, vec!["nothing.glb"]),
    ] {
        let output = glassbox(folder.path(), &line.split(' ').collect::<Vec<_>>());
        let (out, err) = texts(&output);
        let what = format!("{line}\nstdout: {out}\nstderr: {err}");
        assert_eq!(output.status.code(), Some(code), "{what}");
        assert_eq!(err.lines().count(), 1, "{what}");
        for part in parts {
            assert!(err.contains(part), "{part} is missing: {what}");
        }
        assert!(files(folder.path()).is_empty(), "{what}");
    }
}

#[test]
fn the_builders_are_printed_as_markdown_and_csv_with_rates() {
    let folder = tempfile::tempdir().unwrap();
    let text = run(
        folder.path(),
        "bvh cornell-box --rays --size 20x20 --spp 1 --markdown",
    );
    assert!(text.starts_with("| builder | triangles |"), "{text}");
    assert!(
        text.contains("closest Mray/s") && text.contains("Leaves by their depth"),
        "{text}"
    );
    let text = run(folder.path(), "bvh cornell-box --csv");
    assert_eq!(text.lines().count(), 5, "{text}");
}
