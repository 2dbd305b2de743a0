//! The mixer as a person meets it, without a window.

use super::super::temperature::{WHITE, nearest};
use super::super::tests::{Desk, SMALL};
use super::mix::{Mixer, Strip, bake, lights};
use crate::editor::action::Action;
use crate::editor::document::{Document, adopt};
use crate::editor::edits::scene_entity;
use crate::editor::history::{History, redo, undo};
use crate::editor::preferences::Preferences;
use crate::editor::viewport::{EditorCamera, Viewport};
use crate::film::LightMix;
use crate::scene::{PointLamp, SceneId};
use crate::view::ViewSettings;
use bevy::camera::visibility::{InheritedVisibility, Visibility};
use bevy::color::LinearRgba;
use bevy::ecs::entity::Entity;
use bevy::ecs::name::Name;
use bevy::ecs::query::With;
use bevy::math::Vec3;
use bevy::transform::components::Transform;
use bevy_egui::egui::accesskit::Role;
use bevy_egui::egui::{Id, Modifiers, vec2};

fn lamp(desk: &mut Desk) -> (Entity, SceneId, String) {
    let mut lamps = desk
        .world()
        .query::<(Entity, &SceneId, &Name, &PointLamp)>();
    let (lamp, id, name, _) = lamps.iter(desk.app.world()).next().unwrap();
    (lamp, *id, name.to_string())
}

fn open() -> Desk {
    let mut desk = Desk::open("cornell-box");
    run(&mut desk, "lights.mixer");
    desk
}

fn run(desk: &mut Desk, command: &'static str) {
    desk.world().write_message(Action::run(command));
    desk.settle();
}

/// What the view shows.
fn mix(desk: &mut Desk) -> LightMix {
    let mut views = desk
        .world()
        .query_filtered::<Option<&ViewSettings>, With<EditorCamera>>();
    let own = views.single(desk.app.world()).unwrap();
    own.map(|own| own.mix.clone()).unwrap_or_default()
}

fn set(desk: &mut Desk, id: SceneId, change: impl FnOnce(&mut Strip)) {
    let mut mixer = desk.world().resource_mut::<Mixer>();
    let mut strip = mixer.strip(id);
    change(&mut strip);
    mixer.set(id, strip);
    desk.settle();
}

#[test]
fn the_mixer_opens_beside_the_comparison_and_inside_the_picture() {
    for (size, is_beside) in [([1920.0, 1080.0, 1.0], true), (SMALL, false)] {
        let mut desk = Desk::empty(size);
        desk.world().spawn((SceneId(1), PointLamp::default()));
        desk.settle();
        run(&mut desk, "lights.mixer");
        let picture = desk.world().resource::<Viewport>().rect;
        let id = Id::new("light mixer");
        let mixer = desk.context.memory(|memory| memory.area_rect(id));
        let mixer = mixer.expect("it is open");
        assert!(picture.min.x <= mixer.left() && mixer.right() <= picture.max.x);
        // A comparison is 640 wide besides its frame.
        let right_of_it = mixer.left() > picture.min.x + 12.0 + 640.0 + 12.0;
        assert_eq!(right_of_it, is_beside, "{mixer:?} in {picture:?}");
    }
}

#[test]
fn a_click_on_mute_darkens_the_light_in_the_view_and_nothing_in_the_scene() {
    let mut desk = open();
    let (_, id, name) = lamp(&mut desk);
    desk.place_of("Light mixer");
    desk.place_of(&name);
    desk.place_of("The view shows no traced picture.");
    let steps = desk.world().resource::<History>().position();
    desk.world().clear_trackers();
    desk.click_on("M");
    assert_eq!(mix(&mut desk).gains.of(id.0), Vec3::ZERO);
    let changed = desk.changed();
    assert!(changed.is_empty(), "{changed:?}");
    assert_eq!(desk.world().resource::<History>().position(), steps);
    desk.click_on("M");
    assert!(mix(&mut desk).gains.is_neutral());
    // It can be closed, and what is set stays.
    set(&mut desk, id, |strip| strip.gain = 2.0);
    run(&mut desk, "lights.mixer");
    assert!(desk.find("Bake into the lights").is_none());
    assert_eq!(mix(&mut desk).gains.of(id.0), Vec3::splat(2.0));
}

