// SPDX-License-Identifier: Apache-2.0
// The page: turns input into requests, one at a time, and shows the answers.
import {Connection} from '/connection.js';
import {TransferEditor, colourIn, hexOf} from '/editor.js';
import {colourOf, drawBoxes} from '/overlay.js';

const rest_ms = 150;       // time after the last move until the image at rest is requested
const rest_wait_ms = 500;  // from this interval between time steps on, each gets an image at rest
const most_side = 4096;    // largest side of an image, as in the program
const most_zoom = 1000;    // of one request, as in the program
const wheel_step = 1.0015; // zoom factor for one unit of the wheel's delta

const element = id => document.getElementById(id);
const viewport = element('viewport'), image = element('image'), boxes = element('boxes');

let volume = null;         // the volume's description; null: none yet
let asked = {};            // merged input since the last request
let asked_at = null;       // time of the first input since then
let on_its_way = null;     // {sequence, since, settings} of the only request in flight
let moving = false, rest_timer = 0;
let took_ms = null;
let sequence = 0;
let shown = null, ranks = [];
let plays = false, next_step_timer = 0;
const rate = [];           // arrival times of the images of the last second

// ---- requests

// The settings of the view, for a page that is reloaded or a connection that is re-established.
function remembered() {
  return JSON.parse(sessionStorage.getItem('view') ?? 'null');
}
function remember(part) {
  sessionStorage.setItem('view', JSON.stringify({...remembered(), ...part}));
}

function ask(part, moves) {
  asked_at ??= performance.now();
  if (part.rotate && asked.rotate) {
    // The drags follow each other, though the second may begin elsewhere.
    const [from, to] = asked.rotate, [next_from, next_to] = part.rotate;
    part.rotate = [from, to.map((value, k) => value + next_to[k] - next_from[k])];
  }
  if (part.pan && asked.pan) part.pan = part.pan.map((value, k) => value + asked.pan[k]);
  if (part.zoom && asked.zoom) part.zoom.by *= asked.zoom.by;
  if (part.zoom) part.zoom.by = Math.min(most_zoom, Math.max(1 / most_zoom, part.zoom.by));
  asked = {...asked, ...part};
  moving = moves;
  clearTimeout(rest_timer);
  // While a series plays, the next time step follows instead of the same one at rest.
  if (moves && !(plays && wait_ms() < rest_wait_ms)) rest_timer = setTimeout(() => ask({}, false), rest_ms);
  send();
  tellWhetherBusy();
}

// For programs that observe the page.
function tellWhetherBusy() {
  document.documentElement.dataset.busy = on_its_way || asked_at !== null || moving ? 'yes' : 'no';
}

function send() {
  if (on_its_way || asked_at === null || !volume) return;
  const message = {...asked, sequence: ++sequence, still: !moving};
  if (took_ms !== null) message.took_ms = took_ms;
  if (!connection.send(message)) return;
  const {table, volume: shows, surfaces, light, step, lossless, time_step} = message;
  const settings = JSON.parse(JSON.stringify({table, volume: shows, surfaces, light, step, lossless, time_step}));
  on_its_way = {sequence, since: asked_at, settings};
  asked = {};
  asked_at = null;
  took_ms = null;
}

// The request in flight will not be answered; its settings are part of the next one.
function withdraw() {
  if (on_its_way) asked = {...on_its_way.settings, ...asked};
  on_its_way = null;
}

async function show(head, bytes) {
  const bitmap = await createImageBitmap(new Blob([bytes], {type: 'image/' + head.format}));
  if (image.width !== bitmap.width || image.height !== bitmap.height) {
    image.width = bitmap.width;
    image.height = bitmap.height;
  }
  image.getContext('2d').drawImage(bitmap, 0, 0);
  bitmap.close();
  shown = head;
  // Settings that were refused are not sent again after a reload.
  if (on_its_way?.sequence === head.sequence) remember(on_its_way.settings);
  remember({camera: head.camera});
  tellTime();
  overlay();
  answered(head.sequence);
  const now = performance.now();
  rate.push(now);
  while (rate[0] < now - 1000) rate.shift();
  const ms = head.ms, whole = head.still ? '' : `, ${rate.length} images per second`;
  element('frame').textContent = `${head.width} × ${head.height} ${head.format === 'png' ? 'lossless' : 'as JPEG'}: ` +
    `${last_ms.toFixed(0)} ms from input to image (cast ${ms.render.toFixed(1)}, composite ${ms.composite.toFixed(1)}, ` +
    `pack ${ms.pack.toFixed(1)})${whole}`;
  if (!head.still) element('exactness').textContent = '';
  document.documentElement.dataset.shown = `${head.sequence} ${head.still ? 'still' : 'moving'}`;
}

