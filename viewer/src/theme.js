/** Colours of the scene, light and dark; page.css has those of the rest of the page. */

const LIGHT = {
  sky: 0xf5f6f8,
  floor: 0xd5d8de,
  square: 0xc9cdd6,
  line: 0xaab2bf,
  axis: 0x9aa5b5,
  ambient: 1.9,
  sun: 2.0,
};
const DARK = {
  sky: 0x14171c,
  floor: 0x262b33,
  square: 0x2c323b,
  line: 0x3b434f,
  axis: 0x5d6877,
  ambient: 1.25,
  sun: 2.2,
};

/**
 * Robot colours by motion: muted, and distinguishable in both themes and by colour-blind readers.
 */
export const MOTION_COLOURS = [0x7d9fcb, 0xdd9a63, 0x71b59b, 0xa78dcb, 0xcb7d8d, 0x9ca467];
/** Fixed and moving bodies of scenes. */
export const SCENE = 0xb5b1a8,
  SCENE_OBJECT = 0x8d8578;
export const PICKED = 0xe8364f;
export const ROBOT_CONTACT = 0xf09a1a;
export const SOURCE_CONTACT = 0x17a398;

const dark = window.matchMedia('(prefers-color-scheme: dark)');
/** Whether the reader prefers reduced motion. */
export const calm = window.matchMedia('(prefers-reduced-motion: reduce)');

export function theme() {
  return dark.matches ? DARK : LIGHT;
}

/** Calls back when the colour scheme changes. */
export function onThemeChange(callback) {
  dark.addEventListener('change', callback);
}

export function motionColour(index) {
  return MOTION_COLOURS[index % MOTION_COLOURS.length];
}

export function cssColour(colour) {
  return '#' + colour.toString(16).padStart(6, '0');
}
