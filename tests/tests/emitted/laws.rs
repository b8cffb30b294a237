//! Laws of mechanics against closed forms that are written here anew: what a line pulls with, how an oblate planet attracts and what energy it
//! stores, what loads on an equilibrium point add up to, what a stepwise line remembers.

use mbd_compiler::Interpreted;
use mbd_runtime::node::{History, effective};
use mbd_runtime::{Generic, Model, Options, Quantity, Simulation};
use mbd_scene::laws::{LineNumbers, Numbers};
use mbd_scene::{Clamp, Difference, Scene, Scratch};
use nalgebra::Vector3;
use tests::declared::read;
use tests::instant::{Instant, random_instant, value};
use tests::random::Random;

/// The scene executed by the laws on numbers and by the program that is compiled from them.
fn executions(scene: &Scene) -> [(&'static str, Box<dyn Model<f64>>); 2] {
    let generic = Generic::with_defaults(scene.clone()).expect("a scene without parameters");
    let program = Interpreted::new(scene.clone(), &[]).expect("a scene without parameters");
    [
        ("generic", Box::new(generic)),
        ("interpreted", Box::new(program)),
    ]
}

/// An instant with this state where every element decides by itself.
fn free(model: &dyn Model<f64>, state: &[f64]) -> Instant<f64> {
    Instant {
        time: 0.0,
        state: state.to_vec(),
        nodes: Vec::new(),
        effective: Vec::new(),
        hold: vec![0.0; model.layout().one_way()],
        ends: Vec::new(),
        inputs: Vec::new(),
        rows: Vec::new(),
    }
}

#[test]
fn a_damped_line_that_decides_by_itself_never_pushes() {
    let (stiffness, damping, length): (f64, f64, f64) = (2e3, 40.0, 1.5);
    let law = format!(
        "{{ free_length: {length} m, stiffness: {stiffness} N/m, damping: {damping} N*s/m }}"
    );
    let points = format!(
        "model Points {{ gravity: none; point a {{ mass: 2.0 kg }} point b {{ mass: 5.0 kg }} line tie from a to b {law} }}"
    );
    let bodies = format!(
        "model Bodies {{
            gravity: none;
            body a {{ mass: 2.0 kg, inertia: diag(1.0, 1.0, 1.0) kg*m^2 }}
            body b {{ mass: 5.0 kg, inertia: diag(1.0, 1.0, 1.0) kg*m^2 }}
            joint a_free: free from world to a.com;
            joint b_free: free from world to b.com;
            line tie from a.com to b.com {law}
        }}"
    );
    let along = Vector3::new(2.0, -1.0, 2.0) / 3.0;
    for text in [points, bodies] {
        for (name, model) in executions(&read(&text)) {
            let layout = model.layout();
            // The second of the two moves; bodies stand upright.
            let (per_q, nq, nv) = (layout.nq / 2, layout.nq, layout.nv);
            let per_v = nv / 2;
            let mut pushing = 0;
            for stretch in [-0.3, -1e-9, 1e-9, 1e-3, 0.02, 0.3] {
                for rate in [-30.0, -1.5, -0.1, 0.0, 0.1, 1.5, 30.0] {
                    let mut state = vec![0.0; layout.nx()];
                    if per_q == 7 {
                        (state[3], state[per_q + 3]) = (1.0, 1.0);
                    }
                    for k in 0..3 {
                        state[per_q + k] = along[k] * (length + stretch);
                        state[nq + per_v + k] = along[k] * rate;
                    }
                    let force = stiffness * stretch + damping * rate;
                    pushing += usize::from(stretch > 0.0 && force < 0.0);
                    let want = if stretch > 0.0 { force.max(0.0) } else { 0.0 };
                    let instant = free(model.as_ref(), &state);
                    let lines = value(model.as_ref(), Quantity::Lines, &instant);
                    let slope = value(model.as_ref(), Quantity::Derivative, &instant);
                    let moved = Vector3::from_column_slice(&slope[nq + per_v..nq + per_v + 3]);
                    let close = |got: f64, what: &str| {
                        let error = (got - want).abs();
                        assert!(
                            error <= 1e-11 * (1.0 + force.abs()),
                            "{name}, s = {stretch} m, ṡ = {rate} m/s: {what} {got} N, {want} N expected"
                        );
                    };
                    close(lines[0], "tension");
                    close(-5.0 * moved.dot(&along), "force on the second");
                    assert!(lines[0] >= 0.0);
                }
            }
            assert!(pushing > 5, "{pushing}");
        }
    }
}

