//! Starts of joints in campaigns: what is dispersed lies about what is declared, and leaves the rest as it is declared, in both families.

use std::sync::Arc;

use mbd_campaign::Campaign;
use mbd_campaign::run::{RunPlan, Settings};
use mbd_compiler::read_text;
use mbd_runtime::scene::Coordinates;
use mbd_runtime::{Content, Generic, Sampling, Simulation, Trajectory};

mod support;

use support::Folder;

const PENDULUM: &str = "model Pendulum {
    gravity: [0.0, 0.0, -9.81] m/s^2;
    body rod { mass: 2 kg, inertia: diag(0.2, 0.2, 0.01) kg*m^2, frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }
    body bob { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m }
    joint pin: hinge from world to rod.top { axis: y, start: 20 deg, start_rate: 0.5 rad/s, stiffness: 1 N*m/rad }
    joint elbow: hinge from rod.end to bob.top { axis: y, start: -50 deg }
    output swing = pin.angle;
    output bend = elbow.angle;
}";

fn plan(coordinates: Coordinates, dispersed: &str, case: u64) -> RunPlan {
    let what = &dispersed[..3];
    let folder = Folder::new(&format!("starts_{what}_{}_{case}", coordinates.word()));
    let scene = read_text(PENDULUM).scene.expect("a scene");
    let model = Generic::<f64>::with_defaults(scene.in_coordinates(coordinates)).expect("valid");
    let text = format!(
        "seed = 3\ncases = 4\n[start]\n{dispersed}\n[metrics]\nmost = {{ max = \"swing\" }}\n[run]\nuntil = \"1 s\""
    );
    let file = folder.file("dispersions.toml", &text);
    let campaign = Campaign::read(&file, Arc::new(model), Settings::default()).expect("valid");
    campaign.plan(case).expect("a case")
}

/// Both angles at the start of a run as planned [rad].
fn angles(coordinates: Coordinates, plan: &RunPlan) -> [f64; 2] {
    let scene = read_text(PENDULUM).scene.expect("a scene");
    let model = Generic::<f64>::with_defaults(scene.in_coordinates(coordinates)).expect("valid");
    let mut run = Simulation::new(&model, plan.options).expect("options that fit");
    plan.begin(&mut run).expect("a start");
    let mut history = Trajectory::new(&model, Sampling::Steps, Content::ALL);
    run.record(1e-9, &mut history).expect("a run");
    ["swing", "bend"].map(|name| history.column(name).expect("an output")[0])
}

const BOTH: [Coordinates; 2] = [Coordinates::Absolute, Coordinates::Relative];

#[test]
fn a_dispersed_angle_lies_about_the_declared_one() {
    let declared = [20f64.to_radians(), -50f64.to_radians()];
    for coordinates in BOTH {
        let dispersed = "pin.angle = { dist = \"normal\", sigma = \"10 %\" }";
        let nominal = angles(coordinates, &plan(coordinates, dispersed, 0));
        for (got, want) in nominal.iter().zip(declared) {
            assert!((got - want).abs() < 1e-12, "{coordinates:?}: {nominal:?}");
        }
        let drawn = angles(coordinates, &plan(coordinates, dispersed, 1));
        let off = (drawn[0] / declared[0] - 1.0).abs();
        assert!(off > 1e-6 && off < 0.5, "{coordinates:?}: {drawn:?}");
        assert!((drawn[1] - declared[1]).abs() < 1e-12);
    }
}

/// A rod at a pin and a cart on a rail, put there by places that are a little off, and a stone that nothing holds.
const ROUGH: &str = "model Rough {
    gravity: [0.0, 0.0, -9.81] m/s^2;
    body rod { mass: 2 kg, inertia: diag(0.2, 0.2, 0.01) kg*m^2, frame top at [0, 0, 0.5] m }
    joint pin: hinge from world to rod.top { axis: y }
    body cart { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }
    joint rail: prismatic from world to cart.com { axis: x }
    point stone { mass: 1 kg, start at [0, 0, 2] m }
    output swing = pin.angle;
    output height = stone.position.z;
    output way = cart.position.x;
    output pace = cart.velocity.x;
}";

