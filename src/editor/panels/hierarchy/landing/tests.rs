use super::super::super::outline::tests::village;
use super::*;
use crate::scene::{Phong, PointLamp, UsesMaterial};
use bevy::ecs::hierarchy::ChildOf;
use bevy::mesh::Mesh3d;

#[test]
fn rows_land_among_their_siblings_to_be_and_never_below_themselves() {
    let app = village();
    // House 10 { Roof 11 { Tile 12 }, Door 13 }, Garden 20 { Tree 21 }.
    let outline = app.world().resource::<Outline>();
    let rows: Vec<Row> = (0..outline.items.len()).map(Row::Item).collect();
    let place = |id| outline.place(SceneId(id));
    let lands = |id, target| landing(outline, &rows, &[SceneId(id)], target);
    assert_eq!(lands(12, place(10)), 3, "after the roof, before the door");
    assert_eq!(lands(21, place(10)), 4, "after the door");
    assert_eq!(lands(12, None), 4, "between house and garden");
    assert_eq!(lands(21, None), 6, "at the end");
    let may = |id, target| may_land(outline, &[SceneId(id)], target);
    assert!(may(12, place(10)) && may(13, None));
    assert!(!may(10, place(12)) && !may(10, place(10)));
    assert!(!may(13, place(10)), "it is there already");
    // Of several those count that move.
    let all = |ids: &[u64]| ids.iter().map(|&id| SceneId(id)).collect::<Vec<_>>();
    let (some, target) = (all(&[11, 21]), place(10));
    assert_eq!(landing(outline, &rows, &some, target), 4, "after the door");
    let along = all(&[10, 13]);
    assert!(!may_land(outline, &along, None), "the door comes along");
}

#[test]
fn nothing_lands_below_a_material() {
    let mut app = village();
    app.world_mut().spawn((SceneId(30), Phong::default()));
    app.update();
    let outline = app.world().resource::<Outline>();
    let place = |id| outline.place(SceneId(id));
    assert!(place(30).is_some() && may_land(outline, &[SceneId(12)], place(20)));
    assert!(!may_land(outline, &[SceneId(12)], place(30)));
}

#[test]
fn objects_get_the_material_that_they_are_dropped_onto_or_that_is_dropped_onto_them() {
    let mut app = village();
    let world = app.world_mut();
    let brick = world.spawn((SceneId(30), Phong::default())).id();
    world.spawn((SceneId(31), Phong::default()));
    // Tile 12 and door 13 are objects, roof 11 is a group, and tree 21 is a light.
    for id in [12, 13] {
        let entity = world
            .resource::<Outline>()
            .find(SceneId(id))
            .unwrap()
            .entity;
        world.entity_mut(entity).insert(Mesh3d::default());
    }
    let tree = world
        .resource::<Outline>()
        .find(SceneId(21))
        .unwrap()
        .entity;
    world.entity_mut(tree).insert(PointLamp::default());
    let door = world
        .resource::<Outline>()
        .find(SceneId(13))
        .unwrap()
        .entity;
    world.entity_mut(door).insert(UsesMaterial(brick));
    app.update();
    let outline = app.world().resource::<Outline>();
    let place = |id| outline.place(SceneId(id)).unwrap();
    let drops = |ids: &[u64], on: u64, is_between: bool| {
        let ids: Vec<SceneId> = ids.iter().map(|&id| SceneId(id)).collect();
        Landing::of(outline, &ids, place(on), is_between)
    };
    let given = |objects: &[u64], material: u64| Landing::Material {
        objects: objects.iter().map(|&id| SceneId(id)).collect(),
        material: place(material),
    };
    let only = Landing::Nowhere("Only objects have a material");
    let already = Landing::Nowhere("That is its material already");
    for is_between in [false, true] {
        assert_eq!(drops(&[12], 30, is_between), given(&[12], 30));
        // Of several those that have another one; of a group what is in it, once.
        assert_eq!(drops(&[21, 13, 12], 30, is_between), given(&[12], 30));
        assert_eq!(drops(&[10, 12], 31, is_between), given(&[12, 13], 31));
        assert_eq!(drops(&[13], 30, is_between), already);
        assert_eq!(drops(&[21], 30, is_between), only);
        // The other way round, also at a row's edge where the material stands already.
        assert_eq!(drops(&[31], 10, is_between), given(&[12, 13], 31));
        assert_eq!(drops(&[30], 31, is_between), Landing::Nowhere(""));
    }
    assert_eq!(drops(&[31], 13, false), given(&[13], 31));
    assert_eq!(drops(&[30], 13, false), already);
    assert_eq!(drops(&[30], 21, false), only);
    let one = Landing::Nowhere("An object has one material");
    assert_eq!(drops(&[30, 31], 12, false), one);
    // A material can be a part of a group.
    assert_eq!(drops(&[31], 13, true), Landing::Below(Some(place(10))));
    // All else is as it was.
    assert_eq!(drops(&[12], 10, false), Landing::Below(Some(place(10))));
    assert_eq!(drops(&[10], 12, false), Landing::Nowhere(""));
}

#[test]
fn many_rows_of_one_parent_are_dragged_at_once() {
    let mut app = village();
    let world = app.world_mut();
    let garden = world.resource::<Outline>().find(SceneId(20)).unwrap();
    let garden = garden.entity;
    let ids: Vec<SceneId> = (100..20_100).map(SceneId).collect();
    world.spawn_batch(ids.clone().into_iter().map(move |id| (id, ChildOf(garden))));
    app.update();
    let outline = app.world().resource::<Outline>();
    assert_eq!(moved(outline, &ids, outline.place(SceneId(10))), ids);
}
