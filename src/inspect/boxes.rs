//! The boxes of the trees, as they are traced.

use super::color::{AXES, GREY, WHITE, faint, of_scale};
use super::line_set::{Label, LineSet, Panel, Stands, Thinned};
use super::settings::{BoxChoice, BoxColor, BoxSettings, TreeChoice, TreeForm};
use super::trees::{TreeView, trees, triangle_in_world};
use super::visits::Visits;
use super::wide_boxes::wide_boxes;
use super::{Subject, System};
use crate::bvh::{Levels, SplitPlane, TreeRef, node_cost};
use crate::trace::World;
use bevy::color::LinearRgba;
use glam::Vec3;
use std::cmp::Ordering;

/// How much a split plane covers.
const PLANE_ALPHA: f32 = 0.12;

/// Split planes carry their coordinate up to this many; more would be a wall of text.
const MOST_LABELS: usize = 32;

/// A node to be drawn.
struct Chosen {
    node: u32,
    depth: u32,
}

/// Boxes, split planes and the triangles of leaves.
pub(super) fn boxes(subject: &Subject) -> LineSet {
    let settings = &subject.inspect.boxes;
    let world = subject.world;
    let mut set = LineSet::of(System::Boxes, subject.inspect);
    if settings.object != 0 && !world.objects.iter().any(|o| o.id == settings.object) {
        set.notes
            .push(format!("object {} is not in the scene", settings.object));
        return set;
    }
    let visits = match (settings.color, subject.rays) {
        (BoxColor::Visits, Some(rays)) => Some(Visits::of(world, subject.settings, rays, |_| true)),
        (BoxColor::Visits, None) => {
            set.notes
                .push("no pixel was picked, so no ray visited anything".into());
            None
        }
        _ => None,
    };
    let views: Vec<TreeView> = trees(world).filter(|view| wanted(settings, view)).collect();
    if views.iter().all(|view| view.tree.nodes.is_empty()) {
        set.notes.push(without_tree(settings, world));
        return set;
    }
    if settings.form == TreeForm::Wide {
        wide_boxes(&mut set, subject, &views, visits.as_ref());
        return set;
    }
    let chosen: Vec<Vec<Chosen>> = choose(settings, world, &views, &mut set);
    if chosen.iter().all(Vec::is_empty) && set.notes.is_empty() {
        set.notes.push(nothing(settings, &views));
    }
    // The twelve edges of a box, and the four of a plane in it.
    let lines = if settings.split_planes { 16 } else { 12 };
    let scale = Scale::of(settings, &views, &chosen, visits.as_ref());
    let of: usize = chosen.iter().map(Vec::len).sum();
    let mut keep = thin(&chosen, subject.inspect.max_lines as usize / lines);
    let mut drawn = 0;
    let mut triangles = Vec::new();
    for (view, nodes) in views.iter().zip(&chosen) {
        let instance = view.instance().map(|(instance, _)| instance);
        let planes = view.split_planes();
        for chosen in nodes {
            if !keep(chosen) {
                continue;
            }
            drawn += 1;
            let node = chosen.node;
            let stands = Stands::Node { instance, node };
            set.edges(&view.corners(node), scale.color(view, chosen), stands);
            let is_leaf = view.tree.nodes[node as usize].is_leaf();
            if is_leaf && (settings.triangles || settings.choice == BoxChoice::Leaf) {
                triangles.extend(view.triangles(node));
            }
            if settings.split_planes && !is_leaf {
                match planes.of(node) {
                    Some(plane) => draw_plane(&mut set, view, chosen, plane),
                    None => without_plane(&mut set, planes.by_centroids),
                }
            }
        }
    }
    // After all boxes: where there is not room for both, boxes are what is asked for.
    for (instance, triangle) in triangles {
        outline(&mut set, subject, instance, triangle, WHITE);
    }
    if drawn > 0 {
        set.notes.push(
            "the binary form of the trees, as it was built; rays are traced through the wide form made of it"
                .into(),
        );
    }
    if drawn < of {
        set.thinned = Some(Thinned {
            what: "nodes",
            drawn,
            of,
            rule: "the levels nearest to the root",
        });
    }
    set
}

