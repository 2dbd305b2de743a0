//! Lines in a Bevy view, drawn by its retained gizmos.
//!
//! A [`DrawnLines`] is one set of lines, with its two gizmo assets: one hidden by what stands before
//! it, and a faint one that is not. They are made again only where the lines changed, so that a
//! hundred thousand lines cost nothing while they stand.

use super::symbols::SymbolOf;
use super::traced::TracedView;
use bevy::asset::Assets;
use bevy::camera::Camera;
use bevy::camera::visibility::RenderLayers;
use bevy::color::LinearRgba;
use bevy::gizmos::GizmoAsset;
use bevy::gizmos::config::GizmoLineConfig;
use bevy::gizmos::retained::Gizmo;
use bevy::math::Vec3;
use bevy::prelude::{
    App, ChildOf, Children, Commands, Component, DetectChanges, Entity, Has, IntoScheduleConfigs,
    Local, Plugin, PostUpdate, Projection, Query, Ref, ResMut, Startup, Transform, Visibility,
    With,
};
use bevy::transform::TransformSystems;
use bevy::transform::components::GlobalTransform;

/// The layer of lines that an editor draws over its view of a scene: other cameras do not see them.
pub const OVERLAY_LAYER: usize = 14;

/// Draws [`DrawnLines`].
pub struct LinesPlugin;

impl Plugin for LinesPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Startup, spawn_first).add_systems(
            PostUpdate,
            draw_lines
                .after(TransformSystems::Propagate)
                .run_if(renderer_knows_the_first),
        );
    }
}

/// Frames until the renderer has looked at the gizmo of [`spawn_first`] for sure.
const UNTIL_KNOWN: u32 = 2;

/// A gizmo of no line without [`BeforeAll`], which stays.
///
/// A query goes through component sets in the order in which it learns of them, but of several that
/// are new to it in no order at all. So the renderer has to know this one before there is another.
fn spawn_first(mut commands: Commands, mut assets: ResMut<Assets<GizmoAsset>>) {
    let parent = commands.spawn((Transform::default(), Visibility::default()));
    let parent = parent.id();
    let gizmo = Gizmo {
        handle: assets.add(GizmoAsset::new()),
        ..Gizmo::default()
    };
    commands.spawn((gizmo, RenderLayers::default(), ChildOf(parent)));
}

fn renderer_knows_the_first(mut frames: Local<u32>) -> bool {
    *frames = frames.saturating_add(1);
    *frames > UNTIL_KNOWN
}

/// How much of a line is left where something stands before it.
const FAINT: f32 = 0.14;
/// Towards the viewer, so that a line on a surface is not half inside it.
const DEPTH_BIAS: f32 = -0.0004;
/// How much of a line is left however far it is.
const FARTHEST: f32 = 0.25;
/// The part of the lines' ends that are so near that they do not fade.
const NEAR_PART: f32 = 0.1;
/// Ends that are nearer than this part of the farthest's distance are at the viewer, as where camera
/// rays begin: they say nothing of how near the lines are.
const AT_VIEWER: f32 = 0.01;
/// Of so many ends at most that part is looked for.
const LOOKED_AT: usize = 2048;
/// How far the viewer moves before lines fade anew, as a part of the distance from which they do.
const MOVED: f32 = 0.1;
/// More lines than this fade anew only when the viewer rests: making them takes as long as a few
/// frames' worth of a moving hand.
const MOST_WHILE_MOVING: usize = 5000;

/// So many lines of a set are a crowd, in which depth has to be told. Fewer, as the rays of a pixel, one
/// of which may begin at the viewer, are all meant to be seen.
const CROWD: usize = 300;

/// A line from one point to another in world space, its colour linear between the ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Where it starts and ends.
    pub ends: [Vec3; 2],
    /// Linear RGB with opacity, at each end.
    pub colors: [LinearRgba; 2],
}

impl Line {
    /// Of one colour.
    pub fn new(from: Vec3, to: Vec3, color: LinearRgba) -> Self {
        Self {
            ends: [from, to],
            colors: [color; 2],
        }
    }
}

/// A set of lines that is drawn as long as the entity lives. In a perspective view of the tracer's
/// ([`TracedView`]) the farther ones of many are fainter, but for symbols ([`SymbolOf`]) and what is on top.
/// Cameras of the entity's `RenderLayers` show them.
#[derive(Component, Clone, Debug, Default, PartialEq)]
#[require(Transform, Visibility, Fade)]
pub struct DrawnLines {
    /// In world space.
    pub lines: Vec<Line>,
    /// In logical pixels.
    pub width: f32,
    /// Drawn over everything, at full strength.
    pub on_top: bool,
}

