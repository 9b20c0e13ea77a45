import { Raycaster, Vector2, Vector3 } from 'three';
import { HumanFigure } from './human_figure.js';
import { inPhase } from './motions.js';
import { Paths } from './paths.js';
import { RobotFigure } from './robot_figure.js';
import { SceneFigure } from './scene_figure.js';
import { motionColour } from './theme.js';
import { calmWay, lift, onWay, standing } from './ways.js';

/** Distance of neighbours in the row, as a fraction of a robot's height: usual, and at most around scenes. */
const SPACING = 0.85,
  MAX_SPACING = 2.2;

/** The figures of all motions, arranged in a row perpendicular to their heading. */
export class World {
  /**
   * @param {import('./motions.js').Motion[]} motions
   * @param {import('./stage.js').Stage} stage
   * @param {object} figure  from the header: how to draw humans
   * @param {import('./scene_figure.js').SceneData[]} scenes  from the header
   */
  constructor(motions, stage, figure, scenes) {
    this.motions = motions;
    this.stage = stage;
    this.heading = motions[0].heading();
    this.aside = new Vector3(-Math.sin(this.heading), Math.cos(this.heading), 0);
    this.humanMode = 'beside';
    this.humanDistance = 1;
    this.figure = figure;
    this.besideEach = false;
    this.showContacts = true;
    this.showScenes = true;
    this.robots = motions.map((motion, i) => new RobotFigure(motion, motionColour(i)));
    this.humans = this.makeHumans(scenes);
    /** By motion; null: it has none. */
    this.scenes = motions.map(({ data, index }) =>
      data.scene === undefined ? null : new SceneFigure(scenes[data.scene], 'robot', `scene ${index}`),
    );
    this.paths = motions.map((motion, i) => new Paths(motion, motionColour(i)));
    this.stand = motions.map(standing).reduce((a, b) => (b.height > a.height ? b : a));
    this.height = this.stand.height;
    this.chooseSpacing(scenes);
    this.way = calmWay(motions);
    const figures = [...this.robots, ...this.humans, ...this.paths, ...this.scenes.filter(Boolean)];
    stage.scene.add(...figures.map((each) => each.group));
    this.arrange();
  }

  // Creates a human per motion. If motions share a source, only the first one is shown by default.
  makeHumans(scenes) {
    const known = new Set();
    return this.motions
      .filter((motion) => motion.human)
      .map((motion) => {
        const first = !known.has(motion.data.human);
        known.add(motion.data.human);
        const figure = Object.assign(new HumanFigure(motion, this.figure), { motion, first });
        const scene = scenes[motion.data.scene];
        if (scene?.worlds.has('human')) {
          figure.scene = new SceneFigure(scene, 'human', `scene of human ${motion.index}`);
          figure.group.add(figure.scene.group);
        }
        return figure;
      });
  }

  // Keeps the scenes of neighbours apart, and each figure out of the next one's scene. If they are too
  // wide for this, humans stand beside their robots in the robots' scenes.
  chooseSpacing(scenes) {
    this.spacing = SPACING * this.height;
    let apart = this.spacing;
    for (const motion of this.motions) {
      const extent = scenes[motion.data.scene]?.extent(this.aside);
      if (!extent) continue;
      const margin = 0.3 * this.height;
      let [low, high] = extent;
      for (let frame = 0; frame < motion.frames; ++frame) {
        const [x, y] = motion.position.subarray(3 * frame, 3 * frame + 2);
        const along = x * this.aside.x + y * this.aside.y;
        low = Math.min(low, along - margin);
        high = Math.max(high, along + margin);
      }
      apart = Math.max(apart, high - low + margin);
    }
    this.scenesApart = apart <= MAX_SPACING * this.height;
    if (this.scenesApart) this.spacing = apart;
  }

  /** Whether several motions have the same source. */
  get sharesSource() {
    return this.humans.some((human) => !human.first);
  }

  get shownHumans() {
    return this.humans.filter((human) => human.first || this.besideEach);
  }

  /** Shows the source next to each motion, or a shared source once. */
  setBesideEach(on) {
    this.besideEach = on;
    this.arrange();
  }

  setHumanMode(mode) {
    this.humanMode = mode;
    this.arrange();
  }

  setHumanDistance(distance) {
    this.humanDistance = distance;
    this.arrange();
  }

  setPathsVisible(visible) {
    for (const path of this.paths) path.group.visible = visible;
  }

  /** Shows or hides contact marks on stance feet. */
  setContactsVisible(visible) {
    this.showContacts = visible;
    this.shown = null;
  }

  get hasMeshes() {
    return this.robots.some((robot) => robot.covers.size > 0);
  }

  setMeshesVisible(visible) {
    for (const robot of this.robots) if (robot.covers.size > 0) robot.setMeshesVisible(visible);
    this.shown = null;
  }

  get hasScenes() {
    return this.scenes.some(Boolean);
  }

