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
    const most = (list) => list.reduce((most, x) => (Math.abs(x) > most ? Math.abs(x) : most), 0);
    this.pull = Math.max(...data.lines.map((line) => most(line.tension)), 0);
    this.longest = {};
    for (const arrow of data.arrows) {
      for (let k = 0; k + 2 < arrow.v.length; k += 3) {
        const size = Math.hypot(arrow.v[k], arrow.v[k + 1], arrow.v[k + 2]);
        if (size > (this.longest[arrow.unit] || 0)) this.longest[arrow.unit] = size;
      }
    }
    this.measure();
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

  /** All places at a time, for bounds. */
  places(t) {
    const now = this.at(t);
    const arms = this.data.bodies.flatMap((body, k) => body.arms.map((arm) => add(now.bodies[k].p, turn(now.bodies[k].m, arm))));
    const held = this.data.frames.map((frame, k) => (frame.used ? now.frames[k] : null)).filter(Boolean);
    return [...arms, ...now.points, ...held].filter(finite);
  }

  /** How large it is, how far it travels, where the ground lies. */
  measure() {
    const bounds = (places) => places.reduce(([low, high], p) => [low.map((x, k) => Math.min(x, p[k])), high.map((x, k) => Math.max(x, p[k]))], [[1e300, 1e300, 1e300], [-1e300, -1e300, -1e300]]);
    const [start, end] = [this.times[0], this.times[this.times.length - 1]];
    const all = [];
    let own = 0;
    for (let k = 0; k <= 40; k++) {
      const places = this.places(start + ((end - start) * k) / 40);
      if (!places.length) continue;
      const [low, high] = bounds(places);
      own = Math.max(own, norm(add(high, low, -1)));
      all.push(low, high);
    }
    if (!all.length) all.push([0, 0, 0]);
    // A lone body without frames is as large as its ellipsoid or its shapes.
    const body = Math.max(0, ...this.data.bodies.map((body) => body.size));
    const [low, high] = bounds(all);
    const whole = norm(add(high, low, -1));
    this.own = Math.max(own + body, 1e-9);
    this.travels = !this.data.frames.some((frame) => frame.used) && whole > 1.2 * own + body;
    this.centre = add(low, add(high, low, -1), 0.5);
    this.radius = Math.max((this.travels ? own : whole) / 2 + body / 2, 1e-9);
    this.size = 2 * this.radius;
    const up = this.data.up;
    const heights = all.map((p) => dot(p, up));
    // The ground of the world where it is in reach, else below everything.
    const least = Math.min(...heights);
    this.floor = least >= 0 && least < whole ? 0 : least - 0.5 * body;
  }

  /** The middle of everything that moves at a time. */
  middle(t) {
    const now = this.at(t);
    const all = [...now.bodies.map((body) => body.p), ...now.points].filter(finite);
    return all.length ? all.reduce((sum, p) => add(sum, p, 1 / all.length), [0, 0, 0]) : this.centre;
  }
}
