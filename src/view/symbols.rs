//! What the tracer's picture does not show, drawn over it: lights as what they are, cameras,
//! and an outline of what is selected.
//!
//! Each entity's lines are made again when it changed, and only then.

use super::lines::{DrawnLines, Line};
use crate::scene::{
    DirectionalLamp, ParallelogramLamp, PointLamp, Projection, SceneCamera, SceneId, SegmentLamp,
};
use crate::sync::Traced;
use crate::trace;
use bevy::camera::Camera;
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::InheritedVisibility;
use bevy::color::{ColorToComponents, LinearRgba};
use bevy::math::{Affine3A, Vec2, Vec3, Vec3A};
use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::{
    App, Changed, Commands, Component, DetectChanges, Entity, IntoScheduleConfigs, Or, Plugin,
    PostUpdate, Query, RemovedComponents, Res, ResMut, Resource, With,
};
use bevy::transform::TransformSystems;
use bevy::transform::components::GlobalTransform;
use std::f32::consts::TAU;

/// Draws symbols. Needs [`LinesPlugin`](super::LinesPlugin).
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

/// The colours of symbols, linear RGB with opacity.
mod colors {
    use bevy::color::LinearRgba;

    pub const CAMERA: LinearRgba = LinearRgba::new(0.25, 0.45, 0.9, 0.9);
    pub const SELECTED: LinearRgba = LinearRgba::new(1.0, 0.35, 0.03, 1.0);
    pub const ACTIVE: LinearRgba = LinearRgba::new(1.0, 0.62, 0.12, 1.0);
}

/// Sides of circles.
const SIDES: u32 = 32;
/// Radius of the symbol of a light without an extent, as a part of the scene's extent.
const SIZE: f32 = 0.025;
/// Metres, where the scene has no extent.
const SIZE_ALONE: f32 = 0.08;
/// How much the scene's extent has to change before symbols change theirs.
const NEW_SIZE: f32 = 1.3;
/// Pieces of a line that is as long as a light, so that its colours are seen.
const PIECES: u32 = 8;
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

type HasSymbol = Or<(
    With<PointLamp>,
    With<DirectionalLamp>,
    With<SegmentLamp>,
    With<ParallelogramLamp>,
    With<SceneCamera>,
)>;

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
    mut gone: RemovedComponents<SceneId>,
    mut drawn: Query<&mut DrawnLines, With<SymbolOf>>,
) {
    for entity in gone.read() {
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
    if other {
        redo.extend(symbols.lines.keys());
        redo.extend(&lasting);
        if !outlined.0.is_empty() {
            let wanted: HashSet<SceneId> = outlined.0.iter().copied().collect();
            let chosen = selected.iter().filter(|(_, id)| wanted.contains(*id));
            redo.extend(chosen.map(|(entity, _)| entity));
        }
    }
    for entity in &edited {
        if symbols.lines.contains_key(&entity) || lasting.contains(entity) {
            redo.insert(entity);
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
        let outline = switches.outlines && outlined.0.contains(id);
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
                None if sketch.lines.is_empty() => sketch.axes(&place, tint),
                None => {}
            }
        }
        let wanted = DrawnLines {
            lines: sketch.lines,
            width: WIDTH,
            on_top: false,
        };
        let held = symbols.lines.get(&entity).copied();
        match held.and_then(|lines| drawn.get_mut(lines).ok()) {
            Some(mut before) => {
                if *before != wanted {
                    *before = wanted;
                }
            }
            None if wanted.lines.is_empty() => {}
            None => {
                let lines = commands
                    .spawn((
                        SymbolOf {
                            id: *id,
                            is_picked: lasting.contains(entity),
                        },
                        wanted,
                    ))
                    .id();
                symbols.lines.insert(entity, lines);
            }
        }
    }
}

/// Collects the lines of one entity.
#[derive(Default)]
struct Sketch {
    lines: Vec<Line>,
    /// Replaces the colours of what is selected.
    tint: Option<LinearRgba>,
    /// Metres: the radius of a light without an extent.
    size: f32,
}

/// As bright as colours get without losing their hue, so that a strong light's symbol is not white.
fn shown(color: LinearRgba) -> LinearRgba {
    let most = color.red.max(color.green).max(color.blue).max(1e-6);
    LinearRgba::new(color.red / most, color.green / most, color.blue / most, 1.0)
}

