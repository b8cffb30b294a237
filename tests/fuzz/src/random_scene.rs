//! Random scenes of bodies, points and lines, as declarations: the same text for the same seed.

use std::fmt::Write as _;

use laws::random::Random;

/// A random declaration named `Random<seed>`: bodies with skew inertias and offset frames, points with mass, nodes of all models (also
/// joined to each other), lines and springs with and without damping, uniform or central gravity, drag, thrust and outputs; numbers
/// are literals, consts or params.
#[must_use]
pub fn random_scene(seed: u64) -> String {
    Builder::new(seed).build()
}

struct Builder {
    random: Random,
    text: String,
    /// Ends that are not nodes.
    places: Vec<String>,
    numbers: usize,
    declarations: String,
}

impl Builder {
    fn new(seed: u64) -> Self {
        let mut text = String::new();
        let components = if seed.is_multiple_of(2) {
            "body"
        } else {
            "world"
        };
        let _ = writeln!(text, "pub model Random{seed}<T> {{");
        let _ = writeln!(text, "    angular_velocity: {components};");
        Builder {
            random: Random::new(seed),
            text,
            places: Vec::new(),
            numbers: 0,
            declarations: String::new(),
        }
    }

    fn build(mut self) -> String {
        self.gravity();
        let bodies = self.random.below(4);
        for body in 0..bodies {
            self.body(body);
        }
        self.text.push_str("    world {\n");
        for anchor in 0..3 {
            let [x, y, z] = self.random.vector(4.0);
            let _ = writeln!(
                self.text,
                "        frame anchor{anchor} at [{x:.3}, {y:.3}, {z:.3}] m,"
            );
            self.places.push(format!("world.anchor{anchor}"));
        }
        self.text.push_str("    }\n");
        for point in 0..self.random.below(3) {
            let mass = self.number(0.2, 5.0, "kg");
            let _ = writeln!(self.text, "    point ball{point} {{ mass: {mass} }}");
            self.places.push(format!("ball{point}"));
        }
        self.plain_lines();
        let nodes = self.random.below(3);
        for node in 0..nodes {
            self.node(node);
        }
        if nodes == 0 && bodies == 0 && !self.places.iter().any(|place| place.starts_with("ball")) {
            self.node(0);
        }
        self.loads(bodies);
        self.text.push_str(&self.declarations);
        self.text.push_str("}\n");
        self.text
    }

    /// A number with its unit, as a literal, a const or a param.
    fn number(&mut self, low: f64, high: f64, unit: &str) -> String {
        let value = self.random.uniform(low, high);
        let name = self.numbers;
        match self.random.below(3) {
            0 => format!("{value:.4} {unit}"),
            1 => {
                self.numbers += 1;
                let _ = writeln!(self.declarations, "    const C{name} = {value:.4} {unit};");
                format!("C{name}")
            }
            _ => {
                self.numbers += 1;
                let (low, high) = (value * 0.5, value * 2.0);
                let _ = writeln!(
                    self.declarations,
                    "    param p{name} = {value:.4} {unit} in {low:.4} {unit} ..= {high:.4} {unit};"
                );
                format!("p{name}")
            }
        }
    }

    fn gravity(&mut self) {
        let line = match self.random.below(4) {
            0 => "gravity: none;".to_owned(),
            1 => "gravity: [0.3, -0.2, -9.81] m/s^2;".to_owned(),
            2 => "gravity: point_mass { mu: 4.2828e13 m^3/s^2, center: [0.0, 0.0, -3404590.0] m };".to_owned(),
            _ => "gravity: oblate { mu: 4.2828e13 m^3/s^2, center: [1000.0, 0.0, -3404590.0] m, radius: 3396190.0 m, j2: 0.00196, \
                  axis: [0.6, 0.0, 0.8] };"
                .to_owned(),
        };
        let _ = writeln!(self.text, "    {line}");
    }

