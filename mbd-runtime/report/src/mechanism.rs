//! The mechanism of a run at several instants, drawn in the plane in which it extends most; a planar scene in its own.

use mbd_runtime::Trajectory;
use mbd_runtime::nalgebra::{Matrix3, Vector3};
use mbd_runtime::scene::laws::{GravityNumbers, Numbers};
use mbd_runtime::scene::{Place, Plane, PointKind, Scene};

use super::drawing::{Drawing, DrawingPart};
use super::stage::{AXES, RecordedScene, Track};
use super::surface::{Patch as SurfacePart, SurfaceSolid};

/// The instants of a drawing when none are asked for.
const INSTANTS: usize = 5;
/// Paths of more bodies than this are not told apart: only the last one is drawn.
const PATHS: usize = 5;
/// A second view is drawn when the mechanism is at least this deep, compared with its largest extent.
const DEEP: f64 = 0.1;
/// What nothing holds and what travels further than this many of its own lengths is drawn about its own middle.
const TRAVELS: f64 = 1.2;
/// What is smaller than this part of its way is seen on all of it: a single thing, and several that keep together.
const SMALL: [f64; 2] = [0.01, 1e-5];
/// Places of a joint that are further apart than this slide on each other [m].
const APART: f64 = 1e-9;

/// A part of the mechanism in space.
enum SpatialPart {
    Body(Vec<Vector3<f64>>),
    Solid(Skin),
    Line([Vector3<f64>; 2], bool),
    /// Between the two places of a joint that slides.
    Rail([Vector3<f64>; 2]),
    Joint(Vector3<f64>),
    Pivot(Vector3<f64>),
    Point(Vector3<f64>),
}

/// The surface of a solid in space.
struct Skin {
    places: Vec<Vector3<f64>>,
    /// Of each flat part the direction outwards, and its rims by their places.
    flats: Vec<(Vector3<f64>, Vec<Vec<usize>>)>,
}

impl Skin {
    /// That of a solid of a body whose centre of mass is there, and whose axes are rotated so.
    fn of(placed: &SurfaceSolid, (middle, turn): (&Vector3<f64>, &Matrix3<f64>)) -> Skin {
        let surface = placed.surface();
        let places = surface.places.iter();
        let places = places.map(|place| middle + turn * placed.on_body(place));
        let flat = |part: &SurfacePart| {
            let outwards = turn * (placed.turn * part.flat()?);
            Some((outwards, part.rims.clone()))
        };
        Skin {
            places: places.collect(),
            flats: surface.parts.iter().filter_map(flat).collect(),
        }
    }

    /// Its silhouette, and the rims of what is flat and looks at the reader.
    fn seen(&self, view: &View) -> DrawingPart {
        let on_paper = |corner: &usize| self.places.get(*corner).map(|place| view.place(place));
        let rim = |rim: &Vec<usize>| rim.iter().filter_map(on_paper).collect();
        let facing = self
            .flats
            .iter()
            .filter(|(outwards, _)| view.sees(outwards));
        let rims = facing.flat_map(|(_, rims)| rims.iter().map(rim));
        DrawingPart::Solid {
            silhouette: self.places.iter().map(|place| view.place(place)).collect(),
            rims: rims.collect(),
        }
    }
}

/// A plane in space that is drawn: the axes across and up.
struct View([usize; 2]);

impl View {
    fn place(&self, place: &Vector3<f64>) -> [f64; 2] {
        self.0.map(|axis| place[axis])
    }

    /// Whether a reader sees what looks in this direction.
    fn sees(&self, outwards: &Vector3<f64>) -> bool {
        let axis = |k: usize| Vector3::from_fn(|i, _| f64::from(u8::from(i == k)));
        let [across, up] = self.0.map(axis);
        across.cross(&up).dot(outwards) > 1e-9
    }
}

impl SpatialPart {
    fn places(&self) -> &[Vector3<f64>] {
        match self {
            SpatialPart::Body(places) => places,
            SpatialPart::Solid(skin) => &skin.places,
            SpatialPart::Line(ends, _) | SpatialPart::Rail(ends) => ends,
            SpatialPart::Joint(at) | SpatialPart::Pivot(at) | SpatialPart::Point(at) => {
                std::slice::from_ref(at)
            }
        }
    }

