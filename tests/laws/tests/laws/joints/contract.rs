//! One contract for all joints: what a joint forbids and what it allows are two tellings of one motion.

use laws::assert_close;
use laws::jet::Jet;
use laws::mechanism::{
    Coordinates, Instance, Seat, accelerations, add_body, add_external_loads, add_frame, add_joint,
    all_joints, at, carried, empty, evaluate, inertia, jets, state, subspace,
};
use laws::random::Random;
use mbd_scene::joints::{JointLaw, Relative, Twist};
use mbd_scene::laws::{Numbers, branch};
use mbd_scene::{AngularVelocity, Layout, Quantity, Scene};
use nalgebra::{DMatrix, Matrix3, Vector3};

const COMPONENTS: [AngularVelocity; 2] = [AngularVelocity::Body, AngularVelocity::World];

/// Two bodies, or a body and the world, and one joint between them.
struct Pair {
    scene: Scene,
    seats: [Seat; 2],
    parent_is_world: bool,
}

fn pair(
    law: &JointLaw,
    components: AngularVelocity,
    parent_is_world: bool,
    random: &mut Random,
) -> Pair {
    let seats = [Seat::random(random), Seat::random(random)];
    let mut scene = empty([0.3, -0.2, -9.81], components);
    let parent = (!parent_is_world).then(|| add_body(&mut scene, 1.7, &inertia(random)));
    let child = add_body(&mut scene, 0.9, &inertia(random));
    let from = add_frame(&mut scene, parent, seats[0].declared("one"));
    let to = add_frame(&mut scene, Some(child), seats[1].declared("two"));
    add_joint(&mut scene, law.clone(), from, to);
    add_external_loads(&mut scene);
    Pair {
        scene,
        seats,
        parent_is_world,
    }
}

impl Pair {
    fn parent(&self, random: &mut Random) -> Instance {
        if self.parent_is_world {
            Instance::rest()
        } else {
            Instance::random(random)
        }
    }

    fn bodies(&self, parent: Instance, child: Instance) -> Vec<Instance> {
        if self.parent_is_world {
            vec![child]
        } else {
            vec![parent, child]
        }
    }

    fn quantity(&self, what: Quantity, bodies: &[Instance]) -> Vec<f64> {
        evaluate(
            &self.scene,
            what,
            &state(&self.scene, bodies, &[]),
            &[],
            &[],
        )
    }

    /// Φ_v.
    fn jacobian(&self, bodies: &[Instance]) -> DMatrix<f64> {
        let layout = Layout::new(&self.scene);
        let dense = self.quantity(Quantity::ConstraintJacobian, bodies);
        DMatrix::from_row_slice(layout.nc, layout.nv, &dense)
    }
}

/// Calls `check` for every joint, both components, to a body and to the world, at several random instants.
fn everywhere(mut check: impl FnMut(&str, &JointLaw, &Pair, &Coordinates, &mut Random)) {
    let mut random = Random::new(31);
    for (law, numbers) in all_joints() {
        for components in COMPONENTS {
            for to_world in [false, true] {
                for trial in 0..5 {
                    let pair = pair(&law, components, to_world, &mut random);
                    let coordinates = Coordinates::random(&law, numbers.clone(), &mut random);
                    let name = format!("{law:?}, {components:?}, to world {to_world}, {trial}");
                    check(&name, &law, &pair, &coordinates, &mut random);
                }
            }
        }
    }
}

#[test]
fn rows_and_freedoms_make_six_and_the_rows_are_independent() {
    everywhere(|name, law, pair, coordinates, random| {
        assert_eq!(law.rows() + law.freedoms(), 6, "{name}");
        let parent = pair.parent(random);
        let child = carried(law, pair.seats, &parent, coordinates);
        let layout = Layout::new(&pair.scene);
        assert_eq!(layout.nc, law.rows(), "{name}");
        if law.rows() > 0 {
            let singular = pair.jacobian(&pair.bodies(parent, child)).singular_values();
            assert!(singular.min() > 1e-3, "{name}: {singular}");
        }
        let columns = subspace(law, coordinates);
        if !columns.is_empty() {
            let h = DMatrix::from_fn(6, columns.len(), |i, j| match i {
                0..3 => columns[j].linear[i],
                _ => columns[j].angular[i - 3],
            });
            assert!(h.singular_values().min() > 1e-3, "{name}");
        }
    });
}

