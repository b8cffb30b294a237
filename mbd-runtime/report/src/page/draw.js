// Draws the stage on a canvas: everything is sorted by depth, the farthest first.

class Painter {
  constructor(canvas, stage, camera) {
    Object.assign(this, { canvas, stage, camera });
    this.context = canvas.getContext('2d');
    this.show = { forces: false, axes: stage.data.bodies.length <= 100, names: false, trails: true, ground: true };
    this.restyle();
  }

  /** Reads the colours of the page. */
  restyle() {
    const style = getComputedStyle(document.documentElement);
    const colour = (name) => style.getPropertyValue(name).trim();
    this.ink = colour('--ink');
    this.soft = colour('--soft');
    this.faint = colour('--line');
    this.ground = colour('--ground');
    this.accent = colour('--accent');
    this.dark = matchMedia('(prefers-color-scheme: dark)').matches;
  }

  /** A colour of a body, by its number. */
  hue(index, light, alpha = 1) {
    const hue = (205 + 137.5 * index) % 360;
    const base = this.dark ? 30 : 52;
    return `hsla(${hue.toFixed(0)},45%,${(base + 30 * light).toFixed(0)}%,${alpha})`;
  }

  draw(t, follow) {
    const { canvas, context, camera, stage } = this;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const ratio = window.devicePixelRatio || 1;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    context.lineCap = context.lineJoin = 'round';
    const now = stage.at(t);
    camera.target = follow(now) || camera.target;
    camera.aim(width, height);
    // From above the shoulder.
    this.light = unit(add(add(camera.back, camera.up, 0.8), camera.right, -0.4));
    this.items = [];
    this.hot = [];
    if (this.show.ground) this.drawGround();
    if (this.show.trails) this.drawTrails(t);
    stage.data.bodies.forEach((body, k) => this.addBody(body, now.bodies[k], k));
    this.addLines(now);
    this.addJoints(now);
    this.addPoints(now);
    if (this.show.forces) this.addArrows(now);
    this.items.sort((a, b) => b.depth - a.depth);
    for (const item of this.items) item.paint();
    if (this.show.names) this.drawNames();
  }

  /** Remembers what to paint at a depth. */
  add(depth, paint) {
    this.items.push({ depth, paint });
  }

  /** Remembers where a name may be asked for; `text` is a text, or makes one. */
  name(place, text) {
    this.hot.push({ place, text });
  }

  /** The names with their places on the canvas. */
  *names() {
    for (const { place, text } of this.hot) {
      const seen = finite(place) && this.camera.see(place);
      if (seen) yield { x: seen[0], y: seen[1], text: typeof text === 'string' ? text : text() };
    }
  }

  stroke(places, style, width, dash = []) {
    const { context } = this;
    context.beginPath();
    places.forEach(([x, y], k) => (k ? context.lineTo(x, y) : context.moveTo(x, y)));
    context.setLineDash(dash);
    context.lineWidth = width;
    context.strokeStyle = style;
    context.stroke();
  }

  /** How large marks are at a depth, as a share: where bodies are small, so are the marks between them. */
  mark(depth) {
    return Math.min(1, 0.04 * this.stage.grain * this.camera.scale(depth));
  }

  dot(place, radius, fill, stroke) {
    const seen = finite(place) && this.camera.see(place);
    if (!seen) return;
    const [x, y, depth] = seen;
    const r = radius * this.mark(depth);
    this.add(depth * 0.999, () => {
      const { context } = this;
      if (r < 1.5) {
        context.fillStyle = stroke || fill;
        context.fillRect(x - r, y - r, 2 * r, 2 * r);
        return;
      }
      context.beginPath();
      context.arc(x, y, r, 0, 2 * Math.PI);
      context.setLineDash([]);
      context.fillStyle = fill;
      context.fill();
      if (stroke) { context.strokeStyle = stroke; context.lineWidth = 1.3; context.stroke(); }
    });
  }

