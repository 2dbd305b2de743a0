//! Being asked to end from outside: by `kill`, by the end of the session, by the terminal that is closed. The program
//! ends as by Ctrl+C, which Bevy catches itself, so that unsaved work is kept.

use bevy::app::{App, AppExit, Plugin, Update};
use bevy::ecs::message::MessageWriter;
use signal_hook::consts::{SIGHUP, SIGTERM};
use signal_hook::flag;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Makes SIGTERM and SIGHUP an [`AppExit`], for the program and not for an app that has the editor in it. A second one
/// ends the process at once.
pub(super) struct SignalsPlugin;

impl Plugin for SignalsPlugin {
    fn build(&self, app: &mut App) {
        let caught = Arc::new(AtomicUsize::new(0));
        for signal in [SIGTERM, SIGHUP] {
            // Who started it with `nohup` wants it to go on.
            if signal == SIGHUP && is_ignored(signal) {
                continue;
            }
            if let Err(error) = catch(signal, &caught) {
                bevy::log::warn!("signal {signal} ends the program without keeping work: {error}");
            }
        }
        app.add_systems(Update, move |mut exits: MessageWriter<AppExit>| {
            let signal = caught.load(Ordering::Relaxed);
            if let Ok(signal @ 1..) = u8::try_from(signal) {
                exits.write(AppExit::from_code(exit_code(signal)));
            }
        });
    }
}

/// What a shell tells of a program that a signal ended.
fn exit_code(signal: u8) -> u8 {
    128_u8.saturating_add(signal)
}

fn catch(signal: i32, caught: &Arc<AtomicUsize>) -> io::Result<()> {
    let again = Arc::new(AtomicBool::new(false));
    // In the order in which they are called: it is the second that finds the flag set.
    let code = u8::try_from(signal).map_or(1, exit_code);
    flag::register_conditional_shutdown(signal, i32::from(code), Arc::clone(&again))?;
    flag::register(signal, again)?;
    let number = usize::try_from(signal).unwrap_or_default();
    flag::register_usize(signal, Arc::clone(caught), number)?;
    Ok(())
}

/// Whether the process was started with this signal ignored; false where the system does not tell.
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    // "SigIgn:	0000000000000001": a bit for each signal, counted from 1.
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|bits| u64::from_str_radix(bits.trim(), 16).ok());
    ignored.is_some_and(|bits| bits >> (signal - 1) & 1 == 1)
}
