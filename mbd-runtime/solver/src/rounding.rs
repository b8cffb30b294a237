//! What rounding of positions makes of forces: far from the origin the numbers next to each other are so far apart that a line's stretch, a stop's
//! depth or a joint's gap has no digits left.
//!
//! ```text
//! ε |p| K   against   m a,  a = max(|g|, |v̇|, V²/L)      what lines, springs and stops hold                     (1)
//! ε |p|         against   the longest arm of the joints                                                          (2)
//! ```
//!
//! ```text
//! |f(t + ε t) − f(t)|   against   |f(t)|                 what formulas of time make of accelerations and rates of states             (3)
//! ```
//!
//! ```text
//! h (|f(x + ε p) − f(x)| + ε |f|)   against   the tolerance of a step        what rounding makes of the error that a step tells   (4)
//! ```
//!
//! Where (4) counts steps shrink with the tolerance, not with its root, and nothing is gained: the error that they resolve is that of rounding.
//!
//! Time is kept in double precision, and rounded to the scalar where a formula reads it. Both sides of (3) are the largest so far.
//!
//! p is measured from where the state is measured from: where the origin follows something only what ends in the world, and what joints carry from
//! there, has the distance to it.
//! ε of the scalar, |p| the largest coordinate of a body, one that a joint of the tree carries included, ΣK of what holds it, m the largest mass that it is tied to, V and L the scales of the run: a
//! light point passes on the forces between heavy bodies, and it is these that must have digits. So a light body that hangs on a heavy one is
//! measured against the heavy one, too. Source: derived, from a stretch d − L0 whose d comes from positions rounded to ε |p|.

use mbd_scene::{Directions, Float, Joint, Layout, Part, Place, Scene};
use serde::{Deserialize, Serialize};

use crate::columns::part_name;
use crate::integrate::Scales;
use crate::moving::{Moving, Owners, moving};
use crate::options::Method;
use crate::stiffness::Stiffness;

/// Below this what is between two times that formulas tell apart is not looked at [s].
const CLOSE: f64 = 1e-6;
/// So many looks must agree before a run is refused by (3): where what follows time is near zero, one says too much.
const LOOKS: u32 = 10;

/// From this part of a on a run is refused, or ends: one digit is left.
pub(crate) const REFUSED: f64 = 0.1;

/// From this on (4) decides how long steps are: the controller leaves of the error of a step about a third, and rounding moves numbers by a third of their
/// distance.
const DECIDES: f64 = 0.4;
/// Below this part of the tolerance positions have digits enough: nothing is looked at.
pub(crate) const ENOUGH: f64 = 0.1;
/// What a tolerance must be above the distance of two positions, by the norm of errors, so that (4) decides nothing.
const ABOVE: f64 = 10.0;
/// So many lengths of the scene from the origin on an origin that goes along gains digits.
const FAR: f64 = 10.0;

/// Positions with fewer digits than the tolerance of a run asks for: steps shrink with the tolerance there, and the error that they resolve is that of
/// rounding.
#[derive(Clone, Debug, PartialEq)]
pub struct CoarsePositions {
    /// The body or the point, or the joint of a tree, by name.
    pub part: String,
    /// The body or the point that the origin could follow, where it follows none and that is far from it.
    pub to_follow: Option<String>,
    /// Its largest coordinate [m].
    pub distance: f64,
    /// How far apart positions there are that numbers tell apart [m].
    pub apart: f64,
    /// A relative tolerance that they have the digits for; `None` where it is looser than a run takes.
    pub tolerance: Option<f64>,
}

/// (4) so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct StepRounding {
    looks: u32,
    /// How many of them rounding decided.
    decided: u32,
    /// The look at which it decided most.
    most: CoarseLook,
}

/// A look at (4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct CoarseLook {
    /// (4).
    pub share: f64,
    /// Whose position it is, by its number among what moves.
    pub part: usize,
    /// Its largest coordinate [m].
    pub distance: f64,
    /// ε p by the norm of errors, without its tolerance.
    pub apart: f64,
}

