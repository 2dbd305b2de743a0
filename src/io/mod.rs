//! The room `io`.

pub mod builtin;
pub mod shapes;
