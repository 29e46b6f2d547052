// Playback: buttons, keys, and the interface for tests.

const SPEEDS = [0.25, 0.5, 1, 2, 4, 8, 16, 32, 64];

const player = {
  t: 0, playing: false, speed: 1, followed: -1, trail: Infinity, waiting: false, before: 0, drawn: 0,

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
      this.t += Math.min(0.25, Math.max(0, (now - this.before) / 1e3)) * this.speed;
      if (this.t >= end) { this.t = end; this.pause(); }
    }
    this.before = now;
    this.draw();
    if (this.playing) this.redraw();
  },

  draw() {
    if (this.followed >= 0) {
      const state = robotBetween(this.followed, this.t);
      view.x = state.x;
      view.y = state.y;
      view.fitted = false;
    }
    drawMap(this.t, this.followed, this.trail);
    drawEvents(this.t);
    drawPlots(this.t);
    $('scrub').value = this.t;
    $('clock').textContent = `${this.t.toFixed(2)} s of ${end.toFixed(2)} s`;
    this.drawn += 1;
  },

  play() {
    if (this.playing) return;
    if (this.t >= end) this.t = 0;
    this.playing = true;
    this.before = performance.now();
    $('play').textContent = 'Pause';
    this.redraw();
  },

  pause() {
    this.playing = false;
    $('play').textContent = 'Play';
    this.redraw();
  },

  toggle() { if (this.playing) this.pause(); else this.play(); },

  seek(t) {
    this.t = Math.min(end, Math.max(0, Number.isFinite(t) ? t : 0));
    this.redraw();
  },

  setSpeed(speed) {
    this.speed = speed;
    $('speed').value = String(speed);
  },

  follow(robot) {
    this.followed = robot;
    $('follow').value = String(robot);
    if (robot >= 0 && view.fitted) zoom(2.2);
    this.redraw();
  },
};

/** Redraws everything after a change of size or colours. */
function refresh() {
  readColours();
  resizeView();
  eventPicture = null;
  for (const plot of plots) plot.picture = null;
  drawHistograms();
  // Immediately: a canvas is empty after a change of its size.
  player.draw();
}

for (const speed of SPEEDS) $('speed').append(element('option', { value: String(speed), textContent: `${speed}×` }));
player.setSpeed(1);
$('follow').append(element('option', { value: '-1', textContent: 'no robot' }));
facts.robots.forEach((robot, i) => $('follow').append(element('option', { value: String(i), textContent: robot.name })));
$('scrub').max = end;
$('play').addEventListener('click', () => player.toggle());
$('scrub').addEventListener('input', () => player.seek(Number($('scrub').value)));
$('speed').addEventListener('change', () => player.setSpeed(Number($('speed').value)));
$('follow').addEventListener('change', () => player.follow(Number($('follow').value)));
$('trail').addEventListener('change', () => {
  player.trail = $('trail').value === 'all' ? Infinity : Number($('trail').value);
  player.redraw();
});
$('zoom-in').addEventListener('click', () => { zoom(1.4); player.redraw(); });
$('zoom-out').addEventListener('click', () => { zoom(1 / 1.4); player.redraw(); });
const showAll = () => { player.follow(-1); fitView(); view.fitted = true; player.redraw(); };
$('fit').addEventListener('click', showAll);
$('help').addEventListener('click', () => $('keys').showModal());

map.addEventListener('wheel', (event) => {
  event.preventDefault();
  zoom(Math.exp(-Math.sign(event.deltaY) * Math.min(Math.abs(event.deltaY), 120) * 0.0015), event.offsetX, event.offsetY);
  player.redraw();
}, { passive: false });
const fingers = new Map();
map.addEventListener('pointerdown', (event) => {
  map.setPointerCapture(event.pointerId);
  fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
});
map.addEventListener('pointermove', (event) => {
  const before = fingers.get(event.pointerId);
  if (!before) return;
  const now = [event.offsetX, event.offsetY];
  const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
  if (other) {
    const apart = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
    zoom(apart(now) / Math.max(apart(before), 1), other[0], other[1]);
  } else {
    if (player.followed >= 0) player.follow(-1);
    view.x -= (now[0] - before[0]) / view.scale;
    view.y += (now[1] - before[1]) / view.scale;
    view.fitted = false;
  }
  fingers.set(event.pointerId, now);
  player.redraw();
});
for (const name of ['pointerup', 'pointercancel']) map.addEventListener(name, (event) => fingers.delete(event.pointerId));

