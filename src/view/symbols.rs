//! What the tracer's picture does not show, drawn over it: lights as what they are, cameras,
//! and an outline of what is selected.
//!
//! Each entity's lines are made again when it changed, and only then.

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
use bevy::math::{Affine3A, Vec2, Vec3, Vec3A};
use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::{
    Added, App, Changed, Children, Commands, Component, DetectChanges, DetectChangesMut, Entity,
    IntoScheduleConfigs, Or, Plugin, PostUpdate, Query, RemovedComponents, Res, ResMut, Resource,
    With, Without,
};
use bevy::transform::TransformSystems;
use bevy::transform::components::GlobalTransform;

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
}

impl Default for SymbolsOf {
    fn default() -> Self {
        Self {
            lines: HashMap::default(),
            size: SIZE_ALONE,
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

type Groups<'w, 's> = Query<'w, 's, (Entity, &'static SceneId), (With<Children>, Without<Aabb>)>;
type Below<'w, 's> = Query<'w, 's, &'static Children>;
type Measured<'w, 's> = Query<'w, 's, (&'static GlobalTransform, &'static Aabb)>;

/// The box in the world around what hangs below an entity; `None` where that has no size.
fn bounds_below(entity: Entity, below: &Below, measured: &Measured) -> Option<Aabb> {
    let mut bounds: Option<[Vec3A; 2]> = None;
    for (place, aabb) in measured.iter_many(below.iter_descendants(entity)) {
        let place = place.affine();
        let center = place.transform_point3a(aabb.center);
        let axes = place.matrix3;
        let [x, y, z] = aabb.half_extents.to_array();
        let half = axes.x_axis.abs() * x + axes.y_axis.abs() * y + axes.z_axis.abs() * z;
        let [least, most] = bounds.unwrap_or([center - half, center + half]);
        bounds = Some([least.min(center - half), most.max(center + half)]);
    }
    bounds.map(|[least, most]| Aabb::from_min_max(least.into(), most.into()))
}

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
    (groups, below, measured): (Groups, Below, Measured),
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
    // Around what has changed there may be a group with an outline.
    if !outlined.0.is_empty() && (!edited.is_empty() || lost.len() > 0) {
        let chosen = groups.iter().filter(|(_, id)| outlined.0.contains(id));
        redo.extend(chosen.map(|(entity, _)| entity));
    }
    if !other && redo.is_empty() {
        return;
    }
    // Thousands may be selected: none is looked for in all of them.
    let chosen: HashSet<SceneId> = outlined.0.iter().copied().collect();
    if other {
        redo.extend(symbols.lines.keys());
        redo.extend(&lasting);
        if !chosen.is_empty() {
            let selected = selected.iter().filter(|(_, id)| chosen.contains(*id));
            redo.extend(selected.map(|(entity, _)| entity));
        }
    }
    for entity in redo {
        let Ok((_, id, place, visible, point, directional, segment, parallelogram, camera, aabb)) =
            things.get(entity)
        else {
            continue;
        };
        let place = place.affine();
        let mut sketch = Sketch {
            size: symbols.size,
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
                None if sketch.lines.is_empty() => match bounds_below(entity, &below, &measured) {
                    Some(bounds) => sketch.bounds(&Affine3A::IDENTITY, &bounds, tint),
                    None => sketch.axes(&place, tint),
                },
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
        let held = symbols.lines.get(&entity).copied();
        match held.and_then(|lines| drawn.get_mut(lines).ok()) {
            Some((mut lines, mut before)) => {
                lines.set_if_neq(wanted);
                before.set_if_neq(symbol);
            }
            None if wanted.lines.is_empty() => {}
            None => {
                let lines = commands
                    .spawn((RenderLayers::layer(OVERLAY_LAYER), symbol, wanted))
                    .id();
                symbols.lines.insert(entity, lines);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_as_far_from_a_line_as_from_its_nearest_point() {
        let line = [Vec2::new(1.0, 1.0), Vec2::new(5.0, 1.0)];
        for (place, distance) in [
            (Vec2::new(3.0, 4.0), 3.0),
            (Vec2::new(-2.0, 5.0), 5.0),
            (Vec2::new(8.0, -3.0), 5.0),
        ] {
            assert_eq!(distance_to_segment(place, line), distance);
        }
        let point = [Vec2::ONE; 2];
        assert_eq!(distance_to_segment(Vec2::new(1.0, 3.0), point), 2.0);
    }

    #[test]
    fn a_group_has_an_outline_around_all_that_hangs_below_it() {
        use bevy::ecs::system::RunSystemOnce;
        use bevy::prelude::{ChildOf, Transform, World};
        let mut world = World::new();
        let root = world.spawn(GlobalTransform::IDENTITY).id();
        let unit = Aabb::from_min_max(Vec3::splat(-1.0), Vec3::splat(1.0));
        let place = Transform::from_xyz(3.0, 0.0, 0.0).with_scale(Vec3::splat(2.0));
        let inner = world.spawn((ChildOf(root), GlobalTransform::IDENTITY)).id();
        world.spawn((ChildOf(inner), GlobalTransform::from(place), unit));
        world.spawn((ChildOf(root), GlobalTransform::IDENTITY, unit));
        let bounds = move |below: Below, measured: Measured| bounds_below(root, &below, &measured);
        let bounds = world.run_system_once(bounds).unwrap().unwrap();
        let found = [bounds.min(), bounds.max()].map(Vec3::from);
        assert_eq!(
            found,
            [Vec3::new(-1.0, -2.0, -2.0), Vec3::new(5.0, 2.0, 2.0)]
        );
        let alone = move |below: Below, measured: Measured| bounds_below(inner, &below, &measured);
        assert!(world.run_system_once(alone).unwrap().is_some());
        world.despawn(inner);
        let none = world.spawn_empty().id();
        let none = move |below: Below, measured: Measured| bounds_below(none, &below, &measured);
        assert!(world.run_system_once(none).unwrap().is_none());
    }

    /// What draws symbols, alone.
    fn drawing() -> App {
        let mut app = App::new();
        app.init_resource::<Traced>()
            .init_resource::<Symbols>()
            .init_resource::<Outlined>()
            .init_resource::<SymbolsOf>()
            .add_systems(PostUpdate, draw_symbols);
        app
    }

    /// How many lines each symbol has, and whether it is picked by them.
    fn drawn(app: &mut App) -> Vec<(usize, bool)> {
        app.update();
        let mut all = app.world_mut().query::<(&SymbolOf, &DrawnLines)>();
        let all = all.iter(app.world());
        all.map(|(symbol, drawn)| (drawn.lines.len(), symbol.is_picked))
            .collect()
    }

    #[test]
    fn what_is_a_light_no_more_has_no_symbol_and_is_picked_by_none() {
        let mut app = drawing();
        let place = GlobalTransform::IDENTITY;
        let id = SceneId(7);
        let lamp = (PointLamp::default(), InheritedVisibility::VISIBLE);
        let entity = app.world_mut().spawn((id, place, lamp)).id();
        let [(lines, true)] = drawn(&mut app)[..] else {
            panic!("a light has a symbol");
        };
        assert!(lines > 0);
        app.world_mut().entity_mut(entity).remove::<PointLamp>();
        assert_eq!(drawn(&mut app), [(0, false)]);
        // What is selected has its axes then.
        app.world_mut().resource_mut::<Outlined>().0 = vec![id];
        let axes = drawn(&mut app);
        assert!(matches!(axes[..], [(1.., false)]), "{axes:?}");
        app.world_mut()
            .entity_mut(entity)
            .insert(PointLamp::default());
        let lamp = drawn(&mut app);
        assert!(matches!(lamp[..], [(_, true)]) && lamp != axes, "{lamp:?}");
        app.world_mut().entity_mut(entity).remove::<PointLamp>();
        assert_eq!(drawn(&mut app), axes);
        let unit = Aabb::from_min_max(Vec3::splat(-1.0), Vec3::splat(1.0));
        app.world_mut().entity_mut(entity).insert(unit);
        assert_eq!(drawn(&mut app), [(12, false)], "the box of an object");
        app.world_mut().entity_mut(entity).remove::<Aabb>();
        assert_eq!(drawn(&mut app), axes);
    }
}