#[test]
fn solo_silences_the_other_lights_those_that_are_added_later_too() {
    let mut desk = open();
    let (_, id, _) = lamp(&mut desk);
    desk.select([id]);
    run(&mut desk, "lights.solo");
    let other = SceneId(4711);
    desk.world().spawn((
        other,
        Name::new("Other"),
        PointLamp::default(),
        Transform::default(),
    ));
    desk.settle();
    let gains = mix(&mut desk).gains;
    assert_eq!([gains.of(id.0), gains.of(other.0)], [Vec3::ONE, Vec3::ZERO]);
    run(&mut desk, "lights.solo");
    assert!(mix(&mut desk).gains.is_neutral());
}

#[test]
fn the_mix_is_baked_as_one_step_that_undo_takes_back() {
    let mut desk = open();
    let (entity, id, _) = lamp(&mut desk);
    let before = desk.world().get::<PointLamp>(entity).unwrap().clone();
    let steps = desk.world().resource::<History>().position();
    set(&mut desk, id, |strip| {
        strip.gain = 3.0;
        strip.color = LinearRgba::rgb(0.5, 1.0, 0.25);
    });
    desk.click_on("Bake into the lights");
    desk.settle();
    let after = desk.world().get::<PointLamp>(entity).unwrap().clone();
    assert_eq!(after.intensity, 3.0 * before.intensity);
    assert_eq!(after.color.red, 0.5 * before.color.red);
    assert!(mix(&mut desk).gains.is_neutral(), "the lights have it now");
    let history = desk.world().resource::<History>();
    assert_eq!(history.position(), steps + 1);
    assert_eq!(history.undo_text(), Some("Bake the mix into the lights"));
    assert!(undo(desk.world()).is_some());
    assert_eq!(desk.world().get::<PointLamp>(entity), Some(&before));
    desk.settle();
    assert_eq!(
        desk.world().resource::<Mixer>().strip(id).gain,
        3.0,
        "the mix is back"
    );
    assert!(redo(desk.world()).is_some());
    desk.settle();
    assert!(
        desk.world().resource::<Mixer>().is_neutral(),
        "and gone again"
    );
    assert!(undo(desk.world()).is_some());
    desk.settle();
    desk.world().resource_mut::<Mixer>().reset();
    // A light that is not heard has no intensity, and keeps its colour.
    set(&mut desk, id, |strip| strip.is_muted = true);
    run(&mut desk, "lights.bake");
    let dark = desk.world().get::<PointLamp>(entity).unwrap();
    assert_eq!((dark.intensity, dark.color), (0.0, before.color));
}

#[test]
fn the_mixer_and_a_lights_own_field_say_one_temperature_and_mean_the_same_by_it() {
    let mut desk = open();
    let (entity, id, _) = lamp(&mut desk);
    let row = |desk: &mut Desk| {
        let mut rows = lights(desk.world()).into_iter();
        rows.find(|row| row.id == id).unwrap()
    };
    for own in [LinearRgba::WHITE, LinearRgba::rgb(1.0, 0.8, 0.5)] {
        desk.world().get_mut::<PointLamp>(entity).unwrap().color = own;
        let light = row(&mut desk);
        assert_eq!(light.kelvin(), nearest(light.color).round());
        let mut strip = Strip::default();
        assert_eq!(strip.kelvin_of(&light), light.kelvin());
        assert_eq!(strip.kelvin_of(&light) == WHITE, own == LinearRgba::WHITE);
        strip.set_kelvin(&light, 3000.0);
        assert_eq!(strip.kelvin_of(&light), 3000.0);
        set(&mut desk, id, |set| *set = strip.clone());
        run(&mut desk, "lights.bake");
        let baked = row(&mut desk);
        let error = (baked.kelvin() - 3000.0).abs();
        assert!(error <= 1.0, "{} K", baked.kelvin());
        // The one that it has leaves it as it is.
        strip.set_kelvin(&light, light.kelvin());
        assert_eq!(strip, Strip::default());
    }
}

#[test]
fn with_lights_in_one_plane_the_view_hears_of_it_and_another_scene_of_no_mix() {
    let mut desk = open();
    adopt(desk.world(), "cornell-box", None);
    let (_, id, _) = lamp(&mut desk);
    set(&mut desk, id, |strip| strip.kelvin = Some([3000.0, WHITE]));
    desk.world().resource_mut::<Preferences>().lights_apart = false;
    desk.settle();
    let warm = mix(&mut desk);
    assert!(!warm.apart && warm.gains.of(id.0).x > warm.gains.of(id.0).z);
    desk.world().write_message(Action::Open("triangle".into()));
    desk.settle();
    let document = desk.world().resource::<Document>();
    assert_eq!(document.name, "triangle", "a mix is no change of the scene");
    assert!(mix(&mut desk).gains.is_neutral());
    assert!(desk.world().resource::<Mixer>().is_neutral());
}

