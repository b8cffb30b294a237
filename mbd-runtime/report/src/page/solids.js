// Solids: which of their faces are seen, how light these are, and where their edges run on the canvas.

/** Steps of light; faces of one step are painted at once. */
const STEPS = 12;

class Solid {
  /** The surface as the page holds it: corners, and per part its faces, counter-clockwise seen from outside. */
  constructor({ ball, p, parts }) {
    this.ball = ball;
    this.p = unpack(Float32Array, p);
    this.faces = [];
    const edges = new Map();
    parts.forEach((faces, part) => faces.forEach((corners) => {
      const [a, b, c] = corners.map((k) => Array.from(this.p.subarray(3 * k, 3 * k + 3)));
      const normal = unit(cross(add(b, a, -1), add(c, a, -1)));
      // Behind every edge: the face on its other side.
      const face = { part, corners, normal, off: dot(normal, a), beyond: [], step: -1 };
      corners.forEach((k, i) => {
        const next = corners[(i + 1) % corners.length];
        const other = edges.get(`${next} ${k}`);
        edges.set(`${k} ${next}`, [face, i]);
        if (other) { face.beyond[i] = other[0]; other[0].beyond[other[1]] = face; }
      });
      this.faces.push(face);
    }));
    this.parts = parts.length;
    this.x = new Float64Array(this.p.length / 3);
    this.y = new Float64Array(this.p.length / 3);
  }

  /** Finds its corners on the canvas and the light on its faces, from where it is and the rows of the matrix that turns it. Whether it is in front of the eye. */
  project(camera, place, m, light) {
    const { back, distance } = camera;
    // Everything in the axes of the solid.
    const inside = (a) => [0, 1, 2].map((k) => a[0] * m[0][k] + a[1] * m[1][k] + a[2] * m[2][k]);
    const away = add(place, camera.centre, -1);
    const [r, u, d, l] = [camera.right, camera.above, back, light].map(inside);
    const eye = inside(add([-away[0], -away[1], -away[2]], back, distance));
    const [r0, u0, d0] = [dot(away, camera.right), dot(away, camera.above), distance - dot(away, back)];
    const { p, x, y } = this;
    for (let k = 0, i = 0; i < p.length; k++, i += 3) {
      const depth = d0 - d[0] * p[i] - d[1] * p[i + 1] - d[2] * p[i + 2];
      if (!(depth > 0.01 * distance)) return false;
      const scale = camera.focus / depth;
      x[k] = camera.middle[0] + scale * (r0 + r[0] * p[i] + r[1] * p[i + 1] + r[2] * p[i + 2]);
      y[k] = camera.middle[1] - scale * (u0 + u[0] * p[i] + u[1] * p[i + 1] + u[2] * p[i + 2]);
    }
    for (const face of this.faces) {
      const { normal: n } = face;
      const seen = n[0] * eye[0] + n[1] * eye[1] + n[2] * eye[2] > face.off;
      face.step = seen ? Math.round(STEPS * (0.25 + 0.5 * Math.max(0, n[0] * l[0] + n[1] * l[1] + n[2] * l[2]))) : -1;
    }
    return true;
  }

  /** Paints what was found; `colour` of a step of light. */
  paint(context, colour, ink) {
    const { x, y } = this;
    for (let part = 0; part < this.parts; part++) {
      const steps = new Set();
      for (const face of this.faces) if (face.part === part && face.step >= 0) steps.add(face.step);
      for (const step of steps) {
        context.beginPath();
        for (const face of this.faces) {
          if (face.part !== part || face.step !== step) continue;
          face.corners.forEach((k, i) => (i ? context.lineTo(x[k], y[k]) : context.moveTo(x[k], y[k])));
          context.closePath();
        }
        context.fillStyle = colour(step / STEPS);
        context.fill();
      }
    }
    context.beginPath();
    for (const face of this.faces) {
      if (face.step < 0) continue;
      face.corners.forEach((k, i) => {
        const other = face.beyond[i];
        // An edge stands between parts, or where the face beyond it is not seen.
        if (other && other.step >= 0 && (other.part === face.part || other.part < face.part)) return;
        const next = face.corners[(i + 1) % face.corners.length];
        context.moveTo(x[k], y[k]);
        context.lineTo(x[next], y[next]);
      });
    }
    context.setLineDash([]);
    context.lineWidth = 0.8;
    context.strokeStyle = ink;
    context.stroke();
  }
}
