//! Equilibrium points: the balance of their lines, how they follow their anchors, and how they move.

use laws::assert_close;
use laws::instant::Instant;
use laws::mechanism::{Instance, add_frame, add_point, empty, evaluate_at, frame, layout, state};
use laws::random::Random;
use mbd_scene::{
    AngularVelocity, Formula, LineKind, Load, LoadKind, NodeModel, Place, Quantity, Scene,
};
use nalgebra::{DMatrix, Matrix3, Vector3};

use crate::things::{direction, line, moving, node, vector_output};

/// Two nodes with a line between; the first has three anchors, the second two, points and the world.
struct Net {
    scene: Scene,
    nodes: [Place; 2],
    /// Per line its ends, each a node by number or an anchor by number.
    ends: Vec<[End; 2]>,
}

#[derive(Clone, Copy)]
enum End {
    Node(usize),
    Anchor(usize),
}

const ANCHORS: usize = 5;

fn net(model: NodeModel) -> Net {
    let mut scene = empty([0.0; 3], AngularVelocity::Body);
    add_frame(&mut scene, None, frame("post", [0.1, -0.2, 0.3], None));
    let points: Vec<Place> = (0..4)
        .map(|k| add_point(&mut scene, 1.0 + k as f64))
        .collect();
    let nodes = [node(&mut scene, model), node(&mut scene, model)];
    let anchors = [points[0], points[1], Place::World(1), points[2], points[3]];
    use End::{Anchor, Node};
    let ends = vec![
        [Anchor(0), Node(0)],
        [Node(0), Anchor(1)],
        [Anchor(2), Node(0)],
        [Node(0), Node(1)],
        [Node(1), Anchor(3)],
        [Anchor(4), Node(1)],
    ];
    for pair in &ends {
        let places = pair.map(|end| match end {
            Node(n) => nodes[n],
            Anchor(a) => anchors[a],
        });
        let tie = line(LineKind::Line, places, [1.0, 100.0, 0.0]);
        scene.lines.push(tie);
    }
    for (at, force) in [
        (nodes[0], [1.0, 2.0, 3.0]),
        (nodes[0], [0.5, 0.0, -1.0]),
        (nodes[1], [-4.0, 5.0, 6.0]),
    ] {
        scene.loads.push(Load {
            name: "push".to_owned(),
            doc: String::new(),
            at,
            kind: LoadKind::Force(Formula::Vector(force.map(Formula::Number).to_vec())),
        });
    }
    Net { scene, nodes, ends }
}

/// W of each node: all its loads.
const LOADS: [Vector3<f64>; 2] = [Vector3::new(1.5, 2.0, 2.0), Vector3::new(-4.0, 5.0, 6.0)];

/// Where a net is, and with which effective numbers its lines pull.
struct Posed {
    nodes: [Vector3<f64>; 2],
    anchors: [Instance; ANCHORS],
    effective: Vec<[f64; 2]>,
}

impl Posed {
    /// With lines of `longest` times the distance of their ends: all taut below 1, all slack above it.
    fn random(net: &Net, [shortest, longest]: [f64; 2], random: &mut Random) -> Self {
        let mut somewhere = || moving(random.vector(2.0).into(), random.vector(2.0).into());
        let mut anchors: [Instance; ANCHORS] = std::array::from_fn(|_| somewhere());
        anchors[2] = moving(Vector3::new(0.1, -0.2, 0.3), Vector3::zeros());
        let nodes = [random.vector(1.0).into(), random.vector(1.0).into()];
        let mut posed = Posed {
            nodes,
            anchors,
            effective: Vec::new(),
        };
        posed.effective = net
            .ends
            .iter()
            .map(|pair| {
                let [from, to] = pair.map(|end| posed.place(end));
                let length = (to - from).norm() * random.uniform(shortest, longest);
                [random.decades(1.0, 3.0), length]
            })
            .collect();
        posed
    }

    fn place(&self, end: End) -> Vector3<f64> {
        match end {
            End::Node(n) => self.nodes[n],
            End::Anchor(a) => self.anchors[a].position,
        }
    }

    fn instant(&self, net: &Net) -> Instant<f64> {
        let points = [0, 1, 3, 4].map(|a| self.anchors[a]);
        let mut instant = Instant {
            state: state(&net.scene, &[], &points),
            nodes: self.nodes.iter().flat_map(|p| [p.x, p.y, p.z]).collect(),
            effective: self.effective.iter().flatten().copied().collect(),
            hold: vec![0.0; net.ends.len()],
            ..Instant::default()
        };
        instant.ends = evaluate_at(&net.scene, Quantity::AnchorStates, &instant.at());
        instant
    }

