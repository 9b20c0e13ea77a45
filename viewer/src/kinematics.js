/**
 * Forward kinematics of a robot in double precision. A pose has seven numbers: x y z, then the
 * quaternion w x y z.
 */

const POSE = 7;

/** out = a * b for poses stored in arrays at offsets; out may alias a. */
function compose(a, i, b, j, out, k) {
  const w = a[i + 3],
    x = a[i + 4],
    y = a[i + 5],
    z = a[i + 6];
  const px = b[j],
    py = b[j + 1],
    pz = b[j + 2];
  const bw = b[j + 3],
    bx = b[j + 4],
    by = b[j + 5],
    bz = b[j + 6];
  // p + 2 w (v x p) + 2 v x (v x p)
  const cx = y * pz - z * py,
    cy = z * px - x * pz,
    cz = x * py - y * px;
  out[k] = a[i] + px + 2 * (w * cx + y * cz - z * cy);
  out[k + 1] = a[i + 1] + py + 2 * (w * cy + z * cx - x * cz);
  out[k + 2] = a[i + 2] + pz + 2 * (w * cz + x * cy - y * cx);
  out[k + 3] = w * bw - x * bx - y * by - z * bz;
  out[k + 4] = w * bx + x * bw + y * bz - z * by;
  out[k + 5] = w * by - x * bz + y * bw + z * bx;
  out[k + 6] = w * bz + x * by - y * bx + z * bw;
}

/** The kinematic tree of a robot. */
export class Kinematics {
  /** @param {object} robot  from the header */
  constructor(robot) {
    this.links = robot.links;
    this.bodies = robot.bodies;
    this.linkPoses = new Float64Array(POSE * robot.links.length);
    this.bodyPoses = new Float64Array(POSE * robot.bodies.length);
    this.joint = new Float64Array(POSE);
  }

  /**
   * Computes bodyPoses (world_from_body, by body).
   * @param {Float64Array} position  root x y z at offset `p`
   * @param {Float64Array} rotation  root quaternion w x y z at offset `r`; need not be normalised
   * @param {Float64Array} joints    joint positions at offset `q`
   */
  place(position, p, rotation, r, joints, q) {
    const { links, bodies, linkPoses, bodyPoses, joint } = this;
    const norm = Math.hypot(rotation[r], rotation[r + 1], rotation[r + 2], rotation[r + 3]) || 1;
    for (let i = 0; i < 3; ++i) linkPoses[i] = position[p + i];
    for (let i = 0; i < 4; ++i) linkPoses[3 + i] = rotation[r + i] / norm;
    for (let i = 1; i < links.length; ++i) {
      const link = links[i];
      const value = joints[q + link.joint] - (link.reference ?? 0);
      joint.fill(0);
      joint[3] = 1;
      if (link.slides) {
        joint[2] = value;
      } else {
        joint[3] = Math.cos(0.5 * value);
        joint[6] = Math.sin(0.5 * value);
      }
      compose(linkPoses, POSE * link.parent, link.pose, 0, linkPoses, POSE * i);
      compose(linkPoses, POSE * i, joint, 0, linkPoses, POSE * i);
    }
    for (let i = 0; i < bodies.length; ++i) {
      const { link, pose } = bodies[i];
      if (link >= 0) {
        compose(linkPoses, POSE * link, pose, 0, bodyPoses, POSE * i);
      } else {
        bodyPoses.set(pose, POSE * i);
      }
    }
  }

  /** World position of a point of a body; x y z. */
  point(body, [px, py, pz]) {
    const out = new Float64Array(POSE);
    compose(this.bodyPoses, POSE * body, [px, py, pz, 1, 0, 0, 0], 0, out, 0);
    return [out[0], out[1], out[2]];
  }
}
