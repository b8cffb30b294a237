//! Planar scenes against the same scenes in space: every number that both have, at instants and along runs.

use mbd_compiler::{SceneEquations, read_toml, write_toml};
use mbd_runtime::{Generic, Options, Simulation, StepError};
use mbd_scene::{AngularVelocity, Layout, Plane, Quantity, Scene};
use tests::assert_close;
use tests::declared::read;
use tests::mechanism::{evaluate, with_components};
use tests::planar::{
    FOUR_BAR, MECHANISMS, Mechanism, PARALLEL, PENDULUM, PLANES, SLIDER, flattened, in_space,
    lifted, placed,
};
use tests::random::Random;

#[test]
fn a_planar_scene_has_the_accelerations_and_energies_of_the_same_scene_in_space() {
    for mechanism in MECHANISMS {
        for plane in PLANES {
            let planar = mechanism.scene(plane, "");
            let what = format!("{} in {}", mechanism.name, plane.word());
            let mut random = Random::new(3);
            for _ in 0..8 {
                let state = mechanism.state(&planar, &mut random);
                for components in [AngularVelocity::Body, AngularVelocity::World] {
                    let planar = with_components(&planar, components);
                    let space = in_space(&planar);
                    let full = lifted(&planar, &state);
                    let rows = evaluate(&space, Quantity::Constraint, &full, &[], &[]);
                    assert!(rows.iter().all(|row| row.abs() < 1e-12), "{what}: {rows:?}");
                    let of = |what| {
                        (
                            evaluate(&planar, what, &state, &[], &[]),
                            evaluate(&space, what, &full, &[], &[]),
                        )
                    };
                    let (flat, all) = of(Quantity::Derivative);
                    let (a, b) = (Layout::new(&planar).nq, Layout::new(&space).nq);
                    let want = flattened(&planar, &all[b..]);
                    assert_close(&flat[a..], &want, 1e-12, 0.0, &what);
                    for quantity in [
                        Quantity::Energy,
                        Quantity::Momentum,
                        Quantity::Outputs,
                        Quantity::Lines,
                    ] {
                        let (flat, all) = of(quantity);
                        assert_close(&flat, &all, 1e-12, 1e-12, &format!("{what}, {quantity:?}"));
                    }
                }
            }
        }
    }
}

#[test]
fn reactions_in_the_plane_are_those_of_space() {
    // Where no row repeats others in space either, reactions there are unique.
    for plane in PLANES {
        let planar = PENDULUM.scene(plane, "");
        let space = in_space(&planar);
        let mut random = Random::new(4);
        let state = PENDULUM.state(&planar, &mut random);
        let flat = evaluate(&planar, Quantity::Reactions, &state, &[], &[]);
        let all = evaluate(
            &space,
            Quantity::Reactions,
            &lifted(&planar, &state),
            &[],
            &[],
        );
        for (k, (a, b)) in flat.iter().zip(&all).enumerate() {
            let in_plane = (k % 6 < 3) != (k % 3 == plane.normal());
            let want = if in_plane { *b } else { 0.0 };
            assert!((a - want).abs() < 1e-11, "{plane:?}, {k}: {a} {want}");
        }
    }
}

/// The state at the end of a run of Rk4 with projection.
fn run(scene: &Scene, state: &[f64], (steps, step): (u32, f64)) -> Vec<f64> {
    let generic = Generic::with_defaults(scene.clone()).expect("defaults");
    let mut run = Simulation::new(&generic, Options::rk4(step)).expect("options");
    run.set_state(0.0, state).expect("a state");
    run.run(f64::from(steps) * step).expect("a run");
    run.state()[..state.len()].to_vec()
}

#[test]
fn a_run_in_the_plane_ends_where_the_run_in_space_ends() {
    for mechanism in [FOUR_BAR, SLIDER, PENDULUM, PARALLEL] {
        let planar = mechanism.scene(Plane::Xz, "");
        let state = mechanism.state(&planar, &mut Random::new(6));
        let flat = run(&planar, &state, (2000, 5e-4));
        let mut all = run(&in_space(&planar), &lifted(&planar, &state), (2000, 5e-4));
        let want = lifted(&planar, &flat);
        // Both signs of a quaternion are one attitude.
        for (_, slots) in Layout::new(&in_space(&planar)).own_bodies() {
            let range = slots.q + 3..slots.q + 7;
            let same: f64 = range.clone().map(|k| all[k] * want[k]).sum();
            range.for_each(|k| all[k] *= same.signum());
        }
        assert_close(&all, &want, 1e-9, 0.0, mechanism.name);
    }
}

