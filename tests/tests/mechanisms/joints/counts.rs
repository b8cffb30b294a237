//! What a system of joints costs: the order of elimination is found, growth is linear, nothing absent is paid for.

use mbd_compiler::{Kernels, SceneEquations};
use mbd_scene::joints::{
    Axis, ConstantVelocity, Cylindrical, Distance, Hinge, JointForces, JointLaw, Planar, Prismatic,
    Screw, Spherical, Universal,
};
use mbd_scene::{AngularVelocity, Coordinates, Layout, Place, Plane, Quantity, Scene};
use nalgebra::{Matrix3, Vector3};
use tests::linkage::cranks;
use tests::mechanism::{add_body, add_frame, add_gear, add_joint, empty, frame, hinged_anyhow};

/// A slender rod of 1 m along z.
fn rod(scene: &mut Scene) -> (usize, Place, Place) {
    let inertia = Matrix3::from_diagonal(&Vector3::new(0.085, 0.085, 0.001));
    let body = add_body(scene, 1.0, &inertia);
    let top = add_frame(scene, Some(body), frame("top", [0.0, 0.0, 0.5], None));
    let end = add_frame(scene, Some(body), frame("end", [0.0, 0.0, -0.5], None));
    (body, top, end)
}

fn hinge(axis: Axis) -> JointLaw {
    JointLaw::Hinge(Hinge { axis })
}

/// Rods hinged one below the other about y, x, y, x, …; closed to the world at the end if asked.
fn chain(n: usize, closed: bool) -> Scene {
    let mut scene = empty([0.0, 0.0, -9.81], AngularVelocity::Body);
    let mut from = Place::World(0);
    for index in 0..n {
        let (_, top, end) = rod(&mut scene);
        let axis = if index % 2 == 0 { Axis::Y } else { Axis::X };
        add_joint(&mut scene, hinge(axis), from, top);
        from = end;
    }
    if closed {
        let spherical = JointLaw::Spherical(Spherical::default());
        add_joint(&mut scene, spherical, from, Place::World(0));
    }
    scene
}

/// A free hub with arms around it.
fn hub(arms: usize) -> Scene {
    let mut scene = empty([0.0, 0.0, -9.81], AngularVelocity::Body);
    let hub = add_body(&mut scene, 5.0, &Matrix3::identity());
    for arm in 0..arms {
        let angle = arm as f64 * std::f64::consts::TAU / arms as f64;
        let at = [angle.cos(), angle.sin(), 0.0];
        let place = add_frame(&mut scene, Some(hub), frame(&format!("arm{arm}"), at, None));
        let (_, top, _) = rod(&mut scene);
        add_joint(&mut scene, hinge(Axis::Y), place, top);
    }
    scene
}

/// A binary tree of rods hanging from the world.
fn tree(n: usize) -> Scene {
    let mut scene = empty([0.0, 0.0, -9.81], AngularVelocity::Body);
    let mut ends = vec![Place::World(0)];
    for index in 0..n {
        let (_, top, end) = rod(&mut scene);
        let axis = if index % 2 == 0 { Axis::Y } else { Axis::X };
        add_joint(&mut scene, hinge(axis), ends[index.div_ceil(2)], top);
        ends.push(end);
    }
    scene
}

/// Bodies on massless rods, one below the other.
fn of_distances(n: usize) -> Scene {
    let mut scene = empty([0.0, 0.0, -9.81], AngularVelocity::Body);
    let mut from = Place::World(0);
    for _ in 0..n {
        let (_, top, end) = rod(&mut scene);
        let rod = JointLaw::Distance(Distance { length: 0.9.into() });
        add_joint(&mut scene, rod, from, top);
        from = end;
    }
    scene
}

fn cost(scene: &Scene, what: Quantity) -> usize {
    let equations = SceneEquations::trace_only(scene, &[what]);
    equations.program(what).expect("traced").cost().total()
}

/// Operations of filling, factorising and solving the system, given the rows: without the margin, two a row.
fn solving(scene: &Scene) -> usize {
    let margin = 2 * Layout::new(scene).rank();
    cost(scene, Quantity::ProjectionStep) - cost(scene, Quantity::ConstraintJacobian) - margin
}

#[test]
fn an_open_chain_costs_the_same_for_every_further_body() {
    let whole = |n| cost(&chain(n, false), Quantity::Derivative);
    let [four, eight, sixteen, many] = [4, 8, 16, 64].map(whole);
    assert_eq!(sixteen - eight, 2 * (eight - four), "linear in n");
    assert_eq!(many - sixteen, 12 * (eight - four), "linear in n");
    assert!(many <= 520 * 64, "{many}: kinematics, rows, system and all");
    assert!(solving(&chain(16, false)) <= 310 * 16);
}

