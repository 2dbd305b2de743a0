//! The room `film`.
