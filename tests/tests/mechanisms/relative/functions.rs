//! Functions that are generated when asked for: inverse dynamics, gravity force, centre of mass, Jacobians; in both families of coordinates.

use mbd_compiler::{Interpreted, SceneEquations};
use mbd_runtime::{At, BodyState, Generic, model};
use mbd_scene::laws::Numbers;
use mbd_scene::{AngularVelocity, Differentiated, Dual, Model, Quantity, Scene, Variable};
use nalgebra::{DMatrix, DVector, Quaternion, UnitQuaternion, Vector3};
use tests::assert_close;
use tests::looped::mechanism;
use tests::mechanism::{evaluate, layout, state};
use tests::random::Random;
use tests::reference::{field, load, numbers};
use tests::relative::Both;
use tests::system::{instances, list, scene};

type Rate = Dual<f64, 1>;

/// A scene at a state, in one family.
struct Moment<'a> {
    scene: &'a Scene,
    state: Vec<f64>,
}

impl Moment<'_> {
    fn get(&self, what: Quantity, rows: &[f64]) -> Vec<f64> {
        let inputs = vec![0.0; layout(self.scene).ni];
        evaluate(self.scene, what, &self.state, &inputs, rows)
    }

    fn speeds(&self) -> DVector<f64> {
        let layout = layout(self.scene);
        DVector::from_column_slice(&self.state[layout.nq..layout.nq + layout.nv])
    }

    /// A Jacobian times the speeds.
    fn along(&self, what: Quantity) -> Vec<f64> {
        let nv = layout(self.scene).nv;
        let matrix =
            DMatrix::from_row_slice(self.get(what, &[]).len() / nv, nv, &self.get(what, &[]));
        (matrix * self.speeds()).as_slice().to_vec()
    }
}

/// Position, attitude, velocity and angular velocity, world axes, of a body of numbers as absolute coordinates have them.
fn body(numbers: &[f64], components: AngularVelocity) -> (UnitQuaternion<f64>, [Vector3<f64>; 3]) {
    let three = |at: usize| Vector3::new(numbers[at], numbers[at + 1], numbers[at + 2]);
    let attitude = Quaternion::new(numbers[3], numbers[4], numbers[5], numbers[6]);
    let attitude = UnitQuaternion::from_quaternion(attitude);
    let spin = match components {
        AngularVelocity::Body => attitude * three(10),
        AngularVelocity::World => three(10),
    };
    (attitude, [three(0), three(7), spin])
}

/// The two families of a mechanism, with other speeds along its tree.
fn families(seed: u64) -> (Both, Vec<f64>) {
    let (scene, from) = mechanism(seed);
    let mut both = Both::new(&scene, &from);
    let mut random = Random::new(seed);
    let (nq, nv) = (both.layout.nq, both.layout.nv);
    for speed in &mut both.state[nq..nq + nv] {
        *speed = random.uniform(-2.0, 2.0);
    }
    let inputs = vec![0.0; both.layout.ni];
    let bodies = both.get(Quantity::Bodies, &inputs, &[]);
    let absolute = layout(&both.absolute);
    for ((_, slots), numbers) in absolute.own_bodies().zip(bodies.chunks_exact(13)) {
        let v = absolute.nq + slots.v;
        both.from[v..v + 6].copy_from_slice(&numbers[7..]);
    }
    for part in (0..scene.points.len()).map(mbd_scene::Part::Point) {
        if let (Some(own), Some(there)) = (both.layout.own_slots(part), absolute.own_slots(part)) {
            let (own, there) = (nq + own.v, absolute.nq + there.v);
            both.from[there..there + 3].copy_from_slice(&both.state[own..own + 3]);
        }
    }
    (both, bodies)
}

#[test]
fn a_frame_moves_as_its_jacobian_says() {
    for seed in 0..40 {
        let (both, bodies) = families(seed);
        let numbers: Numbers<f64> = Numbers::new(&both.relative, &[]);
        for (index, own) in bodies.chunks_exact(13).enumerate() {
            let (attitude, [_, velocity, spin]) = body(own, both.relative.angular_velocity);
            for (frame, place) in numbers.bodies[index].frames.iter().enumerate() {
                let moved = velocity + spin.cross(&(attitude * place.position));
                let want: Vec<f64> = moved.iter().chain(spin.iter()).copied().collect();
                for (family, scene, state) in [
                    ("relative", &both.relative, both.state.clone()),
                    ("absolute", &both.absolute, both.from.clone()),
                ] {
                    let got = Moment { scene, state }.along(Quantity::FrameJacobian(index, frame));
                    let name = format!("mechanism {seed}, body {index}, frame {frame}, {family}");
                    assert_close(&got, &want, 1e-12, 1e-12, &name);
                }
            }
        }
    }
}

