//! What the tests and the report check this room with: meshes, random numbers, and two oracles that know no tree.
//!
//! HARD CASES are counted here; whoever calls decides with how many rays, and what to do with the count.

pub(crate) mod broken;
pub(crate) mod leaks;
pub(crate) mod meshes;
pub(crate) mod oracle;
pub(crate) mod random;
pub(crate) mod rays;
pub(crate) mod sieve;
pub(crate) mod single;
pub(crate) mod spawned;
pub(crate) mod transforms;
