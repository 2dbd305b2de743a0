//! The rays as rows: a tree with children below their parents, or sorted by a column; filtered by
//! what is drawn and by a text; folded.

use crate::inspect::{Column, Names, RaySettings};
use crate::trace::{DOME, RayKind, RayTree, TracedRay};
use bevy::platform::collections::HashSet;

/// How the list is arranged.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::editor) struct Arrangement {
    /// The column, and whether the largest come first; `None`: the tree.
    pub sort: Option<(Column, bool)>,
    /// Only rays of which kind, end, objects or light contain this.
    pub text: String,
    /// Rays whose children are not shown.
    pub folded: HashSet<u32>,
}

impl Arrangement {
    /// A click on a heading: up, down, and back to the tree.
    pub fn click(&mut self, column: Column) {
        self.sort = match self.sort {
            Some((known, false)) if known == column => Some((column, true)),
            Some((known, true)) if known == column => None,
            _ => Some((column, false)),
        };
    }
}

/// One line of the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::editor) struct Row {
    /// The ray's number.
    pub ray: u32,
    /// How far it is indented: 0 where the list is sorted.
    pub indent: u32,
    /// It has children that can be folded away.
    pub folds: bool,
}

/// The rows of one tree of rays.
#[derive(Default)]
pub(in crate::editor) struct List {
    made_of: Option<MadeOf>,
    /// Depth first: each ray, and where its descendants end.
    tree: Vec<(u32, u32)>,
    rows: Vec<Row>,
}

#[derive(PartialEq)]
struct MadeOf {
    number: u64,
    names: u64,
    arrangement: Arrangement,
    kinds: [bool; 5],
    max_depth: u32,
}

impl List {
    /// The rows. Made again only where the rays (by their number), the names or the arrangement are
    /// others.
    pub fn rows(
        &mut self,
        (rays, number): (&RayTree, u64),
        arrangement: &Arrangement,
        kinds: &RaySettings,
        names: &Names,
    ) -> &[Row] {
        let made_of = MadeOf {
            number,
            names: names.version,
            arrangement: arrangement.clone(),
            kinds: [
                kinds.camera,
                kinds.mirror,
                kinds.transmission,
                kinds.shadow,
                kinds.light_samples,
            ],
            max_depth: kinds.max_depth,
        };
        if self.made_of.as_ref() != Some(&made_of) {
            if self.made_of.as_ref().is_none_or(|old| old.number != number) {
                self.tree = depth_first(rays);
            }
            self.rows = rows(&self.tree, rays, arrangement, kinds, names);
            self.made_of = Some(made_of);
        }
        &self.rows
    }

    /// The rows as they were made last.
    pub fn known(&self) -> &[Row] {
        &self.rows
    }
}

/// Whether the switches of the kinds and the limit of the bounces let a ray be listed.
fn is_listed(kinds: &RaySettings, ray: &TracedRay) -> bool {
    is_kind_on(kinds, ray.kind) && ray.depth <= kinds.max_depth
}

fn is_kind_on(kinds: &RaySettings, kind: RayKind) -> bool {
    match kind {
        RayKind::Camera => kinds.camera,
        RayKind::Mirror | RayKind::Gloss => kinds.mirror,
        RayKind::Transmission | RayKind::Translucency => kinds.transmission,
        RayKind::Shadow => kinds.shadow,
        RayKind::LightSample => kinds.light_samples,
    }
}

/// Each ray before its children, with the place behind its last descendant.
fn depth_first(rays: &RayTree) -> Vec<(u32, u32)> {
    let count = rays.rays.len();
    let none = u32::MAX;
    // Children as linked lists: they stand behind their parents, so that going backwards puts the
    // first child first.
    let (mut first, mut next) = (vec![none; count], vec![none; count]);
    let mut roots = Vec::new();
    for (index, ray) in rays.rays.iter().enumerate().rev() {
        match ray.parent {
            Some(parent) => {
                next[index] = first[parent as usize];
                first[parent as usize] = index as u32;
            }
            None => roots.push(index as u32),
        }
    }
    let mut order: Vec<(u32, u32)> = Vec::with_capacity(count);
    let mut open: Vec<usize> = Vec::new();
    for root in roots.into_iter().rev() {
        let mut now = root;
        loop {
            open.push(order.len());
            order.push((now, 0));
            let child = first[now as usize];
            if child != none {
                now = child;
                continue;
            }
            // Up to where there is a sibling.
            let sibling = loop {
                let Some(place) = open.pop() else { break none };
                order[place].1 = order.len() as u32;
                let sibling = next[order[place].0 as usize];
                if sibling != none {
                    break sibling;
                }
            };
            if sibling == none {
                break;
            }
            now = sibling;
        }
    }
    order
}

