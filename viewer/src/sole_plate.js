/** Geometry of the plate drawn under a stance foot, without three.js. */

/** Margin around the sole, so that the plate is visible next to the foot's shape, metres. */
const RIM = 0.006;

const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => {
  const length = Math.hypot(...a);
  return a.map((each) => each / length);
};

/** Convex hull of points in a plane, counter-clockwise; uses only x and y. */
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
 * The plane of a sole's points, for any orientation of the foot's axes: a point on it and three
 * unit axes. The third axis points from the ground to the foot's origin (the ankle).
 * @param {number[][]} points  in body coordinates
 * @returns {{middle: number[], axes: number[][]}|null}  null: the points are collinear
 */
export function solePlane(points) {
  const middle = [0, 1, 2].map((i) => points.reduce((sum, p) => sum + p[i] / points.length, 0));
  // Find the largest triangle that contains the first point.
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
  // If the ankle is in the sole's plane, the foot's z axis is assumed to point up, as in most feet.
  if (towards < -1e-6 || (Math.abs(towards) <= 1e-6 && normal[2] < 0)) normal = normal.map((each) => -each);
  // The first axis follows the foot's x axis, or z if x is vertical.
  const ahead = Math.abs(normal[0]) < 0.9 ? [1, 0, 0] : [0, 0, 1];
  const first = unit(minus(ahead, normal.map((each) => each * dot(ahead, normal))));
  return { middle, axes: [first, cross(normal, first), normal] };
}

/**
 * A thin plate along a sole's outline, slightly larger than it.
 * @param {number[][]} points  in body coordinates
 * @returns {{vertices: number[], indices: number[]}|null}  null: the points are collinear
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
