// The eye: where it looks from, and where a place in the world lies on the canvas.

const VIEW = Math.tan(Math.PI / 10);
// What is looked at fills this part of the canvas: marks have a size of their own.
const FILLED = 0.9;

class Camera {
  /** `up` is up in the world; `from` the direction it is looked at from, if that matters. */
  constructor(up, from) {
    this.up = unit(up);
    const first = Math.abs(this.up[2]) > 0.9 ? [1, 0, 0] : Math.abs(this.up[1]) > 0.9 ? [0, 0, 1] : [0, 1, 0];
    this.east = unit(add(first, this.up, -dot(first, this.up)));
    this.north = cross(this.up, this.east);
    this.offset = [0, 0, 0];
    this.target = [0, 0, 0];
    this.distance = 1;
    this.look(from || add(add(add([0, 0, 0], this.north, -0.85), this.east, 0.42), this.up, 0.3));
  }

  /** Looks from a direction. */
  look(from) {
    const d = unit(from);
    this.pitch = Math.asin(Math.max(-1, Math.min(1, dot(d, this.up))));
    const flat = Math.hypot(dot(d, this.east), dot(d, this.north));
    this.yaw = flat < 1e-9 ? -Math.PI / 2 : Math.atan2(dot(d, this.north), dot(d, this.east));
  }

  orbit(right, down) {
    this.yaw -= right * 0.008;
    this.pitch = Math.max(-1.5707, Math.min(1.5707, this.pitch + down * 0.008));
  }

  /** Moves what is looked at by pixels. */
  pan(right, down) {
    const metre = this.distance / this.focus;
    this.offset = add(add(this.offset, this.right, -right * metre), this.above, down * metre);
  }

  zoom(factor) {
    this.distance = Math.min(this.far, Math.max(this.far * 1e-7, this.distance * factor));
  }

  /** Stands so that places around what is looked at fill a canvas of this size [px]. */
  fit(places, width, height) {
    this.offset = [0, 0, 0];
    this.aim(width, height);
    this.distance = 1e-9;
    for (const v of places) {
      const wide = Math.max(Math.abs(dot(v, this.right)) / width, Math.abs(dot(v, this.above)) / height);
      this.distance = Math.max(this.distance, dot(v, this.back) + (2 * this.focus * wide) / FILLED);
    }
    this.far = this.distance * 100;
  }

  /** Prepares for a canvas of this size [px]. */
  aim(width, height) {
    const [c, s] = [Math.cos(this.pitch), Math.sin(this.pitch)];
    const [cy, sy] = [Math.cos(this.yaw), Math.sin(this.yaw)];
    this.back = add(add(add([0, 0, 0], this.east, c * cy), this.north, c * sy), this.up, s);
    this.right = add(add([0, 0, 0], this.east, -sy), this.north, cy);
    this.above = cross(this.back, this.right);
    this.middle = [width / 2, height / 2];
    this.focus = Math.min(width, height) / 2 / VIEW;
    this.centre = add(this.target, this.offset);
  }

  /** Depth in front of the eye. */
  depth(place) {
    return this.distance - dot(add(place, this.centre, -1), this.back);
  }

  /** Place on the canvas and depth; null behind the eye. */
  see(place) {
    const v = add(place, this.centre, -1);
    const depth = this.distance - dot(v, this.back);
    if (!(depth > 0.01 * this.distance)) return null;
    const scale = this.focus / depth;
    return [this.middle[0] + scale * dot(v, this.right), this.middle[1] - scale * dot(v, this.above), depth];
  }

  /** The part of a straight line that is in front of the eye. */
  seeLine(a, b) {
    const near = 0.02 * this.distance;
    const [da, db] = [this.depth(a), this.depth(b)];
    if (!(da > near || db > near)) return null;
    if (da < near) a = add(a, add(b, a, -1), (near - da) / (db - da));
    if (db < near) b = add(b, add(a, b, -1), (near - db) / (da - db));
    const ends = [this.see(a), this.see(b)];
    return ends[0] && ends[1] ? ends : null;
  }

  /** Pixels that a metre takes at a depth. */
  scale(depth) {
    return this.focus / depth;
  }
}
