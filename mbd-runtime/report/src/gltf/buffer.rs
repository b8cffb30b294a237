//! The numbers of a glTF file: one block of bytes, parted into views, read through accessors.

use serde_json::{Value, json};

/// 32-bit floating point, as the format counts component types.
const FLOAT: u32 = 5126;
/// 16-bit unsigned.
const UNSIGNED_SHORT: u32 = 5123;
/// What a view of vertices, and one of their indices, is for.
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// A block that grows.
#[derive(Debug, Default)]
pub(super) struct Buffer {
    /// All bytes; a multiple of four.
    pub bytes: Vec<u8>,
    /// `bufferViews`.
    pub views: Vec<Value>,
    /// `accessors`.
    pub accessors: Vec<Value>,
}

impl Buffer {
    /// Vectors of a mesh; the number of their accessor.
    pub fn vertices(&mut self, list: &[[f32; 3]]) -> usize {
        self.floats(list, "VEC3", Some(VERTICES))
    }

    /// Corners of triangles.
    pub fn indices(&mut self, list: &[u16]) -> usize {
        let bytes: Vec<u8> = list.iter().flat_map(|index| index.to_le_bytes()).collect();
        let view = self.view(&bytes, Some(INDICES));
        self.accessor(json!({
            "bufferView": view, "componentType": UNSIGNED_SHORT, "count": list.len(), "type": "SCALAR",
        }))
    }

    /// Rows of numbers of an animation, `SCALAR`, `VEC3` or `VEC4`.
    pub fn course<const N: usize>(&mut self, list: &[[f32; N]], kind: &str) -> usize {
        self.floats(list, kind, None)
    }

    fn floats<const N: usize>(
        &mut self,
        list: &[[f32; N]],
        kind: &str,
        target: Option<u32>,
    ) -> usize {
        let bytes: Vec<u8> = list
            .iter()
            .flatten()
            .flat_map(|x| x.to_le_bytes())
            .collect();
        let view = self.view(&bytes, target);
        let bound = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
            let first = list.first().copied().unwrap_or([0.0; N]);
            let each = list.iter().fold(first, |bound, row| {
                let mut next = bound;
                for (bound, x) in next.iter_mut().zip(row) {
                    *bound = pick(*bound, *x);
                }
                next
            });
            each.to_vec()
        };
        self.accessor(json!({
            "bufferView": view, "componentType": FLOAT, "count": list.len(), "type": kind,
            "min": bound(f32::min), "max": bound(f32::max),
        }))
    }

    fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        let mut view =
            json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let (Some(target), Some(fields)) = (target, view.as_object_mut()) {
            fields.insert("target".into(), target.into());
        }
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(view);
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}