    /// Tension and stiffness of a line, and its direction.
    fn pulled(&self, net: &Net, index: usize) -> (f64, Matrix3<f64>, Vector3<f64>) {
        let [from, to] = net.ends[index].map(|end| self.place(end));
        let [k, l0] = self.effective[index];
        let (vector, length) = (to - from, (to - from).norm());
        let (u, tension) = (vector / length, (k * (length - l0)).max(0.0));
        let along = u * u.transpose();
        let stiffness = match length >= l0 {
            true => along * k + (Matrix3::identity() - along) * (tension / length),
            false => Matrix3::zeros(),
        };
        (tension, stiffness, u)
    }

    /// H of the net, and the blocks J of its anchors, nodes by anchors.
    fn system(&self, net: &Net) -> [DMatrix<f64>; 2] {
        let mut h = DMatrix::zeros(6, 6);
        let mut b = DMatrix::zeros(6, 3 * ANCHORS);
        for (index, pair) in net.ends.iter().enumerate() {
            let (_, j, _) = self.pulled(net, index);
            for (end, other) in [(pair[0], pair[1]), (pair[1], pair[0])] {
                let End::Node(n) = end else { continue };
                let mut own = h.fixed_view_mut::<3, 3>(3 * n, 3 * n);
                own += j;
                match other {
                    End::Node(m) => {
                        let mut far = h.fixed_view_mut::<3, 3>(3 * n, 3 * m);
                        far -= j;
                    }
                    End::Anchor(a) => {
                        let mut far = b.fixed_view_mut::<3, 3>(3 * n, 3 * a);
                        far += j;
                    }
                }
            }
        }
        [h, b]
    }
}

/// Row by row.
fn rows(matrix: &DMatrix<f64>) -> Vec<f64> {
    matrix.transpose().iter().copied().collect()
}

const TAUT: [f64; 2] = [0.5, 0.95];
const SOME: [f64; 2] = [0.7, 1.2];
const SLACK: [f64; 2] = [1.05, 1.5];

#[test]
fn the_balance_of_a_network_is_the_sum_of_its_lines_and_loads() {
    let (net, mut random) = (net(NodeModel::Static), Random::new(31));
    for lengths in [TAUT, SOME, SLACK] {
        for _ in 0..20 {
            let posed = Posed::random(&net, lengths, &mut random);
            let instant = posed.instant(&net);
            // Anchors with their velocities, then all loads of each node.
            let layout = layout(&net.scene);
            for (anchor, found) in layout.anchors.iter().zip(instant.ends.chunks(6)) {
                let end = net.ends[anchor.line].iter().find_map(|end| match end {
                    End::Anchor(a) => Some(posed.anchors[*a]),
                    End::Node(_) => None,
                });
                let end = end.expect("an anchor");
                assert_close(&found[..3], end.position.as_slice(), 0.0, 1e-15, "place");
                assert_close(&found[3..], end.velocity.as_slice(), 0.0, 1e-15, "velocity");
            }
            let loads = &instant.ends[6 * ANCHORS..];
            assert_close(&loads[..3], LOADS[0].as_slice(), 0.0, 1e-15, "load");
            assert_close(&loads[3..], LOADS[1].as_slice(), 0.0, 1e-15, "load");

            let mut want = vec![0.0; 6];
            let (mut sum, mut size, mut taut) = (0.0, 0.0, 0.0);
            for (n, load) in LOADS.iter().enumerate() {
                for k in 0..3 {
                    want[3 * n + k] -= load[k];
                }
            }
            for (index, pair) in net.ends.iter().enumerate() {
                let (tension, j, u) = posed.pulled(&net, index);
                let mut reach = 0.0;
                for (end, sign) in pair.iter().zip([-1.0, 1.0]) {
                    if let End::Node(n) = end {
                        for k in 0..3 {
                            want[3 * n + k] += sign * tension * u[k];
                        }
                        reach += posed.nodes[*n].lp_norm(1);
                    }
                }
                let [from, to] = pair.map(|end| posed.place(end));
                let (d, [k, _]) = ((to - from).norm(), posed.effective[index]);
                if j != Matrix3::zeros() {
                    (sum, size, taut) = (sum + tension, size + k * (d + reach), taut + 1.0);
                }
            }
            let [h, _] = posed.system(&net);
            for &(row, column) in &layout.networks[0].blocks {
                for (i, j) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)] {
                    want.push(h[(3 * row + i, 3 * column + j)]);
                }
            }
            want.extend([sum, size, taut]);
            let got = evaluate_at(&net.scene, Quantity::Equilibrium(0), &instant.at());
            assert_close(&got, &want, 1e-12, 1e-12, "balance");
            // The same balance where it is a residual, with the opposite sign.
            let residual = evaluate_at(&net.scene, Quantity::Balance, &instant.at());
            let minus: Vec<f64> = want[..6].iter().map(|x| -x).collect();
            assert_close(&residual, &minus, 1e-12, 1e-12, "residual");
        }
    }
}

