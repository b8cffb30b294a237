//! A run as an animated glTF 2.0 file (Khronos Group), for viewers and for Blender: bodies as their shapes or ellipsoids, points as balls, lines as
//! rods that stretch. Binary form: a JSON chunk and a chunk of numbers.

mod buffer;
mod mesh;

use mbd_runtime::nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use mbd_runtime::scene::Place;
use mbd_runtime::scene::solids::Solid;
use serde_json::{Value, json};

use super::drawn::safe;
use super::film::ellipsoid;
use super::mechanism::upwards;
use super::playback::rows;
use super::stage::{RecordedScene, Track};
use super::surface::Surface;
use super::views::Run;
use buffer::Buffer;
use mesh::Mesh;

/// Radius of a line, and of a point, as a share of the size of the scene.
const LINE: f64 = 0.002;
const POINT: f64 = 0.008;

/// A run as the bytes of a `.glb` file; `None` where the history holds no motion.
#[must_use]
pub fn gltf(run: &Run<'_>) -> Option<Vec<u8>> {
    let stage = RecordedScene::new(run.scene, run.params, run.trajectory);
    let rows = moments(&stage);
    let mut writer = GltfWriter {
        size: size(&stage, &rows)?,
        stage: &stage,
        rows: &rows,
        buffer: Buffer::default(),
        nodes: Vec::new(),
        meshes: Vec::new(),
        materials: Vec::new(),
        channels: Vec::new(),
        samplers: Vec::new(),
        times: None,
    };
    Some(writer.file())
}

/// The rows that are shown: no two at one time, none with a gap.
fn moments(stage: &RecordedScene<'_>) -> Vec<usize> {
    let times = stage.trajectory.times();
    let whole = |row: usize| {
        let mut tracks = stage.bodies.iter().chain(&stage.points).flatten();
        tracks.all(|track| {
            track
                .columns()
                .all(|column| column.get(row).is_some_and(|x| x.is_finite()))
        })
    };
    let mut kept: Vec<usize> = Vec::new();
    for row in rows(stage).into_iter().filter(|row| whole(*row)) {
        // What an event changed stands behind it.
        if let Some(last) = kept.last().copied()
            && times[row] as f32 <= times[last] as f32
        {
            kept.pop();
        }
        kept.push(row);
    }
    kept
}

/// How far everything extends at the first row [m]; `None` where nothing is anywhere.
fn size(stage: &RecordedScene<'_>, rows: &[usize]) -> Option<f64> {
    let row = *rows.first()?;
    let tracks = stage.bodies.iter().chain(&stage.points).flatten();
    let mut places: Vec<Vector3<f64>> = tracks.filter_map(|track| track.position(row)).collect();
    for (index, numbers) in stage.numbers.bodies.iter().enumerate() {
        let frames = 0..numbers.frames.len();
        places.extend(frames.filter_map(|frame| stage.place(Place::Body(index, frame), row)));
        let axes = ellipsoid(numbers).unwrap_or_default();
        let middle = stage.place(Place::Body(index, 0), row)?;
        places.extend(axes.map(|axis| middle + Vector3::from(axis)));
    }
    let first = *places.first()?;
    let (low, high) = places.iter().fold((first, first), |(low, high), place| {
        (low.inf(place), high.sup(place))
    });
    Some((high - low).norm().max(1e-3))
}

struct GltfWriter<'a> {
    stage: &'a RecordedScene<'a>,
    rows: &'a [usize],
    size: f64,
    buffer: Buffer,
    nodes: Vec<Value>,
    meshes: Vec<Value>,
    materials: Vec<Value>,
    channels: Vec<Value>,
    samplers: Vec<Value>,
    /// The accessor of the times.
    times: Option<usize>,
}

