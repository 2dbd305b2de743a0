//! Writing a file so that the old one stays until the new one is complete.
//!
//! | what stands there | how it is written |
//! |---|---|
//! | nothing, or a file | completely under another name beside it, then renamed; it keeps owner, group and mode |
//! | a symbolic link | what it leads to is written so; the link stays |
//! | a file with several names, or of an owner that cannot be given | completely beside it, then copied into it |
//! | a device, a pipe, `/dev/stdout` | in memory, then into it |
//!
//! Several files that belong together are all staged first, and then take their places one after the other:
//! where anything fails until then, such as a disk that is full, none of them has changed.

mod leftovers;
mod output;
mod space;
mod target;

pub(crate) use output::Output;
pub(crate) use space::{check_space, free_bytes};

use super::error::FileError;
use super::identity::folder_of;
use leftovers::{remove_leftovers, temporary_name};
use output::check_room;
use std::fs::{self, File};
use std::io::{self, Cursor, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use target::{Target, create, takes_place};

/// Writes a file through `write`, and puts it into its place. Where anything fails nothing is left behind,
/// and a file that was there stays as it was.
///
/// A process that is killed leaves what it had written so far; the next one that writes the same file
/// removes that. It knows by a lock that the system takes away from who is gone.
pub(crate) fn replace_file(
    path: &Path,
    write: impl FnOnce(&mut Output) -> io::Result<()>,
) -> Result<(), FileError> {
    Staged::new(path, write)?.commit()
}

/// Checks that a file can be written, before the work whose result it shall hold is done.
pub fn check_writable(path: &Path) -> Result<(), FileError> {
    let Target::File { place, .. } = Target::at(path)? else {
        return Ok(());
    };
    let temporary = temporary_beside(&place);
    File::create_new(&temporary)
        .and_then(|_| fs::remove_file(&temporary))
        .map_err(|error| FileError::writing(path, &error))
}

fn temporary_beside(place: &Path) -> PathBuf {
    folder_of(place).join(temporary_name(place.file_name().unwrap_or_default()))
}

/// A file whose content is complete, and that has not taken its place yet. Dropped before, it leaves nothing.
pub(crate) struct Staged {
    /// As errors name it.
    path: PathBuf,
    content: Content,
}

enum Content {
    Renamed(Temporary, PathBuf),
    /// Into the file that is there.
    Copied(Temporary, PathBuf),
    Streamed(File, Vec<u8>),
    /// Opened only to be written: who reads a pipe takes its closing for the end.
    Opened(PathBuf, Vec<u8>),
}

impl Staged {
    /// Writes the content through `write`, on the disk that it will be on.
    pub fn new(
        path: &Path,
        write: impl FnOnce(&mut Output) -> io::Result<()>,
    ) -> Result<Self, FileError> {
        let writing = |error: io::Error| FileError::writing(path, &error);
        let content = match Target::at(path)? {
            Target::File { place, old } => {
                remove_leftovers(&place);
                let temporary = Temporary::create(&place, |path| create(path, old.as_ref()));
                let temporary = temporary.map_err(writing)?;
                temporary.fill(write).map_err(writing)?;
                let renames = match &old {
                    Some(old) => takes_place(&temporary.file, old).map_err(writing)?,
                    None => true,
                };
                match renames {
                    true => Content::Renamed(temporary, place),
                    false => Content::Copied(temporary, place),
                }
            }
            Target::Stream(place) => Content::Opened(place, in_memory(write).map_err(writing)?),
            Target::Standard(file) => Content::Streamed(file, in_memory(write).map_err(writing)?),
        };
        Ok(Self {
            path: path.to_path_buf(),
            content,
        })
    }

    /// Lets it take its place.
    pub fn commit(self) -> Result<(), FileError> {
        let Self { path, content } = self;
        let result = match content {
            Content::Renamed(temporary, place) => temporary.rename(&place),
            Content::Copied(mut temporary, place) => copy_into(&mut temporary.file, &place),
            Content::Streamed(mut file, bytes) => write_on(&mut file, &bytes),
            Content::Opened(place, bytes) => (File::options().write(true).open(place))
                .and_then(|mut file| file.write_all(&bytes)),
        };
        result.map_err(|error| FileError::writing(&path, &error))
    }
}

fn in_memory(write: impl FnOnce(&mut Output) -> io::Result<()>) -> io::Result<Vec<u8>> {
    let mut output = Output::Memory(Cursor::default());
    write(&mut output)?;
    match output {
        Output::Memory(memory) => Ok(memory.into_inner()),
        Output::File(_) => Ok(Vec::new()),
    }
}

fn write_on(file: &mut File, bytes: &[u8]) -> io::Result<()> {
    if file.metadata()?.is_file() {
        check_room(file, bytes.len() as u64)?;
    }
    file.write_all(bytes)
}

/// Copies a whole file into another. What the other one grows by comes first: where there is no room for that, it
/// gets its old length back, and has not changed.
fn copy_into(from: &mut File, place: &Path) -> io::Result<()> {
    let mut into = File::options().write(true).open(place)?;
    let (old, new) = (into.metadata()?.len(), from.metadata()?.len());
    let mut copy = |start: u64, length: u64| -> io::Result<()> {
        from.seek(SeekFrom::Start(start))?;
        into.seek(SeekFrom::Start(start))?;
        io::copy(&mut from.take(length), &mut into).map(drop)
    };
    if let Err(error) = copy(old, new.saturating_sub(old)) {
        // The first error is the one to report.
        let _ = into.set_len(old);
        return Err(error);
    }
    copy(0, old.min(new))?;
    into.set_len(new)?;
    into.sync_all()
}

/// A file under a temporary name, which goes when this is dropped.
struct Temporary {
    path: PathBuf,
    /// Locked as long as it is open, so that nobody takes it for one that was left.
    file: File,
    renamed: bool,
}

impl Temporary {
    fn create(place: &Path, create: impl FnOnce(&Path) -> io::Result<File>) -> io::Result<Self> {
        let path = temporary_beside(place);
        let file = create(&path)?;
        // Where files cannot be locked they are written all the same; leftovers stay there.
        let _ = file.try_lock();
        Ok(Self {
            path,
            file,
            renamed: false,
        })
    }

    fn fill(&self, write: impl FnOnce(&mut Output) -> io::Result<()>) -> io::Result<()> {
        let mut output = Output::to_file(self.file.try_clone()?);
        write(&mut output)?;
        output.flush()?;
        self.file.sync_all()
    }

    fn rename(mut self, place: &Path) -> io::Result<()> {
        fs::rename(&self.path, place)?;
        self.renamed = true;
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.renamed {
            // What cannot be tidied up adds nothing to the error that is reported.
            let _ = fs::remove_file(&self.path);
        }
    }
}

#[cfg(test)]
mod tests;
