import {
  CapsuleGeometry,
  Color,
  Group,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  Quaternion,
  SphereGeometry,
  Vector3,
} from 'three';
import { SOURCE_CONTACT } from './theme.js';
import { inPhase } from './motions.js';

/** Radii by the bone that starts there, metres for a body 1.75 m tall. */
const RADII = {
  Hips: 0.075,
  Spine: 0.082,
  Spine1: 0.085,
  Spine2: 0.05,
  Neck: 0.045,
  UpLeg: 0.066,
  Leg: 0.05,
  Foot: 0.038,
  Shoulder: 0.045,
  Arm: 0.042,
  ForeArm: 0.034,
};
const AXIS = new Vector3(0, 1, 0);
/** Render order of objects drawn in front of the robot. */
const FRONT = 10;

const plain = (bone) => bone.replace(/^(Left|Right)/, '');

/** The human that a motion was made from, drawn as capsules. */
export class HumanFigure {
  /**
   * @param {import('./motions.js').Motion} motion  with a human
   * @param {object} figure  from the header: colours by side, chains of bones from joint to joint;
   *     bones that a human lacks are skipped
   */
  constructor(motion, figure) {
    this.human = motion.human;
    this.index = new Map(this.human.bones.map((bone, i) => [bone, i]));
    this.group = new Group();
    this.group.name = `human ${motion.index}`;
    const paint = (colour) => new MeshStandardMaterial({ color: colour, roughness: 0.75, transparent: true });
    this.materials = Object.fromEntries(
      Object.entries(figure.colours).map(([side, colour]) => [side, paint(colour)]),
    );
    this.planted = paint(SOURCE_CONTACT);
    this.planted.emissive = new Color(SOURCE_CONTACT);
    this.planted.emissiveIntensity = 0.35;
    this.size = this.human.height / 1.75;
    this.bones = [];
    for (const { side, bones } of figure.chains)
      this.addChain(
        side,
        bones.filter((bone) => this.index.has(bone)),
      );
    if (this.index.has('Head')) this.addHead();
    this.addFeet();
    this.addVeil();
  }

  // Clears the depth buffer without drawing, so that objects drawn later are in front.
  addVeil() {
    const material = new MeshBasicMaterial({
      colorWrite: false,
      depthWrite: false,
      depthTest: false,
      transparent: true,
    });
    this.veil = new Mesh(new SphereGeometry(0.01, 3, 2), material);
    this.veil.renderOrder = FRONT - 1;
    this.veil.frustumCulled = false;
    this.veil.raycast = () => {};
    this.veil.onBeforeRender = (renderer) => renderer.clearDepth();
    this.group.add(this.veil);
  }

  addMesh(geometry, material, name) {
    const mesh = new Mesh(geometry, material);
    mesh.castShadow = mesh.receiveShadow = true;
    mesh.name = name;
    mesh.raycast = () => {};
    this.group.add(mesh);
    return mesh;
  }

  place(bone, frame, out) {
    const at = 3 * (frame * this.human.bones.length + this.index.get(bone));
    const { positions } = this.human;
    return out.set(positions[at], positions[at + 1], positions[at + 2]);
  }

  addChain(side, chain) {
    const from = new Vector3(),
      to = new Vector3();
    for (let i = 0; i + 1 < chain.length; ++i) {
      const length = this.place(chain[i], 0, from).distanceTo(this.place(chain[i + 1], 0, to));
      if (length < 0.01) continue;
      const bone = plain(chain[i]);
      const hip = bone === 'Hips' && side !== 'middle',
        chest = bone === 'Spine2' && side !== 'middle';
      const radius = this.size * (hip || chest ? 0.06 : (RADII[bone] ?? 0.04));
      const geometry = new CapsuleGeometry(radius, Math.max(1e-3, length), 5, 14);
      this.bones.push({
        mesh: this.addMesh(geometry, this.materials[hip || chest ? 'middle' : side], chain[i]),
        from: chain[i],
        to: chain[i + 1],
        length,
      });
    }
  }

  addHead() {
    this.head = this.addMesh(new SphereGeometry(0.105 * this.size, 22, 16), this.materials.middle, 'head');
  }

  /** Contact marks: left heel, left toe, right heel, right toe. */
  addFeet() {
    this.feet = ['LeftFoot', 'LeftToe', 'RightFoot', 'RightToe'].map((bone, i) => {
      if (!this.index.has(bone)) return null;
      const mesh = this.addMesh(
        new SphereGeometry(0.055 * this.size, 16, 12),
        this.planted,
        `contact ${bone}`,
      );
      mesh.castShadow = false;
      return { mesh, bone, phases: this.human.contacts[i] ?? [] };
    });
  }

  /** Draws the human semi-transparent in front of the robot. */
  setOver(over) {
    this.veil.visible = over;
    for (const mesh of this.group.children) if (mesh !== this.veil) mesh.renderOrder = over ? FRONT : 0;
    for (const material of [...Object.values(this.materials), this.planted])
      material.opacity = over ? 0.62 : 1;
  }

  update(frame, showContacts) {
    const last = this.human.frames - 1;
    this.group.userData.ended = frame > last;
    const shown = Math.min(frame, last);
    const from = new Vector3(),
      to = new Vector3(),
      turn = new Quaternion();
    for (const bone of this.bones) {
      this.place(bone.from, shown, from);
      this.place(bone.to, shown, to);
      bone.mesh.position.copy(from).add(to).multiplyScalar(0.5);
      to.sub(from);
      const length = to.length();
      bone.mesh.quaternion.copy(turn.setFromUnitVectors(AXIS, to.normalize()));
      bone.mesh.scale.set(1, length / bone.length, 1);
    }
    if (this.head) this.placeHead(shown, from, to);
    for (const foot of this.feet) {
      if (!foot) continue;
      this.place(foot.bone, shown, foot.mesh.position);
      foot.mesh.visible = showContacts && frame <= last && inPhase(foot.phases, frame);
    }
  }

  placeHead(frame, head, neck) {
    this.place('Head', frame, head);
    this.head.position.copy(head);
    if (!this.index.has('Neck')) return;
    this.place('Neck', frame, neck);
    this.head.position.addScaledVector(head.sub(neck).normalize(), 0.09 * this.size);
  }
}
