import { el } from './dom.js';

/** Panels of which one is visible, following the ARIA practices: arrow keys move between tabs. */
export class Tabs {
  /** @param {HTMLElement} parent  @param {[id: string, name: string, content: HTMLElement][]} tabs */
  constructor(parent, tabs, onShow) {
    this.onShow = onShow;
    this.list = el('div', { role: 'tablist', 'aria-label': 'Information about the motions' });
    this.tabs = tabs.map(([id, name, content]) => {
      const panel = el(
        'div',
        { role: 'tabpanel', id: `panel-${id}`, 'aria-labelledby': `tab-${id}`, tabindex: 0 },
        content,
      );
      const tab = el('button', {
        type: 'button',
        role: 'tab',
        id: `tab-${id}`,
        'aria-controls': panel.id,
        text: name,
        on: { click: () => this.show(id) },
      });
      this.list.append(tab);
      return { id, tab, panel };
    });
    this.list.addEventListener('keydown', (event) => this.move(event));
    parent.append(this.list, ...this.tabs.map(({ panel }) => panel));
    this.show(tabs[0][0]);
  }

  move(event) {
    const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!by) return;
    event.preventDefault();
    event.stopPropagation();
    const now = this.tabs.findIndex(({ id }) => id === this.shown);
    const next = this.tabs[(now + by + this.tabs.length) % this.tabs.length];
    this.show(next.id);
    next.tab.focus();
  }

  show(shown) {
    this.shown = shown;
    for (const { id, tab, panel } of this.tabs) {
      tab.setAttribute('aria-selected', String(id === shown));
      tab.tabIndex = id === shown ? 0 : -1;
      panel.hidden = id !== shown;
    }
    this.onShow?.(shown);
  }
}
