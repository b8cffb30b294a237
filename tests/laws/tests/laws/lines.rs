//! Lines and springs between all kinds of places: what they pull with, what they store and lose, their stiffness and their guards.

use laws::assert_close;
use laws::instant::Instant;
use laws::mechanism::{
    Instance, Seat, add_body, add_frame, add_point, empty, evaluate_at, frame, inertia, layout,
    state,
};
use laws::random::Random;
use mbd_scene::{
    Actions, AngularVelocity, Detachable, Direction, Event, Formula, Function, LineKind, Place,
    Quantity, Scene, Table,
};
use nalgebra::{Matrix3, Vector3};

use crate::things::{at_state, direction, line};

/// The rows of the table of forces over stretch.
const ROWS: [[f64; 2]; 4] = [[0.0, 0.0], [0.1, 30.0], [0.3, 180.0], [0.6, 900.0]];

/// f of a law of stiffness `k`, its slope, and the energy from 0 to s ≥ 0.
fn elastic(kind: LineKind, k: f64, s: f64) -> [f64; 3] {
    let LineKind::Table(_) = kind else {
        return [k * s, k, 0.5 * k * s * s];
    };
    let piece = match s {
        s if s < ROWS[1][0] => 0,
        s if s < ROWS[2][0] => 1,
        _ => 2,
    };
    let slope_of = |n: usize| (ROWS[n + 1][1] - ROWS[n][1]) / (ROWS[n + 1][0] - ROWS[n][0]);
    let force = |s: f64, n: usize| ROWS[n][1] + slope_of(n) * (s - ROWS[n][0]);
    // Trapezia: the force is straight over each piece.
    let mut energy = 0.0;
    for n in 0..=piece {
        let end = if n == piece { s } else { ROWS[n + 1][0] };
        energy += 0.5 * (ROWS[n][1] + force(end, n)) * (end - ROWS[n][0]);
    }
    [force(s, piece), slope_of(piece), energy]
}

/// Two bodies, two points and a place in the world, with one line that nothing holds yet.
struct Rig {
    scene: Scene,
    seats: [Seat; 2],
    post: Vector3<f64>,
}

impl Rig {
    fn new(components: AngularVelocity, random: &mut Random) -> Self {
        let mut scene = empty([0.0; 3], components);
        let post = Vector3::from(random.vector(1.0));
        add_frame(&mut scene, None, frame("post", post.into(), None));
        let seats = [Seat::random(random), Seat::random(random)];
        for seat in seats {
            let body = add_body(&mut scene, random.uniform(1.0, 3.0), &inertia(random));
            add_frame(&mut scene, Some(body), seat.declared("seat"));
            add_point(&mut scene, random.uniform(1.0, 3.0));
        }
        scene.tables.push(Table {
            name: "webbing".to_owned(),
            doc: String::new(),
            x: ROWS.map(|[x, _]| x).to_vec(),
            y: ROWS.map(|[_, y]| y).to_vec(),
            x_unit: mbd_scene::Unit::default(),
            y_unit: mbd_scene::Unit::default(),
            second: None,
            smooth: false,
        });
        Rig { scene, seats, post }
    }

    /// Where a place is, and how it moves.
    fn motion(&self, place: Place, bodies: &[Instance], points: &[Instance]) -> [Vector3<f64>; 2] {
        match place {
            Place::World(_) => [self.post, Vector3::zeros()],
            Place::Body(body, _) => {
                let arm = bodies[body].rotation() * self.seats[body].point;
                let spin = bodies[body].omega.cross(&arm);
                [bodies[body].position + arm, bodies[body].velocity + spin]
            }
            Place::Point(point) => [points[point].position, points[point].velocity],
        }
    }
}

const POST: Place = Place::World(1);
const PLACES: [[Place; 2]; 5] = [
    [POST, Place::Body(0, 1)],
    [Place::Body(0, 1), Place::Body(1, 1)],
    [Place::Body(1, 1), Place::Point(0)],
    [Place::Point(1), Place::Point(0)],
    [Place::Point(0), POST],
];

const COMPONENTS: [AngularVelocity; 2] = [AngularVelocity::Body, AngularVelocity::World];

