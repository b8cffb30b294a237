//! Joints in generated code: chains and loops declared in the language agree in every execution, in both components of angular velocity.

use mbd_runtime::model;
use mbd_scene::{AngularVelocity, Model, Quantity};
use tests::agreement::{agrees, agrees_along, agrees_at};
use tests::assert_close;
use tests::instant::{Instant, random_instant};
use tests::mechanism::evaluate;
use tests::obeying::obeying;
use tests::random::Random;
use tests::reference::{load, numbers};

/// Two links on parallel hinges, the second axis inclined by a frame.
macro_rules! chain {
    ($name:ident $components:ident) => {
        model! {
            /// Two links on hinges.
            pub model $name<T> {
            gravity: [0.0, 0.0, -9.81] m/s^2;
            angular_velocity: $components;
            param length = 1 m in 0.5 m ..= 2 m;
            body upper {
                mass: 2.0 kg,
                inertia: diag(0.17, 0.17, 0.002) kg*m^2,
                frame top at [0.0, 0.0, 0.5 * length],
                frame tip at [0.0, 0.0, -0.5 * length] rotated rpy(20 deg, 0.0, 0.0),
            }
            body lower {
                mass: 1.5 kg,
                inertia: full { xx: 0.0305, yy: 0.0305, zz: 0.001, xz: 0.0005 } kg*m^2 (matrix elements),
                frame top at [0.0, 0.0, 0.25] m,
            }
            joint shoulder: hinge from world to upper.top { axis: y }
            joint elbow: hinge from upper.tip to lower.top { axis: -y }
            load push on lower at top: external;
            load muscle on upper at com = -0.2 N*m*s * elbow.angle_rate * upper.y;
            output speed = norm(lower.velocity);
            output bend = elbow.angle in deg;
            output swing = shoulder.angle;
            event fold = elbow.angle rises 60 deg;
            }
        }
    };
}

chain!(ChainBody body);
chain!(ChainWorld world);