#[test]
fn nodes_follow_their_anchors_by_the_stiffness_of_their_lines() {
    let (mut net, mut random) = (net(NodeModel::Static), Random::new(32));
    for node in net.nodes {
        net.scene
            .outputs
            .push(vector_output(Formula::Velocity(node)));
    }
    for _ in 0..20 {
        let posed = Posed::random(&net, TAUT, &mut random);
        let instant = posed.instant(&net);
        let [h, b] = posed.system(&net);
        let by_anchor = h.clone().lu().solve(&b).expect("taut");
        // In the order of the anchors of the network: by line.
        let order: Vec<usize> = net
            .ends
            .iter()
            .flatten()
            .filter_map(|end| match end {
                End::Anchor(a) => Some(*a),
                End::Node(_) => None,
            })
            .collect();
        let columns: Vec<usize> = order
            .iter()
            .flat_map(|a| [3 * a, 3 * a + 1, 3 * a + 2])
            .collect();
        let want = by_anchor.select_columns(&columns);
        let got = evaluate_at(&net.scene, Quantity::NodeByAnchor(0), &instant.at());
        assert_close(&got, &rows(&want), 1e-9, 0.0, "∂p/∂p_i");
        for node in 0..2 {
            for i in 0..3 {
                for j in 0..3 {
                    let sum: f64 = (0..ANCHORS)
                        .map(|a| got[(3 * node + i) * 15 + 3 * a + j])
                        .sum();
                    let one = f64::from(u8::from(i == j));
                    assert!((sum - one).abs() < 1e-9, "{sum}");
                }
            }
        }
        // What the anchors see: B = J δ − J H⁻¹ J.
        let own = |a: usize| {
            let line = net.ends.iter().position(|pair| {
                pair.iter()
                    .any(|end| matches!(end, End::Anchor(x) if *x == a))
            });
            posed.pulled(&net, line.expect("a line")).1
        };
        let mut want = -(b.transpose() * &by_anchor);
        for a in 0..ANCHORS {
            let mut block = want.fixed_view_mut::<3, 3>(3 * a, 3 * a);
            block += own(a);
        }
        let want = want.select_columns(&columns).select_rows(&columns);
        let got = evaluate_at(&net.scene, Quantity::CondensedStiffness(0), &instant.at());
        assert_close(&got, &rows(&want), 1e-9, 0.0, "stiffness");
        // w = H⁻¹ Σ J v.
        let v = DMatrix::from_fn(15, 1, |i, _| posed.anchors[i / 3].velocity[i % 3]);
        let got = evaluate_at(&net.scene, Quantity::Outputs, &instant.at());
        assert_close(&got, (by_anchor * v).as_slice(), 1e-9, 0.0, "velocity");
    }
}

#[test]
fn nodes_of_slack_lines_follow_the_mean_of_their_own_anchors() {
    let (net, mut random) = (net(NodeModel::Static), Random::new(33));
    let posed = Posed::random(&net, SLACK, &mut random);
    let instant = posed.instant(&net);
    let got = evaluate_at(&net.scene, Quantity::NodeByAnchor(0), &instant.at());
    for (row, numbers) in got.chunks(15).enumerate() {
        let (node, axis) = (row / 3, row % 3);
        for (column, number) in numbers.iter().enumerate() {
            let (anchor, along) = (column / 3, column % 3);
            let mine = (anchor < 3) == (node == 0) && axis == along;
            let share = [1.0 / 3.0, 0.5][node];
            let want = if mine { share } else { 0.0 };
            assert!((number - want).abs() < 1e-12, "{row}, {column}: {number}");
        }
    }
    let seen = evaluate_at(&net.scene, Quantity::CondensedStiffness(0), &instant.at());
    assert_close(&seen, &[0.0; 225], 0.0, 1e-25, "nothing is stiff");
}

/// A node of `rate` with lines to four points; it is the `to` end of some.
fn dashpots(damping: [f64; 4]) -> (Scene, Place) {
    let mut scene = empty([0.0; 3], AngularVelocity::Body);
    let points: Vec<Place> = (0..4).map(|_| add_point(&mut scene, 1.5)).collect();
    let place = node(&mut scene, NodeModel::Rate);
    for (index, (point, damping)) in points.into_iter().zip(damping).enumerate() {
        let ends = if index % 2 == 0 {
            [place, point]
        } else {
            [point, place]
        };
        let numbers = [0.8, 200.0 + 50.0 * index as f64, damping];
        scene.lines.push(line(LineKind::Line, ends, numbers));
    }
    (scene, place)
}

