// The page: connects the program, the scene, the picture, the hand and the panels.

import { Eye } from './eye.js';
import { Hand } from './hand.js';
import { add, length, perspective, scale, sub } from './maths.js';
import { Paint } from './paint.js';
import { Panel } from './panel.js';
import { Scene } from './scene.js';
import { Socket } from './socket.js';

const canvas = document.getElementById('canvas');
const look = { overlay: 'light', curve: 'none', stops: 0, selected: new Set() };
const scene = new Scene();
const eye = new Eye();
const paint = new Paint(canvas);
let [isStale, camera, waiting, pending] = [true, null, null, null];
// For tests, and for the curious: when messages were sent, and when what they changed was drawn.
const times = { sent: new Map(), drawn: [], updates: [], opened: performance.now(), first: null };

// The true picture that is laid over the view when it rests, if that is wanted.
const still = { image: document.getElementById('still'), wanted: false, order: 0, timer: 0 };

/** Lets the view be drawn again, and the true picture be asked for when nothing changes for a while. */
function stale() {
  isStale = true;
  still.image.hidden = true;
  still.order += 1;
  clearTimeout(still.timer);
  if (still.wanted) still.timer = setTimeout(rest, 700);
}

async function rest() {
  const { values } = scene;
  if (!values || values.plays || values.coarse || hand.pointers.size || look.overlay !== 'light') return;
  const { order } = still;
  const png = await ask({ do: 'render', ...view() });
  if (!png || order !== still.order) return;
  URL.revokeObjectURL(still.image.src);
  still.image.src = URL.createObjectURL(new Blob([png], { type: 'image/png' }));
  still.image.hidden = false;
}

const socket = new Socket({
  scene(about) {
    const isNew = !scene.about;
    scene.take(about);
    if (isNew) {
      Object.assign(look, { stops: about.stops, curve: about.curve });
      if (about.cameras.length) camera = 0;
      else if (about.view) eye.look(about.view, 0.6 * length(sub(about.bounds[1], about.bounds[0])));
    }
    panel.takeScene(about);
    paint.takePictures(about.textures).then(stale);
  },
  mesh(mesh) {
    scene.takeMesh(mesh);
    paint.takeMesh(mesh);
  },
  state(state) {
    scene.takeCorners(state.corners);
    paint.takeState(state);
  },
  account(account, bytes) {
    scene.values = account;
    times.updates.push(performance.now());
    if (times.updates.length > 200) times.updates.shift();
    for (const [id, at] of times.sent) {
      if (id <= account.heard) {
        times.drawn.push(performance.now() - at);
        times.sent.delete(id);
      }
    }
    if (waiting !== null && account.heard >= waiting) release();
    if (camera !== null && account.cameras[camera]) {
      eye.look(account.cameras[camera], 0.3 * length(sub(scene.about.bounds[1], scene.about.bounds[0])));
    }
    const recent = times.updates.filter((at) => at > performance.now() - 1000).length;
    panel.takeAccount(account, bytes, recent > 1 ? recent : 0);
    if (times.first === null) {
      times.first = performance.now() - times.opened;
      panel.tell('click to pick, drag to look around or to move what is picked');
    }
    stale();
  },
  opening: (told) => panel.tell(`${told}…`),
  error: (told) => { release(); panel.tell(told, true); },
  rendered: ({ ms }) => panel.tell(`rendered in ${(ms / 1000).toFixed(2)} s`),
  closed: () => panel.tell('the program has ended: start sweeplight view again', true),
});

/** Sends a message of a moving hand when the one before has been heard: the latest wins. */
function stream(message) {
  if (waiting !== null) {
    pending = message;
    return;
  }
  waiting = socket.send(message);
  times.sent.set(waiting, performance.now());
}

function release() {
  waiting = null;
  const next = pending;
  pending = null;
  if (next) stream(next);
}

/** Sends a message, and shows what was wrong with it. */
function ask(message) {
  return socket.ask(message).catch((error) => panel.tell(error.message, true));
}

function step(edits, gesture) {
  if (gesture) stream({ do: 'step', edits, gesture });
  else socket.send({ do: 'step', edits });
}

function save(address, name) {
  Object.assign(document.createElement('a'), { href: address, download: name }).click();
}

const floor = (from) => {
  const hit = scene.about && scene.values ? scene.pick(add(from, [0, 0.1, 0]), [0, -1, 0]) : null;
  return hit ? hit.place[1] : null;
};

