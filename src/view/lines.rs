//! Lines in a Bevy view, drawn by its retained gizmos.
//!
//! A [`DrawnLines`] is one set of lines, with its two gizmo assets: one hidden by what stands before
//! it, and a faint one that is not. They are made again only where the lines changed, so that a
//! hundred thousand lines cost nothing while they stand.

use bevy::asset::Assets;
use bevy::camera::visibility::RenderLayers;
use bevy::color::LinearRgba;
use bevy::gizmos::GizmoAsset;
use bevy::gizmos::config::GizmoLineConfig;
use bevy::gizmos::retained::Gizmo;
use bevy::math::Vec3;
use bevy::prelude::{
    App, Changed, ChildOf, Children, Commands, Component, Entity, Plugin, PostUpdate, Query,
    ResMut, Transform, Visibility,
};

/// Draws [`DrawnLines`].
pub struct LinesPlugin;

impl Plugin for LinesPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(PostUpdate, draw_lines);
    }
}

/// How much of a line is left where something stands before it.
const FAINT: f32 = 0.14;
/// Towards the viewer, so that a line on a surface is not half inside it.
const DEPTH_BIAS: f32 = -0.0004;

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

/// A set of lines that is drawn as long as the entity lives.
#[derive(Component, Clone, Debug, Default, PartialEq)]
#[require(Transform, Visibility)]
pub struct DrawnLines {
    /// In world space.
    pub lines: Vec<Line>,
    /// In logical pixels.
    pub width: f32,
    /// Drawn over everything, at full strength.
    pub on_top: bool,
}

/// On a gizmo that is drawn before everything. It writes the depth of that, so what has to be seen
/// beside it is drawn first: gizmos are drawn in the order in which a query finds them, and that goes
/// component set by component set, the one without this mark being the older.
#[derive(Component)]
struct BeforeAll;

/// Makes the gizmos of those sets that changed.
pub(super) fn draw_lines(
    mut commands: Commands,
    changed: Query<
        (
            Entity,
            &DrawnLines,
            Option<&Children>,
            Option<&RenderLayers>,
        ),
        Changed<DrawnLines>,
    >,
    gizmos: Query<(), bevy::prelude::With<Gizmo>>,
    mut assets: ResMut<Assets<GizmoAsset>>,
) {
    for (entity, drawn, children, layers) in &changed {
        for child in children.into_iter().flatten() {
            if gizmos.contains(*child) {
                commands.entity(*child).despawn();
            }
        }
        if drawn.lines.is_empty() {
            continue;
        }
        let layers = layers.cloned().unwrap_or_default();
        let mut draw = |strength: f32, depth_bias: f32| {
            let gizmo = Gizmo {
                handle: assets.add(asset(&drawn.lines, strength)),
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
        };
        if drawn.on_top {
            draw(1.0, -1.0);
        } else {
            draw(1.0, DEPTH_BIAS);
            draw(FAINT, -1.0);
        }
    }
}

fn asset(lines: &[Line], strength: f32) -> GizmoAsset {
    let mut asset = GizmoAsset::default();
    for line in lines {
        let colors = line.colors.map(|color| LinearRgba {
            alpha: color.alpha * strength,
            ..color
        });
        asset.line_gradient(line.ends[0], line.ends[1], colors[0], colors[1]);
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
