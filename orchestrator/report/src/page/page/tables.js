// Texts and tables.

/** A table; the first row contains its headings, columns named in `texts` are left-aligned. */
function table(headings, rows, texts = [0]) {
  const cell = (tag) => (value, i) => {
    const made = element(tag, texts.includes(i) ? { className: 'text' } : {});
    made.append(value instanceof Node ? value : String(value));
    return made;
  };
  const body = rows.map((row) => element('tr', {}, ...row.map(cell('td'))));
  return element('table', {}, element('thead', {}, element('tr', {}, ...headings.map(cell('th')))), element('tbody', {}, ...body));
}

function card(title, content) {
  $('more').append(element('section', { className: 'card scroll' }, element('h2', { textContent: title }), content));
}

$('title').textContent = facts.title || facts.scenario || 'Mission';
$('source').textContent = [facts.scenario, facts.seed && `seed ${facts.seed}`].filter(Boolean).join(', ');
$('result').textContent = facts.live && !facts.over ? '' : facts.result;
$('caption').textContent = facts.description.trim();
if (facts.missing.length) {
  $('missing').hidden = false;
  for (const line of facts.missing) $('missing').append(element('li', { textContent: line }));
}

function named(name, colour) {
  const dot = element('span', { className: 'dot' });
  dot.style.background = colour;
  return element('span', { className: 'named' }, dot, element('span', {}, name));
}
if (facts.outcome.length) {
  const colourOf = (robot) => (facts.robots[robot] ? `var(--${roleOf(robot)}-${places[robot] % 4})` : 'var(--ink)');
  const rows = facts.outcome.map((r, robot) => ({ ...r, named: named(r.name, colourOf(robot)) }));
  $('outcome').append(table(['robot', 'outcome', 'time [s]', 'driven [m]', 'contacts'],
    rows.map((r) => [r.named, r.outcome === 'active' && facts.over ? 'to the end' : words(r.outcome), timeText(r.time_s), r.distance_m.toFixed(2), r.contacts]), [0, 1]));
  const judged = rows.filter((r) => r.escape_possible_fraction !== undefined);
  if (judged.length) {
    $('outcome').append(table(['verdicts of the referee', 'escape possible', 'impossible from [s]'], judged.map((r) => [
      r.named.cloneNode(true), `${(100 * r.escape_possible_fraction).toFixed(0)} %`, r.escape_impossible_from_s === undefined ? '–' : timeText(r.escape_impossible_from_s),
    ])));
  }
} else {
  $('outcome').textContent = 'not in the log';
}

const describe = (name, text) => {
  if (text !== null && text !== undefined && text !== '') $('run').append(element('dt', { textContent: name }), element('dd', { textContent: text }));
};
describe('scenario', facts.scenario);
describe('seed', facts.seed);
describe('simulated', `${timeText(facts.end_s)} s in ticks of ${+facts.tick_period_s.toPrecision(6)} s${facts.over ? '' : facts.live ? ' so far' : ' (not to its end)'}`);
for (const b of facts.branches || []) describe('branch', `of ${b.parent} from ${timeText(b.at_s)} s on, with ${JSON.stringify(b.change)}`);
describe('mode', facts.mode && words(facts.mode));
describe('digest', facts.digest || (facts.run_digest ? `of the whole run: ${facts.run_digest}` : facts.live ? 'at the end of the run' : 'not in the log'));
describe('version', facts.version);
describe('machine', facts.machine);
describe('messages', facts.messages);

if (facts.coverage) {
  const c = facts.coverage;
  card('Area visited', table(['of the free area', 'of what robots can visit', 'free [m²]', 'visited [m²]', 'mean idleness [s]', 'worst idleness [s]', 'unevenness', 'way [m]'],
    [[`${(100 * c.fraction).toFixed(1)} %`, `${(100 * c.coverable_fraction).toFixed(1)} %`, short(c.free_m2), short(c.visited_m2),
      short(c.mean_idleness_s), short(c.worst_idleness_s), short(c.unevenness), short(c.way_m)]]));
}
const visitors = facts.outcome.filter((r) => r.waypoints);
if (visitors.length) {
  const numbers = (w) => Object.entries(w).filter(([, value]) => typeof value === 'number');
  const keys = numbers(visitors[0].waypoints).map(([key]) => key);
  card('Waypoints', table(['robot', ...keys.map((key) => words(key).replace(/ (m|s)$/, ' [$1]'))], visitors.map((r) => [r.name, ...keys.map((key) => short(r.waypoints[key] ?? NaN))])));
}
if (facts.predictions) {
  const horizons = [...new Set(facts.predictions.map((p) => p.horizon_s))].sort((a, b) => a - b);
  const rows = new Map();
  for (const p of facts.predictions) {
    const key = `${p.observer} ${p.robot} ${p.method}`;
    if (!rows.has(key)) rows.set(key, { p, at: new Map() });
    rows.get(key).at.set(p.horizon_s, p.mean_m);
  }
  card('Predictions: mean error [m]', table(['robot', 'by', ...horizons.map((h) => `${h} s ahead`), 'goals made out', 'key found'],
    [...rows.values()].map(({ p, at }) => [p.robot, words(p.method), ...horizons.map((h) => (at.get(h) === undefined ? '–' : short(at.get(h)))),
      p.goals_observed, p.key_recovered_s === undefined ? '–' : `${timeText(p.key_recovered_s)} s`]), [0, 1]));
}
if (attacks.length) {
  card('Attacks', table(['attacker', 'by', 'begin [s]', 'place [m]', 'for [s]', 'outcome', 'detected at [s]'],
    attacks.map((a) => [a.attacker, words(a.method), timeText(a.begin_s), `${short(a.x)}, ${short(a.y)}`, short(a.duration_s),
      a.outcome, a.detected_s === undefined ? '–' : timeText(a.detected_s)]), [0, 1, 5]));
}
const unplotted = facts.latency.filter((hop) => !hop.histogram);
if (unplotted.length) {
  $('latency').append(element('section', { className: 'card scroll' }, table(['hop', 'p50', 'p90', 'p99', 'max'],
    unplotted.map(({ name, us }) => [words(name), ...[us.p50, us.p90, us.p99, us.max].map(duration)]))));
}
$('scenario').textContent = facts.text;

/** A colour of the style sheet by name, or any colour. */
const cssColour = (colour) => (colour.startsWith('#') ? colour : `var(--${colour})`);
function swatch(colour, className) {
  const made = element('span', { className });
  made.style.background = cssColour(colour);
  return made;
}
for (const layer of LAYERS) {
  const box = element('input', { type: 'checkbox', checked: shown[layer.id], id: `layer-${layer.id}` });
  const label = element('label', {}, box, ...(layer.colour ? [swatch(layer.colour, 'swatch')] : []), layer.text);
  box.addEventListener('change', () => { chosen[layer.id] = shown[layer.id] = box.checked; clock.redraw(); });
  const parts = (layer.parts || []).map(([colour, text]) => element('span', {}, swatch(colour, 'dash'), text));
  $('layers').append(element('li', {}, label, ...(parts.length ? [element('div', { className: 'legend' }, ...parts)] : [])));
}
