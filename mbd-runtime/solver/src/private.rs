//! What generated code calls and nobody else should.

use mbd_scene::Work;
use mbd_scene::laws::{LineNumbers, Numbers};
use mbd_scene::{
    Float, LINE_NUMBERS, Layout, Packed, ParamError, Plan, Real, Scene, StartFrom, checked_numbers,
};

use num_traits::Zero;

use crate::{CoordInfo, Lanes, Lanes4, LineState, Reaction};

pub use crate::dropped_here::DroppedHere;
pub use crate::integrate::{inner_rates, inner_stages};
pub use crate::parts::{member, read, write};
pub use crate::verify::verify;

/// What every model of one declaration shares: unpacked once in a program.
pub struct Declared {
    /// The declaration.
    pub scene: DroppedHere<Scene>,
    /// Where everything lives.
    pub layout: DroppedHere<Layout>,
}

impl Declared {
    /// The declaration and the plan of its solution, from the texts that the compiler wrote.
    #[must_use]
    pub fn unpacked(scene: &str, plan: &str) -> Self {
        let scene = Scene::unpacked(scene).unwrap_or_default();
        let plan = Plan::unpacked(plan).unwrap_or_default();
        Declared {
            layout: DroppedHere::new(Layout::planned(&scene, plan)),
            scene: DroppedHere::new(scene),
        }
    }

    /// The declaration for who keeps it: copied here, and not by code that every crate with a model would compile again.
    #[must_use]
    pub fn copy(&self) -> Scene {
        Scene::clone(&self.scene)
    }
}

/// Sets the coordinates of joints in a state by where bodies are: what `set_bodies` of a model does.
pub fn set_bodies<T: Float>(
    declared: &Declared,
    (params, time, inputs): (&[T], T, &[T]),
    bodies: &[T],
    state: &mut [T],
) {
    let wide = |list: &[T]| -> Vec<f64> { list.iter().map(|x| x.to_f64()).collect() };
    let (params, inputs, bodies) = (wide(params), wide(inputs), wide(bodies));
    let from = StartFrom::new(&params, time.to_f64()).with_inputs(&inputs);
    let mut placed = wide(state);
    mbd_scene::set_bodies(
        (&declared.scene, &declared.layout),
        from,
        &bodies,
        &mut placed,
    );
    for (slot, number) in state.iter_mut().zip(placed) {
        *slot = T::from_f64(number);
    }
}

/// Stiffness, damping and free length of every line, then of every stop.
pub type Lines<T> = Vec<LineNumbers<T>>;

/// The numbers of the lines for parameters that can be run.
///
/// # Errors
/// The first parameter that cannot be run.
pub fn prepare<T: Float>(scene: &Scene, params: &[T]) -> Result<Lines<T>, ParamError> {
    Ok(checked_numbers(scene, params)?.lines)
}

/// The numbers of the lines for parameters that nobody has checked.
#[must_use]
pub fn unchecked<T: Real>(scene: &Scene, params: &[T]) -> Lines<T> {
    Numbers::new(scene, params).lines
}

/// Arrays of any length as serde lists: serde knows those of up to 32.
pub mod list {
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    /// Writes a list.
    ///
    /// # Errors
    /// Those of the serializer.
    pub fn serialize<V: Serialize, S: Serializer, const N: usize>(
        values: &[V; N],
        to: S,
    ) -> Result<S::Ok, S::Error> {
        to.collect_seq(values)
    }

    /// Reads a list.
    ///
    /// # Errors
    /// Those of the deserializer; a list of another length.
    pub fn deserialize<'de, V: Deserialize<'de>, D: Deserializer<'de>, const N: usize>(
        from: D,
    ) -> Result<[V; N], D::Error> {
        let values = Vec::<V>::deserialize(from)?;
        let found = values.len();
        let wrong = |_| D::Error::custom(format_args!("expected {N} values, found {found}"));
        values.try_into().map_err(wrong)
    }
}

