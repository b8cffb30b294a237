//! Joints. What every one promises by itself is in `tests/laws`.

mod counts;
mod couplings;
mod derivatives;
mod fallback;
mod flat;
mod interface;
mod loads;
mod masses;
mod mechanisms;
mod redundant;
mod run;
mod shafts;
mod singular;
mod told;
mod transmitted;
mod turns;
mod unique_reactions;
