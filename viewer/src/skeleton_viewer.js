import {
  ArrowHelper,
  CylinderGeometry,
  Group,
  Mesh,
  MeshStandardMaterial,
  Quaternion,
  SphereGeometry,
  Vector3,
} from 'three';
import { byId, el, seconds, toggle } from './dom.js';
import { addHelp, addKeyboard } from './keyboard.js';
import { PlayedPage } from './played_page.js';
import { Tabs } from './tabs.js';
import { Tags } from './tags.js';
import { cssColour } from './theme.js';
import { Timeline } from './timeline.js';
import { Transport } from './transport.js';
import { cameraChoice, resetButton } from './view_tools.js';

const UP = new Vector3(0, 1, 0);
/** Colour of joints that are not mapped to a bone. */
const OTHER = 0xb9bec8;
const AXES = [
  ['x', 0xd64545],
  ['y', 0x3f9b4f],
  ['z', 0x3d6fd1],
];

/** A skeleton drawn as sticks and balls. */
class SkeletonFigure {
  /**
   * @param {object} skeleton  from the header
   * @param {object} colours  of joints that are mapped to a bone, by side
   * @param {number} thickness  metres
   * @param {number} opacity
   */
  constructor(skeleton, colours, thickness, opacity) {
    this.group = new Group();
    this.points = skeleton.points;
    const paint = (colour) =>
      new MeshStandardMaterial({ color: colour, roughness: 0.75, transparent: opacity < 1, opacity });
    const materials = Object.fromEntries(
      Object.entries(colours).map(([side, colour]) => [side, paint(colour)]),
    );
    const other = paint(OTHER);
    const stick = new CylinderGeometry(0.55 * thickness, thickness, 1, 10),
      ball = new SphereGeometry(1.35 * thickness, 12, 9);
    const add = (geometry, material) => {
      const mesh = new Mesh(geometry, material);
      mesh.castShadow = true;
      this.group.add(mesh);
      return mesh;
    };
    this.balls = this.points.map((point) => {
      const mesh = add(ball, materials[point.side] ?? other);
      if (!point.bone) mesh.scale.setScalar(0.6);
      return mesh;
    });
    this.sticks = this.points.map((point) =>
      point.parent < 0 ? null : add(stick, materials[point.side] ?? other),
    );
    this.places = this.points.map(() => new Vector3());
  }

  /** @param {Float64Array} positions  x y z of each point  @param {number} at  start offset */
  update(positions, at) {
    const way = new Vector3(),
      turn = new Quaternion();
    this.points.forEach((point, i) => {
      const place = this.places[i].fromArray(positions, at + 3 * i);
      this.balls[i].position.copy(place);
      const stick = this.sticks[i];
      if (!stick) return;
      const from = this.places[point.parent];
      way.copy(place).sub(from);
      const length = way.length();
      stick.visible = length > 1e-5;
      if (!stick.visible) return;
      stick.position.copy(from).add(place).multiplyScalar(0.5);
      stick.quaternion.copy(turn.setFromUnitVectors(UP, way.normalize()));
      stick.scale.set(1, length, 1);
    });
  }
}

/**
 * The page of a source alone: its skeleton in motion and at rest, its axes, and recognition
 * results.
 */
export class SkeletonViewer extends PlayedPage {
  constructor(page, tracks) {
    const { frames, rate } = page.skeleton;
    const fps = rate[0] / rate[1];
    super(Math.max(0, frames - 1) / fps, 1 / fps);
    this.skeleton = page.skeleton;
    this.colours = page.figure.colours;
    this.frames = frames;
    this.fps = fps;
    this.stride = 3 * this.skeleton.points.length;
    this.rest = tracks[this.skeleton.rest];
    this.positions = frames > 0 ? tracks[this.skeleton.track] : this.rest;
    this.measure();
    this.addFigures();
    this.tagged = new Tags(this);
    this.addControls(page);
    this.update();
    this.stage.frame();
    this.start();
  }

  frameAt(time) {
    return Math.min(Math.max(0, this.frames - 1), Math.max(0, Math.floor(time * this.fps + 1e-6)));
  }

