//! What the tracer's picture does not show, drawn over it: lights as what they are, cameras,
//! and an outline of what is selected.
//!
//! Each entity's lines are made again when it changed, and only then.

mod bounds;

use super::lines::{DrawnLines, OVERLAY_LAYER};
use super::sketch::{Sketch, colors};
use crate::scene::{
    AnyLamp, DirectionalLamp, ParallelogramLamp, PointLamp, SceneCamera, SceneId, SegmentLamp,
};
use crate::sync::Traced;
use crate::trace;
use bevy::camera::Camera;
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::{InheritedVisibility, RenderLayers};
use bevy::ecs::entity_disabling::Disabled;
use bevy::math::{Affine3A, Vec2, Vec3};
use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::{
    Added, App, Changed, ChildOf, Children, Commands, Component, DetectChanges, DetectChangesMut,
    Entity, IntoScheduleConfigs, Or, Plugin, PostUpdate, Query, RemovedComponents, Res, ResMut,
    Resource, With, Without,
};
use bevy::transform::TransformSystems;
use bevy::transform::components::GlobalTransform;
use bounds::{Below, Bounds, Measured, bounds_below};
use std::iter;

/// Draws symbols, for cameras of [`OVERLAY_LAYER`]. Needs [`LinesPlugin`](super::LinesPlugin).
pub struct SymbolsPlugin;

impl Plugin for SymbolsPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Symbols>()
            .init_resource::<Outlined>()
            .init_resource::<SymbolsOf>()
            .add_systems(
                PostUpdate,
                draw_symbols
                    .after(TransformSystems::Propagate)
                    .after(crate::sync::SyncSystems)
                    .before(super::lines::draw_lines),
            );
    }
}

/// Which symbols are drawn.
#[derive(Resource, Clone, Debug, PartialEq)]
pub struct Symbols {
    /// Lights, each as what it is.
    pub lights: bool,
    /// Cameras as pyramids.
    pub cameras: bool,
    /// The outline of what is selected.
    pub outlines: bool,
    /// The camera that is looked through, which does not see itself.
    pub hidden_camera: Option<SceneId>,
}

impl Default for Symbols {
    fn default() -> Self {
        Self {
            lights: true,
            cameras: true,
            outlines: true,
            hidden_camera: None,
        }
    }
}

/// Which entities have an outline; the last is the active one.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub struct Outlined(pub Vec<SceneId>);

/// Radius of the symbol of a light without an extent, as a part of the scene's extent.
const SIZE: f32 = 0.025;
/// Metres, where the scene has no extent.
const SIZE_ALONE: f32 = 0.08;
/// How much the scene's extent has to change before symbols change theirs.
const NEW_SIZE: f32 = 1.3;
/// Logical pixels.
const WIDTH: f32 = 1.5;

/// The lines of each entity that has a symbol.
#[derive(Resource)]
struct SymbolsOf {
    lines: HashMap<Entity, Entity>,
    /// Metres: the radius of a light without an extent.
    size: f32,
    /// Those of [`Outlined`]: thousands may be selected, and none is looked for in all of them.
    chosen: HashSet<SceneId>,
    /// How many were made again in the last frame: a test's proof that others are not.
    redone: usize,
}

impl Default for SymbolsOf {
    fn default() -> Self {
        Self {
            lines: HashMap::default(),
            size: SIZE_ALONE,
            chosen: HashSet::default(),
            redone: 0,
        }
    }
}

/// The radius of symbols for this scene.
fn symbol_size(world: &trace::World) -> f32 {
    let mut bounds: Option<obvhs::aabb::Aabb> = None;
    for instance in world.aggregate.instances() {
        if let Some(more) = instance.world_bounds() {
            bounds = Some(bounds.map_or(more, |bounds| bounds.union(&more)));
        }
    }
    let extent = bounds.map_or(0.0, |bounds| Vec3::from(bounds.diagonal()).length());
    if extent.is_finite() && extent > 0.0 {
        SIZE * extent
    } else {
        SIZE_ALONE
    }
}

/// On an entity with the lines of another one.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct SymbolOf {
    /// Whose lines these are.
    pub id: SceneId,
    /// These are a light or a camera, which rays do not meet: they are picked by their lines. An
    /// object's outline is not.
    pub is_picked: bool,
}

