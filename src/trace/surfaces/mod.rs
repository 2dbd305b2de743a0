//! What a ray meets: a surface at a hit, how it reflects light, and what it lets through.
//!
//! [`surface`] is read at a hit, with textures as blurred as [`footprint`] says. [`shading`] is Phong's model, [`transmittance`] what
//! passes a surface.

mod footprint;
pub mod shading;
pub(super) mod surface;
pub(super) mod transmittance;

pub use footprint::Cone;
pub use surface::Surface;
