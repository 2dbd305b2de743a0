//! Numbers and lists: `--stats`, `bvh`, `bench`, `scenes`, `--help`.

use super::{glassbox, succeeds, texts};
use glassbox::app::headless_app;
use glassbox::io::save;
use glassbox::scene::{SETTINGS, SceneCamera, SceneId};
use serde_json::Value;

#[test]
fn stats_hold_exactly_the_documented_keys_and_add_up() {
    let folder = tempfile::tempdir().unwrap();
    let arguments =
        "render cornell-box -o a.png --size 20x10 --spp 4 --threads 2 --builder sah --stats a.json";
    succeeds(folder.path(), &arguments.split(' ').collect::<Vec<_>>());
    let text = std::fs::read_to_string(folder.path().join("a.json")).unwrap();
    let stats: Value = serde_json::from_str(&text).unwrap();
    let keys = |value: &Value| {
        let mut keys: Vec<String> = value.as_object().unwrap().keys().cloned().collect();
        keys.sort();
        keys
    };
    let wanted = "build_ms builder height instances mrays_per_s rays relative_error relative_error_is_bound render_ms scene spp threads triangles width";
    assert_eq!(keys(&stats).join(" "), wanted);
    assert_eq!(
        keys(&stats["rays"]).join(" "),
        "camera mirror shadow transmission"
    );
    assert_eq!(stats["scene"], "cornell-box");
    assert_eq!(stats["builder"], "sah");
    for (key, value) in [("width", 20), ("height", 10), ("spp", 4), ("threads", 2)] {
        assert_eq!(stats[key], value, "{key}");
    }
    assert_eq!(stats["rays"]["camera"], 20 * 10 * 4);
    for ray in ["mirror", "shadow"] {
        assert!(
            stats["rays"][ray].as_u64().unwrap() > 0,
            "no {ray} rays: {text}"
        );
    }
    assert!(stats["triangles"].as_u64().unwrap() >= 32, "{text}");
    assert!(stats["instances"].as_u64().unwrap() >= 7, "{text}");
    let number = |value: &Value| value.as_f64().unwrap();
    let rays: f64 = stats["rays"]
        .as_object()
        .unwrap()
        .values()
        .map(number)
        .sum();
    let rate = rays / number(&stats["render_ms"]) / 1e3;
    let said = number(&stats["mrays_per_s"]);
    assert!(
        (rate - said).abs() < 1e-6 * rate,
        "{rate} computed, {said} said"
    );
}

#[test]
fn a_picture_whose_samples_all_agree_tells_a_bound_of_its_error_and_not_zero() {
    let folder = tempfile::tempdir().unwrap();
    let mut app = headless_app();
    app.world_mut().spawn((SceneId(1), SceneCamera::default()));
    save(app.world_mut(), &folder.path().join("empty.scn.ron")).unwrap();
    let arguments = "render empty.scn.ron -o a.png --size 20x10 --error 0.02 --stats a.json";
    let said = succeeds(folder.path(), &arguments.split(' ').collect::<Vec<_>>());
    assert!(said.contains(", error at most 1."), "{said}");
    let text = std::fs::read_to_string(folder.path().join("a.json")).unwrap();
    let stats: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(stats["relative_error_is_bound"], true, "{text}");
    let error = stats["relative_error"].as_f64().unwrap();
    assert!(error > 0.01 && error <= 0.02, "{text}");
}

#[test]
fn bvh_prints_a_line_per_builder_and_the_same_numbers_as_json() {
    let folder = tempfile::tempdir().unwrap();
    let table = succeeds(folder.path(), &["bvh", "head"]);
    let lines: Vec<Vec<&str>> = table
        .lines()
        .map(|line| line.split_whitespace().collect())
        .collect();
    let builders: Vec<&str> = lines.iter().map(|line| line[0]).collect();
    assert_eq!(
        builders,
        ["builder", "none", "median", "sah", "ploc"],
        "{table}"
    );

    let json: Value =
        serde_json::from_str(&succeeds(folder.path(), &["bvh", "head", "--json"])).unwrap();
    let rows = json.as_array().unwrap();
    for (line, row) in lines[1..].iter().zip(rows) {
        assert_eq!(line[0], row["builder"].as_str().unwrap());
        for (column, key) in [
            (1, "triangles"),
            (2, "levels"),
            (3, "nodes"),
            (4, "leaves"),
            (5, "largest_leaf"),
        ] {
            assert_eq!(line[column], row[key].to_string(), "{key} of {}", line[0]);
        }
        let leaves: u64 = row["leaf_sizes"]
            .as_array()
            .unwrap()
            .iter()
            .map(|n| n.as_u64().unwrap())
            .sum();
        assert_eq!(
            leaves,
            row["leaves"].as_u64().unwrap(),
            "leaves in the histogram of {}",
            line[0]
        );
        assert!(row["bytes_per_triangle"].as_f64().unwrap() > 0.0);
    }
    let value = |i: usize, key: &str| rows[i][key].as_f64().unwrap();
    assert_eq!((value(0, "nodes"), value(0, "leaves")), (1.0, 1.0));
    let (median, sah) = (value(1, "sah_cost"), value(2, "sah_cost"));
    assert!(sah < median, "SAH costs {sah}, median {median}");

    let one = succeeds(folder.path(), &["bvh", "triangle", "--builder", "sah"]);
    assert_eq!(one.lines().count(), 2, "{one}");
}