/// Rods joined one below the other, axes in turn about y and x; of every joint these coordinates are driven.
fn chain_of(n: usize, law: impl Fn(Axis) -> JointLaw, motors: &[usize]) -> Scene {
    let mut scene = empty([0.0, 0.0, -9.81], AngularVelocity::Body);
    let mut from = Place::World(0);
    for index in 0..n {
        let (_, top, end) = rod(&mut scene);
        let axis = if index % 2 == 0 { Axis::Y } else { Axis::X };
        add_joint(&mut scene, law(axis), from, top);
        let driven = motors.iter().map(|&coordinate| JointForces {
            coordinate,
            motor: Some(0.3.into()),
            ..JointForces::default()
        });
        scene.joints[index].forces.extend(driven);
        from = end;
    }
    scene
}

fn prismatic(axis: Axis) -> JointLaw {
    JointLaw::Prismatic(Prismatic { axis })
}

fn cylindrical(axis: Axis) -> JointLaw {
    JointLaw::Cylindrical(Cylindrical { axis })
}

fn table(axis: Axis) -> JointLaw {
    JointLaw::Planar(Planar { axis })
}

fn screw(axis: Axis) -> JointLaw {
    let pitch = 0.1.into();
    JointLaw::Screw(Screw { axis, pitch })
}

fn skew(axis: Axis) -> JointLaw {
    let [x, y, _] = axis.0;
    hinge(Axis::new([0.2 + 0.1 * x, 0.3 + 0.2 * y, 0.9]).expect("not zero"))
}

fn ball(_: Axis) -> JointLaw {
    JointLaw::Spherical(Spherical::default())
}

fn cardan(_: Axis) -> JointLaw {
    JointLaw::Universal(Universal::default())
}

fn telescope(axis: Axis) -> JointLaw {
    if axis == Axis::Y {
        hinge(axis)
    } else {
        prismatic(axis)
    }
}

fn drive_shaft(_: Axis) -> JointLaw {
    JointLaw::ConstantVelocity(ConstantVelocity::default())
}

/// A joint by its axis.
type Kind = fn(Axis) -> JointLaw;

/// Joints, their driven coordinates, and the operations of a state derivative that a body of a chain of 16 may cost.
const CHAINS: [(&str, Kind, &[usize], usize); 16] = [
    ("hinge", hinge, &[], 460),
    ("hinge about a skew axis", skew, &[], 525),
    ("hinge, driven", hinge, &[0], 255),
    ("spherical", ball, &[], 255),
    ("universal", cardan, &[], 470),
    ("universal, first angle driven", cardan, &[0], 505),
    ("universal, driven", cardan, &[0, 1], 300),
    ("prismatic", prismatic, &[], 450),
    ("hinge and prismatic in turn", telescope, &[], 515),
    ("prismatic, driven", prismatic, &[0], 330),
    ("cylindrical", cylindrical, &[], 630),
    ("cylindrical, angle driven", cylindrical, &[1], 410),
    ("planar", table, &[], 450),
    ("planar, angle driven", table, &[2], 510),
    ("screw", screw, &[], 685),
    ("constant velocity", drive_shaft, &[], 595),
];

#[test]
fn chains_of_joints_that_hold_more_cost_no_more_than_hinges() {
    for (name, law, motors, most) in CHAINS {
        let scene = chain_of(16, law, motors);
        let body = cost(&scene, Quantity::Derivative) / 16;
        println!("{name}: {body} operations a body");
        assert!(body <= most, "{name}: {body} operations a body");
    }
}

#[test]
fn a_train_of_gears_costs_the_same_for_every_further_wheel() {
    let train = |n: usize| {
        let mut scene = empty([0.0, 0.0, -9.81], AngularVelocity::Body);
        for wheel in 0..n {
            let (_, top, _) = rod(&mut scene);
            add_joint(&mut scene, hinge(Axis::Y), Place::World(0), top);
            if let Some(before) = wheel.checked_sub(1) {
                let joints = scene.joints.len();
                let leader = if before == 0 { 0 } else { joints - 3 };
                add_gear(
                    &mut scene,
                    [(joints - 1, 0), (leader, 0)],
                    (-1.5).into(),
                    0.1,
                );
            }
        }
        scene
    };
    let whole = |n| cost(&train(n), Quantity::Derivative);
    let [four, eight, sixteen] = [4, 8, 16].map(whole);
    println!("gears: {four}, {eight}, {sixteen} operations");
    assert_eq!(sixteen - eight, 2 * (eight - four), "linear in n");
    assert!(sixteen <= 205 * 16, "{sixteen}");
}

#[test]
fn the_cheap_order_of_elimination_is_found() {
    let choice = |scene: &Scene| {
        let candidates = Layout::new(scene).elimination.order.candidates;
        let cheapest = candidates.iter().min().copied();
        candidates.iter().position(|&cost| Some(cost) == cheapest)
    };
    let articulated = Some(2);
    assert_eq!(choice(&chain(8, false)), articulated);
    assert_eq!(choice(&chain(8, true)), articulated);
    assert_eq!(choice(&hub(11)), articulated);
    assert_eq!(choice(&tree(15)), articulated);
    let rods = of_distances(8);
    assert_ne!(choice(&rods), articulated, "nothing carries these bodies");
    assert!(cost(&chain(8, true), Quantity::Derivative) <= 4_600);
    assert!(cost(&hub(11), Quantity::Derivative) <= 5_250);
    assert!(cost(&tree(15), Quantity::Derivative) <= 6_400);
}

