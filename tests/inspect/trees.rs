//! S5, S6, S10: boxes, leaves, split planes and visited nodes, worked out by hand.

use super::{RED, Scene, WHITE, expect, is_color, is_near, segment};
use crate::analytic::{quad, world};
use glam::{UVec2, Vec3};
use glassbox::bvh::{Aggregate, BuildOptions, Builder, Instance, Levels, MeshTree, Triangles};
use glassbox::inspect::{
    BoxChoice, BoxColor, BoxSettings, InspectSettings, LineSet, RaySettings, Segment, Stands,
    System, TreeChoice, TreeForm,
};
use glassbox::trace::{Camera, Material, Mesh, Object, World};
use std::sync::Arc;

/// Unit squares facing +Z at x = 0, 3, 6, 9, as one mesh.
fn row(builder: Builder) -> World {
    let squares = (0..4).flat_map(|i| quad(Vec3::X * 3.0 * i as f32, Vec3::X, Vec3::Y));
    of_mesh(squares.collect(), builder)
}

/// Each square four times: the wide form has a leaf for each, and none for two.
fn often(squares: impl Iterator<Item = Vec<Vec3>>) -> World {
    of_mesh(
        squares.flat_map(|square| square.repeat(4)).collect(),
        Builder::Median,
    )
}