/// The closed loop hinge, universal, spherical, prismatic of `reference/loops`, with its numbers.
macro_rules! ring {
    ($name:ident $components:ident) => {
        model! {
            /// A closed spatial loop with one freedom.
            pub model $name<T> {
            gravity: [0.0, 0.0, -9.81] m/s^2;
            angular_velocity: $components;
            world {
                frame hinge_in at [0.854596381358226, -0.16370253550912262, 0.20979948210376664] m
                    rotated matrix([-0.5348700732101472, -0.710825888626916, 0.45677189147530417], [-0.7255081985340018, 0.10928833053702047, -0.6794806212603699], [0.43307257895659834, -0.694825601763627, -0.5741650672843956]),
                frame prismatic_out at [-0.14925881270582717, -0.3597746880599382, -0.11323597396619894] m
                    rotated matrix([-0.5126488999418983, -0.04438863284114075, 0.8574501470422967], [0.7343038229826591, 0.49487978040534986, 0.46464168829217684], [-0.44495954978111596, 0.8678269713603324, -0.2211048322360678]),
            }
            body crank {
                mass: 1.15047121386676 kg,
                inertia: full { xx: 0.09435547991001479, yy: 0.06528240580755625, zz: 0.0996530543896989, xy: 0.008517731790719343, xz: -0.008876354642228076, yz: 0.03638263647294343 } kg*m^2 (matrix elements),
                frame hinge_out at [0.39309755584761397, -0.15266489346675016, -0.20915575452462418] m
                    rotated matrix([-0.6371080256777206, -0.3632904435337648, 0.6797892447325694], [-0.08238262007439431, 0.9089996369500734, 0.40857406174929023], [-0.7663592287737616, 0.20430299474475488, -0.6090597826253263]),
                frame universal_in at [-0.279659449757934, 0.2776599855950223, 0.4188802316406946] m
                    rotated matrix([0.00911314010550717, -0.9554947724919685, -0.29486724202247033], [-0.08392838868767893, -0.29456987531781076, 0.9519372952708274], [-0.9964301160892853, 0.016072594556265356, -0.08287759319938415]),
            }
            body coupler {
                mass: 2.57214468106162 kg,
                inertia: full { xx: 0.3646133724654997, yy: 0.2544128429694044, zz: 0.4056852230560376, xy: 0.04524782455713646, xz: 0.05860184305963574, yz: 0.06779440996141847 } kg*m^2 (matrix elements),
                frame universal_out at [0.3970353326297881, 0.13202231702911346, 0.21713247642142394] m
                    rotated matrix([-0.7909195341455227, -0.24988975628768975, -0.5585708551379205], [0.35576334545342764, 0.554910025885368, -0.7520021976056219], [0.497874213570872, -0.7934922639032966, -0.34998756347448506]),
                frame spherical_in at [-0.5154779034057965, -0.00233023319681949, -0.25462211770426274] m
                    rotated matrix([0.7851770516709462, 0.07173136692268238, -0.6151029251505181], [-0.44327316596694544, -0.6285062357810096, -0.6391312947415634], [-0.4324417855191163, 0.7744898466628144, -0.46169208305238363]),
            }
            body slider {
                mass: 2.1154100996882317 kg,
                inertia: full { xx: 0.2818477847268445, yy: 0.34036760533152643, zz: 0.3998600249079385, xy: 0.12874591221952036, xz: -0.08830068672128827, yz: 0.03483051739211651 } kg*m^2 (matrix elements),
                frame spherical_out at [0.07581105896221131, 0.2688204267783516, -0.13418132397953023] m
                    rotated matrix([0.46407399726780163, 0.6218451120257259, 0.6308280127812943], [0.7526021795852087, -0.6523747415134243, 0.08942681878992531], [0.4671458919261495, 0.4332618761038241, -0.7707521406856532]),
                frame prismatic_in at [-0.037452093010696866, -0.2932851903703993, 0.31784399874699787] m
                    rotated matrix([0.6225460872399057, -0.7526673294283333, 0.21430879700447342], [0.7787819758662284, 0.6227978901274127, -0.07497614366407726], [-0.07703897278765381, 0.2135759332510663, 0.9738841396222444]),
            }
            joint hinge_joint: hinge from world.hinge_in to crank.hinge_out { axis: z }
            joint universal_joint: universal from crank.universal_in to coupler.universal_out { axes: [x, y] }
            joint spherical_joint: spherical from coupler.spherical_in to slider.spherical_out;
            joint prismatic_joint: prismatic from slider.prismatic_in to world.prismatic_out { axis: z }
            output crank_angle = hinge_joint.angle;
            output turned = universal_joint.angle1 + universal_joint.angle2;
            output turning = universal_joint.angle1_rate * universal_joint.angle2_rate;
            output stroke = prismatic_joint.slide in mm;
            output speed = prismatic_joint.slide_rate;
            }
        }
    };
}

/// A free hub with four arms on tangential hinges.
macro_rules! hub {
    ($name:ident $components:ident) => {
        model! {
            /// A hub with four arms.
            pub model $name<T> {
            gravity: [0.0, 0.0, -9.81] m/s^2;
            angular_velocity: $components;
            body centre {
                mass: 5.0 kg,
                inertia: diag(0.4, 0.5, 0.8) kg*m^2,
                frame east at [0.5, 0.0, 0.0] m,
                frame north at [0.0, 0.5, 0.0] m,
                frame west at [-0.5, 0.0, 0.0] m,
                frame south at [0.0, -0.5, 0.0] m,
            }
            body a { mass: 1.0 kg, inertia: diag(0.085, 0.085, 0.001) kg*m^2, frame top at [0.0, 0.0, 0.5] m }
            body b { mass: 1.0 kg, inertia: diag(0.085, 0.085, 0.001) kg*m^2, frame top at [0.0, 0.0, 0.5] m }
            body c { mass: 1.0 kg, inertia: diag(0.085, 0.085, 0.001) kg*m^2, frame top at [0.0, 0.0, 0.5] m }
            body d { mass: 1.0 kg, inertia: diag(0.085, 0.085, 0.001) kg*m^2, frame top at [0.0, 0.0, 0.5] m }
            joint centre_free: free from world to centre.com;
            joint pin_a: hinge from centre.east to a.top { axis: y }
            joint pin_b: hinge from centre.north to b.top { axis: x }
            joint pin_c: hinge from centre.west to c.top { axis: y }
            joint pin_d: hinge from centre.south to d.top { axis: x }
            }
        }
    };
}

