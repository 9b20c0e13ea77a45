import { DoubleSide, Group, Matrix4, Mesh, MeshStandardMaterial, Quaternion, Vector3 } from 'three';
import { mergeGeometries } from 'three/examples/jsm/utils/BufferGeometryUtils.js';
import { facetGeometry, meshGeometry, placed, shapeGeometry } from './shapes.js';
import { SCENE, SCENE_OBJECT } from './theme.js';

/** Larger meshes get flat triangles, because smooth ones take seconds. */
const MAX_SMOOTH = 50000;

/** The scene of motions, with unpacked tracks. */
export class SceneData {
  /** @param {object} scene  from the header  @param {Float64Array[]} tracks */
  constructor(scene, tracks) {
    this.scale = scene.scale;
    this.bodies = scene.bodies;
    this.worlds = new Map();
    for (const name of ['robot', 'human']) {
      const world = scene[name];
      if (!world) continue;
      const moving = world.poses.flatMap((pose, body) => (pose ? [] : [body]));
      this.worlds.set(name, {
        ...world,
        moving,
        position: tracks[world.position],
        rotation: tracks[world.rotation],
      });
    }
    this.geometries = this.bodies.map(({ shapes }) => bodyGeometry(shapes, tracks));
  }

  /**
   * The extent of the static bodies along a direction, without planes, metres; null if there is none.
   * @param {Vector3} direction  unit vector, in the robot's world
   * @returns {[number, number]|null}
   */
  extent(direction) {
    let low = Infinity,
      high = -Infinity;
    const { poses } = this.worlds.get('robot');
    this.bodies.forEach(({ shapes }, body) => {
      if (!poses[body] || shapes.some((shape) => shape.plane)) return;
      const geometry = placed(this.geometries[body].clone(), poses[body]);
      const point = new Vector3();
      const { position } = geometry.attributes;
      for (let i = 0; i < position.count; ++i) {
        const along = point.fromBufferAttribute(position, i).dot(direction);
        low = Math.min(low, along);
        high = Math.max(high, along);
      }
      geometry.dispose();
    });
    return low <= high ? [low, high] : null;
  }
}

// All shapes of a body as one geometry, in its frame.
function bodyGeometry(shapes, tracks) {
  const geometries = shapes.map((shape) => {
    let geometry;
    if (shape.mesh) {
      const vertices = tracks[shape.mesh.vertices],
        triangles = tracks[shape.mesh.triangles];
      const make = triangles.length > 3 * MAX_SMOOTH ? facetGeometry : meshGeometry;
      geometry = placed(make(vertices, triangles), shape.pose);
    } else {
      geometry = shapeGeometry(shape).toNonIndexed();
    }
    // Only geometries with the same attributes can be merged.
    geometry.deleteAttribute('uv');
    return geometry;
  });
  return mergeGeometries(geometries);
}

// Meshes may be open, or face inward.
const paint = (colour) => new MeshStandardMaterial({ color: colour, roughness: 0.85, side: DoubleSide });

/** A scene around a robot or a human: one object per body. */
export class SceneFigure {
  /** @param {SceneData} scene  @param {'robot'|'human'} world  @param {string} name */
  constructor(scene, world, name) {
    this.world = scene.worlds.get(world);
    this.group = new Group();
    this.group.name = name;
    const fixed = paint(SCENE),
      moving = paint(SCENE_OBJECT);
    this.bodies = scene.bodies.map((body, i) => {
      const pose = this.world.poses[i];
      const mesh = new Mesh(scene.geometries[i], pose ? fixed : moving);
      mesh.name = body.name;
      mesh.castShadow = mesh.receiveShadow = true;
      if (pose) {
        const [x, y, z, qw, qx, qy, qz] = pose;
        mesh.position.set(x, y, z);
        mesh.quaternion.set(qx, qy, qz, qw);
        // The geometry has the size in the robot's world; objects have the same size in both.
        if (world === 'human') mesh.scale.setScalar(1 / scene.scale);
      }
      this.group.add(mesh);
      return mesh;
    });
  }

  /** Poses moving bodies; after the last frame they do not move. @param {number} frame */
  update(frame) {
    const { frames, moving, position, rotation } = this.world;
    const shown = Math.min(frame, frames - 1);
    moving.forEach((body, i) => {
      const at = shown * moving.length + i;
      this.bodies[body].position.fromArray(position, 3 * at);
      const [w, x, y, z] = rotation.subarray(4 * at, 4 * at + 4);
      this.bodies[body].quaternion.set(x, y, z, w).normalize();
    });
  }
}

/** Poses of a scene's drawn bodies in its world: name, position (metres), quaternion w x y z. */
export function drawnBodies({ group, bodies }) {
  group.updateWorldMatrix(true, true);
  const toWorld = group.matrixWorld.clone().invert();
  return bodies.map((body) => {
    const position = new Vector3(),
      turn = new Quaternion(),
      size = new Vector3();
    new Matrix4().multiplyMatrices(toWorld, body.matrixWorld).decompose(position, turn, size);
    return {
      name: body.name,
      position: position.toArray(),
      quaternion: [turn.w, turn.x, turn.y, turn.z],
      scale: size.x,
    };
  });
}
