//! What the colours of the lines mean.

use super::color::{
    AXES, BETWEEN, BLOCKED, BLUE, CYAN, DARK, GREEN, GREY, ORANGE, RED, VERTEX, WHITE, YELLOW,
    faint, of_scale,
};
use super::motion::GHOST_ALPHA;
use super::rays::is_shown;
use super::settings::{BoxChoice, BoxColor, MissColor, TreeForm};
use super::{InspectSettings, System};
use crate::trace::{RayEnd, RayKind, RayTree, TracedRay};
use bevy::color::LinearRgba;

/// One kind of line.
#[derive(Clone, Debug, PartialEq)]
pub struct Meaning {
    /// Linear RGB with opacity; several are the pieces of a scale, or kinds that stand together.
    pub colors: Vec<LinearRgba>,
    /// What has this colour, in a few words.
    pub says: &'static str,
}

/// What the colours of a system's lines mean with these settings. Rays count where there are some of
/// their kind.
pub fn legend(system: System, inspect: &InspectSettings, rays: Option<&RayTree>) -> Vec<Meaning> {
    let mut all = Vec::new();
    let mut say = |colors: &[LinearRgba], says| {
        all.push(Meaning {
            colors: colors.to_vec(),
            says,
        });
    };
    let shown: Vec<&TracedRay> = rays
        .into_iter()
        .flat_map(|tree| &tree.rays)
        .filter(|ray| is_shown(&inspect.rays, ray))
        .collect();
    let scale: Vec<LinearRgba> = (0..=4).map(|i| of_scale(i as f32 / 4.0)).collect();
    match system {
        System::Boxes => {
            let boxes = &inspect.boxes;
            match boxes.color {
                _ if boxes.choice == BoxChoice::Leaf && boxes.form == TreeForm::Binary => {
                    say(&[of_scale(1.0)], "the leaf's box");
                }
                BoxColor::Level | BoxColor::LeafSize | BoxColor::Cost
                    if boxes.form == TreeForm::Wide =>
                {
                    say(&scale, "boxes, from the root's level to the deepest");
                }
                BoxColor::Level => say(&scale, "boxes, from the root's level to the deepest"),
                BoxColor::LeafSize => {
                    say(&scale, "leaves, from few triangles to many");
                    say(&[GREY], "inner nodes");
                }
                BoxColor::Cost => say(&scale, "boxes, from low to high cost"),
                BoxColor::Visits => say(&scale, "boxes, from never entered to most often"),
            }
            if boxes.form == TreeForm::Wide {
                return all;
            }
            if boxes.split_planes {
                say(&AXES, "planes that split across x, y, z");
            }
            if boxes.triangles || boxes.choice == BoxChoice::Leaf {
                say(&[WHITE], "triangles of leaves");
            }
        }
        System::Visits if shown.is_empty() => {}
        System::Visits => {
            if inspect.rays.visited {
                say(&[WHITE], "nodes that the rays entered");
            }
            if inspect.rays.pruned {
                say(&[RED], "nodes behind a nearer hit: left out");
            }
        }
        System::Normals => {
            say(&[VERTEX], "normals of vertices");
            if inspect.normals.between > 0 {
                say(&[BETWEEN], "normals between them");
            }
        }
        System::Lights => say(&[YELLOW, WHITE, CYAN], "lights, in their colours"),
        System::Lens => say(&[CYAN], "aperture, focus plane, field of view"),
        System::Motion => say(
            &[faint(ORANGE, GHOST_ALPHA), ORANGE],
            "where the shutter opens, and closes",
        ),
        System::Lobes => {
            let blurred =
                |ray: &&TracedRay| matches!(ray.kind, RayKind::Gloss | RayKind::Translucency);
            if shown.iter().any(blurred) {
                say(&[CYAN], "the disc that directions are drawn from");
                say(&[YELLOW], "where each ray passes it");
            }
        }
        System::Rays if shown.is_empty() => {}
        System::Rays => {
            let is_light =
                |ray: &&&TracedRay| matches!(ray.kind, RayKind::Shadow | RayKind::LightSample);
            if shown.iter().any(|ray| !is_light(&ray)) {
                say(
                    &[ORANGE, WHITE, CYAN],
                    "rays, in the colour of their radiance",
                );
            }
            let missed = shown.iter().any(|ray| ray.end == RayEnd::Background);
            if missed && inspect.rays.misses == MissColor::Red {
                say(&[RED], "rays that met nothing");
            }
            let lit = |ray: &&&TracedRay| matches!(ray.end, RayEnd::Arrived | RayEnd::Unshadowed);
            if shown.iter().any(|ray| lit(&ray)) {
                say(&[WHITE], "to a light; tinted by what it passes through");
            }
            if shown.iter().any(|ray| ray.end == RayEnd::Blocked) {
                say(&[BLOCKED], "to a light, up to what is in the way");
                say(&[DARK], "where that light does not reach");
            }
            if inspect.rays.hit_triangles {
                say(&[YELLOW], "triangles that were hit");
            }
            if inspect.rays.hit_normals {
                say(&[GREEN], "shading normals");
                say(&[BLUE], "geometric normals");
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::InspectPreset;

    #[test]
    fn every_system_that_is_drawn_without_a_ray_is_explained_and_no_other() {
        let mut inspect = InspectPreset::WhereIsTheNoiseFrom.settings();
        inspect.boxes.split_planes = true;
        for system in System::ALL {
            let meanings = legend(system, &inspect, None);
            let needs_rays = matches!(system, System::Visits | System::Lobes | System::Rays);
            assert_eq!(meanings.is_empty(), needs_rays, "{system:?}: {meanings:?}");
            assert!(meanings.iter().all(|meaning| !meaning.colors.is_empty()));
        }
        let boxes = legend(System::Boxes, &inspect, None);
        assert!(boxes.iter().any(|meaning| meaning.colors == AXES));
        inspect.boxes.split_planes = false;
        let boxes = legend(System::Boxes, &inspect, None);
        assert!(boxes.iter().all(|meaning| meaning.colors != AXES));
    }
}
