// Paths of the robots, swept ground, and the geometry of their tasks.

/** The trail of one robot between two states, simplified to the visible detail. */
function strokeWay(ctx, robot, from, to) {
  const base = robot * frames;
  const nearest = 1 / view.scale;
  ctx.beginPath();
  let [lx, ly] = [xOf(lists.x[base + from]), yOf(lists.y[base + from])];
  ctx.moveTo(lx, ly);
  for (let i = from + 1; i <= to; i++) {
    const x = xOf(lists.x[base + i]), y = yOf(lists.y[base + i]);
    if (i === to || Math.abs(x - lx) + Math.abs(y - ly) > nearest) {
      ctx.lineTo(x, y);
      lx = x; ly = y;
    }
  }
  ctx.stroke();
}

/** Margin of the trails' canvas beyond the map on each side, relative to the map's size. */
const BEYOND = 0.4;

/** A layer of paths: draws them up to a time, each robot's with a width (m), 0 for none. They have a separate canvas,
 * larger than the map: while the view is still or moves a little (following a robot), only new parts are drawn. */
function pathLayer(widthOf, opacity) {
  const canvas = document.createElement('canvas');
  const ctx = canvas.getContext('2d');
  let state = null;
  return (t, length) => {
    const frame = frameAt(t);
    const from = length === Infinity ? 0 : frameAt(t - length);
    const key = [view.scale, map.width, map.height, view.ratio, colours.pursuer, length].join();
    const beyond = [Math.round(map.width * BEYOND), Math.round(map.height * BEYOND)];
    const pixels = view.scale * view.ratio;
    const moved = () => [(view.x - state.x) * pixels, (state.y - view.y) * pixels];
    const goesOn = state && state.key === key && state.frame <= frame && length === Infinity
      && moved().every((d, i) => Math.abs(d) <= beyond[i]);
    if (!goesOn) {
      canvas.width = map.width + 2 * beyond[0];
      canvas.height = map.height + 2 * beyond[1];
      state = { x: view.x, y: view.y };
    }
    ctx.setTransform(pixels, 0, 0, -pixels, canvas.width / 2 - state.x * pixels, canvas.height / 2 + state.y * pixels);
    ctx.lineCap = ctx.lineJoin = 'round';
    const begin = goesOn ? state.frame : from;
    const robots = facts.robots.map((_, robot) => robot).filter((robot) => widthOf(robot) > 0);
    for (const robot of frame > begin ? robots : []) {
      ctx.lineWidth = widthOf(robot);
      ctx.strokeStyle = robotColour(robot);
      strokeWay(ctx, robot, begin, frame);
    }
    state = { key, frame, x: state.x, y: state.y };
    const [dx, dy] = moved();
    paint.setTransform(1, 0, 0, 1, 0, 0);
    paint.globalAlpha = opacity;
    paint.drawImage(canvas, -beyond[0] - dx, -beyond[1] - dy);
    paint.globalAlpha = 1;
    // The last part, to the robots' interpolated positions.
    inMetres(paint);
    paint.globalAlpha = opacity;
    for (const robot of robots) {
      const a = robotAt(robot, frame), b = robotBetween(robot, t);
      paint.lineWidth = widthOf(robot);
      paint.strokeStyle = robotColour(robot);
      paint.beginPath();
      paint.moveTo(a.x, a.y);
      paint.lineTo(b.x, b.y);
      paint.stroke();
    }
    paint.globalAlpha = 1;
  };
}

const drawTrails = pathLayer(() => 2.4 / view.scale, 0.55);
const drawSwept = pathLayer((robot) => 2 * (facts.robots[robot].sweeps || 0), 0.2);

/** Geometry of the robots' tasks: goals, danger zones, rectangles of the free space, contours. */
function drawTask() {
  inMetres(paint);
  const { goals, contours, danger_zones: zones, rectangles } = facts.task;
  if (shown.goals) {
    paint.strokeStyle = colours.exit;
    paint.lineWidth = 1.6 / view.scale;
    for (const goal of goals) {
      const path = new Path2D();
      // A small disc is drawn larger.
      tracePath(path, goal.circle ? { circle: [...goal.circle.slice(0, 2), Math.max(goal.circle[2], 5 / view.scale)] } : goal);
      paint.stroke(path);
    }
  }
  if (shown.danger_zones) {
    const zonePath = new Path2D();
    for (const zone of zones) tracePath(zonePath, zone);
    paint.globalAlpha = 0.12;
    paint.fillStyle = paint.strokeStyle = colours.evader;
    paint.fill(zonePath);
    paint.globalAlpha = 1;
    paint.lineWidth = 1.5 / view.scale;
    paint.setLineDash([2 / view.scale, 3 / view.scale]);
    paint.stroke(zonePath);
  }
  if (shown.rectangles) {
    paint.strokeStyle = colours.faint;
    paint.lineWidth = 1 / view.scale;
    paint.setLineDash([5 / view.scale, 3 / view.scale]);
    for (const [[x0, y0], [x1, y1]] of rectangles) paint.strokeRect(x0, y0, x1 - x0, y1 - y0);
  }
  paint.setLineDash([]);
  if (!shown.contours) return;
  paint.strokeStyle = colours.ink;
  paint.lineWidth = 1.6 / view.scale;
  for (const contour of contours) {
    paint.beginPath();
    contour.forEach(([x, y], i) => (i ? paint.lineTo(x, y) : paint.moveTo(x, y)));
    paint.stroke();
  }
}
