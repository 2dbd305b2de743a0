//! The room `io`.

pub mod shapes;
