//! Components of an app's own, as a person meets them: seen, edited, undone, copied, added, taken away, saved.

mod copies;

use super::desk::Desk;
use crate::editor::edits::{copy, duplicate, paste, scene_entity};
use crate::editor::history::{History, redo, reset, undo};
use crate::io::{OpenOptions, SceneSource, builtin, open};
use crate::scene::{Quantity, SceneId};
use bevy::asset::{AssetServer, Assets, Handle};
use bevy::color::Color;
use bevy::ecs::component::Component;
use bevy::ecs::entity::Entity;
use bevy::ecs::reflect::ReflectComponent;
use bevy::image::Image;
use bevy::math::{Quat, Vec3};
use bevy::reflect::Reflect;
use bevy::reflect::std_traits::ReflectDefault;
use bevy_egui::egui::accesskit::Role;
use bevy_egui::egui::{Event, Key};
use std::collections::HashMap;

/// One of everything.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default)]
#[type_path = "garden"]
struct Growing {
    #[reflect(@Quantity::within(0.0, 10.0, "m"))]
    girth: f32,
    pruned: bool,
    rings: u8,
    debt: i64,
    label: String,
    sun: Vec3,
    lean: Quat,
    leaf: Color,
    kind: Plant,
    since: Option<f32>,
    weights: Vec<f32>,
    pot: Pot,
    by_name: HashMap<String, f32>,
}

impl Default for Growing {
    fn default() -> Self {
        Self {
            girth: 1.0,
            pruned: false,
            rings: 7,
            debt: -3,
            label: "rose".into(),
            sun: Vec3::Y,
            lean: Quat::IDENTITY,
            leaf: Color::srgb(0.0, 1.0, 0.0),
            kind: Plant::Moss,
            since: None,
            weights: vec![0.5],
            pot: Pot::default(),
            by_name: HashMap::from([("a".into(), 1.0)]),
        }
    }
}

#[derive(Reflect, Clone, Debug, PartialEq, Default)]
#[type_path = "garden"]
enum Plant {
    #[default]
    Moss,
    Tree {
        crown: f32,
    },
    Vine(f32, u8),
}

#[derive(Reflect, Clone, Debug, PartialEq, Default)]
#[type_path = "garden"]
struct Pot {
    width: f32,
    inner: Vec<Pot>,
}

/// It has no value to begin with.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component)]
#[type_path = "garden"]
struct Fence {
    posts: u32,
}

/// It has assets.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component)]
#[type_path = "garden"]
struct Labelled {
    front: Handle<Image>,
    back: Option<Handle<Image>>,
    inside: Handle<Image>,
}

/// It is registered, and says nothing of being a component.
#[derive(Component, Reflect, Clone, Debug, PartialEq, Default)]
#[type_path = "garden"]
struct Hidden {
    depth: f32,
}

/// It can be neither cloned nor made.
#[derive(Component, Reflect)]
#[reflect(Component, from_reflect = false)]
#[type_path = "garden"]
struct Sealed {
    secret: u32,
}

/// The mirror block of a box, with some of them.
fn garden(carries: impl bevy::ecs::bundle::Bundle) -> (Desk, Entity, SceneId) {
    // High enough for all that the inspector shows of them.
    let mut desk = Desk::empty([1280.0, 4000.0, 1.0]);
    desk.context.enable_accesskit();
    desk.app
        .register_type::<Growing>()
        .register_type::<Fence>()
        .register_type::<Hidden>()
        .register_type::<Labelled>()
        .register_type::<Sealed>();
    let source = SceneSource::Builtin(builtin::find("cornell-box").unwrap());
    open(desk.world(), &source, OpenOptions::default()).unwrap();
    let (entity, id) = desk.named("Mirror block");
    desk.world().entity_mut(entity).insert(carries);
    desk.settle();
    reset(desk.world());
    desk.select([id]);
    (desk, entity, id)
}

fn growing(desk: &mut Desk, entity: Entity) -> Growing {
    desk.world().get::<Growing>(entity).unwrap().clone()
}

impl Desk {
    fn enter(&mut self, label: &str, text: &str) {
        self.click(self.control_beside(label, Role::SpinButton));
        assert!(self.context.text_edit_focused(), "a field beside {label}");
        self.key(Key::Delete);
        self.frame(vec![Event::Text(text.into())]);
        self.key(Key::Enter);
        self.settle();
    }
}

