import {
  CanvasTexture,
  Color,
  Mesh,
  MeshLambertMaterial,
  PlaneGeometry,
  RepeatWrapping,
  SRGBColorSpace,
} from 'three';

/** Side of the drawn part of the floor, metres; fog hides its border. */
const SIDE = 60;
const PIXELS = 512;

/** A checked floor: squares of one metre, fine lines every quarter metre. */
export class Floor {
  constructor() {
    this.canvas = document.createElement('canvas');
    this.canvas.width = this.canvas.height = PIXELS;
    this.texture = new CanvasTexture(this.canvas);
    this.texture.wrapS = this.texture.wrapT = RepeatWrapping;
    // The pattern is two metres wide.
    this.texture.repeat.set(SIDE / 2, SIDE / 2);
    this.texture.anisotropy = 8;
    this.texture.colorSpace = SRGBColorSpace;
    this.object = new Mesh(new PlaneGeometry(SIDE, SIDE), new MeshLambertMaterial({ map: this.texture }));
    this.object.receiveShadow = true;
    this.object.name = 'floor';
  }

  applyTheme({ floor, square, line }) {
    const context = this.canvas.getContext('2d');
    const css = (colour) => new Color(colour).getStyle();
    const half = PIXELS / 2;
    context.fillStyle = css(floor);
    context.fillRect(0, 0, PIXELS, PIXELS);
    context.fillStyle = css(square);
    context.fillRect(0, 0, half, half);
    context.fillRect(half, half, half, half);
    context.fillStyle = css(line);
    context.globalAlpha = 0.35;
    for (let i = 0; i < 8; ++i) {
      const at = (i * PIXELS) / 8;
      context.fillRect(at, 0, 1, PIXELS);
      context.fillRect(0, at, PIXELS, 1);
    }
    context.globalAlpha = 1;
    for (const at of [0, half]) {
      context.fillRect(at - 1, 0, 3, PIXELS);
      context.fillRect(0, at - 1, PIXELS, 3);
    }
    this.texture.needsUpdate = true;
  }

  /** Moves the floor by whole patterns, so that it appears to stand still. */
  follow(x, y) {
    this.object.position.set(2 * Math.round(x / 2), 2 * Math.round(y / 2), 0);
  }
}
