import { Vector3 } from 'three';
import { drawnBodies } from './scene_figure.js';

/**
 * `window.retarget`: interface for tests and consoles. Positions are read from the drawn scene, in
 * the motion's world.
 */
export function addTestHook(viewer) {
  const { player, world, motions } = viewer;
  window.retarget = {
    player,
    motions: motions.map(({ label, frames, fps }) => ({ label, frames, fps })),
    picked: () => viewer.picked ?? null,
    /** Shows a frame at once. */
    show(frame) {
      player.pause();
      player.seekFrame(frame);
      viewer.frame(performance.now());
    },
    /** Names and positions of a motion's bodies, metres. */
    bodies(motion) {
      const { group, bodies } = world.robots[motion];
      group.updateMatrixWorld(true);
      return bodies.map((body) => {
        const place = group.worldToLocal(body.getWorldPosition(new Vector3()));
        return { name: body.name, position: place.toArray() };
      });
    },
    /** The visible bodies of a motion's scene: name, position, quaternion w x y z, scale. */
    scene(motion) {
      const scene = world.scenes[motion];
      return scene?.group.visible ? drawnBodies(scene) : [];
    },
    /** The same around its human, in the human's world. */
    humanScene(motion) {
      const human = world.humans.find((each) => each.motion.index === motion);
      const shown = human?.group.visible && human.scene?.group.visible;
      return shown ? drawnBodies(human.scene) : [];
    },
    /** Indices of the highlighted bodies of a motion. */
    highlighted: (motion) =>
      [...world.robots[motion].meshes]
        .filter(([, mesh]) => mesh.material === world.robots[motion].pickedMaterial)
        .map(([body]) => body),
    /** Joint positions in a frame by name. */
    joints(motion, frame) {
      const { robot } = motions[motion];
      return Object.fromEntries(
        robot.outputs.map((joint) => [robot.joints[joint].name, motions[motion].jointValue(joint, frame)]),
      );
    },
    /** Positions of the bones of a motion's human, metres. */
    bones(motion, frame) {
      const { human } = motions[motion];
      const count = human.bones.length;
      return human.bones.map((name, i) => ({
        name,
        position: [...human.positions.subarray(3 * (frame * count + i), 3 * (frame * count + i) + 3)],
      }));
    },
    /** Error between a motion's body and its bone in a frame; null if unknown. */
    errors(motion, body, frame) {
      const errors = motions[motion].errors.get(body);
      const at = motions[motion].errorAt(frame);
      return errors && { position: errors.position?.[at], rotation: errors.rotation?.[at] };
    },
    /** The visible humans: index of the motion and position per human. */
    humans: () =>
      world.humans
        .filter((human) => human.group.visible)
        .map((human) => ({ motion: human.motion.index, place: human.group.position.toArray() })),
    /** Position of a robot in the row. */
    placeOf: (motion) => world.robots[motion].group.position.toArray(),
    /** Position of a body in the picture, window pixels. */
    onScreen(motion, body) {
      const canvas = viewer.stage.canvas.getBoundingClientRect();
      const mesh = world.robots[motion].meshes.get(body);
      mesh.geometry.computeBoundingSphere();
      const place = mesh
        .localToWorld(mesh.geometry.boundingSphere.center.clone())
        .project(viewer.stage.camera);
      return [
        canvas.left + (place.x * 0.5 + 0.5) * canvas.width,
        canvas.top + (0.5 - place.y * 0.5) * canvas.height,
      ];
    },
    /**
     * Bodies drawn as meshes, with the corners of their bounding boxes in body coordinates, metres.
     */
    meshes: (motion) =>
      [...world.robots[motion].covers]
        .filter(([, mesh]) => mesh.visible)
        .map(([body, mesh]) => {
          mesh.geometry.computeBoundingBox();
          const { min, max } = mesh.geometry.boundingBox;
          return { body, min: min.toArray(), max: max.toArray() };
        }),
    /** The current picture: width, height and RGBA in base64. */
    picture() {
      viewer.frame(performance.now());
      const { canvas } = viewer.stage;
      const { width, height } = canvas;
      const copy = Object.assign(document.createElement('canvas'), { width, height }).getContext('2d');
      copy.drawImage(canvas, 0, 0);
      const { data } = copy.getImageData(0, 0, width, height);
      let text = '';
      for (let i = 0; i < data.length; i += 8192) text += String.fromCharCode(...data.subarray(i, i + 8192));
      return { width, height, rgba: btoa(text) };
    },
  };
}