#[test]
fn an_app_s_component_is_seen_and_each_edit_is_a_step() {
    let (mut desk, entity, _) = garden(Growing::default());
    for label in [
        "Growing",
        "Girth",
        "Pruned",
        "Rings",
        "Debt",
        "Label",
        "Sun",
        "Lean",
        "Leaf",
        "Kind",
        "Since",
        "Weights",
        "Weights 1",
        "Pot",
        "By name",
    ] {
        desk.place_of(label);
    }
    desk.enter("Girth", "2.5");
    assert_eq!(growing(&mut desk, entity).girth, 2.5);
    desk.enter("Girth", "99");
    assert_eq!(
        growing(&mut desk, entity).girth,
        10.0,
        "its schema is heeded"
    );
    desk.enter("Rings", "300");
    assert_eq!(growing(&mut desk, entity).rings, 255);
    desk.enter("Debt", "-12");
    assert_eq!(growing(&mut desk, entity).debt, -12);
    let names: Vec<String> = desk
        .world()
        .resource::<History>()
        .steps()
        .map(Into::into)
        .collect();
    assert_eq!(names, vec!["Change Growing of Mirror block"; 4]);
    for _ in 0..4 {
        assert!(undo(desk.world()).is_some());
    }
    assert_eq!(growing(&mut desk, entity), Growing::default());
    for _ in 0..4 {
        assert!(redo(desk.world()).is_some());
    }
    assert_eq!(growing(&mut desk, entity).debt, -12);
}

#[test]
fn variants_options_and_lists_are_entered_too() {
    let (mut desk, entity, _) = garden(Growing::default());
    desk.click(desk.control_beside("Since", Role::CheckBox));
    desk.settle();
    assert_eq!(growing(&mut desk, entity).since, Some(0.0));
    desk.click_on("Moss");
    desk.settle();
    desk.click_on("Vine");
    desk.settle();
    assert_eq!(growing(&mut desk, entity).kind, Plant::Vine(0.0, 0));
    desk.place_of("Kind 2");
    desk.click(desk.place_beside("Weights", "Add"));
    desk.settle();
    assert_eq!(growing(&mut desk, entity).weights, [0.5, 0.5]);
    desk.click(desk.place_beside("Weights 1", "✖"));
    desk.settle();
    assert_eq!(growing(&mut desk, entity).weights, [0.5]);
    for _ in 0..4 {
        assert!(undo(desk.world()).is_some());
    }
    assert_eq!(growing(&mut desk, entity), Growing::default());
}

#[test]
fn it_is_added_from_a_menu_with_a_search_and_taken_away_as_steps() {
    let (mut desk, entity, _) = garden(());
    assert!(desk.find("Growing").is_none());
    desk.click_on("Add component…");
    desk.settle();
    desk.place_of("Fence");
    desk.frame(vec![Event::Text("grw".into())]);
    desk.settle();
    assert!(desk.find("Fence").is_none(), "the search leaves what fits");
    desk.click_on("Growing");
    desk.settle();
    assert_eq!(growing(&mut desk, entity), Growing::default());
    desk.click_on("Remove");
    desk.settle();
    assert!(desk.world().get::<Growing>(entity).is_none());
    let steps: Vec<String> = desk
        .world()
        .resource::<History>()
        .steps()
        .map(Into::into)
        .collect();
    assert_eq!(
        steps,
        [
            "Add Growing to Mirror block",
            "Remove Growing from Mirror block"
        ]
    );
    undo(desk.world());
    assert_eq!(growing(&mut desk, entity), Growing::default());
    undo(desk.world());
    assert!(desk.world().get::<Growing>(entity).is_none());
}

