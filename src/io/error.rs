use super::budget::Size;
use std::fmt::{self, Write};
use std::path::{Path, PathBuf};

/// What went wrong with a file: which one, where in it, and what would help. One line, whatever the names in
/// the file hold.
#[derive(Debug)]
pub struct FileError {
    /// The file as the user or the file that refers to it named it.
    pub file: PathBuf,
    /// Where in it.
    pub place: Place,
    /// What is wrong there.
    pub problem: Problem,
}

impl Problem {
    /// More memory would be needed than a scene may take: nothing is opened in part for that.
    pub(crate) fn is_of_memory(&self) -> bool {
        matches!(self, Self::OutOfMemory { .. })
    }
}

impl FileError {
    /// A problem with a file as a whole.
    pub fn new(file: impl Into<PathBuf>, problem: Problem) -> Self {
        Self::at(file, Place::Whole, problem)
    }

    /// A problem at a place in a file.
    pub fn at(file: impl Into<PathBuf>, place: Place, problem: Problem) -> Self {
        Self {
            file: file.into(),
            place,
            problem,
        }
    }

    /// What the operating system said about a file that was to be read.
    pub(crate) fn reading(file: &Path, error: &std::io::Error) -> Self {
        let problem = match error.kind() {
            std::io::ErrorKind::NotFound => Problem::NotFound,
            std::io::ErrorKind::IsADirectory => Problem::IsAFolder,
            _ => Problem::Unreadable(error.to_string()),
        };
        Self::new(file, problem)
    }

    /// What the operating system said about a file that was to be written.
    pub(crate) fn writing(file: &Path, error: &std::io::Error) -> Self {
        Self::new(file, Problem::Unwritable(error.to_string()))
    }
}

impl std::error::Error for FileError {}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            file,
            place,
            problem,
        } = self;
        write!(OneLine(f), "{}{place}: {problem}", file.display())
    }
}

/// Writes on, with a space for each control character: line breaks, and what steers a terminal.
pub(super) struct OneLine<'a, 'b>(pub &'a mut fmt::Formatter<'b>);

impl fmt::Write for OneLine<'_, '_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for (i, part) in text.split(char::is_control).enumerate() {
            if i > 0 {
                self.0.write_char(' ')?;
            }
            self.0.write_str(part)?;
        }
        Ok(())
    }
}

/// A place in a file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Place {
    /// The file as a whole.
    #[default]
    Whole,
    /// A line, counted from 1.
    Line(u64),
    /// A line and a column, counted from 1.
    LineColumn(usize, usize),
    /// A part with a name, for example `mesh 2 "lid", primitive 0`.
    Part(String),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole => Ok(()),
            Self::Line(line) => write!(f, ":{line}"),
            Self::LineColumn(line, column) => write!(f, ":{line}:{column}"),
            Self::Part(part) => write!(f, ": {part}"),
        }
    }
}