impl StepRounding {
    /// Takes in a look; `None` where positions have digits enough.
    pub(crate) fn see(&mut self, look: Option<CoarseLook>) {
        self.looks = self.looks.saturating_add(1);
        let Some(look) = look.filter(|look| look.share > DECIDES) else {
            return;
        };
        self.decided = self.decided.saturating_add(1);
        if look.share > self.most.share {
            self.most = look;
        }
    }

    /// The worst look of a run whose steps rounding decided for the most part, and the tolerance that there are digits for.
    fn decides(&self) -> Option<(CoarseLook, f64)> {
        let decides = self.decided > self.looks / 2;
        decides.then_some((self.most, ABOVE * self.most.apart))
    }

    /// What to tell of it, of positions in `T`.
    pub(crate) fn told<T: Float>(
        &self,
        (scene, layout): (&Scene, &Layout),
        length: f64,
    ) -> Option<CoarsePositions> {
        let (look, tolerance) = self.decides()?;
        let part = moving(layout).nth(look.part)?;
        let body = part.body().and_then(|body| scene.bodies.get(body));
        let own = part_name(scene, part.part);
        let name = body.map_or(own, |body| &body.name);
        let is_far = scene.runs.origin.is_none() && look.distance > FAR * length;
        Some(CoarsePositions {
            part: own.to_owned(),
            to_follow: is_far.then(|| name.to_owned()),
            distance: look.distance,
            apart: T::EPSILON.to_f64() * look.distance,
            tolerance: (tolerance <= Method::LOOSEST).then_some(tolerance),
        })
    }
}

/// What is known of (1) and (2) before a run.
#[derive(Debug)]
pub(crate) struct Rounding {
    parts: Vec<HeldBody>,
    /// The least that an acceleration is measured against [m/s²].
    pub acceleration: f64,
    /// The longest arm of the joints [m]; `None` without rows.
    arm: Option<f64>,
    directions: Directions,
}

/// A body or a point with mass, and what holds it.
#[derive(Debug)]
struct HeldBody {
    moving: Moving,
    /// What lines and springs hold it with, over the largest mass that it is tied to [1/s²].
    rate: f64,
    /// The part of that which ends in the world [1/s²].
    to_world: f64,
    /// Whether rows of a joint hold it to the world.
    on_world: bool,
    /// Whether joints of the tree carry it from the world.
    from_world: bool,
}

/// The body or point whose forces rounding changes most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Affected {
    pub part: Part,
    /// Its largest coordinate [m].
    pub distance: f64,
    /// What rounding makes, as a part of what matters.
    pub share: f64,
}

/// (3) so far, for quantities of different units each by itself.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct TimeRounding {
    /// The largest change and the largest rate of each.
    most: Vec<[f64; 2]>,
    looks: u32,
}

impl TimeRounding {
    /// Copies another one into the room of this one.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.most.clone_from(&other.most);
        self.looks = other.looks;
    }

    /// How far apart times are that formulas tell apart [s]; `None` where that is close enough for whatever moves.
    pub(crate) fn coarseness<T: Float>(time: f64) -> Option<f64> {
        let apart = T::EPSILON.to_f64() * time.abs();
        (apart > CLOSE).then_some(apart)
    }

    /// Takes in the rates of every quantity at a time and at the next one.
    pub(crate) fn see<'a, T: Float>(&mut self, rates: impl Iterator<Item = [&'a [T]; 2]>) {
        for (index, [here, next]) in rates.enumerate() {
            let squares = here.iter().zip(next).map(|(here, next)| {
                let (rate, change) = (here.to_f64(), (*next - *here).to_f64());
                [change * change, rate * rate]
            });
            let sums = squares.fold([0.0; 2], |sum, new| [sum[0] + new[0], sum[1] + new[1]]);
            if self.most.len() <= index {
                self.most.push([0.0; 2]);
            }
            if let Some(most) = self.most.get_mut(index)
                && sums.iter().all(|sum| sum.is_finite())
            {
                *most = [0, 1].map(|at| most[at].max(sums[at].sqrt()));
            }
        }
        self.looks = self.looks.saturating_add(1);
    }

    /// What rounding of time makes, as a part of what there is.
    pub(crate) fn share(&self) -> f64 {
        let changed = self.most.iter().filter(|[change, _]| *change > 0.0);
        let shares = changed.map(|[change, rate]| change / rate.max(*change));
        shares.fold(0.0, f64::max)
    }

    /// Whether the run is refused for it: after enough looks, or at once.
    pub(crate) fn is_refused(&self, at_once: bool) -> bool {
        (at_once || self.looks >= LOOKS) && self.share() >= REFUSED
    }
}

