// SPDX-License-Identifier: Apache-2.0
// The editor of the transfer function: control points over the volume's values, above the volume's histogram.

const radius = 6;
const least_extent = 1 / 1024;  // of a table, in units of the volume's range

// Opacities of one voxel are mostly small, so the editor uses a cube-root scale.
const heightOf = opacity => Math.cbrt(opacity);
const opacityAt = height => height ** 3;

const css = ([r, g, b], alpha = 1) => `rgb(${r * 255} ${g * 255} ${b * 255} / ${alpha})`;
export const hexOf = colour => '#' + colour.map(v => Math.round(v * 255).toString(16).padStart(2, '0')).join('');
export const colourIn = hex => [1, 3, 5].map(at => parseInt(hex.slice(at, at + 2), 16) / 255);

export class TransferEditor {
  // on: {changed(), selected(control point or null), hovered(place or null)}
  constructor(canvas, on) {
    this.canvas = canvas;
    this.on = on;
    this.points = [];
    this.bins = [];
    this.selected = -1;
    this.dragging = false;
    canvas.addEventListener('pointerdown', event => this.press(event));
    canvas.addEventListener('pointermove', event => this.move(event));
    canvas.addEventListener('pointerup', () => { this.dragging = false; });
    canvas.addEventListener('pointerleave', () => this.on.hovered(null));
    canvas.addEventListener('dblclick', () => this.remove());
    canvas.addEventListener('keydown', event => {
      if (event.key === 'Delete' || event.key === 'Backspace') this.remove();
    });
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  // Shows the part of the histogram between the minimum and the maximum, as fractions of that range.
  showHistogram(histogram, low, high) {
    const width = (histogram.high - histogram.low) / histogram.counts.length;
    this.bins = histogram.counts.map((count, i) => ({
      from: (histogram.low + i * width - low) / (high - low),
      to: (histogram.low + (i + 1) * width - low) / (high - low), count}));
    this.draw();
  }

  show(points) {
    this.points = points.map(point => ({...point, colour: [...point.colour]}));
    this.select(-1);
  }

  select(index) {
    this.selected = index;
    this.on.selected(this.points[index] ?? null);
    this.draw();
  }

  recolour(colour) {
    if (this.selected < 0) return;
    this.points[this.selected].colour = colour;
    this.changed();
  }

  remove() {
    if (this.selected < 0 || this.points.length <= 2) return;
    const left = this.points.filter((_, index) => index !== this.selected);
    if (left.at(-1).at - left[0].at < least_extent) return;
    this.points = left;
    this.select(-1);
    this.on.changed();
  }

  changed() {
    this.on.selected(this.points[this.selected] ?? null);
    this.draw();
    this.on.changed();
  }

  // Leaves a border, so that control points at the edge are completely visible.
  get frame() {
    const {width, height} = this.canvas.getBoundingClientRect();
    return {left: radius + 2, top: radius + 2, width: width - 2 * radius - 4, height: height - 2 * radius - 4};
  }

  placeOf(event) {
    const {left, top} = this.canvas.getBoundingClientRect(), frame = this.frame;
    const inside = value => Math.min(1, Math.max(0, value));
    return [inside((event.clientX - left - frame.left) / frame.width),
            inside(1 - (event.clientY - top - frame.top) / frame.height)];
  }

  at(x) {
    const next = this.points.findIndex(point => point.at > x);
    if (next === 0) return this.points[0];
    if (next < 0) return this.points.at(-1);
    const [a, b] = [this.points[next - 1], this.points[next]];
    const share = (x - a.at) / (b.at - a.at);
    return {colour: a.colour.map((value, k) => value + share * (b.colour[k] - value)),
            opacity: a.opacity + share * (b.opacity - a.opacity)};
  }

  press(event) {
    this.canvas.setPointerCapture(event.pointerId);
    const [x, y] = this.placeOf(event), frame = this.frame;
    const far = this.points.map(point =>
      Math.hypot((point.at - x) * frame.width, (heightOf(point.opacity) - y) * frame.height));
    const nearest = far.indexOf(Math.min(...far));
    this.dragging = true;
    if (far[nearest] <= 2 * radius) return this.select(nearest);
    const index = this.points.filter(point => point.at <= x).length;
    this.points.splice(index, 0, {at: x, colour: [...this.at(x).colour], opacity: opacityAt(y)});
    this.selected = index;
    this.changed();
  }

  move(event) {
    const [x, y] = this.placeOf(event);
    this.on.hovered(x);
    if (!this.dragging || this.selected < 0) return;
    const point = this.points[this.selected];
    const last = this.points.length - 1;
    point.at = Math.min(1, this.points[this.selected + 1]?.at ?? 1, Math.max(0, x));
    point.at = Math.max(this.points[this.selected - 1]?.at ?? point.at, point.at);
    // A table whose points all stand at one value is none.
    if (this.points[last].at - this.points[0].at < least_extent)
      point.at = this.selected === 0 ? this.points[last].at - least_extent : this.points[0].at + least_extent;
    point.opacity = opacityAt(y);
    this.changed();
  }

  draw() {
    const ratio = window.devicePixelRatio, {width, height} = this.canvas.getBoundingClientRect(), frame = this.frame;
    if (!width) return;
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    const context = this.canvas.getContext('2d');
    context.scale(ratio, ratio);
    const x = at => frame.left + at * frame.width, y = part => frame.top + (1 - part) * frame.height;

    const most = Math.log1p(Math.max(1, ...this.bins.map(bin => bin.count)));
    context.fillStyle = '#3a4350';
    context.beginPath();
    for (const [i, bin] of this.bins.entries()) {
      const height = y(Math.log1p(bin.count) / most);
      if (i === 0) context.moveTo(x(bin.from), y(0));
      context.lineTo(x(bin.from), height);
      context.lineTo(x(bin.to), height);
      if (i === this.bins.length - 1) context.lineTo(x(bin.to), y(0));
    }
    context.fill();
    context.font = '9px system-ui, sans-serif';
    for (const opacity of [0.001, 0.01, 0.1, 1]) {
      context.fillStyle = '#ffffff14';
      context.fillRect(frame.left, y(heightOf(opacity)), frame.width, 1);
      context.fillStyle = '#8d95a3';
      context.fillText(String(opacity), frame.left + 2, y(heightOf(opacity)) + 9);
    }
    if (this.points.length < 2) return;

    const fill = context.createLinearGradient(x(0), 0, x(1), 0);
    for (const point of this.points) fill.addColorStop(Math.min(1, Math.max(0, point.at)), css(point.colour, 0.45));
    context.beginPath();
    context.moveTo(x(0), y(0));
    // Linear opacity is a curve on the cube-root scale.
    const steps = Math.max(64, Math.round(frame.width));
    for (let i = 0; i <= steps; ++i) context.lineTo(x(i / steps), y(heightOf(this.at(i / steps).opacity)));
    context.lineTo(x(1), y(0));
    context.fillStyle = fill;
    context.fill();
    context.strokeStyle = '#ffffffc0';
    context.lineWidth = 1;
    context.stroke();
    this.points.forEach((point, i) => {
      context.beginPath();
      context.arc(x(point.at), y(heightOf(point.opacity)), radius, 0, 7);
      context.fillStyle = css(point.colour);
      context.fill();
      context.lineWidth = i === this.selected ? 2.5 : 1.25;
      context.strokeStyle = i === this.selected ? '#f0a04b' : '#ffffff';
      context.stroke();
    });
  }
}
