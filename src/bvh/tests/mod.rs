//! The hard cases of ray tracing, each against two oracles that know no tree.

mod any_triangles;
mod directions;
mod each_set;
mod identity;
mod instances;
mod leaks;
mod magnitude;
mod malformed;
mod multi_hit;
mod spawned;
mod sure;
mod transmit;
mod trees;
mod wide;
mod wide_hits;

use super::hard_cases::{broken, meshes, oracle, random, rays, single, transforms};
