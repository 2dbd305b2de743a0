//! The room `io`.
