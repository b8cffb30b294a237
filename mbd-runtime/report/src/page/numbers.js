// The numbers of a page: what the report wrote into it, unpacked; vectors; where a time lies in a history.

/** Base64 to an array of numbers of a type. */
function unpack(Type, text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Type(bytes.buffer);
}

const add = (a, b, s = 1) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const norm = (a) => Math.sqrt(dot(a, a));
const unit = (a) => add([0, 0, 0], a, 1 / (norm(a) || 1));
const finite = (a) => Number.isFinite(a[0] + a[1] + a[2]);

/** Rows of the matrix that turns by a quaternion w x y z. */
function matrix([w, x, y, z]) {
  const n = 2 / (w * w + x * x + y * y + z * z || 1);
  return [
    [1 - n * (y * y + z * z), n * (x * y - w * z), n * (x * z + w * y)],
    [n * (x * y + w * z), 1 - n * (x * x + z * z), n * (y * z - w * x)],
    [n * (x * z - w * y), n * (y * z + w * x), 1 - n * (x * x + y * y)],
  ];
}
const turn = (m, a) => [dot(m[0], a), dot(m[1], a), dot(m[2], a)];
const product = (m, n) => m.map((row) => [0, 1, 2].map((k) => row[0] * n[0][k] + row[1] * n[1][k] + row[2] * n[2][k]));

/** Index of the last of rising times that is not after t, at least 0. */
function rowBefore(times, t) {
  let low = 0, high = times.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= t) low = middle; else high = middle - 1;
  }
  return low;
}

/** Row and share of the way to the next one. */
function between(times, t) {
  const row = rowBefore(times, t);
  const next = Math.min(row + 1, times.length - 1);
  const span = times[next] - times[row];
  return [row, next, span > 0 ? Math.min(1, Math.max(0, (t - times[row]) / span)) : 0];
}

const blend = (list, [i, j, s]) => list[i] + s * (list[j] - list[i]);
const vectorAt = (list, [i, j, s]) => [0, 1, 2].map((k) => list[3 * i + k] + s * (list[3 * j + k] - list[3 * i + k]));

/** The attitude between two rows: the shorter way, normalised. */
function attitudeAt(list, [i, j, s]) {
  const a = [], b = [];
  for (let k = 0; k < 4; k++) { a.push(list[4 * i + k]); b.push(list[4 * j + k]); }
  const sign = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] < 0 ? -1 : 1;
  return matrix(a.map((x, k) => x * (1 - s) + sign * b[k] * s));
}

/** A number for people: four significant digits. */
function shown(x) {
  if (!Number.isFinite(x)) return '–';
  if (x === 0) return '0';
  const size = Math.abs(x);
  return (size >= 1e-3 && size < 1e6 ? String(Number(x.toPrecision(4))) : x.toExponential(3)).replace('-', '−');
}