/// How lines of a set fade with the distance.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Fade(Option<Fading>);

#[derive(Clone, Copy, Debug, PartialEq)]
struct Fading {
    viewer: Vec3,
    /// The distance from which on they do.
    from: f32,
}

impl Fading {
    /// As this viewer sees lines. What is nearest of them has its full strength.
    fn of(lines: &[Line], viewer: Vec3) -> Self {
        let step = lines.len().div_ceil(LOOKED_AT).max(1);
        let ends = lines.iter().step_by(step).flat_map(|line| line.ends);
        let mut distances: Vec<f32> = ends.map(|end| end.distance(viewer)).collect();
        let finite = distances.iter().filter(|distance| distance.is_finite());
        let at_viewer = AT_VIEWER * finite.fold(0.0, |most: f32, &distance| most.max(distance));
        distances.retain(|&distance| distance > at_viewer);
        let place = (distances.len() as f32 * NEAR_PART) as usize;
        let from = match distances.len() {
            0 => 0.0,
            _ => *distances.select_nth_unstable_by(place, f32::total_cmp).1,
        };
        Self { viewer, from }
    }

    /// What is left of a line at a place: as the square of the distance.
    fn strength(self, at: Vec3) -> f32 {
        let distance = at.distance(self.viewer);
        if distance <= self.from {
            return 1.0;
        }
        // Not a number where the place is none.
        (self.from / distance).powi(2).max(FARTHEST)
    }
}

impl Fade {
    /// Whether lines that fade so look right to this viewer.
    fn fits(self, viewer: Option<Vec3>) -> bool {
        match (self.0, viewer) {
            (None, None) => true,
            (Some(fading), Some(viewer)) => fading.viewer.distance(viewer) <= MOVED * fading.from,
            _ => false,
        }
    }
}

/// On a gizmo that is drawn before everything. It writes the depth of that, so what has to be seen
/// beside it is drawn first: gizmos are drawn in the order in which a query finds them, and that goes
/// component set by component set, the one without this mark being the older ([`spawn_first`]).
#[derive(Component)]
struct BeforeAll;

/// Makes the gizmos of those sets that changed, and of those that the viewer has moved away from.
pub(super) fn draw_lines(
    mut commands: Commands,
    views: Query<(&Camera, &GlobalTransform, &Projection), With<TracedView>>,
    mut sets: Query<(
        Entity,
        Ref<DrawnLines>,
        &mut Fade,
        Option<&Children>,
        Option<&RenderLayers>,
        Has<SymbolOf>,
    )>,
    gizmos: Query<&Gizmo>,
    mut assets: ResMut<Assets<GizmoAsset>>,
    mut before: Local<Option<Vec3>>,
) {
    let viewer = views.iter().find(|(camera, ..)| camera.is_active);
    let viewer = viewer.and_then(|(_, transform, projection)| {
        matches!(projection, Projection::Perspective(_)).then(|| transform.translation())
    });
    let rests = std::mem::replace(&mut *before, viewer) == viewer;
    for (entity, drawn, mut fade, children, layers, is_symbol) in &mut sets {
        let fades = !is_symbol && !drawn.on_top && drawn.lines.len() >= CROWD;
        let viewer = viewer.filter(|_| fades);
        let may_fade = rests || drawn.lines.len() <= MOST_WHILE_MOVING;
        if !drawn.is_changed() && (fade.fits(viewer) || !may_fade) {
            continue;
        }
        *fade = Fade(viewer.map(|viewer| Fading::of(&drawn.lines, viewer)));
        let passes: &[(f32, f32)] = match (drawn.lines.is_empty(), drawn.on_top) {
            (true, _) => &[],
            (_, true) => &[(1.0, -1.0)],
            (_, false) => &[(1.0, DEPTH_BIAS), (FAINT, -1.0)],
        };
        let known: Vec<(Entity, &Gizmo)> = children
            .into_iter()
            .flatten()
            .filter_map(|child| Some((*child, gizmos.get(*child).ok()?)))
            .collect();
        let fits = |gizmo: &Gizmo, depth_bias: f32| {
            gizmo.depth_bias == depth_bias && gizmo.line_config.width == drawn.width
        };
        let all_fit = known.len() == passes.len()
            && (known.iter().zip(passes)).all(|((_, gizmo), (_, bias))| fits(gizmo, *bias));
        if all_fit {
            // The renderer has the old lines until the new ones reach it: nothing flickers.
            for ((_, gizmo), (strength, _)) in known.iter().zip(passes) {
                if let Some(mut lines) = assets.get_mut(&gizmo.handle) {
                    *lines = asset(&drawn.lines, *strength, fade.0);
                }
            }
            continue;
        }
        for (child, _) in known {
            commands.entity(child).despawn();
        }
        let layers = layers.cloned().unwrap_or_default();
        for &(strength, depth_bias) in passes {
            let gizmo = Gizmo {
                handle: assets.add(asset(&drawn.lines, strength, fade.0)),
                line_config: GizmoLineConfig {
                    width: drawn.width,
                    ..GizmoLineConfig::default()
                },
                depth_bias,
            };
            let mut child = commands.spawn((gizmo, layers.clone(), ChildOf(entity)));
            if depth_bias <= -1.0 {
                child.insert(BeforeAll);
            }
        }
    }
}