  segment(a, b, style, width, dash) {
    if (!finite(a) || !finite(b)) return;
    const ends = this.camera.seeLine(a, b);
    if (!ends) return;
    // Dashes cost more than they say where there is no room for three of them.
    const room = dash && Math.hypot(ends[0][0] - ends[1][0], ends[0][1] - ends[1][1]) > 3 * (dash[0] + dash[1]);
    this.add((ends[0][2] + ends[1][2]) / 2, () => this.stroke(ends, style, width, room ? dash : []));
  }

  /** A grid on the ground, its squares a round number of metres. */
  drawGround() {
    const { camera, stage } = this;
    const reach = Math.max(stage.radius * 1.6, 1e-9);
    const power = 10 ** Math.floor(Math.log10(reach / 3));
    const step = [1, 2, 5, 10].map((k) => k * power).find((k) => k >= reach / 6);
    this.square = step;
    const origin = add(camera.target, camera.up, stage.floor - dot(camera.target, camera.up));
    const round = (axis) => Math.round(dot(origin, axis) / step) * step - dot(origin, axis);
    const centre = add(add(origin, camera.east, round(camera.east)), camera.north, round(camera.north));
    const count = Math.ceil(reach / step);
    for (let k = -count; k <= count; k++) {
      for (const [along, over] of [[camera.east, camera.north], [camera.north, camera.east]]) {
        const middle = add(centre, over, k * step);
        const ends = camera.seeLine(add(middle, along, -count * step), add(middle, along, count * step));
        if (ends) this.stroke(ends, this.faint, 1);
      }
    }
  }

  /** Where the centres of mass have been. */
  drawTrails(t) {
    const { stage } = this;
    const moving = [...stage.data.bodies, ...stage.data.points.filter((point) => !point.node)];
    if (moving.length > 12) return;
    const last = rowBefore(stage.times, t);
    const step = Math.max(1, Math.ceil(last / 400));
    moving.forEach((thing, index) => {
      const path = [];
      for (let row = 0; row <= last; row += step) {
        const place = vectorAt(thing.p, [row, row, 0]);
        const seen = finite(place) && this.camera.see(place);
        if (seen) path.push(seen);
      }
      this.stroke(path, this.hue(index, 0.3, 0.7), 1.2);
    });
  }

  addBody(body, now, index) {
    if (!finite(now.p)) return;
    const { camera } = this;
    if (!body.shapes.length) this.addEllipsoid(body, now, index);
    for (const shape of body.shapes) this.addShape(shape, now, index);
    for (const k of body.rods) this.segment(now.p, add(now.p, turn(now.m, body.arms[k])), this.ink, 2.2);
    if (this.show.axes) {
      const length = Math.min(0.06 * this.stage.size, 0.6 * this.stage.grain);
      const colours = ['#d0342c', '#2c9a3f', '#2f6fd0'];
      [0, 1, 2].forEach((k) => this.segment(now.p, add(now.p, now.m.map((row) => row[k]), length), colours[k], 1.4));
    }
    if (!body.shapes.length) this.dot(now.p, 3, this.ink);
    this.name(now.p, body.name);
    body.arms.forEach((arm, k) => { if (body.ends[k] !== 'com') this.name(add(now.p, turn(now.m, arm)), () => `${body.name}.${body.ends[k]}`); });
  }

