// Start: the runs of the page, its controls and keys, and the interface for tests.

const sources = await Promise.all(scripts.map(async (script) => {
  const packed = script.nextElementSibling;
  const source = { facts: JSON.parse(script.textContent), data: await unpack(packed.textContent) };
  packed.remove();
  return source;
}));
document.body.classList.toggle('live', isLive);
if (isLive) {
  live.read();
  try {
    sources.push(await live.next());
  } catch (error) {
    sayLive(error.message);
    return;
  }
}
/** Builds a run on the page. */
function build({ facts, data }, before) {
  const host = element('div', { className: 'run' });
  control('runs').append(host);
  const isPair = document.body.classList.contains('pair');
  let root = document;
  if (isPair) {
    root = ownTree(host);
  } else {
    host.append(control('viewer').content.cloneNode(true));
    // Those of a running mission stay where they are while the rest is replaced.
    if (!isLive) control('bar').prepend(control('controls'));
  }
  return viewer(root, facts, data, before, control('runs').firstChild === host);
}

/** Shows newer data of the run in place of the old ones. */
function mount(source) {
  const [shown] = clock.viewers;
  const focused = document.activeElement?.id;
  const before = shown.settings();
  shown.close();
  control('runs').replaceChildren();
  const run = build(source, before);
  clock.viewers = [run];
  Object.assign(window.protean, run.open);
  if (!document.activeElement?.id && focused) control(focused)?.focus({ preventScroll: true });
  run.refresh();
}

/** Shows a run, or two side by side with their differences, in place of those before. */
function showRuns(runs, differences) {
  clock.viewers.forEach((run) => run.close());
  const isPair = runs.length > 1;
  document.body.classList.toggle('pair', isPair);
  const hosts = ['timeline', 'curves'].map(control);
  for (const host of [...hosts, control('difference')]) host.hidden = true;
  for (const id of ['runs', 'curves', 'difference']) control(id).replaceChildren();
  control('events')?.remove();
  clock.difference = differences ? showDifference(differences) : NaN;
  clock.viewers = runs.map((source) => build(source));
  if (isPair) {
    const [first, second] = clock.viewers;
    for (const host of hosts) host.hidden = false;
    first.share(second, ...hosts);
    control('curves-hint').prepend('Solid: first run; dashed: second run. ');
  }
  clock.end = Math.max(...clock.viewers.map((run) => run.end));
  control('scrub').max = clock.end;
  if (!window.protean) return;
  Object.assign(window.protean, clock.viewers[0].open);
  clock.viewers.forEach((run) => run.refresh());
}
const compared = control('compared');
showRuns(sources, compared && JSON.parse(compared.textContent));

for (const speed of SPEEDS) control('speed').append(element('option', { value: String(speed), textContent: `${speed}×` }));
clock.setSpeed(SPEEDS.find((speed) => speed >= 1 && clock.end / speed <= LONGEST_PLAY) ?? SPEEDS.at(-1));
control('play').addEventListener('click', () => clock.toggle());
control('previous').addEventListener('click', () => clock.toEvent(-1));
control('next').addEventListener('click', () => clock.toEvent(1));
control('scrub').addEventListener('input', () => clock.seek(Number(control('scrub').value)));
control('speed').addEventListener('change', () => clock.setSpeed(Number(control('speed').value)));
control('live').addEventListener('click', followLive);
control('help').addEventListener('click', () => control('keys').showModal());
window.addEventListener('hashchange', () => { if (clock.addressed() >= 0) clock.seek(clock.addressed()); });

const all = (act) => () => clock.viewers.forEach(act);
const KEYS = {
  ' ': () => clock.toggle(),
  ArrowLeft: (event) => clock.seek(clock.t - (event.shiftKey ? 10 : 1)),
  ArrowRight: (event) => clock.seek(clock.t + (event.shiftKey ? 10 : 1)),
  ',': () => clock.toFrame(-1), '.': () => clock.toFrame(1),
  ArrowUp: () => clock.changeSpeed(1), ArrowDown: () => clock.changeSpeed(-1),
  Home: () => clock.seek(0), End: () => clock.seek(clock.end),
  '+': all((run) => run.zoom(1.4)), '=': all((run) => run.zoom(1.4)), '-': all((run) => run.zoom(1 / 1.4)),
  0: all((run) => run.showAll()),
  n: () => clock.toEvent(1), p: () => clock.toEvent(-1), ']': () => clock.toEvent(1), '[': () => clock.toEvent(-1),
  l: followLive,
  h: () => world.hold(), s: () => world.step(), '<': () => world.changePace(-1), '>': () => world.changePace(1),
  f: all((run) => run.followNext()),
  '?': () => control('keys').showModal(),
};
document.addEventListener('keydown', (event) => {
  const at = event.composedPath()[0];
  if (event.ctrlKey || event.altKey || event.metaKey || control('keys').open) return;
  if (['SELECT', 'TEXTAREA'].includes(at.tagName) || (at.tagName === 'INPUT' && at.type !== 'range' && event.key === ' ')) return;
  // A focused button or section handles the space key.
  if (event.key === ' ' && (at.tagName === 'BUTTON' || at.tagName === 'SUMMARY')) return;
  const action = KEYS[event.key];
  if (!action) return;
  event.preventDefault();
  action(event);
  clock.redraw();
});

const refreshAll = () => clock.viewers.forEach((run) => run.refresh());
new ResizeObserver(refreshAll).observe(document.body);
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', refreshAll);
window.addEventListener('scroll', () => clock.redraw(), { passive: true });

/** Interface for tests and the browser console. */
window.protean = {
  ...clock.viewers[0].open,
  get runs() { return clock.viewers.map((run) => run.open); },
  get end_s() { return clock.end; },
  get follows() { return clock.follows; },
  get isRunning() { return clock.isRunning; },
  seek: (t) => clock.seek(t), play: () => clock.play(), pause: () => clock.pause(),
  toEvent: (direction) => clock.toEvent(direction),
  get t() { return clock.t; },
  get playing() { return clock.playing; },
  get drawn() { return clock.drawn; },
};
if (isLive) {
  control('live').hidden = false;
  clock.grow(clock.end, sources[0].facts.live);
  world.show(sources[0].facts.live.control);
  followLive();
  offerBranches(sources[0]);
  showLive(!clock.isRunning);
} else clock.t = Math.min(clock.end, clock.addressed() >= 0 ? clock.addressed() : Math.min(...clock.viewers.map((run) => run.opening)));
refreshAll();
clock.draw();
document.documentElement.dataset.ready = 'yes';
window.protean.loaded_ms = performance.now();
