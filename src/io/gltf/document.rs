use super::super::error::{FileError, Place, Problem};
use super::super::folder::Folder;
use super::uri::{data_of, is_data, path_of};
use crate::io::Limits;
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// A parsed glTF file with the bytes of its buffers.
pub(crate) struct Document {
    pub(super) file: PathBuf,
    pub(super) folder: Folder,
    pub(super) limits: Limits,
    pub(super) gltf: gltf::Document,
    buffers: Vec<Vec<u8>>,
}

impl Document {
    /// Reads a `.gltf` or `.glb` file and the buffers that it refers to.
    pub fn read(file: &Path, folder: &Folder, limits: &Limits) -> Result<Self, FileError> {
        let bytes = super::super::read_bytes(file, limits.file_bytes, &limits.memory)?;
        check_header(&bytes)
            .and_then(|()| limits.memory.claim(json_bytes(&bytes)))
            .map_err(|problem| FileError::new(file, problem))?;
        let gltf::Gltf { document, blob } = gltf::Gltf::from_slice_without_validation(&bytes)
            .map_err(|error| parse_error(file, error))?;
        drop(bytes);
        validate(&document).map_err(|error| parse_error(file, error))?;
        let mut document = Self {
            file: file.to_path_buf(),
            folder: folder.clone(),
            limits: limits.clone(),
            gltf: document,
            buffers: Vec::new(),
        };
        document.check_json()?;
        document.read_buffers(blob)?;
        Ok(document)
    }

    /// This file and those that it names.
    pub fn files(&self) -> Vec<PathBuf> {
        let json = self.gltf.as_json();
        let buffers = json.buffers.iter().map(|buffer| buffer.uri.as_deref());
        let images = json.images.iter().map(|image| image.uri.as_deref());
        let uris = buffers.chain(images).flatten();
        let beside = uris
            .filter(|uri| !is_data(uri))
            .filter_map(|uri| self.folder.resolve(&path_of(uri)).ok());
        beside.chain([self.file.clone()]).collect()
    }

    /// An error at a part of this file.
    pub(super) fn error(&self, part: impl Into<String>, problem: Problem) -> FileError {
        FileError::at(&self.file, Place::Part(part.into()), problem)
    }

    /// The bytes of a buffer view.
    pub(super) fn view(&self, view: &gltf::buffer::View) -> Result<&[u8], Problem> {
        let buffer = self.buffers.get(view.buffer().index());
        let end = view.offset().checked_add(view.length());
        buffer
            .zip(end)
            .and_then(|(buffer, end)| buffer.get(view.offset()..end))
            .ok_or_else(|| {
                Problem::Truncated(format!("buffer view {} leaves its buffer", view.index()))
            })
    }

    /// Where a texture's picture is: a file beside this one, or bytes inside it.
    pub(super) fn texture(&self, texture: &gltf::Texture) -> Result<Picture<'_>, FileError> {
        let index = texture.source().index();
        let part = || format!("image {index}");
        // Not through `Image::source`, which takes for granted that one of the two is there.
        let image = self.gltf.as_json().images.get(index);
        let view = image.and_then(|image| image.buffer_view);
        if let Some(view) = view.and_then(|view| self.gltf.views().nth(view.value())) {
            let bytes = self.view(&view).map_err(|p| self.error(part(), p))?;
            return Ok(Picture::Inside(Cow::Borrowed(bytes)));
        }
        match image.and_then(|image| image.uri.as_deref()) {
            Some(uri) if is_data(uri) => match data_of(uri) {
                Some(bytes) => Ok(Picture::Inside(Cow::Owned(bytes))),
                None => {
                    let text = "its data is not base64".to_owned();
                    Err(self.error(part(), Problem::Malformed(text)))
                }
            },
            Some(uri) => Ok(Picture::Beside(path_of(uri))),
            None => {
                let text = "it has neither a file nor data".to_owned();
                Err(self.error(part(), Problem::Malformed(text)))
            }
        }
    }

    /// What the crate's own validation leaves to whoever follows an index.
    fn check_json(&self) -> Result<(), FileError> {
        let json = self.gltf.as_json();
        if !json.asset.version.starts_with("2.") {
            let version = &json.asset.version;
            let text = format!("is glTF {version}, and only 2.0 is read; export it again");
            return Err(FileError::new(&self.file, Problem::Malformed(text)));
        }
        let nodes = json.nodes.len() as u64;
        if nodes > self.limits.entities {
            let problem = Problem::TooMany {
                what: "nodes",
                count: nodes,
                limit: self.limits.entities,
            };
            return Err(FileError::new(&self.file, problem));
        }
        // `Camera::projection` takes for granted that the numbers of its type are there.
        use gltf::json::camera::Type;
        use gltf::json::validation::Checked;
        for (index, camera) in json.cameras.iter().enumerate() {
            let missing = match camera.type_ {
                Checked::Valid(Type::Perspective) if camera.perspective.is_none() => "perspective",
                Checked::Valid(Type::Orthographic) if camera.orthographic.is_none() => {
                    "orthographic"
                }
                _ => continue,
            };
            let text = format!("its {missing} numbers are missing");
            return Err(self.error(format!("camera {index}"), Problem::Malformed(text)));
        }
        Ok(())
    }

    fn read_buffers(&mut self, mut blob: Option<Vec<u8>>) -> Result<(), FileError> {
        let mut buffers = Vec::new();
        for (index, buffer) in self.gltf.as_json().buffers.iter().enumerate() {
            let part = || format!("buffer {index}");
            let bytes = match buffer.uri.as_deref() {
                None => blob.take().ok_or_else(|| {
                    let text = "the binary part of the file".to_owned();
                    self.error(part(), Problem::Truncated(text))
                })?,
                Some(uri) if is_data(uri) => data_of(uri).ok_or_else(|| {
                    let text = "its data is not base64".to_owned();
                    self.error(part(), Problem::Malformed(text))
                })?,
                Some(uri) => self.read_beside(&path_of(uri), part())?,
            };
            if (bytes.len() as u64) < buffer.byte_length.0 {
                let text = format!(
                    "{} of {} bytes are there",
                    bytes.len(),
                    buffer.byte_length.0
                );
                return Err(self.error(part(), Problem::Truncated(text)));
            }
            buffers.push(bytes);
        }
        self.buffers = buffers;
        Ok(())
    }

    fn read_beside(&self, path: &str, part: String) -> Result<Vec<u8>, FileError> {
        let path = path.to_owned();
        let Ok(file) = self.folder.resolve(&path) else {
            return Err(self.error(part, Problem::RefersOutside { path }));
        };
        if !file.exists() {
            return Err(self.error(part, Problem::MissingFile { path }));
        }
        super::super::read_bytes(&file, self.limits.file_bytes, &self.limits.memory)
    }
}

