// Layers of the map, from the lowest to the highest.

/** Minimum radius of a robot on the page (px): smaller robots are enlarged. */
const SMALLEST_DISC = 7;

function methodColour(method) { return colours.curves[(method + 1) % colours.curves.length]; }
/** Number of waypoints above which they hide the map: they are off. */
const MANY_WAYPOINTS = 200;
const some = (name) => lists[`${name}.time`].length > 0;

/** Attacks with their judgement, from the result of the run. */
const attacks = facts.attacks || [];

/** Name of the swept ground, with its share at the end. */
function sweptText() {
  const share = facts.coverage && facts.coverage.coverable_fraction;
  return Number.isFinite(share) ? `swept ground (${(100 * share).toFixed(1)} % of what can be swept, at the end)` : 'swept ground';
}

/** Colours of the times since the last visit, with their words. */
const AGES = facts.idleness.map((age, i) => [`idleness-${i}`, age === null ? 'longer' : `below ${age} s`]);

/** The layers, in the order of the legend. */
const LAYERS = [
  { id: 'ground', text: 'map, obstacles, exits', colour: 'wall', there: true, on: true },
  { id: 'dominance', text: 'dominance regions: who is first there', there: some('dominance'), on: true,
    parts: [['pursuer', facts.pursuers], ['evader', 'an evader, safely'], ['obstacle', 'an evader, but can be cut off']] },
  { id: 'swept', text: sweptText(), colour: sweepers.length ? roleOf(sweepers[0]) : 'neutral', there: sweepers.length > 0, on: false },
  { id: 'idleness', text: 'idleness: time since the last visit', there: sweepers.length > 0, on: true, parts: AGES },
  { id: 'patrols', text: 'idleness of the places of patrols', there: facts.patrols.length > 0, on: true, parts: AGES },
  { id: 'goals', text: 'goals of the robots', colour: 'exit', there: facts.task.goals.length > 0, on: true },
  { id: 'contours', text: 'contours of patrols', colour: 'ink', there: facts.task.contours.length > 0, on: true },
  { id: 'danger_zones', text: 'danger zones', colour: 'evader', there: facts.task.danger_zones.length > 0, on: true },
  { id: 'rectangles', text: 'rectangles of the free space', colour: 'faint', there: facts.task.rectangles.length > 0, on: true },
  { id: 'trails', text: 'paths so far', colour: facts.robots.length ? roleOf(0) : 'ink', there: frames > 1, on: true },
  { id: 'plans', text: 'planned paths; a ring: what the robot heads for', colour: 'plan', there: some('plans'), on: true },
  { id: 'waypoints', text: 'waypoints: reached (filled), left out (cross)', colour: 'pursuer', there: some('waypoints'),
    on: lists['waypoints.time'].length <= MANY_WAYPOINTS },
  { id: 'beliefs', text: `beliefs of ${facts.pursuers} about the evaders`, colour: 'belief', there: some('beliefs'), on: true },
  { id: 'trees', text: 'search trees', colour: 'evader', there: some('trees'), on: true },
  { id: 'sight', text: 'fields of view (lines of sight on the map)', colour: 'pursuer',
    there: facts.eyes.length > 0, on: false },
  { id: 'scans', text: 'range scans', colour: 'obstacle', there: some('scans'), on: false },
  { id: 'predictions', text: 'predictions of the observers', there: some('predictions'), on: true,
    parts: [...new Set(lists['predictions.method'])].sort().map((method) => [methodColour(method), words(facts.methods[method] || 'unknown')]) },
  { id: 'verdicts', text: 'verdicts of the referee on the evaders', there: some('verdicts'), on: true,
    parts: [['exit', 'escape possible'], ['pursuer', 'can be stopped']] },
  { id: 'attacks', text: 'attacks while they last', there: attacks.length > 0, on: true,
    parts: [['exit', 'detected, from then on'], ['pursuer', 'not detected']] },
  ...facts.marks.map((name, topic) => ({ id: `marks ${name}`, text: name, there: some('marks'), on: true,
    parts: [[markColour(topic), 'elements of the topic']] })),
  { id: 'names', text: 'names', colour: 'ink', there: true, on: true },
].filter((layer) => layer.there);
/** Layers that the reader has turned on or off. */
const chosen = { ...before?.chosen };
const shown = { ...Object.fromEntries(LAYERS.map((layer) => [layer.id, layer.on])), ...chosen };

