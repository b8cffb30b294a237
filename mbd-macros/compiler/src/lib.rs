//! The compiler of `mbd`: a declaration becomes a scene, its laws become equations, the equations a program, the program Rust.

mod describe;
mod differentiate;
mod emit;
mod equations;
mod expression;
mod interpret;
mod names;
mod operation;
mod outline;
mod program;

pub use emit::{NameSpans, Settings, emit};
pub use equations::{Equations, is_matrix};
pub use expression::{Expr, Graph, Mask, Node, Slot, Term, recorded, session};
pub use interpret::{Interpreted, Registers};
pub use operation::{Binary, Comparison, Op, Unary};
pub use outline::{Outline, Piece, outline};
pub use program::{Instruction, Operand, Program, Register};
