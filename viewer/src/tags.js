import { byId, el } from './dom.js';
import { cssColour } from './theme.js';

/**
 * Name tags below the figures. They are hidden from screen readers, because the panels repeat them.
 */
export class Tags {
  /** @param {import('./world.js').World} world */
  constructor(world) {
    this.world = world;
    this.nodes = [];
  }

  update() {
    const tags = this.world.tags();
    while (this.nodes.length < tags.length) {
      const dot = el('span', { class: 'dot' }),
        text = document.createTextNode('');
      const node = el('div', { class: 'tag' }, dot, text);
      byId('tags').append(node);
      this.nodes.push({ node, dot, text });
    }
    this.nodes.forEach(({ node, dot, text }, i) => {
      const tag = tags[i];
      node.hidden = !tag?.visible;
      if (node.hidden) return;
      if (text.data !== tag.text) {
        text.data = tag.text;
        dot.hidden = tag.colour === null;
        if (tag.colour !== null) dot.style.background = cssColour(tag.colour);
      }
      node.style.transform = `translate(${tag.x.toFixed(1)}px, ${tag.y.toFixed(1)}px) translate(-50%, 0)`;
    });
  }
}
