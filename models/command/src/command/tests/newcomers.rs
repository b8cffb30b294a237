//! Scenes as a newcomer writes them from the pages alone: they run, and what was mistaken at first is answered with what to write.

use std::f64::consts::{PI, TAU};

use super::*;

/// A scene, and of its lines what stood there first, with what was said of it.
type Scene = (&'static str, &'static str, &'static [Mistake]);
/// What to write, what was written, what is said.
type Mistake = (&'static str, &'static str, &'static str);

const SCENES: [Scene; 20] = [
    (
        "winch.mbd",
        include_str!("../../../../../tests/newcomers/winch.mbd"),
        &[
            (
                "    body rotor {",
                "    world { frame top at [0, 0, 11] m }\n    body rotor {",
                "all frames of the world stand in one `world { … }`",
            ),
            (
                "param payload =",
                "param payload[i in 0..2] =",
                "a `param` has no index: write `param payload`",
            ),
            (
                "param R = 0.4 ohm;",
                "param R = 0.4 ohm;\n    param in = 2 m;",
                "`in` is a word of the language",
            ),
        ],
    ),
    (
        "booms.mbd",
        include_str!("../../../../../tests/newcomers/booms.mbd"),
        &[
            (
                "diag(0.03, 0.03, 0.05)",
                "diag(0.02, 0.02, 0.05)",
                "no rigid body has these principal moments",
            ),
            (
                "    event release",
                "    spring hold on deploy[0].angle { stiffness: 2 N*m/rad }\n    event release",
                "what acts along a coordinate of `deploy` are fields of that joint",
            ),
        ],
    ),
    (
        "door_closer.mbd",
        include_str!("../../../../../tests/newcomers/door_closer.mbd"),
        &[
            (
                "] m, frame bracket",
                "] m; frame bracket",
                "separated by `,`",
            ),
            (
                "free_length: 0.1 m",
                "length: 0.1 m",
                "here it is called `free_length`",
            ),
            (
                "        friction_rate: 0.1 rad/s,\n",
                "",
                "add `friction_rate: 1.0 rad/s`",
            ),
            (
                "output turned",
                "output time",
                "`time` is a word of the language",
            ),
            (
                "\"10 s\"",
                "10 s",
                "write a value with its unit in quotes: `until = \"10 s\"`",
            ),
        ],
    ),
    (
        "crane.mbd",
        include_str!("../../../../../tests/newcomers/crane.mbd"),
        &[
            ("100 kg ..= 2000 kg", "100..2000 kg", "write `..=`"),
            (
                "100 kg ..= 2000 kg",
                "100 ..= 2000 kg",
                "write it as `100 kg`",
            ),
            // What has a unit stands for itself in front of one.
            (
                "[JIB, 0, 9.75 m]",
                "[500 kg, 0, 9.75] m",
                "does not fit the `m` behind the bracket: it is a mass (kg)",
            ),
        ],
    ),
    (
        "kite.mbd",
        include_str!("../../../../../tests/newcomers/kite.mbd"),
        &[
            (
                "    joint kite_free: free from world to kite.com;\n",
                "",
                "add `joint kite_free: free from world to kite.com;`",
            ),
            ("omega_world", "omega", "here it is called `omega_body`"),
        ],
    ),
    (
        "trailer.mbd",
        include_str!("../../../../../tests/newcomers/trailer.mbd"),
        &[
            ("radius: 0.05 m", "radius: 0.05", "write it as `0.05 m`"),
            ("prismatic", "slider", "here it is called `prismatic`"),
        ],
    ),
    (
        "clock.mbd",
        include_str!("../../../../../tests/newcomers/clock.mbd"),
        &[],
    ),
    (
        "planetary.mbd",
        include_str!("../../../../../tests/newcomers/planetary.mbd"),
        &[
            ("in rpm;", "in rps;", "`1 rev/s` for one"),
            (
                "until = \"0.2 s\"",
                "t_end = \"0.2 s\"",
                "the end of a run is called `until`",
            ),
            (
                "until = \"0.2 s\"",
                "until = \"0.2 s\"\nmethod = \"rk45\"",
                "an adaptive method of order 5 is `tsit5`",
            ),
            (
                "until = \"0.2 s\"",
                "until = \"0.2 s\"\nstart.out.angel = \"10 deg\"",
                "did you mean `out.angle`?",
            ),
        ],
    ),
    (
        "seismograph.mbd",
        include_str!("../../../../../tests/newcomers/seismograph.mbd"),
        &[
            (
                "metric swing = max",
                "metric swing = maximum",
                "here it is called `max`",
            ),
            (
                "frame case at [0, ground, 0] m",
                "frame case at (0, ground, 0)",
                "square brackets: `[x, y, z]`",
            ),
        ],
    ),
    (
        "yo_yo.mbd",
        include_str!("../../../../../tests/newcomers/yo_yo.mbd"),
        &[
            (
                "output height = yo_yo.position.z;",
                "output yo_yo.position.z;",
                "write `output NAME = yo_yo.…`",
            ),
            (
                "output height = yo_yo.position.z;",
                "output fall = yo_yo.speed;",
                "its speed is `norm(yo_yo.velocity)`",
            ),
        ],
    ),
    (
        "glider.mbd",
        include_str!("../../../../../tests/newcomers/glider.mbd"),
        &[
            (
                "const m = 3 g;",
                "const m = 3 mm;",
                "write `(1.225 kg) / m^3` for the const and `1.225 (kg/m^3)` for the unit",
            ),
            ("norm(v);\n    load", "|v|;\n    load", "is `norm(v)`"),
            (
                "    const S = 0.017 m^2;",
                "    S = 0.017 m^2;",
                "`const S = …` for a number",
            ),
        ],
    ),
    (
        "balloon.toml",
        include_str!("../../../../../tests/newcomers/balloon.toml"),
        &[
            (
                "gravity = \"[0, 0, -9.81] m/s^2\"",
                "gravity = { uniform = \"[0, 0, -9.81] m/s^2\" }",
                "`gravity = \"[0.0, 0.0, -9.81] m/s^2\"`",
            ),
            (
                "volume = \"4",
                "volume = \"t + 4",
                "the time is called `time`",
            ),
        ],
    ),
    (
        "hoist.mbd",
        include_str!("../../../../../tests/newcomers/hoist.mbd"),
        &[],
    ),
    (
        "clutch.mbd",
        include_str!("../../../../../tests/newcomers/clutch.mbd"),
        &[],
    ),
    (
        "governor.mbd",
        include_str!("../../../../../tests/newcomers/governor.mbd"),
        &[(
            "motor: omega * time",
            "motor: omega",
            "the rate times `time`",
        )],
    ),
    (
        "satellite.toml",
        include_str!("../../../../../tests/newcomers/satellite.toml"),
        &[(
            "\"[0, 0.5, 1] deg/s\"",
            "\"0.5 deg/s\"",
            "expected 3 numbers, found one",
        )],
    ),
    (
        "ring.mbd",
        include_str!("../../../../../tests/newcomers/ring.mbd"),
        &[],
    ),
    (
        "conveyor.mbd",
        include_str!("../../../../../tests/newcomers/conveyor.mbd"),
        &[],
    ),
    (
        "elevator.toml",
        include_str!("../../../../../tests/newcomers/elevator.toml"),
        &[(
            "free_length = \"paid_counter\"",
            "free_length = \"10 m + radius * w\"",
            "what a drum pays out is `state paid_out = 5 m { rate: -0.2 m * drum.angle_rate }`",
        )],
    ),
    (
        "maglev.toml",
        include_str!("../../../../../tests/newcomers/maglev.toml"),
        &[],
    ),
];

/// A metric of a scene, in its unit, and what it is by a closed form.
type Known = (&'static str, &'static str, f64);

/// By torque and inertia, geometry and balance, from the numbers of the scenes.
fn closed_forms() -> Vec<Known> {
    let g = 9.81;
    // The sun turns 1 + ring/sun times as fast as the carrier, a planet ring/planet − 1 times, backwards.
    let inertia =
        4e-3 + 1e-3 * 4.5f64.powi(2) + 3.0 * (2e-4 * 1.8f64.powi(2) + 0.4 * 0.045f64.powi(2));
    let (torque, brake) = (4.5 * 2.0, 0.5);
    let carrier = torque / brake * (1.0 - (-brake * 0.2 / inertia).exp());
    // A driven swing: I φ̈ + c φ̇ + k φ = m l a ω² sin ωt.
    let (w, swing_inertia) = (TAU * 0.8, 0.05 + 2.0 * 0.3f64.powi(2));
    let force = 2.0 * 0.3 * 1e-3 * w * w;
    let swing = force / (0.2 - swing_inertia * w * w).hypot(0.15 * w);
    let fall = g / (1.0 + 2e-5 / (0.06 * 4e-3f64.powi(2)));
    // What glides steadily has its weight against the resultant of lift and drag.
    let (lift, drag) = (0.5, 0.02 + 0.3 * 0.25f64);
    let glide = (2.0 * 3e-3 * g / (1.225 * 0.017 * drag.hypot(lift))).sqrt();
    let volume = 4.0 / 3.0 * PI * 2.5f64.powi(3);
    let (up, across) = (
        (1.2 * volume - 20.0) * g,
        0.5 * 1.2 * PI * 2.5f64.powi(2) * 0.4 * 36.0,
    );
    // At its steady speed the torque of the motor holds the load.
    let current = 250.0 * g * 0.15 / 40.0 / 0.4;
    let hoisted = (90.0 - 0.5 * current) / 0.4 / 40.0 * 0.15;
    let (slow, fast) = (0.2, 0.5);
    let together = fast / (slow + fast);
    let slid = 0.5 * slow * together * (1500.0 * TAU / 60.0f64).powi(2);
    let omega = 1.5 * TAU;
    // The belt drags with what the weight pulls down the slope, by so much slip.
    let slope = 5f64.to_radians();
    let creep = 1e-3 * (slope.tan() / 0.4).atanh();
    // A brake that holds less than its level creeps: Q = F w/√(w² + w0²).
    let held = 200.0 * g * 0.4 / 4e3;
    let sinks = 0.01 * held / (1.0 - held * held).sqrt() * 60.0 / TAU;
    // What the satellite turned with is in its wheels: angular momentum about the common centre of mass, in the axes of the world.
    let wheels = spun_up();
    vec![
        ("hoist.mbd", "final_speed", hoisted),
        ("clutch.mbd", "energy_lost", slid / 1e3),
        ("clutch.mbd", "end_speed", 1500.0 * together),
        (
            "governor.mbd",
            "angle_end",
            (g / (omega * omega * 0.3)).acos().to_degrees(),
        ),
        ("satellite.toml", "speed_y", wheels[1]),
        ("satellite.toml", "speed_z", wheels[2]),
        // Radially ω² = 4 k/m sin²(π/6).
        ("ring.mbd", "quarter", PI / 2.0 / (200.0f64 / 0.5).sqrt()),
        ("ring.mbd", "least", 0.9),
        ("conveyor.mbd", "creep", creep * 1e3),
        ("conveyor.mbd", "top_speed", 2.0 - creep),
        ("elevator.toml", "hangs", 0.9 * g),
        ("elevator.toml", "hangs_counter", 1.1 * g),
        ("elevator.toml", "creeps", sinks),
        ("maglev.toml", "settled", 10.0),
        (
            "maglev.toml",
            "holds",
            0.01 * (0.068 * g / 6.5e-5f64).sqrt(),
        ),
        ("planetary.mbd", "ratio", 4.5),
        ("planetary.mbd", "speed", carrier),
        ("seismograph.mbd", "swing", swing.to_degrees()),
        ("yo_yo.mbd", "fallen", -0.5 * fall),
        ("yo_yo.mbd", "strongest", 0.06 * (g - fall)),
        ("glider.mbd", "slope", -drag / lift),
        ("glider.mbd", "speed", glide),
        ("balloon.toml", "lean", across.atan2(up)),
        ("balloon.toml", "pull", across.hypot(up) / 1e3),
    ]
}

/// Speeds of the wheels of `satellite.toml` once its bus stands [rpm]: they have the angular momentum that all of it began with.
fn spun_up() -> [f64; 3] {
    let places = [[0.2, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.2], [0.0; 3]];
    let masses = [2.0, 2.0, 2.0, 80.0];
    let moments = [
        [0.02, 0.01, 0.01],
        [0.01, 0.02, 0.01],
        [0.01, 0.01, 0.02],
        [10.0, 12.0, 8.0],
    ];
    let centre = 2.0 * 0.2 / 86.0;
    let omega = [0.0, 0.5f64.to_radians(), 1f64.to_radians()];
    let mut momentum = [0.0; 3];
    for ((place, mass), moments) in places.iter().zip(masses).zip(moments) {
        let r = place.map(|x: f64| x - centre);
        let square: f64 = r.iter().map(|x| x * x).sum();
        let along: f64 = r.iter().zip(omega).map(|(x, w)| x * w).sum();
        for axis in 0..3 {
            momentum[axis] +=
                moments[axis] * omega[axis] + mass * (square * omega[axis] - r[axis] * along);
        }
    }
    let (sine, cosine) = 20f64.to_radians().sin_cos();
    let [x, y, z] = momentum;
    let world = [x, cosine * y - sine * z, sine * y + cosine * z];
    world.map(|h| h / 0.02 * 60.0 / TAU)
}

#[test]
fn scenes_of_newcomers_agree_with_closed_forms() {
    let folder = Folder::new("newcomers_known");
    for (name, text, _) in SCENES {
        let known: Vec<Known> = closed_forms().into_iter().filter(|k| k.0 == name).collect();
        if known.is_empty() {
            continue;
        }
        let (file, out) = (folder.file(name, text), folder.0.join("out"));
        run(&[
            "run",
            &file,
            "--no-estimate",
            "--out",
            &out.display().to_string(),
        ])
        .unwrap_or_else(|failure| panic!("{name}: {failure}"));
        let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        for (_, metric, wanted) in known {
            let found = summary["metrics"][metric].as_f64().unwrap();
            assert!(
                (found - wanted).abs() < 1e-5 * wanted.abs(),
                "{name}: {metric}: {found} is {wanted}"
            );
        }
    }
}

#[test]
fn scenes_of_newcomers_run_and_are_formatted() {
    let folder = Folder::new("newcomers");
    let out = folder.0.join("out").display().to_string();
    for (name, text, _) in SCENES {
        let file = folder.file(name, text);
        let told = run(&["run", &file, "--out", &out]);
        let told = told.unwrap_or_else(|failure| panic!("{name}: {failure}"));
        assert!(!told.contains("warning"), "{name}: {told}");
        if !name.ends_with(".mbd") {
            continue;
        }
        let told = run(&["fmt", "--check", &file]).map_err(|failure| failure.to_string());
        assert_eq!(told, Ok(String::new()));
    }
}

#[test]
fn what_newcomers_mistook_is_answered_with_what_to_write() {
    let folder = Folder::new("newcomers_mistakes");
    for (name, text, mistakes) in SCENES {
        for (right, wrong, said) in mistakes {
            assert!(text.contains(right), "{name}: {right}");
            let file = folder.file(name, &text.replace(right, wrong));
            let error = run(&["check", &file]).unwrap_err();
            let told = error.to_string();
            assert_eq!(error.code(), 2);
            assert!(
                told.contains(said) && told.contains(&format!("{name}:")),
                "{name}: {wrong}: {told}"
            );
        }
    }
}

#[test]
fn what_has_no_number_in_a_run_is_named() {
    let folder = Folder::new("newcomers_nan");
    let out = folder.0.join("out").display().to_string();
    let rod =
        "body rod { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m }";
    let cases = [
        (
            "point stone { mass: 1 kg } load air on stone = [1, 0, 0] N; load drag on stone = -1 N * stone.velocity / norm(stone.velocity);",
            "the load `drag` is not a finite number",
        ),
        (
            "joint pin: hinge from world to rod.top { axis: y, force: 1 N*m * pin.angle_rate / abs(pin.angle_rate) }",
            "the `force` of the joint `pin` is not a finite number",
        ),
        (
            "joint pin: hinge from world to rod.top { axis: y } state flow = 0 m { rate: 1 m/s * sqrt(pin.angle - 1 rad) }",
            "the `rate` of the state `flow` is not a finite number",
        ),
    ];
    for (items, said) in cases {
        let bodies = if items.contains("rod") { rod } else { "" };
        let text =
            format!("model Lost {{ gravity: none; {bodies} {items} }}\n[run]\nuntil = \"1 s\"\n");
        let file = folder.file("lost.mbd", &text);
        let error = run(&["run", &file, "--out", &out]).unwrap_err();
        let told = error.to_string();
        assert_eq!(error.code(), 4, "{told}");
        assert!(
            told.contains(said) && told.contains("division by zero"),
            "{told}"
        );
    }
}

#[test]
fn a_rate_below_one_second_a_second_has_digits_and_a_point_no_rotation() {
    let folder = Folder::new("newcomers_slow");
    let out = folder.0.join("out").display().to_string();
    let text = "model Moved { gravity: [0, 0, -9.81] m/s^2; point bob { mass: 1 kg, start at [0, 0, -1.1] m }
        joint rod: distance from world to bob { length: 1 m } }\n[run]\nuntil = \"10 ms\"\n";
    let file = folder.file("moved.mbd", text);
    let told = run(&["run", &file, "--out", &out]).unwrap();
    assert!(told.contains("it starts 0.1 m away; give"), "{told}");
    let speed = told.split(" simulated seconds a second").next().unwrap();
    let speed = speed.rsplit('\n').next().unwrap();
    assert!(speed.parse::<f64>().unwrap() > 0.0, "{told}");
}
