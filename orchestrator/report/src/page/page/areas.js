// Areas and places of the map: time since the last visit, dominance regions of the teams.

/** Maximum number of cells along a side of the map for the times of visits. */
const MAX_VISIT_CELLS = 256;
const sweepers = facts.robots.map((_, robot) => robot).filter((robot) => facts.robots[robot].sweeps > 0);

/** Times of the last visits of the cells of the map, as far as the states go up to a time. */
const visits = (() => {
  const { min, max } = facts.ground;
  const radius = Math.min(...sweepers.map((robot) => facts.robots[robot].sweeps));
  const extent = [max[0] - min[0], max[1] - min[1]];
  const side = Math.max(Math.max(...extent) / MAX_VISIT_CELLS, radius / 4);
  const size = extent.map((length) => Math.max(1, Math.ceil(length / side)));
  const time = sweepers.length ? new Float64Array(size[0] * size[1]).fill(-1) : null;
  let next = 0;
  /** Notes the visits on the way between two positions. */
  function visit(from, to, reach, at) {
    const steps = Math.max(1, Math.ceil(Math.hypot(to[0] - from[0], to[1] - from[1]) / Math.max(reach / 2, side / 2)));
    for (let k = 1; k <= steps; k++) {
      const [x, y] = [0, 1].map((i) => (from[i] + (to[i] - from[i]) * k / steps - min[i]) / side);
      const r = reach / side;
      for (let row = Math.max(0, Math.floor(y - r)); row <= Math.min(size[1] - 1, y + r); row++) {
        for (let column = Math.max(0, Math.floor(x - r)); column <= Math.min(size[0] - 1, x + r); column++) {
          if ((column + 0.5 - x) ** 2 + (row + 0.5 - y) ** 2 <= r * r) time[row * size[0] + column] = at;
        }
      }
    }
  }
  return {
    size, side, time,
    to(t) {
      const frame = frameAt(t);
      if (frame + 1 < next) { time.fill(-1); next = 0; }
      for (; next <= frame; next++) {
        for (const robot of sweepers) {
          const here = robot * frames + next, before = next > 0 ? here - 1 : here;
          visit([xOf(lists.x[before]), yOf(lists.y[before])], [xOf(lists.x[here]), yOf(lists.y[here])],
            facts.robots[robot].sweeps, lists.time[next] / 1e4);
        }
      }
    },
  };
})();

/** Places of the patrols: the line of each (m), and the times of its visits. */
const patrolPlaces = facts.patrols.map((count, patrol) => {
  const begin = 2 * facts.patrols.slice(0, patrol).reduce((sum, n) => sum + n, 0);
  const end = (i) => [xOf(lists['places.x'][begin + i]), yOf(lists['places.y'][begin + i])];
  return Array.from({ length: count }, (_, i) => ({ from: end(2 * i), to: end(2 * i + 1), time: [] }));
});
lists['visits.time'].forEach((time, i) => patrolPlaces[lists['visits.patrol'][i]][lists['visits.place'][i]].time.push(time));

/** Idleness of the places of each patrol at a time (s): since the last visit, or the begin of the run without one. */
const patrolsAt = (t) => patrolPlaces.map((places) => places.map(({ time }) => {
  const last = lastUpTo(time, ticksOf(t));
  return last < 0 ? t : t - time[last] / 1e4;
}));

/** Number of the colour of a time since the last visit (s). */
function shadeOf(age) {
  const shade = facts.idleness.findIndex((most) => most !== null && age < most);
  return shade < 0 ? facts.idleness.length - 1 : shade;
}

