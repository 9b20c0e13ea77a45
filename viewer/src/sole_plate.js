/** The shape of a sole, in numbers alone: what is drawn under a foot that stands. */

/** A little under the sole, so that it is seen beside the foot's own shape, metres. */
const RIM = 0.006;

const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => {
  const length = Math.hypot(...a);
  return a.map((each) => each / length);
};

/** The convex outline of points on a plane, counter-clockwise; only x and y of points are looked at. */
export function outline(points) {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const turn = (o, a, b) => (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
  const half = (list) => {
    const chain = [];
    for (const point of list) {
      while (chain.length > 1 && turn(chain.at(-2), chain.at(-1), point) <= 0) chain.pop();
      chain.push(point);
    }
    return chain.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())];
}

/**
 * The plane that a sole's points are on, whichever of the foot's axes is up: a point of it and three
 * axes of unit length, of which the third points from the ground to the foot's own origin, the ankle.
 * @param {number[][]} points  in the body's frame
 * @returns {{middle: number[], axes: number[][]}|null}  null: the points are on a line
 */
export function solePlane(points) {
  const middle = [0, 1, 2].map((i) => points.reduce((sum, p) => sum + p[i] / points.length, 0));
  // the widest triangle with the first point that the points make
  let normal = [0, 0, 0];
  for (let i = 1; i < points.length; ++i) {
    for (let j = i + 1; j < points.length; ++j) {
      const each = cross(minus(points[i], points[0]), minus(points[j], points[0]));
      if (Math.hypot(...each) > Math.hypot(...normal)) normal = each;
    }
  }
  if (!(Math.hypot(...normal) > 1e-8)) return null;
  normal = unit(normal);
  const towards = -dot(normal, middle);
  // an ankle in the sole's plane: its z axis is up, as in most feet
  if (towards < -1e-6 || (Math.abs(towards) <= 1e-6 && normal[2] < 0)) normal = normal.map((each) => -each);
  // the first axis along the foot's x, or z where that is up
  const ahead = Math.abs(normal[0]) < 0.9 ? [1, 0, 0] : [0, 0, 1];
  const first = unit(minus(ahead, normal.map((each) => each * dot(ahead, normal))));
  return { middle, axes: [first, cross(normal, first), normal] };
}

/**
 * A thin plate along a sole's outline, a little wider than it.
 * @param {number[][]} points  in the body's frame
 * @returns {{vertices: number[], indices: number[]}|null}  null: the points are on a line
 */
export function solePlate(points) {
  const plane = solePlane(points);
  if (!plane) return null;
  const { middle, axes } = plane;
  const flat = points.map((point) => axes.map((axis) => dot(axis, minus(point, middle))));
  let corners = outline(flat);
  if (corners.length < 3) return null;
  const centre = [0, 1].map((i) => corners.reduce((sum, p) => sum + p[i] / corners.length, 0));
  corners = corners.map(([x, y, z]) => {
    const length = Math.hypot(x - centre[0], y - centre[1]) || 1;
    const grow = 1 + (2.5 * RIM) / length;
    return [centre[0] + (x - centre[0]) * grow, centre[1] + (y - centre[1]) * grow, z];
  });
  const vertices = [],
    indices = [],
    count = corners.length;
  const add = (x, y, z) =>
    vertices.push(...[0, 1, 2].map((i) => middle[i] + x * axes[0][i] + y * axes[1][i] + z * axes[2][i]));
  for (const [x, y, z] of corners) {
    add(x, y, z - RIM);
    add(x, y, z + 2 * RIM);
  }
  for (let i = 0; i < count; ++i) {
    const a = 2 * i,
      b = 2 * ((i + 1) % count);
    indices.push(a, b, a + 1, b, b + 1, a + 1);
    if (i > 1) indices.push(0, 2 * i, 2 * (i - 1), 1, 2 * (i - 1) + 1, 2 * i + 1);
  }
  return { vertices, indices };
}
