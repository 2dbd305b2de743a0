//! Plays a script: a movement, a press or a release a frame, as the window would send them.

use super::super::action::Action;
use super::super::command;
use super::super::document::give_up_work;
use super::super::selection::Selection;
use super::super::viewport::traced_render;
use super::claims::check;
use super::keyboard::{parse, send_key, send_letter};
use super::mouse::{move_pointer, press, turn_wheel};
use super::screen::{Shot, shoot};
use super::spot::{Texts, named, place, read_texts};
use super::step::{Button, Spot, Step, Until};
use super::{Script, value};
use crate::io::check_film;
use crate::scene::SceneId;
use crate::view::largest_side;
use bevy::app::{App, AppExit, First, PostUpdate};
use bevy::ecs::entity::Entity;
use bevy::ecs::query::With;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::{Mut, World};
use bevy::input::ButtonState;
use bevy::input::keyboard::KeyCode;
use bevy::math::{UVec2, Vec2};
use bevy::prelude::IntoScheduleConfigs;
use bevy::window::{PrimaryWindow, Window, WindowResized};
use bevy_egui::EguiPostUpdateSet;
use std::collections::VecDeque;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Frames after which all that a movement or a press leads to has been drawn.
const SETTLE: u32 = 3;
/// Movements of a drag.
const DRAG_MOVES: u32 = 8;
/// How long samples and pictures are waited for.
const PATIENCE: Duration = Duration::from_secs(300);

/// Longer than anybody waits, and within what every clock can say.
const FOREVER: Duration = Duration::from_secs(u32::MAX as u64);

pub(super) fn add(app: &mut App, player: Player) {
    app.insert_resource(player)
        .init_resource::<Texts>()
        .init_resource::<Shot>()
        .add_systems(First, play.after(bevy::ecs::message::message_update_system))
        .add_systems(
            PostUpdate,
            read_texts
                .after(EguiPostUpdateSet::EndPass)
                .before(EguiPostUpdateSet::ProcessOutput),
        );
}

/// The script and how far it is.
#[derive(Resource)]
pub(super) struct Player {
    path: PathBuf,
    steps: VecDeque<(usize, Step)>,
    /// Of the step that is going on.
    line: usize,
    moves: VecDeque<Move>,
    shift: bool,
    at: Vec2,
    ended: bool,
}

/// What happens in one frame, or takes several.
enum Move {
    To(Vec2),
    Button(Button, ButtonState),
    PressAt(Button, Vec2),
    Key(KeyCode, ButtonState),
    Letter(char, ButtonState),
    Wheel(f32),
    Frames(u32),
    Until(Instant),
    Samples(f64, Instant),
    Shot(Instant),
}

impl Player {
    pub fn new(script: Script) -> Self {
        Self {
            path: script.path,
            steps: script.steps.into(),
            line: 0,
            // The window has to be there, and drawn.
            moves: [Move::Frames(2 * SETTLE)].into(),
            shift: false,
            at: Vec2::ZERO,
            ended: false,
        }
    }

    pub fn is_playing(&self) -> bool {
        !self.ended
    }

    fn click(&mut self, button: Button) {
        self.moves
            .push_back(Move::Button(button, ButtonState::Pressed));
        self.moves
            .push_back(Move::Button(button, ButtonState::Released));
    }

    fn settle(&mut self) {
        self.moves.push_back(Move::Frames(SETTLE));
    }

    fn drag(&mut self, button: Button, from: Vec2, to: Vec2) {
        self.moves.push_back(Move::To(from));
        self.settle();
        self.moves
            .push_back(Move::Button(button, ButtonState::Pressed));
        for i in 1..=DRAG_MOVES {
            let part = i as f32 / DRAG_MOVES as f32;
            self.moves.push_back(Move::To(from.lerp(to, part)));
        }
        self.settle();
        self.moves
            .push_back(Move::Button(button, ButtonState::Released));
        self.settle();
    }

    fn keys(&mut self, keys: &[KeyCode], state: ButtonState) {
        for key in keys {
            self.moves.push_back(Move::Key(*key, state));
        }
    }
}