#[test]
fn a_joint_pays_for_nothing_it_does_not_need() {
    let swing = |arm: [f64; 3], law: JointLaw| {
        let mut scene = empty([0.0, 0.0, -9.81], AngularVelocity::Body);
        let body = add_body(&mut scene, 1.0, &Matrix3::identity());
        let place = add_frame(&mut scene, Some(body), frame("pivot", arm, None));
        add_joint(&mut scene, law, Place::World(0), place);
        cost(&scene, Quantity::Derivative)
    };
    let odd = Axis::new([0.2, 0.3, 0.9]).expect("not zero");
    let (aligned, tilted) = (
        swing([0.0, 0.0, 0.5], hinge(Axis::Y)),
        swing([0.0, 0.0, 0.5], hinge(odd)),
    );
    // An axis off those of the body costs its direction and the elements that are no longer zero.
    assert!(
        aligned <= 120 && aligned + 40 < tilted && tilted <= 175,
        "{aligned} aligned, {tilted} tilted"
    );
    let spherical = || JointLaw::Spherical(Spherical::default());
    let (none, one, three) = (
        swing([0.0; 3], spherical()),
        swing([0.0, 0.0, 0.5], spherical()),
        swing([0.1, 0.2, 0.5], spherical()),
    );
    assert!(none < one && one < three, "{none} {one} {three}");
}

/// Operations of every function a model of this scene would have; those alike count once.
fn functions(scene: &Scene) -> Vec<usize> {
    let equations = SceneEquations::trace(scene);
    Kernels::of(&equations).lengths(&equations)
}

#[test]
fn no_function_is_longer_than_a_thousand_operations() {
    let chains = [2, 4, 8, 16, 32, 64, 128].map(|n| chain(n, false));
    let others = [chain(8, true), hub(11), tree(15)];
    let anyhow = [2, 4, 8, 16, 32, 64].map(hinged_anyhow);
    let absolute: Vec<Scene> = chains.into_iter().chain(others).chain(anyhow).collect();
    let relative = absolute
        .iter()
        .map(|scene| scene.in_coordinates(Coordinates::Relative));
    for scene in absolute.iter().cloned().chain(relative) {
        let longest = functions(&scene).into_iter().max();
        assert!(
            longest <= Some(1_000),
            "{} bodies: {longest:?}",
            scene.bodies.len()
        );
    }
}

#[test]
fn bodies_alike_share_their_functions() {
    let emitted = |n: usize| functions(&chain(n, false)).iter().sum::<usize>();
    let (eight, many) = (emitted(8), emitted(64));
    assert!(
        many <= 2 * eight,
        "{eight} operations emitted for 8 bodies, {many} for 64"
    );
}

#[test]
fn four_bars_in_a_plane_cost_a_fifth_of_those_in_space_and_grow_with_their_number() {
    let costs = |n: usize| {
        let joined: Vec<[usize; 2]> = (0..n).map(|k| [n + 1 + k, n + 2 + k]).collect();
        let bars: Vec<&[usize]> = joined.iter().map(|bar| bar.as_slice()).collect();
        let space = cranks(n + 1, &bars, 1.2, -1.0, 9.81).scene;
        let flat = Scene {
            planar: Some(Plane::Xy),
            ..space.clone()
        };
        let layout = Layout::new(&flat);
        // Two bodies and a pin on the ground, a crank and two pins for every further window.
        assert_eq!([layout.nv, layout.nc], [6 * n + 3, 6 * n + 2]);
        assert_eq!((layout.rank(), layout.freedoms()), (layout.nc, 1));
        [flat, space].map(|scene| {
            [Quantity::Derivative, Quantity::ProjectionStep].map(|what| cost(&scene, what))
        })
    };
    let [flat, space] = costs(1);
    println!("one: {flat:?}, in space {space:?}");
    assert!(
        3 * flat[0] < space[0] && 3 * flat[1] < space[1],
        "{flat:?} {space:?}"
    );
    let [many, of_space] = costs(10);
    println!("ten: {many:?}, in space {of_space:?}");
    assert!(
        many[0] <= 12 * flat[0] && many[1] <= 12 * flat[1],
        "{many:?}"
    );
    assert!(3 * many[0] < of_space[0], "{many:?} {of_space:?}");
}

#[test]
fn a_free_joint_costs_nothing() {
    let mut scene = empty([0.0, 0.0, -9.81], AngularVelocity::Body);
    let (body, ..) = rod(&mut scene);
    let alone = cost(&scene, Quantity::Derivative);
    let free = JointLaw::Free(Default::default());
    add_joint(&mut scene, free, Place::World(0), Place::Body(body, 0));
    assert_eq!(cost(&scene, Quantity::Derivative), alone);
}