fn asset(lines: &[Line], strength: f32, fading: Option<Fading>) -> GizmoAsset {
    let mut asset = GizmoAsset::default();
    for line in lines {
        let [from, to] = [0, 1].map(|end| {
            let fades = fading.map_or(1.0, |fading| fading.strength(line.ends[end]));
            let color = line.colors[end];
            LinearRgba {
                alpha: color.alpha * strength * fades,
                ..color
            }
        });
        asset.line_gradient(line.ends[0], line.ends[1], from, to);
    }
    asset
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::ecs::system::RunSystemOnce;
    use bevy::ecs::world::World;
    use bevy::prelude::{Has, With};

    #[test]
    fn far_lines_are_fainter_than_near_ones_and_none_is_lost() {
        let line = |z: f32| Line::new(Vec3::Z * z, Vec3::Z * z, LinearRgba::WHITE);
        let lines: Vec<Line> = (1..=20).map(|z| line(z as f32)).collect();
        let fading = Fading::of(&lines, Vec3::ZERO);
        // Two of the twenty are the nearest tenth; the next begins to fade.
        assert_eq!(fading.from, 3.0);
        assert_eq!(fading.strength(Vec3::Z), 1.0);
        assert_eq!(fading.strength(Vec3::Z * 3.0), 1.0);
        assert_eq!(fading.strength(Vec3::Z * 4.0), 9.0 / 16.0);
        assert_eq!(fading.strength(Vec3::Z * 1e9), FARTHEST);
        assert_eq!(Fading::of(&[], Vec3::ONE).from, 0.0);
    }

    #[test]
    fn rays_that_begin_at_the_viewer_do_not_make_all_of_them_faint() {
        let line = |z: f32| Line::new(Vec3::Z * 1e-3, Vec3::Z * z, LinearRgba::WHITE);
        let lines: Vec<Line> = (1..=20).map(|z| line(z as f32)).collect();
        assert_eq!(Fading::of(&lines, Vec3::ZERO).from, 3.0);
        let points = [Line::new(Vec3::ONE, Vec3::ONE, LinearRgba::WHITE); 3];
        assert_eq!(Fading::of(&points, Vec3::ONE).from, 0.0);
    }

    #[test]
    fn lines_fade_anew_when_the_viewer_has_moved_far_enough_to_see_it() {
        let fading = Fading {
            viewer: Vec3::ZERO,
            from: 10.0,
        };
        let fade = Fade(Some(fading));
        assert!(fade.fits(Some(Vec3::X * 0.9)) && !fade.fits(Some(Vec3::X * 1.1)));
        assert!(!fade.fits(None) && Fade(None).fits(None) && !Fade(None).fits(Some(Vec3::X)));
    }

    #[test]
    fn faint_lines_are_drawn_after_all_others_whichever_set_was_made_last() {
        let mut world = World::new();
        world.insert_resource(Assets::<GizmoAsset>::default());
        let line = Line::new(Vec3::ZERO, Vec3::X, LinearRgba::WHITE);
        let set = DrawnLines {
            lines: vec![line],
            ..DrawnLines::default()
        };
        let mut sets: Vec<Entity> = (0..4).map(|_| world.spawn(set.clone()).id()).collect();
        world.run_system_once(draw_lines).unwrap();
        for again in [0, 2, 1, 0] {
            // A new set in place of the old one.
            world.despawn(sets[again]);
            sets[again] = world.spawn(set.clone()).id();
            world.run_system_once(draw_lines).unwrap();
            let mut gizmos = world.query_filtered::<Has<BeforeAll>, With<Gizmo>>();
            let faint: Vec<bool> = gizmos.iter(&world).collect();
            assert!(faint.is_sorted(), "{faint:?}");
            assert!(faint.contains(&true) && faint.contains(&false));
        }
    }
}
