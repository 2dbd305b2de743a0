use super::super::error::{FileError, Problem};
use super::super::file_name::{encoded, of_file, split_fragment};
use super::super::folder::Folder;
use super::super::model::{Model, Node};
use super::super::picture::{PictureUse, cut_short, decode_picture, read_picture};
use super::document::{Document, Picture};
use super::lamps::{Lamp, camera_of, lamp_of};
use super::material::{has_alpha, phong_of};
use super::primitive::{mesh_name, read_primitive};
use crate::io::{Limits, open_regular};
use crate::scene::{Phong, TextureSource};
use bevy::image::Image;
use bevy::math::{Mat4, Quat, Vec3};
use bevy::transform::components::Transform;
use std::io::BufReader;
use std::path::Path;

/// Reads a glTF or GLB file: the default scene, or the first, or all nodes where there is none.
///
/// Meshes are called `Mesh0/Primitive0`, by their indices, because names need not be unique.
/// The texture coordinates are those of the base colour's picture, with its transform applied.
pub(crate) fn read_gltf(file: &Path, folder: &Folder, limits: &Limits) -> Result<Model, FileError> {
    let document = Document::read(file, folder, limits)?;
    let mut model = Model {
        files: document.files(),
        ..Model::default()
    };
    let gltf = &document.gltf;
    for material in gltf.materials() {
        let name = material.name().map(str::to_owned);
        let name = name.unwrap_or_else(|| format!("material {}", model.materials.len()));
        let phong = material_of(&document, &material, &name, &mut model.notes)?;
        model.materials.push((name, phong));
    }
    for mesh in gltf.meshes() {
        for primitive in mesh.primitives() {
            let name = mesh_name(&mesh, &primitive);
            let loaded = read_primitive(&document, &primitive, &name, &mut model.notes)
                .map_err(|problem| document.error(name.clone(), problem))?;
            if let Some(mesh) = loaded {
                model.meshes.insert(name, mesh);
            }
        }
    }
    read_nodes(&document, &mut model)?;
    for (what, count) in [
        ("animations", gltf.animations().count()),
        ("skins", gltf.skins().count()),
    ] {
        if count > 0 {
            model.notes.push(format!("{count} {what} were left out"));
        }
    }
    if model.meshes.is_empty() {
        return Err(FileError::new(file, Problem::NoTriangles));
    }
    Ok(model)
}

/// Reads a picture of a file: `part` is `texture` and the index of a texture. What is wrong with one that can be shown
/// goes to the notes.
pub(crate) fn read_texture(
    document: &Document,
    part: &str,
    usage: PictureUse,
    notes: &mut Vec<FileError>,
) -> Result<Image, FileError> {
    let (file, limits) = (&document.file, &document.limits);
    let index = part.strip_prefix("texture").and_then(|n| n.parse().ok());
    let Some(texture) = index.and_then(|index| document.gltf.textures().nth(index)) else {
        let name = part.to_owned();
        let count = document.gltf.textures().count();
        return Err(FileError::new(file, Problem::NoSuchTexture { name, count }));
    };
    match document.texture(&texture)? {
        Picture::Beside(path) => {
            let path = document.folder.resolve(&path)?;
            let picture = read_picture(&path, usage, limits)?;
            notes.extend(cut_short(&path, BufReader::new(open_regular(&path)?)));
            Ok(picture)
        }
        Picture::Inside(bytes) => {
            let name = format!("{}#{part}", file.display());
            let name = Path::new(&name);
            let picture = decode_picture(name, &bytes, usage, limits)?;
            notes.extend(cut_short(name, &*bytes));
            Ok(picture)
        }
    }
}

fn material_of(
    document: &Document,
    material: &gltf::Material,
    name: &str,
    notes: &mut Vec<String>,
) -> Result<Phong, FileError> {
    let mut phong = phong_of(material);
    let pbr = material.pbr_metallic_roughness();
    if let Some(info) = pbr.base_color_texture() {
        let source = texture_source(document, &info.texture())?;
        if pbr.base_color_factor()[..3]
            .iter()
            .any(|&factor| factor != 1.0)
        {
            notes.push(format!(
                "material `{name}`: its picture takes the place of its colour"
            ));
        }
        if has_alpha(material) {
            let has_part = !split_fragment(&source).1.is_empty();
            let separator = if has_part { "." } else { "#" };
            let path = format!("{source}{separator}alpha");
            phong.opacity_map = Some(TextureSource { path });
        }
        phong.diffuse_map = Some(TextureSource { path: source });
        let sampler = info.texture().sampler();
        use gltf::texture::WrappingMode::Repeat;
        if sampler.wrap_s() != Repeat || sampler.wrap_t() != Repeat {
            notes.push(format!("material `{name}`: its picture repeats here"));
        }
    }
    for (what, is_there) in [
        (
            "metallic and roughness",
            pbr.metallic_roughness_texture().is_some(),
        ),
        ("normal", material.normal_texture().is_some()),
        ("occlusion", material.occlusion_texture().is_some()),
        ("emissive", material.emissive_texture().is_some()),
    ] {
        if is_there {
            notes.push(format!(
                "material `{name}`: its {what} picture was left out"
            ));
        }
    }
    Ok(phong)
}

