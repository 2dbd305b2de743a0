use super::*;

pub fn write(path: &Path, text: &str) {
    let written = replace_file(path, |output| output.write_all(text.as_bytes()));
    written.unwrap_or_else(|error| panic!("{error}"));
}

pub fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().flatten();
    let mut names: Vec<String> = entries
        .map(|entry| entry.file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn what_was_staged_and_does_not_take_its_place_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    write(&path, "old");
    let staged = Staged::new(&path, |output| output.write_all(b"new")).unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    drop(staged);
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    assert_eq!(names(folder.path()), ["a"]);
}

#[cfg(unix)]
mod unix {
    use super::*;
    use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt, chown, symlink};

    #[test]
    fn the_mode_of_a_file_that_is_replaced_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        for mode in [0o600, 0o666, 0o640, 0o755] {
            fs::write(&path, "old").unwrap();
            fs::set_permissions(&path, fs::Permissions::from_mode(mode)).unwrap();
            write(&path, "new");
            let now = fs::metadata(&path).unwrap().mode() & 0o7777;
            assert_eq!(now, mode, "{now:o} instead of {mode:o}");
            assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        }
    }

    #[test]
    fn the_owner_of_a_file_that_is_replaced_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "old").unwrap();
        if chown(&path, Some(1234), Some(1235)).is_err() {
            // Only root gives files away.
            return;
        }
        write(&path, "new");
        let now = fs::metadata(&path).unwrap();
        assert_eq!((now.uid(), now.gid()), (1234, 1235));
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    }

    #[test]
    fn what_a_symbolic_link_leads_to_is_written_and_the_link_stays() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("there")).unwrap();
        fs::write(at("there/old"), "old").unwrap();
        for (link, to) in [("a", "there/old"), ("b", "there/new"), ("c", "a")] {
            symlink(to, at(link)).unwrap();
            write(&at(link), link);
            assert_eq!(fs::read_link(at(link)).unwrap(), Path::new(to));
            assert_eq!(fs::read_to_string(at(link)).unwrap(), link);
        }
        assert_eq!(names(&at("there")), ["new", "old"]);
        assert_eq!(fs::read_to_string(at("there/old")).unwrap(), "c");
        symlink("gone/x", at("d")).unwrap();
        let error = replace_file(&at("d"), |_| Ok(())).unwrap_err().to_string();
        assert!(error.contains("folder does not exist"), "{error}");
    }

    #[test]
    fn a_file_with_two_names_keeps_both() {
        let folder = tempfile::tempdir().unwrap();
        let (a, b) = (folder.path().join("a"), folder.path().join("b"));
        fs::write(&a, "old text").unwrap();
        fs::hard_link(&a, &b).unwrap();
        for text in ["longer than the old text", "short", ""] {
            write(&a, text);
            assert_eq!(fs::read_to_string(&b).unwrap(), text);
        }
        assert_eq!(fs::metadata(&a).unwrap().nlink(), 2);
        assert_eq!(names(folder.path()), ["a", "b"]);
    }

    #[test]
    fn a_file_with_two_names_stays_as_it_is_where_writing_fails() {
        let folder = tempfile::tempdir().unwrap();
        let (a, b) = (folder.path().join("a"), folder.path().join("b"));
        fs::write(&a, "old").unwrap();
        fs::hard_link(&a, &b).unwrap();
        let full = |output: &mut Output| {
            output.write_all(b"new and longer")?;
            Err(io::ErrorKind::StorageFull.into())
        };
        assert!(replace_file(&a, full).is_err());
        assert_eq!(fs::read_to_string(&b).unwrap(), "old");
        assert_eq!(names(folder.path()), ["a", "b"]);
    }

    #[test]
    fn a_device_is_written_to_and_stays_one() {
        let folder = tempfile::tempdir().unwrap();
        for (number, shared, takes_it) in [("3", "/dev/null", true), ("7", "/dev/full", false)] {
            // One of the test's own where that can be had: nobody else's shall be at stake.
            let own = folder.path().join(number);
            let mut make = std::process::Command::new("mknod");
            let made = make.arg(&own).args(["c", "1", number]).output();
            let is_own = made.is_ok_and(|made| made.status.success());
            let path = if is_own { &*own } else { Path::new(shared) };
            check_writable(path).unwrap_or_else(|error| panic!("{error}"));
            let written = replace_file(path, |output| output.write_all(b"text"));
            assert_eq!(written.is_ok(), takes_it, "{shared}");
            let kind = fs::symlink_metadata(path).unwrap().file_type();
            assert!(kind.is_char_device(), "{shared} has become {kind:?}");
        }
    }

    #[test]
    fn a_pipe_is_written_to_and_what_is_sought_in_arrives_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&path).status();
        assert!(made.is_ok_and(|status| status.success()), "mkfifo");
        // Nobody reads yet: that must not be waited for.
        check_writable(&path).unwrap_or_else(|error| panic!("{error}"));
        let from = path.clone();
        let reader = std::thread::spawn(move || fs::read_to_string(from).unwrap());
        let written = replace_file(&path, |output| {
            output.write_all(b"_bc")?;
            output.seek(SeekFrom::Start(0))?;
            output.write_all(b"a")
        });
        written.unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(reader.join().unwrap(), "abc");
        let kind = fs::symlink_metadata(&path).unwrap().file_type();
        assert!(kind.is_fifo(), "it has become {kind:?}");
        assert_eq!(names(folder.path()), ["pipe"]);
    }

    #[test]
    fn a_file_that_may_not_be_written_is_not_replaced_either() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
        if File::options().write(true).open(&path).is_ok() {
            // Root may write everything.
            return;
        }
        let error = check_writable(&path).unwrap_err().to_string();
        assert!(error.contains("cannot be written"), "{error}");
        assert!(replace_file(&path, |_| Ok(())).is_err());
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    }
}