/// One object with the number 5 and two triangles in a leaf.
fn of_mesh(corners: Vec<Vec3>, builder: Builder) -> World {
    let options = BuildOptions {
        builder,
        levels: Levels::Two,
        max_leaf_size: 2,
        ..BuildOptions::default()
    };
    let indices = (0..corners.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    let triangles = Triangles::new(corners, indices.collect()).unwrap();
    let tree = Arc::new(MeshTree::build(triangles, &options));
    let instance = Instance::new(tree.clone(), &glam::Affine3A::IDENTITY).unwrap();
    let mesh = Mesh::of(tree);
    let object = Object {
        id: 5,
        material: 0,
        motion_samples: 0,
        mesh: Arc::new(mesh),
    };
    World {
        aggregate: Arc::new(Aggregate::build(vec![instance], &options)),
        objects: Arc::new(vec![object]),
        ..world(vec![], vec![Material::default()])
    }
}

/// Looks along -Z at the middle of the square at x = 3.
fn camera() -> Camera {
    Camera::looking_at(
        Vec3::new(3.5, 0.25, 4.0),
        Vec3::new(3.5, 0.25, 0.0),
        Vec3::Y,
        0.5,
    )
}

fn boxes(builder: Builder, change: impl Fn(&mut BoxSettings)) -> LineSet {
    let mut inspect = InspectSettings::default();
    inspect.boxes.on = true;
    inspect.boxes.trees = TreeChoice::Meshes;
    change(&mut inspect.boxes);
    Scene::of(row(builder), camera()).lines(System::Boxes, &inspect)
}

#[test]
fn s5_the_boxes_of_a_level_are_those_of_the_halves() {
    let set = boxes(Builder::Median, |boxes| {
        boxes.from_level = 1;
        boxes.to_level = 1;
    });
    // Two squares each: x from 0 to 4 and from 6 to 10.
    assert_eq!(set.segments.len(), 24);
    segment(&set, Vec3::ZERO, Vec3::X * 4.0);
    segment(&set, Vec3::new(6.0, 1.0, 0.0), Vec3::new(10.0, 1.0, 0.0));
    let all = boxes(Builder::Median, |boxes| boxes.to_level = 40);
    // A root, two halves, four squares.
    assert_eq!(all.segments.len(), 7 * 12);
    segment(&all, Vec3::ZERO, Vec3::X * 10.0);
    assert_eq!(all.thinned, None);
}

#[test]
fn the_wide_form_begins_with_the_same_root_and_each_form_says_which_it_is() {
    let binary = boxes(Builder::Sah, |boxes| boxes.to_level = 40);
    let wide = boxes(Builder::Sah, |boxes| {
        boxes.to_level = 40;
        boxes.form = TreeForm::Wide;
    });
    segment(&wide, Vec3::ZERO, Vec3::X * 10.0);
    assert!(wide.segments.len() < binary.segments.len());
    assert!(wide.notes[0].contains("wide form"), "{:?}", wide.notes);
    assert!(
        binary.notes[0].contains("binary form"),
        "{:?}",
        binary.notes
    );
    let none = boxes(Builder::Sah, |boxes| {
        boxes.from_level = 50;
        boxes.to_level = 60;
        boxes.form = TreeForm::Wide;
    });
    assert!(none.is_empty() && none.notes[0].contains("levels 50 to 60"));
}

#[test]
fn s5_the_nth_leaf_is_shown_with_its_triangles() {
    let set = boxes(Builder::Median, |boxes| {
        boxes.choice = BoxChoice::Leaf;
        boxes.leaf = 2;
    });
    let [a, b, c] = [Vec3::X * 6.0, Vec3::X * 7.0, Vec3::new(7.0, 1.0, 0.0)];
    expect(&set, a, c, WHITE);
    segment(&set, a, b);
    let triangles: Vec<_> = set
        .segments
        .iter()
        .filter_map(|s| match s.stands {
            Stands::Triangle { triangle, .. } => Some(triangle),
            _ => None,
        })
        .collect();
    assert_eq!(triangles.len(), 6, "{triangles:?}");
    assert!(
        triangles.iter().all(|t| [4, 5].contains(t)),
        "{triangles:?}"
    );
    let none = boxes(Builder::Median, |boxes| {
        boxes.choice = BoxChoice::Leaf;
        boxes.leaf = 4;
    });
    assert!(none.is_empty());
    assert_eq!(
        none.notes,
        ["there is no leaf 4: there are 4, counted from 0"]
    );
}

#[test]
fn the_path_to_a_triangle_goes_from_the_root_to_its_leaf() {
    let set = boxes(Builder::Median, |boxes| {
        boxes.choice = BoxChoice::Path;
        boxes.object = 5;
        boxes.triangle = 3;
        boxes.trees = TreeChoice::Both;
    });
    // The top tree's root, which holds the object; then root, left half, second square.
    assert_eq!(set.segments.len(), 4 * 12);
    segment(&set, Vec3::ZERO, Vec3::X * 10.0);
    segment(&set, Vec3::ZERO, Vec3::X * 4.0);
    segment(&set, Vec3::X * 3.0, Vec3::X * 4.0);
}

#[test]
fn s10_split_planes_lie_halfway_between_the_centroids_or_the_boxes() {
    // The nearest centroids of the halves' boxes: 3.5 and 6.5; their boxes end at 4 and begin at 6.
    for builder in [Builder::Median, Builder::Sah, Builder::Ploc] {
        let set = boxes(builder, |boxes| {
            boxes.to_level = 0;
            boxes.split_planes = true;
        });
        assert_eq!(set.planes.len(), 1, "{builder:?}: {:?}", set.notes);
        expect(
            &set,
            Vec3::X * 5.0,
            Vec3::new(5.0, 1.0, 0.0),
            [1.0, 0.1, 0.1],
        );
        assert_eq!(set.labels[0].text, "x = 5.000", "{builder:?}");
    }
}

#[test]
fn a_builder_without_planes_says_so_where_boxes_overlap() {
    // PLOC joins boxes and parts nothing by a plane.
    let mut scene = Scene::built("head", UVec2::ONE, glassbox::scene::Builder::Ploc);
    scene.settings.spp = 1;
    let inspect = InspectSettings {
        boxes: BoxSettings {
            on: true,
            split_planes: true,
            to_level: 40,
            ..BoxSettings::default()
        },
        ..InspectSettings::default()
    };
    let set = scene.lines(System::Boxes, &inspect);
    assert!(
        set.notes.iter().any(|note| note.contains("overlap")),
        "{:?}",
        set.notes
    );
}

#[test]
fn s6_visited_nodes_are_white_pruned_ones_red_and_the_hit_triangle_is_outlined() {
    let mut inspect = InspectSettings {
        rays: RaySettings {
            visited: true,
            pruned: true,
            hit_triangles: true,
            ..RaySettings::default()
        },
        ..InspectSettings::default()
    };
    let row = (0..4).map(|i| quad(Vec3::X * 3.0 * i as f32, Vec3::X, Vec3::Y).to_vec());
    let scene = Scene::of(often(row), camera());
    let set = scene.lines(System::Visits, &inspect);
    // The root and the second square: the ray misses all other boxes. No tree is walked above a mesh that is alone.
    assert_eq!(set.segments.len(), 2 * 12);
    expect(&set, Vec3::ZERO, Vec3::X * 10.0, WHITE);
    expect(&set, Vec3::X * 3.0, Vec3::X * 4.0, WHITE);
    let rays = scene.lines(System::Rays, &inspect);
    // The lower triangle of the square: (3,0), (4,0), (4,1).
    expect(&rays, Vec3::X * 3.0, Vec3::X * 4.0, [1.0, 0.85, 0.0]);

    // Along squares one behind the other: the first is hit, so the others, all of them on the ray, are pruned.
    let along = Camera::looking_at(
        Vec3::new(-1.0, 0.3, 0.1),
        Vec3::new(0.0, 0.3, 0.1),
        Vec3::Y,
        0.5,
    );
    let stack = (0..4).map(|i| {
        let corner = Vec3::new(2.0 * i as f32, -1.0, -1.0);
        quad(corner, Vec3::Y * 2.0, Vec3::Z * 2.0).to_vec()
    });
    let scene = Scene::of(often(stack), along);
    let set = scene.lines(System::Visits, &inspect);
    for x in [2.0, 4.0] {
        let corner = Vec3::new(x, -1.0, -1.0);
        expect(&set, corner, corner + Vec3::Y * 2.0, RED);
    }
    // An edge of the last one's box is one of the root's, too.
    let last = [-1.0, 1.0].map(|y| Vec3::new(6.0, y, -1.0));
    let is_last = |s: &&Segment| {
        last.iter()
            .all(|end| s.ends.iter().any(|at| is_near(*at, *end)))
    };
    let mut edges = set.segments.iter().filter(is_last);
    assert!(edges.any(|s| is_color(s.colors[0], RED)));
    // The root, the first square.
    let count = |color| {
        set.segments
            .iter()
            .filter(|s| is_color(s.colors[0], color))
            .count()
    };
    assert_eq!((count(WHITE), count(RED)), (2 * 12, 3 * 12));
    inspect.rays.pruned = false;
    let set = scene.lines(System::Visits, &inspect);
    assert_eq!(set.segments.len(), 2 * 12);
    assert!(set.segments.iter().all(|s| is_color(s.colors[0], WHITE)));
}

#[test]
fn leaf_sizes_costs_and_visits_colour_the_boxes() {
    let color = |set: &LineSet, node: u32| {
        let of_node = |stands: Stands| {
            stands
                == Stands::Node {
                    instance: Some(0),
                    node,
                }
        };
        set.segments
            .iter()
            .find(|s| of_node(s.stands))
            .unwrap()
            .colors[0]
    };
    for choice in [
        BoxColor::Level,
        BoxColor::LeafSize,
        BoxColor::Cost,
        BoxColor::Visits,
    ] {
        let set = boxes(Builder::Median, |boxes| {
            boxes.to_level = 40;
            boxes.color = choice;
        });
        let (root, leaf) = (color(&set, 0), color(&set, 6));
        assert_ne!(root, leaf, "{choice:?}");
    }
}

#[test]
fn more_boxes_than_there_is_room_for_are_thinned_by_level_and_it_says_so() {
    let mut scene = Scene::open("teapot", UVec2::ONE);
    scene.settings.spp = 1;
    let mut inspect = InspectSettings {
        max_lines: 12 * 100,
        ..InspectSettings::default()
    };
    inspect.boxes.on = true;
    inspect.boxes.to_level = 40;
    let set = scene.lines(System::Boxes, &inspect);
    let thinned = set.thinned.expect("a teapot has more than 100 nodes");
    assert!(thinned.drawn == 100 && thinned.of > 1000, "{thinned:?}");
    assert_eq!(set.segments.len(), 12 * thinned.drawn);
}

#[test]
fn of_a_level_that_does_not_fit_as_many_boxes_are_drawn_as_do() {
    let mut inspect = InspectSettings::default();
    for (most, level, drawn, of) in [(2, 2, 2, 4), (5, 0, 5, 7), (6, 0, 6, 7), (1, 0, 1, 7)] {
        inspect.max_lines = 12 * most + 5;
        inspect.boxes.trees = TreeChoice::Meshes;
        (inspect.boxes.from_level, inspect.boxes.to_level) = (level, 40);
        let set = Scene::of(row(Builder::Median), camera()).lines(System::Boxes, &inspect);
        let thinned = set.thinned.expect("there is no room for all");
        assert_eq!((thinned.drawn, thinned.of), (drawn, of), "{most}");
        assert_eq!(set.segments.len(), 12 * drawn, "{most}");
    }
}

#[test]
fn where_no_tree_is_asked_for_it_says_why() {
    let scene = Scene::of(row(Builder::Median), camera());
    let note = |scene: &Scene, change: &dyn Fn(&mut BoxSettings)| {
        let mut inspect = InspectSettings::default();
        change(&mut inspect.boxes);
        let mut notes = Vec::new();
        for form in [TreeForm::Binary, TreeForm::Wide] {
            inspect.boxes.form = form;
            let set = scene.lines(System::Boxes, &inspect);
            assert!(set.is_empty(), "{:?}", set.notes);
            notes.extend(set.notes);
        }
        assert!(notes.len() == 2 && notes[0] == notes[1], "{notes:?}");
        notes.remove(0)
    };
    let leaf = |boxes: &mut BoxSettings| {
        (boxes.choice, boxes.trees) = (BoxChoice::Leaf, TreeChoice::Top);
    };
    assert_eq!(
        note(&scene, &leaf),
        "the leaves of the tree over the objects hold objects: one with triangles is in a mesh's tree"
    );
    let top = |boxes: &mut BoxSettings| (boxes.object, boxes.trees) = (5, TreeChoice::Top);
    assert_eq!(
        note(&scene, &top),
        "the tree over the objects is of them all: that of object 5 is its mesh's"
    );
    let mut one = Scene::of(row(Builder::Median), camera());
    let options = BuildOptions {
        levels: Levels::One,
        ..*one.world.aggregate.options()
    };
    let instances = one.world.aggregate.instances().to_vec();
    one.world.aggregate = Arc::new(Aggregate::build(instances, &options));
    let one_tree = "there is one tree over all triangles: no mesh has one of its own";
    assert_eq!(
        note(&one, &|boxes| boxes.trees = TreeChoice::Meshes),
        one_tree
    );
    assert_eq!(note(&one, &|boxes| boxes.object = 5), one_tree);
    let empty = Scene::of(of_mesh(vec![], Builder::Median), camera());
    for trees in [TreeChoice::Both, TreeChoice::Top, TreeChoice::Meshes] {
        assert_eq!(
            note(&empty, &|boxes| boxes.trees = trees),
            "there is no tree: no object with a triangle is traced"
        );
    }
}

#[test]
fn a_key_changes_with_what_the_system_reads_and_with_nothing_else() {
    let scene = Scene::of(row(Builder::Median), camera());
    let rays = scene.probe(glassbox::trace::Samples::All);
    let base = InspectSettings::default();
    let key = |scene: &Scene, system: System, inspect: &InspectSettings| {
        let subject = glassbox::inspect::Subject::new(
            &scene.world,
            &scene.camera,
            &scene.settings,
            inspect,
            Some(&rays),
        );
        system.key(&subject)
    };
    let mut other = base.clone();
    other.boxes.to_level = 7;
    for system in System::ALL {
        let changed = key(&scene, system, &base) != key(&scene, system, &other);
        assert_eq!(changed, system == System::Boxes, "{system:?}");
    }
    let rebuilt = Scene::of(row(Builder::Median), camera());
    assert_ne!(
        key(&scene, System::Boxes, &base),
        key(&rebuilt, System::Boxes, &base)
    );
    assert_eq!(
        key(&scene, System::Lens, &base),
        key(&rebuilt, System::Lens, &base)
    );
}
