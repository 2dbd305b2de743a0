//! `glassbox report`: what it writes and what it takes in.

use super::{PROGRAM, files, glassbox, succeeds, texts, without_display};

#[test]
fn an_editing_benchmarks_figures_are_a_section_of_the_report() {
    let folder = tempfile::tempdir().unwrap();
    let figures = "scene,objects,edit,frame p50 ms,frame p95 ms,picture p50 ms,redone\n\
                   knot,2,mesh swap,1.5,2.5,40.2,\"meshes, top level\"\n";
    std::fs::write(folder.path().join("edits.csv"), figures).unwrap();
    let arguments = "report sampling triangle --quick --seed 3 --editing edits.csv -o out";
    let said = succeeds(folder.path(), &arguments.split(' ').collect::<Vec<_>>());
    let found = "seen after at most 40 ms in the median (mesh swap in knot)";
    assert!(said.contains(found), "{said}");
    let out = folder.path().join("out");
    let text = std::fs::read_to_string(out.join("report.md")).unwrap();
    for part in [
        arguments,
        "## Sampling",
        "## Editing",
        found,
        "(sampling-triangle-seconds.svg)",
        "meshes, top level",
    ] {
        assert!(text.contains(part), "`{part}` is not in:\n{text}");
    }
    assert_eq!(
        std::fs::read_to_string(out.join("editing.csv")).unwrap(),
        figures
    );
    let files = files(&out);
    for file in [
        "sampling.csv",
        "slopes.csv",
        "sampling-triangle-rays.png",
        "sampling-triangle-rays.svg",
    ] {
        assert!(files.iter().any(|name| name == file), "{files:?}");
    }
}

#[test]
fn editing_figures_that_are_no_table_are_refused_before_anything_is_measured() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bad.csv"), "a,b\n1,2\n3\n").unwrap();
    for (file, said) in [
        ("bad.csv", "bad.csv: line 3: 1 fields instead of 2"),
        ("none.csv", "none.csv"),
    ] {
        let arguments = ["report", "sampling", "triangle", "--editing", file];
        let output = glassbox(folder.path(), &arguments);
        let (_, err) = texts(&output);
        assert_eq!(output.status.code(), Some(1), "{err}");
        assert!(err.contains(said), "{err}");
        assert!(!folder.path().join("report").exists());
    }
}

#[test]
fn an_embree_that_is_named_and_is_none_is_refused_before_anything_is_measured() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("text.so"), "not a library").unwrap();
    for name in ["./text.so", "./missing.so"] {
        let output = without_display(PROGRAM, folder.path())
            .args(["report", "kernels", "triangle", "--quick"])
            .env("EMBREE_LIB", name)
            .output()
            .unwrap();
        let (_, err) = texts(&output);
        assert_eq!(output.status.code(), Some(1), "{err}");
        assert!(err.contains(&format!("EMBREE_LIB={name}: ")), "{err}");
        assert!(!folder.path().join("report").exists());
    }
}