  // Measures height, heading and root path.
  measure() {
    let low = Infinity,
      high = -Infinity;
    for (let i = 2; i < this.stride; i += 3) {
      low = Math.min(low, this.positions[i]);
      high = Math.max(high, this.positions[i]);
    }
    let restLow = Infinity,
      restHigh = -Infinity;
    for (let i = 2; i < this.stride; i += 3) {
      restLow = Math.min(restLow, this.rest[i]);
      restHigh = Math.max(restHigh, this.rest[i]);
    }
    this.restLow = restLow;
    this.height = Math.max(0.3, high - low, restHigh - restLow);
    const at = (name) => this.skeleton.points.findIndex((point) => point.bone === name);
    const [left, right] = [at('LeftUpLeg'), at('RightUpLeg')];
    this.heading = 0;
    if (left < 0 || right < 0) return;
    const across = [0, 1].map((axis) => this.positions[3 * left + axis] - this.positions[3 * right + axis]);
    this.heading = Math.atan2(-across[0], across[1]);
  }

  addFigures() {
    const thickness = 0.011 * this.height;
    this.moving = new SkeletonFigure(this.skeleton, this.colours, thickness, 1);
    this.still = new SkeletonFigure(this.skeleton, this.colours, thickness, 0.55);
    this.still.update(this.rest, 0);
    this.aside = new Vector3(-Math.sin(this.heading), Math.cos(this.heading), 0);
    this.spacing = 0.95 * this.height;
    this.axes = new Group();
    this.skeleton.axes.forEach((direction, i) =>
      this.axes.add(
        new ArrowHelper(
          new Vector3(...direction),
          new Vector3(),
          0.35 * this.height,
          AXES[i][1],
          0.08 * this.height,
          0.045 * this.height,
        ),
      ),
    );
    this.stage.scene.add(this.moving.group, this.still.group, this.axes);
    this.stage.setExtent(this.height, 1.9 * this.spacing, this.heading);
  }

  root(frame) {
    return new Vector3(this.positions[this.stride * frame], this.positions[this.stride * frame + 1], 0);
  }

  addControls(page) {
    const { player, skeleton } = this;
    byId('title').textContent = page.title;
    byId('subtitle').textContent =
      this.frames > 0
        ? `${skeleton.points.length} joints and ends \u00b7 ${seconds(player.duration)} \u00b7 ${this.frames} frames at ${Number(this.fps.toFixed(3))} fps`
        : 'a skeleton without frames';
    const doubts = skeleton.doubts.length;
    byId('verdicts').append(
      el('span', {
        class: `verdict ${skeleton.understood && doubts === 0 ? 'good' : 'bad'}`,
        text: !skeleton.understood
          ? 'no human found'
          : doubts === 0
            ? 'recognised, no warnings'
            : `${doubts} ${doubts === 1 ? 'warning' : 'warnings'}`,
      }),
    );
    this.camera = cameraChoice(this, this.stage.mode);
    const show = (group) => (on) => {
      group.visible = on;
      this.stage.shadowsChanged();
      this.redraw();
    };
    byId('view-tools').append(
      this.camera.element,
      resetButton(this),
      el(
        'div',
        { class: 'group' },
        toggle('Rest pose', true, show(this.still.group), 'Show the skeleton with all rotations at zero'),
        toggle('Axes', true, show(this.axes), 'Show the axes of the file'),
      ),
    );
    this.transport = new Transport(player);
    this.timeline = new Timeline(player, [], () => {});
    this.tabs = new Tabs(byId('panel'), [
      ['found', 'File', this.foundPanel()],
      ['joints', 'Joints', this.jointsPanel()],
    ]);
    this.help = addHelp([
      `Positions on this page are rounded to ${page.precision.bone_m * 1000} mm. Written by ${page.tool}.`,
    ]);
    addKeyboard({
      ...this.playerKeys(this.transport),
      r: () => this.reset(),
      f: () => this.setCamera(this.stage.mode === 'follow' ? 'stand' : 'follow'),
      '?': () => this.help(),
    });
  }

