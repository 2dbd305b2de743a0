use super::super::error::{FileError, Place, Problem};
use super::super::folder::Folder;
use super::super::names::{Missing, Names};
use super::super::notes::Notes;
use super::glb;
use super::json::{Json, Marks};
use super::json_text::{json_bytes, mended, neither, parse_error};
use super::uri::{data_of, is_data, path_of};
use crate::io::Limits;
use serde_json::Value;
use std::borrow::Cow;
use std::cell::{OnceCell, RefCell};
use std::path::{Path, PathBuf};

/// Extensions that are read, those of whose parts nothing is left out included.
const READ: [&str; 12] = [
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_specular",
    "KHR_materials_unlit",
    "KHR_materials_transmission",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_texture_transform",
    "KHR_texture_basisu",
    "KHR_mesh_quantization",
    "EXT_mesh_gpu_instancing",
    "EXT_texture_webp",
    "MSFT_texture_dds",
];

/// How the names of extensions begin that change how things look, not their shape: without them a model can be shown.
const OF_LOOKS: [&str; 11] = [
    "KHR_materials_",
    "KHR_texture_",
    "KHR_technique",
    "KHR_lights_",
    "KHR_animation_",
    "KHR_xmp",
    "EXT_texture_",
    "EXT_lights_",
    "MSFT_texture_",
    "MSFT_lod",
    "ADOBE_materials_",
];

/// A parsed glTF file. The buffers that it refers to are read when they are needed.
pub(crate) struct Document {
    pub(super) file: PathBuf,
    pub(super) folder: Folder,
    pub(super) limits: Limits,
    root: Value,
    marks: Marks,
    buffers: Vec<OnceCell<Result<Bytes, Problem>>>,
    /// The binary part of the file.
    blob: Option<Vec<u8>>,
    /// What there is to say about it.
    pub(super) notes: RefCell<Notes>,
}

impl Document {
    /// Reads a `.gltf` or `.glb` file.
    pub fn read(file: &Path, folder: &Folder, limits: &Limits) -> Result<Self, FileError> {
        let Limits {
            file_bytes, memory, ..
        } = limits;
        let bytes = super::super::read_bytes_unless(file, *file_bytes, memory, neither)?;
        let parts = glb::parts(&bytes).map_err(|problem| FileError::new(file, problem))?;
        let mut notes = Notes::default();
        if !parts.fits {
            let what = "lengths of its parts that are not those of the file";
            notes.add(file, Place::Whole, what, "what is there is read");
        }
        let text = parts.json;
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
        // Some programs end it as they end a text in memory, or fill it up with zeros.
        let end = text.iter().rposition(|&byte| byte != 0);
        let text = &text[..end.map_or(0, |last| last + 1)];
        (limits.memory)
            .claim(json_bytes(text))
            .map_err(|problem| FileError::new(file, problem))?;
        let root = serde_json::from_slice(text).or_else(|error| {
            let note = |what: &str, instead| notes.add(file, Place::Whole, what, instead);
            // Nothing is mended that no JSON has in it, not even in its texts, and large files of it are soon refused.
            let is_other = |&byte: &u8| byte < b' ' && !byte.is_ascii_whitespace();
            let mended = match text.iter().any(is_other) {
                true => None,
                false => mended(text, note),
            };
            mended.ok_or_else(|| parse_error(file, text, &error))
        })?;
        let mut document = Self {
            file: file.to_path_buf(),
            folder: folder.clone(),
            limits: limits.clone(),
            root,
            marks: Marks::default(),
            buffers: Vec::new(),
            blob: parts.blob.map(<[u8]>::to_vec),
            notes: RefCell::new(notes),
        };
        drop(bytes);
        document.check_version()?;
        document.check_extensions()?;
        let buffers = document.json().list("buffers").len();
        document.buffers.resize_with(buffers, OnceCell::new);
        Ok(document)
    }

    /// This file and those that it names.
    pub fn files(&self) -> Vec<PathBuf> {
        let lists = ["buffers", "images"].into_iter();
        let values = lists.filter_map(|key| self.root.get(key)?.as_array());
        let uris = values
            .flatten()
            .filter_map(|value| value.get("uri")?.as_str());
        let beside = uris
            .filter(|uri| !is_data(uri))
            .filter_map(|uri| self.folder.resolve(&path_of(uri)).ok());
        beside.chain([self.file.clone()]).collect()
    }

