// The clock of the page: one time for all runs on it; and functions without a run.

const words = (name) => name.replaceAll('_', ' ');

/** A simulated time (s) as `recorder::time_text` has it. */
const timeText = (seconds) => (Math.round(Math.round(seconds * 1e6) / 1e4) / 100).toFixed(2);

function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

/** A tree of its own for a run in a part of the page, since all runs have the same elements. */
function ownTree(host) {
  const root = host.attachShadow({ mode: 'open' });
  root.append(control('style').cloneNode(true), control('viewer').content.cloneNode(true));
  return root;
}

/** Index of the last of these ascending numbers that is at most a value; -1 if all are above. */
function lastUpTo(numbers, value, length = numbers.length) {
  let low = 0, high = length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (numbers[middle] <= value) low = middle + 1; else high = middle;
  }
  return low - 1;
}

/** Round steps of an axis: about `count` of them between two values. */
function axisSteps(from, to, count) {
  const rough = Math.max((to - from) / count, 1e-12);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((s) => s * power >= rough * 0.999) * power;
  const steps = [];
  for (let i = Math.ceil(from / step - 1e-9); i * step <= to + step * 1e-9; i++) steps.push(+(i * step).toPrecision(10));
  return steps;
}

/** Unpacks data: base64, then deflate. */
async function unpack(text) {
  if (typeof DecompressionStream === 'undefined') throw new Error('this browser is too old: it cannot unpack data');
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

const SPEEDS = [0.25, 0.5, 1, 2, 4, 8, 16, 32, 64];
/** Maximum duration of playing a run at the speed of the beginning (s). */
const LONGEST_PLAY = 60;

const control = (id) => document.getElementById(id);
const clock = {
  t: 0, end: 0, difference: NaN, playing: false, speed: 1, viewers: [], waiting: false, before: 0, drawn: 0, address: 0,
  /** Of a running mission: its present time (s), whether the page follows it, and at which speed. */
  isRunning: false, present: 0, follows: false, rate: 1, grown: 0,

  /** Schedules one redraw. */
  redraw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame((now) => this.step(now));
  },

  step(now) {
    this.waiting = false;
    if (this.playing) {
      // After a pause of the browser, playback continues at the same time.
      this.t += Math.min(0.25, Math.max(0, (now - this.before) / 1e3)) * (this.follows ? this.rate : this.speed);
      const last = this.isRunning ? this.present : this.end;
      if (this.t >= last) {
        this.t = last;
        if (this.isRunning) this.follows = true; else this.pause();
      }
    }
    this.before = now;
    this.draw();
    // At the present time, nothing moves before the next data.
    if (this.playing && !(this.isRunning && this.t >= this.present)) this.redraw();
  },

  /** Takes the end of newer data, and their present time; what is followed arrives there with the next ones. */
  grow(end, { now_s: present, ended }) {
    const now = performance.now();
    const seconds = Math.min(2, Math.max(0.2, (now - this.grown) / 1e3));
    Object.assign(this, { end, present, isRunning: !ended, grown: now, before: now });
    control('scrub').max = end;
    if (this.follows) {
      // A replay that begins again, or long-awaited data.
      if (this.t > present || present - this.t > 30 * seconds) this.t = present;
      this.rate = (present - this.t) / seconds;
    }
    this.redraw();
  },

  follow() {
    this.t = this.present;
    this.follows = true;
    this.play();
    this.redraw();
  },

  draw() {
    for (const run of this.viewers) run.draw(this.t);
    control('scrub').value = this.t;
    control('live').setAttribute('aria-pressed', String(this.follows));
    control('clock').textContent = `${timeText(this.t)} s of ${timeText(this.end)} s`;
    this.drawn += 1;
  },

  play() {
    if (this.playing) return;
    this.follows = this.isRunning && this.t >= this.present;
    if (this.t >= this.end && !this.isRunning) this.t = 0;
    this.playing = true;
    this.before = performance.now();
    control('play').textContent = 'Pause';
    this.redraw();
  },

  pause() {
    this.playing = this.follows = false;
    control('play').textContent = 'Play';
    this.writeAddress();
    this.redraw();
  },

  toggle() { if (this.playing) this.pause(); else this.play(); },

  seek(t) {
    this.t = Math.min(this.end, Math.max(0, Number.isFinite(t) ? t : 0));
    this.follows = this.playing && this.isRunning && this.t >= this.present;
    this.writeAddress();
    this.redraw();
  },

  setSpeed(speed) {
    this.speed = speed;
    control('speed').value = String(speed);
  },

  changeSpeed(by) {
    this.setSpeed(SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, SPEEDS.indexOf(this.speed) + by))]);
  },

  /** Seeks the next or the previous event of any run. */
  toEvent(direction) {
    const times = this.viewers.map(({ markerTimes: all }) => (direction > 0
      ? all[lastUpTo(all, this.t + 1e-6) + 1] ?? Infinity : all[lastUpTo(all, this.t - 1e-3)] ?? -Infinity));
    const time = direction > 0 ? Math.min(...times) : Math.max(...times);
    if (Number.isFinite(time)) this.seek(time);
  },

  /** Seeks a number of states forward. */
  toFrame(by) {
    this.pause();
    this.seek(this.viewers[0].frameTime(this.t, by));
  },

  /** Writes the time into the address, `#t=18`, once the time stays. */
  writeAddress() {
    // The address of a running mission holds its token.
    if (isLive) return;
    clearTimeout(this.address);
    this.address = setTimeout(() => history.replaceState(null, '', `#t=${+this.t.toFixed(2)}`), 250);
  },

  /** Time in the address (s); none: NaN. */
  addressed: () => Number.parseFloat(/(?:^#|&)t=([0-9.]+)/.exec(location.hash)?.[1]),
};
