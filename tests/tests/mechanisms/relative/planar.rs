//! Planar scenes in relative coordinates: the motion, the forces and the angles of absolute ones, in each of the three planes.

use mbd_compiler::Interpreted;
use mbd_runtime::{Content, Options, Sampling, Simulation, Trajectory};
use mbd_scene::{AngularVelocity, Plane, Quantity, Scene};
use tests::assert_close;
use tests::declared::read;
use tests::mechanism::layout;
use tests::planar::{MECHANISMS, Mechanism, PLANES, placed};
use tests::random::Random;
use tests::relative::Both;

/// A trolley that flies, with a rod on a hinge whose frame is turned, a slide on the rod, a ball and a cross that the plane leaves one turn each,
/// a tilted inertia, loads across the plane.
const FLYER: Mechanism = Mechanism {
    name: "flyer",
    items: "
        body trolley { mass: 2 kg, inertia: full { xx: 0.3, yy: 0.4, zz: 0.5, xy: 0.05, yz: -0.03, xz: 0.04 } kg*m^2 (matrix elements),
            frame left at V(-0.3, 0.1) m, frame right at V(0.3, 0.0) m }
        body rod { mass: 1 kg, inertia: full { xx: 0.03, yy: 0.04, zz: 0.05, xy: 0.01 } kg*m^2 (matrix elements), frame top at V(0.0, 0.4) m, frame end at V(0.0, -0.4) m }
        body sleeve { mass: 0.5 kg, inertia: diag(0.01, 0.02, 0.03) kg*m^2 }
        body ball { mass: 0.7 kg, inertia: diag(0.02, 0.02, 0.02) kg*m^2, frame top at V(0.05, 0.2) m }
        body bob { mass: 0.4 kg, inertia: diag(0.01, 0.02, 0.01) kg*m^2, frame top at V(0.0, 0.15) m }
        point weight { mass: 0.3 kg }
        joint afloat: free from world to trolley.com;
        joint pin: hinge from rod.top to trolley.left { axis: NORMAL, damping: 0.1 N*m*s }
        joint slide: prismatic from rod.end to sleeve.com { axis: SECOND, stiffness: 40 N/m }
        joint socket: spherical from trolley.right to ball.top;
        joint yoke: universal from ball.com to bob.top { axes: [NORMAL, FIRST] }
        spring tie from bob.com to weight { free_length: 0.2 m, stiffness: 30 N/m, damping: 0.2 N*s/m }
        load wind on trolley = [0.3, 0.4, 0.5] * 1 N;
        input shoved: force = 0.3 N;
        load shove on rod at end = [shoved, 2 * shoved, -shoved];
        output way = slide.slide;
        output push = ball.acceleration;
    ",
    poses: &[
        [0.1, -0.2, 0.3],
        [-0.2, -0.55, 0.4],
        [-0.35, -0.9, 0.4],
        [0.33, -0.3, 0.2],
        [0.35, -0.45, 0.1],
    ],
};

fn each(mut with: impl FnMut(&str, &Scene, &Both, &[f64])) {
    let mut random = Random::new(77);
    for mechanism in MECHANISMS.into_iter().chain([FLYER]) {
        for plane in PLANES {
            for components in [AngularVelocity::Body, AngularVelocity::World] {
                let settings = match components {
                    AngularVelocity::Body => "angular_velocity: body;",
                    AngularVelocity::World => "angular_velocity: world;",
                };
                let scene = mechanism.scene(plane, settings);
                let state = mechanism.state(&scene, &mut random);
                let inputs: Vec<f64> = (0..layout(&scene).ni)
                    .map(|_| random.uniform(-2.0, 2.0))
                    .collect();
                let name = format!("{}, {}, {components:?}", mechanism.name, plane.word());
                let both = Both::new(&scene, &state);
                with(&name, &scene, &both, &inputs);
            }
        }
    }
}

#[test]
fn bodies_move_in_the_plane_as_absolute_coordinates_move_them() {
    each(|name, _, both, inputs| {
        let (motions, rates) = both.bodies_moving(inputs);
        let absolute = layout(&both.absolute);
        let want = both.want(Quantity::Derivative, inputs);
        let size = |list: &[f64]| list.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
        for (body, slots) in absolute.own_bodies() {
            let (q, v) = (slots.q, absolute.nq + slots.v);
            let own = 6 * body;
            assert_close(
                &motions[own..own + 6],
                &[&both.from[q..q + 3], &both.from[v..v + 3]].concat(),
                0.0,
                1e-13,
                name,
            );
            // A state is closed to the tolerance of a start; accelerations have what that leaves.
            let wanted = [&want[q..q + 3], &want[v..v + 3]].concat();
            assert_close(
                &rates[own..own + 6],
                &wanted,
                0.0,
                1e-9 * size(&wanted),
                name,
            );
        }
    });
}

#[test]
fn a_planar_tree_has_a_speed_a_hinge_and_three_a_body_that_floats() {
    let scene = FLYER.scene(Plane::Xz, "coordinates: relative;");
    let layout = layout(&scene);
    // Trolley 3, rod and sleeve 1 each, weight 2; ball and bob float, on two rows each: what they could do out of the plane is no speed.
    assert_eq!((layout.nv, layout.nc), (13, 4));
    let carried: Vec<&str> = layout
        .joint_links()
        .map(|(joint, _)| scene.joints[joint].name.as_str())
        .collect();
    assert_eq!(carried, ["pin", "slide"]);
}