    /// All of it.
    pub(super) fn json(&self) -> Json<'_> {
        Json::new(&self.root, &self.marks)
    }

    /// An error at a part of this file.
    pub(super) fn error(&self, part: impl Into<String>, problem: Problem) -> FileError {
        FileError::at(&self.file, Place::Part(part.into()), problem)
    }

    /// Says that a part of this file was not taken as it is.
    pub(super) fn note(&self, part: &str, what: impl AsRef<str>, instead: &'static str) {
        let place = Place::Part(part.to_owned());
        self.notes
            .borrow_mut()
            .add(&self.file, place, what, instead);
    }

    /// The same of something with a name.
    pub(super) fn note_named(
        &self,
        part: &str,
        what: impl AsRef<str>,
        name: &str,
        instead: &'static str,
    ) {
        let place = Place::Part(part.to_owned());
        let mut notes = self.notes.borrow_mut();
        notes.add_named(&self.file, place, what, name, instead);
    }

    /// Says that something which can be done without could not be read.
    ///
    /// # Errors
    /// The problem itself, where it is one of memory: nothing is opened in part for that.
    pub(super) fn do_without(
        &self,
        part: &str,
        what: &str,
        problem: Problem,
        instead: &'static str,
    ) -> Result<(), Problem> {
        if problem.is_of_memory() {
            return Err(problem);
        }
        self.note(part, format!("{what}: {problem}"), instead);
        Ok(())
    }

    /// Notes what stands in the parts that were read and was not read itself, whatever it is.
    pub(super) fn note_unread(&self) {
        let mut reported = Vec::new();
        self.json().for_each_unread(&mut |path, key| {
            reported.push(key.to_owned());
            self.note(path, format!("`{key}`, which is not read"), "left out");
        });
        for name in self.extensions("extensionsUsed") {
            let is_known = READ.contains(&name) || reported.iter().any(|key| key == name);
            if !is_known {
                let what = format!("the extension `{name}`, which is not read");
                self.note("extensionsUsed", what, "left out");
            }
        }
    }

    fn extensions(&self, key: &str) -> impl Iterator<Item = &str> {
        self.json().list(key).filter_map(Json::as_text)
    }

    /// Whether the file says that it has something of an extension.
    pub(super) fn uses(&self, extension: &str) -> bool {
        self.extensions("extensionsUsed")
            .any(|name| name == extension)
    }

    fn check_version(&self) -> Result<(), FileError> {
        let json = self.json();
        let version = json.get("asset").and_then(|asset| asset.text("version"));
        // The first version had objects where there are lists now.
        let is_first = json.get("meshes").is_some_and(|meshes| !meshes.is_list());
        let refuse = |text: String| Err(FileError::new(&self.file, Problem::Malformed(text)));
        match version {
            Some(version) if version == "2" || version.starts_with("2.") => Ok(()),
            None if !is_first && json.get("meshes").is_some() => {
                self.note("asset", "no version of glTF", "read as 2.0");
                Ok(())
            }
            None if !is_first => refuse("holds no meshes; is it a glTF file?".to_owned()),
            version => {
                let version = version.unwrap_or("1.0");
                refuse(format!(
                    "is glTF {version}, and only 2.0 is read; export it again"
                ))
            }
        }
    }

    fn check_extensions(&self) -> Result<(), FileError> {
        for name in self.extensions("extensionsRequired") {
            if READ.contains(&name) {
                continue;
            }
            if OF_LOOKS.iter().any(|start| name.starts_with(start)) {
                let what = format!("the required extension `{name}`, which is not read");
                self.note("extensionsRequired", what, "shown without");
                continue;
            }
            let problem = Problem::UnsupportedExtension(name.to_owned());
            return Err(FileError::new(&self.file, problem));
        }
        Ok(())
    }

    /// The bytes of a buffer view.
    pub(super) fn view(&self, index: usize) -> Result<View<'_>, Problem> {
        let missing = || Problem::Malformed(format!("there is no buffer view {index}"));
        let json = self
            .json()
            .element("bufferViews", index)
            .ok_or_else(missing)?;
        let number = json.index("buffer").ok_or_else(missing)?;
        let buffer = self.buffer(number)?;
        let offset = json.index("byteOffset").unwrap_or(0);
        let length = json.index("byteLength").ok_or_else(missing)?;
        let bytes = offset
            .checked_add(length)
            .and_then(|end| buffer.get(offset..end));
        let bytes = bytes.ok_or_else(|| match self.missing_bytes(number, buffer.len()) {
            Some(problem) => Problem::Malformed(format!("buffer {number}: {problem}")),
            None => Problem::Malformed(format!("buffer view {index} leaves its buffer")),
        })?;
        Ok(View {
            bytes,
            stride: json.index("byteStride").filter(|&stride| stride > 0),
        })
    }

    fn buffer(&self, index: usize) -> Result<&[u8], Problem> {
        let missing = || Problem::Malformed(format!("there is no buffer {index}"));
        let place = self.buffers.get(index).ok_or_else(missing)?;
        let read = place.get_or_init(|| {
            self.read_buffer(index).map_err(|problem| {
                if problem.is_of_memory() {
                    return problem;
                }
                Problem::Malformed(format!("buffer {index}: {problem}"))
            })
        });
        match read {
            Ok(Bytes::Own(bytes)) => Ok(bytes),
            Ok(Bytes::OfTheFile) => Ok(self.blob.as_deref().unwrap_or_default()),
            Err(problem) => Err(problem.clone()),
        }
    }

    fn read_buffer(&self, index: usize) -> Result<Bytes, Problem> {
        let missing = || Problem::Malformed("it is none".to_owned());
        let json = self.json().element("buffers", index).ok_or_else(missing)?;
        let bytes = match json.text("uri") {
            None => {
                let there = self.blob.as_ref().map_or(0, Vec::len);
                self.note_missing_bytes(index, there);
                return Ok(Bytes::OfTheFile);
            }
            Some(uri) if is_data(uri) => data_of(uri)
                .ok_or_else(|| Problem::Malformed("its data cannot be decoded".to_owned()))?,
            Some(uri) => {
                let path =
                    self.path(uri, &format!("buffer {index}"))
                        .map_err(|(missing, path)| match missing {
                            Missing::Outside => Problem::RefersOutside { path },
                            Missing::Nowhere => Problem::MissingFile { path },
                        })?;
                let file = self.folder.resolve(&path).map_err(|error| error.problem)?;
                super::super::read_bytes(&file, self.limits.file_bytes, &self.limits.memory)
                    .map_err(|error| error.problem)?
            }
        };
        self.note_missing_bytes(index, bytes.len());
        Ok(Bytes::Own(bytes))
    }

    /// What is wrong with a buffer that has fewer bytes than it says.
    fn missing_bytes(&self, buffer: usize, there: usize) -> Option<Problem> {
        let json = self.json().element("buffers", buffer)?;
        let claimed = json.index("byteLength")?;
        let text = || format!("{there} of {claimed} bytes are there");
        (there < claimed).then(|| Problem::Truncated(text()))
    }

    /// That matters only where what is missing is used.
    fn note_missing_bytes(&self, buffer: usize, there: usize) {
        if self.missing_bytes(buffer, there).is_some() {
            let what = "fewer bytes than it says";
            let instead = "what is there is read";
            self.note(&format!("buffer {buffer}"), what, instead);
        }
    }

    /// The path of the file that a URI means, from this file's folder.
    fn path(&self, uri: &str, part: &str) -> Result<String, (Missing, String)> {
        let mut names = Names::new(&self.folder);
        let decoded = path_of(uri);
        let found = names.find("", &decoded);
        // Some programs write names as they are, and some what a server would be asked for.
        let found = found.or_else(|missing| names.find("", uri).map_err(|_| missing));
        let found = found.or_else(|missing| {
            let (file, _) = uri.split_once('?').ok_or(missing)?;
            names.find("", &path_of(file)).map_err(|_| missing)
        });
        match found {
            Ok(found) => {
                if found.is_guess {
                    let what = "a file whose name is spelt otherwise:";
                    let instead = "the one that was found is read";
                    self.note_named(part, what, &found.path, instead);
                }
                Ok(found.path)
            }
            Err(missing) => Err((missing, decoded)),
        }
    }

    /// Where a texture's picture is: a file beside this one, or bytes inside it.
    pub(super) fn texture(&self, index: usize) -> Result<Picture<'_>, FileError> {
        let malformed =
            |part: String, text: &str| Err(self.error(part, Problem::Malformed(text.to_owned())));
        let Some(texture) = self.json().element("textures", index) else {
            return malformed(format!("texture {index}"), "there is none of that number");
        };
        let source = image_of(texture);
        let Some((source, image)) =
            source.and_then(|source| Some((source, self.json().element("images", source)?)))
        else {
            return malformed(format!("texture {index}"), "it has no picture");
        };
        let part = format!("image {source}");
        if let Some(view) = image.index("bufferView") {
            let view = self
                .view(view)
                .map_err(|problem| self.error(part, problem))?;
            return Ok(Picture::Inside(Cow::Borrowed(view.bytes)));
        }
        match image.text("uri") {
            Some(uri) if is_data(uri) => match data_of(uri) {
                Some(bytes) => Ok(Picture::Inside(Cow::Owned(bytes))),
                None => malformed(part, "its data cannot be decoded"),
            },
            Some(uri) => match self.path(uri, &part) {
                Ok(path) => Ok(Picture::Beside(path)),
                Err((Missing::Outside, path)) => {
                    Err(self.error(part, Problem::RefersOutside { path }))
                }
                Err((Missing::Nowhere, path)) => {
                    Err(self.error(part, Problem::MissingFile { path }))
                }
            },
            None => malformed(part, "it has neither a file nor data"),
        }
    }
}

/// The image that a texture shows. What several programs fall back on stands without an extension, and is preferred.
pub(super) fn image_of(texture: Json) -> Option<usize> {
    let of_extension = |name| texture.extension(name)?.index("source");
    texture
        .index("source")
        .or_else(|| of_extension("EXT_texture_webp"))
        .or_else(|| of_extension("MSFT_texture_dds"))
        .or_else(|| of_extension("KHR_texture_basisu"))
}

/// The bytes of a buffer.
enum Bytes {
    Own(Vec<u8>),
    /// The binary part of the file.
    OfTheFile,
}

/// A part of a buffer.
pub(super) struct View<'a> {
    pub bytes: &'a [u8],
    /// From one value to the next, where that is said.
    pub stride: Option<usize>,
}

/// Where a picture is.
pub(super) enum Picture<'a> {
    /// A path from the file's folder.
    Beside(String),
    /// A picture file inside it.
    Inside(Cow<'a, [u8]>),
}
