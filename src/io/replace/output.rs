//! What a file's content is written into.

use std::fs::File;
use std::io::{self, BufWriter, Cursor, Seek, SeekFrom, Write};

/// A file, or memory where what is written at last cannot be sought in.
pub(crate) enum Output {
    File(BufWriter<Bounded>),
    Memory(Cursor<Vec<u8>>),
}

impl Output {
    pub(super) fn to_file(file: File) -> Self {
        let limit = size_limit();
        Self::File(BufWriter::new(Bounded {
            file,
            limit,
            position: 0,
        }))
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.write(bytes),
            Self::Memory(memory) => memory.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::File(file) => file.flush(),
            Self::Memory(memory) => memory.flush(),
        }
    }
}

impl Seek for Output {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match self {
            Self::File(file) => file.seek(to),
            Self::Memory(memory) => memory.seek(to),
        }
    }
}

/// A file that ends where the system lets files of this process end. Unix ends a process that writes on
/// from there by a signal, SIGXFSZ, and nobody would read why.
pub(crate) struct Bounded {
    file: File,
    /// In bytes.
    limit: u64,
    position: u64,
}

impl Write for Bounded {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let room = self.limit.saturating_sub(self.position);
        if room == 0 && !bytes.is_empty() {
            return Err(too_large(self.limit));
        }
        let fits = bytes.len().min(usize::try_from(room).unwrap_or(usize::MAX));
        let written = self.file.write(&bytes[..fits])?;
        self.position += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for Bounded {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.position = self.file.seek(to)?;
        Ok(self.position)
    }
}

fn too_large(limit: u64) -> io::Error {
    let text = format!("files of this process may have {limit} bytes (ulimit -f)");
    io::Error::new(io::ErrorKind::FileTooLarge, text)
}

/// Refuses to write so many bytes on from where a file of this process is.
pub(super) fn check_room(file: &mut File, bytes: u64) -> io::Result<()> {
    let limit = size_limit();
    if limit == u64::MAX || file.stream_position()?.saturating_add(bytes) <= limit {
        Ok(())
    } else {
        Err(too_large(limit))
    }
}

/// The largest size in bytes that a file may get by this process; asked each time, because another
/// process can change it.
#[cfg(unix)]
fn size_limit() -> u64 {
    use rustix::process::{Resource, getrlimit};
    getrlimit(Resource::Fsize).current.unwrap_or(u64::MAX)
}

#[cfg(not(unix))]
fn size_limit() -> u64 {
    u64::MAX
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_passes_the_limit_is_refused_and_seeking_back_is_not() {
        let mut file = Bounded {
            file: tempfile::tempfile().unwrap(),
            limit: 10,
            position: 0,
        };
        file.write_all(b"0123456789").unwrap();
        let error = file.write_all(b"x").unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::FileTooLarge, "{error}");
        assert!(error.to_string().contains("10 bytes"), "{error}");
        file.seek(SeekFrom::Start(2)).unwrap();
        file.write_all(b"abc").unwrap();
        assert!(file.write_all(b"abcdefgh").is_err());
        assert_eq!(file.file.metadata().unwrap().len(), 10);
    }
}