    fn seen(&self, view: &View) -> DrawingPart {
        let on_paper = |place: &Vector3<f64>| view.place(place);
        match self {
            SpatialPart::Body(places) => DrawingPart::Body(places.iter().map(on_paper).collect()),
            SpatialPart::Solid(skin) => skin.seen(view),
            SpatialPart::Line(ends, slack) => {
                DrawingPart::Line(ends.each_ref().map(on_paper), *slack)
            }
            SpatialPart::Rail(ends) => DrawingPart::Rail(ends.each_ref().map(on_paper)),
            SpatialPart::Joint(at) => DrawingPart::Joint(view.place(at)),
            SpatialPart::Pivot(at) => DrawingPart::Pivot(view.place(at)),
            SpatialPart::Point(at) => DrawingPart::Point(view.place(at)),
        }
    }
}

/// The drawings of a run: one, or two views where the mechanism extends in space; none where nothing holds it together.
///
/// `params`: in declaration order [SI]. `instants`: when it is drawn [s]; empty: evenly over the run.
#[must_use]
pub fn drawings(
    scene: &Scene,
    params: &[f64],
    instants: &[f64],
    trajectory: &Trajectory,
) -> Vec<Drawing> {
    let rows = rows(instants, trajectory.times());
    let stage = RecordedScene::new(scene, params, trajectory);
    let mut instants: Vec<Vec<SpatialPart>> = rows.iter().map(|&row| stage.parts(row)).collect();
    let (Some(&first), Some(&last)) = (rows.first(), rows.last()) else {
        return Vec::new();
    };
    let mut paths = stage.paths(first..=last);
    let least = SMALL[usize::from(scene.bodies.len() + scene.points.len() > 1)];
    let travels = about_itself(&mut instants, &mut paths, least);
    let depth = extents(&instants, &paths);
    let upwards = upwards(scene, &stage.numbers);
    let planes = views(depth, scene.planar, upwards);
    let times: Vec<String> = rows
        .iter()
        .filter_map(|&row| trajectory.times().get(row))
        .map(|time| ((time * 1000.0).round() / 1000.0).to_string())
        .collect();
    let seen = match travels {
        true => "; moving with its middle. Circles: joints and knots",
        false => ". Circles: joints and knots; triangles: fixed in the world",
    };
    let curves = match paths.is_empty() {
        true => "",
        false => {
            "; curves: paths of centres of mass and points, from the first to the last of these instants"
        }
    };
    let caption = format!(
        "At {} s, from pale to dark{seen}{curves}.",
        times.join(", ")
    );
    planes
        .into_iter()
        .map(|plane| draw(scene, plane, &instants, &paths, &caption))
        .collect()
}

fn draw(
    scene: &Scene,
    plane: [usize; 2],
    instants: &[Vec<SpatialPart>],
    paths: &[(String, Vec<Vector3<f64>>)],
    caption: &str,
) -> Drawing {
    let view = View(plane);
    let names = plane.map(|axis| AXES.get(axis).copied().unwrap_or_default());
    let title = format!(
        "{}: the mechanism, {}{} plane",
        scene.name, names[0], names[1]
    );
    let mut drawing = Drawing::new(title, names).caption(caption);
    for parts in instants {
        drawing = drawing.instant(parts.iter().map(|part| part.seen(&view)));
    }
    for (name, places) in paths {
        drawing = drawing.path(name, places.iter().map(|place| view.place(place)).collect());
    }
    drawing
}

/// The rows of the history nearest to the instants of a plan, each once.
fn rows(instants: &[f64], times: &[f64]) -> Vec<usize> {
    let Some(&end) = times.last() else {
        return Vec::new();
    };
    let start = times.first().copied().unwrap_or(end);
    let even = |k: usize| start + (end - start) * k as f64 / (INSTANTS - 1) as f64;
    let wanted: Vec<f64> = match instants {
        [] => (0..INSTANTS).map(even).collect(),
        list => list.to_vec(),
    };
    let nearest = |time: &f64| {
        let after = times.partition_point(|t| t < time).min(times.len() - 1);
        let before = after.saturating_sub(1);
        let distance = |row: usize| times.get(row).map_or(f64::INFINITY, |t| (t - time).abs());
        if distance(before) < distance(after) {
            before
        } else {
            after
        }
    };
    let mut rows: Vec<usize> = wanted.iter().map(nearest).collect();
    rows.sort_unstable();
    rows.dedup();
    rows
}