    fn body(&mut self, body: usize) {
        let mass = self.number(1.0, 50.0, "kg");
        // Principal moments that obey the triangle inequality; small products keep the matrix realisable.
        let [a, b, c] = std::array::from_fn(|_| self.random.uniform(2.0, 3.0));
        let inertia = if self.random.below(2) == 0 {
            format!("diag({a:.3}, {b:.3}, {c:.3}) kg*m^2")
        } else {
            let [xy, xz, yz] = self.random.vector(0.2);
            format!(
                "full {{ xx: {a:.3}, yy: {b:.3}, zz: {c:.3}, xy: {xy:.3}, xz: {xz:.3}, yz: {yz:.3} }} kg*m^2 (matrix elements)"
            )
        };
        let _ = writeln!(self.text, "    body link{body} {{");
        let _ = writeln!(
            self.text,
            "        mass: {mass},\n        inertia: {inertia},"
        );
        for frame in 0..3 {
            let [x, y, z] = self.random.vector(1.0);
            let position = match self.random.below(3) {
                0 => format!("[0.0, 0.0, {z:.3}] m"),
                _ => format!("[{x:.3}, {y:.3}, {z:.3}] m"),
            };
            let _ = writeln!(self.text, "        frame f{frame} at {position},");
            self.places.push(format!("link{body}.f{frame}"));
        }
        let _ = writeln!(
            self.text,
            "    }}\n    joint free{body}: free from world to link{body}.com;"
        );
    }

    fn line(&mut self, keyword: &str, name: &str, from: &str, to: &str, damped: bool) {
        let stiffness = self.number(100.0, 5000.0, "N/m");
        let length = self.number(0.2, 2.0, "m");
        let damping = if damped {
            format!(", damping: {}", self.number(1.0, 50.0, "N*s/m"))
        } else {
            String::new()
        };
        let _ = writeln!(
            self.text,
            "    {keyword} {name} from {from} to {to} {{ free_length: {length}, stiffness: {stiffness}{damping} }}"
        );
    }

    /// Two places that are not on the same thing.
    fn pair(&mut self) -> Option<(String, String)> {
        let owner = |place: &str| place.split('.').next().unwrap_or_default().to_owned();
        for _ in 0..20 {
            let from = self.places[self.random.below(self.places.len())].clone();
            let to = self.places[self.random.below(self.places.len())].clone();
            if owner(&from) != owner(&to) {
                return Some((from, to));
            }
        }
        None
    }

    fn plain_lines(&mut self) {
        for index in 0..self.random.below(4) {
            if let Some((from, to)) = self.pair() {
                let keyword = if self.random.below(3) == 0 {
                    "spring"
                } else {
                    "line"
                };
                let damped = self.random.below(2) == 0;
                self.line(keyword, &format!("plain{index}"), &from, &to, damped);
            }
        }
    }

    fn node(&mut self, node: usize) {
        let (model, damped) = match self.random.below(3) {
            0 => ("static", false),
            1 => ("stepwise", true),
            _ => ("rate", true),
        };
        let _ = writeln!(self.text, "    point knot{node} {{ equilibrium: {model} }}");
        for index in 0..3 + self.random.below(3) {
            let place = self.places[self.random.below(self.places.len())].clone();
            let name = format!("leg{node}_{index}");
            if self.random.below(2) == 0 {
                self.line("line", &name, &place, &format!("knot{node}"), damped);
            } else {
                self.line("line", &name, &format!("knot{node}"), &place, damped);
            }
        }
        if model != "rate" && self.random.below(2) == 0 {
            // A second node of the same model, tied to the first: a network.
            let _ = writeln!(self.text, "    point twin{node} {{ equilibrium: {model} }}");
            self.line(
                "line",
                &format!("tie{node}"),
                &format!("knot{node}"),
                &format!("twin{node}"),
                damped,
            );
            for index in 0..2 {
                let place = self.places[self.random.below(self.places.len())].clone();
                self.line(
                    "line",
                    &format!("twig{node}_{index}"),
                    &format!("twin{node}"),
                    &place,
                    damped,
                );
            }
        }
    }

    fn loads(&mut self, bodies: usize) {
        for body in 0..bodies {
            match self.random.below(3) {
                0 => {
                    let area = self.number(0.1, 2.0, "kg/m");
                    let _ = writeln!(
                        self.text,
                        "    load drag{body} on link{body} at f0 = -({area}) * norm(link{body}.f0.velocity) * link{body}.f0.velocity;"
                    );
                }
                1 => {
                    let _ = writeln!(
                        self.text,
                        "    load couple{body} on link{body} at com = [0.1, sin(time / 1.0 s), 0.3] N*m - cross(link{body}.x, [0.0, 0.0, 2.0] N*m);"
                    );
                }
                _ => {}
            }
            let _ = writeln!(
                self.text,
                "    output tilt{body} = angle(link{body}.z, world.z);"
            );
            let _ = writeln!(self.text, "    output tip{body} = link{body}.f1.position;");
        }
    }
}
