//! What the compiler chooses (`planar: auto`, `coordinates: auto`) moves as what is declared.

use mbd_compiler::{Interpreted, read_text};
use mbd_runtime::{Model, Options, Simulation};
use mbd_scene::Quantity;

/// The outputs at an instant, of the scene with these settings, and its numbers of speeds.
fn outputs(text: &str, settings: &str, until: f64) -> (Vec<f64>, usize) {
    let text = text.replace("SETTINGS", settings);
    let reading = read_text(&text);
    let scene = reading
        .scene
        .unwrap_or_else(|| panic!("{:?}", reading.errors));
    let model = Interpreted::<f64>::new(scene, &[]).expect("no params");
    let mut run = Simulation::new(&model, Options::vern7(1e-11)).expect("a model that runs");
    run.run(until)
        .unwrap_or_else(|error| panic!("{settings}: {error}"));
    let mut out = vec![0.0; model.layout().len(Quantity::Outputs)];
    run.evaluate(Quantity::Outputs, &mut out).expect("outputs");
    (out, model.layout().nv)
}

/// Every choice against space and absolute coordinates; `speeds` are those of the last choice.
fn moves_alike(text: &str, until: f64, speeds: [usize; 2]) {
    let (expected, all) = outputs(text, "", until);
    for settings in [
        "planar: auto;",
        "coordinates: auto;",
        "planar: auto; coordinates: relative;",
        "planar: auto; coordinates: auto;",
    ] {
        let (found, left) = outputs(text, settings, until);
        let largest = expected.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
        let off = expected.iter().zip(&found).map(|(a, b)| (a - b).abs());
        let off = off.fold(0.0_f64, f64::max) / largest;
        println!("{settings} {left} of {all} speeds: {off:e}");
        assert!(off < 1e-8, "{settings} {expected:?} {found:?}");
        assert!(left <= all);
    }
    let (_, left) = outputs(text, "planar: auto; coordinates: auto;", until);
    assert_eq!([all, left], speeds);
}

#[test]
fn bars_and_what_hangs_on_them_move_in_the_plane_as_in_space() {
    let text = "model Bars { SETTINGS gravity: [0.0, 0.0, -9.81] m/s^2;
        world { frame left at [0.0, 0.1, 0.0] m, frame right at [1.0 m, 0.0 m, 0.05 m * sin(time * 3 rad/s)] }
        body crank { mass: 1 kg, inertia: diag(0.03, 0.04, 0.05) kg*m^2, frame a at [-0.15, 0.1, 0.0] m, frame b at [0.15, 0.0, 0.0] m }
        body rod { mass: 2 kg, inertia: diag(0.13, 0.12, 0.11) kg*m^2, frame a at [-0.45, 0.0, 0.05] m, frame b at [0.45, 0.0, 0.05] m }
        body rocker { mass: 1.5 kg, inertia: diag(0.08, 0.09, 0.1) kg*m^2, frame a at [-0.4, 0.0, 0.0] m, frame b at [0.4, 0.0, 0.0] m }
        body plate { mass: 0.4 kg, inertia: diag(0.01, 0.02, 0.01) kg*m^2, frame eye at [0.0, 0.0, 0.1] m, start at [1.2, 0.0, 0.1] m }
        joint one: hinge from world.left to crank.a { axis: y, start: -60 deg, damping: 0.2 N*m*s/rad }
        joint two: hinge from crank.b to rod.a { axis: y }
        joint three: hinge from rod.b to rocker.b { axis: y }
        joint four: hinge from world.right to rocker.a { axis: y }
        joint afloat: free from world to plate.com;
        spring cord from rocker.b to plate.eye { free_length: 0.4 m, stiffness: 30 N/m, damping: 1 N*s/m }
        load side on rod = [0.0, 3.0, 0.0] N;
        output place = plate.position; output angle = one.angle; output turned = three.angle_rate;
        output pull = cord.tension; output held = two.force.z; output all = energy.total; }";
    moves_alike(text, 1.5, [24, 6]);
}

#[test]
fn bodies_on_their_centres_of_mass_move_as_points() {
    let text = "model Stones { SETTINGS gravity: [0.0, 0.0, -9.81] m/s^2;
        body upper { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, start at [0.2, 0.1, -1] m }
        body lower { mass: 2 kg, inertia: diag(0.1, 0.2, 0.15) kg*m^2, start at [0.1, 0, -2] m velocity [0, 1, 0] m/s }
        joint afloat: free from world to upper.com;
        joint swims: free from world to lower.com;
        spring cord from world to upper.com { free_length: 1 m, stiffness: 20 N/m }
        spring below from upper.com to lower.com { free_length: 1 m, stiffness: 20 N/m }
        load air on lower = -0.1 N*s/m * lower.velocity;
        output a = upper.com.position; output b = lower.velocity; output all = energy.total; }";
    moves_alike(text, 1.5, [12, 6]);
}