/// The symbol nearest to a place of the viewport (logical pixels from its top left), and how far
/// off it is, in pixels.
pub fn nearest_symbol<'a>(
    place: Vec2,
    camera: &Camera,
    camera_place: &GlobalTransform,
    symbols: impl IntoIterator<Item = (&'a SymbolOf, &'a DrawnLines)>,
) -> Option<(SceneId, f32)> {
    let mut nearest: Option<(SceneId, f32)> = None;
    for (symbol, drawn) in symbols {
        if !symbol.is_picked {
            continue;
        }
        for line in &drawn.lines {
            let ends = line
                .ends
                .map(|end| camera.world_to_viewport(camera_place, end));
            let [Ok(from), Ok(to)] = ends else {
                continue;
            };
            let corner = camera.logical_viewport_rect().map_or(Vec2::ZERO, |r| r.min);
            let distance = distance_to_segment(place, [from - corner, to - corner]);
            if nearest.is_none_or(|(_, least)| distance < least) {
                nearest = Some((symbol.id, distance));
            }
        }
    }
    nearest
}

fn distance_to_segment(point: Vec2, [from, to]: [Vec2; 2]) -> f32 {
    let along = to - from;
    let t = (point - from).dot(along) / along.length_squared().max(1e-12);
    point.distance(from + along * t.clamp(0.0, 1.0))
}

type Anything<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static SceneId,
        &'static GlobalTransform,
        Option<&'static InheritedVisibility>,
        Option<&'static PointLamp>,
        Option<&'static DirectionalLamp>,
        Option<&'static SegmentLamp>,
        Option<&'static ParallelogramLamp>,
        Option<&'static SceneCamera>,
        Option<&'static Aabb>,
    ),
>;

type HasSymbol = Or<(AnyLamp, With<SceneCamera>)>;

type Edited = Or<(
    Changed<GlobalTransform>,
    Changed<InheritedVisibility>,
    Changed<PointLamp>,
    Changed<DirectionalLamp>,
    Changed<SegmentLamp>,
    Changed<ParallelogramLamp>,
    Changed<SceneCamera>,
    Changed<Aabb>,
)>;

/// Without them a symbol is another one, or none.
type Lost<'w, 's> = (
    RemovedComponents<'w, 's, PointLamp>,
    RemovedComponents<'w, 's, DirectionalLamp>,
    RemovedComponents<'w, 's, SegmentLamp>,
    RemovedComponents<'w, 's, ParallelogramLamp>,
    RemovedComponents<'w, 's, SceneCamera>,
    RemovedComponents<'w, 's, Aabb>,
);

type Groups<'w, 's> = Query<'w, 's, &'static SceneId, Without<Aabb>>;
type Above<'w, 's> = Query<'w, 's, &'static ChildOf>;
type Moved = (With<Aabb>, Or<(Changed<GlobalTransform>, Changed<Aabb>)>);