impl GltfWriter<'_> {
    fn file(&mut self) -> Vec<u8> {
        let mut roots = Vec::new();
        for index in 0..self.stage.bodies.len() {
            roots.extend(self.body(index));
        }
        for index in 0..self.stage.points.len() {
            roots.extend(self.point(index));
        }
        for index in 0..self.stage.scene.lines.len() {
            roots.extend(self.line(index));
        }
        // y is up in glTF.
        let mut up = Vector3::zeros();
        up[upwards(self.stage.scene, &self.stage.numbers)] = 1.0;
        let turn = UnitQuaternion::rotation_between(&up, &Vector3::y());
        let turn = turn.unwrap_or_else(UnitQuaternion::identity);
        let root = self.node(json!({
            "name": safe(&self.stage.scene.name), "children": roots, "rotation": quaternion(&turn),
        }));
        let mut document = json!({
            "asset": { "version": "2.0", "generator": concat!("mbd ", env!("CARGO_PKG_VERSION")) },
            "scene": 0,
            "scenes": [{ "nodes": [root] }],
            "nodes": self.nodes,
            "meshes": self.meshes,
            "materials": self.materials,
            "accessors": self.buffer.accessors,
            "bufferViews": self.buffer.views,
            "buffers": [{ "byteLength": self.buffer.bytes.len() }],
        });
        if let (false, Some(fields)) = (self.channels.is_empty(), document.as_object_mut()) {
            let animation =
                json!({ "name": "run", "channels": self.channels, "samplers": self.samplers });
            fields.insert("animations".into(), json!([animation]));
        }
        binary(&document, &self.buffer.bytes)
    }

    fn body(&mut self, index: usize) -> Option<usize> {
        let stage = self.stage;
        let (scene, numbers) = (stage.scene, stage.numbers.bodies.get(index)?);
        let track = stage.bodies.get(index)?.as_ref()?;
        let material = self.material(index);
        let mut parts = Vec::new();
        for placed in stage.solids(index) {
            let mesh = self.mesh(&placed.surface(), material);
            let at = <[f64; 3]>::from(placed.at);
            parts.push(self.node(json!({
                "mesh": mesh, "translation": at, "rotation": quaternion(&attitude(&placed.turn)),
            })));
        }
        if parts.is_empty()
            && let Some(axes) = ellipsoid(numbers)
        {
            let mesh = self.mesh(&Surface::of(Solid::Sphere, &[1.0]), material);
            let axes = axes.map(Vector3::from);
            // What is flat has no thickness of its own; a scale of zero has no inverse.
            let scale = axes.map(|axis| axis.norm().max(1e-4 * self.size));
            let mut rotation = Matrix3::from_columns(&principal(&axes));
            if rotation.determinant() < 0.0 {
                rotation.column_mut(2).neg_mut();
            }
            parts.push(self.node(json!({
                "mesh": mesh, "scale": scale, "rotation": quaternion(&attitude(&rotation)),
            })));
        }
        let name = safe(&scene.bodies.get(index)?.name);
        let mut node = json!({ "name": name });
        if let (false, Some(fields)) = (parts.is_empty(), node.as_object_mut()) {
            fields.insert("children".into(), parts.into());
        }
        let node = self.node(node);
        self.moves(node, track);
        let mut turns: Vec<[f32; 4]> = Vec::new();
        for row in self.rows {
            let [w, x, y, z] = track.quaternion(*row)?;
            let length = (w * w + x * x + y * y + z * z).sqrt();
            let mut turn = [x, y, z, w].map(|part| (part / length) as f32);
            // The shorter way from row to row.
            if let Some(last) = turns.last()
                && last.iter().zip(turn).map(|(a, b)| a * b).sum::<f32>() < 0.0
            {
                turn = turn.map(|part| -part);
            }
            turns.push(turn);
        }
        let turns = self.buffer.course(&turns, "VEC4");
        self.channel(node, "rotation", turns);
        Some(node)
    }

    fn point(&mut self, index: usize) -> Option<usize> {
        let track = self.stage.points.get(index)?.as_ref()?;
        let material = self.material(index + 3);
        let mesh = self.mesh(&Surface::of(Solid::Sphere, &[POINT * self.size]), material);
        let name = safe(&self.stage.scene.points.get(index)?.name);
        let node = self.node(json!({ "name": name, "mesh": mesh }));
        self.moves(node, track);
        Some(node)
    }

    /// A rod of length one along z, put between the ends of the line and stretched.
    fn line(&mut self, index: usize) -> Option<usize> {
        let line = self.stage.scene.lines.get(index)?;
        let (mut middles, mut turns, mut scales) = (Vec::new(), Vec::new(), Vec::new());
        for row in self.rows {
            let [from, to] = [line.from, line.to].map(|end| self.stage.place(end, *row));
            let (from, to) = (from?, to?);
            let along = to - from;
            let turn = UnitQuaternion::rotation_between(&Vector3::z(), &along);
            let turn = turn.unwrap_or_else(|| {
                // Half a turn, or no direction at all.
                match along.z < 0.0 {
                    true => {
                        UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
                    }
                    false => UnitQuaternion::identity(),
                }
            });
            middles.push(<[f64; 3]>::from(0.5 * (from + to)).map(|x| x as f32));
            turns.push(quaternion(&turn));
            scales.push([1.0, 1.0, along.norm().max(1e-6 * self.size) as f32]);
        }
        let finite = |list: &[[f32; 3]]| list.iter().flatten().all(|x| x.is_finite());
        if !(finite(&middles) && finite(&scales)) {
            return None;
        }
        let material = self.material(usize::MAX);
        let mesh = self.mesh(
            &Surface::of(Solid::Cylinder, &[LINE * self.size, 1.0]),
            material,
        );
        let node = self.node(json!({ "name": safe(&line.name), "mesh": mesh }));
        let courses = [
            ("translation", self.buffer.course(&middles, "VEC3")),
            ("rotation", self.buffer.course(&turns, "VEC4")),
            ("scale", self.buffer.course(&scales, "VEC3")),
        ];
        for (path, course) in courses {
            self.channel(node, path, course);
        }
        Some(node)
    }

    /// The course of the place of a node.
    fn moves(&mut self, node: usize, track: &Track<'_>) {
        let places: Vec<[f32; 3]> = (self.rows.iter())
            .filter_map(|row| track.position(*row))
            .map(|place| <[f64; 3]>::from(place).map(|x| x as f32))
            .collect();
        let places = self.buffer.course(&places, "VEC3");
        self.channel(node, "translation", places);
    }

    fn channel(&mut self, node: usize, path: &str, output: usize) {
        let times = match self.times {
            Some(times) => times,
            None => {
                let all = self.stage.trajectory.times();
                let start = self.rows.first().map_or(0.0, |row| all[*row]);
                // An animation begins at zero.
                let times: Vec<[f32; 1]> = self
                    .rows
                    .iter()
                    .map(|row| [(all[*row] - start) as f32])
                    .collect();
                *self.times.insert(self.buffer.course(&times, "SCALAR"))
            }
        };
        self.samplers
            .push(json!({ "input": times, "output": output, "interpolation": "LINEAR" }));
        let sampler = self.samplers.len() - 1;
        self.channels
            .push(json!({ "sampler": sampler, "target": { "node": node, "path": path } }));
    }

    fn node(&mut self, node: Value) -> usize {
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    fn mesh(&mut self, surface: &Surface, material: usize) -> usize {
        let mesh = Mesh::of(surface);
        let places = self.buffer.vertices(&mesh.places);
        let normals = self.buffer.vertices(&mesh.normals);
        let corners = self.buffer.indices(&mesh.corners);
        self.meshes.push(json!({ "primitives": [{
            "attributes": { "POSITION": places, "NORMAL": normals }, "indices": corners, "material": material,
        }] }));
        self.meshes.len() - 1
    }

    /// The colours of the pages; lines are grey.
    fn material(&mut self, index: usize) -> usize {
        let colour = match index {
            usize::MAX => [0.3, 0.3, 0.3],
            index => hue((205.0 + 137.5 * index as f64) % 360.0),
        };
        let [r, g, b] = colour;
        self.materials.push(json!({ "pbrMetallicRoughness": {
            "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.1, "roughnessFactor": 0.7,
        } }));
        self.materials.len() - 1
    }
}

