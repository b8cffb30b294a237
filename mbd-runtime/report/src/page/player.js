// Play, pause, speed, scrubber; what is shown and followed; mouse, touch and keys on the drawing.

class Player {
  constructor(root, data) {
    this.root = root;
    this.find = (name) => document.querySelector(`[data-mbd="${name}"]`);
    this.stage = new Stage(data);
    this.camera = new Camera(data.up, data.from);
    this.canvas = root.querySelector('canvas');
    this.painter = new Painter(this.canvas, this.stage, this.camera);
    const { times } = this.stage;
    [this.start, this.end] = [times[0], times[times.length - 1]];
    this.time = this.start;
    this.playing = false;
    this.frames = 0;
    this.plots = [...document.querySelectorAll('figure[data-plot]')].map((figure) => new Plot(figure, data.plots[Number(figure.dataset.plot)], this.end - this.start, {
      pick: (t) => this.set(t),
      zoom: (window) => this.zoom(window),
      playing: () => this.playing,
    }));
    this.inSight();
    this.choices(data);
    this.controls();
    this.mouse();
    this.reset();
    this.set(this.start);
  }

  /** Keeps the plots that are in sight: while it plays, only these follow. */
  inSight() {
    this.seen = new Set();
    const watch = new IntersectionObserver((entries) => entries.forEach(({ target, isIntersecting }) => {
      const plot = this.plots.find(({ figure }) => figure === target);
      if (isIntersecting) { this.seen.add(plot); plot.mark(this.time); } else this.seen.delete(plot);
    }));
    this.plots.forEach(({ figure }) => watch.observe(figure));
  }

  /** Fills the lists of speeds and of what can be followed. */
  choices(data) {
    const span = this.end - this.start;
    const option = (list, value, text) => list.append(new Option(text, value));
    const speed = this.find('speed');
    for (const factor of [0.01, 0.1, 0.25, 0.5, 1, 2, 5, 10, 100]) option(speed, factor, `${factor}×`);
    option(speed, span / 10 || 1, 'all in 10 s');
    if (span < 1 || span > 60) speed.selectedIndex = 9; else speed.value = '1';
    const follow = this.find('follow');
    option(follow, 'none', 'nothing');
    option(follow, 'middle', 'the middle');
    data.bodies.forEach((body, k) => option(follow, `body ${k}`, body.name));
    data.points.forEach((point, k) => option(follow, `point ${k}`, point.name));
    follow.value = this.stage.travels ? 'middle' : 'none';
    this.find('tension').parentElement.hidden = !data.lines.length;
    this.bar();
    this.find('forces').parentElement.hidden = !data.arrows.length;
    const longest = Object.entries(this.stage.longest).map(([symbol, size]) => `${shown(size)} ${symbol}`);
    this.scales = [
      longest.length ? `longest arrows: ${longest.join(', ')}` : '',
    ];
  }

  /** The colours of lines with their tensions. */
  bar() {
    const { pull, push, data } = this.stage;
    const most = Math.max(pull, push) || 1;
    const [low, high] = [-push / most, pull / most];
    const colours = Array.from({ length: 41 }, (_, k) => tensionColour(low + ((high - low) * k) / 40, this.painter.dark));
    this.find('tension').style.background = `linear-gradient(to right,${colours.join()})`;
    this.find('least').textContent = push ? `lines push ${shown(push)} N` : 'lines pull 0 N';
    this.find('most').textContent = `${push ? 'pull ' : ''}${shown(pull)} N${data.lines.some((line) => line.slack.includes(1)) ? '; slack ones are dashed' : ''}`;
  }