  setScenesVisible(visible) {
    this.showScenes = visible;
    this.arrange();
  }

  /** Places every figure in the row. */
  arrange() {
    this.shown = null;
    const beside = this.humanMode === 'beside' && this.humans.length > 0;
    const shown = this.shownHumans;
    let place = 0;
    const places = [];
    this.motions.forEach((motion, i) => {
      const human = shown.find((each) => each.motion === motion);
      // Place the human to the left of its robot, which is on the right in the picture.
      if (human && beside) {
        this.placeHuman(human, place);
        places.push(place);
        place -= this.spacing * this.humanDistance;
      }
      this.robots[i].group.position.copy(this.aside).multiplyScalar(place);
      this.paths[i].group.position.copy(this.robots[i].group.position);
      if (this.scenes[i]) {
        this.scenes[i].group.position.copy(this.robots[i].group.position);
        this.scenes[i].group.visible = this.showScenes;
      }
      if (human && !beside) this.placeHuman(human, place);
      places.push(place);
      place -= this.spacing;
    });
    for (const human of this.humans) {
      human.group.visible = this.humanMode !== 'off' && shown.includes(human);
      human.setOver(this.humanMode === 'over');
      // Over the robot, the robot's scene is also the human's.
      if (human.scene) human.scene.group.visible = this.showScenes && beside && this.scenesApart;
    }
    this.middle = (Math.max(...places) + Math.min(...places)) / 2;
    this.stage.setExtent(this.height, Math.max(...places) - Math.min(...places), this.heading);
  }

  placeHuman(human, place) {
    const [scale, x, y, yaw] = human.human.placement;
    human.group.rotation.z = yaw;
    human.group.scale.setScalar(scale);
    human.group.position
      .copy(this.aside)
      .multiplyScalar(place)
      .add(new Vector3(x, y, 0));
  }

  /** Poses all figures. @param {number} time  seconds */
  update(time) {
    // Several pictures may show the same frames.
    const frames = this.motions.map((motion) => motion.step(time)).join();
    if (frames === this.shown) return;
    this.shown = frames;
    this.time = time;
    this.stage.shadowsChanged();
    this.motions.forEach((motion, i) => {
      this.robots[i].update(motion.frameAt(time), this.showContacts, inPhase);
      this.robots[i].setEnded(motion.hasEnded(time));
      this.scenes[i]?.update(motion.step(time));
    });
    // A human may be longer than its motion.
    for (const human of this.shownHumans) {
      human.update(human.motion.step(time), this.showContacts);
      human.scene?.update(human.motion.step(time));
    }
    const [x, y, z] = onWay(this.way, time);
    this.stage.aim(
      x + this.aside.x * this.middle,
      y + this.aside.y * this.middle,
      0.46 * this.height,
      lift(z, this.stand),
    );
  }

  /** The robot body at a point of the canvas. @returns {{motion: number, body: number}|null} */
  pick(clientX, clientY) {
    const box = this.stage.canvas.getBoundingClientRect();
    const point = new Vector2(
      ((clientX - box.left) / box.width) * 2 - 1,
      1 - ((clientY - box.top) / box.height) * 2,
    );
    const ray = new Raycaster();
    ray.setFromCamera(point, this.stage.camera);
    // Rays also hit hidden objects.
    const hit = ray
      .intersectObjects(
        this.robots.map((robot) => robot.group),
        true,
      )
      .find((each) => each.object.visible);
    return hit ? { motion: hit.object.userData.motion, body: hit.object.userData.body } : null;
  }

  /** Highlights bodies in every motion of their robot. @param {boolean} alone  only in this motion */
  highlight(motion, bodies, alone = false) {
    this.robots.forEach((robot, i) => {
      const marked = alone ? i === motion : this.motions[i].robot === this.motions[motion]?.robot;
      robot.highlight(marked ? bodies : []);
    });
  }

  /** Name tags of the figures, in canvas pixels. */
  tags() {
    const tags = [];
    const add = (figure, root, text, colour) => {
      const there = figure.group.localToWorld(root.clone()).setZ(-0.09 * this.height);
      tags.push(this.stage.tagAt(there, text, colour));
    };
    const named = (name, ended) => (ended ? `${name} (ended)` : name);
    this.robots.forEach((robot, i) => {
      const motion = this.motions[i];
      const text = named(motion.label, motion.hasEnded(this.time ?? 0));
      add(robot, robot.bodies[motion.robot.root].position, text, motionColour(i));
    });
    if (this.humanMode === 'beside') {
      for (const human of this.shownHumans) {
        const step = human.motion.step(this.time ?? 0);
        const frame = Math.min(step, human.human.frames - 1);
        const hips = human.index.has('Hips') ? human.place('Hips', frame, new Vector3()) : new Vector3();
        add(human, hips, named(human.motion.report?.source || 'source', step > frame), null);
      }
    }
    return tags;
  }
}
