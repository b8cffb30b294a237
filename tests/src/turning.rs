//! Parallelograms of equal links that turn through both of their flat positions, in a plane and in space, of any size and in any scalar.

use mbd_runtime::{Options, RunError, Scalar, Simulation, Statistics};
use mbd_scene::{AngularVelocity, Model, Quantity, Scene};

use crate::declared::read;
use crate::mechanism::{evaluate, layout, with_components};
use crate::planar::{in_space, lifted};

/// Cranks on the ground, a link apart, and one beam across their tips; everything as long as the distance of two cranks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parallelogram {
    /// Two cranks, or three: then one of them is redundant.
    pub cranks: usize,
    /// Length of a crank, of the beam between two cranks, and of the ground between them \[m\].
    pub link: f64,
    /// Rate of the cranks \[rad/s\].
    pub rate: f64,
    /// Whether the scene is planar.
    pub planar: bool,
    /// Components of angular velocity.
    pub components: AngularVelocity,
    /// Whether a motor turns the first crank.
    pub motor: bool,
    /// Gravity along −y \[m/s²\].
    pub gravity: f64,
    /// By how much each body is heavier than the one before it, relative.
    pub uneven: f64,
    /// Angle of the cranks at the start \[rad\].
    pub start: f64,
}

/// Two links of 2 m in space that turn by themselves.
pub const PLAIN: Parallelogram = Parallelogram {
    cranks: 2,
    link: 2.0,
    rate: 2.0,
    planar: false,
    components: AngularVelocity::Body,
    motor: false,
    gravity: 0.0,
    uneven: 0.0,
    start: 1.0,
};

/// What a run kept and what it did.
#[derive(Clone, Copy, Debug, Default)]
pub struct Kept {
    /// Largest change of energy, relative to the kinetic energy of the start.
    pub energy: f64,
    /// Largest difference of the first crank's angle from an even rotation \[rad\]; of a motion that is not even it says nothing.
    pub angle: f64,
    /// Largest angle of the beam \[rad\]: on the other branch it turns with the cranks.
    pub tilt: f64,
    /// What the run did.
    pub statistics: Statistics,
}

impl Parallelogram {
    /// Its declaration.
    #[must_use]
    pub fn text(&self) -> String {
        let Parallelogram {
            cranks,
            link,
            rate,
            start,
            gravity,
            ..
        } = self;
        let inertia = |body: usize| {
            let mass = 1.0 + self.uneven * body as f64;
            let moment = mass * link * link / 12.0;
            format!("mass: {mass} kg, inertia: diag({moment}, {moment}, {moment}) kg*m^2")
        };
        let half = 0.5 * link;
        let motor = match self.motor {
            true => format!("{{ motor: {start} rad + {rate} rad/s * time }}"),
            false => "{ axis: z }".to_owned(),
        };
        let middle = 0.5 * (*cranks as f64 - 1.0);
        let each = |write: &dyn Fn(usize) -> String| (0..*cranks).map(write).collect::<String>();
        let ground = each(&|k| format!("frame p{k} at [{}, 0, 0] m, ", k as f64 * link));
        let tips = each(&|k| format!("frame p{k} at [{}, 0, 0] m, ", (k as f64 - middle) * link));
        let bodies = each(&|k| {
            format!(
                "body crank{k} {{ {}, frame root at [{}, 0, 0] m, frame tip at [{half}, 0, 0] m }}\n",
                inertia(k),
                -half
            )
        });
        let joints = each(&|k| {
            let motor = if k == 0 { &motor } else { "{ axis: z }" };
            format!(
                "joint root{k}: hinge from world.p{k} to crank{k}.root {motor}
                 joint tip{k}: hinge from crank{k}.tip to beam.p{k} {{ axis: z }}\n"
            )
        });
        format!(
            "model Parallelogram {{ planar: xy; gravity: [0.0, {}, 0.0] m/s^2;
               world {{ {ground} }}
               {bodies}
               body beam {{ {}, {tips} }}
               {joints} }}",
            -gravity,
            inertia(*cranks)
        )
    }

    /// Its scene, and the state it starts from.
    #[must_use]
    pub fn build(&self) -> (Scene, Vec<f64>) {
        let flat = read(&self.text());
        let nq = layout(&flat).nq;
        let (sin, cos) = self.start.sin_cos();
        let (link, rate) = (self.link, self.rate);
        let mut state = vec![0.0; 2 * nq];
        for body in 0..=self.cranks {
            let (part, [x, angle]) = if body < self.cranks {
                (0.5, [body as f64 * link, self.start])
            } else {
                (1.0, [0.5 * (self.cranks as f64 - 1.0) * link, 0.0])
            };
            let arm = [part * link * cos, part * link * sin];
            let turning = if body < self.cranks { rate } else { 0.0 };
            state[3 * body..3 * body + 3].copy_from_slice(&[x + arm[0], arm[1], angle]);
            let speeds = [-rate * arm[1], rate * arm[0], turning];
            state[nq + 3 * body..nq + 3 * body + 3].copy_from_slice(&speeds);
        }
        if self.planar {
            return (flat, state);
        }
        let space = with_components(&in_space(&flat), self.components);
        let state = lifted(&flat, &state);
        (space, state)
    }

    /// The angle of a body.
    fn angle(&self, body: usize, x: &[f64]) -> f64 {
        if self.planar {
            x[3 * body + 2]
        } else {
            2.0 * x[7 * body + 6].atan2(x[7 * body + 3])
        }
    }

    /// Runs a model of its scene to a time.
    ///
    /// # Errors
    /// What the run stopped with.
    pub fn turn<T: Scalar>(
        &self,
        model: &dyn Model<T>,
        options: Options,
        until: f64,
    ) -> Result<Kept, RunError> {
        let (scene, state) = self.build();
        let x: Vec<T> = state.iter().map(|&x| T::from_f64(x)).collect();
        let mut run = Simulation::new(model, options)?;
        run.set_state(0.0, &x)?;
        run.start()?;
        let energy = |x: &[f64]| {
            let parts = evaluate(&scene, Quantity::Energy, x, &[], &[]);
            [parts[0], parts[0] + parts[1]]
        };
        let numbers = |x: &[T]| x.iter().map(|x| x.to_f64()).collect::<Vec<f64>>();
        let [kinetic, first] = energy(&numbers(run.state()));
        let mut kept = Kept::default();
        while run.time() < until {
            run.step()?;
            let x = numbers(run.state());
            // Energy is dear to evaluate.
            if run.statistics().steps % 8 == 0 || run.time() >= until {
                kept.energy = kept.energy.max((energy(&x)[1] - first).abs() / kinetic);
            }
            let off = self.angle(0, &x) - self.start - self.rate * run.time();
            let off = off.rem_euclid(std::f64::consts::TAU);
            kept.angle = kept.angle.max(off.min(std::f64::consts::TAU - off));
            kept.tilt = kept.tilt.max(self.angle(self.cranks, &x).abs());
        }
        kept.statistics = run.statistics();
        Ok(kept)
    }
}
