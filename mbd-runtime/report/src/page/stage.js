// The mechanism at a time: what is where, and what of it is drawn how.

class Stage {
  constructor(data) {
    this.data = data;
    this.times = unpack(Float32Array, data.times);
    const places = (thing) => { thing.p = unpack(Float32Array, thing.p); };
    data.bodies.forEach((body) => { places(body); body.q = unpack(Int16Array, body.q); });
    data.points.forEach(places);
    data.frames.forEach(places);
    data.lines.forEach((line) => {
      line.tension = unpack(Float32Array, line.tension);
      line.slack = unpack(Uint8Array, line.slack);
    });
    data.arrows.forEach((arrow) => { arrow.v = unpack(Float32Array, arrow.v); });
    this.solids = data.solids.map((solid) => new Solid(solid));
    // What lines pull at most, and what springs push at most [N].
    const most = (sign) => data.lines.reduce((most, line) => line.tension.reduce((most, x) => (sign * x > most ? sign * x : most), most), 0);
    [this.pull, this.push] = [most(1), most(-1)];
    this.longest = {};
    for (const arrow of data.arrows) {
      for (let k = 0; k + 2 < arrow.v.length; k += 3) {
        const size = Math.hypot(arrow.v[k], arrow.v[k + 1], arrow.v[k + 2]);
        if (size > (this.longest[arrow.unit] || 0)) this.longest[arrow.unit] = size;
      }
    }
    this.measure();
    // Torques that the forces would make on an arm of nothing are what is left of zero.
    const { N, 'N m': couple } = this.longest;
    if (couple < 1e-9 * N * this.size) delete this.longest['N m'];
    if (N * this.size < 1e-9 * couple) delete this.longest.N;
    data.arrows = data.arrows.filter(({ unit }) => this.longest[unit]);
  }

  /** Where everything is at a time. */
  at(t) {
    const { data } = this;
    const row = between(this.times, t);
    const fixed = (list) => vectorAt(list, list.length > 3 ? row : [0, 0, 0]);
    const bodies = data.bodies.map((body) => ({ p: vectorAt(body.p, row), m: attitudeAt(body.q, row) }));
    const points = data.points.map((point) => vectorAt(point.p, row));
    const frames = data.frames.map((frame) => fixed(frame.p));
    const place = ([kind, index, frame]) => {
      if (kind === 0) return frames[index];
      if (kind === 2) return points[index];
      return add(bodies[index].p, turn(bodies[index].m, data.bodies[index].arms[frame]));
    };
    return { row, bodies, points, frames, place };
  }

  /** The ends of everything as it is. */
  places(now) {
    const places = [...now.points, ...this.data.frames.map((frame, k) => (frame.used ? now.frames[k] : [NaN, 0, 0]))];
    this.data.bodies.forEach((body, k) => {
      const { p, m } = now.bodies[k];
      body.arms.forEach((arm) => places.push(add(p, turn(m, arm))));
      const reach = body.reach.map((x) => Math.abs(x));
      const half = m.map((row) => Math.abs(row[0]) * reach[0] + Math.abs(row[1]) * reach[1] + Math.abs(row[2]) * reach[2]);
      places.push(add(p, half), add(p, half, -1));
    });
    return places.filter(finite);
  }

  /** How large it is, how far it travels, where the ground lies. */
  measure() {
    const [start, end] = [this.times[0], this.times[this.times.length - 1]];
    const instants = Array.from({ length: 41 }, (_, k) => this.at(start + ((end - start) * k) / 40));
    const placed = instants.map((now) => this.places(now)).filter((places) => places.length);
    const seen = placed.map(box);
    const [low, high] = box(seen.length ? seen.flat() : [[0, 0, 0]]);
    const length = ([low, high]) => norm(add(high, low, -1));
    const own = Math.max(1e-9, ...seen.map(length));
    const whole = length([low, high]);
    // What nothing holds and what goes further than its own size is followed; a single thing that is small beside its way is seen on all of it.
    const least = this.data.bodies.length + this.data.points.length > 1 ? 1e-5 : 0.01;
    this.travels = !this.data.frames.some((frame) => frame.used) && whole > 1.2 * own && own > least * whole;
    this.centre = halfway([low, high]);
    this.radius = Math.max((this.travels ? own : whole) / 2, 1e-9);
    // Everything at all these instants, seen from what the eye looks at.
    this.around = placed.flatMap((places, k) => {
      const middle = this.travels ? halfway(seen[k]) : this.centre;
      return places.map((place) => add(place, middle, -1));
    });
    this.size = 2 * this.radius;
    // How large a body is, as most are.
    const sizes = this.data.bodies.map((body) => 2 * Math.max(norm(body.reach), ...body.arms.map(norm))).sort((a, b) => a - b);
    this.grain = sizes[sizes.length >> 1] || this.size;
    // The ground of the world where it is in reach, else below everything.
    const { up } = this.data;
    const lowest = Math.min(dot(low, up), dot(high, up));
    this.floor = lowest >= 0 && lowest < whole ? 0 : lowest;
  }

  /** The middle of everything as it is. */
  middle(now) {
    const places = this.places(now);
    return places.length ? halfway(box(places)) : this.centre;
  }
}

/** The lowest and the highest corner of places. */
function box(places) {
  const low = [...places[0]], high = [...places[0]];
  for (const place of places) {
    for (let k = 0; k < 3; k++) {
      if (place[k] < low[k]) low[k] = place[k];
      if (place[k] > high[k]) high[k] = place[k];
    }
  }
  return [low, high];
}
const halfway = ([low, high]) => add(low, add(high, low, -1), 0.5);
