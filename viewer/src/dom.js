/**
 * Creates an element without parsing markup, so that text from files stays text.
 * @param {string} tag
 * @param {object} [properties]  attributes; also `class`, `text`, `on` (listeners) and booleans
 * @param {...(Node|string)} children
 */
export function el(tag, properties = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined || value === null || value === false) continue;
    if (name === 'text') node.textContent = value;
    else if (name === 'on')
      for (const [type, listener] of Object.entries(value)) node.addEventListener(type, listener);
    else node.setAttribute(name, value === true ? '' : value);
  }
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

export const byId = (id) => document.getElementById(id);

/** Creates an icon from its path in a 16 x 16 box. */
export function icon(path) {
  const space = 'http://www.w3.org/2000/svg';
  const svg = document.createElementNS(space, 'svg');
  svg.setAttribute('viewBox', '0 0 16 16');
  svg.setAttribute('aria-hidden', 'true');
  const shape = document.createElementNS(space, 'path');
  shape.setAttribute('d', path);
  svg.append(shape);
  return svg;
}

/** Formats a number with three significant digits, without an exponent if possible. */
export function numberText(value, digits = 3) {
  if (!Number.isFinite(value)) return '\u2013';
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-4 || size >= 1e6)) return value.toExponential(1);
  const decimals = size === 0 ? 0 : Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return value
    .toFixed(Math.min(5, decimals))
    .replace(/(\.\d*?)0+$/, '$1')
    .replace(/\.$/, '')
    .replace('-', '\u2212');
}

export function seconds(time, digits = 2) {
  return `${time.toFixed(digits)}\u202fs`;
}

/** A choice between exclusive options, as a row of buttons. */
export class Choice {
  /** @param {string} name  @param {[value: string, text: string, title?: string][]} options */
  constructor(name, options, value, onChange) {
    this.onChange = onChange;
    this.buttons = new Map();
    this.element = el('div', { class: 'group', role: 'radiogroup', 'aria-label': name });
    this.element.append(el('span', { class: 'name', 'aria-hidden': 'true', text: name }));
    for (const [key, text, title] of options) {
      const button = el('button', {
        type: 'button',
        role: 'radio',
        text,
        title,
        on: { click: () => this.choose(key) },
      });
      this.buttons.set(key, button);
      this.element.append(button);
    }
    this.element.addEventListener('keydown', (event) => this.move(event));
    this.show(value);
  }

  // Arrow keys move within a group of radio buttons.
  move(event) {
    const by = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!by) return;
    event.preventDefault();
    event.stopPropagation();
    const keys = [...this.buttons.keys()];
    const next = keys[(keys.indexOf(this.value) + by + keys.length) % keys.length];
    this.choose(next);
    this.buttons.get(next).focus();
  }

  show(value) {
    this.value = value;
    for (const [key, button] of this.buttons) {
      button.setAttribute('aria-checked', String(key === value));
      button.tabIndex = key === value ? 0 : -1;
    }
  }

  choose(value) {
    this.show(value);
    this.onChange(value);
  }
}

/** A button with an on and an off state. */
export function toggle(text, pressed, onChange, title) {
  const button = el('button', { type: 'button', text, title, 'aria-pressed': String(pressed) });
  button.addEventListener('click', () => {
    const on = button.getAttribute('aria-pressed') !== 'true';
    button.setAttribute('aria-pressed', String(on));
    onChange(on);
  });
  return button;
}