#[test]
fn a_motion_the_joint_allows_satisfies_its_rows_at_all_three_levels() {
    everywhere(|name, law, pair, coordinates, random| {
        let parent = pair.parent(random);
        let child = carried(law, pair.seats, &parent, coordinates);
        let bodies = pair.bodies(parent, child);
        let zero = vec![0.0; law.rows()];
        for what in [Quantity::Constraint, Quantity::ConstraintRate] {
            let value = pair.quantity(what, &bodies);
            assert_close(&value, &zero, 0.0, 4e-14, &format!("{name}: {what:?}"));
        }
        let moved = pair.jacobian(&bodies)
            * DMatrix::from_vec(
                Layout::new(&pair.scene).nv,
                1,
                accelerations(&pair.scene, &bodies, &[]),
            );
        let bias = pair.quantity(Quantity::ConstraintBias, &bodies);
        assert_close(moved.as_slice(), &bias, 1e-13, 1e-13, &format!("{name}: γ"));
        // Each freedom alone, the parent at rest: Φ_v H = 0.
        for freedom in 0..law.freedoms() {
            let mut alone = coordinates.clone();
            alone.u.fill(0.0);
            alone.u[freedom] = 1.0;
            let still = Instance {
                velocity: Vector3::zeros(),
                omega: Vector3::zeros(),
                ..parent
            };
            let child = carried(law, pair.seats, &still, &alone);
            let rate = pair.quantity(Quantity::ConstraintRate, &pair.bodies(still, child));
            assert_close(&rate, &zero, 0.0, 1e-14, &format!("{name}: Φ_v H"));
        }
        if law.rows() > 0 {
            let numbers = Numbers::new(&pair.scene, &[]);
            let layout = Layout::new(&pair.scene);
            let state = state(&pair.scene, &bodies, &[]);
            let signs = branch(&pair.scene, &layout, &numbers, &at(&state, &[], &[]), 0);
            assert!(signs.iter().all(|&sign| sign > 0.0), "{name}: {signs:?}");
        }
    });
}

#[test]
fn rows_agree_with_jets_along_motions_that_violate_the_joint() {
    everywhere(|name, law, pair, _, random| {
        if law.rows() == 0 {
            return;
        }
        let bodies = pair.bodies(Instance::random(random), Instance::random(random));
        let layout = Layout::new(&pair.scene);
        let jet = evaluate(
            &pair.scene,
            Quantity::Constraint,
            &jets(&pair.scene, &bodies, &[]),
            &[],
            &[],
        );
        let level = |k: usize| jet.iter().map(|jet| jet.0[k]).collect::<Vec<f64>>();
        let rate = pair.quantity(Quantity::ConstraintRate, &bodies);
        assert_close(&rate, &level(1), 1e-14, 1e-14, &format!("{name}: Φ_v v"));
        let bias = pair.quantity(Quantity::ConstraintBias, &bodies);
        let moved = pair.jacobian(&bodies)
            * DMatrix::from_vec(layout.nv, 1, accelerations(&pair.scene, &bodies, &[]));
        let second: Vec<f64> = moved.iter().zip(&bias).map(|(a, b)| a - b).collect();
        assert_close(&second, &level(2), 1e-13, 1e-13, &format!("{name}: γ"));
        // Column by column: a unit of one speed, the others zero.
        let jacobian = pair.jacobian(&bodies);
        for speed in 0..layout.nv {
            let mut moving = bodies.clone();
            for body in &mut moving {
                body.velocity = Vector3::zeros();
                body.omega = Vector3::zeros();
            }
            let (body, axis) = (speed / 6, speed % 3);
            let unit = Vector3::from_fn(|i, _| f64::from(u8::from(i == axis)));
            let rotated = match pair.scene.angular_velocity {
                AngularVelocity::World => unit,
                AngularVelocity::Body => moving[body].rotation() * unit,
            };
            match speed % 6 {
                0..3 => moving[body].velocity = unit,
                _ => moving[body].omega = rotated,
            }
            let jet = evaluate(
                &pair.scene,
                Quantity::Constraint,
                &jets(&pair.scene, &moving, &[]),
                &[],
                &[],
            );
            let rate: Vec<f64> = jet.iter().map(|jet| jet.0[1]).collect();
            let column: Vec<f64> = jacobian.column(speed).iter().copied().collect();
            assert_close(
                &column,
                &rate,
                1e-14,
                1e-14,
                &format!("{name}: column {speed}"),
            );
        }
    });
}

