//! An origin that follows a body: positions far from the world's origin keep the digits of what lies between them.

mod coordinates;
mod digits;
mod outside;
mod tied;
