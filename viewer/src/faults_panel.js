import { el, numberText, seconds } from './dom.js';
import { KINDS, countText, totalsByKind } from './timeline.js';

/** Lists the worst faults by kind; each links to its worst frame. */
export class FaultsPanel {
  constructor(motions, onFault) {
    this.items = motions.flatMap((motion) =>
      (motion.report?.faults ?? []).map((fault) => ({ fault, motion })),
    );
    this.many = motions.length > 1;
    this.kind = null;
    this.list = el('ul', { class: 'list' });
    const totals = totalsByKind(motions);
    this.total = [...totals.values()].reduce((sum, count) => sum + count, 0);
    const kinds = [...KINDS].filter(([kind]) => this.items.some(({ fault }) => fault.kind === kind));
    this.chips = [[null, 'All'], ...kinds].map(([kind, name]) => {
      const count = this.items.filter(({ fault }) => kind === null || fault.kind === kind).length;
      const chip = el(
        'button',
        { type: 'button', 'aria-pressed': String(kind === null) },
        kind === null ? null : el('span', { class: `dot ${kind}` }),
        `${name} ${countText(count, kind === null ? this.total : totals.get(kind))}`,
      );
      chip.addEventListener('click', () => this.filter(kind));
      return { kind, chip };
    });
    this.element =
      this.items.length === 0
        ? el('p', { class: 'quiet', text: 'No faults.' })
        : el(
            'div',
            {},
            el(
              'div',
              { class: 'chips', role: 'group', 'aria-label': 'Kinds of faults' },
              ...this.chips.map(({ chip }) => chip),
            ),
            this.list,
          );
    this.buttons = this.items.map(({ fault, motion }) => {
      const last = Math.max(fault.begin, fault.end - 1);
      const frames =
        last > fault.begin
          ? `frames ${fault.begin}\u2013${last}, worst ${fault.worst}`
          : `frame ${fault.begin}`;
      const button = el(
        'button',
        { type: 'button', title: fault.metric, on: { click: () => onFault(fault, motion) } },
        el('span', { class: `dot ${fault.kind}`, 'aria-hidden': 'true' }),
        el(
          'span',
          { class: 'where' },
          fault.where || fault.label,
          el('small', {
            text: `${fault.where ? fault.label : KINDS.get(fault.kind)} \u00b7 ${frames}${this.many ? ` \u00b7 ${motion.label}` : ''}`,
          }),
        ),
        el(
          'span',
          { class: 'number' },
          `${numberText(fault.amount)} ${fault.unit}`,
          el('small', { text: seconds(fault.worst * motion.frameTime) }),
        ),
      );
      return { fault, button, item: el('li', {}, button) };
    });
    this.filter(null);
  }

  filter(kind) {
    for (const each of this.chips) each.chip.setAttribute('aria-pressed', String(each.kind === kind));
    this.list.replaceChildren(
      ...this.buttons.filter(({ fault }) => kind === null || fault.kind === kind).map(({ item }) => item),
    );
  }

  showFault(chosen) {
    for (const { button, fault } of this.buttons) {
      if (fault === chosen) button.setAttribute('aria-current', 'true');
      else button.removeAttribute('aria-current');
    }
  }
}
