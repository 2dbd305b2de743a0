//! Two trees in two views of the same: boxes and visits of one builder's over the left one, of another's over the
//! right one, and below each what there is to count.
//!
//! The trees are built in the background from the meshes that are traced; where one of the two is
//! what is traced, it is that very tree. Both views look from one place, so that moving it makes no line again.

use super::of_setting;
use crate::bvh::BuildOptions;
use crate::editor::background::{Background, Outcome};
use crate::editor::inspection::{DebugRay, DrawnSet, Seen, Source, seen_from};
use crate::editor::viewport::EditorCamera;
use crate::inspect::{InspectSettings, LineSet, Subject, System, TreeCounts, rebuilt};
use crate::scene::{Builder, RenderSettings};
use crate::sync::Traced;
use crate::trace::{Camera, RayTree, World};
use crate::view::DrawnLines;
use bevy::ecs::query::With;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Commands, Query, Res, ResMut, Single};
use bevy::math::UVec2;
use std::sync::Arc;

/// The layers of the two sides. What is in the left one's is over the editor's own view.
pub(super) const LAYERS: [usize; 2] = [LEFT_TREES_LAYER, 21];
/// What the editor's view shows of a pair.
pub(in crate::editor) const LEFT_TREES_LAYER: usize = 20;
/// What is drawn of each side.
const SYSTEMS: [System; 2] = [System::Boxes, System::Visits];

/// The two sides, from the left.
#[derive(Resource, Default)]
pub(in crate::editor) struct TreePair {
    pub sides: [Side; 2],
    /// Another number for other lines.
    pub version: u64,
    /// The boxes were switched on with it, as nothing would be seen else, and go with it.
    brought_boxes: bool,
}

impl TreePair {
    /// Shows two trees side by side, or one view as before.
    pub fn switch(&mut self, inspect: &mut InspectSettings, on: bool) {
        inspect.pair.on = on;
        if on {
            self.brought_boxes |= !inspect.boxes.on;
            (inspect.on, inspect.boxes.on) = (true, true);
        } else if std::mem::take(&mut self.brought_boxes) {
            inspect.boxes.on = false;
        }
    }
}

/// One side of the view.
#[derive(Default)]
pub(in crate::editor) struct Side {
    /// Whose trees are shown, or being built.
    builder: Builder,
    /// The world of which they are: that which was traced when they were begun.
    of: Option<Arc<World>>,
    building: Option<Background<Arc<World>>>,
    /// With this side's trees; those of before while others are being built.
    world: Option<Arc<World>>,
    failed: Option<String>,
    drawn: [DrawnSet; SYSTEMS.len()],
    counts: Option<(Counted, TreeCounts)>,
    counting: Option<(Counted, Background<TreeCounts>)>,
}

/// What was counted.
#[derive(Clone)]
struct Counted {
    world: Arc<World>,
    camera: Camera,
    size: UVec2,
    rays: Option<Arc<RayTree>>,
}

impl Counted {
    fn is(&self, other: &Self) -> bool {
        let pointer = |rays: &Option<Arc<RayTree>>| rays.as_ref().map(Arc::as_ptr);
        Arc::ptr_eq(&self.world.aggregate, &other.world.aggregate)
            && (&self.camera, self.size) == (&other.camera, other.size)
            && pointer(&self.rays) == pointer(&other.rays)
    }
}

/// How far a side is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::editor) enum SideState {
    /// Its trees are those that are traced.
    Traced,
    /// Its trees were built to be looked at.
    Built,
    /// They are being built; what is shown meanwhile is of before.
    Building,
    /// They cannot be.
    Failed(String),
}

impl Side {
    /// How far it is.
    pub fn state(&self) -> SideState {
        if let Some(why) = &self.failed {
            return SideState::Failed(why.clone());
        }
        match (&self.world, &self.of) {
            _ if self.building.is_some() => SideState::Building,
            (Some(world), Some(of)) if Arc::ptr_eq(world, of) => SideState::Traced,
            (Some(_), _) => SideState::Built,
            (None, _) => SideState::Building,
        }
    }

    /// What its lines say of themselves: what was left out, and why.
    pub fn says(&self) -> impl Iterator<Item = String> {
        self.sets().flat_map(LineSet::says)
    }

    /// The world whose trees are shown.
    pub fn world(&self) -> Option<&Arc<World>> {
        self.world.as_ref()
    }