  /** The homogeneous ellipsoid with the same mass and inertia: its outline is an ellipse. */
  addEllipsoid(body, now, index) {
    const seen = this.camera.see(now.p);
    if (!body.ellipsoid || !seen) return;
    const axes = body.ellipsoid.map((axis) => turn(now.m, axis));
    const { right, above } = this.camera;
    const across = axes.map((axis) => [dot(axis, right), dot(axis, above)]);
    const sum = (i, j) => across.reduce((all, axis) => all + axis[i] * axis[j], 0);
    const [xx, xy, yy] = [sum(0, 0), sum(0, 1), sum(1, 1)];
    const mean = (xx + yy) / 2, gap = Math.hypot((xx - yy) / 2, xy);
    const angle = 0.5 * Math.atan2(2 * xy, xx - yy);
    const scale = this.camera.scale(seen[2]);
    const radii = [Math.sqrt(Math.max(0, mean + gap)) * scale, Math.sqrt(Math.max(0, mean - gap)) * scale];
    this.add(seen[2] * 1.001, () => {
      const { context } = this;
      context.beginPath();
      context.ellipse(seen[0], seen[1], radii[0], radii[1], -angle, 0, 2 * Math.PI);
      context.setLineDash([]);
      context.fillStyle = this.hue(index, 0.6, 0.45);
      context.fill();
      context.strokeStyle = this.hue(index, 0, 0.9);
      context.lineWidth = 1;
      context.stroke();
    });
  }

  /** One shape of a body: what is a ball by its outline, others by their faces. */
  addShape(shape, now, index) {
    const { camera, context } = this;
    const solid = this.stage.solids[shape.solid];
    const m = product(now.m, shape.turn);
    const middle = add(now.p, turn(now.m, shape.at));
    if (!solid.ball) {
      this.add(camera.depth(middle), () => {
        if (solid.project(camera, middle, m, this.light)) solid.paint(context, (light) => this.hue(index, light), this.hue(index, -0.5));
      });
      return;
    }
    const [radius, length] = solid.ball;
    const ends = [-0.5, 0.5].map((s) => camera.see(add(middle, m.map((row) => row[2]), s * length)));
    if (!ends[0] || !ends[1]) return;
    const depth = (ends[0][2] + ends[1][2]) / 2;
    const paint = (grow, style) => {
      context.lineWidth = 2 * (radius * camera.scale(depth) + grow);
      context.setLineDash([]);
      context.strokeStyle = style;
      context.beginPath();
      context.moveTo(ends[0][0], ends[0][1]);
      context.lineTo(ends[1][0] + 0.01, ends[1][1]);
      context.stroke();
    };
    this.add(depth, () => { paint(0.4, this.hue(index, -0.5)); paint(-0.4, this.hue(index, 0.5)); });
  }

  /** Lines: red where they pull most, violet where they push, dashed where they are slack. */
  addLines(now) {
    const { data, pull, push } = this.stage;
    const most = Math.max(pull, push) || 1;
    for (const line of data.lines) {
      const [a, b] = [now.place(line.a), now.place(line.b)];
      const tension = blend(line.tension, now.row);
      const slack = line.slack[now.row[0]] === 1;
      this.segment(a, b, slack ? this.soft : tensionColour(tension / most, this.dark), slack ? 1.2 : 2, slack ? [3, 4] : []);
      this.name(add(a, add(b, a, -1), 0.5), () => `${line.name}: ${slack ? 'slack' : `${shown(tension)} N`}`);
    }
  }

  addJoints(now) {
    const { data, size, grain } = this.stage;
    const reach = Math.min(0.05 * size, 0.4 * grain);
    for (const joint of data.joints) {
      const [a, b] = [now.place(joint.a), now.place(joint.b)];
      const apart = norm(add(a, b, -1)) > 1e-6 * size;
      if (apart) this.segment(a, b, this.soft, 1.2, [2, 3]);
      for (const [axis, body, place] of joint.axes) {
        const direction = body < 0 ? axis : turn(now.bodies[body].m, axis);
        const origin = place ? b : a;
        this.segment(add(origin, direction, -reach), add(origin, direction, reach), this.ink, 1, [6, 2, 1, 2]);
      }
      // Ends that meet have one mark.
      const held = [joint.a, joint.b].some((end) => end[0] === 0);
      for (const [end, place] of [[joint.a, a], [joint.b, b]]) {
        if (end[0] === 0) this.addHeld(place); else if (apart || (!held && place === b)) this.dot(place, 3.6, this.ground, this.ink);
      }
      this.name(b, () => `${joint.name} (${joint.kind})`);
    }
    for (const line of data.lines) {
      for (const end of [line.a, line.b]) if (end[0] === 0) this.addHeld(now.place(end));
    }
  }

