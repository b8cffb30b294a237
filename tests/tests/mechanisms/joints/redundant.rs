//! Rows that repeat others: found in the declaration, named, left out of the system; the motion is the same.

use mbd_runtime::{Generic, Options, Simulation, model};
use mbd_scene::joints::{JointLaw, Rigid};
use mbd_scene::{AngularVelocity, Layout, Model, Quantity, Scene};
use nalgebra::Vector3;
use tests::agreement::agrees;
use tests::declared::read;
use tests::linkage::{Linkage, bricard, planar, plane};
use tests::mechanism::evaluate;

const COMPONENTS: [AngularVelocity; 2] = [AngularVelocity::Body, AngularVelocity::World];
const FOUR_BAR: [[f64; 2]; 4] = [[0.0, 0.0], [0.3, 0.9], [1.6, 1.1], [1.9, 0.0]];

fn four_bar(floats: bool, tilted: bool, components: AngularVelocity) -> Linkage {
    let bars: [&[usize]; 4] = [&[0, 3], &[0, 1], &[1, 2], &[2, 3]];
    let gravity = if floats { [0.0; 3] } else { [0.5, 0.3, -9.81] };
    planar(&FOUR_BAR, &bars, floats, plane(tilted), gravity, components)
}

/// Two cranks and a bar, and a third crank between them that changes nothing.
fn parallelogram() -> Linkage {
    let (s, c) = 0.7_f64.sin_cos();
    let points = [
        [0.0, 0.0],
        [1.0, 0.0],
        [2.0, 0.0],
        [c, s],
        [1.0 + c, s],
        [2.0 + c, s],
    ];
    let bars: [&[usize]; 5] = [&[0, 1, 2], &[0, 3], &[3, 4, 5], &[1, 4], &[2, 5]];
    planar(
        &points,
        &bars,
        false,
        plane(false),
        [0.0; 3],
        AngularVelocity::Body,
    )
}

fn count(scene: &Scene) -> [usize; 3] {
    let layout = Layout::new(scene);
    assert!(layout.redundancy.closed);
    [layout.nc, layout.rank(), layout.freedoms()]
}

#[test]
fn the_rank_is_that_of_the_mechanism_not_of_the_count() {
    for components in COMPONENTS {
        for tilted in [false, true] {
            let scene = four_bar(false, tilted, components).scene;
            assert_eq!(count(&scene), [20, 17, 1]);
            // 6 freedoms as a whole and one inside.
            let scene = four_bar(true, tilted, components).scene;
            assert_eq!(count(&scene), [20, 17, 7]);
        }
        assert_eq!(count(&bricard([0.0; 3], components).scene), [30, 29, 1]);
    }
    assert_eq!(count(&parallelogram().scene), [30, 23, 1]);
}

#[test]
fn the_joint_that_closes_the_loop_names_those_it_repeats() {
    let scene = four_bar(false, false, AngularVelocity::Body).scene;
    let found = Layout::new(&scene).redundancy;
    assert_eq!(
        found.sentences(&scene),
        ["`hinge3` repeats rows of `hinge0`, `hinge1`, `hinge2`: 3 of 5"]
    );
    assert!((0..4).all(|joint| !found.is_unique(joint)));
    // A pendulum beside it is determined.
    let mut linkage = four_bar(false, false, AngularVelocity::Body);
    let at = Vector3::new(5.0, 0.0, 0.0);
    let bob = linkage.body(1.0, [0.1; 3], at);
    linkage.pin([None, Some(bob)], at + Vector3::z(), Vector3::x());
    let layout = Layout::new(&linkage.scene);
    assert!(layout.redundancy.is_unique(4) && layout.joints[4].all_kept());
    assert_eq!(layout.redundancy.loops, 1);
}