function drawGround(t) {
  const ground = groundAt(t);
  inMetres(paint);
  const { min, max } = facts.ground;
  paint.lineWidth = 1.5 / view.scale;
  paint.strokeStyle = colours.edge;
  paint.strokeRect(min[0], min[1], max[0] - min[0], max[1] - min[1]);
  if (!shown.ground) return;
  // The outlines first: overlapping walls hide them.
  if (lists.walls.length === 0) paint.stroke(ground.walls);
  paint.fillStyle = colours.wall;
  paint.fill(ground.walls);
  paint.globalAlpha = 0.85;
  paint.fillStyle = colours.obstacle;
  paint.fill(ground.came);
  paint.globalAlpha = 0.18;
  paint.fillStyle = colours.exit;
  paint.fill(exitPath);
  paint.globalAlpha = 1;
  paint.lineWidth = 2 / view.scale;
  paint.setLineDash([5 / view.scale, 4 / view.scale]);
  paint.strokeStyle = colours.exit;
  paint.stroke(exitPath);
  paint.setLineDash([]);
}

/** Fields of view at a time: their polygons, with the roles of their robots. */
function sightAt(t) {
  const { edges } = groundAt(t);
  if (edges.length > MAX_EDGES) return [];
  return facts.eyes.map((view) => {
    const state = view.robot === undefined ? { x: view.point[0], y: view.point[1], theta: 0, status: 0, present: true }
      : robotBetween(view.robot, t);
    const looks = state.status === 0 && state.present;
    const role = view.robot === undefined ? 'neutral' : roleOf(view.robot);
    return { name: view.name, role, corners: looks ? seenFrom(state, view, edges) : [] };
  }).filter(({ corners }) => corners.length > 2);
}

function drawSight(t) {
  inMetres(paint);
  for (const { role, corners } of sightAt(t)) {
    const path = new Path2D();
    tracePath(path, { corners });
    paint.globalAlpha = 0.1;
    paint.fillStyle = colours[role];
    paint.fill(path);
    paint.globalAlpha = 0.35;
    paint.lineWidth = 1 / view.scale;
    paint.strokeStyle = colours[role];
    paint.stroke(path);
  }
  paint.globalAlpha = 1;
}

/** Calls back with the last item of every robot that is in the game. */
function eachLatest(name, t, most, draw) {
  const frame = frameAt(t);
  for (const robot of layerItems[name].keys()) {
    if (robot < facts.robots.length && robotAt(robot, frame).status !== 0) continue;
    const found = latest(name, robot, t);
    if (found && found.age <= most && found.count > 0) draw(robot, found);
  }
}

/** Age from which a belief or a scan is out of date (s). */
function oldAfter(name) {
  let longest = 2;
  for (const of of layerItems[name].values()) {
    if (of.time.length > 1) longest = Math.max(longest, 3 * (of.time[of.time.length - 1] - of.time[0]) / 1e4 / (of.time.length - 1));
  }
  return longest;
}
const OLD = Object.fromEntries(Object.keys(layerItems).map((name) => [name, oldAfter(name)]));

/** Planned paths at a time: their points (m) from where the robots were when they planned, and the points they head for. */
function plansAt(t) {
  const plans = [];
  eachLatest('plans', t, Infinity, (robot, { item, begin, count, age }) => {
    const points = [], aim = lists['plans.aim'][item];
    if (robot < facts.robots.length) {
      const { x, y } = robotAt(robot, frameAt(t - age));
      points.push([x, y]);
    }
    for (let i = begin; i < begin + count; i++) points.push([xOf(lists['plans.x'][i]), yOf(lists['plans.y'][i])]);
    plans.push({ robot, aim: aim ? points.pop() : null, points });
  });
  return plans;
}