fn rough(dispersed: &str) -> Campaign {
    let what: String = dispersed.chars().take_while(|it| *it != ' ').collect();
    let folder = Folder::new(&format!("starts_rough_{what}"));
    let scene = read_text(ROUGH).scene.expect("a scene");
    let model = Generic::<f64>::with_defaults(scene).expect("valid");
    let text = format!(
        "seed = 3\ncases = 4\n[start]\n{dispersed}\n[metrics]\nfirst = {{ final = \"swing\" }}\nheight = {{ final = \"height\" }}\nway = {{ final = \"way\" }}\npace = {{ final = \"pace\" }}"
    );
    let file = folder.file("dispersions.toml", &text);
    let own = "until = \"0 s\"\n[start]\nrod.x = \"-0.2 m\"\nrod.z = \"-0.45 m\"\nrod.qw = 0.98\nrod.qy = 0.199\ncart.z = \"1 mm\"";
    let own: Settings = toml::from_str(own).expect("settings");
    Campaign::read(&file, Arc::new(model), own).expect("valid")
}

#[test]
fn the_nominal_begins_as_the_scene_does_whatever_is_dispersed() {
    let [by_place, by_joint] = [
        "stone.z = { dist = \"normal\", sigma = \"1 m\" }",
        "pin.angle = { dist = \"normal\", sigma = \"0.1 rad\" }",
    ]
    .map(|dispersed| rough(dispersed).replay(0).expect("the nominal").0);
    assert_eq!(by_joint.status, "ok", "{}", by_joint.why);
    assert_eq!(by_joint.metrics, by_place.metrics);
}

#[test]
fn a_case_begins_where_its_row_says_or_fails() {
    // Nothing holds the stone, and the rail lets the cart go along, whatever it corrects across.
    for (place, metric, unit) in [
        ("stone.z", 1, "m"),
        ("cart.x", 3, "m"),
        ("cart.vx", 2, "m/s"),
    ] {
        let free = rough(&format!(
            "{place} = {{ dist = \"uniform\", low = \"0.1 {unit}\", high = \"0.3 {unit}\" }}"
        ));
        for case in 1..=4 {
            let row = free.replay(case).expect("flown").0;
            assert_eq!(row.status, "ok", "{}", row.why);
            let off = row.metrics[metric] - row.values[0];
            assert!(off.abs() < 1e-9, "{place}: {row:?}");
        }
    }
    for (dispersed, what) in [
        (
            "rod.y = { dist = \"uniform\", low = \"0.1 m\", high = \"0.3 m\" }",
            "its place would be",
        ),
        (
            "rod.qx = { dist = \"uniform\", low = \"0.1\", high = \"0.3\" }",
            "its attitude would be",
        ),
        (
            "rod.vx = { dist = \"uniform\", low = \"0.1 m/s\", high = \"0.3 m/s\" }",
            "its velocity would be",
        ),
        (
            "rod.omega_body_z = { dist = \"uniform\", low = \"0.1 rad/s\", high = \"0.3 rad/s\" }",
            "its angular velocity would be",
        ),
    ] {
        let campaign = rough(dispersed);
        let name = campaign.manifest().dispersed[0].name.clone();
        assert_eq!(campaign.replay(0).expect("the nominal").0.status, "ok");
        let row = campaign.replay(1).expect("a row").0;
        assert_eq!(row.status, "start", "{row:?}");
        let said = format!("`{name}`: the joints of `rod` do not allow what is drawn, and {what}");
        assert!(row.why.contains(&said), "{}", row.why);
    }
}

#[test]
fn a_dispersed_speed_of_a_body_leaves_its_place_as_declared() {
    let campaign =
        rough("cart.vx = { dist = \"normal\", mean = \"0.2 m/s\", sigma = \"0.1 m/s\" }");
    let rows = [0, 1, 2].map(|case| campaign.replay(case).expect("flown").0);
    let [nominal, others @ ..] = &rows;
    for row in others {
        for place in [0, 1, 3] {
            assert_eq!(row.metrics[place], nominal.metrics[place], "{row:?}");
        }
        assert!((row.metrics[2] - row.values[0]).abs() < 1e-12, "{row:?}");
    }
}

#[test]
fn a_start_of_a_run_beyond_half_a_turn_keeps_its_turn() {
    for coordinates in BOTH {
        let scene = read_text(PENDULUM).scene.expect("a scene");
        let text = "until = \"1 s\"\n[start]\npin.angle = \"270 deg\"";
        let settings: Settings = toml::from_str(text).expect("settings");
        let plan = RunPlan::new(&scene.in_coordinates(coordinates), &settings).expect("a plan");
        let [swing, _] = angles(coordinates, &plan);
        assert!(
            (swing - 270f64.to_radians()).abs() < 1e-9,
            "{coordinates:?}: {swing}"
        );
    }
}

