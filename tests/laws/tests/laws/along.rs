//! What acts along joint coordinates: springs, dampers, friction, stops and forces on every coordinate that a joint measures.

use laws::assert_close;
use laws::instant::Instant;
use laws::mechanism::{
    Coordinates, Instance, Seat, add_body, add_external_loads, add_frame, add_joint, all_joints,
    carried, empty, evaluate_at, frame, inertia, layout, state,
};
use laws::oracle::Oracle;
use laws::random::Random;
use mbd_scene::joints::JointLaw;
use mbd_scene::{
    AngularVelocity, Formula, Frame, Function, JointForces, LineKind, Quantity, Scene,
};
use nalgebra::{DVector, Matrix3, UnitQuaternion, Vector3};

use crate::things::line;

const COMPONENTS: [AngularVelocity; 2] = [AngularVelocity::Body, AngularVelocity::World];

/// What acts along one coordinate: numbers of their own for each, so that none stands for another.
struct Acting {
    stiffness: f64,
    rest: f64,
    damping: f64,
    friction: [f64; 2],
    stops: [f64; 2],
    stop: [f64; 2],
    force: f64,
}

impl Acting {
    fn random(random: &mut Random) -> Self {
        let mut between = |low, high| random.uniform(low, high);
        Acting {
            stiffness: between(10.0, 30.0),
            rest: between(-0.5, 0.5),
            damping: between(1.0, 3.0),
            friction: [between(2.0, 4.0), between(0.1, 0.5)],
            // Touched on either side, or on none.
            stops: [between(-0.6, -0.1), between(0.1, 0.6)],
            stop: [between(100.0, 300.0), between(2.0, 20.0)],
            force: between(-5.0, 5.0),
        }
    }

    fn declared(&self, coordinate: usize) -> JointForces {
        let number = |x: f64| Some(Formula::Number(x));
        JointForces {
            coordinate,
            stiffness: number(self.stiffness),
            rest: number(self.rest),
            damping: number(self.damping),
            friction: number(self.friction[0]),
            friction_rate: number(self.friction[1]),
            stops: self.stops.map(number),
            stop_stiffness: number(self.stop[0]),
            stop_damping: number(self.stop[1]),
            force: number(self.force),
            ..JointForces::default()
        }
    }

    /// Depth and pull of the low and the high stop.
    fn touched(&self, [x, u]: [f64; 2]) -> [[f64; 2]; 2] {
        let [k, c] = self.stop;
        let stop = |depth: f64, closing: f64| [depth, k * depth + c * closing];
        [stop(self.stops[0] - x, -u), stop(x - self.stops[1], u)]
    }

    /// Q, the elastic energy, the power of the force and that of what loses energy, at a value and a rate.
    fn at(&self, [x, u]: [f64; 2]) -> [f64; 4] {
        let stretch = x - self.rest;
        let friction = self.friction[0] * u / (u * u + self.friction[1].powi(2)).sqrt();
        let mut effort = -self.stiffness * stretch - self.damping * u - friction + self.force;
        let mut stored = 0.5 * self.stiffness * stretch * stretch;
        let mut lost = -(self.damping * u + friction) * u;
        for ([depth, pull], sign) in self.touched([x, u]).into_iter().zip([1.0, -1.0]) {
            if depth > 0.0 {
                let push = pull.max(0.0);
                effort += sign * push;
                stored += 0.5 * self.stop[0] * depth * depth;
                lost -= (push - self.stop[0] * depth) * (-sign * u);
            }
        }
        [effort, stored, self.force * u, lost]
    }
}

/// Two bodies and a joint, with something along each of its coordinates.
fn pair(law: &JointLaw, components: AngularVelocity, random: &mut Random) -> (Scene, Vec<Acting>) {
    let mut scene = empty([0.0; 3], components);
    let ends = [0, 1].map(|_| {
        let body = add_body(&mut scene, random.uniform(0.5, 2.0), &inertia(random));
        add_frame(&mut scene, Some(body), Seat::random(random).declared("end"))
    });
    add_joint(&mut scene, law.clone(), ends[0], ends[1]);
    let acting: Vec<Acting> = law.measured().map(|_| Acting::random(random)).collect();
    let declared = acting.iter().enumerate();
    scene.joints[0].forces = declared.map(|(k, acting)| acting.declared(k)).collect();
    (scene, acting)
}

