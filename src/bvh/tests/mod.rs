//! The hard cases of ray tracing, each against two oracles that know no tree.

mod directions;
mod identity;
mod instances;
mod leaks;
mod magnitude;
mod malformed;
mod meshes;
mod oracle;
mod random;
mod spawned;
mod trees;
mod wide;
