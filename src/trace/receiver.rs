use super::Surface;
use super::piecewise::larger;
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
    /// Surfaces, each with where it is, as a light's points are chosen for them.
    #[inline(always)]
    pub(super) fn gather<'a>(receiver: impl Fn(usize) -> (&'a Surface, Vec3)) -> Self {
        let mut receivers = Self {
            from: [[0.0; N]; 3],
            normal: [[0.0; N]; 3],
            mirrored: [[0.0; N]; 3],
            diffuse: [0.0; N],
            specular: [0.0; N],
            shininess: [1.0; N],
        };
        for i in 0..N {
            let (surface, from) = receiver(i);
            let n = surface.normal;
            let mirrored = 2.0 * n.dot(surface.to_viewer) * n - surface.to_viewer;
            for axis in 0..3 {
                receivers.from[axis][i] = from[axis];
                receivers.normal[axis][i] = n[axis];
                receivers.mirrored[axis][i] = mirrored[axis];
            }
            receivers.diffuse[i] = surface.diffuse.element_sum() / 3.0;
            receivers.specular[i] = surface.specular.element_sum() / 3.0;
            receivers.shininess[i] = surface.shininess;
        }
        receivers
    }
}

impl Receivers<1> {
    /// One place, as the light's points are chosen for a surface there.
    #[inline(always)]
    pub fn of(surface: &Surface, from: Vec3) -> Self {
        Self::gather(|_| (surface, from))
    }
}
