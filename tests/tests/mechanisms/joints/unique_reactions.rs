//! Which components of reactions are one choice of many: those and only those that depend on which joint closes the loop.

use mbd_runtime::{Generic, Options, Simulation};
use mbd_scene::{Ambiguous, Layout, Quantity, Scene};
use tests::declared::read;

/// A declaration with its joints from one of them on, the others behind the last: another joint closes the loop.
fn turned(head: &str, joints: &[&str], first: usize, coordinates: &str) -> Scene {
    let joints: Vec<&str> = (0..joints.len())
        .map(|k| joints[(k + first) % joints.len()])
        .collect();
    read(&format!(
        "model S {{ coordinates: {coordinates}; {head} {} }}",
        joints.join("\n")
    ))
}

/// The ambiguous components of each joint, by name.
fn told(scene: &Scene) -> Vec<(&str, Vec<&'static str>)> {
    let named = |of: &Ambiguous| (scene.joints[of.joint].name.as_str(), of.named());
    let mut told: Vec<_> = Layout::new(scene)
        .redundancy
        .ambiguous
        .iter()
        .map(named)
        .collect();
    told.sort_unstable();
    told
}

/// The reactions of each joint at a time, by name.
fn reactions(scene: &Scene, time: f64) -> Vec<(String, [f64; 6])> {
    let model = Generic::<f64>::with_defaults(scene.clone()).expect("a valid scene");
    let mut run = Simulation::new(&model, Options::tsit5(1e-11)).expect("options that fit");
    run.run(time).expect("a run");
    let mut all = vec![0.0; 6 * scene.joints.len()];
    run.evaluate(Quantity::Reactions, &mut all)
        .expect("reactions");
    let each = scene.joints.iter().zip(all.chunks(6));
    let each = each.map(|(joint, own)| (joint.name.clone(), std::array::from_fn(|k| own[k])));
    let mut each: Vec<(String, [f64; 6])> = each.collect();
    each.sort_by(|(a, _), (b, _)| a.cmp(b));
    each
}

/// Whatever joint closes the loop, the same components are told, and they are those that differ.
fn check(head: &str, joints: &[&str], time: f64) -> Vec<(String, Vec<&'static str>)> {
    let mut first: Option<Vec<(String, Vec<&'static str>)>> = None;
    let mut runs = Vec::new();
    for coordinates in ["absolute", "relative"] {
        for k in 0..joints.len() {
            let scene = turned(head, joints, k, coordinates);
            let own = told(&scene)
                .into_iter()
                .map(|(name, of)| (name.to_string(), of))
                .collect();
            let first = first.get_or_insert_with(|| Vec::clone(&own));
            assert_eq!(*first, own, "{coordinates}, from joint {k} on");
            runs.push(reactions(&scene, time));
        }
    }
    let first = first.unwrap_or_default();
    const NAMES: [&str; 6] = [
        "force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z",
    ];
    for (joint, (name, _)) in runs[0].iter().enumerate() {
        let of_many = first.iter().find(|(own, _)| own == name);
        for (k, component) in NAMES.iter().enumerate() {
            let values = runs.iter().map(|run| run[joint].1[k]);
            let [low, high] = [f64::min, f64::max].map(|choose| values.clone().reduce(choose));
            let spread = high.unwrap_or(0.0) - low.unwrap_or(0.0);
            let ambiguous = of_many.is_some_and(|(_, of)| of.contains(component));
            println!("{name}.{component}: spread {spread:e}, ambiguous {ambiguous}");
            assert!(
                ambiguous == (spread > 1e-6),
                "{name}.{component}: {spread:e} {ambiguous}"
            );
        }
    }
    first
}

const CRANK: &str = "gravity: [0, 0.5, -9.81] m/s^2;
    body crank { mass: 4 kg, inertia: diag(0.04, 0.06, 0.04) kg*m^2, frame axle at [0, 0, 0] m, frame throw at [0, 3 cm, 4 cm], center_of_mass: [0, 1 cm, -5 mm] }
    body rod { mass: 0.45 kg, inertia: diag(0.0012, 0.0012, 0.0001) kg*m^2, center_of_mass: [0, 2 mm, 45 mm], frame big at [0, 0, 0] m, frame small at [0, 1 cm, 14 cm] }
    body piston { mass: 0.38 kg, inertia: diag(0.0003, 0.0003, 0.0003) kg*m^2 }
    world { frame bore at [0, 4 cm, 0] }";
const CRANK_JOINTS: [&str; 4] = [
    "joint main: hinge from world to crank.axle { axis: y, start: 10 deg, start_rate: 100 rad/s }",
    "joint big: hinge from crank.throw to rod.big { axis: y, start: about -13 deg }",
    "joint small: hinge from rod.small to piston { axis: y, start: about 3 deg }",
    "joint bore: prismatic from world.bore to piston { axis: z, start: about 178 mm }",
];

#[test]
fn a_slider_crank_of_hinges_pushes_in_its_plane_as_the_laws_of_newton_and_euler_say() {
    let across = vec!["force.y", "torque.x", "torque.z"];
    let found = check(CRANK, &CRANK_JOINTS, 0.013);
    let want = ["big", "bore", "main", "small"].map(|name| (name.to_string(), across.clone()));
    assert_eq!(found, want);
    // The rod about its big end, with what accelerates the piston along the bore at its small end, by hand.
    let (r, l, c) = (0.04, 0.14, 0.045);
    for coordinates in ["absolute", "relative"] {
        let scene = read(&format!(
            "model S {{ coordinates: {coordinates}; {CRANK} {} output angle = main.angle; output rate = main.angle_rate;
               output curve = main.angle_acceleration; output side = bore.force.x; output unsure = bore.force.y; output all = bore.force - [1 N, 0, 0]; }}",
            CRANK_JOINTS.join("\n"),
        ));
        let layout = Layout::new(&scene);
        let asked = |output: usize, component| {
            !scene
                .ambiguous_reactions(&layout, &scene.outputs[output].value, component)
                .is_empty()
        };
        assert_eq!(
            [asked(3, None), asked(4, None), asked(5, None)],
            [false, true, true]
        );
        assert_eq!([0, 1, 2].map(|k| asked(5, Some(k))), [false, true, false]);
        let model = Generic::<f64>::with_defaults(scene).expect("a valid scene");
        let mut run = Simulation::new(&model, Options::tsit5(1e-11)).expect("options that fit");
        run.run(0.013).expect("a run");
        let mut out = vec![0.0; 8];
        run.evaluate(Quantity::Outputs, &mut out).expect("outputs");
        let [a, w, e, side] = [out[0], out[1], out[2], out[3]];
        // r sin a + l sin b = 0, twice derived.
        let b = (-r * a.sin() / l).asin();
        let wb = -r * a.cos() * w / (l * b.cos());
        let eb = (r * a.sin() * w * w - r * a.cos() * e + l * b.sin() * wb * wb) / (l * b.cos());
        let second = |length: f64, angle: f64, rate: f64, curve: f64| {
            let (s, c) = angle.sin_cos();
            [
                length * (c * curve - s * rate * rate),
                length * (-s * curve - c * rate * rate),
            ]
        };
        let [big, com, small] = [
            second(r, a, w, e),
            second(c, b, wb, eb),
            second(l, b, wb, eb),
        ];
        let piston = big[1] + small[1];
        let along = 0.38 * (piston + 9.81);
        let [x, z] = [0.45 * (big[0] + com[0]), 0.45 * (big[1] + com[1] + 9.81)];
        let moment = 0.0012 * eb + c * (b.cos() * x - b.sin() * z);
        let want = (moment - l * b.sin() * along) / (l * b.cos());
        println!(
            "{coordinates}: side {side}, by hand {want}, off {:e}",
            side - want
        );
        assert!((side - want).abs() < 1e-7 * want.abs(), "{side} {want}");
    }
}