impl Sketch {
    fn line(&mut self, from: Vec3, to: Vec3, color: LinearRgba) {
        let color = self.tint.unwrap_or(color);
        self.lines.push(Line::new(from, to, color));
    }

    fn gradient(&mut self, ends: [Vec3; 2], colors: [LinearRgba; 2]) {
        // What carries a gradient keeps it: it is what one looks for.
        self.lines.push(Line { ends, colors });
    }

    fn circle(&mut self, center: Vec3, [x, y]: [Vec3; 2], color: LinearRgba) {
        let at = |i: u32| {
            let (sin, cos) = (i as f32 / SIDES as f32 * TAU).sin_cos();
            center + x * cos + y * sin
        };
        for i in 0..SIDES {
            self.line(at(i), at(i + 1), color);
        }
    }

    fn point(&mut self, place: &Affine3A, lamp: &PointLamp) {
        let color = shown(lamp.color);
        let center = Vec3::from(place.translation);
        for [x, y] in [[Vec3::X, Vec3::Y], [Vec3::Y, Vec3::Z], [Vec3::Z, Vec3::X]] {
            self.circle(center, [x * self.size, y * self.size], color);
        }
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            for side in [axis, -axis] {
                self.line(
                    center + side * 1.4 * self.size,
                    center + side * 2.2 * self.size,
                    color,
                );
            }
        }
        let Some(cone) = lamp.cone else {
            return;
        };
        let axes = unit_axes(place);
        let length = 8.0 * self.size;
        for angle in [cone.inner, cone.outer] {
            let (sin, cos) = angle.sin_cos();
            let middle = center - axes[2] * (length * cos);
            let rim = [axes[0], axes[1]].map(|axis| axis * (length * sin));
            self.circle(middle, rim, color);
            for side in [rim[0], -rim[0], rim[1], -rim[1]] {
                self.line(center, middle + side, color);
            }
        }
    }

    fn directional(&mut self, place: &Affine3A, lamp: &DirectionalLamp) {
        let color = shown(lamp.color);
        let center = Vec3::from(place.translation);
        let [x, y, z] = unit_axes(place);
        self.circle(center, [x * 2.0 * self.size, y * 2.0 * self.size], color);
        for start in [Vec3::ZERO, x, -x, y, -y] {
            let from = center + start * (1.2 * self.size);
            let tip = from - z * (8.0 * self.size);
            self.line(from, tip, color);
            for side in [x, -x] {
                self.line(tip, tip + (z * 1.2 + side * 0.5) * self.size, color);
            }
        }
    }

    fn segment(&mut self, place: &Affine3A, lamp: &SegmentLamp) {
        let ends = lamp.ends.map(|end| place.transform_point3(end));
        let colors = lamp.colors.map(shown);
        self.gradient(ends, colors);
        let (x, y) = (ends[1] - ends[0])
            .normalize_or(Vec3::X)
            .any_orthonormal_pair();
        for (end, color) in ends.into_iter().zip(colors) {
            self.circle(end, [x, y].map(|axis| axis * 0.5 * self.size), color);
        }
    }

    fn parallelogram(&mut self, place: &Affine3A, lamp: &ParallelogramLamp) {
        let corner = place.transform_point3(lamp.corner);
        let edges = lamp.edges.map(|edge| place.transform_vector3(edge));
        let colors = lamp.colors.map(shown);
        let at = |u: f32, v: f32| corner + edges[0] * u + edges[1] * v;
        let color = |u: f32, v: f32| {
            let low = mix(colors[0], colors[1], u);
            let high = mix(colors[2], colors[3], u);
            mix(low, high, v)
        };
        for i in 0..PIECES {
            let [a, b] = [i, i + 1].map(|i| i as f32 / PIECES as f32);
            for side in [0.0, 1.0] {
                self.gradient([at(a, side), at(b, side)], [color(a, side), color(b, side)]);
                self.gradient([at(side, a), at(side, b)], [color(side, a), color(side, b)]);
            }
        }
        // Where it shines.
        let normal = edges[0].cross(edges[1]).normalize_or_zero();
        let length = 0.25 * edges[0].length().min(edges[1].length());
        let middle = at(0.5, 0.5);
        let shade = color(0.5, 0.5);
        self.line(middle, middle + normal * length, shade);
        if lamp.two_sided {
            self.line(middle, middle - normal * length, shade);
        }
        if self.tint.is_some() {
            for i in 0..4 {
                let corners = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
                let out = normal * 0.002;
                self.line(corners[i] + out, corners[(i + 1) % 4] + out, shade);
            }
        }
    }

    fn camera(&mut self, place: &Affine3A, camera: &SceneCamera) {
        let center = Vec3::from(place.translation);
        let [x, y, z] = unit_axes(place);
        let (near, half) = match camera.projection {
            Projection::Perspective { fov_y } => (0.0, 3.0 * self.size * (0.5 * fov_y).tan()),
            Projection::Orthographic { height } => (1.0, 0.5 * height),
        };
        let aspect = 4.0 / 3.0;
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let across = corners.map(|[u, v]: [f32; 2]| x * (u * half * aspect) + y * (v * half));
        let ahead = center - z * 3.0 * self.size;
        for i in 0..4 {
            let next = across[(i + 1) % 4];
            self.line(ahead + across[i], ahead + next, colors::CAMERA);
            self.line(center + across[i] * near, ahead + across[i], colors::CAMERA);
        }
        // A roof says which way is up.
        let top = ahead + y * (1.6 * half);
        self.line(ahead + across[2], top, colors::CAMERA);
        self.line(ahead + across[3], top, colors::CAMERA);
    }

    fn bounds(&mut self, place: &Affine3A, aabb: &Aabb, color: LinearRgba) {
        let corner = |i: u32| {
            let side = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
            let local = aabb.center + aabb.half_extents * Vec3A::new(side(0), side(1), side(2));
            place.transform_point3(local.into())
        };
        for i in 0..8 {
            for bit in 0..3 {
                if i >> bit & 1 == 0 {
                    self.line(corner(i), corner(i | 1 << bit), color);
                }
            }
        }
    }

    fn axes(&mut self, place: &Affine3A, color: LinearRgba) {
        let center = Vec3::from(place.translation);
        for axis in unit_axes(place) {
            self.line(
                center - axis * 2.0 * self.size,
                center + axis * 2.0 * self.size,
                color,
            );
        }
    }
}

