//! Tells the program which compiler built it: the report prints that.

use std::process::Command;

fn main() {
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    let output = Command::new(rustc).arg("--version").output();
    let version = output
        .ok()
        .and_then(|output| String::from_utf8(output.stdout).ok());
    let version = version.unwrap_or_else(|| "an unknown rustc".to_owned());
    println!("cargo:rustc-env=GLASSBOX_COMPILER={}", version.trim());
    println!("cargo:rerun-if-changed=build.rs");
}
