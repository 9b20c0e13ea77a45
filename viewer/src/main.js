import { BodyPanel } from './body_panel.js';
import { readHeader, readTracks } from './decode.js';
import { byId, el, seconds } from './dom.js';
import { FaultsPanel } from './faults_panel.js';
import { addTestHook } from './hook.js';
import { JointsPanel } from './joints_panel.js';
import { addHelp, addKeyboard } from './keyboard.js';
import { Motion } from './motions.js';
import { PlayedPage } from './played_page.js';
import { qualityPanel, verdict } from './quality_panel.js';
import { SceneData } from './scene_figure.js';
import { SkeletonViewer, addSkeletonHook } from './skeleton_viewer.js';
import { Tabs } from './tabs.js';
import { Tags } from './tags.js';
import { onThemeChange } from './theme.js';
import { Timeline } from './timeline.js';
import { Transport } from './transport.js';
import { ViewTools } from './view_tools.js';
import { World } from './world.js';

function showHeader(page, motions) {
  byId('title').textContent = page.title;
  const robots = [
    ...new Set(
      motions.map((motion) => motion.robot.name + (motion.robot.variant ? `, ${motion.robot.variant}` : '')),
    ),
  ];
  const [first] = motions;
  // Motions that differ in length have their own frames.
  const areEqual = motions.every(({ frames, fps }) => frames === first.frames && fps === first.fps);
  const frames = `${first.frames} ${first.frames === 1 ? 'frame' : 'frames'} at ${Number(first.fps.toFixed(3))} fps`;
  byId('subtitle').textContent = [
    robots.join(', '),
    seconds(Math.max(...motions.map((motion) => motion.duration))),
    areEqual ? frames : `${motions.length} motions`,
  ].join(' \u00b7 ');
  const resampled = motions.filter((motion) => motion.data.file_rate);
  if (resampled.length > 0) {
    const rates = resampled.map(({ label, data }) => {
      const rate = Number((data.file_rate[0] / data.file_rate[1]).toFixed(3));
      return `${motions.length > 1 ? `${label}: ` : ''}resampled from ${rate} fps`;
    });
    byId('subtitle').append(` \u00b7 ${rates.join(', ')}`);
  }
  for (const motion of motions) {
    if (!motion.report) continue;
    const { state, text } = verdict(motion);
    byId('verdicts').append(
      el('span', {
        class: `verdict ${state}`,
        text: (motions.length > 1 ? `${motion.label}: ` : '') + text,
      }),
    );
  }
}

/** Links back to a gallery and to the adjacent clips. */
function addLinks({ index, previous, next }) {
  const link = (href, text, label) =>
    href && el('a', { href, text, 'aria-label': label, title: label, class: 'clip-link' });
  byId('title').before(
    ...[
      link(index, '\u2190 All', 'Back to all clips'),
      link(previous, '[', 'Previous clip ([)'),
      link(next, ']', 'Next clip (])'),
    ].filter(Boolean),
  );
}

/** The viewer: creates the parts and connects them. */
class Viewer extends PlayedPage {
  constructor(page, tracks) {
    const motions = page.motions.map((data, index) => new Motion(data, index, page, tracks));
    super(
      Math.max(...motions.map((motion) => motion.duration)),
      Math.min(...motions.map((motion) => motion.frameTime)),
    );
    this.motions = motions;
    const scenes = (page.scenes ?? []).map((scene) => new SceneData(scene, tracks));
    this.world = new World(this.motions, this.stage, page.figure, scenes);
    this.tags = new Tags(this.world);
    showHeader(page, this.motions);
    this.links = page.links ?? null;
    if (this.links) addLinks(this.links);
    this.addControls(page);
    this.world.update(0);
    this.stage.frame();
    onThemeChange(() => this.joints.redraw());
    this.addPicking();
    this.start();
  }