/// A planet of J2 whose axis points along `axis`, and one mass near it.
fn planet(axis: [f64; 3]) -> Scene {
    let [x, y, z] = axis;
    read(&format!(
        "model Planet {{
            gravity: oblate {{ mu: {MU:?} m^3/s^2, center: [{:?}, {:?}, {:?}] m, radius: {RADIUS:?} m, j2: {J2:?}, axis: [{x:?}, {y:?}, {z:?}] }};
            point satellite {{ mass: {MASS:?} kg }}
        }}",
        CENTER[0], CENTER[1], CENTER[2]
    ))
}

const MU: f64 = 4.0e5;
const RADIUS: f64 = 60.0;
const J2: f64 = 0.08;
const MASS: f64 = 3.0;
const CENTER: [f64; 3] = [10.0, -70.0, 45.0];

/// The energy [J] at d from the centre of a planet with this axis.
type Potential = fn(&Vector3<f64>, &Vector3<f64>) -> f64;

/// U = −(μ m/r) (1 − J2 (R/r)² P₂(sin φ)), the potential of an oblate planet, for d from its centre [J].
fn potential(d: &Vector3<f64>, axis: &Vector3<f64>) -> f64 {
    let (r, sine) = (d.norm(), d.dot(axis) / d.norm());
    let legendre = (3.0 * sine * sine - 1.0) / 2.0;
    -(MU * MASS / r) * (1.0 - J2 * (RADIUS / r).powi(2) * legendre)
}

/// Places all around the planet, 0.9 to 3 radii from its centre.
fn around(random: &mut Random) -> Vector3<f64> {
    Vector3::from(random.vector(1.0)).normalize() * random.uniform(0.9, 3.0) * RADIUS
}

#[test]
fn an_oblate_planet_attracts_as_its_textbook_components_say() {
    // Components for the axis z, as D. Vallado, Fundamentals of Astrodynamics and Applications, writes them:
    // x, y: −μ x/r³ (1 − 3/2 J2 (R/r)² (5 z²/r² − 1)),  z: −μ z/r³ (1 − 3/2 J2 (R/r)² (5 z²/r² − 3)).
    let mut random = Random::new(71);
    for (name, model) in executions(&planet([0.0, 0.0, 1.0])) {
        for _ in 0..50 {
            let d = around(&mut random);
            let r = d.norm();
            let k = 1.5 * J2 * (RADIUS / r).powi(2);
            let ratio = 5.0 * (d.z / r).powi(2);
            let factor = [1.0, 1.0, 3.0].map(|less| 1.0 - k * (ratio - less));
            let place = d + Vector3::from(CENTER);
            let mut state = place.as_slice().to_vec();
            state.extend([0.0; 3]);
            let instant = free(model.as_ref(), &state);
            let slope = value(model.as_ref(), Quantity::Derivative, &instant);
            for axis in 0..3 {
                let want = -MU * d[axis] / r.powi(3) * factor[axis];
                let error = (slope[3 + axis] - want).abs();
                assert!(error <= 1e-12 * MU / (r * r), "{name}, {d:?}: {error:e}");
            }
        }
    }
}