/// Largest relative change of energy over a run.
fn energy_error(linkage: &Linkage, speeds: &[(usize, f64)], step: f64, until: f64) -> f64 {
    let model = Generic::<f64>::with_defaults(linkage.scene.clone()).expect("a valid scene");
    let mut run = Simulation::new(&model, Options::rk4(step)).expect("options that fit");
    let mut state = linkage.state();
    for &(speed, value) in speeds {
        state[Layout::new(&linkage.scene).nq + speed] = value;
    }
    run.set_state(0.0, &state).expect("a valid state");
    run.start().expect("a consistent start");
    let energy = |x: &[f64]| {
        let parts = evaluate(&linkage.scene, Quantity::Energy, x, &[], &[]);
        [parts[0], parts[0] + parts[1]]
    };
    let (first, mut most, mut scale) = (energy(run.state())[1], 0.0f64, 0.0f64);
    let steps = (until / step).round() as usize;
    for k in 1..=steps {
        run.run(k as f64 * step)
            .unwrap_or_else(|error| panic!("{error}"));
        let [kinetic, whole] = energy(run.state());
        most = most.max((whole - first).abs());
        scale = scale.max(kinetic);
    }
    let x = run.state();
    for what in [Quantity::Constraint, Quantity::ConstraintRate] {
        let rows = evaluate(&linkage.scene, what, x, &[], &[]);
        let left = rows.iter().fold(0.0f64, |m, r| m.max(r.abs()));
        // Also of the rows that are left out.
        assert!(left < 1e-13, "{what:?}: {left:e}");
    }
    most / scale
}

#[test]
fn a_planar_four_bar_of_four_hinges_swings_with_the_order_of_the_method() {
    for components in COMPONENTS {
        let linkage = four_bar(false, true, components);
        let [coarse, fine] = [5e-3, 2.5e-3].map(|h| energy_error(&linkage, &[], h, 1.0));
        let order = (coarse / fine).log2();
        println!("four-bar: {coarse:e}, {fine:e}, order {order}");
        assert!(order > 3.8 && coarse < 1e-5, "{coarse:e} {fine:e}");
    }
}

#[test]
fn an_overconstrained_spatial_loop_of_six_hinges_keeps_its_energy() {
    for components in COMPONENTS {
        let linkage = bricard([0.0, 0.0, -1.0], components);
        let [coarse, fine] = [5e-3, 2.5e-3].map(|h| energy_error(&linkage, &[], h, 1.0));
        let order = (coarse / fine).log2();
        println!("six-bar: {coarse:e}, {fine:e}, order {order}");
        assert!(coarse < 1e-8, "{coarse:e}, order {order}");
    }
}

#[test]
fn a_tumbling_planar_loop_keeps_energy_whatever_way_its_plane_points() {
    let linkage = four_bar(true, false, AngularVelocity::Body);
    // All bodies turn together about an odd axis; the rest is the loop's own motion.
    let mut linkage = linkage;
    let omega = Vector3::new(2.0, 1.0, 1.5);
    for body in &mut linkage.bodies {
        body.omega = omega;
        body.velocity = omega.cross(&body.position);
    }
    let error = energy_error(&linkage, &[], 2e-3, 5.0);
    println!("tumbling four-bar: {error:e}");
    assert!(error < 1e-8, "{error:e}");
}

model! {
    /// A planar four-bar of four parallel hinges: 20 rows of rank 17.
    pub model FourBar<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        world { frame far at [1.9, 0.0, 0.0] m }
        body crank {
            mass: 1.0 kg,
            inertia: diag(0.03, 0.05, 0.06) kg*m^2,
            frame root at [0.0, 0.0, -0.4] m,
            frame tip at [0.0, 0.0, 0.4] m,
        }
        body bar {
            mass: 1.2 kg,
            inertia: diag(0.02, 0.07, 0.06) kg*m^2,
            frame left at [-0.9, 0.0, 0.0] m,
            frame right at [0.9, 0.0, 0.0] m,
        }
        body rocker {
            mass: 1.4 kg,
            inertia: diag(0.03, 0.05, 0.06) kg*m^2,
            frame root at [0.0, 0.0, -0.6] m,
            frame tip at [0.0, 0.0, 0.6] m,
        }
        joint a: hinge from world to crank.root { axis: y }
        joint b: hinge from crank.tip to bar.left { axis: y }
        joint c: hinge from bar.right to rocker.tip { axis: y }
        joint close: hinge from world.far to rocker.root { axis: y }
    }
}

#[test]
fn generated_code_leaves_out_the_rows_that_were_found_when_it_was_made() {
    let model = FourBar::<f64>::new(Default::default()).expect("defaults");
    assert_eq!((model.layout().nc, model.layout().rank()), (20, 17));
    agrees(&model);
    assert!(FourBar::<f64>::explain().contains("`close` repeats rows of `a`, `b`, `c`: 3 of 5"));
}

#[test]
fn welds_that_agree_are_one_weld() {
    let mut linkage = Linkage::new([0.0, 0.0, -9.81], AngularVelocity::Body);
    let body = linkage.body(1.0, [0.1; 3], Vector3::new(1.0, 0.0, 0.0));
    for _ in 0..2 {
        let law = JointLaw::Rigid(Rigid::default());
        linkage.join(law, [None, Some(body)], Vector3::zeros(), Vector3::x());
    }
    assert_eq!(count(&linkage.scene), [12, 6, 0]);
}