#[test]
fn a_joint_with_one_coordinate_starts_by_its_name_alone() {
    let scene = read_text(PENDULUM).scene.expect("a scene");
    let plan = |start: &str| {
        let text = format!("until = \"1 s\"\n[start]\n{start}");
        let settings: Settings = toml::from_str(&text).expect("settings");
        RunPlan::new(&scene, &settings)
    };
    let [short, whole] = ["pin", "pin.angle"].map(|name| plan(&format!("{name} = \"0.3 rad\"")));
    assert_eq!(
        angles(Coordinates::Absolute, &short.expect("a plan")),
        angles(Coordinates::Absolute, &whole.expect("a plan"))
    );
    let twice = plan("pin = \"0.3 rad\"\n\"pin.angle\" = \"0.2 rad\"").expect_err("twice");
    assert!(twice.to_string().contains("is given twice"), "{twice}");
    // What a campaign disperses lies about what the scene file gives under either name.
    let folder = Folder::new("starts_alone");
    let file = "cases = 4\n[start]\npin.angle = { dist = \"normal\", sigma = \"10 %\" }\n[metrics]\nmost = { max = \"swing\" }\n";
    let file = folder.file("dispersions.toml", file);
    let own: Settings =
        toml::from_str("until = \"1 s\"\n[start]\npin = \"0.3 rad\"").expect("settings");
    let model = Generic::<f64>::with_defaults(scene).expect("valid");
    let campaign = Campaign::read(&file, Arc::new(model), own).expect("valid");
    let nominal = campaign.plan(0).expect("a case");
    assert!((angles(Coordinates::Absolute, &nominal)[0] - 0.3).abs() < 1e-12);
}

/// A rate that was dispersed took the place of the angle that the settings give by the name of its joint alone, and a speed that they give as a component of
/// its vector was given twice in every case.
#[test]
fn a_dispersed_number_leaves_what_the_settings_say_of_others_by_whatever_name() {
    let campaign = |scene: &str, given: &str, dispersed: &str, coordinates: Coordinates| {
        let owner: String = given.chars().filter(|it| it.is_alphanumeric()).collect();
        let folder = Folder::new(&format!("starts_by_name_{}_{owner}", coordinates.word()));
        let scene = read_text(scene).scene.expect("a scene");
        let model = Generic::<f64>::with_defaults(scene.in_coordinates(coordinates));
        let text = format!("cases = 3\n[start]\n{dispersed}\n[run]\nuntil = \"1 s\"");
        let file = folder.file("dispersions.toml", &text);
        let own: Settings = toml::from_str(&format!("[start]\n{given}")).expect("settings");
        Campaign::read(&file, Arc::new(model.expect("valid")), own).expect("valid")
    };
    let rate = "pin.angle_rate = { dist = \"normal\", sigma = \"1 rad/s\" }";
    for coordinates in BOTH {
        for given in ["pin = \"0.3 rad\"", "\"pin.angle\" = \"0.3 rad\""] {
            let campaign = campaign(PENDULUM, given, rate, coordinates);
            for case in 0..=3 {
                let plan = campaign.plan(case).expect("a case");
                let [swing, _] = angles(coordinates, &plan);
                assert!((swing - 0.3).abs() < 1e-12, "{given} {case}: {swing}");
            }
        }
    }
    let aside = "stone.vx = { dist = \"normal\", sigma = \"1 m/s\" }";
    for given in [
        "stone.velocity.x = \"5 m/s\"\nstone.vz = \"2 m/s\"",
        "stone.velocity = \"[5, 0, 2] m/s\"",
    ] {
        let stone = "model Stone { gravity: none; point stone { mass: 1 kg } }";
        let campaign = campaign(stone, given, aside, Coordinates::Absolute);
        for case in 0..=3 {
            let drawn = campaign.dispersions().values(case).expect("values")[0];
            let plan = campaign.plan(case).expect("a case");
            assert_eq!(plan.state[3..], [drawn, 0.0, 2.0], "{given}");
            assert!((drawn - 5.0).abs() < 5.0 && (drawn == 5.0) == (case == 0));
        }
    }
}

