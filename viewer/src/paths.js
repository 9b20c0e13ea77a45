import { BufferGeometry, Float32BufferAttribute, Group, Line, LineBasicMaterial } from 'three';

/** Height above the floor, metres. */
const LIFT = 0.004;

/** Paths of root and feet over a whole motion; the root's path is drawn on the floor. */
export class Paths {
  /** @param {import('./motions.js').Motion} motion */
  constructor(motion, colour) {
    this.group = new Group();
    this.group.name = `paths ${motion.index}`;
    const feet = motion.robot.soles.map((sole) => sole.body);
    const lines = [[], ...feet.map(() => [])];
    for (let frame = 0; frame < motion.frames; ++frame) {
      const poses = motion.bodyPoses(frame);
      const root = 7 * motion.robot.root;
      lines[0].push(poses[root], poses[root + 1], LIFT);
      feet.forEach((body, i) => {
        const sole = motion.robot.soles[i];
        const middle = [0, 1, 2].map((axis) =>
          sole.points.reduce((sum, p) => sum + p[axis] / sole.points.length, 0),
        );
        lines[i + 1].push(...motion.kinematics.point(body, middle));
      });
    }
    lines.forEach((points, i) => {
      if (points.length < 6) return;
      const geometry = new BufferGeometry();
      geometry.setAttribute('position', new Float32BufferAttribute(points, 3));
      const material = new LineBasicMaterial({
        color: colour,
        transparent: true,
        opacity: i === 0 ? 0.95 : 0.5,
      });
      this.group.add(new Line(geometry, material));
    });
    for (const line of this.group.children) line.raycast = () => {};
  }
}