/// How scenes name the picture of a texture.
fn texture_source(document: &Document, texture: &gltf::Texture) -> Result<String, FileError> {
    match document.texture(texture)? {
        Picture::Inside(_) => {
            let file = document.file.file_name().unwrap_or_default();
            Ok(format!("{}#texture{}", encoded(file), texture.index()))
        }
        Picture::Beside(path) => {
            let part = || format!("texture {}", texture.index());
            match document.folder.resolve(&path) {
                Err(_) => Err(document.error(part(), Problem::RefersOutside { path })),
                Ok(file) if !file.is_file() => {
                    Err(document.error(part(), Problem::MissingFile { path }))
                }
                Ok(_) => Ok(of_file(path)),
            }
        }
    }
}

fn read_nodes(document: &Document, model: &mut Model) -> Result<(), FileError> {
    let gltf = &document.gltf;
    let scene = gltf.default_scene().or_else(|| gltf.scenes().next());
    let roots: Vec<gltf::Node> = match scene {
        Some(scene) => scene.nodes().collect(),
        None => {
            let children = gltf.nodes().flat_map(|node| node.children());
            let children: std::collections::HashSet<_> = children.map(|c| c.index()).collect();
            let is_root = |node: &gltf::Node| !children.contains(&node.index());
            gltf.nodes().filter(is_root).collect()
        }
    };
    let mut seen = vec![false; gltf.nodes().count()];
    // A stack, not recursion: a file can nest deeper than a thread's stack reaches.
    let mut to_visit: Vec<_> = roots
        .into_iter()
        .rev()
        .map(|node| (node, None, 0))
        .collect();
    while let Some((node, parent, depth)) = to_visit.pop() {
        // What it holds may become entities below its own.
        let levels = depth + 1;
        if levels > document.limits.depth {
            let problem = Problem::TooMany {
                what: "ancestors",
                count: levels,
                limit: document.limits.depth,
            };
            return Err(document.error(format!("node {}", node.index()), problem));
        }
        if std::mem::replace(&mut seen[node.index()], true) {
            let text = "it is reached twice; glTF wants a tree".to_owned();
            let part = format!("node {}", node.index());
            return Err(document.error(part, Problem::Malformed(text)));
        }
        let place = push_node(document, &node, parent, model);
        let children: Vec<_> = node.children().collect();
        to_visit.extend(
            children
                .into_iter()
                .rev()
                .map(|child| (child, Some(place), levels)),
        );
    }
    Ok(())
}

/// Adds a node and what it holds; returns where it is in the model.
fn push_node(
    document: &Document,
    node: &gltf::Node,
    parent: Option<usize>,
    model: &mut Model,
) -> usize {
    let name = node.name().map(str::to_owned);
    let name = name.unwrap_or_else(|| format!("node {}", node.index()));
    let mut contents: Vec<Node> = Vec::new();
    for (mesh, primitive) in node
        .mesh()
        .iter()
        .flat_map(|mesh| mesh.primitives().map(move |primitive| (mesh, primitive)))
    {
        let mesh = mesh_name(mesh, &primitive);
        if model.meshes.contains_key(&mesh) {
            contents.push(Node {
                mesh: Some(mesh),
                material: primitive.material().index(),
                ..Node::default()
            });
        }
    }
    if let Some(light) = node.light() {
        let mut content = Node::default();
        match lamp_of(&light) {
            Some(Lamp::Point(lamp)) => content.point_lamp = Some(lamp),
            Some(Lamp::Directional(lamp)) => content.directional_lamp = Some(lamp),
            None => model
                .notes
                .push(format!("`{name}`: its light has impossible numbers")),
        }
        if light.range().is_some() {
            model
                .notes
                .push(format!("`{name}`: light has no range here"));
        }
        contents.push(content);
    }
    if let Some(camera) = node.camera() {
        let camera = camera_of(&camera);
        if camera.is_none() {
            model
                .notes
                .push(format!("`{name}`: its camera has impossible numbers"));
        }
        contents.push(Node {
            camera,
            ..Node::default()
        });
    }
    let transform = transform_of(document, node, &name, &mut model.notes);
    let place = model.nodes.len();
    let own = match contents.len() {
        1 => contents.pop().unwrap_or_default(),
        _ => Node::default(),
    };
    model.nodes.push(Node {
        name: name.clone(),
        parent,
        transform,
        ..own
    });
    for (index, content) in contents.into_iter().enumerate() {
        model.nodes.push(Node {
            name: format!("{name}/{index}"),
            parent: Some(place),
            ..content
        });
    }
    place
}

fn transform_of(
    document: &Document,
    node: &gltf::Node,
    name: &str,
    notes: &mut Vec<String>,
) -> Transform {
    let transform = match node.transform() {
        gltf::scene::Transform::Decomposed {
            translation,
            rotation,
            scale,
        } => Transform {
            translation: translation.into(),
            rotation: Quat::from_array(rotation).normalize(),
            scale: scale.into(),
        },
        gltf::scene::Transform::Matrix { matrix } => {
            let matrix = Mat4::from_cols_array_2d(&matrix);
            let transform = Transform::from_matrix(matrix);
            let largest = matrix
                .to_cols_array()
                .into_iter()
                .fold(0.0, |a: f32, b| a.max(b.abs()));
            // Between the rounding of a decomposition and what could be seen.
            let tolerance = 1e-4 * largest;
            if !transform.to_matrix().abs_diff_eq(matrix, tolerance) {
                notes.push(format!("`{name}`: the shear in its matrix was left out"));
            }
            transform
        }
    };
    if transform.is_finite() {
        return transform;
    }
    let file = document.file.display();
    notes.push(format!(
        "`{name}`: its transform in {file} cannot be undone; it has no size here"
    ));
    Transform::from_scale(Vec3::ZERO)
}
