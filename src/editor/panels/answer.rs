//! Why a pixel is as it is, in one sentence beside it; and what the pointer is waited for with.

use super::context_menu::ContextMenu;
use super::line_legend;
use super::mirror_picture::MirrorPicture;
use super::says::Says;
use crate::editor::action::Action;
use crate::editor::document::SceneOpened;
use crate::editor::inspection::{DebugRay, show_preset};
use crate::editor::pick::{self, to_points};
use crate::editor::pointer::{Armed, PixelAsked, arm, ask_pixel};
use crate::editor::preferences::Preferences;
use crate::editor::selection::Escaped;
use crate::editor::viewport::Viewport;
use crate::inspect::{InspectPreset, Names, Question, answer};
use crate::scene::{RenderSettings, SceneId};
use crate::trace::RayKind;
use bevy::ecs::observer::On;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Res, ResMut};
use bevy::ecs::world::World;
use bevy::math::{Ray3d, Vec2};
use bevy_egui::egui::{
    self, Align, Align2, Area, CursorIcon, Id, Label, Order, Pos2, Rect, RichText, Stroke,
    Vec2 as Extent, vec2,
};

/// Points.
const WIDTH: f32 = 300.0;
/// Points between the answer and the legend of the lines.
const GAP: f32 = 6.0;
/// How much less a part of the legend is missed than one of a card with buttons.
const LEGEND_MISSED: f32 = 0.1;
/// How far away it is where a ray met nothing.
const FAR: f32 = 1e5;

/// What was asked and is being answered.
#[derive(Resource, Default)]
pub(super) struct Answer(Option<Asked>);

/// Logical pixels around the asked place in which the answer alone is read.
const BESIDE: f32 = 12.0;

impl Answer {
    /// Whether a question was asked there, and its answer is open.
    pub fn is_asked_at(&self, at: Vec2) -> bool {
        let asked = self.0.as_ref();
        asked.is_some_and(|asked| asked.at.distance(at) <= BESIDE)
    }
}

/// A pixel that was asked about.
struct Asked {
    question: Question,
    /// Logical pixels of the window, when it was asked.
    at: Vec2,
    /// What the pixel saw from there.
    ray: Option<Ray3d>,
    /// Which of the debug ray's shots it is.
    shots: u64,
    /// The sentence, of which rays with which names.
    known: Option<((u64, u64), String)>,
    /// What the mirror sees that the sentence is about.
    mirror: MirrorPicture,
}

/// Asks this of the pixel whose menu it was chosen from; from anywhere else the next click in the view does.
pub(super) fn ask(world: &mut World, question: Question) {
    match world.resource::<ContextMenu>().chosen_at() {
        Some(at) => ask_pixel(world, question, at),
        None => arm(world, Armed::Why(question)),
    }
}

pub(super) fn note_question(asked: On<PixelAsked>, ray: Res<DebugRay>, mut answer: ResMut<Answer>) {
    answer.0 = Some(Asked {
        question: asked.question,
        at: asked.at,
        ray: None,
        shots: ray.shots(),
        known: None,
        mirror: MirrorPicture::default(),
    });
}

pub(super) fn forget_question(_: On<Escaped>, mut answer: ResMut<Answer>) {
    answer.0 = None;
}

pub(super) fn forget_scene(_: On<SceneOpened>, mut answer: ResMut<Answer>) {
    answer.0 = None;
}

/// The cross of a command that waits for a click.
pub(super) fn armed_ui(context: &egui::Context, free: Rect, world: &World) {
    let text = match world.get_resource::<Armed>() {
        None | Some(Armed::No) => return,
        Some(Armed::Why(Question::Black)) => "Click a pixel: why is it black? (Esc: none)",
        Some(Armed::Why(Question::Noisy)) => "Click a pixel: why is it noisy? (Esc: none)",
        Some(Armed::Why(Question::Color)) => "Click a pixel: why has it this colour? (Esc: none)",
        Some(Armed::Aim) => "Click what shall be aimed at (Esc: nothing)",
        Some(Armed::Focus) => "Click what shall be sharp (Esc: nothing)",
    };
    let pointer = context.pointer_latest_pos();
    let Some(at) = pointer.filter(|_| world.resource::<Viewport>().hovered) else {
        return;
    };
    context.set_cursor_icon(CursorIcon::Crosshair);
    let id = Id::new("what is waited for");
    let known = context.memory(|memory| memory.area_rect(id));
    let size = known.map_or(vec2(WIDTH, 30.0), |known| known.size());
    let (pivot, corner) = corner_free(free, at, [16.0, 8.0], size, &clickable(context));
    Area::new(id)
        .order(Order::Tooltip)
        .interactable(false)
        .pivot(pivot)
        .fixed_pos(corner)
        .constrain_to(free)
        .show(context, |ui| {
            egui::Frame::popup(ui.style()).show(ui, |ui| ui.label(text));
        });
}

