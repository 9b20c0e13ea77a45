import { Choice, byId, el, toggle } from './dom.js';

/** Camera mode. @param owner  has setCamera(mode)  @param {string} mode  initial mode */
export function cameraChoice(owner, mode) {
  return new Choice(
    'Camera',
    [
      ['follow', 'Follow', 'The camera goes along (F)'],
      ['orbit', 'Orbit', 'It goes along and turns'],
      ['stand', 'Stand', 'It stays where it is (F)'],
    ],
    mode,
    (chosen) => owner.setCamera(chosen),
  );
}

/** A separate button next to the camera choice. @param owner  has reset() */
export function resetButton(owner) {
  const reset = el('button', {
    type: 'button',
    text: 'Reset',
    title: 'Camera back to where it was (R)',
    on: { click: () => owner.reset() },
  });
  return el('div', { class: 'group' }, reset);
}

/** The toolbar above the picture: camera, human, optional objects. */
export class ViewTools {
  /** @param {import('./world.js').World} world  @param {import('./stage.js').Stage} stage */
  constructor(world, stage, redraw) {
    this.world = world;
    this.stage = stage;
    this.redraw = redraw;
    this.camera = cameraChoice(this, stage.mode);
    byId('view-tools').append(this.camera.element, resetButton(this));
    if (world.humans.length > 0) byId('view-tools').append(...this.humanGroup());
    byId('view-tools').append(
      el(
        'div',
        { class: 'group' },
        world.hasMeshes
          ? toggle(
              'Meshes',
              true,
              (on) => this.apply(() => world.setMeshesVisible(on)),
              'Meshes, or the shapes that collide',
            )
          : null,
        world.hasScenes
          ? toggle(
              'Scene',
              true,
              (on) => this.apply(() => world.setScenesVisible(on)),
              'Bodies around the robot and the human',
            )
          : null,
        toggle(
          'Paths',
          true,
          (on) => this.apply(() => world.setPathsVisible(on)),
          'The ways of root and feet',
        ),
        toggle(
          'Contacts',
          true,
          (on) => this.apply(() => world.setContactsVisible(on)),
          'Feet are marked while they stand: the human\u2019s green, the robot\u2019s orange',
        ),
      ),
    );
  }

  humanGroup() {
    const { world } = this;
    this.human = new Choice(
      'Human',
      [
        ['beside', 'Beside', 'At the robot\u2019s size, beside it (H)'],
        ['over', 'Over', 'At the robot\u2019s size, where the robot is (H)'],
        ['off', 'Off'],
      ],
      world.humanMode,
      (mode) => this.setHuman(mode),
    );
    this.distance = el('input', {
      type: 'range',
      min: 0.3,
      max: 3,
      step: 0.05,
      value: world.humanDistance,
      'aria-label': 'Distance of the human',
      title: 'Distance of the human',
    });
    this.distance.addEventListener('input', () =>
      this.apply(() => world.setHumanDistance(Number(this.distance.value))),
    );
    const each = world.sharesSource
      ? el(
          'div',
          { class: 'group' },
          toggle(
            'For each',
            false,
            (on) => this.apply(() => world.setBesideEach(on)),
            'The source of several motions with each of them, or once',
          ),
        )
      : null;
    return [this.human.element, el('div', { class: 'group' }, this.distance), each].filter(Boolean);
  }

  apply(change) {
    change();
    this.redraw();
  }

  setCamera(mode) {
    this.camera.show(mode);
    this.apply(() => this.stage.setMode(mode));
  }

  setHuman(mode) {
    this.human?.show(mode);
    if (this.distance) this.distance.parentElement.hidden = mode !== 'beside';
    this.apply(() => this.world.setHumanMode(mode));
  }

  nextHuman() {
    if (!this.human) return;
    this.setHuman({ beside: 'over', over: 'off', off: 'beside' }[this.world.humanMode]);
  }

  reset() {
    this.apply(() => {
      if (this.stage.mode === 'orbit') this.setCamera('follow');
      this.stage.frame();
    });
  }
}
