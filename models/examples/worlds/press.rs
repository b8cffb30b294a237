//! A press: a flywheel drives a ram through crank and rod, a motor gives the wheel back what the die has taken.
//!
//! With the crank at φ from the bottom the ram is at `z = −r cos φ − √(l² − r² sin² φ)`. What the wheel loses in a stroke is what the die takes.

use mbd_runtime::{Options, RunError, Simulation, model};

use crate::Outcome;

model! {
    /// A press of 220 kN whose motor has the torque of its speed.
    model Press {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        planar: xz;
        const r = 80 mm;
        const l = 400 mm;
        const ratio = 20;
        table motor_torque = {
            0 rpm: 180 N*m, 1200 rpm: 240 N*m, 1420 rpm: 120 N*m, 1500 rpm: 0 N*m,
            1600 rpm: -200 N*m,
        };
        smooth table die = { 0 mm: 0 kN, 3 mm: 160 kN, 8 mm: 220 kN };
        body flywheel { mass: 300 kg, inertia: diag(20, 40, 20) kg*m^2, frame pin at [0, 0, -r] }
        body conrod {
            mass: 12 kg,
            inertia: diag(0.2, 0.2, 0.01) kg*m^2,
            frame big at [0, 0, l / 2],
            frame small at [0, 0, -l / 2],
        }
        body ram { mass: 90 kg, inertia: diag(2, 2, 2) kg*m^2 }
        let depth = -ram.position.z - r - l + 8 mm;
        joint crank: hinge from world to flywheel.com {
            axis: y,
            start: 120 deg,
            start_rate: 7 rad/s,
            force: ratio * motor_torque(ratio * crank.angle_rate),
        }
        joint big: hinge from flywheel.pin to conrod.big { axis: y }
        joint small: hinge from conrod.small to ram.com { axis: y }
        loop joint slide: prismatic from world to ram.com { axis: z }
        load work on ram = [0 N, 0 N, if(ram.velocity.z < 0 m/s, die(depth), 0 N)];
        state taken = 0 J { rate: if(ram.velocity.z < 0 m/s, -die(depth) * ram.velocity.z, 0 W) }
        output speed = crank.angle_rate in rpm;
        output force = die(depth) in kN;
        output stored = energy.kinetic in kJ;
    }
}

fn running() -> Result<Simulation<f64>, RunError> {
    let model = Press::new(PressParams::default()).expect("defaults in their ranges");
    let options = Options {
        work: true,
        ..Options::tsit5(1e-9)
    };
    Simulation::new(&model, options)
}

/// Angle of the crank from the bottom and its rate, height of the ram and its velocity.
fn seen(simulation: &Simulation<f64>) -> [f64; 4] {
    let state = PressState::from_slice(simulation.state()).expect("the state of this model");
    let (wheel, ram) = (state.flywheel(), state.ram());
    [
        wheel.angle,
        wheel.angular_velocity,
        ram.position[1],
        ram.velocity[1],
    ]
}

/// Prints a stroke.
pub fn run() -> Outcome {
    let mut simulation = running()?;
    println!("time [s]  crank [deg]  speed [rpm]  ram [mm]");
    for step in 0..=24 {
        simulation.run(0.05 * f64::from(step))?;
        let [angle, rate, height, _] = seen(&simulation);
        println!(
            "{:8.2}  {:11.1}  {:11.2}  {:8.2}",
            simulation.time(),
            angle.to_degrees(),
            rate * 60.0 / std::f64::consts::TAU,
            1e3 * height
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ram_is_where_crank_and_rod_take_it() {
        let mut simulation = running().unwrap();
        for step in 0..60 {
            simulation.run(0.025 * f64::from(step)).unwrap();
            let [angle, rate, height, velocity] = seen(&simulation);
            let (sin, cos) = angle.sin_cos();
            let rod = (0.16 - 0.0064 * sin * sin).sqrt();
            let want = [
                -0.08 * cos - rod,
                rate * (0.08 * sin + 0.0064 * sin * cos / rod),
            ];
            assert!((height - want[0]).abs() < 1e-9, "{step}: {height} {want:?}");
            assert!(
                (velocity - want[1]).abs() < 1e-8,
                "{step}: {velocity} {want:?}"
            );
        }
    }

    #[test]
    fn what_the_die_takes_in_a_stroke_is_the_area_under_its_table() {
        let mut simulation = running().unwrap();
        simulation.run(0.85).unwrap();
        let [angle, ..] = seen(&simulation);
        // Past the bottom once.
        assert!(angle > std::f64::consts::TAU && angle < 1.5 * std::f64::consts::TAU);
        // Cubics with the slopes 0, m, 0 [kN/mm]: h (y₀ + y₁)/2 + h² (m₀ − m₁)/12 each.
        let slope = 24.0 / (13.0 / (160.0 / 3.0) + 11.0 / 12.0);
        let area = 3.0 * 80.0 - 9.0 * slope / 12.0 + 5.0 * 190.0 + 25.0 * slope / 12.0;
        let state = PressState::from_slice(simulation.state()).expect("the state of this model");
        assert!(
            (state.taken() - area).abs() < 1e-4 * area,
            "{} {area}",
            state.taken()
        );
    }

    #[test]
    fn energy_is_what_the_motor_gives_less_what_the_die_takes() {
        let mut simulation = running().unwrap();
        simulation.start().unwrap();
        let energy = |simulation: &mut Simulation<f64>| {
            let mut out = [0.0; 6];
            simulation
                .evaluate(mbd_runtime::Quantity::Energy, &mut out)
                .unwrap();
            out[0] + out[1]
        };
        let before = energy(&mut simulation);
        simulation.run(1.2).unwrap();
        let gained = energy(&mut simulation) - before;
        let given: f64 = simulation.work().expect("asked for").iter().sum();
        assert!((gained - given).abs() < 1e-2, "{gained} {given}");
    }
}