let last_ms = 0;
function answered(number) {
  if (!on_its_way || number < on_its_way.sequence) return;
  last_ms = performance.now() - on_its_way.since;
  took_ms = Math.max(0, last_ms - (shown?.ms.load ?? 0));
  on_its_way = null;
  playOn();
  send();
  tellWhetherBusy();
}

// ---- messages of the program

function hear(message) {
  if (message.kind === 'status') {
    if (message.state !== 'ready') withdraw();
    banner(message.state === 'ready' ? null : message.text, message.state === 'loading' ? message.done : null);
  } else if (message.kind === 'volume') {
    begin(message);
  } else if (message.kind === 'figures') {
    ranks = message.ranks;
    showRanks();
    overlay();
    element('exactness').textContent = message.error === undefined ? '' :
      `largest error ${message.error.toFixed(4)} against the integral, of ${message.rays} rays`;
    document.documentElement.dataset.figures = message.sequence;
  } else if (message.kind === 'impossible') {
    element('exactness').textContent = message.text;
    play(false);
    // Of a message that cannot be read, the program does not know the number; only one is in flight.
    if (on_its_way) answered(on_its_way.sequence);
  }
}

function begin(message) {
  volume = message;
  withdraw();
  document.title = `${message.name} · Understudy`;
  element('name').textContent = message.name;
  element('about').textContent = `${message.size.join(' × ')} of ${message.type}, ${number(message.low)} to ` +
    `${number(message.high)}, ` +
    (message.nodes ? `${message.nodes} node${message.nodes > 1 ? 's' : ''}` : 'in one process');
  element('low').textContent = number(message.low);
  element('high').textContent = number(message.high);
  const {rotate, pan, zoom, ...pending} = asked;
  const before = {...remembered(), ...pending};
  editor.showHistogram(message.histogram, message.low, message.high);
  editor.show(before.table?.knots ?? message.table);
  element('tables').replaceChildren(...Object.entries(message.tables).map(([name, points]) => {
    const button = document.createElement('button');
    button.type = 'button';
    button.textContent = name;
    button.onclick = () => { editor.show(points); ask({table: {knots: editor.points}}, false); };
    return button;
  }));
  element('shows-volume').checked = before.volume ?? message.volume;
  const surface = (before.surfaces ?? message.surfaces)[0];
  element('shows-surface').checked = Boolean(surface);
  if (surface) {
    element('surface-at').value = surface.at;
    element('surface-colour').value = hexOf(surface.colour);
    element('surface-opacity').value = surface.opacity;
  }
  element('light').checked = before.light ?? message.light;
  element('step').value = before.step ?? message.step;
  element('lossless').checked = before.lossless ?? false;
  element('time').hidden = message.time_steps < 2;
  element('time-step').max = message.time_steps - 1;
  if (!(before.time_step < message.time_steps)) delete before.time_step;
  element('time-step').value = before.time_step ?? message.time_step;
  tellControls();
  ask({...before, size: sizeOf(viewport)}, false);
}

function banner(text, part) {
  element('banner').hidden = text === null;
  element('banner').classList.toggle('quiet', part !== null);
  element('banner-text').textContent = text ?? '';
  element('banner-progress').hidden = part === null;
  if (part !== null) element('banner-progress').value = part;
}

function number(value) {
  return Number.isInteger(value) ? String(value) : value.toPrecision(4);
}

