//! The compiler of `mbd`: a declaration becomes a scene, its laws become equations, the equations a program, the program Rust.

mod differentiate;
mod equations;
mod expression;
mod interpret;
mod names;
mod operation;
mod program;

pub use equations::{Equations, is_matrix};
pub use expression::{Expr, Graph, Mask, Node, Slot, Term, recorded, session};
pub use interpret::{Interpreted, Registers};
pub use operation::{Binary, Comparison, Op, Unary};
pub use program::{Instruction, Operand, Program, Register};
