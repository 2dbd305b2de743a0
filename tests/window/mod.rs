//! The editor in a window, on a display that is started for it: by scripts, and once with the
//! clicks and keys of another program.
//!
//! Needs Xvfb and a Vulkan driver (Debian: xvfb, mesa-vulkan-drivers), and xdotool for one test.
//! Where they are missing a test says so and passes, unless `GLASSBOX_NEEDS_WINDOW=1` is set.

mod clicks;
#[cfg(all(unix, not(target_os = "macos")))]
mod examples;
mod gizmos;
mod handling;
mod marks;
mod pictures;
mod rays;
mod scripts;
mod startup;
mod story;
mod two_trees;

use crate::cli::{PROGRAM, without_display};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// How long a run may take: software drivers draw a few frames a second.
const PATIENCE: Duration = Duration::from_secs(600);

/// One window at a time: several would take each other's time.
static ONE: Mutex<()> = Mutex::new(());

/// A display of the size of one window.
pub(crate) struct Display {
    server: Child,
    name: String,
    _one: MutexGuard<'static, ()>,
}

impl Display {
    /// `None`, said loudly, where there can be none.
    pub fn open() -> Option<Self> {
        Self::sized("1280x720x24")
    }

    fn sized(screen: &str) -> Option<Self> {
        let one = ONE.lock().unwrap_or_else(PoisonError::into_inner);
        let server = Command::new("Xvfb")
            .args([
                "-displayfd",
                "1",
                "-screen",
                "0",
                screen,
                "-nolisten",
                "tcp",
                // It would begin anew when its last client goes: the program asks whether there is a display before it opens it.
                "-noreset",
            ])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let Ok(mut server) = server else {
            missing("Xvfb is missing (Debian: xvfb)");
            return None;
        };
        let mut line = String::new();
        let said = server
            .stdout
            .take()
            .expect("it was asked to say its number");
        BufReader::new(said).read_line(&mut line).unwrap();
        let display = Self {
            server,
            name: format!(":{}", line.trim()),
            _one: one,
        };
        assert!(!line.trim().is_empty(), "Xvfb gave no display");
        // Asked once: all displays have the same drivers.
        static DRAWS: OnceLock<bool> = OnceLock::new();
        let draws = DRAWS.get_or_init(|| display.draws());
        draws.then_some(display)
    }

    /// Whether there is an adapter to draw with.
    fn draws(&self) -> bool {
        let folder = tempfile::tempdir().unwrap();
        // A few frames: ended in its first, the software driver may still be compiling, and crash.
        let output = self.play(folder.path(), &[], "[Wait(Frames(5)), Quit]");
        let (_, err) = crate::cli::texts(&output);
        if err.contains("no graphics adapter") {
            missing("there is no graphics adapter (Debian: mesa-vulkan-drivers)");
            return false;
        }
        assert_eq!(output.status.code(), Some(0), "an empty script: {err}");
        true
    }

    /// The program on this display, with settings of its own.
    pub fn command(&self, folder: &Path) -> Command {
        self.command_in(folder, &[])
    }

    /// The same, started by another program, which gets its arguments.
    pub fn command_in(&self, folder: &Path, by: &[&str]) -> Command {
        let words = [by, &[PROGRAM]].concat();
        let mut command = without_display(words[0], folder);
        command.args(&words[1..]);
        self.show(command)
    }

    /// What a program is told of it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Any program on this display.
    pub fn show(&self, mut command: Command) -> Command {
        command
            .env("DISPLAY", &self.name)
            .env_remove("WAYLAND_DISPLAY");
        command
    }

    /// Runs a script with these arguments before it, in a folder.
    pub fn play(&self, folder: &Path, arguments: &[&str], script: &str) -> Output {
        let file = folder.join("script.ron");
        std::fs::write(&file, script).unwrap();
        let mut command = self.command(folder);
        command.args(arguments).arg("--script").arg(&file);
        finish(command)
    }

    /// Runs a script and expects it to succeed.
    pub fn plays(&self, folder: &Path, arguments: &[&str], script: &str) {
        let output = self.play(folder, arguments, script);
        let (out, err) = crate::cli::texts(&output);
        assert_eq!(
            output.status.code(),
            Some(0),
            "{script}\nstdout: {out}\nstderr: {err}"
        );
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// Waits for a program, but not for ever.
pub(crate) fn finish(mut command: Command) -> Output {
    let child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program did not start");
    let id = child.id();
    let (done, finished) = std::sync::mpsc::channel();
    let waiting = std::thread::spawn(move || {
        let output = child.wait_with_output();
        let _ = done.send(());
        output
    });
    if finished.recv_timeout(PATIENCE).is_err() {
        let _ = Command::new("kill").arg(id.to_string()).status();
    }
    waiting.join().unwrap().expect("the program was lost")
}

/// Waits until something is so.
fn until(what: &str, mut is_so: impl FnMut() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < PATIENCE, "{what} did not happen");
        std::thread::sleep(Duration::from_millis(100));
    }
}

/// Says what is missing, so that nobody takes a skipped test for a passed one.
pub(crate) fn missing(what: &str) {
    let needed = std::env::var("GLASSBOX_NEEDS_WINDOW").is_ok_and(|value| value == "1");
    assert!(!needed, "GLASSBOX_NEEDS_WINDOW=1, and {what}");
    eprintln!("NOT TESTED: {what}");
}

/// The scripts that come with Glassbox.
fn assets() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scripts")
}