fn play(world: &mut World) {
    world.resource_scope(|world, mut player: Mut<Player>| {
        if player.ended {
            return;
        }
        if let Err(text) = advance(world, &mut player) {
            let (path, line) = (player.path.display(), player.line);
            // Where standard error is closed the exit code still says it.
            let _ = writeln!(std::io::stderr(), "error: {path}:{line}: {text}");
            player.ended = true;
            // What a script did it can do again.
            give_up_work(world);
            world.write_message(AppExit::error());
        }
    });
}

/// Does what fits into this frame.
fn advance(world: &mut World, player: &mut Player) -> Result<(), String> {
    let mut windows = world.query_filtered::<Entity, With<PrimaryWindow>>();
    let Ok(window) = windows.single(world) else {
        return Ok(());
    };
    while player.moves.is_empty() {
        let Some((line, step)) = player.steps.pop_front() else {
            player.ended = true;
            return Ok(());
        };
        player.line = line;
        begin(world, player, step)?;
        if player.ended {
            return Ok(());
        }
    }
    let Some(next) = player.moves.pop_front() else {
        return Ok(());
    };
    if let Some(rest) = make(world, player, window, next)? {
        player.moves.push_front(rest);
    }
    Ok(())
}

/// A step becomes movements, or happens at once.
fn begin(world: &mut World, player: &mut Player, step: Step) -> Result<(), String> {
    match step {
        Step::Move(spot) => {
            let at = place(world, &spot)?;
            player.moves.push_back(Move::To(at));
            player.settle();
        }
        Step::Click(spot) => click(world, player, &spot, 1)?,
        Step::DoubleClick(spot) => click(world, player, &spot, 2)?,
        Step::Press(button) => {
            player
                .moves
                .push_back(Move::Button(button, ButtonState::Pressed));
        }
        Step::PressAt(button, spot) => {
            let at = place(world, &spot)?;
            player.moves.push_back(Move::PressAt(button, at));
            player.settle();
        }
        Step::Release(button) => {
            player
                .moves
                .push_back(Move::Button(button, ButtonState::Released));
            player.settle();
        }
        Step::Drag(from, to) => {
            let (from, to) = (place(world, &from)?, place(world, &to)?);
            player.drag(Button::Left, from, to);
        }
        Step::DragWith(button, from, to) => {
            let (from, to) = (place(world, &from)?, place(world, &to)?);
            player.drag(button, from, to);
        }
        Step::Wheel(notches) => {
            player.moves.push_back(Move::Wheel(notches));
            player.settle();
        }
        Step::Key(keys) => {
            let mut keys = parse(&keys)?;
            player.keys(&keys, ButtonState::Pressed);
            keys.reverse();
            player.keys(&keys, ButtonState::Released);
            player.settle();
        }
        Step::Hold(keys) => player.keys(&parse(&keys)?, ButtonState::Pressed),
        Step::LetGo(keys) => player.keys(&parse(&keys)?, ButtonState::Released),
        Step::Type(text) => {
            for letter in text.chars() {
                for state in [ButtonState::Pressed, ButtonState::Released] {
                    player.moves.push_back(Move::Letter(letter, state));
                }
            }
            player.settle();
        }
        Step::Run(id) => {
            let command =
                command::find(world, &id).ok_or_else(|| format!("there is no command {id:?}"))?;
            if let Some(why) = command.state_in(world).why_not {
                return Err(format!("{id:?} cannot be run: {why}"));
            }
            world.write_message(Action::Run(id.into()));
            player.settle();
        }
        Step::Action(action) => {
            world.write_message::<Action>(action);
            player.settle();
        }
        Step::Select(names) => {
            let ids = names.iter().map(|name| named(world, name));
            let ids = ids.collect::<Result<Vec<SceneId>, String>>()?;
            world.resource_mut::<Selection>().set(ids);
            player.settle();
        }
        Step::Set { of, path, to } => {
            value::write(world, of.as_deref(), &path, &to)?;
            player.settle();
        }
        Step::Size(width, height) => {
            check_window(world, &player.path, UVec2::new(width, height))?;
            let mut windows = world.query_filtered::<(Entity, &mut Window), With<PrimaryWindow>>();
            let (width, height) = (width as f32, height as f32);
            if let Ok((window, mut component)) = windows.single_mut(world) {
                component.resolution.set(width, height);
                // Cameras hear of it in the same frame, as where a person drags the border: else
                // they would draw into a window of another size.
                world.write_message(WindowResized {
                    window,
                    width,
                    height,
                });
            }
            player.settle();
        }
        Step::Wait(until) => wait(player, until),
        Step::Screenshot(path) => {
            shoot(world, Path::new(&path).to_path_buf());
            player.moves.push_back(Move::Shot(Instant::now()));
        }
        Step::Quit => {
            player.ended = true;
            give_up_work(world);
            world.write_message(AppExit::Success);
        }
        claim => check(world, claim)?,
    }
    Ok(())
}

