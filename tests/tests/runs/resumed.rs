//! A run that goes on from a snapshot is the one that was not interrupted, to the bit, in whatever it remembers.

use mbd_runtime::{Generic, Options, Scalar, Simulation};
use mbd_scene::Scene;
use tests::declared::read;

/// A four-bar that a filtered motor drives, a pulse of time on its rocker, a winch, a pendulum that is locked and freed, a line that is detached, and
/// a weld that is attached.
fn machine(family: &str) -> Scene {
    read(&format!(
        "model Machine {{ gravity: [0, 0, -9.81] m/s^2; coordinates: {family};
            param k = 400 N/m;
            input wish: angle = 0.2 rad;
            state paid = 0.5 m {{ rate: 0.3 m/s * cos(7 * time / (1 s)) }}
            state turns = 0 {{ rate: 0 }}
            world {{ frame far at [2, 0, 0] m, frame top at [0, 0, 2] m }}
            body crank {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame a at [-0.25, 0, 0] m, frame b at [0.25, 0, 0] m }}
            body rod {{ mass: 1 kg, inertia: diag(0.3, 0.3, 0.3) kg*m^2, frame a at [-1, 0, 0] m, frame b at [1, 0, 0] m }}
            body rocker {{ mass: 1 kg, inertia: diag(0.2, 0.2, 0.2) kg*m^2, frame a at [0.6, 0, 0] m, frame b at [-0.6, 0, 0] m }}
            joint p1: hinge from world to crank.a {{ axis: y, motor: wish + 2 rad/s * time, filter: 50 ms }}
            joint p2: hinge from crank.b to rod.a {{ axis: y, start: about 20 deg }}
            joint p3: spherical from rod.b to rocker.a;
            joint p4: hinge from world.far to rocker.b {{ axis: y, start: about 60 deg, damping: 0.2 N*m*s }}
            load pulse on rocker at a = [40 N * exp(-((time - 0.7 s) / (20 ms))^2), 0 N, if(time > 0.4 s && time < 0.55 s, 5 N, 0 N)];
            body arm {{ mass: 0.5 kg, inertia: diag(0.02, 0.02, 0.01) kg*m^2, frame root at [0, 0, 0.3] m, frame tip at [0, 0, -0.3] m }}
            body hand {{ mass: 0.3 kg, inertia: diag(0.01, 0.02, 0.03) kg*m^2, frame root at [0, 0, 0.2] m }}
            joint sh: universal from world.top to arm.root {{ axes: [x, y], angle1: {{ start: 40 deg }}, angle2: {{ start: 10 deg, start_rate: 2 rad/s }} }}
            joint wr: hinge from arm.tip to hand.root {{ axis: x, start_rate: -3 rad/s, stops: [-100, 100] deg, stop_stiffness: 20 N*m/rad, stop_damping: 0.1 N*m*s }}
            point bob {{ mass: 0.4 kg, start at [0.3, 0.1, 0.6] m }}
            line rope from hand to bob {{ free_length: paid, stiffness: k, damping: 2 N*s/m }}
            spring tie from bob to rod.b {{ free_length: 1 m, stiffness: 20 N/m, damping: 0.3 N*s/m, at_start: detached }}
            event caught = wr.angle falls -0.5 rad {{ lock: wr, acts: once }}
            event freed = time rises 0.6 s {{ free: wr, set: k = 1.1 * k }}
            event tied = rope.stretch rises 10 mm {{ attach: tie, set: turns = turns + 1 }}
            event cut = time rises 1.1 s {{ detach: rope }}
            event held = sh.angle2 falls 0 rad {{ lock: sh.angle2, acts: once, set: bob.velocity.y = 0.5 m/s }}
            event loose = time rises 0.9 s {{ free: sh.angle2 }}
        }}"
    ))
}

/// The pauses of a run [s].
const PAUSES: [f64; 10] = [0.05, 0.21, 0.3, 0.41, 0.6, 0.69, 0.9, 1.1, 1.13, 1.4];