function drawPlans(t) {
  inMetres(paint);
  for (const { robot, points, aim } of plansAt(t)) {
    paint.strokeStyle = robot < facts.robots.length ? robotColour(robot) : colours.plan;
    paint.lineWidth = 1.8 / view.scale;
    paint.setLineDash([6 / view.scale, 4 / view.scale]);
    paint.beginPath();
    points.forEach(([x, y], i) => (i ? paint.lineTo(x, y) : paint.moveTo(x, y)));
    paint.stroke();
    paint.setLineDash([]);
    if (!aim) continue;
    for (const radius of [6, 1]) {
      paint.beginPath();
      paint.arc(...aim, radius / view.scale, 0, 2 * Math.PI);
      paint.stroke();
    }
  }
}

function drawTrees(t) {
  inMetres(paint);
  const x = lists['trees.to.x'], y = lists['trees.to.y'], path = lists['trees.path'];
  const bx = lists['trees.back.x'], by = lists['trees.back.y'];
  eachLatest('trees', t, Infinity, (robot, { begin, count }) => {
    for (const chosen of [0, 1]) {
      paint.beginPath();
      for (let i = begin; i < begin + count; i++) {
        if (path[i] !== chosen) continue;
        paint.moveTo(xOf((x[i] + bx[i]) & 65535), yOf((y[i] + by[i]) & 65535));
        paint.lineTo(xOf(x[i]), yOf(y[i]));
      }
      paint.strokeStyle = robot < facts.robots.length ? robotColour(robot) : colours.plan;
      paint.globalAlpha = chosen ? 0.95 : 0.3;
      paint.lineWidth = (chosen ? 2 : 1) / view.scale;
      paint.stroke();
    }
  });
  paint.globalAlpha = 1;
}

function drawBeliefs(t) {
  inPixels(paint);
  paint.fillStyle = colours.belief;
  paint.globalAlpha = 0.6;
  const size = 2.6, boxes = lists['beliefs.box'], xs = lists['beliefs.x'], ys = lists['beliefs.y'];
  eachLatest('beliefs', t, OLD.beliefs, (robot, { item, begin, count }) => {
    const [bx, by, w, h] = boxes.subarray(4 * item, 4 * item + 4);
    for (let i = begin; i < begin + count; i++) {
      const [px, py] = toScreen(xOf(bx + xs[i] / 255 * w), yOf(by + ys[i] / 255 * h));
      paint.fillRect(px - size / 2, py - size / 2, size, size);
    }
  });
  paint.globalAlpha = 1;
  paint.strokeStyle = colours['belief-ink'];
  paint.lineWidth = 2;
  eachLatest('beliefs', t, OLD.beliefs, (robot, { item }) => {
    const [px, py] = toScreen(xOf(lists['beliefs.mean'][2 * item]), yOf(lists['beliefs.mean'][2 * item + 1]));
    paint.beginPath();
    paint.moveTo(px - 6, py); paint.lineTo(px + 6, py); paint.moveTo(px, py - 6); paint.lineTo(px, py + 6);
    paint.stroke();
  });
}

function drawScans(t) {
  inMetres(paint);
  eachLatest('scans', t, OLD.scans, (robot, { item, begin, count, age }) => {
    if (robot >= facts.robots.length) return;
    // From the pose of the scan.
    const state = robotAt(robot, frameAt(t - age));
    const angle = (n) => lists['scans.angles'][n] / 65536 * 2 * Math.PI;
    const [first, turn] = [angle(2 * item), angle(2 * item + 1)];
    paint.beginPath();
    for (let i = 0; i < count; i++) {
      const bearing = state.theta + first + (turn > Math.PI ? turn - 2 * Math.PI : turn) * i;
      const range = lists['scans.range'][begin + i] / 1e3;
      paint.moveTo(state.x, state.y);
      paint.lineTo(state.x + range * Math.cos(bearing), state.y + range * Math.sin(bearing));
    }
    paint.globalAlpha = 0.45;
    paint.lineWidth = 1 / view.scale;
    paint.strokeStyle = colours.obstacle;
    paint.stroke();
    paint.globalAlpha = 1;
  });
}

