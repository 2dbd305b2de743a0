//! Scenes and models through files and back.

mod app;
mod round_trip;
