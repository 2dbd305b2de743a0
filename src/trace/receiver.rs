use super::Surface;
use super::piecewise::larger;
use super::vectors::set_column;
use super::vertices::Vertices;
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
    pub(super) fn parts(&self, i: usize) -> [f32; 2] {
        let [diffuse, specular] = [self.diffuse[i], self.specular[i]];
        let per_sum = 1.0 / larger(diffuse + specular, f32::MIN_POSITIVE);
        [diffuse * per_sum, specular * per_sum]
    }
}

impl<const N: usize> Receivers<N> {
    pub(super) const NOWHERE: Self = Self {
        from: [[0.0; N]; 3],
        normal: [[0.0; N]; 3],
        mirrored: [[0.0; N]; 3],
        diffuse: [0.0; N],
        specular: [0.0; N],
        shininess: [1.0; N],
    };

    /// Vertices with a highlight, each with where it is.
    #[inline(always)]
    pub(super) fn glossy(
        vertices: &Vertices,
        vertex: impl Fn(usize) -> usize,
        from: impl Fn(usize) -> Vec3,
    ) -> Self {
        let mut receivers = Self::NOWHERE;
        for i in 0..N {
            let vertex = vertex(i);
            receivers.set(i, &vertices.surface(vertex), from(vertex));
        }
        receivers
    }

    #[inline(always)]
    fn set(&mut self, i: usize, surface: &Surface, from: Vec3) {
        let n = surface.normal;
        let mirrored = 2.0 * n.dot(surface.to_viewer) * n - surface.to_viewer;
        set_column(&mut self.from, i, from);
        set_column(&mut self.normal, i, n);
        set_column(&mut self.mirrored, i, mirrored);
        self.diffuse[i] = surface.diffuse.element_sum() / 3.0;
        self.specular[i] = surface.specular.element_sum() / 3.0;
        self.shininess[i] = surface.shininess;
    }
}

impl Receivers<1> {
    /// One place, as the light's points are chosen for a surface there.
    #[inline(always)]
    pub fn of(surface: &Surface, from: Vec3) -> Self {
        let mut receivers = Self::NOWHERE;
        receivers.set(0, surface, from);
        receivers
    }
}
