//! Generated code in relative coordinates: every quantity agrees with the interpreter to the bit and with the laws to rounding, alone and along runs.

use mbd_runtime::{Options, Simulation, model};
use mbd_scene::Model;
use tests::agreement::{agrees, agrees_along};

model! {
    /// An arm of three links with a spring, a stop, a damped line and a torque at its elbow.
    pub model Arm<T> {
        coordinates: relative;
        gravity: [0.0, 0.0, -9.81] m/s^2;
        input torque: torque = 0.3 N*m;
        param length = 1 m in 0.5 m ..= 2 m;
        world { frame mast at [0.2, 0.0, 1.5] m, frame hook at [1.0, 0.4, 2.0] m }
        body base {
            mass: 3 kg,
            inertia: diag(0.1, 0.1, 0.05) kg*m^2,
            frame foot at [0.0, 0.0, -0.2] m,
            frame top at [0.05, 0.0, 0.2] m rotated rpy(20 deg, 0.0, 0.0),
        }
        body upper {
            mass: 2 kg,
            inertia: full { xx: 0.17, yy: 0.16, zz: 0.02, xz: 0.01 } kg*m^2 (matrix elements),
            frame root at [0.0, 0.0, 0.5 * length],
            frame tip at [0.0, 0.0, -0.5 * length],
        }
        body lower {
            mass: 1 kg,
            inertia: diag(0.03, 0.03, 0.001) kg*m^2,
            frame root at [0.0, 0.0, 0.25] m,
            frame hand at [0.0, 0.02, -0.25] m,
        }
        joint turntable: hinge from world.mast to base.foot { axis: z, damping: 0.2 N*m*s }
        joint shoulder: universal from base.top to upper.root { axes: [x, y] }
        joint elbow: hinge from upper.tip to lower.root {
            axis: y,
            force: torque,
            stiffness: 4 N*m,
            rest: 10 deg,
            stops: [-120, 120] deg,
            stop_stiffness: 400 N*m,
            start: 20 deg,
        }
        line cable from lower.hand to world.hook {
            free_length: 0.6 m,
            stiffness: 200 N/m,
            damping: 5 N*s/m,
        }
        output reach = lower.hand.position;
        output bend = elbow.angle in deg;
        output strain = shoulder.torque;
        output jerk = lower.acceleration;
        event bent = elbow.angle rises 60 deg;
    }
}

model! {
    /// A body that floats, with legs on a ball joint, a slide, and one walked from its child.
    pub model Walker<T> {
        coordinates: relative;
        angular_velocity: world;
        gravity: [0.1, 0.0, -9.81] m/s^2;
        world { frame hook at [0.0, 0.0, 3.0] m }
        body trunk {
            mass: 5 kg,
            inertia: full { xx: 0.3, yy: 0.4, zz: 0.2, xy: 0.02 } kg*m^2 (matrix elements),
            frame hip[i in 0..3] at polar(0.4 m, i * 120 deg, -0.1 m),
            frame ring at [0.0, 0.0, 0.3] m,
        }
        body leg[i in 0..3] {
            mass: 0.7 kg,
            inertia: diag(0.01, 0.012, 0.002) kg*m^2,
            frame top at [0.0, 0.0, 0.3] m,
            frame foot at [0.0, 0.0, -0.3] m,
        }
        point weight { mass: 0.5 kg }
        joint afloat: free from world to trunk.com;
        joint ball: spherical from trunk.hip[0] to leg[0].top;
        joint slide: cylindrical from trunk.hip[1] to leg[1].top {
            axis: z,
            slide: { stiffness: 300 N/m },
            angle: { stiffness: 2 N*m },
        }
        joint back: hinge from leg[2].top to trunk.hip[2] { axis: x, damping: 0.1 N*m*s }
        spring sling from trunk.ring to world.hook {
            free_length: 1 m,
            stiffness: 90 N/m,
            damping: 2 N*s/m,
        }
        spring pull from leg[0].foot to weight { free_length: 0.3 m, stiffness: 40 N/m }
        output height = trunk.position;
    }
}

model! {
    /// A four-bar with a motor on its crank and a hinge that closes the loop.
    pub model Bar<T> {
        coordinates: relative;
        gravity: [0.0, 0.0, -9.81] m/s^2;
        world { frame left at [0.0, 0.0, 0.0] m, frame right at [1.2, 0.0, 0.0] m }
        body crank {
            mass: 1 kg,
            inertia: diag(0.01, 0.02, 0.02) kg*m^2,
            frame a at [-0.2, 0.0, 0.0] m,
            frame b at [0.2, 0.0, 0.0] m,
        }
        body rod {
            mass: 2 kg,
            inertia: diag(0.01, 0.2, 0.2) kg*m^2,
            frame a at [-0.6, 0.0, 0.0] m,
            frame b at [0.6, 0.0, 0.0] m,
        }
        body rocker {
            mass: 1.5 kg,
            inertia: diag(0.01, 0.1, 0.1) kg*m^2,
            frame a at [-0.4, 0.0, 0.0] m,
            frame b at [0.4, 0.0, 0.0] m,
        }
        joint drive: hinge from world.left to crank.a { axis: y, motor: 30 deg + 3 rad/s * time }
        joint one: hinge from crank.b to rod.a { axis: y }
        loop joint two: hinge from rod.b to rocker.b { axis: y }
        joint three: hinge from world.right to rocker.a { axis: y }
        output effort = drive.motor_torque;
    }
}

