//! The views of one film: what can be shown of a picture and of how it came about.
//!
//! | view | shows | read from | values |
//! |---|---|---|---|
//! | shaded | the picture | the picture | bloom, exposure, view transform |
//! | albedo | kd with its texture | first hits | mean over the samples, sRGB |
//! | normal | the shading normal in world space | first hits | mean over the samples, n·0.5 + 0.5 |
//! | depth | metres to the first surface | first hits | central ray, heatmap, near is bright |
//! | object | which object | first hits | central ray, a colour for each `SceneId` |
//! | nodes | nodes of the trees that the ray entered | first hits | central ray, heatmap |
//! | triangles | triangles tested | first hits | central ray, heatmap |
//! | samples | samples of the pixel | the film | heatmap |
//! | error | estimated error of the pixel | the film | heatmap |
//! | bloom-threshold | what passes bloom's threshold | the picture | exposure, view transform |
//! | bloom-layer | what bloom adds | the picture | exposure, view transform |
//!
//! Nodes and triangles are those of the single-ray traversal, counted for each pixel's central ray,
//! whatever kernel the picture was traced with. Showing traces no ray: what a view reads was traced
//! before, by [`render`](super::render()) or [`FirstHits::trace`](super::FirstHits::trace).

pub(crate) mod font;
mod heatmap;
mod legend;
mod object_color;
mod show;
mod viridis;

pub use heatmap::Scale;
pub use legend::burn_legend;
pub use object_color::object_color;
pub use show::{Shown, Sources, ViewError, show};
pub use viridis::viridis;

use std::fmt;
use std::str::FromStr;

/// What is shown of a film. The table is in the module's documentation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "the module's table says what each is")]
pub enum View {
    #[default]
    Shaded,
    Albedo,
    Normal,
    Depth,
    Object,
    Nodes,
    Triangles,
    Samples,
    Error,
    BloomThreshold,
    BloomLayer,
}

/// What a view is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The linear picture.
    Picture,
    /// [`FirstHits`](super::FirstHits).
    FirstHits,
    /// The number of each pixel's samples.
    Samples,
    /// The estimated error of each pixel.
    Errors,
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Picture => "the picture",
            Self::FirstHits => "first hits",
            Self::Samples => "the samples of each pixel",
            Self::Errors => "the error of each pixel",
        })
    }
}

impl View {
    /// All of them, in the table's order.
    pub const ALL: [Self; 11] = [
        Self::Shaded,
        Self::Albedo,
        Self::Normal,
        Self::Depth,
        Self::Object,
        Self::Nodes,
        Self::Triangles,
        Self::Samples,
        Self::Error,
        Self::BloomThreshold,
        Self::BloomLayer,
    ];

    /// As the command line calls it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Shaded => "shaded",
            Self::Albedo => "albedo",
            Self::Normal => "normal",
            Self::Depth => "depth",
            Self::Object => "object",
            Self::Nodes => "nodes",
            Self::Triangles => "triangles",
            Self::Samples => "samples",
            Self::Error => "error",
            Self::BloomThreshold => "bloom-threshold",
            Self::BloomLayer => "bloom-layer",
        }
    }

    /// What must be there before it can be shown.
    pub fn source(self) -> Source {
        match self {
            Self::Shaded | Self::BloomThreshold | Self::BloomLayer => Source::Picture,
            Self::Albedo
            | Self::Normal
            | Self::Depth
            | Self::Object
            | Self::Nodes
            | Self::Triangles => Source::FirstHits,
            Self::Samples => Source::Samples,
            Self::Error => Source::Errors,
        }
    }

    /// Whether it shows one number a pixel, on a scale.
    pub fn is_heatmap(self) -> bool {
        matches!(
            self,
            Self::Depth | Self::Nodes | Self::Triangles | Self::Samples | Self::Error
        )
    }
}

impl fmt::Display for View {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A name that no view has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no view `{0}`: choose one of {names}", names = View::ALL.map(View::name).join(", "))]
pub struct UnknownView(pub String);

impl FromStr for View {
    type Err = UnknownView;

    fn from_str(name: &str) -> Result<Self, UnknownView> {
        let found = Self::ALL.into_iter().find(|view| view.name() == name);
        found.ok_or_else(|| UnknownView(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_view_is_found_by_its_name_and_another_name_lists_them_all() {
        for view in View::ALL {
            assert_eq!(view.to_string().parse(), Ok(view));
        }
        let message = "wireframe".parse::<View>().unwrap_err().to_string();
        for view in View::ALL {
            assert!(message.contains(view.name()), "{message}");
        }
    }
}
