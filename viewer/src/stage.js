import {
  DirectionalLight,
  Fog,
  HemisphereLight,
  MathUtils,
  PCFShadowMap,
  PerspectiveCamera,
  Scene,
  Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { Floor } from './floor.js';
import { calm, onThemeChange, theme } from './theme.js';

const UP = new Vector3(0, 0, 1);
/** Initial angle of the camera from the heading: to the front and one side. */
const SIDE = MathUtils.degToRad(38);
/** Angular speed of the camera in `orbit`, rad/s. */
const ORBIT_SPEED = 0.35;
/** Effect of a key press: rotation in rad, distance factor. */
const KEY_TURN = 0.1,
  KEY_ZOOM = 1.1;

/** Renderer, light, floor and camera. World axes: metres, Z up, as in the data. */
export class Stage {
  /** @param {HTMLCanvasElement} canvas  @param {() => void} redraw  requests a picture */
  constructor(canvas, redraw) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, powerPreference: 'high-performance' });
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    // Update shadows only when an object has moved, not the camera.
    this.renderer.shadowMap.autoUpdate = false;
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(38, 1, 0.05, 200);
    this.camera.up.copy(UP);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.maxPolarAngle = 0.55 * Math.PI;
    this.controls.minDistance = 0.3;
    this.controls.maxDistance = 60;
    this.controls.zoomToCursor = false;
    this.controls.addEventListener('change', redraw);
    this.addKeys(redraw);
    this.mode = 'follow';
    this.target = new Vector3(0, 0, 0.8);
    this.floor = new Floor();
    this.addLights();
    this.scene.add(this.floor.object);
    this.applyTheme();
    onThemeChange(() => {
      this.applyTheme();
      redraw();
    });
    new ResizeObserver(() => {
      this.resize();
      redraw();
    }).observe(canvas.parentElement);
    this.resize();
  }

  // Arrow keys rotate the view while the canvas has the keyboard focus. A mouse press does not
  // focus it, so that arrow keys still move through time afterwards.
  addKeys(redraw) {
    this.canvas.addEventListener('mousedown', (event) => {
      event.preventDefault();
      document.activeElement?.blur();
    });
    this.canvas.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const turn = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
      const zoom = { '+': 1 / KEY_ZOOM, '=': 1 / KEY_ZOOM, '-': KEY_ZOOM }[event.key];
      if (!turn && !zoom) return;
      event.preventDefault();
      event.stopPropagation();
      this.orbit(...(turn ?? [0, 0]), zoom ?? 1);
      redraw();
    });
  }

  // Orbits by a number of steps around and down, and scales the distance.
  orbit(around, down, farther) {
    const { minDistance, maxDistance, maxPolarAngle, target } = this.controls;
    const arm = this.camera.position.clone().sub(target);
    const distance = arm.length();
    const angle = Math.atan2(arm.y, arm.x) + around * KEY_TURN;
    const polar = Math.acos(arm.z / distance) + down * KEY_TURN;
    const tilt = Math.min(maxPolarAngle, Math.max(0.05, polar));
    const reach = Math.min(maxDistance, Math.max(minDistance, farther * distance));
    this.camera.position.set(
      target.x + reach * Math.sin(tilt) * Math.cos(angle),
      target.y + reach * Math.sin(tilt) * Math.sin(angle),
      target.z + reach * Math.cos(tilt),
    );
    this.controls.update();
  }

  addLights() {
    this.ambient = new HemisphereLight(0xffffff, 0x8a8f99, 1);
    this.ambient.position.copy(UP);
    this.sun = new DirectionalLight(0xffffff, 1);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(1024, 1024);
    this.sun.shadow.radius = 3;
    this.sun.shadow.bias = -0.0004;
    this.sun.shadow.normalBias = 0.016;
    Object.assign(this.sun.shadow.camera, { near: 0.5, far: 14 });
    // Light from the opposite side, so that no side looks flat.
    this.fill = new DirectionalLight(0xdfe8ff, 0.35);
    this.scene.add(this.ambient, this.sun, this.sun.target, this.fill, this.fill.target);
  }

  applyTheme() {
    const colours = theme();
    this.renderer.setClearColor(colours.sky);
    this.scene.fog = new Fog(colours.sky, 9, 26);
    this.ambient.intensity = colours.ambient;
    this.sun.intensity = colours.sun;
    this.floor.applyTheme(colours);
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  /**
   * Sets the extent of the scene, metres: `height` above the floor, `width` of the row across
   * `heading`. Shadows cover the same width, so that they are sharp, and the light comes from the
   * camera's initial side.
   */
  setExtent(height, width, heading) {
    Object.assign(this, { height, width, heading });
    const { camera } = this.sun.shadow;
    const half = Math.max(1.2, 0.5 * width + 0.9 * height);
    Object.assign(camera, { left: -half, right: half, top: half, bottom: -half });
    camera.updateProjectionMatrix();
  }

  /** A name tag in canvas pixels. @param {Vector3} place  world position, metres */
  tagAt(place, text, colour) {
    const there = place.clone().project(this.camera);
    return {
      text,
      colour,
      x: (there.x * 0.5 + 0.5) * this.canvas.clientWidth,
      y: (0.5 - there.y * 0.5) * this.canvas.clientHeight,
      visible: there.z < 1,
    };
  }

  shadowsChanged() {
    this.renderer.shadowMap.needsUpdate = true;
  }

  /**
   * Sets the camera target in the world; `lift` is its height relative to a figure on the floor.
   */
  aim(x, y, z, lift = 0) {
    const move = new Vector3(x, y, z + lift).sub(this.target);
    this.target.set(x, y, z + lift);
    if (this.mode !== 'stand') {
      this.camera.position.add(move);
      this.controls.target.add(move);
    }
    this.shine(this.sun, -SIDE - 0.95, 2.6, 5, x, y, lift);
    this.shine(this.fill, -SIDE + 1.1, 4, 1.5, x, y, lift);
    this.floor.follow(x, y);
  }

  // Places a light by its angle from the heading, its distance and its height.
  shine(light, turn, distance, rise, x, y, lift) {
    const angle = (this.heading ?? 0) + turn;
    light.target.position.set(x, y, 0.3 + lift);
    light.position.set(x + distance * Math.cos(angle), y + distance * Math.sin(angle), rise + lift);
  }

  /** Views the row from the front and one side, near enough that it fills the picture. */
  frame() {
    const angle = this.heading - SIDE;
    const tangent = Math.tan(MathUtils.degToRad(this.camera.fov) / 2);
    const across = 0.5 * this.width * Math.cos(SIDE) + 0.42 * this.height;
    const distance =
      0.5 * this.width * Math.sin(SIDE) +
      Math.max((0.74 * this.height) / tangent, across / (tangent * this.camera.aspect));
    const rise = MathUtils.degToRad(12);
    this.controls.target.copy(this.target);
    this.camera.position.set(
      this.target.x + distance * Math.cos(rise) * Math.cos(angle),
      this.target.y + distance * Math.cos(rise) * Math.sin(angle),
      this.target.z + distance * Math.sin(rise),
    );
    this.controls.update();
  }

  setMode(mode) {
    this.mode = mode;
    // Bring the figures back into the picture.
    if (mode !== 'stand') {
      const move = this.target.clone().sub(this.controls.target);
      this.camera.position.add(move);
      this.controls.target.add(move);
      this.controls.update();
    }
  }

  /** Whether the camera rotates automatically. */
  get turns() {
    return this.mode === 'orbit' && !calm.matches;
  }

  /** Rotates the camera in `orbit`. @param {number} seconds  elapsed time */
  turn(seconds) {
    if (!this.turns) return;
    const arm = this.camera.position.clone().sub(this.controls.target);
    arm.applyAxisAngle(UP, ORBIT_SPEED * seconds);
    this.camera.position.copy(this.controls.target).add(arm);
    this.controls.update();
  }

  render() {
    // Keep the camera above the floor.
    this.camera.position.z = Math.max(0.03, this.camera.position.z);
    this.camera.lookAt(this.controls.target);
    this.renderer.render(this.scene, this.camera);
  }
}