impl RecordedScene<'_> {
    /// Everything at one row.
    fn parts(&self, row: usize) -> Vec<SpatialPart> {
        let scene = self.scene;
        let mut parts = Vec::new();
        for (body, declared) in scene.bodies.iter().enumerate() {
            let skins = self.skins(body, row);
            if !skins.is_empty() {
                parts.extend(skins.into_iter().map(SpatialPart::Solid));
                let arms = self.arms(body).into_iter().filter_map(|frame| {
                    let ends = [0, frame].map(|frame| self.place(Place::Body(body, frame), row));
                    Some(SpatialPart::Body(vec![ends[0]?, ends[1]?]))
                });
                parts.extend(arms);
                continue;
            }
            // A body between two of its places; its centre of mass is one of them where it has no other two.
            let first = usize::from(declared.frames.len() > 2);
            let frames = (first..declared.frames.len()).map(|frame| Place::Body(body, frame));
            let places = frames.filter_map(|place| self.place(place, row)).collect();
            parts.push(SpatialPart::Body(places));
        }
        for joint in scene.joints.iter().filter(|joint| joint.law.rows() > 0) {
            let fixed = |place: Place| matches!(place, Place::World(_));
            let (Some(parent), Some(child)) =
                (self.place(joint.parent, row), self.place(joint.child, row))
            else {
                continue;
            };
            if (child - parent).norm() > APART {
                parts.push(SpatialPart::Rail([parent, child]));
            }
            parts.extend(
                [(joint.parent, parent), (joint.child, child)].map(|(end, at)| {
                    if fixed(end) {
                        SpatialPart::Pivot(at)
                    } else {
                        SpatialPart::Joint(at)
                    }
                }),
            );
        }
        for line in &scene.lines {
            let ends = [line.from, line.to].map(|end| self.place(end, row));
            let stretch = self.column(&line.name, "stretch");
            let stretch = stretch.and_then(|column| column.get(row));
            if let ([Some(from), Some(to)], Some(stretch)) = (ends, stretch) {
                let slack = *stretch <= 0.0 && line.kind.is_unilateral();
                parts.push(SpatialPart::Line([from, to], slack));
            }
            for end in [line.from, line.to] {
                if let (Place::World(_), Some(at)) = (end, self.place(end, row)) {
                    parts.push(SpatialPart::Pivot(at));
                }
            }
        }
        for (point, declared) in scene.points.iter().enumerate() {
            if let Some(at) = self.place(Place::Point(point), row) {
                parts.push(match declared.kind {
                    PointKind::Mass(_) => SpatialPart::Point(at),
                    PointKind::Node(_) => SpatialPart::Joint(at),
                });
            }
        }
        parts
    }

    /// The shapes of a body where it is; none where it has none, or the history does not hold where it is.
    fn skins(&self, body: usize, row: usize) -> Vec<Skin> {
        let track = self.bodies.get(body).and_then(Option::as_ref);
        let pose = track.and_then(|track| Some((track.position(row)?, track.turn(row)?)));
        let Some((middle, turn)) = pose else {
            return Vec::new();
        };
        let solids = self.solids(body);
        let solids = solids.iter();
        solids
            .map(|placed| Skin::of(placed, (&middle, &turn)))
            .collect()
    }

    /// Paths of the centres of mass and of the points with mass.
    fn paths(&self, rows: std::ops::RangeInclusive<usize>) -> Vec<(String, Vec<Vector3<f64>>)> {
        let bodies = self.scene.bodies.iter().zip(&self.bodies);
        let bodies = bodies.map(|(body, track)| (body.name.as_str(), track));
        let points = self.scene.points.iter().zip(&self.points);
        let masses = points.filter(|(point, _)| matches!(point.kind, PointKind::Mass(_)));
        let masses = masses.map(|(point, track)| (point.name.as_str(), track));
        let all: Vec<(&str, &Option<Track<'_>>)> = bodies.chain(masses).collect();
        let shown = match all.as_slice() {
            list if list.len() <= PATHS => list,
            [.., last] => std::slice::from_ref(last),
            [] => &[],
        };
        let path = |(name, track): &(&str, &Option<Track<'_>>)| {
            let place = |row| track.as_ref()?.position(row);
            (
                (*name).to_string(),
                rows.clone().filter_map(place).collect(),
            )
        };
        shown.iter().map(path).collect()
    }
}

/// Moves every instant about its own middle, if the mechanism travels far; paths are then left out. Whether it does.
fn about_itself(
    instants: &mut [Vec<SpatialPart>],
    paths: &mut Vec<(String, Vec<Vector3<f64>>)>,
    least: f64,
) -> bool {
    let fixed = instants
        .iter()
        .flatten()
        .any(|part| matches!(part, SpatialPart::Pivot(_)));
    let own = instants
        .iter()
        .map(|parts| extents(std::slice::from_ref(parts), &[]).max())
        .fold(0.0, f64::max);
    let whole = extents(instants, &[]).max();
    if fixed || whole < TRAVELS * own || own <= least * whole {
        return false;
    }
    paths.clear();
    for parts in instants {
        let Some((low, high)) = bounds(parts.iter().flat_map(SpatialPart::places)) else {
            continue;
        };
        let middle = 0.5 * (low + high);
        for part in parts {
            match part {
                SpatialPart::Body(places) | SpatialPart::Solid(Skin { places, .. }) => {
                    places.iter_mut().for_each(|place| *place -= middle)
                }
                SpatialPart::Line(ends, _) | SpatialPart::Rail(ends) => {
                    ends.iter_mut().for_each(|end| *end -= middle)
                }
                SpatialPart::Joint(at) | SpatialPart::Pivot(at) | SpatialPart::Point(at) => {
                    *at -= middle
                }
            }
        }
    }
    true
}