/// Whether a tree is asked for.
pub(super) fn wanted(settings: &BoxSettings, view: &TreeView) -> bool {
    // A leaf, or the path to a triangle, is looked for where triangles are.
    match view.name {
        TreeRef::Top => {
            let holds_triangles = view.tree.nodes.is_empty() || !view.triangles_below_are_objects();
            settings.trees != TreeChoice::Meshes
                && (settings.object == 0 || settings.choice == BoxChoice::Path)
                && (settings.choice != BoxChoice::Leaf || holds_triangles)
        }
        TreeRef::Mesh(_) => {
            settings.trees != TreeChoice::Top
                && (settings.object == 0 || view.object() == Some(settings.object))
        }
    }
}

impl TreeView<'_> {
    /// Whether it is a top tree over objects.
    fn triangles_below_are_objects(&self) -> bool {
        let first = self.tree.nodes.iter().position(|node| node.is_leaf());
        self.name == TreeRef::Top
            && first.is_some_and(|leaf| self.triangles(leaf as u32).is_empty())
    }
}

fn choose(
    settings: &BoxSettings,
    world: &World,
    views: &[TreeView],
    set: &mut LineSet,
) -> Vec<Vec<Chosen>> {
    let mut leaf_offset = 0;
    let mut chosen = Vec::with_capacity(views.len());
    for view in views {
        let depths = view.depths();
        let with_depth = |node: u32| Chosen {
            node,
            depth: depths[node as usize],
        };
        chosen.push(match settings.choice {
            BoxChoice::Levels => {
                let levels = settings.from_level..=settings.to_level;
                (0..view.tree.nodes.len() as u32)
                    .map(with_depth)
                    .filter(|chosen| levels.contains(&chosen.depth))
                    .collect()
            }
            BoxChoice::Leaf => {
                let leaves = view.leaves();
                let index = (settings.leaf as usize).checked_sub(leaf_offset);
                leaf_offset += leaves.len();
                index
                    .and_then(|index| leaves.get(index))
                    .map(|&leaf| with_depth(leaf))
                    .into_iter()
                    .collect()
            }
            BoxChoice::Path => {
                let instance = world.objects.iter().position(|o| o.id == settings.object);
                let place =
                    instance.and_then(|instance| view.place_of(instance as u32, settings.triangle));
                place
                    .map(|place| view.path(place).into_iter().map(with_depth).collect())
                    .unwrap_or_default()
            }
        });
    }
    if settings.choice == BoxChoice::Path && settings.object == 0 {
        set.notes
            .push("a path goes to a triangle of an object: none is chosen".into());
    }
    chosen
}

/// Why none of the trees is asked for, or none that is has a node.
fn without_tree(settings: &BoxSettings, world: &World) -> String {
    let object = settings.object;
    if trees(world).all(|view| view.tree.nodes.is_empty()) {
        "there is no tree: no object with a triangle is traced".into()
    } else if world.aggregate.options().levels == Levels::One {
        "there is one tree over all triangles: no mesh has one of its own".into()
    } else if settings.trees != TreeChoice::Top {
        format!("object {object} has no triangle that is traced, and so no tree")
    } else if settings.choice == BoxChoice::Leaf {
        "the leaves of the tree over the objects hold objects: one with triangles is in a mesh's tree"
            .into()
    } else {
        format!("the tree over the objects is of them all: that of object {object} is its mesh's")
    }
}

fn nothing(settings: &BoxSettings, views: &[TreeView]) -> String {
    match settings.choice {
        BoxChoice::Levels => {
            let deepest = views.iter().flat_map(TreeView::depths).max().unwrap_or(0);
            format!(
                "no node at levels {} to {}: the deepest is {deepest}",
                settings.from_level, settings.to_level
            )
        }
        BoxChoice::Leaf => {
            let count: usize = views.iter().map(|view| view.leaves().len()).sum();
            format!(
                "there is no leaf {}: there are {count}, counted from 0",
                settings.leaf
            )
        }
        BoxChoice::Path => format!(
            "object {} has no traced triangle {}",
            settings.object, settings.triangle
        ),
    }
}

/// All nodes where there is room for `most`; else the levels nearest to the root, and of the first that does not fit as many
/// as do. It is asked for each node once.
fn thin(chosen: &[Vec<Chosen>], most: usize) -> impl FnMut(&Chosen) -> bool + use<> {
    let mut counts: Vec<usize> = Vec::new();
    for chosen in chosen.iter().flatten() {
        let depth = chosen.depth as usize;
        if counts.len() <= depth {
            counts.resize(depth + 1, 0);
        }
        counts[depth] += 1;
    }
    let mut room = most;
    let mut whole = 0;
    for count in counts {
        if count > room {
            break;
        }
        room -= count;
        whole += 1;
    }
    move |chosen| match chosen.depth.cmp(&whole) {
        Ordering::Less => true,
        Ordering::Equal if room > 0 => {
            room -= 1;
            true
        }
        _ => false,
    }
}