#[test]
fn the_energy_of_gravity_is_the_potential_whose_slope_is_the_force() {
    let axis = Vector3::new(0.6, 0.0, 0.8);
    let mut random = Random::new(72);
    let point_mass = format!(
        "model PointMass {{
            gravity: point_mass {{ mu: {MU:?} m^3/s^2, center: [{:?}, {:?}, {:?}] m }};
            point satellite {{ mass: {MASS:?} kg }}
        }}",
        CENTER[0], CENTER[1], CENTER[2]
    );
    let sphere = |d: &Vector3<f64>, _: &Vector3<f64>| -MU * MASS / d.norm();
    let cases: [(Scene, Potential); 2] = [
        (planet([0.6, 0.0, 0.8]), potential),
        (read(&point_mass), sphere),
    ];
    for (scene, law) in cases {
        for (name, model) in executions(&scene) {
            let evaluated = |d: &Vector3<f64>| {
                let place = d + Vector3::from(CENTER);
                let mut state = place.as_slice().to_vec();
                state.extend([0.0; 3]);
                let instant = free(model.as_ref(), &state);
                let slope = value(model.as_ref(), Quantity::Derivative, &instant);
                let energy = value(model.as_ref(), Quantity::Energy, &instant)[1];
                (energy, Vector3::from_column_slice(&slope[3..]) * MASS)
            };
            let (origin, _) = evaluated(&-Vector3::from(CENTER));
            for _ in 0..50 {
                let d = around(&mut random);
                let (energy, force) = evaluated(&d);
                // Where a potential is zero is a choice: differences count.
                let rise = law(&d, &axis) - law(&-Vector3::from(CENTER), &axis);
                let error = (energy - origin - rise).abs();
                assert!(error <= 1e-12 * MU * MASS / RADIUS, "{name}: {error:e} J");
                // Fourth-order differences of the energy: 1e-10 of the force with steps of 0.05 m.
                let step = 0.05;
                for k in 0..3 {
                    let at = |steps: f64| evaluated(&(d + Vector3::ith(k, steps * step))).0;
                    let slope = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * step);
                    let error = (force[k] + slope).abs();
                    assert!(
                        error <= 1e-8 * force.norm(),
                        "{name}, axis {k}: {error:e} N"
                    );
                }
            }
        }
    }
}

#[test]
fn all_loads_on_an_equilibrium_point_add_up() {
    // A knot on one line that pulls: it stands where the line points along the sum W of its loads, stretched by |W|/K.
    let (stiffness, length) = (4e3, 1.2);
    let total: Vector3<f64> = Vector3::new(12.0, -5.0, -40.0)
        + Vector3::new(-4.0, 9.0, -20.0)
        + Vector3::new(1.0, 2.0, 3.0);
    let want = total.normalize() * (length + total.norm() / stiffness);
    for (equilibrium, damping) in [("static", ""), ("stepwise", ", damping: 40 N*s/m")] {
        let scene = read(&format!(
            "model Hung {{
                gravity: none;
                point knot {{ equilibrium: {equilibrium} }}
                line up from world to knot {{ free_length: {length} m, stiffness: {stiffness} N/m{damping} }}
                line spare from world to knot {{ free_length: 9 m, stiffness: {stiffness} N/m{damping} }}
                load first on knot = [12.0, -5.0, -40.0] N;
                load second on knot = [-4.0, 9.0, -20.0] N;
                load third on knot = [1.0, 2.0, 3.0] N;
            }}"
        ));
        for (name, model) in executions(&scene) {
            let mut simulation =
                Simulation::new(model.as_ref(), Options::rk4(0.01)).expect("options that fit");
            simulation.set_nodes(&[0.0, 0.0, -1.0]).expect("a guess");
            simulation.run(1.0).expect("the loads are balanced");
            let mut lines = [0.0_f64; 20];
            let found = simulation.evaluate(Quantity::Lines, &mut lines);
            found.expect("a balance");
            let place = Vector3::from_column_slice(simulation.nodes());
            let force: f64 = (lines[0] - total.norm()).abs();
            assert!(force <= 1e-9, "{equilibrium}, {name}: {force:e} N");
            let away = (place - want).norm();
            assert!(away <= 1e-12, "{equilibrium}, {name}: {away:e} m");
        }
    }
}

