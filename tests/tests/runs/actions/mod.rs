//! What events do: numbers set, lines detached and attached, runs stopped, located to the last digits and booked in the balance of energy.

mod handover;
mod joints;
mod lines;
mod locks;
mod numbers;
mod own_guard;
mod refused;
mod repeated;
mod speeds;

use mbd_runtime::{Method, Options};
use mbd_scene::Coordinates;

const G: f64 = 9.81;

/// Every method, at tolerances at which a parabola and a swing are exact to many digits.
fn methods() -> [Options; 6] {
    [
        Options::rattle(1e-3),
        Options::rk4(1e-3),
        Options::tsit5(1e-12),
        Options::vern7(1e-12),
        Options::rodas5p(1e-11),
        Options::auto(1e-11),
    ]
}

/// Those that a model in these coordinates runs with: Rattle needs absolute ones.
fn methods_in(coordinates: Coordinates) -> impl Iterator<Item = Options> {
    let all = methods().into_iter();
    all.filter(move |options| {
        coordinates == Coordinates::Absolute || !matches!(options.method, Method::Rattle { .. })
    })
}