model! {
    /// A trolley that flies in a plane: a rod walked from its child, a slide on it, a loop by a ball, tilted inertias, loads across the plane.
    pub model Flat<T> {
        coordinates: relative;
        planar: xz;
        gravity: [0.2, 0.3, -9.81] m/s^2;
        param arm = 0.4 m in 0.2 m ..= 1 m;
        world { frame hook at [0.5, 0.0, 1.0] m }
        body trolley {
            mass: 2 kg,
            inertia: full {
                xx: 0.3,
                yy: 0.4,
                zz: 0.5,
                xy: 0.05,
                yz: -0.03,
            } kg*m^2 (matrix elements),
            frame left at [-0.3, 0.0, 0.1] m,
            frame right at [0.3, 0.0, 0.0] m rotated rpy(0.0, 25 deg, 0.0),
        }
        body rod {
            mass: 1 kg,
            inertia: diag(0.03, 0.04, 0.05) kg*m^2,
            frame top at [0.0, 0.0, arm],
            frame end at [0.0, 0.0, -arm],
        }
        body sleeve { mass: 0.5 kg, inertia: diag(0.01, 0.02, 0.03) kg*m^2 }
        body ball {
            mass: 0.7 kg,
            inertia: diag(0.02, 0.02, 0.02) kg*m^2,
            frame top at [0.05, 0.0, 0.2] m,
        }
        point weight { mass: 0.3 kg }
        joint afloat: free from world to trolley.com;
        joint pin: hinge from rod.top to trolley.left { axis: y, damping: 0.1 N*m*s }
        joint slide: prismatic from rod.end to sleeve.com {
            axis: z,
            stiffness: 40 N/m,
            stops: [-0.1 m, none],
            stop_stiffness: 1 kN/m,
        }
        joint socket: spherical from trolley.right to ball.top;
        spring tie from ball.com to weight {
            free_length: 0.2 m,
            stiffness: 30 N/m,
            damping: 0.2 N*s/m,
        }
        line sling from trolley.com to world.hook { free_length: 0.6 m, stiffness: 300 N/m }
        load wind on trolley = [0.3, 0.4, 0.5] * 1 N;
        load push on rod at end = [0.2, 0.1, 0.3] * 1 N;
        output way = slide.slide;
        output turned = sleeve.orientation;
    }
}

model! {
    /// A gripper on an arm that is driven by its shoulder: fingers that mimic each other, a rack that follows one by a radius that stays a parameter.
    pub model Gripper<T> {
        coordinates: relative;
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param radius = 0.1 m in 0.05 m ..= 0.2 m;
        body arm {
            mass: 2 kg,
            inertia: full { xx: 0.17, yy: 0.16, zz: 0.02, xz: 0.01 } kg*m^2 (matrix elements),
            frame root at [0.0, 0.0, 0.5] m,
            frame left at [0.1, 0.0, -0.5] m,
            frame right at [-0.1, 0.0, -0.5] m,
            frame axle at [0.0, 0.1, 0.0] m,
        }
        body finger[i in 0..2] {
            mass: 0.3 kg,
            inertia: diag(0.002, 0.003, 0.001) kg*m^2,
            frame root at [0.0, 0.0, 0.1] m,
            frame tip at [0.01, 0.0, -0.1] m,
        }
        body rack {
            mass: 0.5 kg,
            inertia: diag(0.01, 0.02, 0.01) kg*m^2,
            frame end at [0.1, 0.0, 0.0] m,
        }
        body weight {
            mass: 0.2 kg,
            inertia: diag(0.001, 0.001, 0.001) kg*m^2,
            frame top at [0.0, 0.0, 0.2] m,
        }
        joint mimic: gear from open.angle to close.angle { ratio: -6 / 5, offset: 5 deg }
        joint pinion: gear from close.angle to rail.slide { ratio: radius }
        joint shoulder: universal from world to arm.root {
            axes: [x, y],
            angle1: { motor: (0.3 rad) * sin((2 rad/s) * time) },
        }
        joint open: hinge from arm.left to finger[0].root {
            axis: y,
            stiffness: 3 N*m,
            start: 10 deg,
        }
        joint close: hinge from arm.right to finger[1].root { axis: y, damping: 0.05 N*m*s }
        joint rail: prismatic from arm.axle to rack.com { axis: [0.6, 0.0, 0.8] }
        joint hang: spherical from rack.end to weight.top;
        spring band from finger[0].tip to finger[1].tip { free_length: 0.1 m, stiffness: 30 N/m }
        output effort = shoulder.angle1_motor_torque;
        output pushed = rail.slide;
    }
}

fn defaults() -> [Box<dyn Model<f64>>; 5] {
    [
        Box::new(Arm::<f64>::new(Default::default()).expect("defaults")),
        Box::new(Walker::<f64>::new(Default::default()).expect("defaults")),
        Box::new(Bar::<f64>::new(Default::default()).expect("defaults")),
        Box::new(Gripper::<f64>::new(Default::default()).expect("defaults")),
        Box::new(Flat::<f64>::new(Default::default()).expect("defaults")),
    ]
}

#[test]
fn every_quantity_agrees_in_every_execution() {
    for model in defaults() {
        agrees(&*model);
    }
}

#[test]
fn runs_are_the_same_in_every_execution() {
    for model in defaults() {
        let mut run = Simulation::new(&*model, Options::rk4(2e-3)).expect("a model");
        if model
            .scene()
            .joints
            .iter()
            .any(|joint| joint.name == "drive")
        {
            // The loop closes from where the motor stands.
            run.set_joints(&[("drive.angle", 30_f64.to_radians())])
                .expect("a loop that closes");
        }
        run.start().expect("a consistent start");
        agrees_along(&*model, run.state(), (100, 2e-3), 1e-9);
    }
}
