//! Derivatives through the nodes by the implicit function theorem, on the dual numbers of another library.
//!
//! ```text
//! G(x, y) = 0,  ẋ = F(x, y):      dy = −G_y⁻¹ G_x dx,      dẋ = F(x + dx ε, y + dy ε)
//! ```

use mbd_scene::Scratch;
use mbd_scene::laws::Numbers;
use mbd_scene::{Layout, Quantity, Scene};
use nalgebra::{DMatrix, DVector};

use crate::instant::Instant;
use crate::oracle::Oracle;

/// The laws of one scene on dual numbers.
pub struct Implicit<'s> {
    scene: &'s Scene,
    layout: Layout,
    numbers: Numbers<Oracle>,
    scratch: Scratch<Oracle>,
}

impl<'s> Implicit<'s> {
    /// The laws of `scene` for `params`.
    #[must_use]
    pub fn new(scene: &'s Scene, params: &[f64]) -> Self {
        let params: Vec<Oracle> = params.iter().copied().map(Oracle::constant).collect();
        let layout = Layout::new(scene);
        Implicit {
            scene,
            numbers: Numbers::new(scene, &params),
            scratch: Scratch::new(&layout),
            layout,
        }
    }

    /// A quantity: value and derivative by the one seeded variable.
    pub fn evaluate(&mut self, what: Quantity, at: &Instant<Oracle>) -> Vec<Oracle> {
        let mut out = vec![Oracle::constant(0.0); self.layout.len(what)];
        mbd_scene::evaluate(
            what,
            self.scene,
            &self.layout,
            &self.numbers,
            &at.at(),
            &mut self.scratch,
            &mut out,
        );
        out
    }

    /// The derivative of the first numbers of a balance by the seeded variable.
    fn slopes(&mut self, balance: Quantity, at: &Instant<Oracle>) -> DVector<f64> {
        let rows = at.nodes.len();
        let out = self.evaluate(balance, at);
        DVector::from_iterator(rows, out.iter().take(rows).map(|x| x.0.eps))
    }

    /// Lets the node unknowns of `seeded` follow its seeded variable, so that `balance` (its first numbers) stays zero.
    ///
    /// # Panics
    /// If the balance does not determine the nodes.
    pub fn follow(&mut self, balance: Quantity, seeded: &mut Instant<Oracle>) {
        let rows = seeded.nodes.len();
        let right = self.slopes(balance, seeded);
        let mut by_node = DMatrix::zeros(rows, rows);
        for column in 0..rows {
            let mut at = seeded.map(|x| Oracle::constant(x.0.re));
            at.nodes[column] = Oracle::variable(at.nodes[column].0.re);
            by_node.set_column(column, &self.slopes(balance, &at));
        }
        let moved = by_node
            .lu()
            .solve(&right)
            .expect("a taut network determines its nodes");
        for (node, slope) in seeded.nodes.iter_mut().zip(moved.iter()) {
            node.0.eps = -slope;
        }
    }

    /// dẋ/dx and dy/dx at a state whose nodes are in balance, both row by row.
    pub fn by_state(&mut self, at: &Instant<f64>) -> [Vec<f64>; 2] {
        let (columns, rows, nodes) = (at.state.len(), at.state.len(), at.nodes.len());
        let mut derivative = vec![0.0; rows * columns];
        let mut by_node = vec![0.0; nodes * columns];
        for column in 0..columns {
            let mut seeded = at.map(Oracle::constant);
            seeded.state[column] = Oracle::variable(at.state[column]);
            self.follow(Quantity::Balance, &mut seeded);
            for (row, node) in seeded.nodes.iter().enumerate() {
                by_node[row * columns + column] = node.0.eps;
            }
            let rates = self.evaluate(Quantity::Derivative, &seeded);
            for (row, rate) in rates.iter().enumerate() {
                derivative[row * columns + column] = rate.0.eps;
            }
        }
        [derivative, by_node]
    }
}