impl Rounding {
    /// That of a model, whose joints reach `arm` far [m].
    pub(crate) fn new(
        (layout, joints): (&Layout, &[Joint]),
        stiffness: &Stiffness,
        scales: Scales,
        arm: Option<f64>,
    ) -> Self {
        let parts: Vec<Moving> = moving(layout).collect();
        let tied = stiffness.heaviest_tied(joints, &parts);
        let owners = Owners::of(layout);
        let mut on_world = vec![false; parts.len()];
        let tying = joints
            .iter()
            .filter_map(|joint| owners.at(tied_to_world(joint)?));
        tying.for_each(|at| on_world[at] = true);
        let parts = parts.into_iter().zip(on_world).zip(tied);
        let parts = parts.map(|((moving, on_world), mass)| {
            let stiffness = [
                stiffness.moving(&moving, false),
                stiffness.to_world(&moving),
            ];
            let [rate, to_world] = stiffness.map(|stiffness| match stiffness / mass {
                rate if rate.is_finite() => rate,
                _ => 0.0,
            });
            HeldBody {
                on_world,
                from_world: (moving.carried)
                    .and_then(|body| layout.root_link(body)?.joint)
                    .is_some(),
                moving,
                rate,
                to_world,
            }
        });
        let own = scales.speed * scales.speed / scales.length;
        Rounding {
            parts: parts.collect(),
            acceleration: own.max(stiffness.gravity()),
            arm,
            directions: layout.directions,
        }
    }

    /// The worst of (1) and (2) at a state with its rates, whose origin is that far from that of the world [m]. `bodies`:
    /// [`Quantity::Bodies`](mbd_scene::Quantity::Bodies), empty in absolute coordinates.
    pub(crate) fn worst<T: Float>(
        &self,
        state: &[T],
        rates: &[T],
        bodies: &[T],
        origin: f64,
    ) -> Option<Affected> {
        let precision = T::EPSILON.to_f64();
        let largest = |list: &[T], range: std::ops::Range<usize>| {
            let own = list.get(range).unwrap_or_default();
            own.iter()
                .fold(0.0, |most: f64, x| most.max(x.to_f64().abs()))
        };
        let affected = self.parts.iter().map(|held| {
            let part = &held.moving;
            let carried = part.carried.map_or(0..0, |body| {
                let first = self.directions.motion() * body;
                first..first + self.directions.translations().len()
            });
            let carried = match held.from_world {
                true => largest(bodies, carried) + origin,
                false => (largest(bodies, carried) - origin).max(0.0),
            };
            let distance = largest(state, part.position.clone()).max(carried);
            let acceleration = self.acceleration.max(largest(rates, part.velocity.clone()));
            let far = distance + origin;
            let own = distance * held.rate;
            let tied = if origin > 0.0 {
                far * held.to_world
            } else {
                0.0
            };
            let force = precision * own.max(tied) / acceleration;
            let off = if held.on_world { far } else { distance };
            let gap = self.arm.map_or(0.0, |arm| precision * off / arm);
            Affected {
                part: part.part,
                distance: if tied > own { far } else { off },
                share: force.max(gap),
            }
        });
        affected.max_by(|a, b| a.share.total_cmp(&b.share))
    }
}

/// What rows of a joint hold to the world.
fn tied_to_world(joint: &Joint) -> Option<Place> {
    let holds = joint.law.rows() > 0 && joint.law.couples().is_empty();
    match (joint.parent, joint.child) {
        (Place::World(_), other) | (other, Place::World(_)) if holds => Some(other),
        _ => None,
    }
}
