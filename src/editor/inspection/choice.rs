//! Which ray and which node are meant, wherever they were chosen: in the list, in the view, by keys.

use super::debug_ray::{DebugRay, NO_VIEW, Shot};
use super::list::{Arrangement, List};
use super::view_of;
use crate::editor::command::{Command, Over, State, commands};
use crate::editor::notice::Notices;
use crate::editor::preferences::Preferences;
use crate::editor::selection::Escaped;
use crate::editor::trees::pair::TreePair;
use crate::inspect::{InspectSettings, Stands, Stepper, Traversal};
use crate::sync::Traced;
use crate::trace;
use bevy::ecs::observer::On;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Local, Res, ResMut};
use bevy::ecs::world::World;
use bevy::math::UVec2;
use std::sync::Arc;
use std::time::Instant;

/// What stands beside the list of rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::editor) enum Side {
    /// Why the pixel has its value.
    #[default]
    Why,
    /// All numbers of the chosen ray.
    Ray,
    /// Its way through the trees.
    Steps,
}

/// A node of a tree, of the world as it was when it was chosen.
#[derive(Clone)]
pub(in crate::editor) struct Node {
    pub world: Arc<trace::World>,
    /// The instance whose mesh's tree it is in; `None` for the top tree.
    pub instance: Option<u32>,
    pub node: u32,
}

/// What is looked at more closely.
#[derive(Resource, Default)]
pub(in crate::editor) struct Inspected {
    ray: Option<u32>,
    /// It was chosen elsewhere: the list has to show it.
    pub scrolls: bool,
    node: Option<Node>,
    /// Visited and pruned nodes are drawn of the chosen ray alone.
    pub only_its_nodes: bool,
    pub side: Side,
    pub arrangement: Arrangement,
    pub list: List,
    pub stepper: Stepper,
    /// Of which rays, of which shot and of which of them `stepper` is.
    stepped: Option<(u64, u32)>,
    number: u64,
    shots: u64,
    sets_nodes_of: bool,
}

impl Inspected {
    /// The chosen ray.
    pub fn ray(&self) -> Option<u32> {
        self.ray
    }

    /// The chosen node.
    pub fn node(&self) -> Option<&Node> {
        self.node.as_ref()
    }

    /// Chooses a ray; `scrolls` where that was not done in the list.
    pub fn choose_ray(&mut self, ray: Option<u32>, scrolls: bool) {
        if self.ray.is_none() && ray.is_some() && self.side == Side::Why {
            self.side = Side::Ray;
        }
        self.ray = ray;
        self.scrolls |= scrolls && ray.is_some();
    }

    /// Chooses a node.
    pub fn choose_node(&mut self, node: Option<Node>) {
        self.node = node;
    }

    /// A click on a line in the view. `false` where it is nothing that can be chosen, or is chosen
    /// already: then the click is meant for what is behind it.
    pub fn click(&mut self, stands: Stands, world: &Arc<trace::World>) -> bool {
        match stands {
            Stands::Ray(ray) if self.ray != Some(ray) => self.choose_ray(Some(ray), true),
            Stands::Node { instance, node } => {
                let known = self.node.as_ref();
                if known.is_some_and(|known| (known.instance, known.node) == (instance, node)) {
                    return false;
                }
                self.node = Some(Node {
                    world: world.clone(),
                    instance,
                    node,
                });
            }
            _ => return false,
        }
        true
    }
}

/// Nothing is chosen any more.
pub(super) fn let_go(_: On<Escaped>, mut inspected: ResMut<Inspected>) {
    inspected.ray = None;
    inspected.node = None;
}

/// Whether there is a ray to step through.
fn has_ray(world: &World) -> State {
    State::when(
        world.resource::<Inspected>().ray.is_some(),
        "Steps are those of a debug ray: point at the picture and press R, and choose a ray of the list or of the view",
    )
}

pub(super) fn commands() -> Vec<Command> {
    commands! {
        "rays.inspector" "Ray inspector" ["Shift+R"] "The debug ray's rays as a tree with all their numbers, below the picture"
            => toggle_inspector; menu("View", 5); over(&[Over::Ray, Over::Box]); state(is_inspector_shown),
        "rays.forward" "Next step" ["."] "One step of the chosen ray's way through the trees on"
            => |world| step(world, Stepper::forward); over(&[Over::Ray]); repeats(); state(has_ray),
        "rays.back" "Step before" [","] "One step of the chosen ray's way through the trees back"
            => |world| step(world, Stepper::back); over(&[Over::Ray]); repeats(); state(has_ray),
        "rays.play" "Play steps" ["Space"] "Plays the chosen ray's way through the trees, or stops"
            => |world| step(world, Stepper::toggle); over(&[Over::Ray]); state(has_ray),
    }
}

