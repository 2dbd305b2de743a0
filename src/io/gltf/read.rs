use super::super::error::{FileError, Problem};
use super::super::folder::Folder;
use super::super::model::{Model, Node, triangle_mesh};
use super::super::picture::{PictureUse, decode_picture, read_picture};
use super::accessors::{floats, indices};
use super::document::{Document, Picture};
use super::lamps::{Lamp, camera_of, lamp_of};
use super::material::{has_alpha, phong_of};
use crate::io::Limits;
use crate::scene::{Phong, TextureSource};
use bevy::image::Image;
use bevy::math::{Affine2, Mat4, Quat, Vec2, Vec3};
use bevy::mesh::Mesh;
use bevy::transform::components::Transform;
use gltf::mesh::Mode;
use std::path::Path;

/// Reads a glTF or GLB file: the default scene, or the first, or all nodes where there is none.
///
/// Meshes are called `Mesh0/Primitive0`, by their indices, because names need not be unique.
/// The texture coordinates are those of the base colour's picture, with its transform applied.
pub(crate) fn read_gltf(file: &Path, folder: &Folder, limits: &Limits) -> Result<Model, FileError> {
    let document = Document::read(file, folder, limits)?;
    let mut model = Model::default();
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

/// Reads a picture of a file: `part` is `texture` and the index of a texture.
pub(crate) fn read_texture(
    file: &Path,
    part: &str,
    folder: &Folder,
    usage: PictureUse,
    limits: &Limits,
) -> Result<Image, FileError> {
    let document = Document::read(file, folder, limits)?;
    let index = part.strip_prefix("texture").and_then(|n| n.parse().ok());
    let Some(texture) = index.and_then(|index| document.gltf.textures().nth(index)) else {
        let name = part.to_owned();
        let count = document.gltf.textures().count();
        return Err(FileError::new(file, Problem::NoSuchTexture { name, count }));
    };
    match document.texture(&texture)? {
        Picture::Beside(path) => read_picture(&document.folder.resolve(&path)?, usage, limits),
        Picture::Inside(bytes) => {
            let name = format!("{}#{part}", file.display());
            decode_picture(Path::new(&name), &bytes, usage, limits)
        }
    }
}

fn mesh_name(mesh: &gltf::Mesh, primitive: &gltf::Primitive) -> String {
    format!("Mesh{}/Primitive{}", mesh.index(), primitive.index())
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
            let separator = if source.contains('#') { "." } else { "#" };
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
            Ok(format!(
                "{}#texture{}",
                file.to_string_lossy(),
                texture.index()
            ))
        }
        Picture::Beside(path) => {
            let part = || format!("texture {}", texture.index());
            match document.folder.resolve(&path) {
                Err(_) => Err(document.error(part(), Problem::RefersOutside { path })),
                Ok(file) if !file.is_file() => {
                    Err(document.error(part(), Problem::MissingFile { path }))
                }
                Ok(_) => Ok(path),
            }
        }
    }
}

