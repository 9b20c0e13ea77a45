/** Colours of the scene, light and dark; those of the rest of the page are in page.css. */

const LIGHT = {
  sky: 0xf5f6f8, floor: 0xe9ebef, square: 0xdfe3e9, line: 0xc5ccd6, axis: 0x9aa5b5,
  ambient: 1.55, sun: 2.1, shadow: 0.42,
};
const DARK = {
  sky: 0x14171c, floor: 0x262b33, square: 0x2c323b, line: 0x3b434f, axis: 0x5d6877,
  ambient: 1.0, sun: 2.3, shadow: 0.6,
};

/** Robots by motion: quiet colours that are told apart in light and dark, and by the colour-blind. */
export const MOTION_COLOURS = [0x6c8fbd, 0xd08a52, 0x63a58c, 0x9a7fc0, 0xbf6b7d, 0x8d9457];
export const HUMAN_COLOURS = { left: 0x7fb08a, right: 0xc98d80, middle: 0xb4aea4 };
export const PICKED = 0xffb02e;
export const ROBOT_CONTACT = 0xf09a1a;
export const SOURCE_CONTACT = 0x17a398;

const dark = window.matchMedia('(prefers-color-scheme: dark)');

export function theme() {
  return dark.matches ? DARK : LIGHT;
}

/** Calls back whenever the reader's preference changes. */
export function onThemeChange(callback) {
  dark.addEventListener('change', callback);
}

export function motionColour(index) {
  return MOTION_COLOURS[index % MOTION_COLOURS.length];
}

export function cssColour(colour) {
  return '#' + colour.toString(16).padStart(6, '0');
}
