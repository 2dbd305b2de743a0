//! Questions about a pixel, and their answers in one sentence. Why it is black is answered here: what the camera meets
//! there, and what is in the way of its light.

use super::document::named;
use super::{mixture, noise};
use crate::trace::{RayEnd, RayKind, RayTree, TracedRay};
use glam::Vec3;
use std::collections::{BTreeMap, BTreeSet};

/// Mirrors that are followed before the sentence ends: more than two make it no clearer.
const MIRRORS: usize = 2;

/// What is asked of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Question {
    /// What is in the way of its light.
    Black,
    /// What its samples differ in.
    Noisy,
    /// What its colour is mixed of.
    Color,
}

/// One sentence, from the rays of a pixel: why it is black from those of the first sample, the rest from all that there
/// are.
pub fn answer(question: Question, tree: &RayTree, names: &BTreeMap<u64, String>) -> String {
    if tree.samples.is_empty() {
        return "Nothing was traced there.".into();
    }
    match question {
        Question::Black => black(tree, names),
        Question::Noisy => noise::sentence(tree, names),
        Question::Color => mixture::sentence(tree, names),
    }
}

/// Where the light of the first sample's camera ray is blocked, and through mirrors.
pub(super) fn black(tree: &RayTree, names: &BTreeMap<u64, String>) -> String {
    let of = Tree { tree, names };
    let Some((index, camera)) = of.camera() else {
        return "Nothing was traced there.".into();
    };
    let sentence = match camera.end {
        RayEnd::Background => "Nothing is there: it shows the background".into(),
        RayEnd::Light => match camera.met_light {
            Some(light) => format!("It shows the light {}", named(names, light)),
            None => "It shows a light".into(),
        },
        _ => {
            let (name, clause) = of.surface(index, camera, MIRRORS);
            format!("{name} {clause}")
        }
    };
    format!("{sentence}.")
}

/// The ray that leaves the mirror which the first sample shows, behind what is transparent too; `None` where the sentence
/// on why the pixel is black speaks of no mirror.
pub fn mirror_ray(tree: &RayTree) -> Option<&TracedRay> {
    let names = &BTreeMap::new();
    let of = Tree { tree, names };
    let (mut index, mut ray) = of.camera()?;
    for _ in 0..MIRRORS {
        let light = of.light(index);
        (index, ray) = of.bounce(index, ray, &light)?;
        if is_mirrored(ray.kind) {
            return tree.rays.get(index as usize);
        }
    }
    None
}

fn is_mirrored(kind: RayKind) -> bool {
    matches!(kind, RayKind::Mirror | RayKind::Gloss)
}

struct Tree<'a> {
    tree: &'a RayTree,
    names: &'a BTreeMap<u64, String>,
}

impl<'a> Tree<'a> {
    fn camera(&self) -> Option<(u32, &'a TracedRay)> {
        let mut rays = (0..).zip(&self.tree.rays);
        rays.find(|(_, ray)| ray.kind == RayKind::Camera)
    }