#[test]
fn the_centre_of_mass_moves_as_its_jacobian_says_and_carries_the_momentum() {
    for seed in 0..40 {
        let (both, _) = families(seed);
        let numbers: Numbers<f64> = Numbers::new(&both.relative, &[]);
        let bodies = numbers.bodies.iter().map(|body| body.mass);
        let mass: f64 = bodies
            .chain(numbers.points.iter().map(|(mass, _)| *mass))
            .sum();
        let mut told = Vec::new();
        for (scene, state) in [
            (&both.relative, both.state.clone()),
            (&both.absolute, both.from.clone()),
        ] {
            let moment = Moment { scene, state };
            let centre = moment.get(Quantity::CentreOfMass, &[]);
            let momentum = moment.get(Quantity::Momentum, &[]);
            let velocity: Vec<f64> = momentum[..3].iter().map(|p| p / mass).collect();
            assert_close(&centre[3..], &velocity, 1e-12, 1e-12, "momentum");
            let along = moment.along(Quantity::CentreOfMassJacobian);
            assert_close(
                &along,
                &velocity,
                1e-12,
                1e-12,
                &format!("mechanism {seed}"),
            );
            told.push(centre);
        }
        assert_close(&told[0], &told[1], 1e-12, 1e-12, "families");
    }
}

#[test]
fn gravity_force_is_the_slope_of_the_energy_of_gravity() {
    for seed in 0..40 {
        let (both, _) = families(seed);
        for (scene, state) in [
            (&both.relative, both.state.clone()),
            (&both.absolute, both.from.clone()),
        ] {
            let moment = Moment { scene, state };
            let rates = moment.get(Quantity::Derivative, &[]);
            let coordinates = layout(scene).nq;
            let moved = moment.state.iter().zip(&rates).enumerate();
            let moved: Vec<Rate> = moved
                .map(|(index, (&value, &rate))| Dual {
                    value,
                    slopes: [if index < coordinates { rate } else { 0.0 }],
                })
                .collect();
            let inputs = vec![Dual::constant(0.0); layout(scene).ni];
            let energy = evaluate(scene, Quantity::Energy, &moved, &inputs, &[]);
            let force = DVector::from_vec(moment.get(Quantity::GravityForce, &[]));
            let power = force.dot(&moment.speeds());
            assert_close(
                &[power],
                &[energy[1].slopes[0]],
                1e-11,
                1e-11,
                &format!("mechanism {seed}"),
            );
        }
    }
}

#[test]
fn inverse_dynamics_gives_back_what_the_accelerations_came_from() {
    for seed in 0..40 {
        let (both, _) = families(seed);
        let inputs = vec![0.0; both.layout.ni];
        let rates = both.get(Quantity::Derivative, &inputs, &[]);
        let (nq, nv, nc) = (both.layout.nq, both.layout.nv, both.layout.nc);
        if nc > 0 {
            continue;
        }
        // Nothing has to act besides for the accelerations of what acts.
        let none = both.get(Quantity::InverseDynamics, &inputs, &rates[nq..nq + nv]);
        let forces = both.get(Quantity::BiasForce, &inputs, &[]);
        let size = forces.iter().fold(1.0f64, |most, x| most.max(x.abs()));
        assert_close(
            &none,
            &vec![0.0; nv],
            0.0,
            1e-11 * size,
            &format!("mechanism {seed}"),
        );
    }
}

#[test]
fn torques_of_robots_and_their_slopes_are_those_of_pinocchio() {
    for (robot, file) in [("robot_panda", "fd_panda"), ("robot_ur5", "fd_ur5")] {
        let system = load(&format!("robots/{robot}.json"));
        let stored = load(&format!("derivatives/{file}.json"));
        let absolute = scene(&system["system"], AngularVelocity::Body);
        for moment in list(&stored["states"]) {
            let source = moment["source_state"].as_u64().expect("an index") as usize;
            let bodies = instances(&list(&system["states"])[source]["bodies"]);
            let both = Both::new(&absolute, &state(&absolute, &bodies, &[]));
            let (nq, nv) = (both.layout.nq, both.layout.nv);
            let (tau, rates) = (field(moment, "tau"), field(moment, "vdot"));
            let got = both.get(Quantity::InverseDynamics, &[], &rates);
            assert_close(&got, &tau, 1e-11, 1e-11, &format!("{robot} torques"));
            // By the equations that `emit: [partial]` emits.
            let equations = SceneEquations::trace_with_derivatives(&both.relative);
            let model = Interpreted::from_equations(equations, &[]).expect("no params");
            let slopes = Quantity::Partial(Differentiated::Residual, Variable::State);
            let at = At {
                rows: &rates,
                ..At::of_state(0.0, &both.state, &[])
            };
            let (nx, mut by_state) = (nq + nv, vec![0.0; model.layout().len(slopes)]);
            model.evaluate(slopes, &at, &mut model.work(), &mut by_state);
            let by_state = DMatrix::from_row_slice(by_state.len() / nx, nx, &by_state);
            let constants: Vec<Rate> = rates.iter().map(|&x| Dual::constant(x)).collect();
            for (name, first) in [("dtau_dq", 0), ("dtau_dv", nq)] {
                let want = list(&moment[name]);
                for direction in 0..nv {
                    let mut moved: Vec<Rate> =
                        both.state.iter().map(|&x| Dual::constant(x)).collect();
                    moved[first + direction].slopes = [1.0];
                    let slopes = evaluate(
                        &both.relative,
                        Quantity::InverseDynamics,
                        &moved,
                        &[],
                        &constants,
                    );
                    let got: Vec<f64> = slopes.iter().map(|x| x.slopes[0]).collect();
                    let column: Vec<f64> = want.iter().map(|row| numbers(row)[direction]).collect();
                    let emitted = by_state.column(first + direction);
                    assert_close(
                        emitted.rows(nq, nv).into_owned().as_slice(),
                        &column,
                        1e-11,
                        1e-11,
                        &format!("{robot} {name} {direction}, emitted"),
                    );
                    assert_close(
                        &got,
                        &column,
                        1e-11,
                        1e-11,
                        &format!("{robot} {name} {direction}"),
                    );
                }
            }
        }
    }
}