function drawPredictions(t) {
  inPixels(paint);
  eachLatest('predictions', t, OLD.predictions, (robot, { begin, count }) => {
    if (robot >= facts.robots.length) return;
    const state = robotBetween(robot, t);
    const methods = new Map();
    for (let i = begin; i < begin + count; i++) {
      if (lists['predictions.x'][i] === 65535) continue;
      const method = lists['predictions.method'][i];
      if (!methods.has(method)) methods.set(method, []);
      methods.get(method).push([facts.horizons_s[lists['predictions.horizon'][i]], i]);
    }
    for (const [method, points] of methods) {
      points.sort((a, b) => a[0] - b[0]);
      paint.strokeStyle = paint.fillStyle = methodColour(method);
      paint.lineWidth = 1.2;
      paint.beginPath();
      paint.moveTo(...toScreen(state.x, state.y));
      const places = points.map(([, i]) => toScreen(xOf(lists['predictions.x'][i]), yOf(lists['predictions.y'][i])));
      for (const place of places) paint.lineTo(...place);
      paint.globalAlpha = 0.6;
      paint.stroke();
      paint.globalAlpha = 1;
      for (const [x, y] of places) { paint.beginPath(); paint.arc(x, y, 3, 0, 2 * Math.PI); paint.fill(); }
    }
  });
}

/** A cross at each place under attack, in a ring of the distance at which guards detect it. */
function drawAttacks(t) {
  inPixels(paint);
  for (const a of attacks) {
    if (t < a.begin_s || t > a.begin_s + a.duration_s) continue;
    const [x, y] = toScreen(a.x, a.y);
    paint.strokeStyle = a.detected_s !== undefined && t >= a.detected_s ? colours.exit : colours.pursuer;
    paint.lineWidth = 2.5;
    paint.beginPath();
    paint.moveTo(x - 6, y - 6); paint.lineTo(x + 6, y + 6);
    paint.moveTo(x - 6, y + 6); paint.lineTo(x + 6, y - 6);
    paint.stroke();
    paint.lineWidth = 1.2;
    paint.beginPath();
    paint.arc(x, y, Math.max(9, a.distance_m * view.scale), 0, 2 * Math.PI);
    paint.stroke();
  }
}

/** For each waypoint the number of the next one of its robot at the same place: it is a lap old from then on. */
const nextLap = new Map();
{
  const last = new Map();
  lists['waypoints.time'].forEach((_, i) => {
    const key = [lists['waypoints.robot'][i], ...['x', 'y'].map((axis) => Math.round(lists[`waypoints.${axis}`][i] * raster.step * 20))].join();
    if (last.has(key)) nextLap.set(last.get(key), i);
    last.set(key, i);
  });
}

function drawWaypoints(t) {
  inPixels(paint);
  const until = lastUpTo(lists['waypoints.time'], ticksOf(t));
  const many = until > 600;
  for (let i = 0; i <= until; i++) {
    if (lists['waypoints.x'][i] === 65535) continue;
    const [x, y] = toScreen(xOf(lists['waypoints.x'][i]), yOf(lists['waypoints.y'][i]));
    if (x < -9 || y < -9 || x > view.width + 9 || y > view.height + 9) continue;
    const newest = i > until - 3;
    const r = newest ? 5 : many ? 2 : 3;
    paint.globalAlpha = newest ? 1 : nextLap.get(i) <= until ? 0.12 : 0.55;
    if (lists['waypoints.outcome'][i] === 0) {
      paint.fillStyle = colours.pursuer;
      paint.fillRect(x - r, y - r, 2 * r, 2 * r);
    } else {
      paint.strokeStyle = colours.evader;
      paint.lineWidth = 1.6;
      paint.beginPath();
      paint.moveTo(x - r, y - r); paint.lineTo(x + r, y + r); paint.moveTo(x + r, y - r); paint.lineTo(x - r, y + r);
      paint.stroke();
    }
  }
  paint.globalAlpha = 1;
}

/** Radius of a robot's disc on the page (px). */
const discOf = (robot) => Math.max(SMALLEST_DISC, facts.robots[robot].radius * view.scale);

