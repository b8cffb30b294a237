//! Every joint of the list: what it forbids, what it allows, and what it carries.

mod carried;
mod contract;
mod coordinates;
mod equivalents;
mod orders;
mod reference;
mod split;
mod trees;