#[test]
fn a_stepwise_line_remembers_the_positive_part_of_its_stretch_only() {
    // T = [K s + (C/τ)(w0 s − m)]₊ over the free length with the differences of s⁺, m ≥ 0, and nothing below the free length.
    let numbers = LineNumbers {
        stiffness: 3e3,
        damping: 45.0,
        free_length: 1.1,
    };
    let mut random = Random::new(73);
    let mut slack_memories = 0;
    for _ in 0..2000 {
        let tau = random.decades(-3.0, -1.0);
        let step = random.decades(-3.0, -1.0);
        let (last, before) = (random.uniform(-0.2, 0.2), random.uniform(-0.6, 0.6));
        let theta = tau / step;
        let plus = |s: f64| s.max(0.0);
        let euler = [1.0, plus(last)];
        let bdf2 = [
            (1.0 + 2.0 * theta) / (1.0 + theta),
            plus((1.0 + theta) * plus(last) - theta * theta / (1.0 + theta) * plus(before)),
        ];
        slack_memories += usize::from(last < 0.0 || before < 0.0);
        for (formula, before, [weight, memory]) in [
            (Difference::Euler, None, euler),
            (Difference::Bdf2, None, euler),
            (Difference::Bdf2, Some((before, step)), bdf2),
        ] {
            let history = History { last, before };
            let [k, l] = effective(&numbers, formula, Clamp::Positive, tau, history);
            for _ in 0..5 {
                let stretch = random.uniform(-0.1, 0.3);
                let rate = numbers.damping / tau;
                let pull = numbers.stiffness * stretch + rate * (weight * stretch - memory);
                let want = if stretch > 0.0 { pull.max(0.0) } else { 0.0 };
                let got = k * (numbers.free_length + stretch - l).max(0.0);
                let error = (got - want).abs();
                assert!(
                    error <= 1e-12 * k,
                    "{formula:?}, s {stretch}, {history:?}: {got} N, {want} N expected"
                );
            }
        }
    }
    assert!(slack_memories > 500, "{slack_memories}");
}

#[test]
fn the_masses_are_the_diagonal_of_the_mass_matrix() {
    for plane in ["", "planar: xz;"] {
        for components in ["body", "world"] {
            let inertia = match plane {
                "" => {
                    "full { xx: 2.0, yy: 2.5, zz: 3.0, xy: 0.1, xz: -0.2, yz: 0.15 } kg*m^2 (matrix elements)"
                }
                _ => "diag(2.0, 2.5, 3.0) kg*m^2",
            };
            let scene = read(&format!(
                "model Masses {{
                    gravity: none;
                    {plane}
                    angular_velocity: {components};
                    point stone {{ mass: 0.5 kg }}
                    body ship {{ mass: 7.0 kg, inertia: {inertia} }}
                    body boat {{ mass: 3.0 kg, inertia: {inertia} }}
                    joint ship_free: free from world to ship.com;
                    joint boat_free: free from world to boat.com;
                }}"
            ));
            let layout = mbd_scene::Layout::new(&scene);
            let instant = random_instant(&scene, &mut Random::new(74));
            let mut masses = vec![0.0; layout.nv];
            mbd_scene::masses(
                &scene,
                &layout,
                &Numbers::new(&scene, &[]),
                &instant.at(),
                &mut Scratch::new(&layout),
                &mut masses,
            );
            let model = Generic::with_defaults(scene).expect("a scene without parameters");
            let matrix = value(&model, Quantity::MassMatrix, &instant);
            let diagonal: Vec<f64> = matrix.iter().step_by(layout.nv + 1).copied().collect();
            assert_eq!(masses, diagonal, "{plane} {components}");
        }
    }
}
