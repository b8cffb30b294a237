//! The command line `mbd`: runs, checks and converts scenes. Without arguments it flies the parachute, the main job of this project.

use std::process::ExitCode;

fn main() -> ExitCode {
    mbd_command::main()
}
