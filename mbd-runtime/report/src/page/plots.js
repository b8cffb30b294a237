// The plots of a page: a mark at the time of the player, values beside the names, zoom over time.

const NS = 'http://www.w3.org/2000/svg';
const make = (name, attributes, parent) => {
  const element = document.createElementNS(NS, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return parent.appendChild(element);
};

/** 1, 2 or 5 times a power of ten, not below x. */
function roundStep(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  return [1, 2, 5, 10].map((k) => k * power).find((step) => step >= x * (1 - 1e-9)) || x;
}

class Plot {
  /** A figure of the page and its numbers; `pick` is told of a time, `zoom` of a window of times. */
  constructor(figure, data, span, { pick, zoom, playing }) {
    Object.assign(this, { figure, data, span });
    this.panel = figure.querySelector('.panel');
    this.svg = this.panel.querySelector('svg');
    this.curves = this.svg.querySelector('.mbd-curves');
    this.box = this.curves.getAttribute('viewBox').split(' ').map(Number);
    this.still = { x: this.svg.querySelector('.mbd-x').innerHTML, y: this.svg.querySelector('.mbd-y').innerHTML, curves: this.curves.innerHTML };
    this.series = data.series.map((series) => ({
      ...series, t: unpack(Float32Array, series.t), v: unpack(Float32Array, series.v),
    }));
    this.values = [...figure.querySelectorAll('.legend li')].map((entry) => {
      const value = document.createElement('output');
      entry.append(value);
      return value;
    });
    this.window = data.x;
    this.now = make('line', { class: 'mbd-now', y1: 0, y2: '100%' }, this.svg);
    this.chosen = make('rect', { class: 'mbd-chosen', y: 0, height: '100%', width: 0 }, this.svg);
    this.listen(pick, zoom, playing);
  }

  listen(pick, zoom, playing) {
    const { panel } = this;
    const share = (event) => {
      const box = panel.getBoundingClientRect();
      return Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
    };
    const time = (s) => this.window[0] + s * (this.window[1] - this.window[0]);
    let from = null;
    panel.addEventListener('pointerdown', (event) => { from = share(event); });
    panel.addEventListener('pointermove', (event) => {
      const here = share(event);
      if (from !== null && event.buttons && Math.abs(here - from) > 0.01) {
        this.chosen.setAttribute('x', `${100 * Math.min(from, here)}%`);
        this.chosen.setAttribute('width', `${100 * Math.abs(here - from)}%`);
      } else if (event.pointerType === 'mouse' && !playing()) pick(time(here));
    });
    panel.addEventListener('pointerup', (event) => {
      const here = share(event);
      if (from !== null && Math.abs(here - from) > 0.01) zoom([time(Math.min(from, here)), time(Math.max(from, here))]);
      else pick(time(here));
      from = null;
      this.chosen.setAttribute('width', 0);
    });
    panel.addEventListener('pointerleave', () => { from = null; this.chosen.setAttribute('width', 0); });
    panel.addEventListener('dblclick', () => zoom(null));
  }

  /** Shows a time: the mark, and what every curve is there. */
  mark(t) {
    const [low, high] = this.window;
    const place = high > low ? (t - low) / (high - low) : 0;
    const inside = place >= -1e-9 && place <= 1 + 1e-9;
    this.now.style.display = inside ? '' : 'none';
    if (inside) {
      this.now.setAttribute('x1', `${(100 * place).toFixed(3)}%`);
      this.now.setAttribute('x2', `${(100 * place).toFixed(3)}%`);
    }
    this.figure.dataset.time = t;
    this.series.forEach((series, k) => {
      if (this.values[k]) this.values[k].textContent = shown(this.value(series, t));
    });
  }

  /** A curve at a time; not a number beyond its ends and in its gaps. */
  value(series, t) {
    const { t: times, v } = series;
    if (!times.length || t < times[0] - 1e-6 * this.span || t > times[times.length - 1] + 1e-6 * this.span) return NaN;
    const [i, j, s] = between(times, t);
    if (series.wrap && Math.abs(v[j] - v[i]) > series.wrap / 2) return series.base + v[s < 0.5 ? i : j];
    return series.base + v[i] + (s > 0 ? s * (v[j] - v[i]) : 0);
  }

  /** Shows a window of times; null: everything, as it was drawn at first. */
  zoom(times) {
    const { svg, still, curves } = this;
    this.window = times || this.data.x;
    if (!times) {
      svg.querySelector('.mbd-x').innerHTML = still.x;
      svg.querySelector('.mbd-y').innerHTML = still.y;
      curves.innerHTML = still.curves;
      this.hideMarks('');
      return;
    }
    this.hideMarks('none');
    const log = this.data.log;
    const scale = log ? (y) => (y > 0 ? Math.log10(y) : NaN) : (y) => y;
    let [low, high] = [Infinity, -Infinity];
    for (const { t, v, base } of this.series) {
      for (let k = Math.max(0, rowBefore(t, times[0])); k < t.length; k++) {
        const y = scale(base + v[k]);
        if (y < low) low = y;
        if (y > high) high = y;
        if (t[k] > times[1]) break;
      }
    }
    if (!(high > low)) { const pad = Math.abs(low) * 0.1 || 1; low = (Number.isFinite(low) ? low : 0) - pad; high = low + 2 * pad; }
    const step = roundStep((high - low) / 5);
    const [bottom, top] = [Math.floor(low / step + 1e-9) * step, Math.ceil(high / step - 1e-9) * step];
    this.grid('x', times, roundStep((times[1] - times[0]) / 6), (x) => shown(x));
    this.grid('y', [bottom, top], step, (y) => (log ? shown(10 ** y) : shown(y)));
    const [, , width, height] = this.box;
    const right = (t) => ((t - times[0]) / (times[1] - times[0])) * width;
    const down = (y) => (1 - (scale(y) - bottom) / (top - bottom)) * height;
    const paths = [...curves.querySelectorAll('path')];
    this.series.forEach((series, k) => paths[k] && paths[k].setAttribute('d', this.path(series, times, right, down)));
  }

  /** A curve in a window as a path. */
  path({ t, v, base, wrap }, times, right, down) {
    const parts = [];
    let before = NaN;
    const [first, last] = [rowBefore(t, times[0]), Math.min(t.length - 1, rowBefore(t, times[1]) + 1)];
    for (let k = first; k <= last; k++) {
      const [x, y] = [right(t[k]), down(base + v[k])];
      const joined = Number.isFinite(before) && !(wrap && Math.abs(v[k] - before) > wrap / 2);
      before = Number.isFinite(y) ? v[k] : NaN;
      if (Number.isFinite(y)) parts.push(`${joined ? 'L' : 'M'}${x.toFixed(2)} ${y.toFixed(2)}`);
    }
    return parts.join('') || 'M0 0';
  }

  /** Grid lines and labels of one axis. */
  grid(axis, [low, high], step, label) {
    const group = this.svg.querySelector(`.mbd-${axis}`);
    group.replaceChildren();
    for (let k = Math.ceil(low / step - 1e-6); k * step <= high + 1e-6 * step; k++) {
      const place = `${(100 * (k * step - low)) / (high - low)}%`;
      const across = axis === 'x';
      const turned = `${100 - parseFloat(place)}%`;
      make('line', across ? { class: 'mbd-grid', x1: place, x2: place, y1: 0, y2: '100%' } : { class: 'mbd-grid', x1: 0, x2: '100%', y1: turned, y2: turned }, group);
      const text = make('text', across ? { class: 'mbd-text', x: place, y: '100%', dy: 16, 'text-anchor': 'middle', 'font-size': 12.5 } : { class: 'mbd-text', x: 0, y: turned, dx: -6, dy: 4.4, 'text-anchor': 'end', 'font-size': 12.5 }, group);
      text.textContent = label(k * step);
    }
  }

  hideMarks(display) {
    const marks = this.svg.querySelector('.mbd-marks');
    if (marks) marks.style.display = display;
  }
}