hub!(HubBody body);
hub!(HubWorld world);

/// Coordinates coupled by gears, along a chain and across it, one with a ratio that stays a parameter, and a constant-velocity joint.
macro_rules! geared {
    ($name:ident $components:ident) => {
        model! {
            /// A train of gears.
            pub model $name<T> {
            gravity: [0.4, -0.3, -9.81] m/s^2;
            angular_velocity: $components;
            param radius = 40 mm in 10 mm ..= 90 mm;
            body rotor {
                mass: 1.5 kg,
                inertia: full { xx: 0.0305, yy: 0.0305, zz: 0.02, xz: 0.0005 } kg*m^2 (matrix elements),
                frame pin at [0.1, 0.2, 0.0] m rotated rpy(20 deg, 0.0, 10 deg),
                frame tip at [0.0, 0.0, 0.3] m,
            }
            body wheel { mass: 0.5 kg, inertia: diag(0.004, 0.005, 0.006) kg*m^2, frame hub at [0.02, 0.0, 0.0] m }
            body rack { mass: 2.0 kg, inertia: diag(0.17, 0.17, 0.02) kg*m^2 }
            body shaft { mass: 1.0 kg, inertia: diag(0.085, 0.085, 0.001) kg*m^2, frame root at [0.0, 0.0, -0.5] m }
            joint teeth: gear from motor.angle to axle.angle { ratio: -20 / 43, offset: 5 deg }
            joint motor: hinge from world to rotor.com { axis: [0.3, -0.5, 0.7] }
            joint axle: hinge from rotor.pin to wheel.hub { axis: z }
            joint rail: prismatic from world to rack.com { axis: x }
            joint pinion: gear from motor.angle to rail.slide { ratio: radius }
            joint bend: constant_velocity from rotor.tip to shaft.root { axis: [0.2, 0.1, 0.9] }
            load push on wheel: external;
            load pull on rack: external;
            output turned = axle.angle;
            }
        }
    };
}

geared!(GearedBody body);
geared!(GearedWorld world);

/// Joints in a tree, axes odd, frames inclined, a pitch that stays a parameter.
macro_rules! turning {
    ($name:ident $components:ident) => {
        model! {
            /// Joints that turn.
            pub model $name<T> {
            gravity: [0.4, -0.3, -9.81] m/s^2;
            angular_velocity: $components;
            param pitch = 80 mm in 10 mm ..= 200 mm;
            body nut { mass: 1.3 kg, inertia: diag(0.03, 0.04, 0.05) kg*m^2, frame tip at [0.1, 0.2, -0.3] m rotated rpy(0.3, -0.4, 0.5) }
            body spider {
                mass: 0.8 kg,
                inertia: full { xx: 0.03, yy: 0.04, zz: 0.05, xy: 0.004, xz: -0.003, yz: 0.002 } kg*m^2 (matrix elements),
                frame top at [0.0, 0.1, 0.3] m rotated rpy(-0.2, 0.1, 0.7),
                frame tip at [0.2, 0.0, -0.3] m,
            }
            body sleeve { mass: 0.9 kg, inertia: diag(0.03, 0.04, 0.05) kg*m^2, frame top at [0.1, 0.0, 0.2] m }
            joint thread: screw from world to nut.com { axis: [0.6, 0.0, 0.8], pitch: pitch }
            joint knuckle: universal from nut.tip to spider.top { axes: [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0]] }
            joint slide: cylindrical from spider.tip to sleeve.top { axis: [1, 2, 3] }
            }
        }
    };
}

turning!(TurningBody body);
turning!(TurningWorld world);