/// Bars of 1, 2 and 2 m between pivots 2 m apart; the crank to the digit, the rocker about an angle.
const LOOP: &str = "model Loop { gravity: none;
    world { frame far at [2, 0, 0] m }
    body crank { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame a at [-0.5, 0, 0] m, frame b at [0.5, 0, 0] m }
    body bar { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame a at [-1, 0, 0] m, frame b at [1, 0, 0] m }
    body rocker { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame a at [-1, 0, 0] m, frame b at [1, 0, 0] m }
    joint p: hinge from world to crank.a { axis: z, start: 80 deg }
    joint q: hinge from crank.b to bar.a { axis: z }
    joint r: hinge from world.far to rocker.a { axis: z, start: about 90 deg }
    joint s: hinge from bar.b to rocker.b { axis: z }
    output crank_angle = p.angle; }";

#[test]
fn what_is_about_a_value_stays_about_it_when_it_is_dispersed() {
    for run in ["", "[run.start]\n\"r.angle\" = \"about 95 deg\"\n"] {
        let folder = Folder::new(&format!("about_{}", run.len()));
        let model = Generic::<f64>::with_defaults(read_text(LOOP).scene.expect("a scene"));
        let text = format!(
            "seed = 3\ncases = 4\n[start]\n\"r.angle\" = {{ dist = \"normal\", sigma = \"5 deg\" }}\n[metrics]\nmost = {{ max = \"crank_angle\" }}\n[run]\nuntil = \"1 s\"\n{run}"
        );
        let file = folder.file("dispersions.toml", &text);
        let model = Arc::new(model.expect("valid"));
        let campaign = Campaign::read(&file, model, Settings::default()).expect("valid");
        let said = |case: u64| {
            let plan = campaign.plan(case).expect("a rocker that gives way");
            let about = &plan.assembly.about;
            assert_eq!(about.len(), 1);
            [about[0].said, about[0].taken]
        };
        let (nominal, drawn) = (said(0), said(1));
        let wanted = if run.is_empty() { 90f64 } else { 95.0 };
        assert!(
            (nominal[0] - wanted.to_radians()).abs() < 1e-12,
            "{nominal:?}"
        );
        assert!((drawn[0] - nominal[0]).abs() > 1e-3, "{drawn:?}");
        assert!((drawn[1] - nominal[1]).abs() < 1e-9, "the crank decides");
    }
}

/// Four numbers of an attitude are made a unit quaternion: of one that is drawn the row told a start that the run does not have.
#[test]
fn the_row_of_an_attitude_tells_the_unit_quaternion_that_a_run_begins_with() {
    let text = "model Adrift { gravity: none;
        body a { mass: 1 kg, inertia: diag(1, 2, 2.5) kg*m^2 }
        joint afloat: free from world to a.com; }";
    let folder = Folder::new("starts_attitude");
    let model = Generic::<f64>::with_defaults(read_text(text).scene.expect("a scene"));
    let text = "seed = 3\ncases = 4\n[start]\na.qx = { dist = \"uniform\", low = 0.2, high = 0.4 }\n[metrics]\nqw = { final = \"a.qw\" }\nqx = { final = \"a.qx\" }\n[run]\nuntil = \"0 s\"";
    let file = folder.file("dispersions.toml", text);
    let model = Arc::new(model.expect("valid"));
    let campaign = Campaign::read(&file, model, Settings::default()).expect("valid");
    for case in 1..=4 {
        let drawn = campaign.dispersions().values(case).expect("values")[0];
        let row = campaign.replay(case).expect("flown").0;
        let taken = drawn / (1.0 + drawn * drawn).sqrt();
        assert!((row.values[0] - taken).abs() < 1e-15, "{row:?}");
        assert!((row.metrics[1] - taken).abs() < 1e-15, "{row:?}");
    }
}