#[test]
fn bench_prints_a_markdown_table_with_a_column_per_builder() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = [
        "bench",
        "cornell-box",
        "--size",
        "20x20",
        "--spp",
        "1",
        "--runs",
        "2",
    ];
    let text = succeeds(folder.path(), &arguments);
    let rows: Vec<Vec<&str>> = text
        .lines()
        .filter(|line| line.starts_with('|'))
        .map(|line| line.trim_matches('|').split('|').map(str::trim).collect())
        .collect();
    assert_eq!(rows[0], ["", "none", "median", "SAH", "PLOC"], "{text}");
    assert!(rows.iter().all(|row| row.len() == 5), "{text}");
    let find = |name: &str| {
        rows.iter()
            .find(|row| row[0] == name)
            .unwrap_or_else(|| panic!("no {name}: {text}"))
    };
    let times = |name: &str| -> Vec<f64> {
        find(name)[1..]
            .iter()
            .map(|cell| cell.trim_end_matches(" ms").parse().unwrap())
            .collect()
    };
    let (least, median, most) = (
        times("Time to render, min"),
        times("Time to render, median"),
        times("Time to render, max"),
    );
    for i in 0..4 {
        assert!(least[i] <= median[i] && median[i] <= most[i], "{text}");
    }
    find("Time to create");
    find("BVH levels");
    find("Max triangles per leaf");

    let knot = [
        "bench", "knot", "--size", "4x4", "--spp", "1", "--runs", "1",
    ];
    let text = succeeds(folder.path(), &knot);
    assert!(
        text.contains("|  | median | SAH | PLOC |") && text.contains("--with-none"),
        "{text}"
    );
}

#[test]
fn scenes_are_listed_one_a_line() {
    let folder = tempfile::tempdir().unwrap();
    let text = succeeds(folder.path(), &["scenes"]);
    let scenes = glassbox::io::builtin::SCENES;
    assert_eq!(text.lines().count(), scenes.len());
    for (line, scene) in text.lines().zip(scenes) {
        assert!(line.starts_with(scene.name), "{line}");
        assert!(
            line.contains(" triangle") && line.contains(" light"),
            "{line}"
        );
        assert!(line.ends_with(scene.sentence), "{line}");
    }
}

#[test]
fn lists_and_timings_are_json_where_that_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let parse = |arguments: &[&str]| -> serde_json::Value {
        serde_json::from_str(&succeeds(folder.path(), arguments)).unwrap()
    };
    let scenes = parse(&["scenes", "--json"]);
    let found = scenes.as_array().unwrap();
    assert_eq!(found.len(), glassbox::io::builtin::SCENES.len());
    assert!(
        found.iter().all(|scene| scene["triangles"].is_u64()),
        "{scenes}"
    );
    let bench = [
        "bench", "triangle", "--size", "8x8", "--spp", "1", "--runs", "2", "--json",
    ];
    let bench = parse(&bench);
    assert_eq!(bench["size"], serde_json::json!([8, 8]));
    for builder in bench["builders"].as_array().unwrap() {
        assert_eq!(builder["render_ms"].as_array().unwrap().len(), 2, "{bench}");
    }
}

#[test]
fn every_command_is_completed_and_has_a_manual_page() {
    let folder = tempfile::tempdir().unwrap();
    let whole = succeeds(folder.path(), &["man"]);
    assert!(whole.contains("glassbox"), "{whole}");
    let help = succeeds(folder.path(), &["--help"]);
    let (_, list) = help.split_once("Commands:\n").expect("a list of commands");
    let (list, _) = list.split_once("\n\n").expect("its end");
    // What a command is said to be may go on in the next line, farther in.
    let starts = list
        .lines()
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let commands: Vec<&str> = starts
        .filter_map(|line| line.split_whitespace().next())
        .collect();
    let commands: Vec<&str> = commands
        .into_iter()
        .filter(|name| *name != "help")
        .collect();
    assert!(commands.len() >= 11, "{help}");
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = succeeds(folder.path(), &["completions", shell]);
        for command in &commands {
            assert!(script.contains(command), "{shell} lacks {command}");
        }
    }
    for command in &commands {
        let page = succeeds(folder.path(), &["man", command]);
        assert!(page.contains(&format!("glassbox\\-{command}")), "{page}");
    }
    let output = glassbox(folder.path(), &["man", "rendr"]);
    let why = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{why}");
    assert!(why.contains("did you mean render?"), "{why}");
}

#[test]
fn help_lists_every_setting_and_the_version_is_the_packages() {
    let folder = tempfile::tempdir().unwrap();
    let help = succeeds(folder.path(), &["render", "--help"]);
    for setting in SETTINGS.iter() {
        assert!(help.contains(&setting.path), "{} is missing", setting.path);
    }
    let version = succeeds(folder.path(), &["--version"]);
    assert_eq!(
        version.trim(),
        format!("glassbox {}", env!("CARGO_PKG_VERSION"))
    );
}

#[test]
fn nothing_is_drawn_over_itself_where_the_output_is_no_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let output = glassbox(
        folder.path(),
        &["render", "triangle", "-o", "a.png", "--size", "9x9"],
    );
    let (out, err) = texts(&output);
    assert!(
        !out.contains(['\r', '\x1b']) && err.is_empty(),
        "stdout: {out:?}\nstderr: {err:?}"
    );
}
