//! The command line `mbd`: runs, checks and converts scenes. Without arguments it flies the parachute, the main job of this project.

mod command;

use std::process::ExitCode;

fn main() -> ExitCode {
    command::main()
}
