//! The classical method of order 4 for fixed steps, with the cubic through both ends of the step and their rates.
//!
//! The cubic is y(θ) = x + (3θ² − 2θ³)(x⁺ − x) + h (θ − 2θ² + θ³) k₁ + h (θ³ − θ²) k₅, where k₅ is the rate at the new state. Its error is O(h⁴)
//! for every θ, the order of the method.

use super::tableau::Tableau;

const SIXTH: f64 = 1.0 / 6.0;
const THIRD: f64 = 1.0 / 3.0;

/// Classical RK4 with an embedded step of order 3, b̂ = (1/6, 1/3, 1/3, 0, 1/6), whose difference h (k₄ − k₅)/6 shows what the step resolves; the fifth stage is the first of the next step.
pub(crate) const RK4: Tableau<5, 5, 4> = Tableau {
    a: [
        [0.0; 5],
        [0.5, 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.5, 0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0, 0.0],
        [SIXTH, THIRD, THIRD, SIXTH, 0.0],
    ],
    c: [0.0, 0.5, 0.5, 1.0, 1.0],
    error: [0.0, 0.0, 0.0, SIXTH, -SIXTH],
    dense: [
        [1.0, 3.0 * SIXTH - 2.0, 1.0 - 2.0 * SIXTH, 0.0],
        [0.0, 3.0 * THIRD, -2.0 * THIRD, 0.0],
        [0.0, 3.0 * THIRD, -2.0 * THIRD, 0.0],
        [0.0, 3.0 * SIXTH, -2.0 * SIXTH, 0.0],
        [0.0, -1.0, 1.0, 0.0],
    ],
    order: 4,
    embedded: 3,
    dense_order: 3,
    alike: [1, 2],
    stable: 2.785_293_563_405_281,
}
.checked();
