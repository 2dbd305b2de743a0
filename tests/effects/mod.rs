//! Lens, gloss, transparency and translucency: each against what it should be.

mod gloss;
mod lens;
mod motion;
mod samples;
mod transparency;