fn instant(scene: &Scene, x: Vec<f64>) -> Instant<f64> {
    Instant {
        state: x,
        hold: vec![0.0; layout(scene).one_way()],
        ..Instant::default()
    }
}

#[test]
fn what_acts_along_a_coordinate_has_the_power_and_the_energy_of_its_closed_form() {
    let mut random = Random::new(41);
    let mut touches = [0, 0];
    for (law, _) in all_joints() {
        for components in COMPONENTS {
            let (scene, acting) = pair(&law, components, &mut random);
            let layout = layout(&scene);
            for _ in 0..10 {
                // Anywhere, off the joint too: what acts is what the coordinate says.
                let bodies = [Instance::random(&mut random), Instance::random(&mut random)];
                let x = state(&scene, &bodies, &[]);
                let at = instant(&scene, x.clone());
                let told = evaluate_at(&scene, Quantity::Coordinates, &at.at());
                let forces = evaluate_at(&scene, Quantity::Forces, &at.at());
                let v = DVector::from_column_slice(&x[layout.nq..layout.nq + layout.nv]);
                let power = v.dot(&DVector::from_vec(forces));
                let mut want = [0.0; 4];
                let mut guards = Vec::new();
                for (acting, told) in acting.iter().zip(told.chunks(2)) {
                    let here = [told[0], told[1]];
                    let [effort, stored, given, lost] = acting.at(here);
                    for (sum, more) in want.iter_mut().zip([effort * told[1], stored, given, lost])
                    {
                        *sum += more;
                    }
                    for (touched, count) in acting.touched(here).into_iter().zip(&mut touches) {
                        *count += usize::from(touched[0] > 0.0);
                        guards.extend(touched);
                    }
                }
                let name = format!("{law:?}, {components:?}");
                let scale = 1e-9 * (1.0 + want[0].abs());
                assert_close(&[power], &want[..1], 1e-10, scale, &name);
                let energy = evaluate_at(&scene, Quantity::Energy, &at.at());
                assert_close(&energy[2..5], &want[1..], 1e-10, 1e-9, &name);
                let told = evaluate_at(&scene, Quantity::Guards, &at.at());
                assert_close(&told, &guards, 1e-10, 1e-9, &name);
            }
        }
    }
    assert!(touches.iter().all(|&count| count > 50), "{touches:?}");
}

#[test]
fn a_stop_that_is_held_pushes_as_it_is_held() {
    let mut random = Random::new(42);
    for (law, _) in all_joints() {
        let (scene, acting) = pair(&law, AngularVelocity::Body, &mut random);
        let layout = layout(&scene);
        let bodies = [Instance::random(&mut random), Instance::random(&mut random)];
        let x = state(&scene, &bodies, &[]);
        let v = DVector::from_column_slice(&x[layout.nq..layout.nq + layout.nv]);
        let mut at = instant(&scene, x);
        let told = evaluate_at(&scene, Quantity::Coordinates, &at.at());
        let mut power = |hold: f64| {
            at.hold.fill(hold);
            v.dot(&DVector::from_vec(evaluate_at(
                &scene,
                Quantity::Forces,
                &at.at(),
            )))
        };
        let (carries, carries_nothing) = (power(1.0), power(-1.0));
        let mut want = 0.0;
        for (acting, told) in acting.iter().zip(told.chunks(2)) {
            let [low, high] = acting.touched([told[0], told[1]]).map(|[_, pull]| pull);
            want += (low - high) * told[1];
        }
        let got = carries - carries_nothing;
        let scale = 1e-10 * (1.0 + carries.abs());
        assert_close(&[got], &[want], 1e-10, scale, &format!("{law:?}"));
    }
}

#[test]
fn in_relative_coordinates_the_effort_stands_where_its_coordinate_does() {
    let mut random = Random::new(43);
    for (law, _) in all_joints() {
        let (scene, acting) = pair(&law, AngularVelocity::Body, &mut random);
        let scene = scene.in_coordinates(mbd_scene::Coordinates::Relative);
        let layout = layout(&scene);
        let Some(link) = layout.carried(0) else {
            continue;
        };
        let mut x: Vec<f64> = (0..layout.nx())
            .map(|_| random.uniform(-1.0, 1.0))
            .collect();
        for at in layout.quaternions() {
            x[at..at + 4].copy_from_slice(&random.attitude());
        }
        let at = instant(&scene, x.clone());
        let forces = evaluate_at(&scene, Quantity::Forces, &at.at());
        for (k, acting) in acting.iter().enumerate() {
            let here = [x[link.slots.q + k], x[layout.nq + link.slots.v + k]];
            let [effort, ..] = acting.at(here);
            let got = forces[link.slots.v + k];
            assert_close(&[got], &[effort], 1e-12, 1e-12, &format!("{law:?}, {k}"));
        }
    }
}