/// A Peaucellier linkage, whose tip runs along x = (0.5² − 0.3²)/0.5 = 0.32 m, as it is put with its crank at −20 deg. Where its arms lie on each other,
/// the linkage has one freedom more.
fn peaucellier(coordinates: &str, latch: &str) -> Scene {
    let [arm, side, crank] = [0.5_f64, 0.3, 0.25];
    let angle = 20.0_f64.to_radians();
    let b = [crank + crank * angle.cos(), -crank * angle.sin()];
    let far = b[0].hypot(b[1]);
    let (direction, open) = (
        b[1].atan2(b[0]),
        ((arm * arm + far * far - side * side) / (2.0 * arm * far)).acos(),
    );
    let knee = [1.0, -1.0].map(|s| {
        let angle: f64 = direction + s * open;
        [arm * angle.cos(), arm * angle.sin()]
    });
    let tip = b.map(|x| x * (arm * arm - side * side) / (far * far));
    let bar = |name: &str, mass: f64, [p, q]: [[f64; 2]; 2]| {
        let half = 0.5 * (q[0] - p[0]).hypot(q[1] - p[1]);
        let turn = -(q[1] - p[1]).atan2(q[0] - p[0]);
        let [x, z] = [0, 1].map(|k| 0.5 * (p[k] + q[k]));
        format!(
            "body {name} {{ mass: {mass} kg, inertia: diag(0.01, 0.01, 0.01) kg*m^2,
               frame a at [-{half:?}, 0, 0] m, frame b at [{half:?}, 0, 0] m,
               start at [{x:?}, 0, {z:?}] m rotated rpy(0, {turn:?} rad, 0) }}\n"
        )
    };
    let bodies = [
        bar("crank", 0.2, [[crank, 0.0], b]),
        bar("arm0", 0.5, [[0.0; 2], knee[0]]),
        bar("arm1", 0.5, [[0.0; 2], knee[1]]),
        bar("in0", 0.3, [knee[0], b]),
        bar("in1", 0.3, [knee[1], b]),
        bar("out0", 0.3, [knee[0], tip]),
        bar("out1", 0.3, [knee[1], tip]),
    ];
    read(&format!(
        "model Peaucellier {{ gravity: [0, 0, -9.81] m/s^2; coordinates: {coordinates}; planar: xz;
           world {{ frame o at [0, 0, 0] m, frame c at [{crank}, 0, 0] m }}
           {}
           joint j0: hinge from world.c to crank.a {{ axis: y }}
           joint ja0: hinge from world.o to arm0.a {{ axis: y }}
           joint ja1: hinge from world.o to arm1.a {{ axis: y }}
           joint ji0: hinge from arm0.b to in0.a {{ axis: y }}
           joint ji1: hinge from arm1.b to in1.a {{ axis: y }}
           joint jo0: hinge from arm0.b to out0.a {{ axis: y }}
           joint jo1: hinge from arm1.b to out1.a {{ axis: y }}
           joint k0: hinge from crank.b to in0.b {{ axis: y }}
           joint k1: hinge from crank.b to in1.b {{ axis: y }}
           joint p: hinge from out0.b to out1.b {{ axis: y }}
           {latch}
           output x = out0.b.position.x; }}",
        bodies.concat()
    ))
}

#[test]
fn a_linkage_that_collapses_elsewhere_keeps_all_its_rows_and_draws_its_line() {
    // A latch is one row more for a while, and no reason to look for an assembly that moves while it holds.
    let latch =
        "event cut = time rises 0.2 s { lock: j0 } event go = time rises 0.3 s { free: j0 }";
    for coordinates in ["absolute", "relative"] {
        for latch in ["", latch] {
            let scene = peaucellier(coordinates, latch);
            let lost = Layout::new(&scene).redundancy.lost();
            assert_eq!(lost, 0, "{coordinates} {latch}");
            let model = Generic::<f64>::with_defaults(scene).expect("a valid scene");
            let mut run = Simulation::new(&model, Options::tsit5(1e-9)).expect("options that fit");
            for end in [0.0, 0.1, 0.25, 0.4] {
                run.run(end).expect("a run");
                let mut x = [0.0];
                run.evaluate(Quantity::Outputs, &mut x).expect("outputs");
                assert!((x[0] - 0.32).abs() < 1e-10, "{coordinates} {latch}: {x:?}");
            }
        }
    }
}
