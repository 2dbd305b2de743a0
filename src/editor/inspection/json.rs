//! The picked pixel as one JSON document: what `glassbox inspect --json` writes of it.

use super::{DebugRay, Drawings, Inspected};
use crate::editor::document::Document;
use crate::editor::navigation::LookThrough;
use crate::inspect::{self, InspectSettings, LineSet, Names, Traversal, pattern};
use crate::scene::RenderSettings;
use crate::trace::samples_per_pixel;
use bevy::ecs::world::World;

/// The document, with the lines that are drawn and the steps of the chosen ray. The error says what
/// is missing.
pub(in crate::editor) fn json(world: &World) -> Result<String, String> {
    let ray = world.resource::<DebugRay>();
    let (Some(rays), Some((traced, settings)), Some(shot)) =
        (ray.rays(), ray.traced_with(), ray.shot())
    else {
        return Err("no pixel was picked yet, so there is nothing to copy".into());
    };
    let names = world.resource::<Names>();
    let settings = RenderSettings {
        output: world.resource::<RenderSettings>().output,
        ..settings.clone()
    };
    let document = world.get_resource::<Document>();
    let scene = document.map_or_else(String::new, |document| match &document.path {
        Some(path) => path.display().to_string(),
        None => document.name.clone(),
    });
    let through = world.get_resource::<LookThrough>().and_then(|t| t.camera);
    let camera = through.map_or_else(|| "view".into(), |id| names.of(id.0));
    let lines: Vec<LineSet> = match world.get_resource::<Drawings>() {
        Some(drawings) => drawings.sets().cloned().collect(),
        None => Vec::new(),
    };
    let choice = &world.resource::<InspectSettings>().pattern;
    let pattern = choice.on.then(|| {
        let count = samples_per_pixel(traced, &shot.camera, &settings);
        pattern(
            traced,
            &settings,
            choice,
            rays.pixel,
            count.into(),
            inspect::MOST_POINTS,
        )
    });
    let inspected = world.resource::<Inspected>();
    let traversal: Option<&Traversal> = inspected.ray().map(|_| inspected.stepper.traversal());
    let document = inspect::Document {
        lines: &lines,
        pattern: pattern.as_ref(),
        traversal,
        ..inspect::Document::new((&scene, &camera), traced, &settings, rays, &names.things)
    };
    serde_json::to_string(&document).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Bench, SIZE};
    use super::*;
    use crate::sync::{Traced, TracedCameras};
    use crate::trace::{Samples, probe};
    use bevy::math::UVec2;
    use serde_json::Value;

    #[test]
    fn what_is_copied_is_what_the_command_line_writes_of_the_pixel() {
        let mut bench = Bench::open("cornell-box");
        assert!(json(bench.app.world()).is_err());
        bench.shoot([300, 240]);
        bench.inspected().choose_ray(Some(0), false);
        bench.app.update();
        let copied: Value = serde_json::from_str(&json(bench.app.world()).unwrap()).unwrap();

        // As `cli/inspect.rs` puts it together.
        let world = bench.app.world();
        let settings = RenderSettings {
            size: SIZE,
            ..world.resource::<RenderSettings>().clone()
        };
        let camera = &world.resource::<TracedCameras>().0[0].camera;
        let traced = &world.resource::<Traced>().world;
        let samples = Samples::One(0);
        let rays = probe(traced, camera, &settings, UVec2::new(300, 240), &samples).unwrap();
        let traversal = Traversal::of(traced, &settings, &rays, 0);
        let names = &world.resource::<Names>().things;
        let document = inspect::Document {
            traversal: Some(&traversal),
            ..inspect::Document::new(("cornell-box", "view"), traced, &settings, &rays, names)
        };
        // By way of its text: numbers are written as short as they can be.
        let written = serde_json::to_string(&document).unwrap();
        let mut written: Value = serde_json::from_str(&written).unwrap();
        written["scene"] = copied["scene"].clone();
        assert_eq!(copied, written);
        assert!(copied["rays"].as_array().is_some_and(|rays| rays.len() > 1));
    }
}