model! {
    /// A crane that floats: a mast on a skew hinge, a boom on a universal joint, a ball, a weight on a spring.
    model Crane {
        coordinates: relative;
        emit: [
            inverse_dynamics, gravity_force, centre_of_mass, centre_of_mass_jacobian,
            frame_jacobian(boom.tip), frame_jacobian(ball.com),
        ];
        gravity: [0.3, -0.2, -9.7] m/s^2;
        param cargo = 0.7 kg in 0.1 kg ..= 2 kg;
        joint afloat: free from world to hull.com;
        body hull {
            mass: 9 kg,
            inertia: full { xx: 1.2, yy: 2.0, zz: 2.4, xy: 0.1 } kg*m^2 (matrix elements),
            frame deck at [0.4, 0.1, 0.3] m rotated rpy(10 deg, 20 deg, 0.0),
        }
        body mast {
            mass: 2 kg,
            inertia: diag(0.2, 0.2, 0.05) kg*m^2,
            frame foot at [0.0, 0.0, -0.5] m,
            frame head at [0.0, 0.05, 0.5] m,
        }
        body boom {
            mass: 1 kg,
            inertia: diag(0.02, 0.1, 0.1) kg*m^2,
            frame heel at [-0.6, 0.0, 0.0] m,
            frame tip at [0.6, 0.0, 0.1] m,
        }
        body ball {
            mass: 0.5 kg,
            inertia: diag(0.01, 0.01, 0.01) kg*m^2,
            frame eye at [0.0, 0.0, 0.2] m,
        }
        point weight { mass: cargo }
        joint slew: hinge from hull.deck to mast.foot { axis: [1, 2, 3] }
        joint luff: universal from mast.head to boom.heel { axes: [y, z] }
        joint hang: spherical from boom.tip to ball.eye;
        spring rope from ball.com to weight { free_length: 0.4 m, stiffness: 50 N/m }
    }
}

/// What is asked for has a method; what was not asked for is not a number.
#[test]
fn asked_functions_are_methods_and_give_what_the_laws_give() {
    let crane = Crane::new(CraneParams::default()).expect("defaults");
    let mut at = CraneState::at_origin();
    at.set_hull(BodyState::at([0.2, 0.1, -0.3]));
    let mut random = Random::new(4);
    at.v.iter_mut().for_each(|x| *x = random.uniform(-1.0, 1.0));
    let motion: [f64; Crane::NV] = std::array::from_fn(|_| random.uniform(-1.0, 1.0));
    let (state, layout) = (at.to_vec(), crane.layout());
    let hold = vec![0.0; layout.holds()];
    let asked = At {
        hold: &hold,
        rows: &motion,
        ..At::of_state(0.0, &state, &[])
    };
    let generic = Generic::new(crane.scene().clone(), crane.params()).expect("the same");
    let ask = |model: &dyn Model<f64>, what: Quantity| {
        let mut out = vec![0.0; layout.len(what)];
        model.evaluate(what, &asked, &mut model.work(), &mut out);
        out
    };
    let laws = |what: Quantity| ask(&generic, what);
    let close = |got: &[f64], what: Quantity| {
        assert_close(got, &laws(what), 1e-13, 1e-13, &format!("{what:?}"))
    };
    close(
        crane.inverse_dynamics(&at, &motion).as_slice(),
        Quantity::InverseDynamics,
    );
    close(crane.gravity_force(&at).as_slice(), Quantity::GravityForce);
    close(crane.centre_of_mass(&at).as_slice(), Quantity::CentreOfMass);
    close(
        crane.centre_of_mass_jacobian(&at).transpose().as_slice(),
        Quantity::CentreOfMassJacobian,
    );
    let frame = |body: &str, frame: &str| {
        let body = crane
            .scene()
            .bodies
            .iter()
            .position(|own| own.name == body)
            .expect("a body");
        let frames = &crane.scene().bodies[body].frames;
        Quantity::FrameJacobian(
            body,
            frames
                .iter()
                .position(|own| own.name == frame)
                .expect("a frame"),
        )
    };
    close(
        crane.frame_jacobian_boom_tip(&at).transpose().as_slice(),
        frame("boom", "tip"),
    );
    close(
        crane.frame_jacobian_ball_com(&at).transpose().as_slice(),
        frame("ball", "com"),
    );
    let out = ask(&crane, frame("mast", "head"));
    assert!(out.iter().all(|x| x.is_nan()), "{out:?}");
}
