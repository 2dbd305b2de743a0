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
    Added, App, Changed, ChildOf, Children, Commands, Component, DetectChanges, DetectChangesMut,
    Entity, IntoScheduleConfigs, Or, Plugin, PostUpdate, Query, RemovedComponents, Res, ResMut,
    Resource, With, Without,
};
use bevy::transform::TransformSystems;
use bevy::transform::components::GlobalTransform;
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
type Below<'w, 's> = Query<'w, 's, &'static Children>;
type Measured<'w, 's> = Query<'w, 's, (&'static GlobalTransform, &'static Aabb)>;
type Moved = (With<Aabb>, Or<(Changed<GlobalTransform>, Changed<Aabb>)>);

/// Least and most corner of a box in the world; `None` where nothing has a size.
type Bounds = Option<[Vec3A; 2]>;

fn union(a: Bounds, b: Bounds) -> Bounds {
    match (a, b) {
        (Some([least, most]), Some([lesser, greater])) => {
            Some([least.min(lesser), most.max(greater)])
        }
        (a, b) => a.or(b),
    }
}

fn world_bounds(place: &GlobalTransform, aabb: &Aabb) -> [Vec3A; 2] {
    let place = place.affine();
    let center = place.transform_point3a(aabb.center);
    let axes = place.matrix3;
    let [x, y, z] = aabb.half_extents.to_array();
    let half = axes.x_axis.abs() * x + axes.y_axis.abs() * y + axes.z_axis.abs() * z;
    [center - half, center + half]
}

/// The box in the world around what hangs below an entity; `None` where that has no size. Of groups within groups, all may
/// be asked for: each is looked into once, and `known` remembers it.
fn bounds_below(
    entity: Entity,
    below: &Below,
    measured: &Measured,
    known: &mut HashMap<Entity, Bounds>,
) -> Option<Aabb> {
    let own = |entity: Entity| {
        let (place, aabb) = measured.get(entity).ok()?;
        Some(world_bounds(place, aabb))
    };
    let mut waiting = vec![(entity, false)];
    while let Some((entity, are_children_known)) = waiting.pop() {
        if known.contains_key(&entity) {
            continue;
        }
        let children = below.get(entity).map_or(&[][..], |children| children);
        if !are_children_known && !children.is_empty() {
            waiting.push((entity, true));
            waiting.extend(children.iter().map(|&child| (child, false)));
            continue;
        }
        let with_below = |&child: &Entity| union(own(child), known.get(&child).copied().flatten());
        let bounds = children.iter().map(with_below).fold(None, union);
        known.insert(entity, bounds);
    }
    let [least, most] = known.get(&entity).copied().flatten()?;
    Some(Aabb::from_min_max(least.into(), most.into()))
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
        use bevy::prelude::{Transform, World};
        let mut world = World::new();
        let root = world.spawn(GlobalTransform::IDENTITY).id();
        let unit = Aabb::from_min_max(Vec3::splat(-1.0), Vec3::splat(1.0));
        let place = Transform::from_xyz(3.0, 0.0, 0.0).with_scale(Vec3::splat(2.0));
        let inner = world.spawn((ChildOf(root), GlobalTransform::IDENTITY)).id();
        world.spawn((ChildOf(inner), GlobalTransform::from(place), unit));
        world.spawn((ChildOf(root), GlobalTransform::IDENTITY, unit));
        let of = |entity: Entity| {
            move |below: Below, measured: Measured| {
                bounds_below(entity, &below, &measured, &mut HashMap::default())
            }
        };
        let bounds = world.run_system_once(of(root)).unwrap().unwrap();
        let found = [bounds.min(), bounds.max()].map(Vec3::from);
        assert_eq!(
            found,
            [Vec3::new(-1.0, -2.0, -2.0), Vec3::new(5.0, 2.0, 2.0)]
        );
        assert!(world.run_system_once(of(inner)).unwrap().is_some());
        world.despawn(inner);
        let none = world.spawn_empty().id();
        assert!(world.run_system_once(of(none)).unwrap().is_none());
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

    #[test]
    fn of_thousands_of_outlined_groups_those_around_what_changed_are_made_again() {
        let mut app = drawing();
        let world = app.world_mut();
        let unit = Aabb::from_min_max(Vec3::splat(-1.0), Vec3::splat(1.0));
        let mut parts = Vec::new();
        let mut ids = Vec::new();
        for number in 1..=2000 {
            let id = SceneId(number);
            let outer = world.spawn((id, GlobalTransform::IDENTITY)).id();
            let below = (GlobalTransform::IDENTITY, ChildOf(outer));
            let inner = world.spawn((SceneId(10_000 + number), below)).id();
            ids.extend([id, SceneId(10_000 + number)]);
            // Not of the scene: a part of a model that an app has put there.
            let part = (GlobalTransform::IDENTITY, unit, ChildOf(inner));
            parts.push(world.spawn(part).id());
        }
        world.resource_mut::<Outlined>().0 = ids;
        let redone = |app: &mut App| {
            app.update();
            app.world().resource::<SymbolsOf>().redone
        };
        assert_eq!(redone(&mut app), 4000);
        assert_eq!(redone(&mut app), 0);
        let place = GlobalTransform::from_xyz(5.0, 0.0, 0.0);
        app.world_mut().entity_mut(parts[3]).insert(place);
        assert_eq!(redone(&mut app), 2, "the two groups around it");
        app.world_mut().despawn(parts[4]);
        assert_eq!(redone(&mut app), 2);
        let mut all = app.world_mut().query::<(&SymbolOf, &DrawnLines)>();
        let mut least: Vec<f32> = (all.iter(app.world()))
            .filter(|(symbol, _)| [4, 10_004].contains(&symbol.id.0))
            .flat_map(|(_, drawn)| drawn.lines.iter().map(|line| line.ends[0].x))
            .collect();
        least.sort_by(f32::total_cmp);
        assert_eq!(least[0], 4.0);
    }
}