  addControls(page) {
    const { player, motions } = this;
    const onFault = (fault, motion) => this.goToFault(fault, motion);
    this.transport = new Transport(player);
    this.timeline = new Timeline(player, motions, onFault);
    this.tools = new ViewTools(this.world, this.stage, this.redraw);
    this.faults = new FaultsPanel(motions, onFault);
    this.joints = new JointsPanel(player, motions);
    this.body = new BodyPanel(
      player,
      motions,
      (motion, body) => this.pick(motion, body),
      (name) => {
        if (name !== null) this.joints.add(name);
        this.tabs.show('joints');
      },
    );
    this.tabs = new Tabs(
      byId('panel'),
      [
        ['quality', 'Quality', qualityPanel(motions)],
        ['faults', `Faults ${this.faults.total}`, this.faults.element],
        ['joints', 'Plots', this.joints.element],
        ['body', 'Body', this.body.element],
      ],
      () => {
        this.joints?.showTime();
        this.body?.showTime();
      },
    );
    const { joint, root_m: root, bone_m: bone, error_cm: cm, error_deg: degrees } = page.precision;
    this.help = addHelp([
      'Drag to rotate, scroll to zoom, drag with the right button to pan; click a body to select it. ' +
        'While the 3D view has the focus (Tab), arrow keys rotate it, and \u2212 and + zoom. ' +
        'A link that ends in #t=12.3 opens the page at 12.3 seconds.',
      `Maximum rounding errors on this page: joints ${joint} rad, root ${root * 1000} mm, ` +
        `bones ${bone * 1000} mm, tracking errors ${cm} cm and ${degrees}\u00b0. Written by ${page.tool}.`,
    ]);
    this.addKeys();
  }

  addKeys() {
    const { tools } = this;
    addKeyboard({
      ...this.playerKeys(this.transport),
      '[': () => this.previousOrNext(-1),
      ']': () => this.previousOrNext(1),
      n: () => this.nextFault(1),
      p: () => this.nextFault(-1),
      f: () => tools.setCamera(this.stage.mode === 'follow' ? 'stand' : 'follow'),
      r: () => tools.reset(),
      h: () => tools.nextHuman(),
      '?': () => this.help(),
    });
  }

  // Goes to the adjacent clip of a gallery, or to the adjacent fault without a gallery.
  previousOrNext(by) {
    if (!this.links) return this.nextFault(by);
    const address = by < 0 ? this.links.previous : this.links.next;
    if (address) window.location.href = address;
  }

  goToFault(fault, motion) {
    this.player.pause();
    this.player.seek(fault.worst * motion.frameTime);
    this.timeline.showFault(fault);
    this.faults.showFault(fault);
    this.fault = fault;
    if (fault.joint !== undefined) this.joints.add(motion.robot.joints[fault.joint].name);
    this.pick(motion.index, fault.bodies[0] ?? null, fault.bodies, false);
  }

  // Goes to the next fault after the current time, ordered by worst frame.
  nextFault(by) {
    const items = [...this.faults.items].sort(
      (a, b) => a.fault.worst * a.motion.frameTime - b.fault.worst * b.motion.frameTime,
    );
    if (items.length === 0) return;
    const now = this.player.time;
    const time = ({ fault, motion }) => fault.worst * motion.frameTime;
    const at = items.findIndex(({ fault }) => fault === this.fault);
    let next;
    if (at >= 0 && Math.abs(time(items[at]) - now) < 1e-6) {
      next = items[(at + by + items.length) % items.length];
    } else {
      next =
        by > 0
          ? (items.find((each) => time(each) > now) ?? items[0])
          : (items.findLast((each) => time(each) < now) ?? items.at(-1));
    }
    this.goToFault(next.fault, next.motion);
  }

  /** Picks a body; null deselects. */
  pick(motion, body, bodies = body === null ? [] : [body], show = true) {
    this.picked = body === null ? null : { motion, body };
    // A fault marks only its own motion, a chosen body all motions of its robot.
    this.world.highlight(motion, bodies, !show);
    this.body.show(body === null ? null : motion, body);
    this.joints.showBody(body === null ? null : this.motions[motion].robot.bodies[body].name);
    if (show && body !== null) this.tabs.show('body');
    this.redraw();
  }

  addPicking() {
    const canvas = byId('canvas');
    let down = null;
    canvas.addEventListener('pointerdown', (event) => {
      down = [event.clientX, event.clientY];
    });
    canvas.addEventListener('pointerup', (event) => {
      // A drag rotates the camera and picks nothing.
      if (!down || event.button !== 0 || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 5)
        return;
      const hit = this.world.pick(event.clientX, event.clientY);
      this.pick(hit?.motion ?? 0, hit?.body ?? null);
    });
  }

  update() {
    this.world.update(this.player.time);
  }

  updateTags() {
    this.tags.update();
  }
}

async function main() {
  const message = byId('message');
  try {
    const page = await readHeader();
    const tracks = await readTracks(page.tracks);
    if (page.skeleton) {
      addSkeletonHook(new SkeletonViewer(page, tracks));
      return;
    }
    addTestHook(new Viewer(page, tracks));
  } catch (error) {
    // There is no WebGL, or the browser lacks DecompressionStream.
    message.textContent = `This browser cannot show the motion: ${error.message}`;
    console.error(error);
  }
}

main();
