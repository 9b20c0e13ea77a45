/** How large robots are and where the camera goes with them: numbers alone, without three.js. */

/** Seconds either side over which the camera's way is calmed. */
const CALM = 0.35;

/** Rises of the root that are a step's, and no reason to lift the camera: share of a robot's height. */
const STEADY = 0.12;

/**
 * How high a robot stands with all joints at zero, and its root above the floor then; metres. Of the
 * robot, not of what it does in a motion.
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
  // a head above the highest body
  return { height: Math.max(0.1, 1.18 * (high - low)), root: -low };
}

/** Means of so many numbers to both sides; as far to both, so that the ends stay where they are. */
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
 * Where the roots are on the whole, without their sway: the mean of the motions that still run, by
 * steps of `frameTime`; a mean of means.
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

/** Where on its way the camera is at a time. @returns {number[]} x y z */
export function onWay({ frameTime, axes }, time) {
  const at = Math.min(axes[0].length - 1, Math.max(0, Math.floor(time / frameTime + 1e-6)));
  return axes.map((axis) => axis[at]);
}

/**
 * How far up or down the camera goes along with a root, metres: not with every step, but with who
 * climbs, crawls or lies.
 * @param {number} root  its calmed height  @param {{height: number, root: number}} stand
 */
export function lift(root, stand) {
  const off = root - stand.root;
  return Math.sign(off) * Math.max(0, Math.abs(off) - STEADY * stand.height);
}