#[test]
fn what_is_zero_by_accident_of_a_param_of_time_or_of_the_place_is_not_unique() {
    let wanted = |components: &[&'static str]| {
        ["big", "bore", "main", "small"].map(|name| (name, components.to_vec()))
    };
    // The plane of the crank stands across y, with the param at its default and at the start.
    for (param, angle) in [("param tilt = 0 deg;", "tilt"), ("", "0.1 rad/s * time")] {
        let ground = format!(
            "frame bore at [-4 cm * sin({angle}), 4 cm * cos({angle}), 0] rotated rpy(0, 0, {angle}), frame hub at [0, 0, 0] m rotated rpy(0, 0, {angle})"
        );
        let head = CRANK.replace("frame bore at [0, 4 cm, 0]", &ground);
        let joints = CRANK_JOINTS.map(|joint| joint.replace("from world to", "from world.hub to"));
        let joints: Vec<&str> = joints.iter().map(String::as_str).collect();
        let scene = turned(&format!("{param} {head}"), &joints, 0, "absolute");
        let want = wanted(&["force.x", "force.y", "torque.x", "torque.y", "torque.z"]);
        assert_eq!(told(&scene), want, "{angle}");
    }
    // A param that turns nothing changes nothing.
    let head = format!("param scale = 1 in 0.5 ..= 2; {CRANK}");
    let scene = turned(&head, &CRANK_JOINTS, 0, "relative");
    assert_eq!(told(&scene), wanted(&["force.y", "torque.x", "torque.z"]));
    // On a block that flies.
    let head = CRANK.replace(
        "world {",
        "body block { mass: 9 kg, inertia: diag(1, 1, 1) kg*m^2,",
    );
    let joints = CRANK_JOINTS.map(|joint| joint.replace("from world", "from block"));
    let joints: Vec<&str> = joints.iter().map(String::as_str).collect();
    let scene = turned(
        &format!("{head} joint fly: free from world to block"),
        &joints,
        0,
        "relative",
    );
    let all = [
        "force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z",
    ];
    assert_eq!(told(&scene), wanted(&all));
}

#[test]
fn a_beam_on_three_supports_is_told_along_them_alone() {
    let head = "gravity: [1, 0, -9.81] m/s^2;
        body beam { mass: 2 kg, inertia: diag(0.1, 0.7, 0.7) kg*m^2, frame l at [-1, 0, 0] m, frame m at [0.2, 0, 0] m, frame r at [1, 0, 0] m }
        world { frame l at [-1, 0, 0] m, frame m at [0.2, 0, 0] m, frame r at [1, 0, 0] m }";
    let joints = [
        "joint jl: hinge from world.l to beam.l { axis: y }",
        "joint jm: point_on_plane from world.m to beam.m { axis: z }",
        "joint jr: point_on_plane from world.r to beam.r { axis: z }",
    ];
    let found = check(head, &joints, 0.0);
    let want = ["jl", "jm", "jr"].map(|name| (name.to_string(), vec!["force.z"]));
    assert_eq!(found, want);
}