/// Names and units of coordinates.
#[must_use]
pub const fn named<const N: usize>(pairs: [(&'static str, &'static str); N]) -> [CoordInfo; N] {
    let mut named = [CoordInfo { name: "", unit: "" }; N];
    let mut index = 0;
    while index < N {
        let (name, unit) = pairs[index];
        named[index] = CoordInfo { name, unit };
        index += 1;
    }
    named
}

/// Parameter values as an array.
///
/// # Errors
/// [`ParamError::Count`] for a list of another length.
pub fn counted<T: Copy, const N: usize>(params: &[T]) -> Result<[T; N], ParamError> {
    params.try_into().map_err(|_| ParamError::Count {
        expected: N,
        found: params.len(),
    })
}

/// The slice as an array, if it has the right length.
#[inline]
#[must_use]
pub fn fixed<T, const N: usize>(slice: &[T]) -> Option<&[T; N]> {
    slice.try_into().ok()
}

/// The slice as an array to write to, if it has the right length.
#[inline]
pub fn fixed_mut<T, const N: usize>(slice: &mut [T]) -> Option<&mut [T; N]> {
    slice.try_into().ok()
}

/// Right-hand sides behind a factor, row by row, and room for as many solutions: how many columns, and the factor with the right-hand sides.
#[inline]
#[allow(clippy::type_complexity, reason = "a count, an array and a list")]
fn behind<'a, T, const F: usize, const N: usize>(
    rows: &'a [T],
    out: &[T],
) -> Option<(usize, &'a [T; F], &'a [T])> {
    let (factor, right) = rows.split_first_chunk()?;
    let fits = right.len() == out.len() && right.len().is_multiple_of(N.max(1));
    fits.then_some((out.len() / N.max(1), factor, right))
}

/// [`Quantity::Solve`](mbd_scene::Quantity::Solve) column by column: `alone` takes the factor and one of them.
pub fn solve_columns<T: Real, const F: usize, const N: usize>(
    rows: &[T],
    out: &mut [T],
    mut alone: impl FnMut(&[T; F], &[T; N], &mut [T; N]),
) {
    if let Some((columns, factor, right)) = behind::<T, F, N>(rows, out) {
        for column in 0..columns {
            solve_column((factor, right), (column, columns), out, &mut alone);
        }
    }
}

#[inline]
fn solve_column<T: Real, const F: usize, const N: usize>(
    (factor, right): (&[T; F], &[T]),
    (column, columns): (usize, usize),
    out: &mut [T],
    alone: &mut impl FnMut(&[T; F], &[T; N], &mut [T; N]),
) {
    let (mut given, mut found) = ([T::zero(); N], [T::zero(); N]);
    let right = right.iter().skip(column).step_by(columns);
    given.iter_mut().zip(right).for_each(|(to, x)| *to = *x);
    alone(factor, &given, &mut found);
    let out = out.iter_mut().skip(column).step_by(columns);
    out.zip(found).for_each(|(to, x)| *to = x);
}

/// The same, four columns beside each other: every one has the numbers that it has alone.
pub fn solve_beside<const F: usize, const N: usize>(
    rows: &[f64],
    out: &mut [f64],
    mut alone: impl FnMut(&[f64; F], &[f64; N], &mut [f64; N]),
    mut beside: impl FnMut(&[Lanes4; F], &[Lanes4; N], &mut [Lanes4; N]),
) {
    let Some((columns, factor, right)) = behind::<f64, F, N>(rows, out) else {
        return;
    };
    const WIDTH: usize = Lanes4::WIDTH;
    if columns == 1 {
        return solve_column((factor, right), (0, columns), out, &mut alone);
    }
    let (mut given, mut found) = ([Lanes4::zero(); N], [Lanes4::zero(); N]);
    let mut wide = [Lanes4::zero(); F];
    for (to, x) in wide.iter_mut().zip(factor) {
        *to = Lanes4::from([*x; WIDTH]);
    }
    let mut first = 0;
    while first < columns {
        for (to, row) in given.iter_mut().zip(right.chunks_exact(columns)) {
            let right = row.get(first..).unwrap_or_default();
            *to = Lanes4::from(match right.first_chunk::<WIDTH>() {
                Some(beside) => *beside,
                None => leading(right),
            });
        }
        beside(&wide, &given, &mut found);
        for (x, row) in found.iter().zip(out.chunks_exact_mut(columns)) {
            let out = row.get_mut(first..).unwrap_or_default();
            let x = <[f64; WIDTH]>::from(*x);
            match out.first_chunk_mut::<WIDTH>() {
                Some(out) => *out = x,
                None => copy_few(&x, out),
            }
        }
        first += WIDTH;
    }
}

