/** Sizes of robots and paths of the camera, without three.js. */

/** Half width of the smoothing window of the camera path, seconds. */
const CALM = 0.35;

/**
 * Rise of the root within a step that does not lift the camera, as a fraction of a robot's height.
 */
const STEADY = 0.12;

/**
 * Standing height of a robot with all joints at zero, and the height of its root above the floor;
 * metres. Independent of the motion.
 * @param {import('./motions.js').Motion} motion
 * @returns {{height: number, root: number}}
 */
export function standing(motion) {
  const { robot, kinematics } = motion;
  kinematics.place([0, 0, 0], 0, [1, 0, 0, 0], 0, new Float64Array(motion.jointCount), 0);
  const heights = robot.bodies.slice(1).map((_, i) => kinematics.bodyPoses[7 * (i + 1) + 2]);
  for (const { body, points } of robot.soles) {
    for (const point of points) heights.push(kinematics.point(body, point)[2]);
  }
  const low = Math.min(...heights),
    high = Math.max(...heights);
  // Add a margin for the head above the highest body.
  return { height: Math.max(0.1, 1.18 * (high - low)), root: -low };
}

/** Moving average; the window is symmetric everywhere, so that the ends are unchanged. */
function calmed(values, half) {
  const count = values.length;
  const sums = new Float64Array(count + 1);
  for (let i = 0; i < count; ++i) sums[i + 1] = sums[i] + values[i];
  return values.map((_, i) => {
    const reach = Math.min(half, i, count - 1 - i);
    return (sums[i + reach + 1] - sums[i - reach]) / (2 * reach + 1);
  });
}

/**
 * The mean root path of the motions that are still running, without sway, in steps of `frameTime`;
 * smoothed twice.
 * @param {import('./motions.js').Motion[]} motions
 * @returns {{frameTime: number, axes: Float64Array[]}}  x, y, z in metres
 */
export function calmWay(motions) {
  const frameTime = Math.min(...motions.map((motion) => motion.frameTime));
  const longest = Math.max(...motions.map((motion) => motion.duration));
  const count = Math.round(longest / frameTime) + 1;
  const half = Math.max(1, Math.round(CALM / frameTime));
  const axes = [0, 1, 2].map((axis) => {
    const way = new Float64Array(count);
    for (let i = 0; i < count; ++i) {
      const going = motions.filter((motion) => !motion.hasEnded(i * frameTime));
      const running = going.length > 0 ? going : motions;
      for (const motion of running)
        way[i] += motion.position[3 * motion.frameAt(i * frameTime) + axis] / running.length;
    }
    return calmed(calmed(way, half), half);
  });
  return { frameTime, axes };
}

/** Camera position on its path at a time. @returns {number[]} x y z */
export function onWay({ frameTime, axes }, time) {
  const at = Math.min(axes[0].length - 1, Math.max(0, Math.floor(time / frameTime + 1e-6)));
  return axes.map((axis) => axis[at]);
}

/**
 * Vertical offset of the camera for a root height, metres: ignores steps, but follows climbing,
 * crawling and lying.
 * @param {number} root  smoothed height
 * @param {{height: number, root: number}} stand
 */
export function lift(root, stand) {
  const off = root - stand.root;
  return Math.sign(off) * Math.max(0, Math.abs(off) - STEADY * stand.height);
}