function drawRobots(t, followed) {
  inPixels(paint);
  for (let robot = 0; robot < facts.robots.length; robot++) {
    const state = robotBetween(robot, t);
    if (!state.present) continue;
    const [x, y] = toScreen(state.x, state.y);
    const r = discOf(robot);
    paint.globalAlpha = state.status === 0 ? 1 : PALE;
    paint.fillStyle = robotColour(robot);
    paint.strokeStyle = colours.paper;
    paint.lineWidth = 2;
    paint.beginPath();
    paint.arc(x, y, r, 0, 2 * Math.PI);
    paint.fill();
    paint.stroke();
    // Heading.
    const nose = ([angle, far]) => [x + far * r * Math.cos(state.theta + angle), y - far * r * Math.sin(state.theta + angle)];
    paint.beginPath();
    [[0, 1.75], [0.55, 1], [-0.55, 1]].map(nose).forEach((p, i) => (i ? paint.lineTo(...p) : paint.moveTo(...p)));
    paint.closePath();
    paint.fill();
    paint.globalAlpha = 1;
    // Within this ring, the centre of an evader is caught.
    if (facts.capture_m && state.status === 0 && roleOf(robot) === 'pursuer') {
      paint.strokeStyle = robotColour(robot);
      paint.lineWidth = 1;
      paint.beginPath();
      paint.arc(x, y, facts.capture_m * view.scale, 0, 2 * Math.PI);
      paint.stroke();
    }
    if (robot === followed || state.failSafe || state.inContact) {
      paint.strokeStyle = state.failSafe || state.inContact ? colours.obstacle : colours.ink;
      paint.lineWidth = 2;
      paint.beginPath();
      paint.arc(x, y, r + 4, 0, 2 * Math.PI);
      paint.stroke();
    }
  }
}

/** Symbols at which robots were caught, escaped or arrived. */
function drawMarks(t) {
  inPixels(paint);
  for (const [time, kind, robot, , ex, ey] of facts.events) {
    if (time > t + 1e-6) break;
    const name = facts.event_kinds[kind];
    if (!['captured', 'escaped', 'goal_reached'].includes(name)) continue;
    const [x, y] = toScreen(ex, ey);
    paint.strokeStyle = robot === null ? colours.ink : robotColour(robot);
    if (name === 'captured') {
      for (const [width, colour] of [[6, paint.strokeStyle], [3, colours.ink]]) {
        paint.strokeStyle = colour;
        paint.lineWidth = width;
        paint.lineCap = 'round';
        paint.beginPath();
        paint.moveTo(x - 7, y - 7); paint.lineTo(x + 7, y + 7); paint.moveTo(x + 7, y - 7); paint.lineTo(x - 7, y + 7);
        paint.stroke();
      }
    } else {
      paint.fillStyle = colours.exit;
      paint.lineWidth = 2;
      paint.beginPath();
      paint.moveTo(x, y - 9); paint.lineTo(x + 9, y); paint.lineTo(x, y + 9); paint.lineTo(x - 9, y);
      paint.closePath();
      paint.fill();
      paint.stroke();
    }
  }
}

/** Distances between a name and its robot (px), the preferred first. */
const NAME_GAPS = [0, 11, 22, 33];

/** Left ends of a text of this width beside a point, at a distance (px). */
function besides(x, y, far, width) {
  const left = x - far - width, right = x + far, middle = x - width / 2, high = Math.max(far, 13);
  return [[right, y - far], [right, y + far], [left, y - far], [left, y + far], [right, y], [left, y], [middle, y - high], [middle, y + high]];
}