/// The bodies and the points with the `to` end of a line at `vector` from its `from` end and moving at `rate` against it.
fn arranged(
    rig: &Rig,
    places: [Place; 2],
    [vector, rate]: [Vector3<f64>; 2],
    random: &mut Random,
) -> [Vec<Instance>; 2] {
    let mut bodies = vec![Instance::random(random), Instance::random(random)];
    let mut points = bodies.clone();
    // The post does not move: what is tied to it does.
    let (moved, [from, to]) = match places[1] {
        Place::World(_) => (places[0], [places[1], places[0]]),
        _ => (places[1], places),
    };
    let sign = if moved == places[1] { 1.0 } else { -1.0 };
    let ends = [from, to].map(|place| rig.motion(place, &bodies, &points));
    let shift = ends[0][0] + vector * sign - ends[1][0];
    let push = ends[0][1] + rate * sign - ends[1][1];
    let part = match moved {
        Place::Body(body, _) => &mut bodies[body],
        Place::Point(point) => &mut points[point],
        Place::World(_) => unreachable!("the post does not move"),
    };
    part.position += shift;
    part.velocity += push;
    [bodies, points]
}

/// The forces f along the speeds of a force on the `from` end and its opposite on the `to` end.
fn along_speeds(
    rig: &Rig,
    places: [Place; 2],
    force: Vector3<f64>,
    bodies: &[Instance],
) -> Vec<f64> {
    let layout = layout(&rig.scene);
    let mut f = vec![0.0; layout.nv];
    for (place, force) in places.iter().zip([force, -force]) {
        match *place {
            Place::World(_) => {}
            Place::Body(body, _) => {
                let arm = bodies[body].rotation() * rig.seats[body].point;
                let torque =
                    bodies[body].in_components(arm.cross(&force), rig.scene.angular_velocity);
                for k in 0..3 {
                    f[6 * body + k] += force[k];
                    f[6 * body + 3 + k] += torque[k];
                }
            }
            Place::Point(point) => {
                for k in 0..3 {
                    f[12 + 3 * point + k] += force[k];
                }
            }
        }
    }
    f
}

/// A stretch and its rate, along a line whose numbers are free length, stiffness and damping.
struct Pulled {
    kind: LineKind,
    numbers: [f64; 3],
    stretch: f64,
    rate: f64,
}

impl Pulled {
    /// f + C ṡ.
    fn pull(&self) -> f64 {
        let [force, ..] = elastic(self.kind, self.numbers[1], self.stretch);
        force + self.numbers[2] * self.rate
    }

    /// What it carries under a hold.
    fn tension(&self, hold: f64) -> f64 {
        let taut = self.stretch > 0.0;
        match (self.kind, hold) {
            (LineKind::Spring, _) => self.pull(),
            (_, 1.0) => self.pull(),
            (_, -1.0) => 0.0,
            _ if taut => self.pull().max(0.0),
            _ => 0.0,
        }
    }
}

fn kinds() -> [LineKind; 3] {
    [LineKind::Line, LineKind::Spring, LineKind::Table(0)]
}

