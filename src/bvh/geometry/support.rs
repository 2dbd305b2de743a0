//! How far a mesh reaches, in every direction.
//!
//! The support function h(d) is the largest d · p of all points p of a shape, and where a shape ends in a turned space
//! is its support along that space's axes. It is known here in the directions of a grid on a cube's faces. Between them
//! it follows from being convex and homogeneous: h(Σ wᵢ dᵢ) <= Σ wᵢ h(dᵢ) for weights that are not negative, so that the
//! blend of a cell's four corners is never too small. Of a ball it is at most 2.6 % too large, of a cube never. What is
//! more comes from the boxes that the shape is taken from: of a ball of 8,192 triangles the box round it has 1.06 to 1.3
//! times the area of one round its corners (its own box, turned: up to 3 times).

use std::sync::OnceLock;

use glam::{DVec3, IVec3};
use obvhs::bvh2::{Bvh2, node::Bvh2Node};

/// Cells along an edge of the cube, an even number: no cell lies across a plane between octants.
const CELLS: usize = 6;
/// Directions are measured in cells, from the cube's middle.
const HALF: i32 = CELLS as i32 / 2;
/// Boxes of a tree that the shape is taken from.
const MOST_BOXES: usize = 1024;
/// Nodes of a tree whose boxes are looked at one by one each time: a table of them would take more memory than the mesh.
const FEW_NODES: usize = 63;

/// The support function of the boxes of a tree.
#[derive(Clone, Debug)]
pub(in crate::bvh) struct Support {
    /// By x, y and z of the direction, each from -[`HALF`] to [`HALF`]. What lies inside of the cube is not used.
    along: [[[f32; CELLS + 1]; CELLS + 1]; CELLS + 1],
}

/// A box by its middle and how far it reaches from there.
type Middle = (DVec3, DVec3);

fn middle(node: &Bvh2Node) -> Middle {
    let (min, max) = (node.aabb().min.as_dvec3(), node.aabb().max.as_dvec3());
    ((min + max) * 0.5, (max - min) * 0.5)
}

/// How far boxes reach along a direction, and the other way.
fn ends(boxes: impl Iterator<Item = Middle>, direction: DVec3) -> [f64; 2] {
    let size = direction.abs();
    let start = [f64::NEG_INFINITY; 2];
    boxes.fold(start, |[ahead, behind], (middle, half)| {
        let (middle, half) = (direction.dot(middle), size.dot(half));
        [ahead.max(half + middle), behind.max(half - middle)]
    })
}

/// How far the leaves of a tree that has some reach along a direction of any length but zero, and the other way: no less
/// (but for the rounding of f64), and hardly more. Of few the exact ends; else what `known` has or gets.
pub(in crate::bvh) fn reach(
    tree: &Bvh2,
    known: &OnceLock<Box<Support>>,
    direction: DVec3,
) -> [f64; 2] {
    if tree.nodes.len() <= FEW_NODES {
        let leaves = tree.nodes.iter().filter(|node| node.is_leaf());
        return ends(leaves.map(middle), direction);
    }
    let support = known.get_or_init(|| Box::new(Support::of(tree)));
    [support.along(direction), support.along(-direction)]
}

impl Support {
    /// Of a tree with a node.
    fn of(tree: &Bvh2) -> Self {
        let mut nodes = vec![&tree.nodes[0]];
        // In the order of their depth: what was opened stands before `opened`.
        let mut opened = 0;
        let mut leaves = Vec::new();
        while leaves.len() + nodes.len() - opened < MOST_BOXES && opened < nodes.len() {
            let node = nodes[opened];
            opened += 1;
            if node.is_leaf() {
                leaves.push(node);
            } else {
                let first = node.first_index as usize;
                nodes.extend(&tree.nodes[first..first + 2]);
            }
        }
        leaves.extend(&nodes[opened..]);
        let boxes: Vec<Middle> = leaves.into_iter().map(middle).collect();
        let mut along = [[[0.0; CELLS + 1]; CELLS + 1]; CELLS + 1];
        let places = 0..(CELLS + 1).pow(3);
        // Each with its opposite.
        for place in places.take((CELLS + 1).pow(3) / 2) {
            let (x, y, z) = (
                place / (CELLS + 1).pow(2),
                place / (CELLS + 1) % (CELLS + 1),
                place % (CELLS + 1),
            );
            let at = IVec3::new(x as i32, y as i32, z as i32) - HALF;
            if at.abs().max_element() == HALF {
                let [ahead, behind] = ends(boxes.iter().copied(), at.as_dvec3());
                along[x][y][z] = above(ahead);
                along[CELLS - x][CELLS - y][CELLS - z] = above(behind);
            }
        }
        Self { along }
    }

    /// No less than the largest `direction · p` of all points p (but for the rounding of f64), and hardly more. The
    /// direction has any length but zero.
    fn along(&self, direction: DVec3) -> f64 {
        let size = direction.abs().max_element() / f64::from(HALF);
        let at = direction / size + f64::from(HALF);
        // The first of the two grid planes that it lies between, axis by axis. It lies in one of the cube's faces, which
        // gives the other plane no weight.
        let first = at
            .floor()
            .clamp(DVec3::ZERO, DVec3::splat(CELLS as f64 - 1.0));
        let weight = at - first;
        let first = first.as_uvec3();
        let longest = direction.abs().max_position();
        let mut sum = 0.0;
        for corner in 0..8 {
            let corner = glam::UVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
            // Not by its weight, which may be a rounding away from 0: what lies inside of the cube is not known.
            if corner[longest] != u32::from(direction[longest] > 0.0) {
                continue;
            }
            let mut part = 1.0;
            for axis in (0..3).filter(|axis| *axis != longest) {
                part *= match corner[axis] {
                    0 => 1.0 - weight[axis],
                    _ => weight[axis],
                };
            }
            let place = first + corner;
            let [x, y, z] = [place.x, place.y, place.z].map(|i| i as usize);
            sum += part * f64::from(self.along[x][y][z]);
        }
        sum * size
    }
}