/// Where a loop decides, the column told what was drawn, from which nothing of the run follows.
#[test]
fn the_row_of_what_gives_way_tells_what_is_taken() {
    let scene = LOOP.replace(
        "s: hinge from bar.b to rocker.b { axis: z }",
        "s: hinge from bar.b to rocker.b { axis: z }\n    output rocker_angle = r.angle;",
    );
    for (dispersed, is_free) in [("\"r.angle\"", false), ("\"p.angle\"", true)] {
        let folder = Folder::new(&format!("starts_taken_{is_free}"));
        let model = Generic::<f64>::with_defaults(read_text(&scene).scene.expect("a scene"));
        let text = format!(
            "seed = 3\ncases = 4\n[start]\n{dispersed} = {{ dist = \"normal\", sigma = \"5 deg\" }}\n[metrics]\ncrank = {{ final = \"crank_angle\" }}\nrocker = {{ final = \"rocker_angle\" }}\n[run]\nuntil = \"0 s\""
        );
        let file = folder.file("dispersions.toml", &text);
        let model = Arc::new(model.expect("valid"));
        let campaign = Campaign::read(&file, model, Settings::default()).expect("valid");
        let rows = [0, 1, 2, 3, 4].map(|case| campaign.replay(case).expect("flown").0);
        for row in &rows {
            let [crank, rocker] = row.metrics[..] else {
                panic!("two metrics");
            };
            let begun = if is_free { crank } else { rocker };
            assert!((row.values[0] - begun).abs() < 1e-9, "{row:?}");
        }
        let spread = (rows[1].values[0] - rows[2].values[0]).abs();
        assert_eq!(spread > 1e-3, is_free, "{rows:?}");
    }
}

/// Two wheels on springs of 2 N m/rad each, both of 1 kg m², geared 1 : 3; the first begins 400 degrees from where its spring is at rest, and nothing says
/// where the second does.
const GEARED: &str = "model Geared { gravity: none;
    body a { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
    body b { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
    joint slow: hinge from world to a.com { axis: z, start: about 400 deg, stiffness: 2 N*m }
    joint fast: hinge from world to b.com { axis: z, stiffness: 2 N*m }
    joint teeth: gear from slow.angle to fast.angle { ratio: 3 / 1 }
    output turned = fast.angle; }";

#[test]
fn a_start_beyond_half_a_turn_is_dispersed_about_itself() {
    for coordinates in BOTH {
        let folder = Folder::new(&format!("starts_turns_{}", coordinates.word()));
        let scene = read_text(GEARED).scene.expect("a scene");
        let model = Generic::<f64>::with_defaults(scene.in_coordinates(coordinates));
        let text = "seed = 3\ncases = 4\n[start]\nfast.angle = { dist = \"normal\", sigma = \"1 %\" }\n[metrics]\nlast = { final = \"turned\" }\n[run]\nuntil = \"1 s\"\ntolerance = 1e-11";
        let file = folder.file("dispersions.toml", text);
        let model = Arc::new(model.expect("valid"));
        let campaign = Campaign::read(&file, model, Settings::default()).expect("valid");
        let nominal = 1200f64.to_radians();
        for case in 0..=4 {
            let row = campaign.replay(case).expect("flown").0;
            assert_eq!(row.status, "ok", "{}", row.why);
            // 10 kg m² and 20 N m/rad at the slow wheel: φ = φ(0) cos(√2 t).
            let [begun, wanted] = [row.values[0], row.values[0] * 2f64.sqrt().cos()];
            let off = (begun / nominal - 1.0).abs();
            match case {
                0 => assert!(off < 1e-12, "{coordinates:?}: {begun}"),
                _ => assert!(off > 1e-6 && off < 0.05, "{coordinates:?}: {begun}"),
            }
            let last = row.metrics[0];
            assert!((last - wanted).abs() < 1e-8, "{coordinates:?}: {row:?}");
        }
    }
}

#[test]
fn what_the_nominal_would_tell_is_not_dispersed_where_it_cannot_begin() {
    let folder = Folder::new("starts_unknown");
    // Bars of 1 m that do not reach across 5 m.
    let scene = LOOP.replace("far at [2, 0, 0] m", "far at [8, 0, 0] m");
    let model = Generic::<f64>::with_defaults(read_text(&scene).scene.expect("a scene"));
    let text = "seed = 3\ncases = 4\n[start]\n\"q.angle\" = { dist = \"normal\", sigma = \"5 deg\" }\n[metrics]\nmost = { max = \"crank_angle\" }\n[run]\nuntil = \"1 s\"\n[run.start]\ncrank.x = \"0.5 m\"";
    let file = folder.file("dispersions.toml", text);
    let model = Arc::new(model.expect("valid"));
    let refused = Campaign::read(&file, model, Settings::default());
    let why = refused.err().expect("no nominal value").to_string();
    assert!(why.contains("q.angle"), "{why}");
    assert!(why.contains("give it a start"), "{why}");
}