fn toggle_inspector(world: &mut World) {
    if let Some(mut preferences) = world.get_resource_mut::<Preferences>() {
        preferences.show_rays = !preferences.show_rays;
    }
}

fn is_inspector_shown(world: &World) -> State {
    let preferences = world.get_resource::<Preferences>();
    State::switch(preferences.is_some_and(|preferences| preferences.show_rays))
}

fn step(world: &mut World, how: impl FnOnce(&mut Stepper)) {
    let mut inspected = world.resource_mut::<Inspected>();
    inspected.side = Side::Steps;
    how(&mut inspected.stepper);
}

/// The pixel in the middle of the picture.
pub(in crate::editor) fn shoot_middle(world: &mut World) {
    let size = view_of(world).map_or(UVec2::ZERO, |(_, size)| size);
    shoot_pixel(world, size / 2);
}

/// A pixel of the picture as the view shows it now.
pub(in crate::editor) fn shoot_pixel(world: &mut World, pixel: UVec2) {
    let view = view_of(world);
    let Some(mut ray) = world.get_resource_mut::<DebugRay>() else {
        return;
    };
    let known = ray.shot().cloned();
    let shot = match (view, known) {
        (Some((camera, size)), _) => Shot {
            pixel,
            camera,
            size,
        },
        // While nothing is traced the picture is the one before.
        (None, Some(known)) => Shot { pixel, ..known },
        (None, None) => {
            world.resource_mut::<Notices>().tell(NO_VIEW);
            return;
        }
    };
    ray.shoot(shot);
}

/// Other rays, another choice: the steps are those of the chosen ray, the visited nodes too.
pub(super) fn follow(
    ray: Res<DebugRay>,
    traced: Res<Traced>,
    pair: Option<Res<TreePair>>,
    mut inspected: ResMut<Inspected>,
    mut settings: ResMut<InspectSettings>,
) {
    let shots = ray.shots();
    if inspected.shots != shots {
        inspected.shots = shots;
        inspected.ray = None;
        inspected.side = match inspected.side {
            Side::Ray => Side::Why,
            side => side,
        };
        inspected.arrangement.folded.clear();
    }
    if inspected.number != ray.number() {
        inspected.number = ray.number();
        let count = ray.rays().map_or(0, |rays| rays.rays.len());
        inspected.ray = inspected.ray.filter(|&index| (index as usize) < count);
    }
    let is_there = |node: &Node| {
        let pair = pair.as_ref().is_some_and(|pair| pair.shows(&node.world));
        pair || Arc::ptr_eq(&node.world, &traced.world)
    };
    if (inspected.node.as_ref()).is_some_and(|node| !is_there(node)) {
        keep_node(&mut inspected, &traced.world);
    }
    let stepped = inspected.ray.map(|index| (ray.number(), index));
    if inspected.stepped != stepped {
        let stays = match (inspected.stepped, stepped) {
            (Some((_, before)), Some((_, now))) => before == now,
            _ => false,
        };
        inspected.stepped = stepped;
        let traversal = match (ray.rays(), ray.traced_with(), stepped) {
            (Some(rays), Some((world, settings)), Some((_, index))) => {
                Traversal::of(world, settings, rays, index)
            }
            _ => Traversal::default(),
        };
        inspected.stepper.load(traversal, stays);
    }
    let only = inspected.only_its_nodes;
    if only || inspected.sets_nodes_of {
        let wanted = inspected.ray.filter(|_| only).unwrap_or(u32::MAX);
        inspected.sets_nodes_of = only;
        if settings.rays.nodes_of != wanted {
            settings.rays.nodes_of = wanted;
        }
    }
}

/// A node stays chosen where its tree is the same one in the new world.
fn keep_node(inspected: &mut Inspected, world: &Arc<trace::World>) {
    let Some(node) = &mut inspected.node else {
        return;
    };
    let (old, new) = (&node.world.aggregate, &world.aggregate);
    let same = match node.instance {
        None => Arc::ptr_eq(old, new),
        Some(instance) => {
            let tree = |world: &trace::World| {
                let object = world.objects.get(instance as usize)?;
                Some((object.id, object.mesh.tree.clone()))
            };
            match (tree(&node.world), tree(world)) {
                (Some((a, old)), Some((b, new))) => a == b && Arc::ptr_eq(&old, &new),
                _ => false,
            }
        }
    };
    if same {
        node.world = world.clone();
    } else {
        inspected.node = None;
    }
}