#[test]
fn velocity_and_acceleration_of_a_joint_are_the_derivatives_of_its_pose() {
    let mut random = Random::new(5);
    for (law, numbers) in all_joints() {
        for _ in 0..5 {
            let at = Coordinates::random(&law, numbers.clone(), &mut random);
            let mut rates = vec![0.0; law.coordinates()];
            law.rates(&at.relative(), &mut rates);
            let moving: Vec<Jet> =
                at.q.iter()
                    .zip(&rates)
                    .map(|(q, d)| Jet([*q, *d, 0.0]))
                    .collect();
            let speeds: Vec<Jet> = at.u.iter().map(|u| Jet::constant(*u)).collect();
            let constants: Vec<Jet> = numbers.iter().map(|n| Jet::constant(*n)).collect();
            let relative = Relative {
                q: &moving,
                u: &speeds,
                numbers: &constants,
            };
            let pose = law.motion(&relative);
            let sum = |columns: &[Twist<f64>]| {
                columns.iter().zip(&at.u).fold(
                    (Vector3::zeros(), Vector3::zeros()),
                    |(x, k), (column, u)| (x + column.linear * *u, k + column.angular * *u),
                )
            };
            let (velocity, omega) = sum(&subspace(&law, &at));
            let rate = pose.position.map(|x| x.0[1]);
            assert_close(
                rate.as_slice(),
                velocity.as_slice(),
                1e-14,
                1e-14,
                &format!("{law:?}: ṡ"),
            );
            let r: Matrix3<f64> = pose.rotation.map(|x| x.0[0]);
            let spun = omega.cross_matrix() * r;
            let rotated = pose.rotation.map(|x| x.0[1]);
            assert_close(
                rotated.as_slice(),
                spun.as_slice(),
                1e-14,
                1e-14,
                &format!("{law:?}: Ṙ"),
            );
            let mut columns = vec![Twist::zero(); law.freedoms()];
            law.subspace(&relative, &mut columns);
            let changes: Vec<Twist<f64>> = columns
                .iter()
                .map(|column| Twist {
                    linear: column.linear.map(|x| x.0[1]),
                    angular: column.angular.map(|x| x.0[1]),
                })
                .collect();
            let (linear, angular) = sum(&changes);
            let bias = law.bias(&at.relative());
            let name = format!("{law:?}: b");
            assert_close(
                bias.linear.as_slice(),
                linear.as_slice(),
                1e-14,
                1e-14,
                &name,
            );
            assert_close(
                bias.angular.as_slice(),
                angular.as_slice(),
                1e-14,
                1e-14,
                &name,
            );
        }
    }
}

#[test]
fn a_flipped_hinge_satisfies_its_rows_and_fails_the_branch_test() {
    let mut random = Random::new(8);
    for keyword in ["hinge", "cylindrical", "planar", "rigid", "prismatic"] {
        let (law, numbers) = all_joints()
            .into_iter()
            .find(|(law, _)| law.keyword() == keyword)
            .expect("in the list");
        let pair = pair(&law, AngularVelocity::Body, false, &mut random);
        let parent = pair.parent(&mut random);
        let coordinates = Coordinates::random(&law, numbers, &mut random);
        let mut flipped = pair.seats;
        flipped[1].frame *= Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0));
        let child = carried(&law, flipped, &parent, &coordinates);
        let bodies = pair.bodies(parent, child);
        let zero = vec![0.0; law.rows()];
        let value = pair.quantity(Quantity::Constraint, &bodies);
        assert_close(&value, &zero, 0.0, 1e-14, keyword);
        let numbers = Numbers::new(&pair.scene, &[]);
        let state = state(&pair.scene, &bodies, &[]);
        let layout = Layout::new(&pair.scene);
        let signs = branch(&pair.scene, &layout, &numbers, &at(&state, &[], &[]), 0);
        assert!(signs.iter().any(|&sign| sign < 0.0), "{keyword}: {signs:?}");
    }
}

#[test]
fn a_joint_reads_back_what_it_writes() {
    for (law, _) in all_joints() {
        let text = serde_json::to_string(&law).expect("a joint is data");
        let back: JointLaw = serde_json::from_str(&text).expect("its own text");
        assert_eq!(back, law, "{text}");
    }
    let zero = serde_json::from_str::<JointLaw>(r#"{"Hinge":{"axis":[0,0,0]}}"#);
    assert!(zero.is_err(), "a zero axis is no axis");
}