/** Places of the patrols in the colours of their idleness: lines along contours, discs where a place is a point. */
function drawPatrols(t) {
  inMetres(paint);
  paint.lineWidth = 7 / view.scale;
  paint.lineCap = 'round';
  const paths = colours.idleness.map(() => new Path2D());
  patrolsAt(t).forEach((ages, patrol) => ages.forEach((age, place) => {
    const { from, to } = patrolPlaces[patrol][place];
    const path = paths[shadeOf(age)];
    path.moveTo(...from);
    path.lineTo(...to);
  }));
  paths.forEach((path, shade) => { paint.strokeStyle = colours.idleness[shade]; paint.stroke(path); });
  paint.lineCap = 'butt';
}

/** A colour `#rrggbb` as numbers. */
const rgbOf = (colour) => [1, 3, 5].map((i) => Number.parseInt(colour.slice(i, i + 2), 16));

/** A canvas with a pixel for every cell of a grid, drawn over the map: its rows begin at the smallest y. */
function cellLayer() {
  const canvas = document.createElement('canvas');
  const ctx = canvas.getContext('2d');
  let image = null;
  return ([width, height], [x, y], side, colourOf) => {
    if (!image || image.width !== width || image.height !== height) {
      [canvas.width, canvas.height] = [width, height];
      image = ctx.createImageData(width, height);
    }
    for (let i = 0; i < width * height; i++) {
      const [r, g, b, alpha] = colourOf(i);
      image.data.set([r, g, b, alpha], 4 * i);
    }
    ctx.putImageData(image, 0, 0);
    inMetres(paint);
    paint.imageSmoothingEnabled = false;
    paint.drawImage(canvas, x, y, width * side, height * side);
    paint.imageSmoothingEnabled = true;
  };
}
const NOTHING = [0, 0, 0, 0];

const idleCells = cellLayer();
function drawIdleness(t) {
  visits.to(t);
  const shades = colours.idleness.map((colour) => [...rgbOf(colour), 150]);
  idleCells(visits.size, facts.ground.min, visits.side, (i) => {
    const last = visits.time[i];
    if (last < 0) return NOTHING;
    return shades[shadeOf(t - last)];
  });
}

/** Opacities of the dominance regions, as in `protean picture`; their owners: none, pursuers, evaders, cut off. */
const OWNER_OPACITY = [0, 0.16, 0.22, 0.16];
const dominanceCells = cellLayer();
function drawDominance(t) {
  const found = latest('dominance', 0, t);
  if (!found || found.age > OLD.dominance) return;
  const shades = [colours.paper, colours.pursuer, colours.evader, colours.obstacle]
    .map((colour, owner) => [...rgbOf(colour), 255 * OWNER_OPACITY[owner]]);
  const { size, origin, side } = facts.dominance;
  dominanceCells(size, origin, side, (i) => shades[lists['dominance.owner'][found.begin + i]] || NOTHING);
}

/** The last verdict of the referee on a robot: whether its escape is possible, and by how much (s). */
function verdictOn(robot, t) {
  const found = latest('verdicts', robot, t);
  if (!found || found.age > OLD.verdicts) return null;
  const margin = lists['verdicts.margin'][found.item];
  const isPossible = lists['verdicts.possible'][found.item] === 1;
  return { isPossible, text: isPossible ? `escape possible${margin === 65535 ? '' : ` by ${(margin / 100).toFixed(1)} s`}` : 'can be stopped' };
}

/** Rings around the evaders: whether they can escape. */
function drawVerdicts(t) {
  inPixels(paint);
  for (const robot of layerItems.verdicts.keys()) {
    const verdict = verdictOn(robot, t), state = facts.robots[robot] && robotBetween(robot, t);
    if (!verdict || !state || state.status !== 0) continue;
    const [x, y] = toScreen(state.x, state.y);
    paint.strokeStyle = verdict.isPossible ? colours.exit : colours.pursuer;
    paint.lineWidth = 2.5;
    paint.setLineDash(verdict.isPossible ? [] : [4, 3]);
    paint.beginPath();
    paint.arc(x, y, discOf(robot) + 7, 0, 2 * Math.PI);
    paint.stroke();
  }
  paint.setLineDash([]);
}
