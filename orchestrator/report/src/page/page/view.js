// The map's canvas: which part of the world it shows.

const map = $('map');
const paint = map.getContext('2d');
const view = { x: 0, y: 0, scale: 50, width: 1, height: 1, ratio: 1 };
const colours = {};

/** Takes the colours of the light or dark scheme from the style sheet. */
function readColours() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ['paper', 'wall', 'edge', 'ink', 'faint', 'obstacle', 'exit', 'belief', 'belief-ink',
    'card', 'line', 'plan']) colours[name] = style.getPropertyValue(`--${name}`).trim();
  colours.shades = {};
  for (const role of ['pursuer', 'evader', 'neutral']) {
    colours.shades[role] = [0, 1, 2, 3].map((shade) => style.getPropertyValue(`--${role}-${shade}`).trim());
    [colours[role]] = colours.shades[role];
  }
  colours.idleness = facts.idleness.map((_, i) => style.getPropertyValue(`--idleness-${i}`).trim());
  colours.curves = [colours.pursuer, colours.evader, colours.exit, colours.belief, colours.obstacle, colours.ink,
    '#7a6cc9', '#a0522d', '#56b4e9', '#999933'];
}
readColours();

/** Role of a robot. */
const roleOf = (robot) => facts.robots[robot].role;
/** Place of a robot among those of its role. */
const places = facts.robots.map((_, robot) => facts.robots.slice(0, robot).filter((_, other) => roleOf(other) === roleOf(robot)).length);
/** Colour of a robot: a shade of its role's. */
const robotColour = (robot) => colours.shades[roleOf(robot)][places[robot] % 4];
/** Paler colour of robots that have left the game, as in `protean picture`. */
const PALE = 0.45;

/** Fits a canvas to its element on the page; returns true if its size changed. */
function fitCanvas(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
  const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
  if (canvas.width === width && canvas.height === height) return false;
  canvas.width = width;
  canvas.height = height;
  return true;
}

function fitView() {
  const { min, max } = facts.ground;
  view.x = (min[0] + max[0]) / 2;
  view.y = (min[1] + max[1]) / 2;
  const margin = 14;
  view.scale = Math.max(1e-3, Math.min((view.width - 2 * margin) / (max[0] - min[0]), (view.height - 2 * margin) / (max[1] - min[1])));
}

function resizeView() {
  const first = view.width === 1;
  fitCanvas(map);
  view.ratio = window.devicePixelRatio || 1;
  const fits = first || view.fitted;
  view.width = map.clientWidth;
  view.height = map.clientHeight;
  if (fits) { fitView(); view.fitted = true; }
}

/** The map has the shape of the world, within limits. */
{
  const { min, max } = facts.ground;
  const shape = (max[0] - min[0]) / (max[1] - min[1]);
  $('stage').parentElement.style.setProperty('--shape', String(Math.min(2.4, Math.max(0.8, shape || 1))));
}

const toScreen = (x, y) => [view.width / 2 + (x - view.x) * view.scale, view.height / 2 - (y - view.y) * view.scale];
const toWorld = (px, py) => [view.x + (px - view.width / 2) / view.scale, view.y - (py - view.height / 2) / view.scale];

/** Draws in pixels of the page. */
function inPixels(ctx) { ctx.setTransform(view.ratio, 0, 0, view.ratio, 0, 0); }

/** Draws in metres of the world, y up. */
function inMetres(ctx) {
  const s = view.scale * view.ratio;
  ctx.setTransform(s, 0, 0, -s, (view.width / 2 - view.x * view.scale) * view.ratio, (view.height / 2 + view.y * view.scale) * view.ratio);
}

/** Zooms by a factor about a point on the canvas. */
function zoom(factor, px = view.width / 2, py = view.height / 2) {
  const [x, y] = toWorld(px, py);
  view.scale = Math.min(5000, Math.max(0.05, view.scale * factor));
  const [nx, ny] = toWorld(px, py);
  view.x += x - nx;
  view.y += y - ny;
  view.fitted = false;
}