fn mix(a: LinearRgba, b: LinearRgba, t: f32) -> LinearRgba {
    LinearRgba::from_vec4(a.to_vec4().lerp(b.to_vec4(), t))
}

fn unit_axes(place: &Affine3A) -> [Vec3; 3] {
    let m = place.matrix3;
    [
        (m.x_axis, Vec3::X),
        (m.y_axis, Vec3::Y),
        (m.z_axis, Vec3::Z),
    ]
    .map(|(axis, instead)| Vec3::from(axis).try_normalize().unwrap_or(instead))
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
    fn a_lights_gradient_is_drawn_in_its_colours() {
        let lamp = SegmentLamp {
            ends: [Vec3::ZERO, Vec3::X],
            colors: [
                LinearRgba::rgb(4.0, 0.0, 0.0),
                LinearRgba::rgb(0.0, 0.5, 0.0),
            ],
            ..SegmentLamp::default()
        };
        let mut sketch = Sketch::default();
        sketch.segment(&Affine3A::from_translation(Vec3::Y), &lamp);
        let line = sketch.lines[0];
        assert_eq!(line.ends, [Vec3::Y, Vec3::ONE - Vec3::Z]);
        let [from, to] = line.colors.map(|color| color.to_vec3());
        assert_eq!((from, to), (Vec3::X, Vec3::Y));
    }

    #[test]
    fn bounds_have_twelve_edges_of_the_right_lengths() {
        let mut sketch = Sketch::default();
        let aabb = Aabb::from_min_max(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0));
        let place = Affine3A::from_scale(Vec3::splat(2.0));
        sketch.bounds(&place, &aabb, LinearRgba::WHITE);
        let mut lengths: Vec<_> = sketch
            .lines
            .iter()
            .map(|line| line.ends[0].distance(line.ends[1]).round() as u32)
            .collect();
        lengths.sort_unstable();
        assert_eq!(lengths, [2, 2, 2, 2, 4, 4, 4, 4, 6, 6, 6, 6]);
    }
}
