//! Lens, gloss, transparency and translucency: each against what it should be.

mod gloss;
mod inherited_motion;
mod lens;
mod motion;
mod moving_lights;
mod samples;
mod transparency;