fn rows(
    tree: &[(u32, u32)],
    rays: &RayTree,
    arrangement: &Arrangement,
    kinds: &RaySettings,
    names: &Names,
) -> Vec<Row> {
    let search = Search::new(&arrangement.text, names);
    let wanted = |ray: u32| {
        let ray = &rays.rays[ray as usize];
        is_listed(kinds, ray) && search.finds(ray)
    };
    if let Some((column, descending)) = arrangement.sort {
        let mut order: Vec<u32> = tree.iter().map(|(ray, _)| *ray).collect();
        order.retain(|&ray| wanted(ray));
        column.sort(&mut order, &rays.rays, names, descending);
        return order
            .into_iter()
            .map(|ray| Row {
                ray,
                indent: 0,
                folds: false,
            })
            .collect();
    }
    let mut rows = Vec::new();
    let mut at = 0;
    while let Some(&(ray, end)) = tree.get(at) {
        let has_children = end as usize > at + 1;
        if wanted(ray) {
            rows.push(Row {
                ray,
                indent: rays.rays[ray as usize].depth,
                folds: has_children,
            });
        }
        // What is searched for is found in folded branches too.
        let folded = search.is_empty() && arrangement.folded.contains(&ray);
        at = if folded { end as usize } else { at + 1 };
    }
    rows
}

/// What a text finds: worked out per name once, so that half a million rays are searched without
/// writing down a text for each.
struct Search {
    text: String,
    things: HashSet<u64>,
}

impl Search {
    fn new(text: &str, names: &Names) -> Self {
        let text = text.trim().to_lowercase();
        let things = match text.is_empty() {
            true => HashSet::default(),
            false => {
                let ids = names.things.keys().copied().chain([DOME]);
                ids.filter(|&id| names.of(id).to_lowercase().contains(&text))
                    .collect()
            }
        };
        Self { text, things }
    }

    fn is_empty(&self) -> bool {
        self.text.is_empty()
    }

