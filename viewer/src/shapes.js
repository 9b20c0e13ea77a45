import {
  BoxGeometry,
  BufferGeometry,
  CapsuleGeometry,
  CylinderGeometry,
  Float32BufferAttribute,
  Matrix4,
  PlaneGeometry,
  Quaternion,
  SphereGeometry,
  Vector3,
} from 'three';
import { toCreasedNormals } from 'three/examples/jsm/utils/BufferGeometryUtils.js';

/** Side of a drawn plane, metres; fog hides its border. */
const PLANE_SIDE = 100;

/** Minimum angle of an edge that is drawn sharp, rad. */
const CREASE = 0.6;

function originGeometry(shape) {
  if (shape.box) return new BoxGeometry(...shape.box.map((half) => 2 * half));
  if (shape.plane) return new PlaneGeometry(PLANE_SIDE, PLANE_SIDE);
  // Capsules and cylinders of three.js extend along y, ours along z.
  if (shape.capsule) {
    const [radius, half] = shape.capsule;
    return new CapsuleGeometry(radius, 2 * half, 6, 18).rotateX(Math.PI / 2);
  }
  if (shape.cylinder) {
    const [radius, half] = shape.cylinder;
    return new CylinderGeometry(radius, radius, 2 * half, 32).rotateX(Math.PI / 2);
  }
  return new SphereGeometry(shape.sphere, 20, 14);
}

/** Moves a geometry. @param {number[]} pose  x, y, z, quaternion w x y z */
export function placed(geometry, [x, y, z, qw, qx, qy, qz]) {
  return geometry.applyMatrix4(
    new Matrix4().compose(new Vector3(x, y, z), new Quaternion(qx, qy, qz, qw), new Vector3(1, 1, 1)),
  );
}

/** A primitive in its body's frame, metres. */
export function shapeGeometry(shape) {
  return placed(originGeometry(shape), shape.pose);
}

/** A surface of triangles, round where its edges are blunt. */
export function meshGeometry(vertices, triangles) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(vertices, 3));
  geometry.setIndex(Array.from(triangles));
  return toCreasedNormals(geometry, CREASE);
}

/** The same with flat triangles, which is faster. */
export function facetGeometry(vertices, triangles) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(vertices, 3));
  geometry.setIndex(Array.from(triangles));
  const flat = geometry.toNonIndexed();
  flat.computeVertexNormals();
  return flat;
}