/// The sentence, and where to go from it; true where the pointer is over it.
pub(super) fn answer_ui(
    context: &egui::Context,
    free: Rect,
    world: &mut World,
    shown: &mut Answer,
) -> bool {
    let Some(asked) = &mut shown.0 else {
        return false;
    };
    let offset = world.resource::<Viewport>().offset(asked.at);
    if asked.ray.is_none() {
        asked.ray = pick::ray(world, asked.at - offset);
    }
    let ray = world.resource::<DebugRay>();
    if ray.shots() != asked.shots {
        shown.0 = None;
        return false;
    }
    let names = world.resource::<Names>();
    let of = (ray.number(), names.version);
    // Those of another question stand until all samples are there.
    let rays = ray.rays().filter(|_| !ray.is_busy());
    if let Some(rays) = rays
        && asked.known.as_ref().is_none_or(|(known, _)| *known != of)
    {
        asked.known = Some((of, answer(asked.question, rays, &names.things)));
    }
    // What a pixel's noise comes from is no question of what is seen.
    if asked.question != Question::Noisy && !ray.is_busy() {
        let output = &world.resource::<RenderSettings>().output;
        asked.mirror.update(context, ray, output);
    }
    let text = asked.known.as_ref().map_or("…", |(_, text)| text);
    let camera = rays.and_then(|rays| rays.rays.iter().find(|ray| ray.kind == RayKind::Camera));
    let met = camera
        .and_then(|ray| ray.hit)
        .map(|hit| SceneId(hit.object));
    // The view may have moved since: the answer stays with what it is about.
    let far = camera.map(|ray| ray.t * ray.direction.length());
    let far = far.filter(|far| far.is_finite()).unwrap_or(FAR);
    let seen = asked.ray.map(|ray| ray.get_point(far));
    let seen = seen.and_then(|seen| pick::to_window(world, seen));
    let at = seen.map_or(asked.at, |seen| seen + offset);
    let at = to_points(context, at);
    let (pivot, corner) = corner_beside(free, at, [14.0; 2]);
    let preset = match asked.question {
        Question::Noisy => InspectPreset::WhereIsTheNoiseFrom,
        _ => InspectPreset::WhyBlack,
    };
    let mut wish = None;
    let id = Id::new("why a pixel is as it is");
    let legend = line_legend::layer();
    let (known, taken) = context.memory(|memory| {
        let taken = memory.areas().is_visible(&legend);
        let taken = taken.then(|| memory.area_rect(legend.id)).flatten();
        (memory.area_rect(id), taken)
    });
    let size = known.map_or(vec2(WIDTH, 60.0), |known| known.size());
    let room = room_beside(free, pivot.anchor_size(corner, size), taken);
    let area = Area::new(id)
        .order(Order::Middle)
        .pivot(pivot)
        .fixed_pos(corner)
        .constrain_to(room)
        .show(context, |ui| {
            egui::Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_max_width(WIDTH.min(free.width() - 20.0));
                ui.add(Label::new(RichText::new(text).strong()).wrap());
                asked.mirror.show(ui);
                ui.horizontal(|ui| {
                    for (name, says, what) in [
                        (
                            "Show rays",
                            "Draws the pixel's rays, each in the light that it carries",
                            Wish::Rays,
                        ),
                        (
                            "Ray inspector",
                            "Lists the pixel's rays with all their numbers",
                            Wish::Tree,
                        ),
                    ] {
                        if ui.small_button(name).says(says).clicked() {
                            wish = Some(what);
                        }
                    }
                    let go = ui.add_enabled(met.is_some(), egui::Button::new("Go there").small());
                    if go.says("Selects the object there, and frames it").clicked() {
                        wish = met.map(Wish::Go);
                    }
                    if ui.small_button("✖").says("Closes this (Esc)").clicked() {
                        wish = Some(Wish::Close);
                    }
                });
            });
        });
    let ink = context
        .style_of(context.theme())
        .visuals
        .selection
        .stroke
        .color;
    let cross = context.layer_painter(egui::LayerId::background());
    let cross = cross.with_clip_rect(free);
    for side in [
        vec2(1.0, 0.0),
        vec2(-1.0, 0.0),
        vec2(0.0, 1.0),
        vec2(0.0, -1.0),
    ] {
        for (width, ink) in [(3.0, egui::Color32::from_black_alpha(160)), (1.2, ink)] {
            let line = [at + 4.0 * side, at + 11.0 * side];
            cross.line_segment(line, Stroke::new(width, ink));
        }
    }
    match wish {
        Some(Wish::Rays) => show_preset(world, preset),
        Some(Wish::Tree) => world.resource_mut::<Preferences>().show_rays = true,
        Some(Wish::Go(id)) => {
            world.write_message(Action::Select(vec![id]));
            world.write_message(Action::run("view.frame-selected"));
            shown.0 = None;
        }
        Some(Wish::Close) => shown.0 = None,
        None => {}
    }
    let pointer = context.pointer_latest_pos();
    pointer.is_some_and(|at| area.response.rect.contains(at))
}

