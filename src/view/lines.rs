//! Lines in a Bevy view, drawn by its retained gizmos.
//!
//! A [`DrawnLines`] is one set of lines, with its two gizmo assets: one hidden by what stands before
//! it, and a faint one that is not. They are made again only where the lines changed, so that a
//! hundred thousand lines cost nothing while they stand.

use super::symbols::SymbolOf;
use super::traced::TracedView;
use bevy::asset::Assets;
use bevy::camera::visibility::RenderLayers;
use bevy::camera::{Camera, Projection};
use bevy::color::LinearRgba;
use bevy::gizmos::GizmoAsset;
use bevy::gizmos::config::GizmoLineConfig;
use bevy::gizmos::retained::Gizmo;
use bevy::math::Vec3;
use bevy::prelude::{
    App, Changed, ChildOf, Children, Commands, Component, Entity, IntoScheduleConfigs, Plugin,
    PostUpdate, Query, ResMut, Transform, Visibility, With, Without,
};
use bevy::transform::TransformSystems;
use bevy::transform::components::GlobalTransform;

/// Draws [`DrawnLines`].
pub struct LinesPlugin;

impl Plugin for LinesPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            PostUpdate,
            (
                draw_lines,
                fade_lines
                    .after(draw_lines)
                    .after(TransformSystems::Propagate),
            ),
        );
    }
}

/// How much of a line is left where something stands before it.
const FAINT: f32 = 0.14;
/// Towards the viewer, so that a line on a surface is not half inside it.
const DEPTH_BIAS: f32 = -0.0004;
/// Where lines begin to fade, as a part of the distance of the farthest: a line there has its full
/// width. Those that are nearer are no more than a few times as wide, those at the far end keep a
/// quarter of their strength.
const FADES_FROM: f32 = 0.25;

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
/// ([`TracedView`]) the farther ones are thinner and fainter, but for symbols ([`SymbolOf`]).
#[derive(Component, Clone, Debug, Default, PartialEq)]
#[require(Transform, Visibility, Reach)]
pub struct DrawnLines {
    /// In world space.
    pub lines: Vec<Line>,
    /// In logical pixels.
    pub width: f32,
    /// Drawn over everything, at full strength.
    pub on_top: bool,
}

/// A sphere around all lines of a set.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Reach {
    middle: Vec3,
    radius: f32,
}

impl Reach {
    fn of(lines: &[Line]) -> Self {
        let ends = || lines.iter().flat_map(|line| line.ends);
        let (min, max) = ends().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), end| {
            (min.min(end), max.max(end))
        });
        let reach = Self {
            middle: 0.5 * (min + max),
            radius: 0.5 * (max - min).length(),
        };
        match reach.middle.is_finite() && reach.radius.is_finite() {
            true => reach,
            false => Self::default(),
        }
    }

    /// The distance from the viewer at which lines have their full width; nearer ones are wider,
    /// farther ones fainter.
    fn fades_from(&self, viewer: Vec3) -> f32 {
        let distance = (self.middle - viewer).length();
        let farthest = distance + self.radius;
        (distance - self.radius).max(FADES_FROM * farthest)
    }
}

/// Makes the gizmos of those sets that changed.
pub(super) fn draw_lines(
    mut commands: Commands,
    mut changed: Query<
        (
            Entity,
            &DrawnLines,
            &mut Reach,
            Option<&Children>,
            Option<&RenderLayers>,
        ),
        Changed<DrawnLines>,
    >,
    gizmos: Query<(), With<Gizmo>>,
    mut assets: ResMut<Assets<GizmoAsset>>,
) {
    for (entity, drawn, mut reach, children, layers) in &mut changed {
        for child in children.into_iter().flatten() {
            if gizmos.contains(*child) {
                commands.entity(*child).despawn();
            }
        }
        if drawn.lines.is_empty() {
            continue;
        }
        *reach = Reach::of(&drawn.lines);
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
            commands.spawn((gizmo, layers.clone(), ChildOf(entity)));
        };
        if drawn.on_top {
            draw(1.0, -1.0);
        } else {
            draw(1.0, DEPTH_BIAS);
            draw(FAINT, -1.0);
        }
    }
}

/// Has farther lines thinner and fainter: the renderer divides a line's width by its distance, and
/// what is thinner than a pixel is drawn as faint as it is thin. So no line is made again when the
/// view moves.
pub(super) fn fade_lines(
    views: Query<(&Camera, &GlobalTransform, &Projection), With<TracedView>>,
    sets: Query<(&DrawnLines, &Reach, &Children), Without<SymbolOf>>,
    mut gizmos: Query<&mut Gizmo>,
) {
    let Some((camera, transform, projection)) = views.iter().find(|(camera, ..)| camera.is_active)
    else {
        return;
    };
    let scale = camera.target_scaling_factor().unwrap_or(1.0);
    let perspective = matches!(projection, Projection::Perspective(_));
    for (drawn, reach, children) in &sets {
        let fades = perspective && !drawn.on_top;
        let width = match fades {
            true => drawn.width * scale * reach.fades_from(transform.translation()),
            false => drawn.width * scale,
        };
        let mut gizmos = gizmos.iter_many_mut(children);
        while let Some(mut gizmo) = gizmos.fetch_next() {
            let config = &gizmo.line_config;
            if config.perspective != fades || config.width != width {
                gizmo.line_config.perspective = fades;
                gizmo.line_config.width = width;
            }
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

    #[test]
    fn lines_fade_from_where_they_begin_but_never_from_too_near() {
        let white = LinearRgba::WHITE;
        let lines = [
            Line::new(Vec3::NEG_X, Vec3::X, white),
            Line::new(Vec3::ZERO, Vec3::X, white),
        ];
        let reach = Reach::of(&lines);
        assert_eq!((reach.middle, reach.radius), (Vec3::ZERO, 1.0));
        // From outside: from the nearest end of the sphere on.
        assert_eq!(reach.fades_from(Vec3::Z * 10.0), 9.0);
        // From within, and from just outside.
        assert_eq!(reach.fades_from(Vec3::ZERO), FADES_FROM);
        assert_eq!(reach.fades_from(Vec3::Z), 2.0 * FADES_FROM);
        assert_eq!(Reach::of(&[]), Reach::default());
    }
}