function showRanks() {
  const slowest = Math.max(...ranks.map(rank => rank.ms), 1e-9);
  const most = Math.max(...ranks.map(rank => rank.samples), 1);
  element('ranks').replaceChildren(...ranks.map((rank, i) => {
    const row = document.createElement('div');
    row.className = 'rank';
    row.title = `${(rank.bytes / 2 ** 20).toFixed(1)} MiB of bricks, ${rank.samples} samples`;
    const swatch = document.createElement('i');
    swatch.style.background = colourOf(i);
    const name = document.createElement('span');
    name.textContent = String(i);
    const bars = document.createElement('span');
    bars.className = 'bars';
    for (const part of [rank.ms / slowest, rank.samples / most]) {
      const bar = document.createElement('b');
      bar.style.width = `${100 * part}%`;
      bars.append(bar);
    }
    const text = document.createElement('output');
    text.textContent = `${rank.ms.toFixed(1)} ms`;
    row.append(swatch, name, bars, text);
    return row;
  }));
}

function overlay() {
  const {width, height} = viewport.getBoundingClientRect();
  boxes.width = width * window.devicePixelRatio;
  boxes.height = height * window.devicePixelRatio;
  drawBoxes(boxes, element('shows-boxes').checked ? shown?.matrix : null, ranks);
}

// ---- input on the image

function sizeOf(of) {
  const {width, height} = of.getBoundingClientRect();
  return [width, height].map(side =>
    Math.min(most_side, Math.max(16, Math.round(side * window.devicePixelRatio))));
}

// In halves of the shorter side, right and up from the centre.
function pointAt(x, y) {
  const {left, top, width, height} = viewport.getBoundingClientRect(), half = Math.min(width, height) / 2;
  return [(x - left - width / 2) / half, (height / 2 - (y - top)) / half];
}

const held = new Map();  // last positions of the pressed pointers
image.addEventListener('contextmenu', event => event.preventDefault());
image.addEventListener('pointerdown', event => {
  image.setPointerCapture(event.pointerId);
  held.set(event.pointerId, [event.clientX, event.clientY]);
});
for (const end of ['pointerup', 'pointercancel'])
  image.addEventListener(end, event => held.delete(event.pointerId));
image.addEventListener('pointermove', event => {
  const before = held.get(event.pointerId);
  if (!before) return;
  const now = [event.clientX, event.clientY];
  held.set(event.pointerId, now);
  if (held.size === 1) {
    const from = pointAt(...before), to = pointAt(...now);
    const pans = event.shiftKey || event.buttons > 1;
    ask(pans ? {pan: [to[0] - from[0], to[1] - from[1]]} : {rotate: [from, to]}, true);
    return;
  }
  const [, other] = [...held].find(([id]) => id !== event.pointerId);
  const apart = place => Math.hypot(place[0] - other[0], place[1] - other[1]);
  const middle = place => pointAt((place[0] + other[0]) / 2, (place[1] + other[1]) / 2);
  const from = middle(before), to = middle(now);
  ask({zoom: {by: Math.min(10, Math.max(0.1, apart(now) / Math.max(1, apart(before)))), at: to},
       pan: [to[0] - from[0], to[1] - from[1]]}, true);
});
image.addEventListener('wheel', event => {
  event.preventDefault();
  const way = event.deltaY * (event.deltaMode === 1 ? 20 : event.deltaMode === 2 ? 300 : 1);
  const by = Math.min(10, Math.max(0.1, wheel_step ** -way));
  ask({zoom: {by, at: pointAt(event.clientX, event.clientY)}}, true);
}, {passive: false});
image.addEventListener('keydown', event => {
  const turns = {ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1]};
  if (turns[event.key]) ask({rotate: [[0, 0], turns[event.key]]}, true);
  else if (volume?.time_steps > 1 && event.key === 'PageUp') goTo(Number(element('time-step').value) - 1);
  else if (volume?.time_steps > 1 && event.key === 'PageDown') goTo(Number(element('time-step').value) + 1);
  else if (volume?.time_steps > 1 && event.key === ' ') { if (!event.repeat) play(!plays); }
  else if (event.key === '+' || event.key === '-') ask({zoom: {by: event.key === '+' ? 1.15 : 1 / 1.15, at: [0, 0]}}, true);
  else return;
  event.preventDefault();
});
new ResizeObserver(() => { if (volume) ask({size: sizeOf(viewport)}, true); }).observe(viewport);

// ---- the controls

