//! Tests of the whole stack. A module a subject; tests of one file stand in that file.

mod analytic;
mod bad_input;
mod cli;
mod convergence;
#[cfg(feature = "editor")]
mod editor;
mod effects;
mod files;
mod film;
mod inspect;
mod mutation;
mod trees;
#[cfg(feature = "editor")]
mod views;
#[cfg(feature = "editor")]
mod window;