/// Where a card beside a place has its corner, and which of its corners that is: away from the nearer sides of the free
/// rectangle, so that it lies over that; so many points right of and below the place, and left of and above it.
pub(super) fn corner_beside(free: Rect, at: Pos2, [after, before]: [f32; 2]) -> (Align2, Pos2) {
    let [right, below] = [at.x < free.center().x, at.y < free.center().y];
    let pivot = match (right, below) {
        (true, true) => Align2::LEFT_TOP,
        (true, false) => Align2::LEFT_BOTTOM,
        (false, true) => Align2::RIGHT_TOP,
        (false, false) => Align2::RIGHT_BOTTOM,
    };
    let away = |is_after: bool| if is_after { after } else { -before };
    (pivot, at + vec2(away(right), away(below)))
}

/// The same for what goes with the pointer: at the first corner, from that one on, at which it lies over nothing that can be
/// clicked, or over the least of it.
pub(super) fn corner_free(
    free: Rect,
    at: Pos2,
    [after, before]: [f32; 2],
    size: Extent,
    taken: &[(Rect, f32)],
) -> (Align2, Pos2) {
    let away = |align| match align {
        Align::Min => after,
        _ => -before,
    };
    let (first, _) = corner_beside(free, at, [after, before]);
    let flipped = |align| match align {
        Align::Min => Align::Max,
        _ => Align::Min,
    };
    let [x, y] = first.0;
    let corners = [
        [x, y],
        [flipped(x), y],
        [x, flipped(y)],
        [flipped(x), flipped(y)],
    ];
    let hidden = |[x, y]: [Align; 2]| {
        let corner = at + vec2(away(x), away(y));
        let wanted = Align2([x, y]).anchor_size(corner, size);
        let last = (free.max - size).max(free.min);
        let stands = Rect::from_min_size(wanted.min.clamp(free.min, last), size);
        let over = taken.iter().map(|(taken, missed)| {
            let part = taken.intersect(stands);
            if part.is_positive() {
                part.area() * missed
            } else {
                0.0
            }
        });
        let over: f32 = over.sum();
        // Over what it is about it would be worst.
        over + if stands.contains(at) {
            stands.area()
        } else {
            0.0
        }
    };
    let least = corners.into_iter().map(|corner| (hidden(corner), corner));
    let least = least.reduce(|best, next| if next.0 < best.0 { next } else { best });
    let [x, y] = least.map_or(first.0, |(_, corner)| corner);
    (Align2([x, y]), at + vec2(away(x), away(y)))
}

/// Where cards and windows lie over the picture that have something to click, and how much each is missed where something
/// lies over it: the legend of the lines is only read, and folded now and then.
pub(super) fn clickable(context: &egui::Context) -> Vec<(Rect, f32)> {
    let legend = line_legend::layer();
    context.memory(|memory| {
        let layers = memory.areas().visible_layer_ids().into_iter();
        let layers =
            layers.filter(|layer| matches!(layer.order, Order::Middle | Order::Foreground));
        let place = |layer: egui::LayerId| {
            let missed = if layer == legend { LEGEND_MISSED } else { 1.0 };
            Some((memory.area_rect(layer.id)?, missed))
        };
        layers.filter_map(place).collect()
    })
}