/// Where a picture is.
pub(super) enum Picture<'a> {
    /// A path from the file's folder.
    Beside(String),
    /// A PNG or JPEG inside it.
    Inside(Cow<'a, [u8]>),
}

/// The crate's validation, which follows the index of `POSITION` before it has checked it.
fn validate(document: &gltf::Document) -> Result<(), gltf::Error> {
    use gltf::json::Path;
    use gltf::json::validation::{Error, Validate};
    let json = document.as_json();
    let mut errors = Vec::new();
    let primitives = json.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let mut accessors = primitives.flat_map(|primitive| primitive.attributes.values());
    if accessors.any(|accessor| json.get(*accessor).is_none()) {
        let path = Path::new()
            .field("meshes")
            .field("primitives")
            .field("attributes");
        errors.push((path, Error::IndexOutOfBounds));
    } else {
        json.validate(json, Path::new, &mut |path, error| {
            errors.push((path(), error));
        });
    }
    if errors.is_empty() {
        Ok(())
    } else {
        Err(gltf::Error::Validation(errors))
    }
}

/// A binary file's header holds the length of the whole file. `gltf` takes for granted that the header at
/// least is part of it.
fn check_header(bytes: &[u8]) -> Result<(), Problem> {
    const HEADER: u32 = 12;
    let Some((b"glTF", rest)) = bytes.split_at_checked(4) else {
        return Ok(());
    };
    let length = rest.get(4..8).and_then(|bytes| bytes.try_into().ok());
    match length.map(u32::from_le_bytes) {
        Some(length) if length < HEADER => {
            let text = format!("its header says that the file is {length} bytes long");
            Err(Problem::Malformed(text))
        }
        _ => Ok(()),
    }
}

/// What the JSON of a file becomes in memory: for each object in it the largest that there is, and its texts. Data that
/// is written as text has no braces.
fn json_bytes(bytes: &[u8]) -> u64 {
    const LARGEST: u64 = 1000;
    let json = match bytes.split_at_checked(20) {
        Some((header, rest)) if header.starts_with(b"glTF") => {
            let length = header[12..16].iter().rev();
            let length = length.fold(0, |sum, &byte| sum << 8 | usize::from(byte));
            rest.get(..length).unwrap_or(rest)
        }
        _ => bytes,
    };
    let objects = json.iter().filter(|&&byte| byte == b'{').count();
    LARGEST * objects as u64 + json.len() as u64
}

fn parse_error(file: &Path, error: gltf::Error) -> FileError {
    use gltf::binary::Error as Glb;
    use gltf::json::validation::Error as Invalid;
    let problem = match error {
        gltf::Error::Validation(errors) => match errors.into_iter().next() {
            Some((path, Invalid::Unsupported)) => Problem::UnsupportedExtension(path.to_string()),
            Some((path, Invalid::IndexOutOfBounds)) => Problem::Malformed(format!(
                "{path} names something that the file does not hold"
            )),
            Some((path, error)) => Problem::Malformed(format!("{path}: {error}")),
            None => Problem::Malformed("is not valid glTF".into()),
        },
        gltf::Error::Binary(Glb::Length {
            length,
            length_read,
        }) => Problem::Truncated(format!("{length_read} of {length} bytes are there")),
        gltf::Error::Binary(Glb::ChunkLength {
            length,
            length_read,
            ..
        }) => Problem::Truncated(format!(
            "{length_read} of a part's {length} bytes are there"
        )),
        gltf::Error::Binary(Glb::Io(_)) => Problem::Truncated("the header is incomplete".into()),
        gltf::Error::Deserialize(error) if error.is_eof() => {
            Problem::Truncated("the JSON is incomplete".into())
        }
        gltf::Error::Deserialize(error) => {
            let place = Place::LineColumn(error.line(), error.column());
            let text = error.to_string();
            let text = text.split(" at line").next().unwrap_or_default().to_owned();
            return FileError::at(file, place, Problem::Malformed(text));
        }
        other => Problem::Malformed(other.to_string()),
    };
    FileError::new(file, problem)
}
