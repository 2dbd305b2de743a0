//! STL and PLY that cannot be shown, and such as ask for too much.

use super::{refused, refused_with, says};
use crate::files::app::write;
use glassbox::io::{Budget, Limits, OpenOptions};
use std::time::{Duration, Instant};

const FACES: &str = "element face 1\nproperty list uchar int vertex_indices\n";
const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";

fn says_of(name: &str, content: impl AsRef<[u8]>, parts: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let start = Instant::now();
    says(&refused(&write(folder.path(), name, content)), parts);
    let time = start.elapsed();
    assert!(
        time < Duration::from_secs(20),
        "{name}: refused after {time:?}"
    );
}

fn ply(elements: &str, numbers: &str) -> String {
    format!("ply\nformat ascii 1.0\n{elements}end_header\n{numbers}")
}

#[test]
fn an_stl_that_holds_nothing_that_can_be_shown_says_what_it_is() {
    says_of("a.stl", "", &["a.stl", "is empty"]);
    says_of(
        "a.stl",
        "solid a\nendsolid a\n",
        &["a.stl: holds no triangles"],
    );
    says_of(
        "a.stl",
        "Dear all,\nno facets here.\n",
        &["a.stl:1", "neither an ASCII nor a binary"],
    );
    says_of(
        "a.stl",
        [0; 60],
        &["a.stl", "neither an ASCII nor a binary"],
    );
    says_of("a.stl", [0; 84], &["a.stl: holds no triangles"]);
    let text = "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 0 one 0\n";
    says_of("a.stl", text, &["a.stl:5", "`one` is not a number"]);
    let mut lies = vec![0; 84];
    lies[80..].fill(0xff);
    says_of(
        "a.stl",
        lies,
        &["a.stl", "ends too early", "4294967295 facets and has 0"],
    );
}

#[test]
fn a_ply_that_holds_nothing_that_can_be_shown_says_what_it_is() {
    let points = format!("element vertex 2\n{XYZ}");
    says_of(
        "a.ply",
        ply(&points, "0 0 0 1 1 1"),
        &["a.ply: holds 2 points and no triangles"],
    );
    says_of("a.ply", "obj\n", &["a.ply:1", "does not begin with `ply`"]);
    says_of(
        "a.ply",
        "ply\nformat ascii 1.0\n",
        &["a.ply", "no `end_header`"],
    );
    says_of(
        "a.ply",
        "ply\nend_header\n",
        &["a.ply:2", "says no `format`"],
    );
    says_of(
        "a.ply",
        "ply\nformat text 1.0\n",
        &["a.ply:2", "`text` is no format"],
    );
    says_of(
        "a.ply",
        ply("element vertex many\n", ""),
        &["a.ply:3", "has no number"],
    );
    says_of(
        "a.ply",
        ply("property float x\n", ""),
        &["a.ply:3", "no property of an element"],
    );
    let flat = "element vertex 1\nproperty float x\nproperty float y\n";
    says_of("a.ply", ply(flat, "0 0"), &["no x, y and z"]);
    let faces = format!("element vertex 1\n{XYZ}element face 1\nproperty int a\n");
    says_of(
        "a.ply",
        ply(&faces, "0 0 0 1"),
        &["no list `vertex_indices`"],
    );
    let outside = format!("element vertex 1\n{XYZ}{FACES}");
    says_of(
        "a.ply",
        ply(&outside, "0 0 0 3 0 0 1"),
        &["vertex 1 is used, and there are 1"],
    );
}

/// Numbers that are larger than the file: nothing may be allocated or counted for them.
#[test]
fn lying_counts_and_lengths_of_a_ply_end_with_the_file() {
    let nothing = format!(
        "element nothing {}\nelement vertex {}\n{XYZ}{FACES}",
        i64::MAX,
        u64::MAX
    );
    says_of("a.ply", ply(&nothing, "0 0 0"), &["ends too early"]);
    let many = format!("element vertex {}9\n{XYZ}", u64::MAX);
    says_of("a.ply", ply(&many, "0 0 0"), &["has no number"]);
    for length in ["4294967295", "-1", "1e300", "inf", "nan", "0.5"] {
        let elements = format!(
            "element vertex 1\n{XYZ}element face 1\nproperty list uint int vertex_indices\n"
        );
        says_of(
            "a.ply",
            ply(&elements, &format!("0 0 0 {length} 0 0")),
            &["a.ply:"],
        );
    }
    let word = "9".repeat(1 << 21);
    says_of(
        "a.ply",
        ply(&format!("element vertex 1\n{XYZ}"), &word),
        &["letters is not a number"],
    );
    let header = format!("ply\nformat ascii 1.0\ncomment {}", "x".repeat(1 << 21));
    says_of("a.ply", header, &["no `end_header`"]);
}

#[test]
fn a_scan_that_asks_for_more_memory_or_triangles_than_allowed_is_refused_while_it_is_read() {
    let mut stl = vec![0; 84];
    stl[80..].copy_from_slice(&200_000_u32.to_le_bytes());
    for i in 0..200_000 {
        let corner = |axis: usize| (0..3).map(move |a| if a == axis { i as f32 } else { 1.0 });
        let numbers = [[0.0; 3].to_vec(), (0..3).flat_map(corner).collect()].concat();
        stl.extend(numbers.iter().flat_map(|number: &f32| number.to_le_bytes()));
        stl.extend([0; 2]);
    }
    let corners = 200_000;
    let list = "property list uint int vertex_indices\n";
    let ply = ply(
        &format!("element vertex 3\n{XYZ}element face 1\n{list}"),
        &format!(
            "0 0 0 1 0 0 0 1 0 {corners} {}",
            "0 1 2 0 ".repeat(corners / 4)
        ),
    );
    for (name, content) in [("a.stl", stl), ("a.ply", ply.into_bytes())] {
        let folder = tempfile::tempdir().unwrap();
        let file = write(folder.path(), name, content);
        let limits = Limits {
            memory: Budget::of(16 << 20),
            ..Limits::default()
        };
        let options = |limits| OpenOptions {
            limits,
            ..OpenOptions::default()
        };
        says(&refused_with(&file, options(limits)), &[name, "--memory"]);
        let limits = Limits {
            triangles: 1000,
            ..Limits::default()
        };
        says(
            &refused_with(&file, options(limits)),
            &[name, "triangles, and the limit is 1000"],
        );
    }
}
