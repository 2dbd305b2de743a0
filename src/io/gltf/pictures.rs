//! Which pictures a material has, and which of them says where its meshes take them.

use super::super::error::FileError;
use super::document::Document;
use super::json::Json;
use super::material::SPECULAR_GLOSSINESS;
use super::texture::{TextureInfo, alpha_of, texture_source};
use crate::scene::TextureSource;

/// The pictures of a material, as far as they are read.
pub(super) struct Pictures {
    pub base: Option<TextureInfo>,
    pub emissive: Option<TextureInfo>,
    pub normal: Option<TextureInfo>,
    /// Of what is no metal: its reflections' colour, and how strong they are.
    tint: Option<TextureInfo>,
    strength: Option<TextureInfo>,
}

impl Pictures {
    pub fn of(material: Json) -> Self {
        let base = match material.extension(SPECULAR_GLOSSINESS) {
            Some(glossy) => glossy.get("diffuseTexture"),
            None => {
                (material.get("pbrMetallicRoughness")).and_then(|pbr| pbr.get("baseColorTexture"))
            }
        };
        let own = |key| material.get(key).and_then(TextureInfo::of);
        let of = |extension: Option<Json>, key| extension?.get(key).and_then(TextureInfo::of);
        let specular = material.extension("KHR_materials_specular");
        let glossy = material.extension(SPECULAR_GLOSSINESS);
        Self {
            base: base.and_then(TextureInfo::of),
            emissive: own("emissiveTexture"),
            normal: own("normalTexture"),
            tint: match glossy {
                Some(_) => of(glossy, "specularGlossinessTexture"),
                None => of(specular, "specularColorTexture"),
            },
            strength: of(specular, "specularTexture").filter(|_| glossy.is_none()),
        }
    }

    pub fn all(&self) -> impl Iterator<Item = TextureInfo> {
        let Self {
            base,
            emissive,
            normal,
            tint,
            strength,
        } = *self;
        [base, emissive, normal, tint, strength]
            .into_iter()
            .flatten()
    }

    /// Whether there are any of reflections.
    pub fn have_reflections(&self) -> bool {
        self.tint.or(self.strength).is_some()
    }

    /// The one that the reflections of what is no metal take.
    pub fn of_reflections(
        &self,
        document: &Document,
        note: &impl Fn(&str, &'static str),
    ) -> Result<Option<TextureSource>, FileError> {
        let tint = texture_source(document, self.tint)?;
        let strength = texture_source(document, self.strength)?;
        let strength = strength.map(|picture| alpha_of(&picture));
        if tint.is_some() && strength.is_some() {
            let what = "two pictures of reflections, their colour and their strength, of";
            note(what, "the colour's is taken");
        }
        Ok(tint.or(strength))
    }
}

/// The picture of a material whose texture coordinates meshes take: that of its colour, where it has one.
pub(super) fn placing_texture(document: &Document, material: Option<usize>) -> Option<TextureInfo> {
    let material = document.json().element("materials", material?)?;
    Pictures::of(material).all().next()
}
