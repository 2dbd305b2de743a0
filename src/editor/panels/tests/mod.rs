//! The panels as a person meets them: drawn by egui without a window, and operated by pointer and
//! keys at the places where their texts stand.

mod commands;
mod desk;
mod drawn;
mod foreign;
mod kept;
mod named;
mod operated;
mod questions;
mod rows;
mod trees;
mod typed;

pub(super) use desk::{Desk, SMALL, USUAL, bounds};
pub(super) use drawn::texts;
pub(super) use typed::type_nonsense;