/// Room for columns of a matrix beside each other.
type ColumnRoom = Vec<Lanes4>;

/// Scratch of so many numbers, and of so many registers for columns of a matrix.
#[must_use]
pub fn work_with_columns(count: usize, beside: usize) -> Work<f64> {
    Work::list_and(count, vec![Lanes4::zero(); beside])
}

/// The two parts of it.
pub fn work_and_columns(work: &mut Work<f64>) -> (&mut [f64], &mut [Lanes4]) {
    let (numbers, beside) = work.both::<ColumnRoom>();
    (
        numbers,
        beside.map_or(&mut [], |beside| beside.as_mut_slice()),
    )
}

/// The direction, what does not depend on it, and the rest of a working list.
#[inline]
#[allow(clippy::type_complexity, reason = "two arrays and a list")]
fn directed<T, const C: usize, const V: usize>(
    work: &mut [T],
) -> Option<(&mut [T; C], &mut [T; V], &mut [T])> {
    let (direction, rest) = work.split_first_chunk_mut()?;
    let (values, rest) = rest.split_first_chunk_mut()?;
    Some((direction, values, rest))
}

/// A matrix column by column, of the C columns that are given of so many. `before` finds the V numbers that do not depend on the direction; `alone` takes the derivative of the R rows in the
/// direction that the working list begins with.
pub fn columns<T: Real, const C: usize, const V: usize, const R: usize>(
    work: &mut [T],
    (columns, width): (&[usize; C], usize),
    out: &mut [T],
    before: impl Fn(&mut [T; V], &mut [T]),
    alone: impl Fn(&mut [T], &mut [T; R]),
) {
    let Some((direction, values, rest)) = directed::<T, C, V>(work) else {
        return;
    };
    before(values, rest);
    direction.fill(T::zero());
    let mut found = [T::zero(); R];
    for (number, &column) in columns.iter().enumerate() {
        if let Some(seed) = work.get_mut(number) {
            *seed = T::one();
        }
        alone(work, &mut found);
        if let Some(seed) = work.get_mut(number) {
            *seed = T::zero();
        }
        let out = out.iter_mut().skip(column).step_by(width.max(1));
        out.zip(&found).for_each(|(to, x)| *to = *x);
    }
}

/// The same, four columns beside each other.
pub fn columns_beside<const C: usize, const V: usize, const R: usize>(
    (work, wide): (&mut [f64], &mut [Lanes4]),
    (columns, width): (&[usize; C], usize),
    out: &mut [f64],
    before: impl Fn(&mut [f64; V], &mut [f64]),
    beside: impl Fn(&mut [Lanes4], &mut [Lanes4; R]),
) {
    let narrow = directed::<f64, C, V>(work);
    let (Some((_, values, rest)), Some((direction, known, _))) =
        (narrow, directed::<Lanes4, C, V>(wide))
    else {
        return;
    };
    const WIDTH: usize = Lanes4::WIDTH;
    before(values, rest);
    direction.fill(Lanes4::zero());
    for (to, x) in known.iter_mut().zip(values) {
        *to = Lanes4::from([*x; WIDTH]);
    }
    let mut found = [Lanes4::zero(); R];
    for (group, columns) in columns.chunks(WIDTH).enumerate() {
        let seeds = group * WIDTH..group * WIDTH + columns.len();
        for (lane, seed) in wide[seeds.clone()].iter_mut().enumerate() {
            let unit = |other| f64::from(u8::from(other == lane));
            *seed = Lanes4::from(std::array::from_fn::<_, WIDTH, _>(unit));
        }
        beside(wide, &mut found);
        wide[seeds].fill(Lanes4::zero());
        for (row, x) in out.chunks_mut(width.max(1)).zip(&found) {
            let x = <[f64; WIDTH]>::from(*x);
            for (&column, x) in columns.iter().zip(x) {
                if let Some(to) = row.get_mut(column) {
                    *to = x;
                }
            }
        }
    }
}

