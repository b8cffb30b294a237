//! Every execution and both families of coordinates: the laws with an origin that moves are the same everywhere.

use mbd_runtime::{Model, model};
use tests::agreement::agrees;

model! {
    /// A capsule with a lid, under lines that meet at a point, over a planet.
    pub model Absolute<T> {
        coordinates: absolute;
        gravity: oblate {
            mu: 40 m^3/s^2,
            center: [0, 0, -9] m,
            radius: 5 m,
            j2: 0.01,
            axis: [0, 0, 1],
        };
        origin: follows capsule;
        verify;
        world { frame mast at [0, 0, 5] m, frame crane at [sin(1 rad/s * time) * 1 m, 0 m, 4 m] }
        body capsule { mass: 5 kg, inertia: diag(1, 1.2, 0.8) kg*m^2, frame top at [0, 0, 0.5] m }
        body lid { mass: 0.5 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame rim at [0, 0, 0.2] m }
        joint float: free from world to capsule.com;
        joint hinge: hinge from capsule.top to lid.rim { axis: x, damping: 0.1 N*m*s }
        point left { mass: 1 kg }
        spring tether from world.mast to left {
            free_length: 1 m,
            stiffness: 2 N/m,
            damping: 0.1 N*s/m,
        }
        line hoist from world.crane to capsule.top {
            free_length: 1 m,
            stiffness: 20 N/m,
            damping: 0.2 N*s/m,
        }
        load drag on left = -0.02 kg/m * norm(left.velocity) * left.velocity;
        load wind on lid = [0.1 N/m * left.position.x, 0 N, 30 N];
        state flown = 0 m { rate: norm(capsule.velocity) }
        output gap = left.position - capsule.top.position;
        output height = capsule.position.z;
        output placed = hinge.angle;
        event low = capsule.position.z falls 25 m;
    }
}

model! {
    /// The same in relative coordinates, a node with dampers between.
    pub model Relative<T> {
        coordinates: relative;
        gravity: point_mass { mu: 40 m^3/s^2, center: [0, 0, -9] m };
        origin: follows lid;
        world { frame mast at [0, 0, 5] m }
        body capsule { mass: 5 kg, inertia: diag(1, 1.2, 0.8) kg*m^2, frame top at [0, 0, 0.5] m }
        body lid { mass: 0.5 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame rim at [0, 0, 0.2] m }
        joint float: free from world to capsule.com;
        joint hinge: hinge from capsule.top to lid.rim { axis: x, damping: 0.1 N*m*s }
        point left { mass: 1 kg }
        point right { mass: 1 kg }
        point knot { equilibrium: rate }
        line riser from capsule.top to knot {
            free_length: 1 m,
            stiffness: 20 N/m,
            damping: 2 N*s/m,
        }
        line a from knot to left { free_length: 1 m, stiffness: 10 N/m, damping: 1 N*s/m }
        line b from knot to right { free_length: 1 m, stiffness: 10 N/m, damping: 1 N*s/m }
        line tether from world.mast to knot {
            free_length: 1 m,
            stiffness: 2 N/m,
            damping: 0.1 N*s/m,
        }
        load drag on left = -0.02 kg/m * norm(left.velocity) * left.velocity;
        output gap = left.position - capsule.top.position;
        output height = knot.position;
        output speed = knot.velocity.x - capsule.velocity.x;
    }
}

model! {
    /// Two points in a plane.
    pub model Planar<T> {
        planar: xz;
        gravity: [0, 0, -9.81] m/s^2;
        origin: follows a;
        verify;
        point a { mass: 1 kg }
        point b { mass: 2 kg }
        body c { mass: 2 kg, inertia: diag(1, 1, 1) kg*m^2, frame end at [1, 0, 0] m }
        joint float: free from world to c.com;
        spring tie from a to b { free_length: 1 m, stiffness: 20 N/m, damping: 0.2 N*s/m }
        spring tail from b to c.end { free_length: 1 m, stiffness: 20 N/m, damping: 0.2 N*s/m }
        output gap = b.position - a.position;
        output place = c.end.position;
    }
}

#[test]
fn generated_and_interpreted_equations_are_those_of_the_laws_wherever_the_origin_is() {
    let absolute = Absolute::<f64>::new(Default::default()).expect("defaults");
    let relative = Relative::<f64>::new(Default::default()).expect("defaults");
    let planar = Planar::<f64>::new(Default::default()).expect("defaults");
    for model in [&absolute as &dyn Model<f64>, &relative, &planar] {
        agrees(model);
    }
}