/// A primitive's triangles; `None` for points and lines.
fn read_primitive(
    document: &Document,
    primitive: &gltf::Primitive,
    name: &str,
    notes: &mut Vec<String>,
) -> Result<Option<Mesh>, Problem> {
    let mode = primitive.mode();
    if !matches!(
        mode,
        Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
    ) {
        notes.push(format!("{name}: points and lines were left out"));
        return Ok(None);
    }
    let Some(accessor) = primitive.get(&gltf::Semantic::Positions) else {
        return Err(Problem::Malformed("it has no positions".into()));
    };
    let positions = floats::<3>(document, &accessor)?;
    finite("a vertex", positions.as_flattened())?;
    let count = positions.len();
    let normals = match primitive.get(&gltf::Semantic::Normals) {
        Some(accessor) => floats::<3>(document, &accessor)?,
        None => Vec::new(),
    };
    finite("a normal", normals.as_flattened())?;
    let (set, transform) = uv_set(primitive);
    let mut uvs = match primitive.get(&gltf::Semantic::TexCoords(set)) {
        Some(accessor) => floats::<2>(document, &accessor)?,
        None => Vec::new(),
    };
    finite("a texture coordinate", uvs.as_flattened())?;
    for (what, given) in [
        ("normals", normals.len()),
        ("texture coordinates", uvs.len()),
    ] {
        if given != 0 && given != count {
            return Err(Problem::Malformed(format!(
                "{given} {what} for {count} vertices"
            )));
        }
    }
    if let Some(transform) = transform {
        for uv in &mut uvs {
            *uv = transform.transform_point2(Vec2::from(*uv)).into();
        }
    }
    let corners = match primitive.indices() {
        Some(accessor) => indices(document, &accessor)?,
        None => (0..u32::try_from(count).unwrap_or(u32::MAX)).collect(),
    };
    if let Some(index) = corners.iter().find(|&&index| index as usize >= count) {
        return Err(Problem::IndexOutOfRange {
            what: "vertex",
            index: index.to_string(),
            count,
        });
    }
    let corners = triangles_of(mode, corners);
    let triangles = corners.len() as u64 / 3;
    if triangles == 0 {
        notes.push(format!("{name}: has no triangles"));
        return Ok(None);
    }
    if triangles > document.limits.triangles {
        return Err(Problem::TooMany {
            what: "triangles",
            count: triangles,
            limit: document.limits.triangles,
        });
    }
    if primitive.get(&gltf::Semantic::Colors(0)).is_some() {
        notes.push(format!("{name}: its vertex colours were left out"));
    }
    Ok(Some(triangle_mesh(positions, normals, uvs, corners)))
}

/// Which set of texture coordinates the base colour's picture uses, and how it moves them.
fn uv_set(primitive: &gltf::Primitive) -> (u32, Option<Affine2>) {
    let material = primitive.material();
    let Some(info) = material.pbr_metallic_roughness().base_color_texture() else {
        return (0, None);
    };
    let Some(transform) = info.texture_transform() else {
        return (info.tex_coord(), None);
    };
    // KHR_texture_transform turns counter-clockwise as seen in a picture whose v points down.
    let affine = Affine2::from_scale_angle_translation(
        transform.scale().into(),
        -transform.rotation(),
        transform.offset().into(),
    );
    (
        transform.tex_coord().unwrap_or(info.tex_coord()),
        Some(affine),
    )
}

fn finite(what: &str, values: &[f32]) -> Result<(), Problem> {
    match values.iter().all(|value| value.is_finite()) {
        true => Ok(()),
        false => Err(Problem::NotFinite { what: what.into() }),
    }
}

/// Corners of separate triangles. A strip turns every second one around (glTF 2.0, 3.7.2.1).
fn triangles_of(mode: Mode, mut corners: Vec<u32>) -> Vec<u32> {
    match mode {
        Mode::TriangleStrip => (2..corners.len())
            .flat_map(|i| match i % 2 {
                0 => [corners[i - 2], corners[i - 1], corners[i]],
                _ => [corners[i - 1], corners[i - 2], corners[i]],
            })
            .collect(),
        Mode::TriangleFan => (2..corners.len())
            .flat_map(|i| [corners[0], corners[i - 1], corners[i]])
            .collect(),
        _ => {
            corners.truncate(corners.len() / 3 * 3);
            corners
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
    let mut to_visit: Vec<_> = roots.into_iter().rev().map(|node| (node, None)).collect();
    while let Some((node, parent)) = to_visit.pop() {
        if std::mem::replace(&mut seen[node.index()], true) {
            let text = "it is reached twice; glTF wants a tree".to_owned();
            let part = format!("node {}", node.index());
            return Err(document.error(part, Problem::Malformed(text)));
        }
        let place = push_node(document, &node, parent, model);
        let children: Vec<_> = node.children().collect();
        to_visit.extend(children.into_iter().rev().map(|child| (child, Some(place))));
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