const editor = new TransferEditor(element('editor'), {
  changed: () => ask({table: {knots: editor.points}}, true),
  selected: point => {
    element('control-point').style.visibility = point ? 'visible' : 'hidden';
    if (!point) return;
    element('control-point-colour').value = hexOf(point.colour);
    element('control-point-text').textContent = `at ${valueAt(point.at)}, opacity ${point.opacity.toPrecision(3)}`;
  },
  hovered: place => { element('hovered').textContent = place === null ? '' : valueAt(place); },
});
function valueAt(place) {
  return volume ? Number((volume.low + place * (volume.high - volume.low)).toPrecision(4)).toString() : '';
}
element('control-point').style.visibility = 'hidden';
element('control-point-colour').addEventListener('input', event => editor.recolour(colourIn(event.target.value)));
element('control-point-remove').addEventListener('click', () => editor.remove());

// ---- time

let step_asked_at = 0;

function goTo(time_step) {
  if (!volume) return;
  const count = volume.time_steps;
  element('time-step').value = (time_step + count) % count;
  step_asked_at = performance.now();
  ask({time_step: Number(element('time-step').value)}, true);
}

function tellTime() {
  if (!volume) return;
  element('time-text').textContent = `${shown.time_step} / ${volume.time_steps - 1}`;
  element('name').textContent = shown.name;
  document.title = `${shown.name} · Understudy`;
  document.documentElement.dataset.timeStep = shown.time_step;
}

// The interval between time steps that the user has chosen.
function wait_ms() {
  const pace = Number(element('pace').value);
  return pace ? 1000 / pace : 0;
}

// The first time step follows the last one; no step is skipped, however slow they are.
function playOn() {
  clearTimeout(next_step_timer);
  if (!plays || !volume) return;
  next_step_timer = setTimeout(() => { if (plays && volume) goTo(Number(element('time-step').value) + 1); },
                               Math.max(0, step_asked_at + wait_ms() - performance.now()));
}

function play(wanted) {
  if (plays && !wanted && volume) ask({}, false);
  plays = wanted;
  element('play').textContent = plays ? 'Pause' : 'Play';
  playOn();
}
element('play').addEventListener('click', () => play(!plays));
element('earlier').addEventListener('click', () => goTo(Number(element('time-step').value) - 1));
element('later').addEventListener('click', () => goTo(Number(element('time-step').value) + 1));
element('time-step').addEventListener('input', event => goTo(Number(event.target.value)));

// ---- the other controls

function tellControls() {
  element('surface-value').textContent = valueAt(Number(element('surface-at').value));
  element('step-text').textContent = Number(element('step').value).toFixed(2);
}
function surfaces() {
  if (!element('shows-surface').checked) return [];
  return [{at: Number(element('surface-at').value), colour: colourIn(element('surface-colour').value),
           opacity: Number(element('surface-opacity').value)}];
}
element('shows-volume').addEventListener('change', event => ask({volume: event.target.checked}, false));
element('shows-surface').addEventListener('change', () => ask({surfaces: surfaces()}, false));
for (const id of ['surface-at', 'surface-colour', 'surface-opacity'])
  element(id).addEventListener('input', () => {
    element('shows-surface').checked = true;
    tellControls();
    ask({surfaces: surfaces()}, true);
  });
element('light').addEventListener('change', event => ask({light: event.target.checked}, false));
element('step').addEventListener('input', event => { tellControls(); ask({step: Number(event.target.value)}, true); });
element('lossless').addEventListener('change', event => ask({lossless: event.target.checked}, false));
element('home').addEventListener('click', () => { if (volume) ask({camera: volume.camera}, false); });
element('shows-boxes').addEventListener('change', overlay);

// ---- the connection

element('ask').addEventListener('submit', event => {
  event.preventDefault();
  element('ask').hidden = true;
  connection.useSecret(element('secret').value);
});
const connection = new Connection({
  message: hear,
  image: (head, bytes) => show(head, bytes).catch(error => { element('exactness').textContent = String(error); answered(head.sequence); }),
  closed: () => {
    withdraw();
    volume = null;
    banner('The connection to understudy view is lost; trying again.', null);
  },
  askForSecret: reason => {
    if (reason) element('ask-reason').textContent = reason;
    element('ask').hidden = false;
  },
});