/// A frame of the world that slides and turns about z, and where it is at a time.
fn cart(time: f64) -> (Frame, Instance) {
    let (rates, rate) = (Vector3::new(0.7, -0.4, 0.3), 0.9);
    let times = |k: f64| Formula::Apply(Function::Mul, vec![k.into(), Formula::Time]);
    let angle = || vec![times(rate)];
    let [sin, cos] = [Function::Sin, Function::Cos].map(|f| Formula::Apply(f, angle()));
    let minus = Formula::Apply(Function::Neg, vec![sin.clone()]);
    let zero = || Formula::Number(0.0);
    let declared = Frame {
        position: [0, 1, 2].map(|axis| times(rates[axis])),
        rotation: Some([
            [cos.clone(), minus, zero()],
            [sin, cos, zero()],
            [zero(), zero(), 1.0.into()],
        ]),
        ..frame("cart", [0.0; 3], None)
    };
    let here = Instance {
        position: rates * time,
        attitude: UnitQuaternion::from_axis_angle(&Vector3::z_axis(), rate * time),
        velocity: rates,
        omega: Vector3::z() * rate,
        ..Instance::rest()
    };
    (declared, here)
}

#[test]
fn energy_changes_by_the_power_of_loads_dampers_and_drives_along_every_joint() {
    let mut random = Random::new(44);
    let time = 0.8;
    for (law, numbers) in all_joints() {
        for components in COMPONENTS {
            for drives in [true, false] {
                let (declared, moving) = cart(time);
                let parent = if drives { moving } else { Instance::rest() };
                let mut scene = empty([0.3, -0.2, -9.81], components);
                let body = add_body(&mut scene, 1.4, &inertia(&mut random));
                let seat = Seat::random(&mut random);
                let to = add_frame(&mut scene, Some(body), seat.declared("end"));
                let from = match drives {
                    true => add_frame(&mut scene, None, declared),
                    false => add_frame(&mut scene, None, frame("base", [0.0; 3], None)),
                };
                add_joint(&mut scene, law.clone(), from, to);
                let acting = law.measured().map(|_| Acting::random(&mut random));
                let declared = acting.enumerate().map(|(k, acting)| acting.declared(k));
                scene.joints[0].forces = declared.collect();
                let post = add_frame(&mut scene, None, frame("post", [3.0, 1.0, 0.5], None));
                let tie = line(LineKind::Spring, [post, to], [0.3, 80.0, 2.0]);
                scene.lines.push(tie);
                add_external_loads(&mut scene);
                let base = Seat {
                    point: Vector3::zeros(),
                    frame: Matrix3::identity(),
                };
                let coordinates = Coordinates::random(&law, numbers.clone(), &mut random);
                let child = carried(&law, [base, seat], &parent, &coordinates);
                let mut at = instant(&scene, state(&scene, &[child], &[]));
                at.time = time;
                at.inputs = random
                    .vector(3.0)
                    .iter()
                    .chain(&random.vector(3.0))
                    .copied()
                    .collect();
                let slope = evaluate_at(&scene, Quantity::Derivative, &at.at());
                // Along the motion: every number of the state with its rate.
                let mut along = at.map(Oracle::constant);
                for (number, rate) in along.state.iter_mut().zip(slope) {
                    number.0.eps = rate;
                }
                along.time.0.eps = 1.0;
                let told = evaluate_at(&scene, Quantity::Energy, &along.at());
                let change: f64 = told[..3].iter().map(|energy| energy.0.eps).sum();
                let power: f64 = told[3..].iter().map(|power| power.0.re).sum();
                let scale: f64 = told[3..].iter().map(|power| power.0.re.abs()).sum();
                let name = format!("{law:?}, {components:?}, driven {drives}");
                assert_close(&[change], &[power], 1e-10, 1e-9 * (1.0 + scale), &name);
                assert!(drives || told[5].0.re == 0.0, "{name}");
            }
        }
    }
}
