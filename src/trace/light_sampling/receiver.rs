use crate::trace::Surface;
use crate::trace::math::piecewise::larger;
use crate::trace::math::vectors::{column_vector, set_column};
use glam::Vec3;

/// What points of a light are chosen for: places that see it, and how they reflect, in columns. What a place
/// reflects counts with one number instead of a colour.
#[derive(Clone, Copy, Debug)]
pub struct Receivers<const N: usize> {
    /// Where they are, in the frame in which the light stands still: x, y, z.
    pub from: [[f32; N]; 3],
    /// Unit normals for shading.
    pub normal: [[f32; N]; 3],
    /// The mirrored direction to the viewer, a unit vector: its cosine with a direction l is `r·v`.
    pub mirrored: [[f32; N]; 3],
    /// kd, the mean of its channels.
    pub diffuse: [f32; N],
    /// ks, the mean of its channels.
    pub specular: [f32; N],
    /// s ≥ 1.
    pub shininess: [f32; N],
}

impl<const N: usize> Receivers<N> {
    /// The parts that kd and ks have in their sum.
    #[inline(always)]
    pub(in crate::trace) fn parts(&self, i: usize) -> [f32; 2] {
        let [diffuse, specular] = [self.diffuse[i], self.specular[i]];
        let per_sum = 1.0 / larger(diffuse + specular, f32::MIN_POSITIVE);
        [diffuse * per_sum, specular * per_sum]
    }
}

impl<const N: usize> Receivers<N> {
    pub(in crate::trace) const NOWHERE: Self = Self {
        from: [[0.0; N]; 3],
        normal: [[0.0; N]; 3],
        mirrored: [[0.0; N]; 3],
        diffuse: [0.0; N],
        specular: [0.0; N],
        shininess: [1.0; N],
    };

    /// How the surface in a lane reflects, whose normal is there: kd, ks and the direction to the viewer.
    #[inline(always)]
    pub(in crate::trace) fn reflect_like(
        &mut self,
        i: usize,
        diffuse: Vec3,
        specular: Vec3,
        to_viewer: Vec3,
    ) {
        let n = column_vector(&self.normal, i);
        set_column(
            &mut self.mirrored,
            i,
            2.0 * n.dot(to_viewer) * n - to_viewer,
        );
        self.diffuse[i] = diffuse.element_sum() / 3.0;
        self.specular[i] = specular.element_sum() / 3.0;
    }
}

impl Receivers<1> {
    /// One place, as the light's points are chosen for a surface there.
    #[inline(always)]
    pub fn of(surface: &Surface, from: Vec3) -> Self {
        let mut receivers = Self::NOWHERE;
        set_column(&mut receivers.from, 0, from);
        set_column(&mut receivers.normal, 0, surface.normal);
        receivers.reflect_like(0, surface.diffuse, surface.specular, surface.to_viewer);
        receivers.shininess[0] = surface.shininess;
        receivers
    }
}
