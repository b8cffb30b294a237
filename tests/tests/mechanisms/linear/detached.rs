//! Linear systems and rests of scenes whose events lock and free coordinates, detach and attach joints and lines: with what holds where they are made.

use mbd_runtime::{Options, Simulation, StateSpace, linearise, trim};
use tests::declared::read;

use super::{eigenvalues, generic};

const GRAVITY: f64 = 9.81;
/// Mass [kg], distance of the centre of mass from the pin [m], moment of inertia about the pin [kg m²].
const ROD: [f64; 3] = [2.0, 0.5, 0.1 + 2.0 * 0.25];

/// Two rods side by side; the first may be locked, and both may be welded to each other.
fn rods(family: &str, events: &str) -> String {
    let [mass, arm, _] = ROD;
    let rod = format!(
        "mass: {mass} kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0, 0, {arm}] m"
    );
    format!(
        "model Rods {{ coordinates: {family}; gravity: [0, 0, -{GRAVITY}] m/s^2;
            param k = 0 N*m/rad;
            world {{ frame beside at [0, 1, 0] m }}
            body first {{ {rod}, frame side at [0, 1, 0] m }}
            body second {{ {rod} }}
            joint pin: hinge from world to first.top {{ axis: y, force: -k * pin.angle }}
            joint other: hinge from world.beside to second.top {{ axis: y, stiffness: 3 N*m/rad }}
            joint weld: rigid from first.side to second.com {{ at_start: detached }}
            output one = pin.angle;
            output two = other.angle;
            {events} }}"
    )
}

/// ω² of a rod with a spring of this stiffness [1/s²].
fn swing(stiffness: f64) -> f64 {
    let [mass, arm, inertia] = ROD;
    (mass * GRAVITY * arm + stiffness) / inertia
}

fn assert_swings(space: &StateSpace, squares: &[f64]) {
    let mut expected: Vec<f64> = squares
        .iter()
        .flat_map(|square| [-square.sqrt(), square.sqrt()])
        .collect();
    expected.sort_by(f64::total_cmp);
    let mut found: Vec<f64> = eigenvalues(space)
        .iter()
        .map(|[real, imaginary]| {
            assert!(real.abs() < 1e-9, "{real}");
            *imaginary
        })
        .collect();
    found.sort_by(f64::total_cmp);
    assert_eq!(found.len(), expected.len(), "{found:?} {:?}", space.states);
    for (found, expected) in found.iter().zip(&expected) {
        assert!((found - expected).abs() < 1e-8, "{found} {expected}");
    }
}

#[test]
fn a_linear_system_has_what_is_attached_where_the_run_stands() {
    let events = "event held = time rises 1 s { lock: pin }
        event let_go = time rises 2 s { free: pin }
        event welded = time rises 3 s { attach: weld, set: k = 5 N*m/rad }
        event cut = time rises 4 s { detach: weld }";
    for family in ["absolute", "relative"] {
        let model = generic(read(&rods(family, events)));
        let both = [swing(0.0), swing(3.0)];
        let rest = trim(&model).solve().expect("they hang");
        assert_swings(&rest.space, &both);
        let alone = linearise(&model, 0.0, &rest.state, &Vec::new()).expect("a system");
        assert_swings(&alone, &both);
        let mut run = Simulation::new(&model, Options::tsit5(1e-10)).expect("options");
        run.set_state(0.0, &rest.state).expect("a state");
        let stages: [(f64, &[f64]); 5] = [
            (0.5, &both),
            (1.5, &[swing(3.0)]),
            (2.5, &both),
            // One body on two springs, each half of what swings.
            (3.5, &[0.5 * (swing(5.0) + swing(3.0))]),
            (4.5, &[swing(5.0), swing(3.0)]),
        ];
        for (time, squares) in stages {
            run.run(time).expect("a run");
            assert_swings(&run.linearise(&[]).expect("a system"), squares);
            let rest = run.trim().solve().expect("it stands");
            assert_swings(&rest.space, squares);
        }
    }
}

#[test]
fn a_rest_holds_what_is_locked_where_the_run_locked_it() {
    let events = "event held = pin.angle rises 0 rad { lock: pin, set: k = 7 N*m/rad, acts: once }";
    for family in ["absolute", "relative"] {
        let model = generic(read(&rods(family, events)));
        let mut run = Simulation::new(&model, Options::tsit5(1e-10)).expect("options");
        run.set_joints(&[("pin.angle", -0.3), ("other.angle", 0.4)])
            .expect("it can be placed");
        run.run(5.0).expect("a run");
        assert_eq!(run.events().len(), 1);
        let rest = run.trim().solve().expect("the second one hangs");
        assert_swings(&rest.space, &[swing(3.0)]);
        run.set_rest(&rest).expect("a rest");
        run.run(6.0).expect("a run");
        let [first, second] = ["one", "two"].map(|name| run.output(name).expect("an output"));
        assert!(
            first.abs() < 1e-9 && second.abs() < 1e-9,
            "{first} {second}"
        );
        assert_eq!(run.model().params(), [7.0]);
        assert_eq!(run.events().len(), 1);
    }
}