/// What a run is that never stops but pauses, and one that is made anew from a snapshot at every pause: all that their snapshots hold, at the first pause at which it
/// differs or at the last one. `None` where the method is not offered.
fn whole_and_resumed<T: Scalar>(
    model: &Generic<T>,
    options: Options,
    shift: f64,
) -> Option<[String; 2]> {
    let begin = || Simulation::new(model, options);
    let (mut whole, mut resumed) = (begin().ok()?, begin().ok()?);
    let mut told = [String::new(), String::new()];
    for (number, pause) in PAUSES.iter().enumerate() {
        for run in [&mut whole, &mut resumed] {
            if number == 2 {
                run.set_inputs(&[T::from_f64(0.5)]).expect("an angle");
            }
            run.run(pause + shift).expect("it runs");
        }
        told = [&whole, &resumed].map(|run| format!("{:?}", run.snapshot()));
        if told[0] != told[1] {
            return Some(told);
        }
        let kept = resumed.snapshot();
        resumed = begin().expect("as before");
        resumed.restore(&kept).expect("of the same model");
    }
    Some(told)
}

/// Where two texts differ first.
fn difference([whole, resumed]: &[String; 2]) -> String {
    let same = whole.bytes().zip(resumed.bytes());
    let same = same.take_while(|(a, b)| a == b).count();
    let part = |text: &str| text[same.saturating_sub(200)..(same + 60).min(text.len())].to_owned();
    format!("{}\n{}", part(whole), part(resumed))
}

fn assert_goes_on<T: Scalar>(family: &str, methods: &[Options], shifts: &[f64]) {
    let mut differ = Vec::new();
    let model = Generic::<T>::new(machine(family), &[T::from_f64(400.0)]).expect("a scene");
    for options in methods {
        for shift in shifts {
            let told = whole_and_resumed(&model, *options, *shift);
            let told = told.expect("a method that is offered");
            if told[0] != told[1] {
                let (method, where_) = (options.method, difference(&told));
                differ.push(format!("{method:?} {shift}:\n{where_}"));
            }
        }
    }
    assert!(differ.is_empty(), "{}", differ.join("\n"));
}

const SHIFTS: [f64; 2] = [0.0, 0.0137];

fn fixed_and_explicit() -> [Options; 4] {
    [
        Options::rk4(2e-3),
        Options::rk4(3.3e-3),
        Options::tsit5(1e-6),
        Options::vern7(1e-7),
    ]
}

fn stiff() -> [Options; 2] {
    [Options::rodas5p(1e-5), Options::auto(1e-6)]
}

fn in_single_precision() -> [Options; 5] {
    [
        Options::rk4(2e-3),
        Options::tsit5(1e-5),
        Options::vern7(1e-5),
        Options::rodas5p(1e-5),
        Options::auto(1e-5),
    ]
}

#[test]
fn a_machine_that_is_saved_at_any_instant_goes_on_to_the_bit() {
    assert_goes_on::<f64>("absolute", &fixed_and_explicit(), &SHIFTS);
}

#[test]
fn a_machine_that_is_saved_at_any_instant_of_stiff_steps_goes_on_to_the_bit() {
    assert_goes_on::<f64>("absolute", &stiff(), &SHIFTS);
}

#[test]
fn a_machine_in_relative_coordinates_goes_on_to_the_bit() {
    assert_goes_on::<f64>("relative", &fixed_and_explicit(), &SHIFTS);
}

#[test]
fn a_machine_in_relative_coordinates_goes_on_to_the_bit_in_stiff_steps() {
    assert_goes_on::<f64>("relative", &stiff(), &SHIFTS);
}

#[test]
fn a_machine_goes_on_to_the_bit_in_single_precision() {
    assert_goes_on::<f32>("absolute", &in_single_precision(), &[0.031]);
}

#[test]
fn a_machine_in_relative_coordinates_goes_on_to_the_bit_in_single_precision() {
    assert_goes_on::<f32>("relative", &in_single_precision(), &[0.031]);
}