/// Calls `check` for every law, damped or not, between all kinds of places, at stretches on both sides of zero.
fn everywhere(
    mut check: impl FnMut(&Rig, [Place; 2], &Pulled, Vector3<f64>, &[Vec<Instance>; 2], &Instant<f64>),
) {
    let mut random = Random::new(21);
    for components in COMPONENTS {
        for kind in kinds() {
            for damping in [0.0, 40.0] {
                for places in PLACES {
                    let mut rig = Rig::new(components, &mut random);
                    let numbers = [1.5, 400.0, damping];
                    rig.scene.lines.push(line(kind, places, numbers));
                    for stretch in [-0.3, -0.02, 0.03, 0.2, 0.7] {
                        for rate in [-8.0, -0.4, 0.0, 0.5, 8.0] {
                            let u = direction(&mut random);
                            let across = u.cross(&direction(&mut random));
                            let pulled = Pulled {
                                kind,
                                numbers,
                                stretch,
                                rate,
                            };
                            let vectors = [u * (1.5 + stretch), u * rate + across];
                            let parts = arranged(&rig, places, vectors, &mut random);
                            let x = state(&rig.scene, &parts[0], &parts[1]);
                            check(&rig, places, &pulled, u, &parts, &at_state(x, 1));
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn lines_pull_and_springs_push_by_stretch_and_rate_on_both_their_ends() {
    everywhere(|rig, places, pulled, u, [bodies, _], at| {
        for hold in [0.0, 1.0, -1.0] {
            let mut at = at.clone();
            at.hold[0] = hold;
            let tension = pulled.tension(hold);
            let got = evaluate_at(&rig.scene, Quantity::Forces, &at.at());
            let want = along_speeds(rig, places, u * tension, bodies);
            let name = format!("{places:?}, {:?} held {hold}", rig.scene.lines[0].kind);
            assert_close(&got, &want, 1e-11, 1e-10, &name);
            let told = evaluate_at(&rig.scene, Quantity::Lines, &at.at());
            // What is told of a line never pushes.
            let told_tension = match pulled.kind {
                LineKind::Spring => tension,
                _ => tension.max(0.0),
            };
            let want = [
                told_tension,
                1.5 + pulled.stretch,
                pulled.stretch,
                pulled.rate,
            ];
            assert_close(&told[..4], &want, 1e-11, 1e-10, &name);
        }
        let guards = evaluate_at(&rig.scene, Quantity::Guards, &at.at());
        let want = [pulled.stretch, pulled.pull()];
        assert_close(&guards, &want, 1e-11, 1e-10, "guards");
    });
}

#[test]
fn what_lines_store_and_lose_is_the_area_below_their_force() {
    everywhere(|rig, _, pulled, _, _, at| {
        let energy = evaluate_at(&rig.scene, Quantity::Energy, &at.at());
        let acting = match pulled.kind {
            LineKind::Spring => pulled.stretch,
            _ => pulled.stretch.max(0.0),
        };
        let [force, _, stored] = elastic(pulled.kind, pulled.numbers[1], acting);
        let lost = match pulled.numbers[2] {
            0.0 => 0.0,
            _ => -(pulled.tension(0.0) - force) * pulled.rate,
        };
        assert_close(&energy[2..5], &[stored, 0.0, lost], 1e-10, 1e-9, "energy");
        assert!(energy[4] <= 1e-9, "dampers take: {}", energy[4]);
    });
}

#[test]
fn the_stiffness_of_a_line_is_the_slope_of_its_force() {
    everywhere(|rig, _, pulled, u, _, at| {
        let told = evaluate_at(&rig.scene, Quantity::Lines, &at.at());
        let tension = pulled.tension(0.0);
        let [_, slope, _] = elastic(pulled.kind, pulled.numbers[1], pulled.stretch);
        let along = u * u.transpose();
        let across = Matrix3::identity() - along;
        let want = match pulled.stretch >= 0.0 {
            true => along * slope + across * (tension / (1.5 + pulled.stretch)),
            false => Matrix3::zeros(),
        };
        let want = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|at| want[at]);
        assert_close(&told[4..], &want, 1e-11, 1e-9, "stiffness");
    });
}

#[test]
fn a_line_without_free_length_is_as_stiff_across_as_along_even_without_length() {
    let mut random = Random::new(22);
    for kind in kinds() {
        let mut rig = Rig::new(AngularVelocity::Body, &mut random);
        let places = [POST, Place::Point(0)];
        rig.scene.lines.push(line(kind, places, [0.0, 300.0, 0.0]));
        for length in [0.0, 0.05, 0.2] {
            let vectors = [direction(&mut random) * length, Vector3::zeros()];
            let parts = arranged(&rig, places, vectors, &mut random);
            let x = state(&rig.scene, &parts[0], &parts[1]);
            let told = evaluate_at(&rig.scene, Quantity::Lines, &at_state(x, 1).at());
            let [force, slope, _] = elastic(kind, 300.0, length);
            let u = vectors[0].try_normalize(1e-9).unwrap_or(Vector3::x());
            let across = if length > 0.0 { force / length } else { slope };
            let along = u * u.transpose();
            let want = along * slope + (Matrix3::identity() - along) * across;
            let want = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|at| want[at]);
            assert_close(&told[..3], &[force, length, length], 1e-9, 1e-12, "told");
            assert_close(&told[4..], &want, 1e-9, 1e-9, "stiffness");
        }
        // With a free length it is slack there.
        rig.scene.lines[0].free_length = 0.5.into();
        let parts = arranged(&rig, places, [Vector3::zeros(); 2], &mut random);
        let x = state(&rig.scene, &parts[0], &parts[1]);
        let told = evaluate_at(&rig.scene, Quantity::Lines, &at_state(x, 1).at());
        let tension = match kind {
            LineKind::Spring => -150.0,
            _ => 0.0,
        };
        assert_close(&told[..3], &[tension, 0.0, -0.5], 1e-9, 1e-12, "told");
        assert_close(&told[4..], &[0.0; 6], 0.0, 0.0, "stiffness");
    }
}

#[test]
fn what_is_detached_pulls_stores_and_loses_nothing() {
    let mut random = Random::new(23);
    for kind in kinds() {
        let mut rig = Rig::new(AngularVelocity::Body, &mut random);
        let places = [POST, Place::Body(0, 1)];
        rig.scene.lines.push(line(kind, places, [1.0, 300.0, 20.0]));
        rig.scene.events.push(Event {
            name: "cut".to_owned(),
            doc: String::new(),
            guard: Formula::Time,
            direction: Direction::Rises,
            actions: Actions {
                detach: vec![Detachable::Line(0)],
                ..Actions::default()
            },
        });
        let u = direction(&mut random);
        let parts = arranged(&rig, places, [u * 1.4, u * 0.3], &mut random);
        let x = state(&rig.scene, &parts[0], &parts[1]);
        let mut at = at_state(x, 1);
        for (hold, attached) in [(0.0, 1.0), (-2.0, 0.0)] {
            at.hold[0] = hold;
            let [force, slope, stored] = elastic(kind, 300.0, 0.4);
            let tension = attached * (force + 20.0 * 0.3);
            let told = evaluate_at(&rig.scene, Quantity::Lines, &at.at());
            let energy = evaluate_at(&rig.scene, Quantity::Energy, &at.at());
            let forces = evaluate_at(&rig.scene, Quantity::Forces, &at.at());
            let want = along_speeds(&rig, places, u * tension, &parts[0]);
            assert_close(&told[..1], &[tension], 1e-11, 1e-12, "tension");
            assert_close(&forces, &want, 1e-11, 1e-11, "force");
            let want = [attached * stored, 0.0, -attached * 20.0 * 0.3 * 0.3];
            assert_close(&energy[2..5], &want, 1e-10, 1e-12, "energy");
            let trace = told[4] + told[7] + told[9];
            let want = attached * slope + 2.0 * tension / 1.4;
            assert_close(&[trace], &[want], 1e-10, 1e-12, "stiffness");
        }
    }
}

#[test]
fn a_winch_changes_the_stretch_and_gives_what_it_pulls_in() {
    let mut random = Random::new(24);
    let places = [POST, Place::Point(0)];
    // L0 = 2 − 0.3 t − 0.05 t², at t = 1.5 s: 1.4375 m, at −0.45 m/s.
    let time = || Formula::Time;
    let product = |a: Formula, b: Formula| Formula::Apply(Function::Mul, vec![a, b]);
    let minus = |a: Formula, b: Formula| Formula::Apply(Function::Sub, vec![a, b]);
    let bent = minus(
        minus(2.0.into(), product(0.3.into(), time())),
        product(0.05.into(), product(time(), time())),
    );
    let given = Formula::Vector(vec![1.4375.into(), (-0.45).into()]);
    for free_length in [bent, given] {
        for damping in [0.0, 25.0] {
            let mut rig = Rig::new(AngularVelocity::Body, &mut random);
            let mut wound = line(LineKind::Line, places, [0.0, 300.0, damping]);
            wound.free_length = free_length.clone();
            rig.scene.lines.push(wound);
            let u = direction(&mut random);
            let parts = arranged(&rig, places, [u * 1.8375, u * 0.2], &mut random);
            let mut at = at_state(state(&rig.scene, &parts[0], &parts[1]), 1);
            at.time = 1.5;
            let (stretch, rate) = (0.4, 0.65);
            let tension = 300.0 * stretch + damping * rate;
            let told = evaluate_at(&rig.scene, Quantity::Lines, &at.at());
            let want = [tension, 1.8375, stretch, rate];
            assert_close(&told[..4], &want, 1e-11, 0.0, "line");
            let guards = evaluate_at(&rig.scene, Quantity::Guards, &at.at());
            assert_close(&guards, &[stretch, tension], 1e-11, 0.0, "guards");
            let energy = evaluate_at(&rig.scene, Quantity::Energy, &at.at());
            let want = [
                150.0 * stretch * stretch,
                0.0,
                -damping * rate * rate,
                0.45 * tension,
            ];
            assert_close(&energy[2..6], &want, 1e-11, 1e-12, "energy");
        }
    }
}