fn bounds<'p>(
    places: impl Iterator<Item = &'p Vector3<f64>>,
) -> Option<(Vector3<f64>, Vector3<f64>)> {
    places
        .filter(|place| place.iter().all(|x| x.is_finite()))
        .fold(None, |bounds, place| {
            let (low, high) = bounds.unwrap_or((*place, *place));
            Some((low.inf(place), high.sup(place)))
        })
}

/// How far everything extends along the three axes [m].
fn extents(instants: &[Vec<SpatialPart>], paths: &[(String, Vec<Vector3<f64>>)]) -> Vector3<f64> {
    let parts = instants.iter().flatten().flat_map(SpatialPart::places);
    let all = parts.chain(paths.iter().flat_map(|(_, places)| places));
    bounds(all).map_or_else(Vector3::zeros, |(low, high)| high - low)
}

/// The axis that gravity points along, backwards: z where there is none, or none that is the same everywhere.
pub(super) fn upwards(scene: &Scene, numbers: &Numbers<f64>) -> usize {
    match &numbers.gravity {
        GravityNumbers::Uniform(pull) if pull.norm() > 0.0 => pull.iamax(),
        _ => match scene.planar {
            Some(Plane::Xy) => 1,
            _ => 2,
        },
    }
}

/// The planes to draw in, each as the axes across and up: that of largest extent, or of a planar scene, and one from the side if the mechanism is
/// deep. What is up in the world is up in every plane that contains it. None where nothing extends.
pub(super) fn views(
    extents: Vector3<f64>,
    plane: Option<Plane>,
    upwards: usize,
) -> Vec<[usize; 2]> {
    if extents.max() <= 0.0 {
        return Vec::new();
    }
    let (deep, least) = extents.argmin();
    let deep = match plane {
        Some(plane) => plane.normal(),
        // Of equal extents the plane with z upwards is taken.
        None if extents[1] <= least * (1.0 + 1e-9) => 1,
        None => deep,
    };
    let upright = |a: usize, b: usize| match a == upwards {
        true => [b, a],
        false => [a, b],
    };
    let [a, b] = match deep {
        0 => [1, 2],
        1 => [0, 2],
        _ => [0, 1],
    };
    let front = upright(a, b);
    // From the side: what is up stays up; of a plan, which has no up, the wider axis stays across.
    let kept = match deep == upwards {
        true if extents[b] > extents[a] => b,
        true => a,
        false => front[1],
    };
    let side = upright(deep.min(kept), deep.max(kept));
    let is_deep = plane.is_none() && extents[deep] > DEEP * extents.max();
    [front].into_iter().chain(is_deep.then_some(side)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_planar_scene_is_seen_along_its_normal_whatever_extends_in_it() {
        for (plane, want) in [
            (Plane::Xy, [0, 1]),
            (Plane::Yz, [1, 2]),
            (Plane::Xz, [0, 2]),
        ] {
            for axis in (0..3).filter(|&axis| axis != plane.normal()) {
                // A weight that falls along one axis.
                let mut extents = Vector3::zeros();
                extents[axis] = 2.0;
                assert_eq!(views(extents, Some(plane), 2), [want]);
            }
        }
        assert_eq!(views(Vector3::new(1.0, 2.0, 0.0), None, 2), [[0, 1]]);
        assert!(views(Vector3::zeros(), Some(Plane::Xz), 2).is_empty());
    }

    #[test]
    fn what_is_up_in_the_world_is_up_in_every_view() {
        // A platform: wide along x and y, seen from above and from the side.
        let platform = Vector3::new(2.0, 1.8, 0.5);
        assert_eq!(views(platform, None, 2), [[0, 1], [0, 2]]);
        // The same with gravity along y, as in many papers.
        assert_eq!(
            views(Vector3::new(2.0, 0.5, 1.8), None, 1),
            [[0, 2], [0, 1]]
        );
        // A tower and a swing.
        assert_eq!(
            views(Vector3::new(1.0, 0.5, 4.0), None, 2),
            [[0, 2], [1, 2]]
        );
        assert_eq!(
            views(Vector3::new(0.5, 1.0, 4.0), None, 2),
            [[1, 2], [0, 2]]
        );
    }
}
