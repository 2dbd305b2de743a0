//! Whether there can be a window at all: asked before Bevy asks, which would panic.

use std::fmt;

/// Why there can be no window.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NoWindow {
    /// No display, or one that does not answer.
    Display(String),
    /// The display's libraries are missing.
    Library(String),
    /// Nothing that can draw.
    Adapter,
}

impl fmt::Display for NoWindow {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Display(why) => write!(f, "no window: {why}"),
            Self::Library(library) => write!(
                f,
                "no window: {library} is missing; on Debian install libx11-6 libx11-xcb1 \
                 libxcursor1 libxi6 libxrandr2 libxkbcommon-x11-0"
            ),
            Self::Adapter => write!(
                f,
                "no graphics adapter was found: install a Vulkan driver (Debian: \
                 mesa-vulkan-drivers), or use `glassbox render`, which needs none"
            ),
        }
    }
}

impl std::error::Error for NoWindow {}

/// Asks the display and the graphics drivers.
pub fn check() -> Result<(), NoWindow> {
    check_display()?;
    check_adapter()
}

#[cfg(all(unix, not(target_os = "macos")))]
fn check_display() -> Result<(), NoWindow> {
    let given = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    if cfg!(feature = "wayland") && given("WAYLAND_DISPLAY") {
        // The compositor is asked by winit; the socket's name alone says nothing.
        return Ok(());
    }
    if !given("DISPLAY") {
        let why = if given("WAYLAND_DISPLAY") {
            "this build draws with X11 only and DISPLAY is not set; build with --features wayland, \
             or start XWayland"
        } else {
            "DISPLAY is not set"
        };
        return Err(NoWindow::Display(why.to_owned()));
    }
    check_libraries()?;
    // The libraries' own error handling ends the program; this connection only says how it went.
    x11rb::rust_connection::RustConnection::connect(None)
        .map(|_| ())
        .map_err(|error| {
            let display = std::env::var_os("DISPLAY").unwrap_or_default();
            NoWindow::Display(format!(
                "the display {} does not answer ({error})",
                display.to_string_lossy()
            ))
        })
}

#[cfg(all(unix, not(target_os = "macos")))]
fn check_libraries() -> Result<(), NoWindow> {
    let opened = [
        ("libX11", x11_dl::xlib::Xlib::open().is_ok()),
        ("libXcursor", x11_dl::xcursor::Xcursor::open().is_ok()),
        ("libX11-xcb", x11_dl::xlib_xcb::Xlib_xcb::open().is_ok()),
        ("libXi", x11_dl::xinput2::XInput2::open().is_ok()),
    ];
    match opened.iter().find(|(_, there)| !there) {
        Some((library, _)) => Err(NoWindow::Library((*library).to_owned())),
        None => Ok(()),
    }
}

#[cfg(not(all(unix, not(target_os = "macos"))))]
fn check_display() -> Result<(), NoWindow> {
    Ok(())
}

/// Whether there is an adapter of the kinds that Bevy would use.
fn check_adapter() -> Result<(), NoWindow> {
    let backends = wgpu::Backends::from_env().unwrap_or(wgpu::Backends::all());
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let asked = instance.request_adapter(&wgpu::RequestAdapterOptions::default());
    match bevy::tasks::block_on(asked) {
        Ok(_) => Ok(()),
        Err(_) => Err(NoWindow::Adapter),
    }
}