/// Unit vectors along three half axes at right angles, any of which may be zero.
fn principal(axes: &[Vector3<f64>; 3]) -> [Vector3<f64>; 3] {
    let unit = |k: usize| axes[k].try_normalize(1e-12);
    match [unit(0), unit(1), unit(2)] {
        [Some(a), Some(b), Some(c)] => [a, b, c],
        [None, Some(b), Some(c)] => [b.cross(&c), b, c],
        [Some(a), None, Some(c)] => [a, c.cross(&a), c],
        [Some(a), Some(b), None] => [a, b, a.cross(&b)],
        // A rod: any directions across it.
        [a, b, c] => {
            let along = a.or(b).or(c).unwrap_or_else(Vector3::z);
            let across = along.cross(&match along.x.abs() < 0.9 {
                true => Vector3::x(),
                false => Vector3::y(),
            });
            let (u, v) = (across.normalize(), along.cross(&across).normalize());
            match (a.is_some(), b.is_some()) {
                (true, _) => [along, u, v],
                (_, true) => [v, along, u],
                _ => [u, v, along],
            }
        }
    }
}

fn attitude(rotation: &Matrix3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*rotation))
}

/// x, y, z, w, as glTF has it.
fn quaternion(turn: &UnitQuaternion<f64>) -> [f32; 4] {
    let parts = turn.quaternion().coords;
    <[f64; 4]>::from(parts).map(|part| part as f32)
}

/// A colour of medium strength, by its angle on the wheel [°].
fn hue(angle: f64) -> [f64; 3] {
    let part = |shift: f64| {
        let x = ((angle + shift) / 60.0).rem_euclid(6.0);
        let ramp = (2.0 - (x - 3.0).abs()).clamp(0.0, 1.0);
        0.75 - 0.5 * ramp
    };
    // Red, green and blue are a third of the wheel apart.
    [part(0.0), part(240.0), part(120.0)]
}

/// Header, JSON, numbers: each chunk a multiple of four bytes.
fn binary(document: &Value, numbers: &[u8]) -> Vec<u8> {
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + json.len() + 8 + numbers.len();
    let mut bytes = Vec::with_capacity(length);
    let word = |bytes: &mut Vec<u8>, number: usize| bytes.extend((number as u32).to_le_bytes());
    bytes.extend(b"glTF");
    word(&mut bytes, 2);
    word(&mut bytes, length);
    for (kind, chunk) in [(b"JSON", json.as_slice()), (b"BIN\0", numbers)] {
        word(&mut bytes, chunk.len());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}
