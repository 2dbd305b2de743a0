//! What stands where a file is to be written, and so how it is written there.

use super::super::error::{FileError, Problem};
use super::super::identity::{behind_links, folder_of, node};
use std::fs::{self, File, Metadata};
use std::io;
use std::path::{Path, PathBuf};

/// What stands at a path.
pub(super) enum Target {
    /// Nothing yet, or a file: it lies here, behind all links.
    File {
        place: PathBuf,
        old: Option<Metadata>,
    },
    /// A device or a pipe at this path.
    Stream(PathBuf),
    /// What standard output or standard error of this process leads to, as `/dev/stdout` does.
    Standard(File),
}

impl Target {
    /// Looks at what stands there; neither a pipe nor a device is opened. A file must be one that may be
    /// written.
    pub fn at(path: &Path) -> Result<Self, FileError> {
        let writing = |error: io::Error| FileError::writing(path, &error);
        if path.file_name().is_none() || ends_as_folder(path) {
            return Err(FileError::new(path, Problem::IsAFolder));
        }
        let old = match fs::metadata(path) {
            // It would be told only when everything is done.
            Err(error) if error.kind() == io::ErrorKind::InvalidFilename => {
                return Err(writing(error));
            }
            old => old.ok(),
        };
        if let Some(old) = &old {
            if old.is_dir() {
                return Err(FileError::new(path, Problem::IsAFolder));
            }
            if let Some(standard) = standard(old) {
                return Ok(Self::Standard(standard));
            }
            if !old.is_file() {
                return Ok(Self::Stream(path.to_path_buf()));
            }
            // Renaming asks the folder's permissions only: the file's own count too.
            File::options().write(true).open(path).map_err(writing)?;
        }
        let place = behind_links(path).map_err(writing)?;
        if !folder_of(&place).is_dir() {
            let problem = match file_on_the_way(&place) {
                Some(file) => Problem::FileAsFolder(file.display().to_string()),
                None => Problem::NoFolder,
            };
            return Err(FileError::new(path, problem));
        }
        Ok(Self::File { place, old })
    }
}

/// Whether a path is written as that of a folder. `file_name` does not see it.
fn ends_as_folder(path: &Path) -> bool {
    let last = path.as_os_str().as_encoded_bytes().last();
    last.is_some_and(|last| std::path::is_separator(char::from(*last)))
}

/// What would have to be a folder for something to lie at this path, and is none.
fn file_on_the_way(path: &Path) -> Option<&Path> {
    let there = path.ancestors().skip(1).find(|part| part.exists())?;
    (!there.is_dir()).then_some(there)
}

/// The stream of this process that is this file. A terminal or `/dev/null` may be opened by its name as well.
#[cfg(unix)]
fn standard(metadata: &Metadata) -> Option<File> {
    use std::os::fd::AsFd;
    let streams = [
        io::stdout().as_fd().try_clone_to_owned(),
        io::stderr().as_fd().try_clone_to_owned(),
    ];
    let mut streams = streams.into_iter().flatten().map(File::from);
    streams.find(|stream| {
        let of_stream = stream.metadata().ok();
        of_stream.is_some_and(|stream| node(&stream) == node(metadata))
    })
}

#[cfg(not(unix))]
fn standard(_: &Metadata) -> Option<File> {
    None
}

/// A new file beside the old one, which nobody can read who cannot read that.
pub(super) fn create(path: &Path, old: Option<&Metadata>) -> io::Result<File> {
    let mut options = File::options();
    options.write(true).read(true).create_new(true);
    #[cfg(unix)]
    if old.is_some() {
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    }
    #[cfg(not(unix))]
    let _ = old;
    options.open(path)
}

/// Gives a new file what the old one has, so that it can take its place: owner, group and mode. False where that
/// cannot be, or where the old one has more names, which would go on leading to it.
#[cfg(unix)]
pub(super) fn takes_place(new: &File, old: &Metadata) -> io::Result<bool> {
    use std::os::unix::fs::{MetadataExt, PermissionsExt, fchown};
    if old.nlink() > 1 {
        return Ok(false);
    }
    let now = new.metadata()?;
    let owner = (now.uid() != old.uid()).then(|| old.uid());
    let group = (now.gid() != old.gid()).then(|| old.gid());
    if (owner.is_some() || group.is_some()) && fchown(new, owner, group).is_err() {
        return Ok(false);
    }
    let mode = old.permissions().mode() & 0o7777;
    Ok(new
        .set_permissions(fs::Permissions::from_mode(mode))
        .is_ok())
}

#[cfg(not(unix))]
pub(super) fn takes_place(_: &File, _: &Metadata) -> io::Result<bool> {
    Ok(true)
}