  /** What the world holds stands on a foot. */
  addHeld(place) {
    const seen = finite(place) && this.camera.see(place);
    if (!seen) return;
    const s = this.mark(seen[2]);
    this.add(seen[2], () => {
      const [x, y] = seen, { context } = this;
      context.beginPath();
      context.moveTo(x, y); context.lineTo(x - 7 * s, y + 11 * s); context.lineTo(x + 7 * s, y + 11 * s); context.closePath();
      context.setLineDash([]);
      context.fillStyle = this.faint; context.fill();
      context.strokeStyle = this.ink; context.lineWidth = Math.min(1.2, 2 * s); context.stroke();
    });
    this.dot(place, 3.2, this.ground, this.ink);
  }

  addPoints(now) {
    this.stage.data.points.forEach((point, k) => {
      const place = now.points[k];
      if (!finite(place)) return;
      if (point.node) this.dot(place, 3.2, this.ground, this.ink); else this.dot(place, 4.5, this.hue(k + 3, 0.1), this.ink);
      this.name(place, point.name);
    });
  }

  /** Forces and torques: the longest of the run is a quarter of the mechanism. */
  addArrows(now) {
    const { data, longest, size } = this.stage;
    for (const arrow of data.arrows) {
      const value = vectorAt(arrow.v, now.row);
      const [from, force] = [now.place(arrow.at), norm(value)];
      if (!finite(from) || !(force > 0.01 * longest[arrow.unit])) continue;
      const to = add(from, value, (0.25 * size) / longest[arrow.unit]);
      const ends = this.camera.seeLine(from, to);
      if (!ends) continue;
      const style = arrow.unit === 'N' ? this.accent : '#8e44ad';
      this.add(Math.min(ends[0][2], ends[1][2]) * 0.99, () => {
        const [[x0, y0], [x1, y1]] = ends;
        const angle = Math.atan2(y1 - y0, x1 - x0);
        const wing = (turned) => [x1 - 8 * Math.cos(angle + turned), y1 - 8 * Math.sin(angle + turned)];
        this.stroke([[x0, y0], [x1, y1]], style, 2);
        this.stroke([wing(0.4), [x1, y1], wing(-0.4)], style, 2);
        // A couple has two heads.
        if (arrow.unit !== 'N') this.stroke([wing(0.4), [x1, y1], wing(-0.4)].map(([x, y]) => [x - 5 * Math.cos(angle), y - 5 * Math.sin(angle)]), style, 2);
      });
      this.name(to, () => `${arrow.name}: ${shown(force)} ${arrow.unit}`);
    }
  }

  drawNames() {
    const { context } = this;
    context.font = '11px Helvetica,Arial,sans-serif';
    context.textAlign = 'left';
    const taken = [];
    for (const { x, y, text } of this.names()) {
      if (taken.some(([a, b]) => Math.abs(a - x) < 60 && Math.abs(b - y) < 12)) continue;
      taken.push([x, y]);
      context.lineWidth = 3;
      context.setLineDash([]);
      context.strokeStyle = this.ground;
      context.strokeText(text, x + 7, y - 5);
      context.fillStyle = this.ink;
      context.fillText(text, x + 7, y - 5);
    }
  }
}

/** From grey over blue and green to red where it pulls, to violet where it pushes: -1 … 1. */
function tensionColour(share, dark) {
  const s = Math.sqrt(Math.min(1, Math.abs(share)));
  const hue = 210 + (share < 0 ? 90 : -205) * s;
  return `hsl(${hue.toFixed(0)},${(30 + 60 * s).toFixed(0)}%,${dark ? 62 : 45}%)`;
}
