//! A capsule that comes down in phases, all of them declared: a drogue on a strap, cut when the reefed main parachute comes out; the full parachute;
//! a heat shield that drops; the landing, which ends the run.
//!
//! Under a parachute of area C_D S the speed settles at `v = √(2 m g/(ρ C_D S))`. Energy is lost by drag, by the damping of the strap and by what the
//! phases take along; with all of it the balance closes.

use mbd_runtime::{Content, Options, RunError, Sampling, Simulation, Stop, Trajectory, model};

use crate::Outcome;

model! {
    /// A capsule of 900 kg from 8 km on.
    model StagedDescent {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param mass = 900 kg in 500 kg ..= 1200 kg;
        param cd_s = 2 m^2 in 1 m^2 ..= 800 m^2;
        point capsule { mass: mass, start at [0.0, 0.0, 8000.0] m velocity [40.0, 0.0, -150.0] m/s }
        point drogue { mass: 8 kg, start at [0.0, 0.0, 8020.0] m velocity [40.0, 0.0, -150.0] m/s }
        line strap from capsule to drogue {
            free_length: 20 m,
            stiffness: 20 kN/m,
            damping: 800 N*s/m,
        }
        let air = 1.2 kg/m^3 * exp(-capsule.position.z / (8.5 km));
        load drag on capsule = -0.5 * air * cd_s * norm(capsule.velocity) * capsule.velocity;
        load braking on drogue = -0.5 * air * 6 m^2 * norm(drogue.velocity) * drogue.velocity;
        event main_out = capsule.position.z falls 4000 m {
            detach: strap,
            set: cd_s = 40 m^2,
            acts: once,
        }
        event disreefed = capsule.position.z falls 3500 m { set: cd_s = 400 m^2, acts: once }
        event shield_off = capsule.position.z falls 2500 m { set: mass = mass - 200 kg, acts: once }
        event landed = capsule.position.z falls 0 m { then: stop }
        output height = capsule.position.z;
        output pull = strap.tension in kN;
    }
}

/// The whole descent with a history of every second.
fn descent(model: &StagedDescent) -> Result<(Simulation<f64>, Trajectory), RunError> {
    let options = Options {
        work: true,
        ..Options::tsit5(1e-9)
    };
    let mut run = Simulation::new(model, options)?;
    let mut history = Trajectory::new(model, Sampling::Every(1.0), Content::ALL);
    let end = run.record(3600.0, &mut history)?;
    assert_eq!(end, Stop::Event(3), "the landing");
    Ok((run, history))
}

/// Prints the phases.
pub fn run() -> Outcome {
    let model = StagedDescent::new(StagedDescentParams::default())?;
    let (run, history) = descent(&model)?;
    println!("{:12} {:>9}", "event", "time [s]");
    for (time, name) in &history.events {
        println!("{name:12} {time:>9.2}");
    }
    for acted in run.actions() {
        let work = acted.work().unwrap_or(f64::NAN) / 1e3;
        println!(
            "at {:.2} s the phases took {:.1} kJ along",
            acted.time, -work
        );
    }
    let speed = run.state()[8];
    println!("landed after {:.1} s at {:.2} m/s", run.time(), -speed);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_capsule_lands_at_the_speed_at_which_drag_carries_what_is_left_of_it() -> Outcome {
        let model = StagedDescent::new(StagedDescentParams::default())?;
        let (run, _) = descent(&model)?;
        let speed = (2.0 * 700.0 * 9.81 / (1.2 * 400.0_f64)).sqrt();
        let found = -run.state()[8];
        // It falls into denser air, which it follows by a ten-thousandth.
        assert!(
            (found - speed).abs() < 3e-4 * speed,
            "{found} against {speed}"
        );
        assert_eq!(run.model().params(), [700.0, 400.0]);
        Ok(())
    }

    #[test]
    fn the_balance_of_energy_closes_over_all_phases() -> Outcome {
        let model = StagedDescent::new(StagedDescentParams::default())?;
        let (_, history) = descent(&model)?;
        let column = |name| history.column(name).expect("a column");
        let works = ["work.loads", "work.dampers", "work.actions"].map(column);
        let total = column("energy.total");
        let balance = |row: usize| total[row] - works.iter().map(|work| work[row]).sum::<f64>();
        let rows = 0..history.len();
        let worst = rows.fold(0.0_f64, |most, row| {
            most.max((balance(row) - balance(0)).abs())
        });
        assert!(worst < 1e-6 * total[0], "{worst} of {} J", total[0]);
        Ok(())
    }

    #[test]
    fn the_strap_pulls_until_it_is_cut() -> Outcome {
        let model = StagedDescent::new(StagedDescentParams::default())?;
        let (run, history) = descent(&model)?;
        let cut = run.actions()[0].time;
        let column = |name| history.column(name).expect("a column");
        let (height, pull) = (column("height"), column("pull"));
        for (row, time) in history.times().iter().enumerate() {
            match *time > cut {
                true => assert_eq!(pull[row], 0.0),
                false => assert!(height[row] > 3999.0),
            }
        }
        assert!(pull.iter().copied().fold(0.0, f64::max) > 5.0);
        Ok(())
    }
}