/// The first numbers of a list; zero where it ends early.
#[must_use]
pub fn leading<T: Real, const N: usize>(numbers: &[T]) -> [T; N] {
    let mut leading = [T::zero(); N];
    copy_few(numbers, &mut leading);
    leading
}

/// The state as coordinates, speeds and node positions, if it has the right length.
#[inline]
#[must_use]
#[allow(clippy::type_complexity, reason = "three arrays of three lengths")]
pub fn split<T, const Q: usize, const V: usize, const Z: usize>(
    state: &[T],
) -> Option<(&[T; Q], &[T; V], &[T; Z])> {
    let (q, rest) = state.split_first_chunk()?;
    let (v, rest) = rest.split_first_chunk()?;
    Some((q, v, rest.try_into().ok()?))
}

/// The state of a model with declared states as coordinates, speeds, node positions and these, if it has the right length.
#[inline]
#[must_use]
#[allow(clippy::type_complexity, reason = "four arrays of four lengths")]
pub fn split_with_states<T, const Q: usize, const V: usize, const Z: usize, const S: usize>(
    state: &[T],
) -> Option<(&[T; Q], &[T; V], &[T; Z], &[T; S])> {
    let (rest, states) = state.split_last_chunk()?;
    let (q, v, z) = split(rest)?;
    Some((q, v, z, states))
}

/// Ten numbers a line as line states.
#[must_use]
pub fn line_states<T: Real, const N: usize>(numbers: &[T]) -> [LineState<T>; N] {
    let mut lines = numbers.chunks_exact(LINE_NUMBERS);
    std::array::from_fn(|_| {
        let line: Option<&[T; LINE_NUMBERS]> = lines.next().and_then(fixed);
        let [tension, length, stretch, rate, xx, xy, xz, yy, yz, zz] =
            *line.unwrap_or(&[T::zero(); LINE_NUMBERS]);
        LineState {
            tension,
            length,
            stretch,
            rate,
            stiffness: [xx, xy, xz, yy, yz, zz],
        }
    })
}

/// Six numbers a joint as reactions.
#[must_use]
pub fn reactions<T: Real, const N: usize>(numbers: &[T]) -> [Reaction<T>; N] {
    let mut joints = numbers.chunks_exact(6);
    std::array::from_fn(|_| {
        let joint: Option<&[T; 6]> = joints.next().and_then(fixed);
        let [fx, fy, fz, tx, ty, tz] = *joint.unwrap_or(&[T::zero(); 6]);
        Reaction {
            force: [fx, fy, fz],
            torque: [tx, ty, tz],
        }
    })
}

/// A list as its first Q, next V and next Z numbers; zero where it ends early.
#[must_use]
pub fn parts<T: Real, const Q: usize, const V: usize, const Z: usize>(
    numbers: &[T],
) -> ([T; Q], [T; V], [T; Z]) {
    let mut rest = numbers.iter().copied();
    let mut next = || rest.next().unwrap_or_else(T::zero);
    let q = std::array::from_fn(|_| next());
    let v = std::array::from_fn(|_| next());
    (q, v, std::array::from_fn(|_| next()))
}

/// The same of a model with declared states, whose S numbers follow.
#[must_use]
pub fn parts_with_states<
    T: Real,
    const Q: usize,
    const V: usize,
    const Z: usize,
    const S: usize,
>(
    numbers: &[T],
) -> ([T; Q], [T; V], [T; Z], [T; S]) {
    let (q, v, z) = parts(numbers);
    let mut rest = numbers.iter().skip(Q + V + Z).copied();
    let states = std::array::from_fn(|_| rest.next().unwrap_or_else(T::zero));
    (q, v, z, states)
}

/// Writes a list into a working list, from a place on; `false` where that is too short.
#[inline]
pub fn enter<T: Copy, const N: usize>(work: &mut [T], begin: usize, list: &[T; N]) -> bool {
    let place = work.get_mut(begin..).and_then(<[T]>::first_chunk_mut);
    place.map(|place| *place = *list).is_some()
}