#[test]
fn what_has_no_value_to_begin_with_is_edited_and_copied_and_cannot_be_added() {
    let (mut desk, entity, id) = garden(Fence { posts: 4 });
    desk.enter("Posts", "9");
    assert_eq!(desk.world().get(entity), Some(&Fence { posts: 9 }));
    let twin = duplicate(desk.world(), &[id]).roots[0];
    let clipboard = copy(desk.world(), &[id]).unwrap();
    let pasted = paste(desk.world(), &clipboard).unwrap()[0];
    for id in [twin, pasted] {
        let entity = scene_entity(desk.world(), id).unwrap();
        assert_eq!(desk.world().get(entity), Some(&Fence { posts: 9 }));
    }
    let (other, id) = desk.named("Short block");
    desk.select([id]);
    desk.click_on("Add component…");
    desk.settle();
    desk.click_on("Fence");
    desk.settle();
    assert_eq!(
        desk.world().get::<Fence>(other),
        None,
        "nothing was made up"
    );
}

#[test]
fn what_cannot_be_made_or_is_no_component_to_reflection_is_shown_and_copied() {
    let (mut desk, entity, id) = garden((Sealed { secret: 41 }, Hidden { depth: 2.0 }));
    desk.click_on("Other components");
    // It unfolds slowly.
    desk.wait(1.0);
    desk.settle();
    desk.place_of("Sealed");
    desk.place_of("Sealed { secret: 41 }");
    let twin = duplicate(desk.world(), &[id]).roots[0];
    let twin = scene_entity(desk.world(), twin).unwrap();
    assert_eq!(desk.world().get::<Sealed>(twin).unwrap().secret, 41);
    assert_eq!(desk.world().get::<Hidden>(twin).unwrap().depth, 2.0);
    desk.world().get_mut::<Sealed>(entity).unwrap().secret = 42;
    desk.settle();
    assert_eq!(desk.world().get::<Sealed>(entity).unwrap().secret, 42);
}

#[test]
fn no_number_and_great_depth_make_no_steps_of_their_own() {
    let mut deep = Pot::default();
    for _ in 0..40 {
        deep = Pot {
            width: f32::NAN,
            inner: vec![deep],
        };
    }
    let odd = Growing {
        girth: f32::NAN,
        sun: Vec3::splat(f32::INFINITY),
        pot: deep,
        weights: vec![f32::NAN; 300],
        ..Growing::default()
    };
    let (mut desk, entity, _) = garden(odd);
    let touch = |desk: &mut Desk| {
        desk.world().get_mut::<Growing>(entity).unwrap().rings += 0;
        desk.settle();
    };
    touch(&mut desk);
    touch(&mut desk);
    assert_eq!(desk.world().resource::<History>().steps().count(), 0);
    desk.place_of("and 236 more");
    desk.enter("Rings", "8");
    assert!(undo(desk.world()).is_some());
    let after = growing(&mut desk, entity);
    assert_eq!((after.rings, after.weights.len()), (7, 300));
    assert!(after.girth.is_nan());
}

#[test]
fn a_handle_is_shown_as_the_path_of_its_asset() {
    let (mut desk, entity, _) = garden(Labelled::default());
    let made = desk
        .world()
        .resource_mut::<Assets<Image>>()
        .add(Image::default());
    let loaded = desk.world().resource::<AssetServer>().load("leaf.png");
    let labelled = Labelled {
        front: loaded,
        back: Some(made),
        inside: Handle::default(),
    };
    desk.world().entity_mut(entity).insert(labelled);
    desk.settle();
    for text in ["leaf.png", "made by the app", "none"] {
        desk.place_of(text);
    }
    assert!(desk.find("Strong").is_none(), "what Bevy calls a handle");
}

#[test]
fn several_are_edited_at_once_and_keep_what_was_not_entered() {
    let (mut desk, entity, id) = garden(Growing::default());
    let (other, other_id) = desk.named("Short block");
    let before = Growing {
        label: "fern".into(),
        weights: vec![1.0, 2.0, 3.0],
        ..Growing::default()
    };
    desk.world().entity_mut(other).insert(before);
    reset(desk.world());
    desk.select([other_id, id]);
    desk.enter("Girth", "3");
    let after = growing(&mut desk, other);
    assert_eq!(
        (after.girth, &*after.label, after.weights.len()),
        (3.0, "fern", 3)
    );
    desk.click(desk.place_beside("Weights", "Add"));
    desk.settle();
    assert_eq!(growing(&mut desk, entity).weights, [0.5, 0.5]);
    assert_eq!(
        growing(&mut desk, other).weights,
        [0.5, 0.5],
        "all get what was entered"
    );
}