#[test]
fn a_rate_node_moves_as_the_dampers_of_its_carrying_lines_let_it() {
    let mut random = Random::new(34);
    let damping = [20.0, 35.0, 50.0, 65.0];
    let (scene, _) = dashpots(damping);
    let layout = layout(&scene);
    assert!(layout.solves_rates());
    let mut solved = 0;
    for carried in [
        [1.0, 1.0, 1.0, 1.0],
        [1.0, 1.0, 0.0, 1.0],
        [1.0, -1.0, 1.0, 1.0],
    ] {
        for _ in 0..20 {
            let place = Vector3::from(random.vector(0.3));
            let points: Vec<Instance> = (0..4)
                .map(|_| moving(direction(&mut random) * 1.3, random.vector(2.0).into()))
                .collect();
            let mut x = state(&scene, &[], &points);
            let z = layout.nq + layout.nv;
            x[z..z + 3].copy_from_slice(place.as_slice());
            let at = Instant {
                state: x,
                nodes: vec![f64::NAN; 3],
                hold: carried.to_vec(),
                ..Instant::default()
            };
            let (mut d, mut f) = (Matrix3::zeros(), Vector3::zeros());
            let leg = |index: usize| {
                let away = points[index].position - place;
                let stiffness = 200.0 + 50.0 * index as f64;
                (away.normalize(), stiffness, away.norm() - 0.8)
            };
            for index in (0..4).filter(|&index| carried[index] > 0.0) {
                let (u, stiffness, stretch) = leg(index);
                d += u * u.transpose() * damping[index];
                f += u * (stiffness * stretch + damping[index] * u.dot(&points[index].velocity));
            }
            // det D − 1e-5 (tr D)³: where it is not positive nothing is said.
            let margin = d.determinant() - 1e-5 * d.trace().powi(3);
            if margin < 1e-3 * d.trace().powi(3) {
                continue;
            }
            solved += 1;
            let w = d.lu().solve(&f).expect("dampers in all directions");
            let got = evaluate_at(&scene, Quantity::Rates, &at.at());
            let (rates, rest) = got.split_at(layout.nx());
            assert_close(&rates[z..z + 3], w.as_slice(), 1e-9, 0.0, "velocity");
            let (ends, certificates) = rest.split_at(layout.len(Quantity::AnchorStates));
            let states = evaluate_at(&scene, Quantity::AnchorStates, &at.at());
            assert_eq!(ends, &states[..]);
            assert_close(&certificates[..1], &[margin], 1e-9, 0.0, "margin");
            let mean = points
                .iter()
                .fold(Vector3::zeros(), |sum, p| sum + p.velocity)
                / 4.0;
            let (mut largest, mut most, mut agreed) = (0.0_f64, 0.0_f64, f64::INFINITY);
            let (mut stretches, mut pulls) = (Vec::new(), Vec::new());
            for index in 0..4 {
                let (u, stiffness, stretch) = leg(index);
                let push =
                    stiffness * stretch + damping[index] * u.dot(&(points[index].velocity - mean));
                let opening = damping[index] * u.dot(&(w - mean));
                let (pull, carries) = (push - opening, carried[index] > 0.0);
                if carries {
                    largest = largest.max(push.abs() + opening.abs());
                    most = most.max(pull);
                }
                // Positive where a line does what was held of it.
                agreed = agreed.min((carried[index] - 0.5) * stretch.min(pull));
                stretches.push(stretch);
                pulls.push(pull);
            }
            assert_close(&certificates[1..2], &[largest], 1e-9, 0.0, "largest");
            assert_close(&certificates[2..3], &[most], 1e-9, 1e-9, "most");
            assert_close(&certificates[3..4], &[agreed], 1e-9, 1e-9, "agreed");
            assert_close(&certificates[4..], &stretches, 1e-9, 1e-9, "stretches");
            // The accelerations are those of the pulls that balance the node; where all lines do what was held of them, these are what each pulls by itself.
            for (index, pull) in pulls.into_iter().enumerate() {
                let (u, _, stretch) = leg(index);
                let tension = if carried[index] > 0.0 { pull } else { 0.0 };
                let by_itself = if stretch > 0.0 { pull.max(0.0) } else { 0.0 };
                assert!(agreed <= 0.0 || tension == by_itself);
                let v = layout.nq + 3 * index;
                let want = u * (-tension / 1.5);
                assert_close(
                    &rates[v..v + 3],
                    want.as_slice(),
                    1e-9,
                    1e-9,
                    "acceleration",
                );
            }
        }
    }
    assert!(solved > 30, "{solved}");
}