    fn children(&self, parent: u32) -> impl Iterator<Item = (u32, &'a TracedRay)> + use<'a> {
        self.tree.children(parent)
    }

    /// The ray by which a surface is seen, where it is more mirror or glass than it is lit itself.
    fn bounce(&self, index: u32, ray: &TracedRay, light: &Light) -> Option<(u32, &'a TracedRay)> {
        let ways = |mirrored: bool| {
            let children = self.children(index);
            children
                .filter(move |(_, ray)| ray.light.is_none() && is_mirrored(ray.kind) == mirrored)
        };
        // A surface may be a faint mirror and clear: what more of its light comes from.
        let share = |mirrored| -> f32 {
            let weights = ways(mirrored).map(|(_, ray)| ray.weight.max_element());
            weights.sum()
        };
        let (child_index, child) = ways(share(true) >= share(false)).next()?;
        let hit = ray.hit.as_ref();
        let follows = match child.kind {
            _ if !light.arrives => true,
            kind if is_mirrored(kind) => {
                hit.is_some_and(|hit| hit.mirror.max_element() > hit.diffuse.max_element())
            }
            _ => hit.is_some_and(|hit| hit.opacity < 0.5),
        };
        follows.then_some((child_index, child))
    }

    /// What the surface is called, and a clause on where its light is; through what is more mirror or glass than it is
    /// lit itself.
    fn surface(&self, index: u32, ray: &TracedRay, mirrors: usize) -> (String, String) {
        let hit = ray.hit.map(|hit| named(self.names, hit.object));
        let name = hit.unwrap_or_else(|| "a surface".into());
        let light = self.light(index);
        let bounce = self.bounce(index, ray, &light).filter(|_| mirrors > 0);
        let Some((child_index, child)) = bounce else {
            return (name, light.clause);
        };
        let verb = match child.kind {
            kind if is_mirrored(kind) => "is a mirror that sees",
            _ => "is transparent, and behind it is",
        };
        let seen = match (child.end, child.met_light) {
            (RayEnd::Background, _) => "the background".into(),
            (RayEnd::Light, Some(light)) => format!("the light {}", named(self.names, light)),
            (RayEnd::Light, None) => "a light".into(),
            _ => {
                let (seen, clause) = self.surface(child_index, child, mirrors - 1);
                format!("{seen}, which {clause}")
            }
        };
        (name, format!("{verb} {seen}"))
    }

    /// What became of the shadow rays that left a surface.
    fn light(&self, index: u32) -> Light {
        let mut arriving = BTreeSet::new();
        let mut blocked: BTreeMap<u64, BTreeSet<u64>> = BTreeMap::new();
        let (mut behind, mut unlit) = (BTreeSet::new(), BTreeSet::new());
        let mut faint = false;
        let mut carried = Vec3::ZERO;
        for (_, ray) in self.children(index) {
            let Some(light) = ray.light else {
                continue;
            };
            match ray.end {
                RayEnd::Blocked => {
                    let blockers = blocked.entry(light.id).or_default();
                    blockers.extend(ray.hit.map(|hit| hit.object));
                }
                RayEnd::Unlit if light.n_dot_l <= 0.0 => {
                    behind.insert(light.id);
                }
                RayEnd::Unlit => {
                    unlit.insert(light.id);
                }
                RayEnd::LeftOut => faint = true,
                _ => {
                    arriving.insert(light.id);
                    carried += ray.carried;
                }
            }
        }
        let list = |ids: &mut dyn Iterator<Item = u64>| {
            let names: Vec<String> = ids.map(|id| named(self.names, id)).collect();
            names.join(" and ")
        };
        let shadows: Vec<String> = blocked
            .iter()
            .filter(|(light, _)| !arriving.contains(light))
            .map(|(&light, blockers)| {
                let light = named(self.names, light);
                format!(
                    "in the shadow of {}, from {light}",
                    list(&mut blockers.iter().copied())
                )
            })
            .collect();
        let clause = if !arriving.is_empty() {
            let lit = format!("is lit by {}", list(&mut arriving.iter().copied()));
            let dark = match carried.max_element() > 0.0 {
                true => "",
                false => ", and reflects none of that light",
            };
            match shadows.is_empty() {
                true => format!("{lit}{dark}"),
                false => format!("{lit}{dark}, and lies {}", shadows.join(" and ")),
            }
        } else if !shadows.is_empty() {
            format!("is {}", shadows.join(" and "))
        } else if faint {
            "could be lit by none but lights so faint that this sample asked for none of them"
                .into()
        } else if !behind.is_empty() {
            format!("is turned away from {}", list(&mut behind.iter().copied()))
        } else if !unlit.is_empty() {
            format!(
                "is of a colour that reflects nothing of {}",
                list(&mut unlit.iter().copied())
            )
        } else {
            "is reached by no light: the scene has none, or shading is off".into()
        };
        Light {
            arrives: !arriving.is_empty(),
            clause,
        }
    }
}

/// What there is to say of a surface's direct light.
struct Light {
    /// Some of it comes.
    arrives: bool,
    clause: String,
}
