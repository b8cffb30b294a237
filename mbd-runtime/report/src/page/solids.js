// Shapes of bodies as faces, in the axes of the shape: z is the axis of what is round.

const RIM = 20;
const ring = (radius, z) => Array.from({ length: RIM }, (_, k) => {
  const angle = (2 * Math.PI * k) / RIM;
  return [radius * Math.cos(angle), radius * Math.sin(angle), z];
});

/** The faces between two rings. */
const wall = (low, high) => low.map((place, k) => [place, low[(k + 1) % RIM], high[(k + 1) % RIM], high[k]]);

/** Faces by keyword; a face's corners turn counter-clockwise seen from outside. Sizes [m]. */
const FACES = {
  box([a, b, c]) {
    const corner = (i, j, k) => [i * a / 2, j * b / 2, k * c / 2];
    const faces = [];
    for (const s of [1, -1]) {
      faces.push([[s, -s, -1], [s, s, -1], [s, s, 1], [s, -s, 1]]);
      faces.push([[s, s, -1], [-s, s, -1], [-s, s, 1], [s, s, 1]]);
      faces.push([[-1, -s, s], [1, -s, s], [1, s, s], [-1, s, s]]);
    }
    return faces.map((face) => face.map(([i, j, k]) => corner(i, j, k)));
  },
  cylinder([radius, length]) {
    const [low, high] = [ring(radius, -length / 2), ring(radius, length / 2)];
    return [...wall(low, high), high, [...low].reverse()];
  },
  tube([outer, inner, length]) {
    const [low, high] = [ring(outer, -length / 2), ring(outer, length / 2)];
    const [inLow, inHigh] = [ring(inner, -length / 2), ring(inner, length / 2)];
    return [...wall(low, high), ...wall(inHigh, inLow), ...wall(high, inHigh), ...wall(inLow, low)];
  },
};