/// Lets the time of a frame pass.
pub(super) fn play(mut inspected: ResMut<Inspected>, mut last: Local<Option<Instant>>) {
    let now = Instant::now();
    let before = last.replace(now);
    if !inspected.stepper.playing {
        *last = None;
        return;
    }
    if let Some(before) = before {
        // A window that was not drawn for a while does not jump.
        let seconds = (now - before).as_secs_f32().min(0.5);
        inspected.stepper.pass(seconds);
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::Bench;
    use super::*;
    use crate::editor::action::Action;
    use crate::editor::inspection::Which;

    #[test]
    fn the_choice_stays_while_the_scene_is_edited_and_goes_with_another_shot() {
        let mut bench = Bench::open("cornell-box");
        bench.shoot([300, 240]);
        bench.inspected().choose_ray(Some(1), true);
        assert!(bench.inspected().scrolls);
        assert_eq!(bench.inspected().side, Side::Ray);
        bench.app.update();
        let steps = bench.inspected().stepper.len();
        bench.move_something();
        assert_eq!(bench.inspected().ray(), Some(1));
        assert!(steps > 0 && !bench.inspected().stepper.is_empty());
        bench.shoot([10, 10]);
        assert_eq!(bench.inspected().ray(), None);
        assert!(bench.inspected().stepper.is_empty());
    }

    #[test]
    fn a_click_on_a_line_chooses_and_a_second_one_is_for_what_is_behind() {
        let mut bench = Bench::open("cornell-box");
        bench.shoot([300, 240]);
        let world = bench.app.world().resource::<Traced>().world.clone();
        let inspected = bench.inspected();
        assert!(inspected.click(Stands::Ray(1), &world));
        assert_eq!(inspected.ray(), Some(1));
        assert!(!inspected.click(Stands::Ray(1), &world));
        let node = Stands::Node {
            instance: None,
            node: 0,
        };
        assert!(inspected.click(node, &world));
        assert!(!inspected.click(node, &world));
        assert!(!inspected.click(Stands::Camera, &world));
        bench.act(Action::run("select.none"));
        assert_eq!(bench.inspected().ray(), None);
        assert!(bench.inspected().node().is_none());
    }

    #[test]
    fn keys_play_the_steps_of_the_chosen_ray_and_say_so_where_there_is_none() {
        let mut bench = Bench::open("cornell-box");
        bench.act(Action::run("rays.forward"));
        assert!(!bench.app.world().resource::<Notices>().is_empty());
        bench.shoot([300, 240]);
        bench.inspected().choose_ray(Some(0), false);
        bench.app.update();
        bench.act(Action::run("rays.forward"));
        bench.act(Action::run("rays.forward"));
        bench.act(Action::run("rays.back"));
        assert_eq!(bench.inspected().stepper.at(), 1);
        assert_eq!(bench.inspected().side, Side::Steps);
    }

    #[test]
    fn visited_nodes_are_those_of_the_chosen_ray_where_that_is_asked_for_and_of_all_again() {
        let mut bench = Bench::open("cornell-box");
        bench.shoot([300, 240]);
        bench.inspected().choose_ray(Some(1), false);
        bench.inspected().only_its_nodes = true;
        bench.app.update();
        let nodes_of = |bench: &Bench| {
            let settings = bench.app.world().resource::<InspectSettings>();
            settings.rays.nodes_of
        };
        assert_eq!(nodes_of(&bench), 1);
        bench.inspected().only_its_nodes = false;
        bench.app.update();
        assert_eq!(nodes_of(&bench), u32::MAX);
    }

    #[test]
    fn every_state_says_what_it_is() {
        let mut bench = Bench::open("cornell-box");
        let says = |bench: &Bench| bench.app.world().resource::<DebugRay>().says();
        assert!(says(&bench).unwrap().contains("press R"));
        bench.shoot([5000, 240]);
        let text = says(&bench).unwrap();
        assert!(
            text.contains("pixel 5000,240 is outside the picture"),
            "{text}"
        );
        bench.ray().which = Which::Number(1 << 20);
        bench.shoot([300, 240]);
        assert!(says(&bench).unwrap().contains("there is no sample 1048576"));
        bench.ray().which = Which::First;
        bench.app.update();
        assert_eq!(says(&bench), None);
        let met = bench.hide_what_is_met();
        let text = says(&bench).unwrap();
        assert!(
            text.starts_with(&met) && text.contains("deleted or hidden"),
            "{text}"
        );
        bench.hide_everything();
        assert!(says(&bench).unwrap().contains("no object"));
    }

    #[test]
    fn all_samples_are_traced_beside_the_frames_and_are_the_renders() {
        let mut bench = Bench::open("cornell-box");
        bench.ray().which = Which::All;
        bench.shoot([300, 240]);
        bench.wait();
        let ray = bench.app.world().resource::<DebugRay>();
        let rays = ray.rays().unwrap();
        assert_eq!(Some(rays.samples.len() as u64), ray.sample_count());
        assert!(rays.samples.len() > 1);
    }
}
