//! The compiler of `mbd`: a declaration becomes a scene, its laws become equations, the equations a program, the program Rust.

mod attitude;
mod check;
mod compile;
mod describe;
mod differentiate;
mod directional;
mod emit;
mod equations;
mod expression;
mod families;
#[cfg(feature = "format")]
mod format;
mod hash;
mod interpret;
mod kernels;
mod lexeme;
mod lists;
mod messages;
mod names;
mod number;
mod operation;
mod partition;
mod phases;
mod plane;
mod program;
mod reading;
mod resolve;
mod selection;
mod simplify;
mod solution;
mod strided;
mod syntax;
mod titles;
#[cfg(feature = "toml")]
mod toml;
mod units;
mod urdf;
mod vocabulary;

pub use check::without_inertia;
#[cfg(feature = "pretty")]
pub use compile::expand;
pub use compile::{compile, emit, immovable};
pub use describe::metric_text;
pub use directional::MatrixColumns;
pub use emit::{EmitSettings, NameSpans, emit_model};
pub use equations::{SceneEquations, is_matrix, lay_out, lay_out_factor};
pub use expression::{Expr, Graph, Label, Mask, Slot, Term, TermKind, recorded, session};
pub use families::Families;
#[cfg(feature = "format")]
pub use format::{FormattedRust, format_rust, format_text};
pub use interpret::{Interpreted, Registers};
pub use kernels::{Kernel, KernelDriver, Kernels, ResultPlaces, Window};
pub use lists::{NumberList, ProgramArguments};
pub use messages::similar::nearest;
pub use messages::{About, Location, Message, MessagePlace};
pub use number::{read_number, read_vector};
pub use operation::{Binary, Comparison, Op, Unary};
pub use partition::{Local, ProgramBlock, partition};
pub use phases::misfits;
pub use plane::plane_of_motion;
pub use program::{Instruction, Operand, Program, Register};
pub use reading::{
    DeclarationOptions, NamedFile, NextScene, Reading, Spans, read_text, read_text_in, read_tokens,
};
pub use resolve::{Emitted, Named, mixes_turns};
pub use solution::{Solution, SolutionMember};
pub use strided::{RoundItem, StridedRun};
pub use syntax::quantities;
pub use syntax::words::ABOUT;
#[cfg(feature = "toml")]
pub use toml::{read_toml, read_toml_in, text_to_toml, toml_to_text, write_text, write_toml};
pub use urdf::read_urdf;
pub use vocabulary::Vocabulary;
