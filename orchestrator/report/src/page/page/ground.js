// The static scene: walls, obstacles that change, exits; and lines of sight.

/** A shape as a closed path: corners, or a disc. */
function tracePath(path, shape) {
  if (shape.circle) {
    const [x, y, r] = shape.circle;
    path.moveTo(x + r, y);
    path.arc(x, y, r, 0, 2 * Math.PI);
  } else if (shape.corners && shape.corners.length) {
    shape.corners.forEach(([x, y], i) => (i ? path.lineTo(x, y) : path.moveTo(x, y)));
    path.closePath();
  }
}

function cornersOf(shape) {
  if (!shape.circle) return shape.corners || [];
  const [x, y, r] = shape.circle;
  return Array.from({ length: 24 }, (_, i) => [x + r * Math.cos(i * Math.PI / 12), y + r * Math.sin(i * Math.PI / 12)]);
}

const exitPath = new Path2D();
for (const exit of facts.ground.exits) tracePath(exitPath, exit);

let groundCache = null;

/** The static scene at a time: paths of the map and of changed obstacles, and the edges of both. */
function groundAt(t) {
  const { obstacles, changes } = facts.ground;
  let revision = 0;
  while (revision < changes.length && changes[revision].time <= t + 1e-6) revision++;
  if (groundCache && groundCache.revision === revision) return groundCache;
  const standing = new Map(obstacles.map((o) => [o.id, { shape: o, came: false }]));
  for (const change of changes.slice(0, revision)) {
    if (change.circle || change.corners) standing.set(change.id, { shape: change, came: true });
    else standing.delete(change.id);
  }
  const walls = new Path2D(), came = new Path2D();
  const edges = [];
  const outline = (corners) => corners.forEach((a, i) => {
    const b = corners[(i + 1) % corners.length];
    edges.push([a[0], a[1], b[0], b[1]]);
  });
  for (const { shape, came: late } of standing.values()) {
    tracePath(late ? came : walls, shape);
    outline(cornersOf(shape));
  }
  const cells = lists.walls;
  for (let i = 0; i + 3 < cells.length; i += 4) {
    const [x0, y0, x1, y1] = [xOf(cells[i]), yOf(cells[i + 1]), xOf(cells[i + 2]), yOf(cells[i + 3])];
    walls.rect(x0, y0, x1 - x0, y1 - y0);
    outline([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]);
  }
  const { min, max } = facts.ground;
  outline([[min[0], min[1]], [max[0], min[1]], [max[0], max[1]], [min[0], max[1]]]);
  groundCache = { revision, walls, came, edges };
  return groundCache;
}

/** Maximum number of edges for which lines of sight are drawn. */
const MAX_EDGES = 3000;

/** Area visible from a position within a range and a field of view (none: all): corners of a polygon. */
function seenFrom({ x, y, theta }, { range, field_of_view: opening }, edges) {
  const angles = [];
  if (edges.length <= 200) {
    for (const [ax, ay] of edges) {
      const angle = Math.atan2(ay - y, ax - x);
      angles.push(angle - 1e-4, angle, angle + 1e-4);
    }
  }
  if (edges.length > 200 || range) for (let i = -180; i < 180; i++) angles.push(i * Math.PI / 180);
  const turn = Math.min(opening ?? 2 * Math.PI, 2 * Math.PI);
  // Begins at the right end of the field of view.
  const begin = turn < 2 * Math.PI ? theta - turn / 2 : -Math.PI;
  const relative = (angle) => (angle - begin) - 2 * Math.PI * Math.floor((angle - begin) / (2 * Math.PI));
  const within = angles.map(relative).filter((angle) => angle <= turn);
  if (turn < 2 * Math.PI) within.push(0, turn);
  within.sort((a, b) => a - b);
  const corners = within.map((angle) => {
    const dx = Math.cos(begin + angle), dy = Math.sin(begin + angle);
    let nearest = range ?? Infinity;
    for (const [ax, ay, bx, by] of edges) {
      const ex = bx - ax, ey = by - ay;
      const across = dx * ey - dy * ex;
      if (across === 0) continue;
      const far = ((ax - x) * ey - (ay - y) * ex) / across;
      const along = ((ax - x) * dy - (ay - y) * dx) / across;
      if (far > 0 && far < nearest && along >= 0 && along <= 1) nearest = far;
    }
    return nearest === Infinity ? null : [x + nearest * dx, y + nearest * dy];
  }).filter(Boolean);
  if (turn < 2 * Math.PI) corners.push([x, y]);
  return corners;
}
