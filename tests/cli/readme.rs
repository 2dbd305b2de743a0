//! The commands that README shows, as a reader would paste them.

use super::{PROGRAM, files, texts, without_display};
use std::path::Path;

/// The first block of commands below a heading of README.
fn commands(heading: &str) -> String {
    let readme = include_str!("../../README.md");
    let (_, below) = readme.split_once(heading).expect(heading);
    let (_, block) = below.split_once("```sh\n").expect("a block of commands");
    let (block, _) = block.split_once("```").expect("its end");
    block.to_owned()
}

#[test]
fn each_line_of_the_command_line_section_works_as_it_stands_in_this_order() {
    let folder = tempfile::tempdir().unwrap();
    let beside = Path::new(PROGRAM).parent().expect("a folder").display();
    let path = format!("{beside}:{}", std::env::var("PATH").unwrap_or_default());
    let block = commands("\n## The command line\n");
    let lines: Vec<&str> = block.lines().collect();
    assert!(lines.len() >= 15, "{block}");
    for line in lines {
        let output = without_display("sh", folder.path())
            .args(["-c", line])
            .env("PATH", &path)
            .output()
            .expect("a shell");
        let (out, err) = texts(&output);
        assert!(output.status.success(), "{line}\n{out}\n{err}");
    }
    let made = files(folder.path());
    for name in [
        "c.png",
        "room.scn.ron",
        "show-Close-up.png",
        "t.png",
        "tree.png",
        "report",
    ] {
        assert!(made.iter().any(|made| made == name), "no {name}: {made:?}");
    }
}