#[test]
fn the_same_mechanism_moves_alike_in_all_three_planes() {
    for mechanism in MECHANISMS {
        let ends = PLANES.map(|plane| {
            let mut scene = mechanism.scene(plane, "");
            for body in &mut scene.bodies {
                // The same about every axis.
                body.inertia.xx = body.inertia.zz.clone();
                body.inertia.yy = body.inertia.zz.clone();
            }
            let generic = Generic::with_defaults(scene.clone()).expect("defaults");
            let mut run = Simulation::new(&generic, Options::tsit5(1e-9)).expect("options");
            // Positions by the first and the second axis after the normal; from rest.
            let layout = Layout::new(&scene);
            let mut rest = vec![0.0; layout.nx()];
            let first = |slot: usize| {
                let [a, b] = [slot, slot + 1];
                if plane == Plane::Xz { [b, a] } else { [a, b] }
            };
            for ((_, slots), pose) in layout.own_bodies().zip(mechanism.poses) {
                let [a, b] = first(slots.q);
                (rest[a], rest[b], rest[slots.q + 2]) = (pose[0], pose[1], pose[2]);
            }
            if scene.points.len() == 1 {
                let [a, b] = first(layout.nq - 2);
                (rest[a], rest[b]) = (0.9, -1.6);
            }
            run.set_state(0.0, &rest).expect("a state");
            run.run(0.7).expect("a run");
            let state = run.state();
            let mut list = Vec::new();
            for (_, slots) in layout.own_bodies() {
                let [a, b] = first(slots.q);
                list.extend([state[a], state[b], state[slots.q + 2]]);
            }
            list
        });
        for other in &ends[1..] {
            assert_close(other, &ends[0], 1e-9, 0.0, mechanism.name);
        }
    }
}

/// A parallelogram whose cranks turn all the way round.
const PARALLELOGRAM: Mechanism = Mechanism {
    name: "parallelogram",
    items: "
        world { frame b at V(1.0, 0.0) m }
        body one { mass: 1 kg, inertia: diag(0.03, 0.04, 0.05) kg*m^2, frame root at V(-0.15, 0.0) m, frame tip at V(0.15, 0.0) m }
        body two { mass: 1 kg, inertia: diag(0.03, 0.04, 0.05) kg*m^2, frame root at V(-0.15, 0.0) m, frame tip at V(0.15, 0.0) m }
        body beam { mass: 2 kg, inertia: diag(0.3, 0.4, 0.5) kg*m^2, frame a at V(-0.5, 0.0) m, frame b at V(0.5, 0.0) m }
        joint root_one: hinge from world to one.root { axis: NORMAL }
        joint root_two: hinge from world.b to two.root { axis: NORMAL }
        joint tip_one: hinge from one.tip to beam.a { axis: NORMAL }
        joint tip_two: hinge from two.tip to beam.b { axis: NORMAL }
    ",
    poses: &[],
};

#[test]
fn a_planar_parallelogram_passes_both_flat_positions_and_keeps_its_energy() {
    let items = placed(PARALLELOGRAM.items, Plane::Xy);
    let scene = read(&format!(
        "model Flat {{ planar: xy; gravity: none; {items} }}"
    ));
    let (sin, cos) = 1.0_f64.sin_cos();
    let spin = 4.0;
    let mut state = vec![0.0; 18];
    let (half, full) = ([0.15 * cos, 0.15 * sin], [0.3 * cos, 0.3 * sin]);
    let speeds = |[x, y]: [f64; 2]| [-spin * y, spin * x];
    for (body, (offset, arm, angle, rate)) in [
        (0.0, half, 1.0, spin),
        (1.0, half, 1.0, spin),
        (0.5, full, 0.0, 0.0),
    ]
    .into_iter()
    .enumerate()
    {
        state[3 * body..3 * body + 3].copy_from_slice(&[offset + arm[0], arm[1], angle]);
        let [vx, vy] = speeds(arm);
        state[9 + 3 * body..12 + 3 * body].copy_from_slice(&[vx, vy, rate]);
    }
    let before = evaluate(&scene, Quantity::Energy, &state, &[], &[]);
    // Through flat at π and at 2π.
    let end = run(&scene, &state, (4000, 5e-4));
    let after = evaluate(&scene, Quantity::Energy, &end, &[], &[]);
    assert_close(&after[..1], &before[..1], 1e-12, 0.0, "kinetic energy");
    assert!(
        (end[2] - (1.0 + 2.0 * spin)).abs() < 1e-9,
        "not wrapped: {}",
        end[2]
    );
    assert!(end[8].abs() < 1e-9, "the beam stays level: {}", end[8]);
}

#[test]
fn a_knot_of_lines_in_a_plane_sits_where_it_does_in_space() {
    let items = "
        world { frame left at V(-1.0, 2.0) m, frame right at V(1.5, 2.2) m }
        body lamp { mass: 2 kg, inertia: diag(0.01, 0.02, 0.03) kg*m^2, frame hook at V(0.05, 0.2) m }
        point knot;
        joint lamp_free: free from world to lamp.com;
        line a from world.left to knot { free_length: 1.2 m, stiffness: 5 kN/m }
        line b from world.right to knot { free_length: 1.6 m, stiffness: 5 kN/m }
        line cord from knot to lamp.hook { free_length: 0.5 m, stiffness: 5 kN/m }
        output pull = a.tension;
    ";
    let items = placed(items, Plane::Xz);
    let gravity = placed("V(0.0, -9.81)", Plane::Xz);
    let scene = read(&format!(
        "model Lamp {{ planar: xz; gravity: {gravity} m/s^2; {items} }}"
    ));
    // x along the second axis.
    let state = [0.8, 0.4, 0.1, 0.0, 0.3, 0.2];
    let flat = run(&scene, &state, (1000, 5e-4));
    let all = run(&in_space(&scene), &lifted(&scene, &state), (1000, 5e-4));
    let want = lifted(&scene, &flat);
    assert_close(&all, &want, 1e-8, 0.0, "lamp");
}