/// Joints that slide, and a weld.
macro_rules! sliding {
    ($name:ident $components:ident) => {
        model! {
            /// Joints that slide.
            pub model $name<T> {
            gravity: [0.4, -0.3, -9.81] m/s^2;
            angular_velocity: $components;
            body tile { mass: 1.1 kg, inertia: diag(0.03, 0.04, 0.05) kg*m^2, frame edge at [0.3, 0.1, 0.0] m rotated rpy(0.1, 0.2, 0.3) }
            body weld { mass: 0.7 kg, inertia: diag(0.02, 0.03, 0.04) kg*m^2, frame top at [0.0, 0.2, 0.2] m, frame tip at [0.0, -0.2, 0.1] m }
            body cart { mass: 0.6 kg, inertia: diag(0.02, 0.03, 0.04) kg*m^2 }
            joint floor: planar from world to tile.com { axis: [0.0, 0.6, 0.8] }
            joint glue: rigid from tile.edge to weld.top;
            joint guide: prismatic from weld.tip to cart.com { axis: -x }
            }
        }
    };
}

sliding!(SlidingBody body);
sliding!(SlidingWorld world);

/// The joints of one or two rows, and a hinge and a spherical joint carried by them.
macro_rules! holding {
    ($name:ident $components:ident) => {
        model! {
            /// Joints that hold little.
            pub model $name<T> {
            gravity: [0.4, -0.3, -9.81] m/s^2;
            angular_velocity: $components;
            body bob { mass: 1.3 kg, inertia: diag(0.03, 0.04, 0.05) kg*m^2, frame top at [0.1, 0.2, 0.3] m, frame tip at [0.1, 0.2, -0.3] m rotated rpy(0.3, -0.4, 0.5) }
            body bead { mass: 0.8 kg, inertia: diag(0.03, 0.04, 0.05) kg*m^2, frame eye at [0.0, 0.1, 0.1] m }
            body puck { mass: 0.9 kg, inertia: diag(0.03, 0.04, 0.05) kg*m^2, frame rim at [0.1, 0.0, 0.2] m rotated rpy(0.5, 0.0, 0.1) }
            body cone { mass: 1.1 kg, inertia: diag(0.03, 0.04, 0.05) kg*m^2, frame edge at [0.3, 0.1, 0.0] m }
            body ball { mass: 0.7 kg, inertia: diag(0.02, 0.03, 0.04) kg*m^2, frame top at [0.0, 0.2, 0.2] m, frame tip at [0.0, -0.2, 0.1] m rotated rpy(0.2, 0.3, 0.0) }
            body leaf { mass: 0.6 kg, inertia: diag(0.02, 0.03, 0.04) kg*m^2, frame top at [0.1, -0.2, 0.3] m }
            joint rod: distance from world to bob.top { length: 0.8 m }
            joint wire: point_on_line from bob.tip to bead.eye { axis: [2, 1, 0] }
            joint shelf: point_on_plane from world to puck.rim { axis: z }
            joint tilt: constant_angle from puck.rim to cone.com { axes: [z, x], angle: 60 deg }
            joint socket: spherical from cone.edge to ball.top;
            joint door: hinge from ball.tip to leaf.top { axis: [0.3, -0.5, 0.7] }
            }
        }
    };
}

holding!(HoldingBody body);
holding!(HoldingWorld world);

ring!(LoopBody body);
ring!(LoopWorld world);