fn draw_symbols(
    mut commands: Commands,
    switches: Res<Symbols>,
    outlined: Res<Outlined>,
    traced: Res<Traced>,
    mut symbols: ResMut<SymbolsOf>,
    things: Anything,
    lasting: Query<Entity, HasSymbol>,
    edited: Query<Entity, (With<SceneId>, Edited)>,
    selected: Query<(Entity, &SceneId)>,
    (groups, above, below, measured): (Groups, Above, Below, Measured),
    moved: Query<Entity, Moved>,
    (regrouped, mut emptied): (
        Query<Entity, Changed<Children>>,
        RemovedComponents<Children>,
    ),
    (mut gone, mut enabled): (RemovedComponents<SceneId>, RemovedComponents<Disabled>),
    mut lost: Lost,
    disabled: Query<Entity, (With<SceneId>, Added<Disabled>)>,
    mut drawn: Query<(&mut DrawnLines, &mut SymbolOf)>,
) {
    for entity in gone.read().chain(&disabled) {
        if let Some(lines) = symbols.lines.remove(&entity) {
            commands.entity(lines).despawn();
        }
    }
    let mut redo: HashSet<Entity> = HashSet::default();
    let mut other = switches.is_changed() || outlined.is_changed();
    if traced.is_changed() && traced.changes.top_level {
        let size = symbol_size(&traced.world);
        let ratio = size / symbols.size;
        if !(1.0 / NEW_SIZE..NEW_SIZE).contains(&ratio) {
            symbols.size = size;
            other = true;
        }
    }
    let (point, directional, segment, parallelogram, camera, aabb) = &mut lost;
    let lost: Vec<Entity> = (point.read().chain(directional.read()))
        .chain(segment.read().chain(parallelogram.read()))
        .chain(camera.read().chain(aabb.read()))
        .collect();
    let lost = lost.iter().copied();
    for entity in edited.iter().chain(enabled.read()).chain(lost.clone()) {
        if symbols.lines.contains_key(&entity) || lasting.contains(entity) {
            redo.insert(entity);
        }
    }
    let SymbolsOf {
        lines: held,
        size,
        chosen,
        redone,
    } = &mut *symbols;
    if outlined.is_changed() {
        *chosen = outlined.0.iter().copied().collect();
    }
    // Around what has changed there may be groups with an outline.
    let changed = moved.iter().chain(lost);
    let changed = changed.chain(&regrouped).chain(emptied.read());
    let mut seen: HashSet<Entity> = HashSet::default();
    for entity in changed.filter(|_| !chosen.is_empty()) {
        let way = iter::once(entity).chain(above.iter_ancestors(entity));
        let new = way.take_while(|&entity| seen.insert(entity));
        redo.extend(new.filter(|&entity| groups.get(entity).is_ok_and(|id| chosen.contains(id))));
    }
    *redone = redo.len();
    if !other && redo.is_empty() {
        return;
    }
    if other {
        redo.extend(held.keys());
        redo.extend(&lasting);
        if !chosen.is_empty() {
            let selected = selected.iter().filter(|(_, id)| chosen.contains(*id));
            redo.extend(selected.map(|(entity, _)| entity));
        }
    }
    *redone = redo.len();
    let mut known: HashMap<Entity, Bounds> = HashMap::default();
    for entity in redo {
        let Ok((_, id, place, visible, point, directional, segment, parallelogram, camera, aabb)) =
            things.get(entity)
        else {
            continue;
        };
        let place = place.affine();
        let mut sketch = Sketch {
            size: *size,
            ..Sketch::default()
        };
        let visible = visible.is_none_or(|visible| visible.get());
        let outline = switches.outlines && chosen.contains(id);
        let active = outlined.0.last() == Some(id);
        sketch.tint = outline.then_some(if active {
            colors::ACTIVE
        } else {
            colors::SELECTED
        });
        if switches.lights && (visible || outline) {
            if let Some(lamp) = point {
                sketch.point(&place, lamp);
            }
            if let Some(lamp) = directional {
                sketch.directional(&place, lamp);
            }
            if let Some(lamp) = segment {
                sketch.segment(&place, lamp);
            }
            if let Some(lamp) = parallelogram {
                sketch.parallelogram(&place, lamp);
            }
        }
        if let Some(camera) = camera
            && switches.cameras
            && switches.hidden_camera != Some(*id)
        {
            sketch.camera(&place, camera);
        }
        if let Some(tint) = sketch.tint {
            match aabb {
                Some(aabb) => sketch.bounds(&place, aabb, tint),
                None if sketch.lines.is_empty() => {
                    match bounds_below(entity, &below, &measured, &mut known) {
                        Some(bounds) => sketch.bounds(&Affine3A::IDENTITY, &bounds, tint),
                        None => sketch.axes(&place, tint),
                    }
                }
                None => {}
            }
        }
        let wanted = DrawnLines {
            lines: sketch.lines,
            width: WIDTH,
            on_top: false,
        };
        let symbol = SymbolOf {
            id: *id,
            is_picked: lasting.contains(entity),
        };
        let before = held.get(&entity).copied();
        match before.and_then(|lines| drawn.get_mut(lines).ok()) {
            Some((mut lines, mut before)) => {
                lines.set_if_neq(wanted);
                before.set_if_neq(symbol);
            }
            None if wanted.lines.is_empty() => {}
            None => {
                let lines = commands
                    .spawn((RenderLayers::layer(OVERLAY_LAYER), symbol, wanted))
                    .id();
                held.insert(entity, lines);
            }
        }
    }
}

#[cfg(test)]
mod tests;