  foundPanel() {
    const { skeleton } = this;
    const panel = el('div');
    if (skeleton.doubts.length > 0) {
      panel.append(
        el('h2', { text: 'Warnings' }),
        el('ul', {}, ...skeleton.doubts.map((text) => el('li', { text }))),
      );
    }
    const pre = el('pre', { text: skeleton.facts });
    Object.assign(pre.style, { overflowX: 'auto', fontSize: '12px', lineHeight: '1.4' });
    panel.append(el('h2', { text: 'Detected properties' }), pre);
    return panel;
  }

  jointsPanel() {
    const rows = this.skeleton.points.map((point) => {
      const dot = el('span', { class: 'dot', 'aria-hidden': 'true' });
      Object.assign(dot.style, {
        display: 'inline-block',
        width: '9px',
        height: '9px',
        borderRadius: '50%',
        marginRight: '6px',
        background: cssColour(this.colours[point.side] ?? OTHER),
      });
      return el(
        'tr',
        {},
        el('th', { scope: 'row' }, dot, point.name),
        el('td', { class: point.bone ? '' : 'quiet', text: point.bone ?? '\u2013' }),
        el('td', { class: 'quiet', text: point.side ?? '' }),
      );
    });
    return el(
      'table',
      {},
      el(
        'thead',
        {},
        el('tr', {}, ...['Joint', 'Bone', 'Side'].map((text) => el('th', { scope: 'col', text }))),
      ),
      el('tbody', {}, ...rows),
    );
  }

  setCamera(mode) {
    this.camera.show(mode);
    this.stage.setMode(mode);
    this.redraw();
  }

  reset() {
    if (this.stage.mode === 'orbit') this.setCamera('follow');
    this.stage.frame();
    this.redraw();
  }

  update() {
    const frame = this.frameAt(this.player.time);
    if (frame === this.shown) return;
    this.shown = frame;
    this.stage.shadowsChanged();
    this.moving.update(this.positions, this.stride * frame);
    const { x, y } = this.root(frame);
    // The rest pose and the axes follow the root; the rest pose stands on its lowest point.
    this.still.group.position
      .set(x - this.rest[0], y - this.rest[1], -this.restLow)
      .addScaledVector(this.aside, -this.spacing);
    this.axes.position.set(x, y, 0.003).addScaledVector(this.aside, 0.75 * this.spacing);
    this.stage.aim(
      x - 0.1 * this.spacing * this.aside.x,
      y - 0.1 * this.spacing * this.aside.y,
      0.46 * this.height,
    );
  }

  /** Name tags of the figures and axes, in canvas pixels. */
  tags() {
    const tags = [];
    const add = (place, text, colour) => tags.push(this.stage.tagAt(place, text, colour));
    const below = -0.08 * this.height;
    const root = this.root(this.shown ?? 0);
    add(new Vector3(root.x, root.y, below), this.frames > 0 ? 'motion' : 'rest pose', null);
    if (this.still.group.visible) {
      add(
        new Vector3(this.rest[0], this.rest[1], 0).add(this.still.group.position).setZ(below),
        'rest pose',
        null,
      );
    }
    if (this.axes.visible) {
      this.skeleton.axes.forEach((direction, i) =>
        add(
          new Vector3(...direction).multiplyScalar(0.4 * this.height).add(this.axes.position),
          AXES[i][0],
          AXES[i][1],
        ),
      );
    }
    return tags;
  }

  updateTags() {
    this.tagged.update();
  }
}

/** Interface of such a page for tests. */
export function addSkeletonHook(viewer) {
  window.retarget = {
    player: viewer.player,
    show(frame) {
      viewer.player.pause();
      viewer.player.seekFrame(frame);
      viewer.frame(performance.now());
    },
    /** Whether another picture will be drawn. */
    pictureDue: () => viewer.scheduled,
    /** Names and positions of joints and end sites as drawn, metres. */
    joints: () =>
      viewer.skeleton.points.map((point, i) => ({
        ...point,
        position: viewer.moving.balls[i].position.toArray(),
      })),
    rest: () =>
      viewer.skeleton.points.map((point, i) => ({
        ...point,
        position: viewer.still.balls[i].position.toArray(),
      })),
  };
}