/// Refuses a size that the window cannot have: the graphics driver would end the program.
fn check_window(world: &mut World, script: &Path, size: UVec2) -> Result<(), String> {
    let mut windows = world.query_filtered::<&Window, With<PrimaryWindow>>();
    let scale = windows.single(world).map_or(1.0, Window::scale_factor);
    let pixels = (size.as_vec2() * scale).as_uvec2();
    let most = largest_side(world).unwrap_or(u32::MAX);
    if pixels.max_element() > most {
        let UVec2 { x, y } = size;
        return Err(format!(
            "Size({x}, {y}): {most} pixels on a side is the most that can be drawn here"
        ));
    }
    check_film(world, script, pixels).map_err(|error| error.problem.to_string())
}

fn click(world: &mut World, player: &mut Player, spot: &Spot, times: u32) -> Result<(), String> {
    let at = place(world, spot)?;
    player.moves.push_back(Move::To(at));
    player.settle();
    for _ in 0..times {
        player.click(Button::Left);
    }
    player.settle();
    Ok(())
}

fn wait(player: &mut Player, until: Until) {
    let now = Instant::now();
    match until {
        Until::Frames(frames) => player.moves.push_back(Move::Frames(frames)),
        Until::Seconds(seconds) => {
            let seconds = Duration::try_from_secs_f32(seconds).unwrap_or_default();
            // What is longer than the clock can say is as long as it can be waited for.
            let until = now.checked_add(seconds).unwrap_or(now + FOREVER);
            player.moves.push_back(Move::Until(until));
        }
        Until::Samples(samples) => {
            // What was changed before has to have started a render.
            player.settle();
            player
                .moves
                .push_back(Move::Samples(samples, now + PATIENCE));
        }
    }
}

/// Does one thing; what is left of it comes back.
fn make(
    world: &mut World,
    player: &mut Player,
    window: Entity,
    next: Move,
) -> Result<Option<Move>, String> {
    match next {
        Move::To(at) => {
            move_pointer(world, window, player.at, at);
            player.at = at;
        }
        Move::Button(button, state) => press(world, window, button, state),
        Move::PressAt(button, at) => {
            move_pointer(world, window, player.at, at);
            player.at = at;
            press(world, window, button, ButtonState::Pressed);
        }
        Move::Key(key, state) => {
            if key == KeyCode::ShiftLeft {
                player.shift = state == ButtonState::Pressed;
            }
            send_key(world, window, key, state, player.shift);
        }
        Move::Letter(letter, state) => send_letter(world, window, letter, state),
        Move::Wheel(notches) => turn_wheel(world, window, notches),
        Move::Frames(frames) => {
            return Ok((frames > 1).then(|| Move::Frames(frames - 1)));
        }
        Move::Until(when) => {
            return Ok((Instant::now() < when).then_some(Move::Until(when)));
        }
        Move::Samples(wanted, patience) => {
            let now = samples(world);
            if now.is_none_or(|now| now < wanted) {
                if Instant::now() > patience {
                    return Err(format!(
                        "waited for {wanted} samples, and there are {now:?}"
                    ));
                }
                return Ok(Some(Move::Samples(wanted, patience)));
            }
            // They have to be developed and drawn too.
            return Ok(Some(Move::Until(
                Instant::now() + Duration::from_millis(600),
            )));
        }
        Move::Shot(since) => match world.resource_mut::<Shot>().take() {
            Some(shot) => shot?,
            None if since.elapsed() > PATIENCE => return Err("there was no picture".into()),
            None => return Ok(Some(Move::Shot(since))),
        },
    }
    Ok(None)
}

/// Of each pixel of the traced view; all that are wanted where it has ended.
fn samples(world: &World) -> Option<f64> {
    let status = traced_render(world)?.status()?;
    Some(match status.state {
        crate::film::State::Ended(_) => f64::INFINITY,
        _ => status.samples,
    })
}