    fn finds(&self, ray: &TracedRay) -> bool {
        if self.text.is_empty() {
            return true;
        }
        let of_thing = |id: Option<u64>| id.is_some_and(|id| self.things.contains(&id));
        ray.kind.name().contains(&self.text)
            || ray.end.name().contains(&self.text)
            || of_thing(ray.from)
            || of_thing(ray.hit.map(|hit| hit.object))
            || of_thing(ray.light.map(|light| light.id))
            || of_thing(ray.met_light)
            || (ray.crossings.iter()).any(|crossing| self.things.contains(&crossing.object))
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{names_of, rays_of};
    use super::*;

    #[test]
    fn the_tree_has_every_ray_once_each_below_its_parent_and_before_its_next_sibling() {
        let (rays, _) = rays_of("showcase", [320, 200], crate::trace::Samples::All);
        let tree = depth_first(&rays);
        let mut seen: Vec<u32> = tree.iter().map(|(ray, _)| *ray).collect();
        let mut place = vec![0; rays.rays.len()];
        for (at, &ray) in seen.iter().enumerate() {
            place[ray as usize] = at as u32;
        }
        for (index, ray) in rays.rays.iter().enumerate() {
            let Some(parent) = ray.parent else { continue };
            let (from, to) = (
                place[parent as usize],
                tree[place[parent as usize] as usize].1,
            );
            let own = place[index];
            assert!(
                from < own && own < to,
                "ray {index} at {own} of {from}..{to}"
            );
            assert!(tree[own as usize].1 <= to);
        }
        seen.sort_unstable();
        assert!(seen.iter().enumerate().all(|(i, &ray)| i as u32 == ray));
        assert_eq!(seen.len(), rays.rays.len());
    }

    #[test]
    fn folding_hides_descendants_and_searching_finds_them_all_the_same() {
        let (rays, names) = rays_of("cornell-box", [300, 240], crate::trace::Samples::One(0));
        let kinds = RaySettings::default();
        let mut arrangement = Arrangement::default();
        let mut list = List::default();
        let all = list.rows((&rays, 1), &arrangement, &kinds, &names).len();
        assert_eq!(all, rays.rays.len());
        assert!(all > 1, "a surface asks for light");
        arrangement.folded.insert(0);
        let folded = list.rows((&rays, 1), &arrangement, &kinds, &names).to_vec();
        assert_eq!(folded.len(), 1);
        assert!(folded[0].folds);
        arrangement.text = "Lamp".into();
        let found = list.rows((&rays, 1), &arrangement, &kinds, &names);
        let expected = rays.rays.iter().filter(|ray| ray.light.is_some()).count();
        assert_eq!(found.len(), expected);
        arrangement.text = "no such thing".into();
        assert!(
            list.rows((&rays, 1), &arrangement, &kinds, &names)
                .is_empty()
        );
    }

    #[test]
    fn switches_of_kinds_and_the_bounce_limit_decide_what_is_listed() {
        let (rays, names) = rays_of("cornell-box", [300, 240], crate::trace::Samples::All);
        let mut list = List::default();
        let arrangement = Arrangement::default();
        let mut kinds = RaySettings {
            shadow: false,
            light_samples: false,
            ..RaySettings::default()
        };
        let rows = list.rows((&rays, 1), &arrangement, &kinds, &names);
        assert!(!rows.is_empty());
        assert!(
            rows.iter()
                .all(|row| !rays.rays[row.ray as usize].kind.is_for_light())
        );
        kinds.shadow = true;
        kinds.max_depth = 0;
        let rows = list.rows((&rays, 1), &arrangement, &kinds, &names);
        assert_eq!(rows.len(), rays.samples.len(), "camera rays alone");
    }

    #[test]
    fn a_click_on_a_heading_sorts_up_then_down_then_as_a_tree() {
        let (rays, names) = rays_of("knot", [300, 240], crate::trace::Samples::All);
        let kinds = RaySettings::default();
        let mut list = List::default();
        let mut arrangement = Arrangement::default();
        let mut figures = |arrangement: &Arrangement| -> Vec<u64> {
            let rows = list.rows((&rays, 1), arrangement, &kinds, &names);
            rows.iter()
                .map(|row| rays.rays[row.ray as usize].cost.nodes)
                .collect()
        };
        let tree = figures(&arrangement);
        arrangement.click(Column::Nodes);
        let up = figures(&arrangement);
        assert!(up.is_sorted(), "{up:?}");
        arrangement.click(Column::Nodes);
        let down = figures(&arrangement);
        assert!(down.iter().rev().is_sorted(), "{down:?}");
        assert!(
            down.first() > down.last(),
            "rays cost different numbers of nodes"
        );
        arrangement.click(Column::Nodes);
        assert_eq!(arrangement.sort, None);
        assert_eq!(figures(&arrangement), tree);
    }

    #[test]
    fn another_name_sorts_and_finds_at_once() {
        let (rays, mut names) = rays_of("cornell-box", [300, 240], crate::trace::Samples::One(0));
        let lamp = rays
            .rays
            .iter()
            .find_map(|ray| Some(ray.light?.id))
            .unwrap();
        let kinds = RaySettings::default();
        let mut list = List::default();
        let arrangement = Arrangement {
            text: "sun".into(),
            ..Arrangement::default()
        };
        assert!(
            list.rows((&rays, 1), &arrangement, &kinds, &names)
                .is_empty()
        );
        names_of(&mut names, lamp, "Sun");
        assert!(
            !list
                .rows((&rays, 1), &arrangement, &kinds, &names)
                .is_empty()
        );
    }
}