/// What can be wrong with a file, and what to do about it.
#[derive(Debug, Clone, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum Problem {
    #[error("no such file; check the name and the folder")]
    NotFound,
    #[error(
        "neither a file nor a built-in scene; `glassbox scenes` lists the built-in ones: {known}"
    )]
    NoSuchScene { known: String },
    #[error("is a folder; name a file in it")]
    IsAFolder,
    #[error("cannot be read: {0}")]
    Unreadable(String),
    #[error("cannot be written: {0}; choose another place or change its permissions")]
    Unwritable(String),
    #[error(
        "needs {needs}, and {free} are free on its disk; make room there, or choose another place"
    )]
    NoSpace { needs: Size, free: Size },
    #[error(
        "may take up to {most}, and {free} are free on its disk; make room there, or choose another place"
    )]
    LittleSpace { most: Size, free: Size },
    #[error("the folder does not exist; create it first")]
    NoFolder,
    #[error("`{0}` is a file and no folder; choose another place")]
    FileAsFolder(String),
    #[error("is the same file as `{input}`, which is read here; write under another name")]
    IsRead { input: String },
    #[error("is the same file as `{other}`, which is written too; give one of them another name")]
    WrittenTwice { other: String },
    #[error("{0}; choose another name")]
    Unnameable(String),
    #[error("files that end in `{extension}` are not {wanted}")]
    UnknownExtension {
        extension: String,
        wanted: &'static str,
    },
    #[error("is neither a file nor a folder but a pipe or a device; name a file")]
    NotAFile,
    #[error("is empty")]
    Empty,
    #[error("is packed ({0}); unpack it first")]
    Packed(&'static str),
    #[error("is {0} in place of a file; get the file itself")]
    StandsForAFile(&'static str),
    #[error("{size} bytes, and the limit is {limit}; split it up")]
    TooLarge { size: u64, limit: u64 },
    #[error(
        "points outside the folder of the file that names it; copy it there, or use --allow-outside"
    )]
    Outside,
    #[error(
        "refers to `{path}`, which points outside this file's folder; copy it there, or use --allow-outside"
    )]
    RefersOutside { path: String },
    #[error("`{path}` does not exist; put it beside this file or correct the name")]
    MissingFile { path: String },
    #[error("{0}")]
    Malformed(String),
    #[error("ends too early: {0}; get a complete copy")]
    Truncated(String),
    #[error("was cut off: what is missing is grey; get a complete copy")]
    CutShort,
    #[error("is damaged ({0}): what could not be decoded is grey; get a complete copy")]
    DecodedInPart(String),
    #[error("{what} {index} is used, and there are {count}; the file is damaged")]
    IndexOutOfRange {
        what: &'static str,
        index: String,
        count: usize,
    },
    #[error("{what} is not a finite number; repair the mesh where it was made")]
    NotFinite { what: String },
    #[error("{what} is {value}, and must be {range}")]
    OutOfRange {
        what: Box<str>,
        value: Box<str>,
        range: Box<str>,
    },
    #[error("RenderSettings: {0}")]
    Setting(Box<crate::scene::RangeProblem>),
    #[error("holds no triangles")]
    NoTriangles,
    #[error("holds {count} points and no triangles; have the program that made it build a surface")]
    PointsAlone { count: u64 },
    #[error("no mesh named `{name}`; it has {known}")]
    NoSuchMesh { name: String, known: String },
    #[error("no picture `{name}`; it has {count}, counted from texture0")]
    NoSuchTexture { name: String, count: usize },
    #[error("{0}")]
    Builtin(String),
    #[error("{count} {what}, and the limit is {limit}")]
    TooMany {
        what: &'static str,
        count: u64,
        limit: u64,
    },
    #[error(
        "{width}x{height} pixels, and the limit is {limit} together and 65536 a side; scale the picture down"
    )]
    PictureTooLarge { width: u64, height: u64, limit: u64 },
    #[error(
        "{width}x{height} pixels, and files of this format have at most {limit} a side; write a .png or .exr"
    )]
    PictureTooLong { width: u64, height: u64, limit: u64 },
    #[error("a picture of {width}x{height} pixels has no pixels; both must be at least 1")]
    PictureEmpty { width: u32, height: u32 },
    #[error("{given} pixels were given for a picture of {width}x{height}")]
    PictureSize {
        width: u32,
        height: u32,
        given: usize,
    },
    #[error(
        "was written by a newer Glassbox (file version {found}, this program reads up to {known}); update Glassbox"
    )]
    NewerVersion { found: u32, known: u32 },
    #[error("says no `FileVersion`; is it a Glassbox scene?")]
    NoVersion,
    #[error("`{name}` is not a component that Glassbox scenes keep; remove it or update Glassbox")]
    UnknownComponent { name: String },
    #[error("two entities carry SceneId {0}; give one of them another number")]
    DuplicateId(u64),
    #[error("refers to entity {0}, which the file does not hold")]
    NoSuchEntity(String),
    #[error("the extension {0} is required and not supported; export without it")]
    UnsupportedExtension(String),
    #[error(
        "needs {needs} of memory, and {left} are left of the {whole} that a scene may take; make it smaller, or allow more with --memory"
    )]
    OutOfMemory {
        needs: Size,
        left: Size,
        whole: Size,
    },
    #[error("{0}; correct the numbers of the shape")]
    Shape(String),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_one_line_whatever_the_names_in_the_file_hold() {
        let problem = Problem::UnknownComponent {
            name: "be(\n),\x1b[2J".into(),
        };
        let error = FileError::at("a\nb.scn.ron", Place::LineColumn(3, 19), problem);
        assert!(
            error
                .to_string()
                .starts_with("a b.scn.ron:3:19: `be( ), [2J` is not"),
            "{error}"
        );
    }
}