#[test]
fn energy_momentum_and_reactions_in_the_plane_do_not_depend_on_coordinates() {
    each(|name, _, both, inputs| {
        for what in [Quantity::Energy, Quantity::Momentum] {
            let want = both.want(what, inputs);
            assert_close(&both.get(what, inputs, &[]), &want, 1e-10, 1e-10, name);
        }
        if layout(&both.absolute).redundancy.repeats.is_empty() {
            let want = both.want(Quantity::Reactions, inputs);
            let got = both.get(Quantity::Reactions, inputs, &[]);
            assert_close(&got, &want, 1e-8, 1e-8, name);
        }
    });
}

#[test]
fn equations_of_motion_and_factor_hold_in_the_plane() {
    each(|name, _, both, inputs| {
        let layout = &both.layout;
        if !layout.redundancy.repeats.is_empty() {
            return;
        }
        let rates = both.get(Quantity::Derivative, inputs, &[]);
        let multipliers = both.get(Quantity::Multipliers, inputs, &[]);
        let motion = [&rates[layout.nq..layout.nq + layout.nv], &multipliers].concat();
        let left = both.get(Quantity::Residual, inputs, &motion);
        let most = left[layout.nq..]
            .iter()
            .fold(0.0_f64, |m, x| m.max(x.abs()));
        assert!(most < 1e-9, "{name}: {most:e}");
        let factor = both.get(Quantity::Factor, inputs, &[]);
        let size = layout.nv + layout.nc;
        let right: Vec<f64> = (0..size).map(|k| 0.3 + 0.1 * k as f64).collect();
        let list = [&factor[..], &right].concat();
        let solved = both.get(Quantity::Solve, inputs, &list);
        // M x = b + Φᵀ y, Φ x = c.
        let mass = both.get(Quantity::MassMatrix, inputs, &[]);
        let jacobian = both.get(Quantity::ConstraintJacobian, inputs, &[]);
        let (x, y) = solved.split_at(layout.nv);
        for i in 0..layout.nv {
            let inertia: f64 = (0..layout.nv).map(|j| mass[i * layout.nv + j] * x[j]).sum();
            let held: f64 = (0..layout.nc)
                .map(|j| jacobian[j * layout.nv + i] * y[j])
                .sum();
            assert_close(&[inertia - held], &right[i..=i], 1e-9, 1e-9, name);
        }
        for row in 0..layout.nc {
            let line = &jacobian[row * layout.nv..(row + 1) * layout.nv];
            let moved: f64 = line.iter().zip(x).map(|(a, b)| a * b).sum();
            let at = layout.nv + row;
            assert_close(&[moved], &right[at..=at], 1e-9, 1e-9, name);
        }
    });
}

/// What a run in one family comes to: the last row of some columns.
fn run(family: &str, items: &str, until: f64, columns: &[&str]) -> Vec<f64> {
    let text = format!("model Flat {{ planar: xz; coordinates: {family}; {items} }}");
    let model = Interpreted::<f64>::new(read(&text), &[]).expect("a model");
    let mut run = Simulation::new(&model, Options::vern7(1e-11)).expect("options");
    run.start().expect("a start");
    let mut history = Trajectory::new(&model, Sampling::At(vec![until]), Content::ALL);
    run.record(until, &mut history).expect("a smooth motion");
    let last = |name: &&str| *history.column(name).and_then(|c| c.last()).expect(name);
    columns.iter().map(last).collect()
}

#[test]
fn runs_in_the_plane_have_the_same_columns_and_angles_that_count_turns() {
    let items = placed(
        "gravity: V(-9.81, 0.0) m/s^2;
         body wheel { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame rim at V(0.3, 0.0) m rotated rpy(0, 30 deg, 0) }
         body rod { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at V(0.4, 0.0) m }
         joint axle: hinge from world to wheel.com { axis: NORMAL, start: 10 deg, start_rate: 20 rad/s }
         joint pin: hinge from rod.top to wheel.rim { axis: NORMAL, start: -15 deg }
         output turned = rod.orientation;",
        Plane::Xz,
    );
    let columns = [
        "wheel.x",
        "wheel.angle",
        "wheel.omega_y",
        "rod.x",
        "rod.z",
        "rod.angle",
        "rod.vx",
        "rod.vz",
        "rod.omega_y",
        "turned.y",
    ];
    let [relative, absolute] =
        ["relative", "absolute"].map(|family| run(family, &items, 1.5, &columns));
    assert!(absolute[5].abs() > 7.0, "more than a turn: {absolute:?}");
    assert_close(&relative, &absolute, 0.0, 1e-7, "columns of both families");
}

#[test]
fn a_frame_of_the_world_that_turns_carries_its_joint_by_rows_in_a_plane() {
    let items = "gravity: [0.0, 0.0, -9.81] m/s^2;
         world { frame arm at [0.2 * cos(3 rad/s * time), 0, -0.2 * sin(3 rad/s * time)] m rotated rpy(0, 3 rad/s * time, 0) }
         body rod { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0, 0, 0.4] m }
         joint pin: hinge from world.arm to rod.top { axis: y, damping: 1 N*m*s }";
    let columns = ["rod.x", "rod.z", "rod.angle", "rod.omega_y", "pin.force_x"];
    let columns = &columns[..4];
    let [relative, absolute] =
        ["relative", "absolute"].map(|family| run(family, items, 4.0, columns));
    assert_close(&relative, &absolute, 0.0, 1e-7, "columns of both families");
}