/// From what the colour shows to the colour.
struct Scale<'a> {
    choice: BoxColor,
    high: f64,
    visits: Option<&'a Visits>,
}

impl<'a> Scale<'a> {
    fn of(
        settings: &BoxSettings,
        views: &[TreeView],
        chosen: &[Vec<Chosen>],
        visits: Option<&'a Visits>,
    ) -> Self {
        let mut scale = Self {
            choice: settings.color,
            high: 0.0,
            visits,
        };
        for (view, nodes) in views.iter().zip(chosen) {
            for chosen in nodes {
                scale.high = scale.high.max(scale.value(view, chosen));
            }
        }
        scale
    }

    fn value(&self, view: &TreeView, chosen: &Chosen) -> f64 {
        let node = &view.tree.nodes[chosen.node as usize];
        match self.choice {
            BoxColor::Level => f64::from(chosen.depth),
            BoxColor::LeafSize if node.is_leaf() => f64::from(node.prim_count),
            BoxColor::LeafSize => 0.0,
            BoxColor::Cost => node_cost(view.tree, chosen.node as usize),
            BoxColor::Visits => self.visits.map_or(0.0, |visits| {
                f64::from(visits.entered(view.name, chosen.node))
            }),
        }
    }

    fn color(&self, view: &TreeView, chosen: &Chosen) -> LinearRgba {
        let inner = !view.tree.nodes[chosen.node as usize].is_leaf();
        if self.choice == BoxColor::LeafSize && inner {
            return GREY;
        }
        let place = self.value(view, chosen) / self.high.max(f64::MIN_POSITIVE);
        // Costs fall off from the root by powers: their root keeps the lower levels apart.
        let place = match self.choice {
            BoxColor::Cost => place.sqrt(),
            _ => place,
        };
        of_scale(place as f32)
    }
}

/// The outline of a triangle in the world, at time 0.
pub(super) fn outline(
    set: &mut LineSet,
    subject: &Subject,
    instance: u32,
    triangle: u32,
    color: LinearRgba,
) {
    let Some(corners) = triangle_in_world(subject.world, instance, triangle) else {
        return;
    };
    set.closed(&corners, color, Stands::Triangle { instance, triangle });
}

/// The part of a split plane that lies in its node's box.
fn draw_plane(set: &mut LineSet, view: &TreeView, chosen: &Chosen, plane: SplitPlane) {
    let node = &view.tree.nodes[chosen.node as usize];
    let SplitPlane { axis, position } = plane;
    let [u, v] = [[1, 2], [2, 0], [0, 1]][axis];
    let at = |right: f32, up: f32| {
        let mut point = Vec3::ZERO;
        (point[axis], point[u], point[v]) = (position, right, up);
        point
    };
    let (min, max) = (node.min, node.max);
    let corners = view.place([
        at(min[u], min[v]),
        at(max[u], min[v]),
        at(max[u], max[v]),
        at(min[u], max[v]),
    ]);
    let stands = Stands::Node {
        instance: view.instance().map(|(instance, _)| instance),
        node: chosen.node,
    };
    set.closed(&corners, AXES[axis], stands);
    set.planes.push(Panel {
        corner: corners[0],
        edges: [corners[1] - corners[0], corners[3] - corners[0]],
        color: faint(AXES[axis], PLANE_ALPHA),
        stands,
    });
    if set.labels.len() < MOST_LABELS {
        let name = ["x", "y", "z"][axis];
        set.labels.push(Label {
            at: corners[2],
            text: format!("{name} = {position:.3}"),
            color: AXES[axis],
            stands,
        });
    }
}

fn without_plane(set: &mut LineSet, by_centroids: bool) {
    let note = if by_centroids {
        "some nodes have no split plane: the centroids of their triangles coincide"
    } else {
        "some nodes have no split plane: this builder joins boxes instead of splitting, and theirs overlap"
    };
    if !set.notes.iter().any(|known| known == note) {
        set.notes.push(note.into());
    }
}