/// What a kernel may read of a working list, and the range that it writes from its own place on; `None` where the list is too short.
#[inline(always)]
pub fn own_range<T, const N: usize>(work: &mut [T], begin: usize) -> Option<(&[T], &mut [T; N])> {
    let (known, own) = work.split_at_mut_checked(begin)?;
    Some((known, own.first_chunk_mut()?))
}

/// The numbers of a working list from a place on; `None` where it is too short.
#[inline(always)]
#[must_use]
pub fn window<T, const N: usize>(known: &[T], begin: usize) -> Option<&[T; N]> {
    known.get(begin..)?.first_chunk()
}

/// Places of this round of a loop; advances them to the next.
#[inline(always)]
pub fn next<const N: usize>(places: &mut [usize; N], steps: [isize; N]) -> [usize; N] {
    let these = *places;
    for (place, step) in places.iter_mut().zip(steps) {
        *place = place.wrapping_add_signed(step);
    }
    these
}

/// Calls a kernel several times, places advancing evenly, as long as it can do its work.
#[inline(always)]
pub fn rounds<T, const N: usize>(
    work: &mut [T],
    count: usize,
    mut places: [usize; N],
    steps: [isize; N],
    kernel: impl Fn(&mut [T], [usize; N]) -> bool,
) -> bool {
    (0..count).all(|_| kernel(work, next(&mut places, steps)))
}

/// The same for a kernel that takes known numbers: one row a call.
#[inline(always)]
pub fn rounds_with<T, const N: usize, const K: usize>(
    work: &mut [T],
    rows: &[[f64; K]],
    mut places: [usize; N],
    steps: [isize; N],
    kernel: impl Fn(&mut [T], [usize; N], &[f64; K]) -> bool,
) -> bool {
    rows.iter()
        .all(|row| kernel(work, next(&mut places, steps), row))
}

/// Takes every result from its place in a working list; `false` where the list is too short.
#[inline(always)]
pub fn take<T: Copy, const N: usize>(work: &[T], out: &mut [T; N], places: &[usize; N]) -> bool {
    for (out, &place) in out.iter_mut().zip(places) {
        let Some(&value) = work.get(place) else {
            return false;
        };
        *out = value;
    }
    true
}

/// Copies as many numbers as fit. Mostly they are few, and a call of what copies many costs more than they do.
#[inline]
fn copy_few<T: Copy>(from: &[T], out: &mut [T]) {
    #[inline(always)]
    fn all<T: Copy, const N: usize>(from: &[T], out: &mut [T]) {
        if let (Some(from), Some(out)) = (from.first_chunk::<N>(), out.first_chunk_mut()) {
            *out = *from;
        }
    }
    match out.len().min(from.len()) {
        0 => {}
        1 => all::<T, 1>(from, out),
        2 => all::<T, 2>(from, out),
        3 => all::<T, 3>(from, out),
        4 => all::<T, 4>(from, out),
        count => {
            let (from, out) = (from.get(..count), out.get_mut(..count));
            if let (Some(from), Some(out)) = (from, out) {
                out.copy_from_slice(from);
            }
        }
    }
}

/// Rounds of stretches to copy: how often; how many numbers, first place and step in the result, first place and step in the working list.
pub type Copies = (usize, &'static [(usize, (usize, isize), (usize, isize))]);

/// Copies results out of a working list; `false` where one of the lists is too short.
#[inline]
pub fn copy<T: Copy>(work: &[T], out: &mut [T], copies: &[Copies]) -> bool {
    for &(rounds, stretches) in copies {
        for round in 0..rounds as isize {
            for &(count, (to, to_step), (from, from_step)) in stretches {
                let to = to.wrapping_add_signed(to_step.wrapping_mul(round));
                let from = from.wrapping_add_signed(from_step.wrapping_mul(round));
                let (Some(out), Some(work)) = (
                    out.get_mut(to..).and_then(|out| out.get_mut(..count)),
                    work.get(from..).and_then(|work| work.get(..count)),
                ) else {
                    return false;
                };
                copy_few(work, out);
            }
        }
    }
    true
}