/// A door with a closer and a stop, a bolt with friction that slides and turns in it, a nut on a thread of the bolt.
macro_rules! door {
    ($name:ident $components:ident) => {
        model! {
            /// What acts along joint coordinates, all of it.
            pub model $name<T> {
            gravity: [0.0, 0.5, -9.81] m/s^2;
            angular_velocity: $components;
            param closing = 2.0 N*m/rad in 0.0 N*m ..= 10 N*m;
            param wide = 110 deg in 60 deg ..= 170 deg;
            const NONE = 0.0 N*m*s;
            body door {
                mass: 20 kg,
                inertia: diag(2.0, 1.0, 1.2) kg*m^2,
                frame edge at [-0.4, 0.0, 0.0] m rotated rpy(0.0, 5 deg, 0.0),
                frame lock at [0.4, 0.0, 0.1] m rotated rpy(0.0, 90 deg, 0.0),
            }
            body bolt { mass: 0.3 kg, inertia: diag(1e-3, 2e-3, 1e-3) kg*m^2 }
            body nut { mass: 0.1 kg, inertia: diag(1e-3, 1e-3, 2e-3) kg*m^2 }
            body spider { mass: 0.1 kg, inertia: diag(1e-3, 1e-3, 2e-3) kg*m^2 }
            joint hinges: hinge from world to door.edge {
                axis: z, stiffness: closing, rest: -10 deg, damping: 0.5 N*m*s,
                stops: [-5 deg, wide], stop_stiffness: 2 kN*m, stop_damping: 5 N*m*s,
                force: 0.3 N*m * cos(time / 1 s) - 0.1 N*m * bolting.slide / 1 m,
            }
            joint bolting: cylindrical from door.lock to bolt.com {
                slide: { friction: 0.2 N, friction_rate: 1 cm/s, stops: [none, 4 cm], stop_stiffness: 1 kN/m },
                angle: { damping: NONE, stiffness: 0.01 N*m/rad },
            }
            joint thread: screw from bolt.com to nut.com { pitch: 2 cm, damping: 1e-3 N*m*s, stops: [-20 rad, none], stop_stiffness: 1 N*m }
            joint gimbal: universal from bolt.com to spider.com { damping: 0.01 N*m*s, angle1: { stiffness: 0.2 N*m } }
            output opening = hinges.angle in deg;
            }
        }
    };
}

door!(DoorBody body);
door!(DoorWorld world);

#[test]
fn what_acts_along_coordinates_agrees_in_every_execution() {
    fn check(model: &dyn Model<f64>) {
        agrees_at(model, &on_the_joints(model));
        let start = obeying(model.scene(), &mut Random::new(8));
        agrees_along(model, &start, (100, 2e-3), 1e-10);
    }
    check(&DoorBody::<f64>::new(Default::default()).expect("defaults"));
    check(&DoorWorld::<f64>::new(Default::default()).expect("defaults"));
}

#[test]
fn a_chain_of_two_hinges_agrees_in_every_execution() {
    agrees(&ChainBody::<f64>::new(Default::default()).expect("defaults"));
    agrees(&ChainWorld::<f64>::new(Default::default()).expect("defaults"));
}

#[test]
fn a_closed_loop_of_four_joints_agrees_in_every_execution() {
    agrees(&LoopBody::<f64>::new(Default::default()).expect("defaults"));
    agrees(&LoopWorld::<f64>::new(Default::default()).expect("defaults"));
}

/// Random instants on the joints, and near them.
fn on_the_joints(model: &dyn Model<f64>) -> Vec<Instant<f64>> {
    let mut random = Random::new(31);
    let mut instants = Vec::new();
    for _ in 0..5 {
        let state = obeying(model.scene(), &mut random);
        let off = state.iter().map(|x| x + random.uniform(-1e-2, 1e-2));
        let off = off.collect();
        for state in [state, off] {
            let instant = random_instant(model.scene(), &mut random);
            instants.push(Instant { state, ..instant });
        }
    }
    instants
}

#[test]
fn every_joint_agrees_in_every_execution() {
    fn check(model: &dyn Model<f64>) {
        agrees_at(model, &on_the_joints(model));
    }
    check(&TurningBody::<f64>::new(Default::default()).expect("defaults"));
    check(&TurningWorld::<f64>::new(Default::default()).expect("defaults"));
    check(&SlidingBody::<f64>::new(Default::default()).expect("defaults"));
    check(&SlidingWorld::<f64>::new(Default::default()).expect("defaults"));
    check(&HoldingBody::<f64>::new(Default::default()).expect("defaults"));
    check(&HoldingWorld::<f64>::new(Default::default()).expect("defaults"));
    check(&GearedBody::<f64>::new(Default::default()).expect("defaults"));
    check(&GearedWorld::<f64>::new(Default::default()).expect("defaults"));
    check(&HubBody::<f64>::new(Default::default()).expect("defaults"));
    check(&HubWorld::<f64>::new(Default::default()).expect("defaults"));
}

