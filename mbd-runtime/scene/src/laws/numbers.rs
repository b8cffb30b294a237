//! The constants of a scene as numbers of one scalar: what stays the same while the state changes.

use std::cell::OnceCell;

use nalgebra::{Matrix3, Vector3};

use crate::laws::coupling::Coupling;
use crate::laws::formula::{Context, Value, of_let, scalar, triple};
use crate::scalar::algebra::{inverse, symmetric};
use crate::{Formula, Frame, Gravity, JointForces, Place, Plane, PointKind, Real, Scene, Triple};

/// The constants of a body.
#[derive(Clone, Debug)]
pub struct BodyNumbers<S> {
    /// Mass [kg].
    pub mass: S,
    /// 1 / mass [1/kg].
    pub inverse_mass: S,
    /// Inertia about the centre of mass, body axes [kg m²].
    pub inertia: Matrix3<S>,
    /// Its inverse [1/(kg m²)]; in a planar scene that of the element about the normal, the rest is zero.
    pub inverse_inertia: Matrix3<S>,
    /// Its frames.
    pub frames: Vec<FrameNumbers<S>>,
}

/// The constants of a frame.
#[derive(Clone, Debug)]
pub struct FrameNumbers<S> {
    /// Origin from the centre of mass, body axes (from the world origin, world axes) [m].
    pub position: Vector3<S>,
    /// Rotation, frame axes to body axes; `None`: parallel.
    pub rotation: Option<Matrix3<S>>,
}

impl<S: Real> FrameNumbers<S> {
    fn unknown() -> Self {
        FrameNumbers {
            position: Vector3::repeat(S::from_f64(f64::NAN)),
            rotation: None,
        }
    }
}

/// The constants of a line, or of a stop, which has no free length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LineNumbers<S> {
    /// Stiffness K [N/m]: the slope of the elastic force at zero stretch.
    pub stiffness: S,
    /// Damping C [N s/m].
    pub damping: S,
    /// Free length L0 [m].
    pub free_length: S,
}

/// The constants of gravity.
#[derive(Clone, Debug)]
pub enum GravityNumbers<S> {
    /// No gravity.
    None,
    /// Acceleration [m/s²].
    Uniform(Vector3<S>),
    /// A point mass, or an oblate planet.
    Central {
        /// Gravitational parameter [m³/s²].
        mu: S,
        /// Centre in world coordinates [m].
        center: Vector3<S>,
        /// Whether the potential is zero far away, and not at the world origin: where the centre is near that, beside what moves about it.
        from_far: bool,
        /// The J2 term, if declared.
        oblate: Option<OblateNumbers<S>>,
    },
    /// From the caller.
    Field,
}

/// The constants of the J2 term.
#[derive(Clone, Debug)]
pub struct OblateNumbers<S> {
    /// Equatorial radius [m].
    pub radius: S,
    /// J2 [1].
    pub j2: S,
    /// Unit vector along the axis, world components.
    pub axis: Vector3<S>,
}

/// The constants of [`JointForces`]; `None`: absent, or zero by declaration.
#[derive(Clone, Debug, PartialEq)]
pub struct JointForceNumbers<S> {
    /// Stiffness K [N/m or N m/rad].
    pub stiffness: Option<S>,
    /// Rest x0 [m or rad].
    pub rest: Option<S>,
    /// Damping C [N s/m or N m s/rad].
    pub damping: Option<S>,
    /// Friction F [N or N m] and the rate w over which it turns [m/s or rad/s].
    pub friction: Option<[S; 2]>,
    /// The low and the high stop [m or rad].
    pub stops: [Option<S>; 2],
}

impl<S: Real> JointForceNumbers<S> {
    /// The constants of one entry, evaluated by `of`.
    pub fn new(scene: &Scene, forces: &JointForces, of: impl Fn(&Formula) -> S) -> Self {
        let given = |formula: &Option<Formula>| {
            let formula = formula.as_ref().filter(|formula| !scene.is_zero(formula));
            formula.map(&of)
        };
        JointForceNumbers {
            stiffness: given(&forces.stiffness),
            rest: given(&forces.rest),
            damping: given(&forces.damping),
            friction: given(&forces.friction)
                .map(|level| [level, given(&forces.friction_rate).unwrap_or_else(S::zero)]),
            stops: forces.stops.each_ref().map(|stop| stop.as_ref().map(&of)),
        }
    }
}