const panel = new Panel(scene, {
  step,
  look(change) { Object.assign(look, change); stale(); },
  camera(value) { camera = value === '' ? null : Number(value); if (scene.values) this.again(); },
  again() {
    const seen = camera === null ? null : scene.values.cameras[camera];
    if (seen) eye.look(seen, 0.3 * length(sub(scene.about.bounds[1], scene.about.bounds[0])));
    stale();
  },
  still(on) { still.wanted = on; stale(); },
  walk(on) { eye.walks = on; free(); if (on) eye.stand(floor); stale(); },
  play: (on) => socket.send({ do: 'play', on }),
  seek: (seconds) => stream({ do: 'seek', seconds }),
  undo: () => socket.send({ do: 'undo' }),
  turn: (node, turn, gesture) => stream({
    do: 'place', node: scene.about.nodes[node].number, turn, about: middleOf(node, gesture), gesture,
  }),
  select: (node) => hand.select(node),
  add: (file) => file && step([{ add: { file } }]),
  async render() {
    panel.tell('renders this view…');
    const png = await ask({ do: 'render', ...view() });
    if (png) panel.show(URL.createObjectURL(new Blob([png], { type: 'image/png' })), `${scene.about.name}.png`);
  },
  async lines() {
    const answer = await ask({ do: 'lines' });
    if (answer) save(URL.createObjectURL(new Blob([answer.lines])), `${scene.about.name}.jsonl`);
  },
  async verify() {
    panel.tell('traces and solves this state from nothing…');
    const answer = await ask({ do: 'verify' });
    if (!answer) return;
    const { differ, difference, seconds } = answer.verified;
    panel.tell(`${answer.holds ? 'holds' : 'FAILS'}: ${differ} samples differ, radiosity within ${difference.toExponential(1)}; `
      + `from nothing ${(1000 * seconds).toFixed(0)} ms`, !answer.holds);
  },
});

/** The point that a node turns about in a gesture: the middle that it had when the gesture began. */
const pivots = new Map();
function middleOf(node, gesture) {
  if (!pivots.has(gesture)) pivots.set(gesture, scene.middle(node));
  return pivots.get(gesture);
}

/** What `render` is asked for: this view, in pixels of the page. */
function view() {
  const { forward } = eye;
  const size = [canvas.width, canvas.height].map((pixels) => Math.min(3840, Math.max(1, pixels)));
  const at = add(eye.eye, scale(forward, 1));
  return { eye: eye.eye, at, degrees: (eye.yfov * 180) / Math.PI, size, stops: look.stops, curve: look.curve };
}

/** Lets go of the camera of the file. */
function free() {
  camera = null;
  document.getElementById('camera').value = '';
}

const hand = new Hand(canvas, scene, eye, {
  moved() { if (!hand.drag) free(); stale(); },
  selected(node) {
    look.selected = new Set(node === null ? [] : scene.below(node));
    panel.select(node);
    stale();
  },
  carried(node, by, gesture) {
    stream({ do: 'place', node: scene.about.nodes[node].number, by, gesture });
  },
});

addEventListener('keydown', (event) => {
  if (event.target.matches('input, select')) return;
  if ((event.ctrlKey || event.metaKey) && event.code === 'KeyZ') socket.send({ do: 'undo' });
  else if (event.code === 'Escape') hand.select(null);
  else if (event.code === 'Space') { event.preventDefault(); socket.send({ do: 'play', on: !scene.values?.plays }); }
  else eye.keys.add(event.code);
});
addEventListener('keyup', (event) => eye.keys.delete(event.code));
addEventListener('blur', () => eye.keys.clear());
addEventListener('resize', stale);

let last = performance.now();
function frame(now) {
  const seconds = Math.min(0.1, (now - last) / 1000);
  last = now;
  if (eye.keys.size && eye.step(seconds, floor)) {
    free();
    stale();
  }
  if (isStale) {
    isStale = false;
    const ratio = Math.min(2, devicePixelRatio || 1);
    canvas.width = Math.round(canvas.clientWidth * ratio);
    canvas.height = Math.round(canvas.clientHeight * ratio);
    const far = scene.about ? 4 * length(sub(scene.about.bounds[1], scene.about.bounds[0])) + length(sub(eye.eye, eye.at)) : 100;
    paint.draw(scene, perspective(eye.eye, eye.forward, eye.yfov, canvas.width / canvas.height, far / 20000, far), look);
  }
  requestAnimationFrame(frame);
}
requestAnimationFrame(frame);

globalThis.sweeplight = { scene, eye, look, paint, hand, panel, socket, times, view, still };