/// The part of the free rectangle in which a card that wants to stand there hides nothing of what is taken already: right of
/// that, else below it.
fn room_beside(free: Rect, wanted: Rect, taken: Option<Rect>) -> Rect {
    let size = wanted.size();
    let last = (free.max - size).max(free.min);
    let stands = Rect::from_min_size(wanted.min.clamp(free.min, last), size);
    let Some(taken) = taken.filter(|taken| taken.intersects(stands)) else {
        return free;
    };
    let right = free.with_min_x(taken.max.x + GAP);
    let below = free.with_min_y(taken.max.y + GAP);
    if right.width() >= size.x {
        right
    } else if below.height() >= size.y {
        below
    } else {
        free
    }
}

/// What a person wants next.
enum Wish {
    Rays,
    Tree,
    Go(SceneId),
    Close,
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy_egui::egui::pos2;

    #[test]
    fn an_answer_hides_nothing_of_the_legend_where_there_is_room_beside_it() {
        let at = |x, y, width, height| Rect::from_min_size(pos2(x, y), vec2(width, height));
        let legend = at(230.0, 60.0, 240.0, 80.0);
        let card = vec2(300.0, 200.0);
        for (free, place) in [
            // Beside it in a wide view, below it in a narrow one.
            (at(220.0, 50.0, 1000.0, 700.0), pos2(476.0, 50.0)),
            (at(220.0, 50.0, 500.0, 500.0), pos2(220.0, 146.0)),
            // Nothing is to be had in one that is too small.
            (at(220.0, 50.0, 350.0, 220.0), pos2(220.0, 50.0)),
        ] {
            let wanted = Rect::from_min_size(pos2(300.0, 100.0), card);
            let room = room_beside(free, wanted, Some(legend));
            assert_eq!(room.min, place, "{free}");
            assert_eq!(room_beside(free, wanted, None), free);
        }
        // What stands elsewhere has all of it.
        let free = at(220.0, 50.0, 1000.0, 700.0);
        let far = Rect::from_min_size(pos2(800.0, 400.0), card);
        assert_eq!(room_beside(free, far, Some(legend)), free);
    }

    #[test]
    fn what_goes_with_the_pointer_lies_over_no_button_where_another_corner_is_free() {
        let free = Rect::from_min_size(pos2(200.0, 50.0), vec2(1000.0, 700.0));
        let (size, gaps) = (vec2(180.0, 120.0), [18.0, 14.0]);
        let stands = |at: Pos2, taken: &[(Rect, f32)]| {
            let (pivot, corner) = corner_free(free, at, gaps, size, taken);
            pivot.anchor_size(corner, size)
        };
        let at = pos2(500.0, 300.0);
        let usual = stands(at, &[]);
        assert_eq!(usual.min, at + vec2(18.0, 18.0), "right of it and below");
        let answer = Rect::from_min_size(at + vec2(40.0, 60.0), vec2(300.0, 90.0));
        let card = stands(at, &[(answer, 1.0)]);
        assert!(!card.intersects(answer) && !card.contains(at), "{card}");
        // Where there is something everywhere, over the least of it.
        let left = Rect::from_min_max(pos2(200.0, 50.0), at - vec2(20.0, 0.0));
        let below = Rect::from_min_max(pos2(200.0, 310.0), free.max);
        let above = Rect::from_min_max(pos2(510.0, 50.0), pos2(1200.0, 200.0));
        let everywhere = [left, below, above].map(|taken| (taken, 1.0));
        let card = stands(at, &everywhere);
        assert!(card.max.y < at.y && card.min.x > at.x, "{card}");
        // Rather over what is only read.
        let read = [(left, 1.0), (below, LEGEND_MISSED), (above, 1.0)];
        let card = stands(at, &read);
        assert_eq!(card.min, usual.min);
        // In a corner it stays in the view, and off the pointer.
        let card = stands(free.max - vec2(5.0, 5.0), &[]);
        assert!(free.contains_rect(card), "{card}");
    }
}
