// The view of a run: its buttons, and what the page needs of it.

const player = {
  followed: -1, trail: Infinity,

  draw(now) {
    const t = Math.min(now, end);
    if (this.followed >= 0) {
      const state = robotBetween(this.followed, t);
      view.x = state.x;
      view.y = state.y;
      view.fitted = false;
    }
    drawMap(t, this.followed, this.trail);
    if (isOriginal && whatIf.source) drawPlaces(t);
    // Their axes may be longer than this run.
    drawEvents(now);
    drawPlots(now);
  },

  follow(robot) {
    this.followed = robot;
    $('follow').value = String(robot);
    if (robot >= 0 && view.fitted) zoom(2.2);
    clock.redraw();
  },
};

/** Draws robots where they are moved to. */
function drawPlaces(t) {
  inMetres(paint);
  for (const [name, [x, y]] of whatIf.places) {
    const robot = facts.robots.findIndex((own) => own.name === name);
    const from = robotBetween(robot, t);
    paint.strokeStyle = robotColour(robot);
    paint.lineWidth = 2 / view.scale;
    paint.setLineDash([6 / view.scale, 4 / view.scale]);
    paint.beginPath(); paint.moveTo(from.x, from.y); paint.lineTo(x, y); paint.stroke();
    paint.setLineDash([]);
    paint.beginPath(); paint.arc(x, y, Math.max(facts.robots[robot].radius, 7 / view.scale), 0, 2 * Math.PI); paint.stroke();
  }
  whatIf.draw();
}

/** The robot of the original under a point of the map (px), where it may be moved; undefined without. */
function movableAt(px, py) {
  if (!isOriginal || !whatIf.source) return undefined;
  const distances = facts.robots.map(({ name, radius }, robot) => {
    const state = robotBetween(robot, Math.min(clock.t, end));
    const [x, y] = toScreen(...(whatIf.places.get(name) ?? [state.x, state.y]));
    const isNear = state.status === 0 && Math.hypot(x - px, y - py) < Math.max(14, radius * view.scale);
    return { name, distance: isNear ? Math.hypot(x - px, y - py) : Infinity };
  });
  const nearest = distances.reduce((a, b) => (a.distance <= b.distance ? a : b));
  return nearest.distance < Infinity ? nearest.name : undefined;
}

/** Redraws everything after a change of size or colours. */
function refresh() {
  readColours();
  resizeView();
  eventPicture = null;
  for (const plot of plots) plot.picture = null;
  drawHistograms();
  // Immediately: a canvas is empty after a change of its size.
  player.draw(clock.t);
}

$('follow').append(element('option', { value: '-1', textContent: 'no robot' }));
facts.robots.forEach((robot, i) => $('follow').append(element('option', { value: String(i), textContent: robot.name })));
$('follow').addEventListener('change', () => player.follow(Number($('follow').value)));
$('trail').addEventListener('change', () => {
  player.trail = $('trail').value === 'all' ? Infinity : Number($('trail').value);
  clock.redraw();
});
$('zoom-in').addEventListener('click', () => { zoom(1.4); clock.redraw(); });
$('zoom-out').addEventListener('click', () => { zoom(1 / 1.4); clock.redraw(); });
const showAll = () => { player.follow(-1); fitView(); view.fitted = true; clock.redraw(); };
$('fit').addEventListener('click', showAll);

map.addEventListener('wheel', (event) => {
  event.preventDefault();
  zoom(Math.exp(-Math.sign(event.deltaY) * Math.min(Math.abs(event.deltaY), 120) * 0.0015), event.offsetX, event.offsetY);
  clock.redraw();
}, { passive: false });
const fingers = new Map();
let moved;
map.addEventListener('pointerdown', (event) => {
  if (!fingers.size) moved = movableAt(event.offsetX, event.offsetY);
  map.setPointerCapture(event.pointerId);
  fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
});
map.addEventListener('pointermove', (event) => {
  const before = fingers.get(event.pointerId);
  if (!before) return;
  const now = [event.offsetX, event.offsetY];
  const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
  if (moved && !other) {
    whatIf.place(moved, toWorld(...now));
  } else if (other) {
    const apart = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
    zoom(apart(now) / Math.max(apart(before), 1), other[0], other[1]);
  } else {
    if (player.followed >= 0) player.follow(-1);
    view.x -= (now[0] - before[0]) / view.scale;
    view.y += (now[1] - before[1]) / view.scale;
    view.fitted = false;
  }
  fingers.set(event.pointerId, now);
  clock.redraw();
});
for (const name of ['pointerup', 'pointercancel']) map.addEventListener(name, (event) => fingers.delete(event.pointerId));

eventsCanvas.addEventListener('click', (event) => {
  clock.seek(markerAt(event.offsetX, event.offsetY)?.time ?? eventT(event.offsetX));
});
eventsCanvas.addEventListener('pointermove', (event) => {
  hovered = markerAt(event.offsetX, event.offsetY);
  eventsCanvas.title = hovered?.text ?? '';
  clock.redraw();
});
eventsCanvas.addEventListener('pointerleave', () => { hovered = null; clock.redraw(); });

const resized = new ResizeObserver(refresh);
resized.observe($('map-box'));
if (before) {
  Object.assign(view, before.view);
  Object.assign(player, { followed: before.followed, trail: before.trail });
  $('follow').value = String(player.followed);
  $('trail').value = player.trail === Infinity ? 'all' : String(player.trail);
  $('scenario-box').open = before.isScenarioOpen;
}
$('loading').hidden = true;

return {
  end, opening, markerTimes, refresh, zoom, showAll,
  draw: (t) => player.draw(t),
  close: () => resized.disconnect(),
  /** What the reader has set, for the viewer of newer data. */
  settings: () => ({
    view, chosen, followed: player.followed, trail: player.trail, isScenarioOpen: $('scenario-box').open,
    hidden: plots.flatMap(({ title, curves }) => curves.filter(({ on }) => !on).map(({ name }) => `${title} ${name}`)),
  }),
  sharedMarkers, plots,
  /** Shows time line and curves of both runs once, in parts of the page; `other` is the other run. */
  share(other, timeline, curves) {
    adoptEvents(other.sharedMarkers());
    timeline.append($('events'));
    other.open.root.getElementById('events').remove();
    const parts = ['figures-title', 'curves-hint', 'plots'];
    curves.append(...parts.map((part) => $(part)));
    adoptPlots(other.plots);
    for (const part of parts) other.open.root.getElementById(part).remove();
    other.plots.length = 0;
  },
  followNext: () => player.follow(player.followed + 1 < facts.robots.length ? player.followed + 1 : -1),
  /** Time of the state this many states after that at a time (s). */
  frameTime: (t, by) => lists.time[Math.min(frames - 1, Math.max(0, frameAt(t) + by))] / 1e4,
  open: {
    outcome: facts.outcome, digest: facts.digest, missing: facts.missing, frames, raster, facts, root, view,
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
    /** Planned paths at a time (s): their points by robot, the first the robot's position. */
    plansAt: (t) => Object.fromEntries(plansAt(t).map(({ robot, points }) => [robot, points])),
    patrolsAt,
    /** Boxes of the names on the map at a time (s): left, top, right, bottom (px). */
    namesAt: (t) => placeNames(t).map(({ box }) => box),
    /** Fields of view at a time (s): polygons by name. */
    sightAt: (t) => Object.fromEntries(sightAt(t).map(({ name, corners }) => [name, corners])),
  },
};