eventsCanvas.addEventListener('click', (event) => {
  const marker = markerAt(event.offsetX, event.offsetY);
  player.seek(marker ? marker.time : eventT(event.offsetX));
  $('event-words').textContent = sayMarker(marker);
});
eventsCanvas.addEventListener('pointermove', (event) => {
  const marker = markerAt(event.offsetX, event.offsetY);
  if (marker) $('event-words').textContent = sayMarker(marker);
});

/** Seeks the next or the previous event. */
function toEvent(direction) {
  const i = direction > 0 ? lastUpTo(markerTimes, player.t + 1e-6) + 1 : lastUpTo(markerTimes, player.t - 1e-3);
  if (i < 0 || i >= markers.length) return;
  player.seek(markers[i].time);
  $('event-words').textContent = sayMarker(markers[i]);
}

/** Seeks a number of states forward. */
function toFrame(by) {
  player.pause();
  const frame = Math.min(frames - 1, Math.max(0, frameAt(player.t) + by));
  player.seek(lists.time[frame] / 1e4);
}

const changeSpeed = (by) => player.setSpeed(SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, SPEEDS.indexOf(player.speed) + by))]);
const KEYS = {
  ' ': () => player.toggle(),
  ArrowLeft: (event) => player.seek(player.t - (event.shiftKey ? 10 : 1)),
  ArrowRight: (event) => player.seek(player.t + (event.shiftKey ? 10 : 1)),
  ',': () => toFrame(-1), '.': () => toFrame(1),
  ArrowUp: () => changeSpeed(1), ArrowDown: () => changeSpeed(-1),
  Home: () => player.seek(0), End: () => player.seek(end),
  '+': () => zoom(1.4), '=': () => zoom(1.4), '-': () => zoom(1 / 1.4), 0: showAll,
  n: () => toEvent(1), p: () => toEvent(-1),
  f: () => player.follow(player.followed + 1 < facts.robots.length ? player.followed + 1 : -1),
  '?': () => $('keys').showModal(),
};
document.addEventListener('keydown', (event) => {
  const at = event.target;
  if (event.ctrlKey || event.altKey || event.metaKey || $('keys').open) return;
  if (at.tagName === 'SELECT' || (at.tagName === 'INPUT' && at.type !== 'range' && event.key === ' ')) return;
  // A focused button or section handles the space key.
  if (event.key === ' ' && (at.tagName === 'BUTTON' || at.tagName === 'SUMMARY')) return;
  const action = KEYS[event.key];
  if (!action) return;
  event.preventDefault();
  action(event);
  player.redraw();
});

new ResizeObserver(refresh).observe(document.body);
new ResizeObserver(refresh).observe($('map-box'));
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', refresh);
window.addEventListener('scroll', () => player.redraw(), { passive: true });

/** Interface for tests and the browser console. */
window.protean = {
  outcome: facts.outcome, digest: facts.digest, missing: facts.missing, end_s: end, frames, raster, facts,
  /** The last state of the world up to a time (s). */
  at(t) {
    const frame = frameAt(t);
    return {
      tick: lists.tick[frame], time_s: lists.time[frame] / 1e4,
      robots: facts.robots.map(({ name }, robot) => {
        const { x, y, theta, status, present } = robotAt(robot, frame);
        return { name, x, y, theta, status: STATUS[status] || 'unknown', present };
      }),
    };
  },
  /** Content of the layers at a time (s): number of parts by layer and robot. */
  layersAt(t) {
    const found = {};
    for (const name of Object.keys(layerItems)) {
      for (const robot of layerItems[name].keys()) {
        const last = latest(name, robot, t);
        if (last) (found[name] ??= {})[robot] = last.count;
      }
    }
    return found;
  },
  /** Fields of view at a time (s): polygons by name. */
  sightAt: (t) => Object.fromEntries(sightAt(t).map(({ name, corners }) => [name, corners])),
  seek: (t) => player.seek(t), play: () => player.play(), pause: () => player.pause(),
  get t() { return player.t; },
  get playing() { return player.playing; },
  get drawn() { return player.drawn; },
};
refresh();
$('loading').hidden = true;
document.documentElement.dataset.ready = 'yes';
window.protean.loaded_ms = performance.now();