/// The nearest f32 that is no less.
fn above(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) < x {
        near.next_up()
    } else {
        near
    }
}

#[cfg(test)]
mod tests {
    use std::{f32::consts::TAU, sync::Arc};

    use glam::{Affine3A, EulerRot, Quat, Vec3};
    use obvhs::aabb::Aabb;
    use proptest::prelude::*;

    use super::super::instance::Instance;
    use super::super::mesh_tree::MeshTree;
    use super::*;
    use crate::bvh::hard_cases::meshes::{cube, moved, scatter, sphere};
    use crate::bvh::hard_cases::random::Random;
    use crate::bvh::{BuildOptions, Triangles};

    fn turned(random: &mut Random) -> Quat {
        let [x, y, z] = [0; 3].map(|_| random.between(0.0, TAU));
        Quat::from_euler(EulerRot::XYZ, x, y, z)
    }

    /// The area of an instance's box in those of the exact one around its corners: least and largest of many turns.
    fn looseness(mesh: Triangles) -> [f32; 2] {
        let mesh = Arc::new(MeshTree::build(mesh, &BuildOptions::default()));
        let mut random = Random::new(5);
        let ratios = (0..200).map(|_| {
            let place = Affine3A::from_quat(turned(&mut random));
            let instance = Instance::new(mesh.clone(), &place).unwrap();
            let corners = mesh.triangles().positions().iter();
            let exact: Aabb = corners
                .map(|corner| {
                    let corner = instance.to_world_point(*corner).into();
                    Aabb::new(corner, corner)
                })
                .reduce(|all, one| all.union(&one))
                .unwrap();
            instance.world_bounds().unwrap().half_area() / exact.half_area()
        });
        ratios.fold([f32::INFINITY, 0.0], |[least, most], ratio| {
            [least.min(ratio), most.max(ratio)]
        })
    }

    #[test]
    fn a_turned_ball_has_a_box_hardly_larger_than_the_ball() {
        let [least, most] = looseness(sphere(5));
        assert!(least > 0.9999 && most < 1.35, "{least} {most}");
    }

    #[test]
    fn a_turned_cube_has_its_own_box() {
        let [least, most] = looseness(cube());
        assert!(least > 0.9999 && most < 1.0001, "{least} {most}");
    }

    proptest! {
        #[test]
        fn no_point_of_a_mesh_lies_beyond_its_support(
            seed in any::<u64>(),
            count in 1_usize..20_000,
            axis in prop::array::uniform3(-3..=3_i32),
            nudge in prop::sample::select(vec![0.0, 1e-300, 1e-17, 1e-3, 1.0]),
        ) {
            let mesh = MeshTree::build(scatter(count, 0.3, seed), &BuildOptions::default());
            let mut random = Random::new(seed);
            let direction = IVec3::from(axis).as_dvec3() + random.direction().as_dvec3() * nudge;
            prop_assume!(direction != DVec3::ZERO);
            let [found, _] = mesh.reach_along(direction);
            let [_, opposite] = mesh.reach_along(-direction);
            prop_assert_eq!(found, opposite);
            let points = mesh.triangles().positions().iter();
            let ends = points.map(|point| direction.dot(point.as_dvec3()));
            let exact = ends.fold(f64::NEG_INFINITY, f64::max);
            prop_assert!(found >= exact, "{found} {exact}");
            // The cube around everything.
            prop_assert!(found <= 1.5 * direction.abs().element_sum(), "{found} {exact}");
        }

        #[test]
        fn every_corner_lies_in_the_box_of_its_instance_at_every_time(
            seed in any::<u64>(),
            count in 1_usize..3_000,
            offset in prop::sample::select(vec![0.0_f32, 1.0, 1e4]),
            far in prop::sample::select(vec![0.0_f32, 100.0, 1e6]),
            stretch in 0.1_f32..10.0,
            velocity in prop::sample::select(vec![0.0_f32, 3.0]),
        ) {
            let mut random = Random::new(seed);
            let mesh = moved(&scatter(count, 0.3, seed), |p| p + offset);
            let scale = Vec3::new(stretch, 1.0, 1.0 / stretch);
            let (turn, translation) = (turned(&mut random), random.cube() * far);
            let place = Affine3A::from_scale_rotation_translation(scale, turn, translation)
                * Affine3A::from_quat(turned(&mut random));
            let mesh = Arc::new(MeshTree::build(mesh, &BuildOptions::default()));
            let velocity = random.cube() * velocity;
            let instance = Instance::new(mesh, &place).unwrap().moving(velocity).unwrap();
            let bounds = instance.world_bounds().unwrap();
            let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
            let linear = instance.exact_linear();
            for corner in instance.mesh.triangles().positions() {
                let still = linear * corner.as_dvec3() + translation.as_dvec3();
                for time in [0.0, 0.5, 1.0] {
                    let at = still + velocity.as_dvec3() * time;
                    prop_assert!(at.cmpge(min).all() && at.cmple(max).all(), "{at} {bounds:?}");
                }
            }
        }
    }
}
