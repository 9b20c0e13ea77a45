import { Choice, byId, el, toggle } from './dom.js';

/** Camera mode. @param owner  has setCamera(mode)  @param {string} mode  initial mode */
export function cameraChoice(owner, mode) {
  return new Choice(
    'Camera',
    [
      ['follow', 'Follow', 'The camera follows the robot (F)'],
      ['orbit', 'Orbit', 'The camera follows and orbits the robot'],
      ['stand', 'Fixed', 'The camera does not move (F)'],
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
    title: 'Reset the camera (R)',
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
              'Show meshes or collision shapes',
            )
          : null,
        world.hasScenes
          ? toggle(
              'Scene',
              true,
              (on) => this.apply(() => world.setScenesVisible(on)),
              'Show the bodies of the scene',
            )
          : null,
        toggle(
          'Paths',
          true,
          (on) => this.apply(() => world.setPathsVisible(on)),
          'Show the paths of root and feet',
        ),
        toggle(
          'Contacts',
          true,
          (on) => this.apply(() => world.setContactsVisible(on)),
          'Mark feet in contact: the human\u2019s green, the robot\u2019s orange',
        ),
      ),
    );
  }

  humanGroup() {
    const { world } = this;
    this.human = new Choice(
      'Human',
      [
        ['beside', 'Beside', 'Scaled to the robot, beside it (H)'],
        ['over', 'Over', 'Scaled to the robot, at the same position (H)'],
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
      'aria-label': 'Distance between human and robot',
      title: 'Distance between human and robot',
    });
    this.distance.addEventListener('input', () =>
      this.apply(() => world.setHumanDistance(Number(this.distance.value))),
    );
    const each = world.sharesSource
      ? el(
          'div',
          { class: 'group' },
          toggle(
            'Per robot',
            false,
            (on) => this.apply(() => world.setBesideEach(on)),
            'Show the common source of several motions beside each robot, or once',
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