/** Places of the names beside the robots: each where it covers no robot and no other name, or none. */
function placeNames(t) {
  paint.font = `${view.width < 500 ? 11 : 13}px system-ui, sans-serif`;
  const taken = facts.robots.map((_, robot) => {
    const state = robotBetween(robot, t);
    const [x, y] = toScreen(state.x, state.y);
    const r = discOf(robot);
    return [x - r, y - r, x + r, y + r];
  });
  const boxOf = ([px, py], width) => [px - 1, py - 8, px + width + 1, py + 8];
  const isFree = ([left, top, right, bottom]) => left >= 0 && top >= 0 && right <= view.width && bottom <= view.height
    && taken.every((other) => right < other[0] || left > other[2] || bottom < other[1] || top > other[3]);
  const placed = [];
  for (let robot = 0; robot < facts.robots.length; robot++) {
    const state = robotBetween(robot, t);
    if (!state.present) continue;
    const verdict = shown.verdicts && state.status === 0 ? verdictOn(robot, t) : null;
    const text = facts.robots[robot].name + (verdict ? `: ${verdict.text}` : '');
    const from = toScreen(state.x, state.y);
    const disc = 1.3 * discOf(robot), far = disc + (verdict ? 8 : 4);
    const width = paint.measureText(text).width;
    for (const gap of NAME_GAPS) {
      const at = besides(...from, far + gap, width).find((place) => isFree(boxOf(place, width)));
      if (!at) continue;
      const box = boxOf(at, width);
      taken.push(box);
      placed.push({ text, at, box, from, disc, isFar: gap > 0, isOut: state.status !== 0 });
      break;
    }
  }
  return placed;
}

/** Names beside the robots, with a line to the robot where it is not near. */
function drawNames(t) {
  inPixels(paint);
  paint.textBaseline = 'middle';
  paint.lineJoin = 'round';
  for (const { text, at, box, from: [x, y], disc, isFar, isOut } of placeNames(t)) {
    paint.strokeStyle = paint.fillStyle = isOut ? colours.faint : colours.ink;
    if (isFar) {
      const to = [Math.min(Math.max(x, box[0]), box[2]), Math.min(Math.max(y, box[1]), box[3])];
      const part = disc / Math.hypot(to[0] - x, to[1] - y);
      paint.lineWidth = 1;
      paint.beginPath(); paint.moveTo(x + part * (to[0] - x), y + part * (to[1] - y)); paint.lineTo(...to); paint.stroke();
    }
    paint.lineWidth = 3.5;
    paint.strokeStyle = colours.paper;
    paint.strokeText(text, ...at);
    paint.fillText(text, ...at);
  }
}

function drawScaleBar() {
  inPixels(paint);
  let metres = 1e-3;
  for (const step of [2, 2.5, 2, 2, 2.5, 2, 2, 2.5, 2, 2, 2.5, 2, 2, 2.5, 2, 2, 2.5, 2]) {
    if (metres * view.scale >= 60) break;
    metres *= step;
  }
  metres = Math.round(metres * 1e3) / 1e3;
  const [x, y, long] = [14, view.height - 7, metres * view.scale];
  paint.strokeStyle = paint.fillStyle = colours.ink;
  paint.lineWidth = 2;
  paint.beginPath();
  paint.moveTo(x, y - 5); paint.lineTo(x, y + 5); paint.moveTo(x, y); paint.lineTo(x + long, y);
  paint.moveTo(x + long, y - 5); paint.lineTo(x + long, y + 5);
  paint.stroke();
  paint.font = '13px system-ui, sans-serif';
  paint.textBaseline = 'middle';
  paint.lineWidth = 3;
  paint.strokeStyle = colours.paper;
  paint.strokeText(`${metres} m`, x + long + 8, y);
  paint.fillText(`${metres} m`, x + long + 8, y);
}

/** Draws all layers at a time. */
function drawMap(t, followed, trail) {
  paint.setTransform(1, 0, 0, 1, 0, 0);
  paint.fillStyle = colours.paper;
  paint.fillRect(0, 0, map.width, map.height);
  drawGround(t);
  if (shown.dominance) drawDominance(t);
  if (shown.sight) drawSight(t);
  if (shown.trees) drawTrees(t);
  if (shown.swept) drawSwept(t, Infinity);
  if (shown.idleness) drawIdleness(t);
  if (shown.patrols) drawPatrols(t);
  drawTask();
  if (shown.trails) drawTrails(t, trail);
  if (shown.waypoints) drawWaypoints(t);
  if (shown.beliefs) drawBeliefs(t);
  if (shown.scans) drawScans(t);
  if (shown.plans) drawPlans(t);
  if (shown.predictions) drawPredictions(t);
  if (shown.attacks) drawAttacks(t);
  drawMarkTopics(t);
  drawMarks(t);
  drawRobots(t, followed);
  if (shown.verdicts) drawVerdicts(t);
  if (shown.names) drawNames(t);
  drawScaleBar();
}