/// Every constant of a scene, evaluated for given parameters.
#[derive(Clone, Debug)]
pub struct Numbers<S> {
    /// The live parameters, in declaration order [SI].
    pub params: Vec<S>,
    /// Per body.
    pub bodies: Vec<BodyNumbers<S>>,
    /// Mass and its inverse of each point; zero for a node [kg, 1/kg].
    pub points: Vec<(S, S)>,
    /// Per line, then per stop; the free length of a line that is wound as it is at the declared start.
    pub lines: Vec<LineNumbers<S>>,
    /// The world frames that stay where they are; NaN for one that moves.
    pub world_frames: Vec<FrameNumbers<S>>,
    /// Gravity.
    pub gravity: GravityNumbers<S>,
    /// The numbers of each joint, in the order of [`JointDefinition::numbers`](crate::joints::JointDefinition::numbers).
    pub joints: Vec<Vec<S>>,
    /// Per joint, the relation of the coordinates that it couples, if it couples any.
    pub couplings: Vec<Option<Coupling<S>>>,
    /// Per joint, what acts along its coordinates, in the order of [`Joint::along`](crate::Joint::along).
    pub forces: Vec<Vec<JointForceNumbers<S>>>,
}

/// The only things a constant may depend on.
struct Constants<'a, S> {
    scene: &'a Scene,
    params: &'a [S],
    lets: Vec<OnceCell<Value<S>>>,
}

impl<'a, S: Real> Constants<'a, S> {
    fn new(scene: &'a Scene, params: &'a [S]) -> Self {
        Constants {
            scene,
            params,
            lets: vec![OnceCell::new(); scene.lets.len()],
        }
    }
}

impl<S: Real> Context<S> for Constants<'_, S> {
    fn scene(&self) -> &Scene {
        self.scene
    }

    fn param(&self, index: usize) -> Option<S> {
        self.params.get(index).copied()
    }

    fn named(&self, index: usize) -> Option<Value<S>> {
        let kept = self.lets.get(index)?;
        if let Some(value) = kept.get() {
            return Some(*value);
        }
        let value = of_let(index, self)?;
        Some(*kept.get_or_init(|| value))
    }
}

/// What inputs, states and time are worth at a declared start: defaults, starts, and zero.
struct AtStart<'c, 'a, S>(&'c Constants<'a, S>);

impl<S: Real> Context<S> for AtStart<'_, '_, S> {
    fn scene(&self) -> &Scene {
        self.0.scene
    }

    fn param(&self, index: usize) -> Option<S> {
        self.0.param(index)
    }

    fn named(&self, index: usize) -> Option<Value<S>> {
        of_let(index, self)
    }

    fn input(&self, index: usize) -> Option<Value<S>> {
        let input = self.0.scene.inputs.get(index)?;
        let [x, y, z] = input.default.map(S::from_f64);
        Some(match input.components {
            1 => Value::Scalar(x),
            _ => Value::Vector(Vector3::new(x, y, z)),
        })
    }

    fn state(&self, index: usize) -> Option<S> {
        let state = self.0.scene.states.get(index)?;
        Some(scalar(&state.start, self))
    }

    fn time(&self) -> Option<S> {
        Some(S::zero())
    }
}

/// The value of a scalar formula that depends on params alone.
pub fn constant<S: Real>(scene: &Scene, params: &[S], formula: &Formula) -> S {
    scalar(formula, &Constants::new(scene, params))
}

/// The value of a scalar formula of params, inputs, states and time at a declared start.
pub fn start_of<S: Real>(scene: &Scene, params: &[S], formula: &Formula) -> S {
    scalar(formula, &AtStart(&Constants::new(scene, params)))
}

/// Whether the world origin is no place to measure the potential of a centre of gravity from: it is the centre, or nearer to it than half of what a
/// body or a point that the scene puts somewhere is, by the defaults of the params. There 1/|c| would be far more than anything that moves.
fn is_near_origin(scene: &Scene, center: &Triple) -> bool {
    if center.iter().all(|c| scene.is_zero(c)) {
        return true;
    }
    let params: Vec<f64> = scene.params.iter().map(|param| param.default).collect();
    let constants = Constants::new(scene, &params);
    let vector = |of: &Triple| Vector3::from(of.each_ref().map(|x| scalar(x, &constants)));
    let center: Vector3<f64> = vector(center);
    let parts = scene.starts.parts.iter();
    let mut places = parts.filter_map(|start| start.position.as_ref().map(&vector));
    places.any(|place| (place - center).norm() > 2.0 * center.norm())
}

/// Where the declared states start [SI], for `params` in declaration order.
pub fn starts<S: Real>(scene: &Scene, params: &[S]) -> Vec<S> {
    let states = scene.states.iter();
    states
        .map(|state| start_of(scene, params, &state.start))
        .collect()
}

/// The inverse of the element of an inertia about the normal of a plane.
fn along_normal<S: Real>(inertia: &Matrix3<S>, plane: Plane) -> Matrix3<S> {
    let normal = (plane.normal(), plane.normal());
    let mut inverse = Matrix3::zeros();
    inverse[normal] = S::one() / inertia[normal];
    inverse
}