#[test]
fn a_light_that_is_deleted_while_its_gain_is_dragged_is_baked_into_nothing() {
    let mut desk = open();
    let (entity, id, _) = lamp(&mut desk);
    desk.context.enable_accesskit();
    desk.settle();
    let at = desk.control_beside("Gain", Role::Slider);
    desk.point(at);
    desk.button(at, true, Modifiers::NONE);
    desk.point(at + vec2(20.0, 0.0));
    let dragged = desk.world().resource::<Mixer>().strip(id).gain;
    assert!(dragged > 0.0 && dragged != 1.0, "{dragged}");
    desk.world().despawn(entity);
    desk.point(at + vec2(30.0, 0.0));
    desk.button(at, false, Modifiers::NONE);
    assert!(desk.find("Gain").is_none());
    run(&mut desk, "lights.bake");
    assert!(mix(&mut desk).gains.is_neutral());
}

#[test]
fn a_light_that_was_alone_and_is_deleted_silences_nobody() {
    let mut desk = open();
    let (entity, id, _) = lamp(&mut desk);
    let other = SceneId(10_000);
    desk.world().spawn((other, PointLamp::default()));
    set(&mut desk, id, |strip| strip.is_solo = true);
    desk.settle();
    assert_eq!(mix(&mut desk).gains.of(other.0), Vec3::ZERO);
    desk.world().despawn(entity);
    desk.settle();
    assert!(mix(&mut desk).gains.is_neutral());
}

#[test]
fn of_a_thousand_lights_only_those_rows_are_laid_out_that_are_seen() {
    let mut desk = open();
    for number in 0..1000 {
        desk.world().spawn((
            SceneId(10_000 + number),
            Name::new(format!("Bulb {number}")),
            PointLamp::default(),
            Transform::default(),
        ));
    }
    // The list has rows of the same names.
    desk.world().resource_mut::<Preferences>().show_hierarchy = false;
    desk.settle();
    desk.place_of("⏷ Bulb (1000)");
    let seen = (0..1000).filter(|number| desk.find(&format!("Bulb {number}")).is_some());
    let seen = seen.count();
    assert!((1..20).contains(&seen), "{seen} rows");
    desk.click_on("⏷ Bulb (1000)");
    assert!(desk.find("Bulb 0").is_none(), "folded");
}

#[test]
fn the_window_is_as_high_as_its_rows_and_leaves_most_of_the_picture_where_they_are_many() {
    let mut desk = open();
    let (_, _, name) = lamp(&mut desk);
    let height = |desk: &Desk| {
        let foot = desk.place_of("Bake into the lights").y;
        foot - desk.place_of("Light mixer").y
    };
    let below = desk.place_of("Bake into the lights").y - desk.place_of("Colour").y;
    // A row ends some points below its last line.
    assert!((0.0..80.0).contains(&below), "{below} points below {name}");
    let low = height(&desk);
    for number in 0..30 {
        desk.world().spawn((
            SceneId(10_000 + number),
            Name::new(format!("Light {}", char::from(b'a' + number as u8))),
            PointLamp::default(),
            Transform::default(),
        ));
    }
    desk.settle();
    let high = height(&desk);
    assert!(high > low + 100.0, "{low} points, and {high}");
    assert!(high < 0.75 * desk.size[1], "{high} points");
}

#[test]
fn what_is_set_for_a_hidden_light_is_kept_where_the_others_are_baked() {
    let mut desk = open();
    let (_, id, _) = lamp(&mut desk);
    let hidden = SceneId(4711);
    desk.world().spawn((
        hidden,
        PointLamp::default(),
        Transform::default(),
        Visibility::Hidden,
    ));
    desk.settle();
    set(&mut desk, hidden, |strip| strip.gain = 0.5);
    set(&mut desk, id, |strip| strip.gain = 2.0);
    // Whether it is seen follows in a schedule of the window.
    let other = scene_entity(desk.world(), hidden).unwrap();
    desk.world()
        .entity_mut(other)
        .insert(InheritedVisibility::HIDDEN);
    bake(desk.world());
    let mixer = desk.world().resource::<Mixer>();
    assert_eq!([mixer.strip(id).gain, mixer.strip(hidden).gain], [1.0, 0.5]);
}