  controls() {
    const range = this.find('time');
    Object.assign(range, { min: 0, max: 10000, step: 1, disabled: !(this.end > this.start) });
    range.addEventListener('input', () => this.set(this.start + (range.value / 10000) * (this.end - this.start)));
    this.find('play').addEventListener('click', () => this.play(!this.playing));
    this.find('play').disabled = !(this.end > this.start);
    this.find('follow').addEventListener('change', () => { this.camera.offset = [0, 0, 0]; this.request(); });
    for (const word of Object.keys(this.painter.show)) {
      const box = this.find(word);
      box.checked = this.painter.show[word];
      box.addEventListener('change', () => { this.painter.show[word] = box.checked; this.request(); });
    }
    this.find('fit').addEventListener('click', () => { this.reset(); this.request(); });
    this.find('whole').addEventListener('click', () => this.zoom(null));
    this.find('closer').addEventListener('click', () => this.zoom(this.narrowed(0.5)));
    this.find('wider').addEventListener('click', () => this.zoom(this.narrowed(2)));
    new ResizeObserver(() => this.request()).observe(this.canvas);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { this.painter.restyle(); this.bar(); this.request(); });
  }

  mouse() {
    const { canvas, camera } = this;
    const held = new Map();
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      held.set(event.pointerId, [event.clientX, event.clientY]);
    });
    canvas.addEventListener('pointermove', (event) => {
      const last = held.get(event.pointerId);
      if (!last) { this.point(event); return; }
      const [dx, dy] = [event.clientX - last[0], event.clientY - last[1]];
      const other = [...held].find(([id]) => id !== event.pointerId);
      if (other) {
        const away = (place) => Math.hypot(place[0] - other[1][0], place[1] - other[1][1]);
        camera.zoom(away(last) / (away([event.clientX, event.clientY]) || 1));
        camera.pan(dx / 2, dy / 2);
      } else if (event.shiftKey || event.buttons & 6) camera.pan(dx, dy);
      else camera.orbit(dx, dy);
      held.set(event.pointerId, [event.clientX, event.clientY]);
      this.request();
    });
    for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, (event) => held.delete(event.pointerId));
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      camera.zoom(Math.exp(Math.max(-0.5, Math.min(0.5, event.deltaY * 0.0015))));
      this.request();
    }, { passive: false });
    canvas.addEventListener('keydown', (event) => {
      const step = (this.end - this.start) / 100;
      const keys = {
        ' ': () => this.play(!this.playing),
        ArrowRight: () => this.set(this.time + step),
        ArrowLeft: () => this.set(this.time - step),
        '+': () => camera.zoom(0.8),
        '-': () => camera.zoom(1.25),
      };
      if (!keys[event.key]) return;
      event.preventDefault();
      keys[event.key]();
      this.request();
    });
  }

  /** Names what the mouse points at. */
  point(event) {
    const box = this.canvas.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    let [near, best] = [null, 16];
    for (const hot of this.painter.names()) {
      const away = Math.hypot(hot.x - x, hot.y - y);
      if (away < best) { near = hot; best = away; }
    }
    const tip = this.find('tip');
    tip.hidden = !near;
    if (near) {
      tip.textContent = near.text;
      tip.style.left = `${Math.min(near.x + 12, box.width - 140)}px`;
      tip.style.top = `${near.y + 12}px`;
    }
  }

  /** Where the camera follows to. */
  followed(now) {
    const [kind, index] = this.find('follow').value.split(' ');
    const place = { body: () => now.bodies[index].p, point: () => now.points[index], middle: () => this.stage.middle(now) }[kind];
    const found = place ? place() : this.stage.centre;
    return finite(found) ? found : null;
  }

  reset() {
    this.camera.target = this.stage.travels ? this.stage.middle(this.stage.at(this.time)) : this.stage.centre;
    this.camera.fit(this.stage.around, this.canvas.clientWidth, this.canvas.clientHeight);
  }

  /** Goes to a time: the drawing, the scrubber and all plots. */
  set(t) {
    this.time = Math.min(this.end, Math.max(this.start, t));
    const share = this.end > this.start ? (this.time - this.start) / (this.end - this.start) : 0;
    this.find('time').value = Math.round(share * 10000);
    this.find('now').textContent = `${this.time.toFixed(this.end - this.start < 10 ? 3 : 2)} s`;
    (this.playing ? this.seen : this.plots).forEach((plot) => plot.mark(this.time));
    this.request();
  }

  /** A window of times around now, wider or narrower than that of the plots; null: everything. */
  narrowed(factor) {
    const [low, high] = this.window || [this.start, this.end];
    const half = (factor * (high - low)) / 2;
    if (2 * half >= this.end - this.start || !(half > 0)) return null;
    const middle = Math.min(this.end - half, Math.max(this.start + half, this.time));
    return [middle - half, middle + half];
  }

  zoom(window) {
    this.window = window;
    this.plots.forEach((plot) => { plot.zoom(window); plot.mark(this.time); });
  }

  play(on) {
    this.playing = on && this.end > this.start;
    if (!this.playing) this.set(this.time);
    else if (this.time >= this.end) this.set(this.start);
    this.find('play').textContent = this.playing ? 'Pause' : 'Play';
    this.last = null;
    this.request();
  }

  request() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame((clock) => this.frame(clock));
  }

  frame(clock) {
    this.waiting = false;
    if (this.playing) {
      const passed = this.last === null ? 0 : (clock - this.last) / 1000;
      this.last = clock;
      this.set(this.time + passed * Number(this.find('speed').value));
      if (this.time >= this.end) this.play(false);
    }
    this.painter.draw(this.time, (now) => this.followed(now));
    const grid = this.painter.show.ground ? `squares of ${shown(this.painter.square)} m` : '';
    const says = [grid, ...this.scales].filter(Boolean).join(' · ');
    if (this.said !== says) this.find('scales').textContent = this.said = says;
    this.canvas.dataset.frames = ++this.frames;
    if (this.frames === 1) this.canvas.dataset.first = performance.now().toFixed(0);
  }
}

const root = document.querySelector('.player');
const dock = document.querySelector('.dock');
root.hidden = dock.hidden = false;
try {
  new Player(root, JSON.parse(document.getElementById('mbd-data').textContent));
} catch (error) {
  // The drawings that stand still take its place.
  root.hidden = dock.hidden = true;
  document.documentElement.classList.remove('live');
  throw error;
}
