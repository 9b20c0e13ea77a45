import {
  BufferGeometry,
  Color,
  Float32BufferAttribute,
  Group,
  Mesh,
  MeshStandardMaterial,
  SphereGeometry,
} from 'three';
import { mergeGeometries } from 'three/examples/jsm/utils/BufferGeometryUtils.js';
import { meshGeometry, shapeGeometry } from './shapes.js';
import { solePlate } from './sole_plate.js';
import { PICKED, ROBOT_CONTACT } from './theme.js';

/** A thin plate along a sole's outline, in body coordinates. */
function soleGeometry(points) {
  const plate = solePlate(points);
  if (!plate) return new SphereGeometry(0.02, 12, 8).translate(...points[0]);
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(plate.vertices, 3));
  geometry.setIndex(plate.indices);
  const flat = geometry.toNonIndexed();
  flat.computeVertexNormals();
  return flat;
}

/** A robot in the scene: one object per body, placed in the motion's world. */
export class RobotFigure {
  /** @param {import('./motions.js').Motion} motion  @param {number} colour */
  constructor(motion, colour) {
    this.motion = motion;
    this.group = new Group();
    this.group.name = `robot ${motion.index}`;
    this.material = new MeshStandardMaterial({ color: colour, roughness: 0.62, metalness: 0.08 });
    this.darker = this.material.clone();
    this.darker.color.multiplyScalar(0.8);
    this.pickedMaterial = new MeshStandardMaterial({ color: PICKED, roughness: 0.6 });
    this.bodies = motion.robot.bodies.map((body, index) => {
      const object = new Group();
      object.name = body.name;
      object.userData = { motion: motion.index, body: index };
      this.group.add(object);
      return object;
    });
    this.meshes = new Map();
    this.addShapes();
    this.covers = this.addMeshes();
    this.addSoles();
  }

  addShapes() {
    const byBody = new Map();
    for (const shape of this.motion.robot.shapes) {
      if (!byBody.has(shape.body)) byBody.set(shape.body, []);
      byBody.get(shape.body).push(shapeGeometry(shape));
    }
    for (const [body, geometries] of byBody) this.addMesh(body, mergeGeometries(geometries));
  }

  addMesh(body, geometry) {
    // Adjacent bodies of a chain have different shades.
    const material = this.depth(body) % 2 === 0 ? this.material : this.darker;
    const mesh = new Mesh(geometry, material);
    mesh.castShadow = mesh.receiveShadow = true;
    mesh.userData = { ...this.bodies[body].userData, material };
    this.bodies[body].add(mesh);
    this.meshes.set(body, mesh);
  }

  /**
   * Adds the manufacturer's meshes, which cover the bodies' collision shapes.
   * @returns {Map<number, Mesh>}
   */
  addMeshes() {
    const covers = new Map();
    for (const { body, vertices, triangles } of this.motion.meshes) {
      const geometry = meshGeometry(vertices, triangles);
      const mesh = new Mesh(geometry, this.depth(body) % 2 === 0 ? this.material : this.darker);
      mesh.castShadow = mesh.receiveShadow = true;
      mesh.userData = { ...this.bodies[body].userData, material: mesh.material };
      this.bodies[body].add(mesh);
      covers.set(body, mesh);
    }
    for (const body of covers.keys()) if (this.meshes.has(body)) this.meshes.get(body).visible = false;
    return covers;
  }

  /** Shows meshes or, in their place, collision shapes. */
  setMeshesVisible(visible) {
    for (const [body, mesh] of this.covers) {
      mesh.visible = visible;
      if (this.meshes.has(body)) this.meshes.get(body).visible = !visible;
    }
  }

  depth(body) {
    const { bodies } = this.motion.robot;
    let depth = 0;
    for (let at = body; at > 0; at = bodies[at].parent) depth += this.meshes.has(at) ? 1 : 0;
    return depth;
  }

  addSoles() {
    const material = new MeshStandardMaterial({
      color: ROBOT_CONTACT,
      roughness: 0.5,
      emissive: new Color(ROBOT_CONTACT),
      emissiveIntensity: 0.35,
    });
    this.soles = [];
    for (const contact of this.motion.data.contacts) {
      const sole = this.motion.robot.soles.find(
        (each) => each.body === contact.body && each.side === contact.side,
      );
      if (!sole || sole.points.length === 0) continue;
      const mesh = new Mesh(soleGeometry(sole.points), material);
      mesh.name = `sole ${contact.side}`;
      mesh.raycast = () => {};
      this.bodies[sole.body].add(mesh);
      this.soles.push({ mesh, phases: contact.phases });
    }
  }

  /** @param {number} frame  @param {boolean} showContacts */
  update(frame, showContacts, inPhase) {
    const poses = this.motion.bodyPoses(frame);
    this.bodies.forEach((body, i) => {
      const at = 7 * i;
      body.position.set(poses[at], poses[at + 1], poses[at + 2]);
      body.quaternion.set(poses[at + 4], poses[at + 5], poses[at + 6], poses[at + 3]);
    });
    for (const { mesh, phases } of this.soles) mesh.visible = showContacts && inPhase(phases, frame);
  }

  /** A motion that has ended is pale. @param {boolean} ended */
  setEnded(ended) {
    if (this.ended === ended) return;
    this.ended = ended;
    for (const material of [this.material, this.darker]) {
      material.transparent = ended;
      material.opacity = ended ? 0.35 : 1;
      material.needsUpdate = true;
    }
  }

  /** Highlights only these bodies. @param {number[]} bodies */
  highlight(bodies) {
    for (const [body, mesh] of [...this.meshes, ...this.covers]) {
      mesh.material = bodies.includes(body) ? this.pickedMaterial : mesh.userData.material;
    }
  }
}