    /// The lines that are drawn.
    pub fn sets(&self) -> impl Iterator<Item = &LineSet> {
        self.drawn.iter().filter_map(DrawnSet::set)
    }

    /// What there is to count of its trees; while they are another's, that of before.
    pub fn counts(&self) -> Option<&TreeCounts> {
        self.counts.as_ref().map(|(_, counts)| counts)
    }

    /// Nothing of it is left.
    fn clear(&mut self) {
        (self.of, self.world, self.building) = (None, None, None);
        (self.counts, self.counting, self.failed) = (None, None, None);
    }

    /// Counts what is not counted yet, beside the frames: one count at a time, the newest comes next.
    fn count(&mut self, wanted: &Counted, settings: &RenderSettings) {
        if let Some((of, work)) = self.counting.take() {
            match work.take() {
                Outcome::Pending => self.counting = Some((of, work)),
                Outcome::Done(counts) => self.counts = Some((of, counts)),
                // It was reported, and would end so again: there is nothing to be read.
                Outcome::Lost => self.counts = Some((of, TreeCounts::default())),
            }
        }
        let is_known = self.counts.as_ref().is_some_and(|(of, _)| of.is(wanted));
        if is_known || self.counting.is_some() {
            return;
        }
        let (of, settings) = (wanted.clone(), settings.clone());
        let work = Background::start("counts of trees", move |_| {
            TreeCounts::of(&of.world, &of.camera, &settings, of.rays.as_deref())
        });
        // Without a thread nothing is counted; everything else is there.
        self.counting = work.ok().map(|work| (wanted.clone(), work));
    }

    /// Begins to build what is wanted and not there yet.
    fn want(&mut self, builder: Builder, traced: &Arc<World>, options: BuildOptions) {
        let known = self.of.as_ref().is_some_and(|of| {
            Arc::ptr_eq(&of.aggregate, &traced.aggregate)
                && Arc::ptr_eq(&of.objects, &traced.objects)
        });
        if known && self.builder == builder {
            // What is not of the trees may be another: the world that is traced is shown as it is.
            if self.state() == SideState::Traced {
                (self.of, self.world) = (Some(traced.clone()), Some(traced.clone()));
            }
            return;
        }
        let is_traced = *traced.aggregate.options() == options;
        if self.building.is_some() && !is_traced {
            // While something is dragged every frame brings another world: what was begun is
            // finished and shown, and the newest comes next.
            return;
        }
        self.builder = builder;
        self.of = Some(traced.clone());
        self.building = None;
        self.failed = None;
        if is_traced {
            self.world = Some(traced.clone());
            return;
        }
        let of = traced.clone();
        let work = Background::start("pair of trees", move |_| Arc::new(rebuilt(&of, &options)));
        match work {
            Ok(work) => self.building = Some(work),
            Err(error) => self.failed = Some(format!("no thread to build on: {error}")),
        }
    }

    fn carry_on(&mut self) {
        let Some(work) = &self.building else {
            return;
        };
        match work.take() {
            Outcome::Pending => return,
            Outcome::Done(world) => self.world = Some(world),
            Outcome::Lost => self.failed = Some("its trees could not be built".into()),
        }
        self.building = None;
    }
}

/// How a builder's trees are built, with the scene's other settings.
fn options(traced: &World, builder: Builder) -> BuildOptions {
    BuildOptions {
        builder: of_setting(builder),
        ..*traced.aggregate.options()
    }
}

/// Has the trees that the settings ask for built, and lets go of them when nobody does.
pub(super) fn build_pair(
    inspect: Res<InspectSettings>,
    traced: Res<Traced>,
    mut pair: ResMut<TreePair>,
) {
    let wanted = &inspect.pair;
    if !(inspect.on && wanted.on) {
        pair.sides.iter_mut().for_each(Side::clear);
        return;
    }
    for (side, builder) in pair.sides.iter_mut().zip([wanted.left, wanted.right]) {
        // What is done makes room for the next build within the same frame.
        side.carry_on();
        side.want(builder, &traced.world, options(&traced.world, builder));
    }
}

