import { Kinematics } from './kinematics.js';

// Decodes bone positions. Bones are stored relative to the previous bone of their chain, which
// precedes them.
function bonePlaces(human, track) {
  if (!human.placed) {
    const count = human.bones.length;
    for (let frame = 0; frame < human.frames; ++frame) {
      human.parents.forEach((parent, i) => {
        if (parent < 0) return;
        for (let axis = 0; axis < 3; ++axis)
          track[3 * (frame * count + i) + axis] += track[3 * (frame * count + parent) + axis];
      });
    }
    // Motions with the same source share the result.
    human.placed = track;
  }
  return human.placed;
}

/** A motion with unpacked tracks; frames are its own, times are in seconds. */
export class Motion {
  constructor(data, index, page, tracks) {
    this.data = data;
    this.index = index;
    this.label = data.label;
    this.robot = page.robots[data.robot];
    this.frames = data.frames;
    this.frameTime = data.rate[1] / data.rate[0];
    this.fps = data.rate[0] / data.rate[1];
    this.position = tracks[data.tracks.position];
    this.rotation = tracks[data.tracks.rotation];
    this.joints = tracks[data.tracks.joints];
    this.jointCount = this.robot.joints.length;
    this.report = data.report ?? null;
    this.kinematics = new Kinematics(this.robot);
    this.meshes = (this.robot.meshes ?? []).map(({ body, vertices, triangles }) => ({
      body,
      vertices: tracks[vertices],
      triangles: tracks[triangles],
    }));
    /**
     * Tracking errors of bodies in cm and degrees, every errorStride-th frame, up to the end of the
     * source.
     */
    this.errorStride = data.error_stride ?? 1;
    this.errors = new Map(
      (data.errors ?? []).map(({ body, bone, position, rotation }) => [
        body,
        { bone, position: tracks[position] ?? null, rotation: tracks[rotation] ?? null },
      ]),
    );
    /** Contacts with bodies of the scene: part of the human, surface, phases. */
    this.touches = data.touches ?? [];
    this.human = null;
    if (data.human !== undefined) {
      const human = page.humans[data.human];
      this.human = {
        ...human,
        positions: bonePlaces(human, tracks[human.track]),
        placement: data.placement,
        contacts: data.source_contacts ?? [[], [], [], []],
      };
    }
  }

  /** Time of the last frame, seconds. */
  get duration() {
    return (this.frames - 1) * this.frameTime;
  }

  /** The frame at a time; not clamped to the end of the motion, because its human may be longer. */
  step(time) {
    return Math.max(0, Math.floor(time * this.fps + 1e-6));
  }

  /** The frame shown at a time: the last one that has started. */
  frameAt(time) {
    return Math.min(this.frames - 1, this.step(time));
  }

  /** Whether the last frame has been shown for its full duration. */
  hasEnded(time) {
    return this.step(time) >= this.frames;
  }

  /** World poses of all bodies in a frame; seven numbers each. */
  bodyPoses(frame) {
    this.kinematics.place(
      this.position,
      3 * frame,
      this.rotation,
      4 * frame,
      this.joints,
      this.jointCount * frame,
    );
    return this.kinematics.bodyPoses;
  }

  /** Index of a frame in a body's errors. */
  errorAt(frame) {
    return Math.floor(frame / this.errorStride);
  }

  jointValue(joint, frame) {
    return this.joints[this.jointCount * frame + joint];
  }

  /** Speed from this frame to the next, as in reports; rad/s or m/s. */
  jointSpeed(joint, frame) {
    const at = Math.min(frame, this.frames - 2);
    if (at < 0) return 0;
    return (this.jointValue(joint, at + 1) - this.jointValue(joint, at)) * this.fps;
  }

  /** Mean heading of the robot: the sum of its root's x axis on the ground. */
  heading() {
    let x = 0,
      y = 0;
    for (let frame = 0; frame < this.frames; ++frame) {
      const [w, qx, qy, qz] = this.rotation.subarray(4 * frame, 4 * frame + 4);
      x += 1 - 2 * (qy * qy + qz * qz);
      y += 2 * (qx * qy + w * qz);
    }
    return Math.hypot(x, y) > 1e-6 ? Math.atan2(y, x) : 0;
  }
}

/** Whether a frame is in one of the phases [begin, end), which are sorted by time. */
export function inPhase(phases, frame) {
  for (const [begin, end] of phases) {
    if (frame < begin) return false;
    if (frame < end) return true;
  }
  return false;
}