#[test]
fn frames_that_disagree_out_of_the_plane_are_told_at_the_start() {
    let scene = read(
        "model Apart { planar: xz; gravity: [0.0, 0.0, -9.81] m/s^2;
            param offset = 0 m in -1 m ..= 1 m;
            body rod { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0.0, offset, 0.5 m] }
            body bead { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }
            joint hold: hinge from world to rod.top { axis: y }
            joint lie: planar from world to bead.com { axis: y } }",
    );
    let start = |offset: f64| {
        let generic = Generic::new(scene.clone(), &[offset]).expect("a parameter");
        let mut run = Simulation::new(&generic, Options::rk4(1e-3)).expect("options");
        run.set_state(0.0, &[0.0; 12]).expect("a state");
        run.start().map_err(|error| error.cause)
    };
    assert!(start(0.0).is_ok());
    match start(0.1) {
        Err(StepError::InconsistentStart { norm, rows }) => {
            assert!((norm - 0.1).abs() < 1e-12, "{norm}");
            assert_eq!(rows.len(), 1);
            assert_eq!(rows[0].0, "hold");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn joints_that_hold_nothing_in_the_plane_leave_a_free_body_and_its_numbers_finite() {
    let scene = read(
        "model Loose { planar: xy; gravity: [0.0, -9.81, 0.0] m/s^2;
            body disc { mass: 2 kg, inertia: diag(0.1, 0.1, 0.2) kg*m^2, frame rim at [0.3, 0.0, 0.0] m }
            joint floor: planar from world to disc.rim { axis: z }
            joint sheet: point_on_plane from world to disc.com { axis: z }
            joint level: constant_angle from world to disc.com { axes: [z, x], angle: 90 deg }
            output push = disc.rim.position; }",
    );
    let layout = Layout::new(&scene);
    assert_eq!((layout.nc, layout.freedoms(), layout.nv), (0, 3, 3));
    let generic = Generic::with_defaults(scene.clone()).expect("defaults");
    let mut simulation = Simulation::new(&generic, Options::tsit5(1e-12)).expect("options");
    simulation
        .set_state(0.0, &[0.1, 0.2, 0.3, 1.0, 4.0, 2.0])
        .expect("a state");
    simulation.run(0.5).expect("a run");
    let want = [
        0.6,
        0.2 + 2.0 - 0.125 * 9.81,
        1.3,
        1.0,
        4.0 - 0.5 * 9.81,
        2.0,
    ];
    assert_close(simulation.state(), &want, 0.0, 1e-11, "thrown disc");
}

#[test]
fn a_planar_scene_is_the_same_from_toml() {
    for plane in PLANES {
        let scene = FOUR_BAR.scene(plane, "");
        let back = read_toml(&write_toml(&scene));
        assert_eq!(back.scene.as_ref(), Some(&scene), "{:?}", back.errors);
    }
    // Both orders of the axes mean one plane.
    let items = placed(FOUR_BAR.items, Plane::Xz);
    let other = read(&format!(
        "model Planar {{ planar: zx; gravity: none; {items} }}"
    ));
    assert_eq!(other.planar, Some(Plane::Xz));
}

/// Operations of the state derivative and of a projection step.
fn costs(scene: &Scene) -> [usize; 2] {
    let wanted = [Quantity::Derivative, Quantity::ProjectionStep];
    let equations = SceneEquations::trace_only(scene, &wanted);
    wanted.map(|what| equations.program(what).expect("traced").cost().total())
}

#[test]
fn a_planar_four_bar_costs_less_than_a_quarter_of_that_in_space() {
    let bare = FOUR_BAR.items.split("spring").next().expect("the joints");
    let bare = bare
        .replace(", damping: 0.1 N*m*s", "")
        .replace(", stiffness: 3 N*m/rad", "");
    let items = placed(&bare, Plane::Xz);
    let scene = read(&format!(
        "model Bare {{ planar: xz; gravity: [0.0, 0.0, -9.81] m/s^2; {items} }}"
    ));
    let layout = Layout::new(&scene);
    assert_eq!(
        (layout.nq, layout.nv, layout.nc, layout.rank()),
        (9, 9, 8, 8)
    );
    assert!(layout.redundancy.repeats.is_empty());
    let (flat, space) = (costs(&scene), costs(&in_space(&scene)));
    // In space 1,297 and 1,037; 1,444 and 1,047 before one elimination served every joint.
    assert!(flat[0] <= 283 && flat[1] <= 262, "{flat:?}");
    assert!(space[0] <= 1297 && space[1] <= 1037, "{space:?}");
    assert!(
        4 * flat[0] < space[0] && 3 * flat[1] < space[1],
        "{space:?}"
    );
}