impl Numbers<f64> {
    /// The largest distance of a joint's frame from the centre of mass of its body [m]; zero where no joint has an arm.
    #[must_use]
    pub fn longest_arm(&self, scene: &Scene) -> f64 {
        let ends = scene.joints.iter();
        let ends = ends.flat_map(|joint| [joint.parent, joint.child]);
        let frames = ends.filter_map(|place| match place {
            Place::Body(body, frame) => self.bodies.get(body)?.frames.get(frame),
            Place::World(_) | Place::Point(_) => None,
        });
        let arms = frames.map(|frame| frame.position.norm());
        arms.fold(0.0, f64::max)
    }
}

impl<S: Real> Numbers<S> {
    /// Evaluates the constants of `scene` for `params` (SI, declaration order).
    #[must_use]
    pub fn new(scene: &Scene, params: &[S]) -> Self {
        let constants = Constants::new(scene, params);
        let of = |formula: &Formula| scalar(formula, &constants);
        let frames = |frames: &[Frame]| {
            frames
                .iter()
                .map(|frame| match frame.moves(scene) {
                    true => FrameNumbers::unknown(),
                    false => FrameNumbers {
                        position: triple(&frame.position, &constants),
                        rotation: frame.rotation.as_ref().map(|rows| {
                            let rows = rows
                                .each_ref()
                                .map(|row| triple(row, &constants).transpose());
                            Matrix3::from_rows(&rows)
                        }),
                    },
                })
                .collect::<Vec<_>>()
        };
        let bodies = scene.bodies.iter().map(|body| {
            S::section(&body.name);
            let i = &body.inertia;
            let inertia = symmetric([
                of(&i.xx),
                of(&i.xy),
                of(&i.xz),
                of(&i.yy),
                of(&i.yz),
                of(&i.zz),
            ]);
            let mass = of(&body.mass);
            BodyNumbers {
                mass,
                inverse_mass: (S::one() / mass).label("inverse_mass"),
                inertia,
                inverse_inertia: match scene.planar {
                    None => inverse(&inertia),
                    Some(plane) => along_normal(&inertia, plane),
                },
                frames: frames(&body.frames),
            }
        });
        let points = scene.points.iter().map(|point| match &point.kind {
            PointKind::Mass(mass) => {
                S::section(&point.name);
                let mass = of(mass);
                (mass, (S::one() / mass).label("inverse_mass"))
            }
            PointKind::Node(_) => (S::zero(), S::zero()),
        });
        let lines = scene.lines.iter().map(|line| LineNumbers {
            stiffness: line.kind.stiffness(&scene.tables, of(&line.stiffness)),
            damping: of(&line.damping),
            free_length: match line.is_wound(scene) {
                true => scalar(line.free_length_and_rate().0, &AtStart(&constants)),
                false => of(&line.free_length),
            },
        });
        let given = |formula: &Option<Formula>| formula.as_ref().map(of);
        let lines = lines.chain(scene.stops().map(|(_, forces, _)| LineNumbers {
            stiffness: given(&forces.stop_stiffness).unwrap_or_else(|| S::from_f64(f64::NAN)),
            damping: given(&forces.stop_damping).unwrap_or_else(S::zero),
            free_length: S::zero(),
        }));
        let forces = scene.joints.iter().map(|joint| {
            let entries = joint.forces.iter();
            entries
                .map(|forces| JointForceNumbers::new(scene, forces, of))
                .collect()
        });
        let gravity = match &scene.gravity {
            Gravity::None => GravityNumbers::None,
            Gravity::Uniform { acceleration } => {
                GravityNumbers::Uniform(triple(acceleration, &constants))
            }
            Gravity::PointMass { mu, center } => GravityNumbers::Central {
                mu: of(mu),
                center: triple(center, &constants),
                from_far: is_near_origin(scene, center),
                oblate: None,
            },
            Gravity::Oblate {
                mu,
                center,
                radius,
                j2,
                axis,
            } => GravityNumbers::Central {
                mu: of(mu),
                center: triple(center, &constants),
                from_far: is_near_origin(scene, center),
                oblate: Some(OblateNumbers {
                    radius: of(radius),
                    j2: of(j2),
                    axis: triple(axis, &constants),
                }),
            },
            Gravity::Field => GravityNumbers::Field,
        };
        let joints = scene.joints.iter().map(|joint| {
            let numbers = joint.law.numbers();
            numbers.iter().map(|(_, formula)| of(formula)).collect()
        });
        let joints: Vec<Vec<S>> = joints.collect();
        let couplings = scene.joints.iter().zip(&joints);
        let couplings = couplings.map(|(joint, numbers)| Coupling::new(scene, joint, numbers));
        Numbers {
            params: params.to_vec(),
            bodies: bodies.collect(),
            points: points.collect(),
            lines: lines.collect(),
            world_frames: frames(&scene.world_frames),
            gravity,
            couplings: couplings.collect(),
            joints,
            forces: forces.collect(),
        }
    }
}
