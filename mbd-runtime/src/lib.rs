//! Multibody dynamics compiled from a declaration: the runtime that users depend on.
//!
//! | to … | use |
//! |---|---|
//! | declare a scene and compile its equations | [`model!`] |
//! | run the same scene without compilation, by its laws | [`Generic`] on a [`scene::Scene`] |
//! | integrate a model | [`Simulation`] with [`Options`] |
//! | drive it: inputs held, as functions of time and state, by controllers at samples | [`Simulation::set_inputs`], [`Simulation::control`], [`Simulation::control_every`] |
//! | record named columns with units | [`Trajectory`] with [`Sampling`] and [`Content`] |
//! | run many cases with other params, inputs and starts on several threads | [`Batch`] of [`Case`]s |
//! | run several cases beside each other in one register | [`Lanes4`], [`Lanes8`] as the scalar of a generated model, [`LockStep`] |
//! | stop a run and continue it to the bit | [`Snapshot`] |
//! | read what events did, and let another model go on | [`Acted`], [`Handover`] |
//! | linearise at a state: A, B, C, D in minimal coordinates, eigenvalues | [`linearise`], [`StateSpace`]; in all of x and by parameters: [`Linearisation`] |
//! | find a state and inputs at which nothing accelerates | [`trim`](crate::trim()) |
//! | find the efforts that give accelerations | [`inverse_dynamics`] |
//! | ask any model for one quantity | [`Model::evaluate`] with [`Quantity`] and [`At`] |
//! | read what went wrong, in the names of the declaration | [`RunError`], [`StepError`] |
//! | read what a run cost | [`Statistics`]; `explain()` and `COST` of a model say what its equations cost |

#[cfg(doctest)]
#[doc = include_str!("../../docs/events.md")]
struct ThePageAboutEvents;

#[cfg(doctest)]
#[doc = include_str!("../../docs/campaigns.md")]
struct ThePageAboutCampaigns;

#[cfg(doctest)]
#[doc = include_str!("../../docs/control.md")]
struct ThePageAboutDriving;

pub use mbd_macros::model;
#[doc(inline)]
pub use mbd_solver::*;
