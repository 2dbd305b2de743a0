use super::super::super::folder::Folder;
use super::*;
use crate::io::Budget;

#[test]
fn a_name_with_very_many_options_behind_it_is_looked_for_in_a_moment() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("long.mtl");
    std::fs::write(
        &file,
        format!("newmtl a\nmap_Kd b{}\n", " -c".repeat(200_000)),
    )
    .unwrap();
    let limits = Limits::default();
    let started = std::time::Instant::now();
    let whole = Folder::of(&file, false);
    let mut names = Names::new(&whole);
    let notes = &mut Notes::default();
    let read = read_mtl(&file, "long.mtl", &limits, &mut names, notes).unwrap();
    assert_eq!(read[0].diffuse_map, Some(None));
    // Each of its beginnings would be 60 billion bytes.
    let seconds = started.elapsed().as_secs();
    assert!(seconds < 20, "{seconds} s");
}

#[test]
fn materials_count_as_memory_while_they_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("many.mtl");
    let lines: String = (0..2000)
        .map(|i| format!("newmtl {i}\nKd 1 1 1\n"))
        .collect();
    std::fs::write(&file, lines).unwrap();
    let read = |bytes| {
        let limits = Limits {
            memory: Budget::of(bytes),
            ..Limits::default()
        };
        let whole = Folder::of(&file, false);
        let mut names = Names::new(&whole);
        read_mtl(
            &file,
            "many.mtl",
            &limits,
            &mut names,
            &mut Notes::default(),
        )
    };
    let error = read(100 * ENTITY).unwrap_err();
    assert!(error.problem.is_of_memory(), "{error}");
    assert_eq!(error.place, Place::Line(201), "{error}");
    assert_eq!(read(2000 * ENTITY).unwrap().len(), 2000);
}