#[test]
fn a_run_of_a_tree_is_the_same_in_every_execution() {
    fn run(model: &dyn Model<f64>) {
        let start = obeying(model.scene(), &mut Random::new(8));
        agrees_along(model, &start, (100, 2e-3), 1e-10);
    }
    run(&ChainBody::<f64>::new(Default::default()).expect("defaults"));
    run(&ChainWorld::<f64>::new(Default::default()).expect("defaults"));
    run(&HubBody::<f64>::new(Default::default()).expect("defaults"));
    run(&HubWorld::<f64>::new(Default::default()).expect("defaults"));
    run(&GearedBody::<f64>::new(Default::default()).expect("defaults"));
    run(&GearedWorld::<f64>::new(Default::default()).expect("defaults"));
    run(&TurningBody::<f64>::new(Default::default()).expect("defaults"));
    run(&TurningWorld::<f64>::new(Default::default()).expect("defaults"));
    run(&SlidingBody::<f64>::new(Default::default()).expect("defaults"));
    run(&SlidingWorld::<f64>::new(Default::default()).expect("defaults"));
    run(&HoldingBody::<f64>::new(Default::default()).expect("defaults"));
    run(&HoldingWorld::<f64>::new(Default::default()).expect("defaults"));
}

#[test]
fn a_run_of_the_closed_loop_is_the_same_in_every_execution() {
    let body = LoopBody::<f64>::new(Default::default()).expect("defaults");
    agrees_along(&body, &of_the_reference(&body, 0), (100, 2e-3), 1e-10);
    let world = LoopWorld::<f64>::new(Default::default()).expect("defaults");
    agrees_along(&world, &of_the_reference(&world, 0), (100, 2e-3), 1e-10);
}

#[test]
fn runs_in_single_precision_have_the_bits_of_the_interpreter() {
    fn run(model: &dyn Model<f32>, start: &[f64]) {
        agrees_along(model, start, (50, 2e-3), 1e-4);
    }
    let start = |scene| obeying(scene, &mut Random::new(8));
    let door = DoorBody::<f32>::new(Default::default()).expect("defaults");
    run(&door, &start(door.scene()));
    let chain = ChainBody::<f32>::new(Default::default()).expect("defaults");
    run(&chain, &start(chain.scene()));
    let hub = HubWorld::<f32>::new(Default::default()).expect("defaults");
    run(&hub, &start(hub.scene()));
    let turning = TurningBody::<f32>::new(Default::default()).expect("defaults");
    run(&turning, &start(turning.scene()));
    let geared = GearedBody::<f32>::new(Default::default()).expect("defaults");
    run(&geared, &start(geared.scene()));
    let sliding = SlidingWorld::<f32>::new(Default::default()).expect("defaults");
    run(&sliding, &start(sliding.scene()));
    let holding = HoldingWorld::<f32>::new(Default::default()).expect("defaults");
    run(&holding, &start(holding.scene()));
    let double = LoopBody::<f64>::new(Default::default()).expect("defaults");
    let closed = LoopBody::<f32>::new(Default::default()).expect("defaults");
    run(&closed, &of_the_reference(&double, 0));
}

/// A state of `reference/loops`, at rest.
fn of_the_reference(model: &dyn Model<f64>, instant: usize) -> Vec<f64> {
    let file = load("loops/loop_RUSP.json");
    let history = &file["time_history"];
    let layout = model.layout();
    let mut state = vec![0.0; layout.nx()];
    for (body, slots) in layout.own_bodies() {
        let position = numbers(&history["r"][instant][body]);
        let attitude = numbers(&history["quat"][instant][body]);
        state[slots.q..slots.q + 3].copy_from_slice(&position);
        state[slots.q + 3..slots.q + 7].copy_from_slice(&attitude);
    }
    state
}

#[test]
fn the_declared_loop_closes_where_the_loop_of_the_reference_does() {
    let model = LoopBody::<f64>::new(Default::default()).expect("defaults");
    let layout = model.layout();
    assert_eq!(model.scene().angular_velocity, AngularVelocity::Body);
    assert_eq!((layout.nv, layout.nc), (18, 17));
    for instant in [0, 20, 50] {
        let state = of_the_reference(&model, instant);
        let rows = evaluate(model.scene(), Quantity::Constraint, &state, &[], &[]);
        assert_close(&rows, &[0.0; 17], 0.0, 1e-11, "rows of the closed loop");
    }
}
