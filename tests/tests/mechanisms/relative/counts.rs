//! What relative coordinates cost: operations of a chain, in the order of the best generated code known, and linear in its length.

use mbd_compiler::SceneEquations;
use mbd_scene::joints::{Axis, Hinge, JointLaw, Rigid};
use mbd_scene::{AngularVelocity, Coordinates, Place, Quantity, Scene};
use nalgebra::{Matrix3, Vector3};
use tests::declared::read;
use tests::mechanism::{add_body, add_frame, add_joint, empty, frame, hinged_anyhow};
use tests::reference::load;
use tests::system::scene;

/// Slender rods of 0.3 m hinged one below the other about y, x, y, x, ….
fn chain(n: usize) -> Scene {
    hinged(n, [Axis::Y, Axis::X])
}

/// The same about these axes in turn.
fn hinged(n: usize, axes: [Axis; 2]) -> Scene {
    let mut scene = empty([0.0, 0.0, -9.81], AngularVelocity::Body);
    let inertia = Matrix3::from_diagonal(&Vector3::new(0.0076, 0.0076, 0.0002));
    let mut from = Place::World(0);
    for index in 0..n {
        let body = add_body(&mut scene, 1.0, &inertia);
        let [top, end] = [0.15, -0.15]
            .map(|z| add_frame(&mut scene, Some(body), frame("end", [0.0, 0.0, z], None)));
        let axis = axes[index % 2];
        add_joint(&mut scene, JointLaw::Hinge(Hinge { axis }), from, top);
        from = end;
    }
    scene.in_coordinates(Coordinates::Relative)
}

/// Bodies of any inertia hinged on one another anywhere, about any axis.
fn general(n: usize) -> Scene {
    hinged_anyhow(n).in_coordinates(Coordinates::Relative)
}

/// Operations of a quantity.
pub fn operations(scene: &Scene, what: Quantity) -> usize {
    let equations = SceneEquations::trace_only(scene, &[what]);
    equations.program(what).expect("a program").cost().total()
}

#[test]
fn a_chain_takes_as_few_operations_as_the_best_generated_code() {
    // Traced recursions in C: 1,391 for eight, 9,035 for thirty-two.
    let count = |n| operations(&chain(n), Quantity::Derivative);
    let [eight, sixteen, long] = [8, 16, 32].map(count);
    assert!(eight <= 1_201, "{eight}");
    assert!(sixteen <= 3_698, "{sixteen}");
    assert!(long <= 8_066, "{long}");
    let longer = count(64);
    assert!(
        longer < 2 * long + long / 10,
        "{longer} grows faster than the chain, {long} for half of it"
    );
}

#[test]
fn a_chain_about_parallel_axes_takes_fewer_operations_a_body_than_the_best_generated_code() {
    // Traced articulated bodies in C: 294 a body.
    for n in [8, 16, 32, 64] {
        let count = operations(&hinged(n, [Axis::Y; 2]), Quantity::Derivative);
        println!("{n} rods: {count}, {} a body", count / n);
        assert!(count <= 294 * n, "{n}: {count}");
    }
}

#[test]
fn a_robot_takes_fewer_operations_than_the_best_generated_code() {
    // Traced recursions in C: the whole, inverse dynamics, bias, mass matrix.
    let file = load("robots/robot_panda.json");
    let mut panda = scene(&file["system"], AngularVelocity::Body);
    // Of seven joints: the fingers stay where they are.
    let slides = |law: &JointLaw| matches!(law, JointLaw::Prismatic(_));
    for joint in panda.joints.iter_mut().filter(|joint| slides(&joint.law)) {
        joint.law = JointLaw::Rigid(Rigid {});
    }
    let panda = panda.in_coordinates(Coordinates::Relative);
    for (what, best, own) in [
        (Quantity::Derivative, 1_469, 1_230),
        (Quantity::InverseDynamics, 798, 632),
        (Quantity::BiasForce, 776, 606),
        (Quantity::MassMatrix, 464, 408),
    ] {
        let count = operations(&panda, what);
        assert!(count <= own && own < best, "{what:?}: {count}");
    }
}

#[test]
fn links_that_lie_anyhow_take_little_more_than_links_along_each_other() {
    let count = |n| operations(&general(n), Quantity::Derivative);
    let [eight, long] = [8, 32].map(count);
    assert!(eight <= 2_760, "{eight}");
    assert!(long <= 14_800, "{long}");
}

#[test]
fn mass_matrix_and_bias_of_a_chain_take_fewer_operations_than_a_traced_recursion() {
    // Traced: 738, 1,267, 3,816 and 12,006.
    for (links, most) in [(6, 551), (8, 905), (16, 2_935), (32, 9_870)] {
        let scene = chain(links);
        let both = [Quantity::MassMatrix, Quantity::BiasForce].map(|what| operations(&scene, what));
        let both: usize = both.into_iter().sum();
        println!("{links} links: {both}");
        assert!(both <= most, "{links}: {both}");
    }
}

/// Rods hinged about these axes in turn, their mass, moments and length told by `rod`, with the frames of its joints.
fn rods(n: usize, axes: &[&str], params: &str, rod: &str) -> Scene {
    let mut text =
        format!("model Chain {{ coordinates: relative; gravity: [0.0, 0.0, -9.81] m/s^2; {params}");
    let mut from = "world".to_owned();
    for (index, axis) in (0..n).zip(axes.iter().cycle()) {
        text += &format!(
            "body rod{index} {{ {rod} }}
             joint pin{index}: hinge from {from} to rod{index}.top {{ axis: {axis} }}"
        );
        from = format!("rod{index}.end");
    }
    read(&(text + "}"))
}

#[test]
fn live_parameters_cost_a_derivative_no_more_than_numbers() {
    let live = "param mass = 1 kg; param length = 0.3 m; param across = 0.0076 kg*m^2; param along = 0.0002 kg*m^2;";
    let of_live = "mass: mass, inertia: [across, across, along],
        frame top at [0 m, 0 m, 0.5 * length], frame end at [0 m, 0 m, -0.5 * length]";
    let of_numbers = "mass: 1 kg, inertia: diag(0.0076, 0.0076, 0.0002) kg*m^2,
        frame top at [0, 0, 0.15] m, frame end at [0, 0, -0.15] m";
    for axes in [
        &["y"][..],
        &["y", "x"],
        &["[0.6, 0.0, 0.8]", "[0.0, 0.6, 0.8]"],
    ] {
        for n in [2, 8, 32] {
            let count = |params: &str, rod: &str| {
                operations(&rods(n, axes, params, rod), Quantity::Derivative) as f64
            };
            let (numbers, live) = (count("", of_numbers), count(live, of_live));
            println!("{n} rods about {axes:?}: {live} over {numbers}");
            assert!(live <= 1.3 * numbers, "{n} {axes:?}: {live} over {numbers}");
        }
    }
}