impl TreePair {
    /// The world whose trees a line of a view is about: where there is no pair, that which is traced.
    pub fn meant<'a>(
        &'a self,
        side: usize,
        system: System,
        traced: &'a Arc<World>,
    ) -> &'a Arc<World> {
        let of_side = self.sides.get(side).and_then(Side::world);
        of_side
            .filter(|_| SYSTEMS.contains(&system))
            .unwrap_or(traced)
    }

    /// Whether there is a line.
    pub fn draws(&self) -> bool {
        self.sides.iter().any(|side| side.sets().next().is_some())
    }

    /// Whether it shows this world's trees.
    pub fn shows(&self, world: &Arc<World>) -> bool {
        let mut worlds = self.sides.iter().filter_map(Side::world);
        worlds.any(|shown| Arc::ptr_eq(shown, world))
    }
}

/// Counts, and makes those lines again that may be others.
pub(super) fn draw_pair(
    mut commands: Commands,
    inspect: Res<InspectSettings>,
    settings: Res<RenderSettings>,
    ray: Res<DebugRay>,
    view: Single<Seen, With<EditorCamera>>,
    mut lines: Query<&mut DrawnLines>,
    mut pair: ResMut<TreePair>,
) {
    let (render, view, camera, place, projection) = *view;
    let seen = seen_from(render, view, camera, place, projection);
    let TreePair { sides, version, .. } = &mut *pair;
    for (side, layer) in sides.iter_mut().zip(LAYERS) {
        let Some((world, (camera, size))) = side.world.clone().zip(seen.as_ref()) else {
            for drawn in &mut side.drawn {
                *version += u64::from(drawn.clear(&mut commands));
            }
            continue;
        };
        let settings = RenderSettings {
            size: *size,
            ..settings.clone()
        };
        let source = Source {
            world,
            rays: ray.rays().cloned(),
        };
        let counted = Counted {
            world: source.world.clone(),
            camera: camera.clone(),
            size: *size,
            rays: source.rays.clone(),
        };
        side.count(&counted, &settings);
        let rays = source.rays.as_deref();
        let subject = Subject::new(&source.world, camera, &settings, &inspect, rays);
        for (system, drawn) in SYSTEMS.into_iter().zip(&mut side.drawn) {
            let is_on = system.is_wanted(&inspect) && (rays.is_some() || !system.needs_rays());
            let is_other = match is_on {
                true => drawn.draw(system, &subject, &source, layer, &mut commands, &mut lines),
                false => drawn.clear(&mut commands),
            };
            *version += u64::from(is_other);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::headless_editor;
    use crate::io::{OpenOptions, SceneSource, builtin, open};
    use std::thread::sleep;
    use std::time::{Duration, Instant};

    #[test]
    fn boxes_that_came_with_two_trees_go_with_them_and_others_stay() {
        for had_boxes in [false, true] {
            let mut inspect = InspectSettings::default();
            inspect.boxes.on = had_boxes;
            let mut pair = TreePair::default();
            pair.switch(&mut inspect, true);
            assert!(inspect.on && inspect.pair.on && inspect.boxes.on);
            pair.switch(&mut inspect, false);
            assert_eq!((inspect.pair.on, inspect.boxes.on), (false, had_boxes));
        }
    }

    #[test]
    fn one_build_at_a_time_goes_on_and_the_newest_world_comes_next() {
        let mut app = headless_editor();
        let source = SceneSource::Builtin(builtin::find("head").unwrap());
        open(app.world_mut(), &source, OpenOptions::default()).unwrap();
        app.update();
        app.update();
        let first = app.world().resource::<Traced>().world.clone();
        // The same objects at another place in memory.
        let newer = || {
            let objects = Arc::new((*first.objects).clone());
            Arc::new(World {
                objects,
                ..(*first).clone()
            })
        };
        let worlds = [newer(), newer()];
        let is_of = |side: &Side, world: &Arc<World>| {
            let of = side.of.as_ref();
            of.is_some_and(|of| Arc::ptr_eq(of, world))
        };
        let mut side = Side::default();
        for world in [&first, &worlds[0], &worlds[1]] {
            side.want(Builder::Median, world, options(world, Builder::Median));
        }
        assert!(is_of(&side, &first) && side.state() == SideState::Building);
        let start = Instant::now();
        while side.building.is_some() {
            assert!(
                start.elapsed() < Duration::from_secs(120),
                "it is never built"
            );
            sleep(Duration::from_millis(1));
            side.carry_on();
        }
        assert!(side.world.is_some());
        side.want(
            Builder::Median,
            &worlds[1],
            options(&worlds[1], Builder::Median),
        );
        assert!(is_of(&side, &worlds[1]) && side.building.is_some());
    }
}
