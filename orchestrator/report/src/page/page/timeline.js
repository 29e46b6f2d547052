// The events of the run on a time axis.

const LANES = [
  { text: 'caught', kinds: ['captured'], colour: 'police' },
  { text: 'escaped, arrived', kinds: ['escaped', 'goal_reached'], colour: 'exit' },
  { text: 'obstacles', kinds: ['obstacle', 'pushed_out', 'trapped', 'released'], colour: 'obstacle' },
  { text: 'contacts', kinds: ['contact_begin', 'contact_end'], colour: 'evader' },
  { text: 'command errors', kinds: ['invalid_command', 'missing_command'], colour: 'belief-ink' },
  { text: 'standstills, ends', kinds: ['stands', 'timed_out', 'game_over'], colour: 'ink' },
];
/** Names of kinds of events, as in `protean picture`. */
const EVENT_WORDS = { captured: 'caught', goal_reached: 'arrived', obstacle: 'obstacle changed' };
const eventsCanvas = $('events');
const LANE = 17, GUTTER = 118, RIGHT = 12;

/** Markers: time, lane, text; `small` for one of many. */
const markers = facts.events.map(([time, kind, robot, other]) => {
  const name = facts.event_kinds[kind] || 'unknown';
  const who = robot === null ? '' : `${facts.robots[robot] ? facts.robots[robot].name : `robot ${robot}`} `;
  let by = '';
  if (name === 'captured' && other !== null && facts.robots[other]) by = ` by ${facts.robots[other].name}`;
  else if (name.startsWith('contact') && other !== null && facts.robots[other]) by = `: ${facts.robots[other].name}`;
  else if (name === 'obstacle' && other !== null) by = ` (${other})`;
  return { time, lane: LANES.findIndex((lane) => lane.kinds.includes(name)), text: `${who}${EVENT_WORDS[name] || words(name)}${by}` };
});
const waypointTimes = lists['waypoints.time'];
if (waypointTimes.length) {
  LANES.push({ text: 'waypoints', kinds: [], colour: 'exit' });
  for (let i = 0; i < waypointTimes.length; i++) {
    const outcome = facts.waypoint_outcomes[lists['waypoints.outcome'][i]] || 'unknown';
    const reached = outcome === 'reached';
    const robot = facts.robots[lists['waypoints.robot'][i]];
    markers.push({
      time: waypointTimes[i] / 1e4, lane: LANES.length - 1, small: true, colour: reached ? 'exit' : 'evader',
      text: `${robot ? robot.name : ''}: waypoint ${reached ? 'reached' : `left out (${words(outcome)})`}`,
    });
  }
}
markers.sort((a, b) => a.time - b.time);
const usedLanes = LANES.map((_, i) => i).filter((i) => markers.some((m) => m.lane === i));
for (const marker of markers) marker.row = usedLanes.indexOf(marker.lane);
const markerTimes = markers.map((m) => m.time);

const eventX = (t) => GUTTER + (eventsCanvas.clientWidth - GUTTER - RIGHT) * (end > 0 ? t / end : 0);
const eventT = (x) => Math.min(end, Math.max(0, (x - GUTTER) / (eventsCanvas.clientWidth - GUTTER - RIGHT) * end));
let eventPicture = null;

/** Round steps of an axis: about `count` of them between two values. */
function axisSteps(from, to, count) {
  const rough = Math.max((to - from) / count, 1e-12);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((s) => s * power >= rough * 0.999) * power;
  const steps = [];
  for (let i = Math.ceil(from / step - 1e-9); i * step <= to + step * 1e-9; i++) steps.push(+(i * step).toPrecision(10));
  return steps;
}

function drawEventPicture() {
  const height = Math.max(1, usedLanes.length) * LANE + 20;
  eventsCanvas.style.height = `${height}px`;
  fitCanvas(eventsCanvas);
  const ratio = window.devicePixelRatio || 1;
  eventPicture = document.createElement('canvas');
  eventPicture.width = eventsCanvas.width;
  eventPicture.height = eventsCanvas.height;
  const ctx = eventPicture.getContext('2d');
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  ctx.font = '12px system-ui, sans-serif';
  ctx.textBaseline = 'middle';
  const bottom = height - 20;
  for (const t of axisSteps(0, end, 10)) {
    ctx.strokeStyle = colours.line;
    ctx.beginPath(); ctx.moveTo(eventX(t), 0); ctx.lineTo(eventX(t), bottom); ctx.stroke();
    ctx.fillStyle = colours.faint;
    ctx.textAlign = 'center';
    ctx.fillText(`${t} s`, Math.min(eventX(t), eventsCanvas.clientWidth - 16), bottom + 11);
  }
  usedLanes.forEach((lane, row) => {
    ctx.fillStyle = colours.faint;
    ctx.textAlign = 'right';
    ctx.fillText(LANES[lane].text, GUTTER - 10, row * LANE + LANE / 2);
  });
  if (!usedLanes.length) {
    ctx.fillStyle = colours.faint;
    ctx.textAlign = 'right';
    ctx.fillText('no events', GUTTER - 10, LANE / 2);
  }
  for (const marker of markers) {
    if (marker.row < 0) continue;
    const x = eventX(marker.time), y = marker.row * LANE + LANE / 2;
    ctx.fillStyle = colours[marker.colour || LANES[marker.lane].colour];
    if (marker.small) ctx.fillRect(x - 1, y - 6, 2, 12);
    else { ctx.beginPath(); ctx.arc(x, y, 5, 0, 2 * Math.PI); ctx.fill(); }
  }
}

function drawEvents(t) {
  if (!eventPicture) drawEventPicture();
  const ctx = eventsCanvas.getContext('2d');
  ctx.setTransform(1, 0, 0, 1, 0, 0);
  ctx.clearRect(0, 0, eventsCanvas.width, eventsCanvas.height);
  ctx.drawImage(eventPicture, 0, 0);
  const ratio = window.devicePixelRatio || 1;
  ctx.fillStyle = colours.ink;
  ctx.fillRect(Math.round((eventX(t) - 0.75) * ratio), 0, Math.round(1.5 * ratio), eventsCanvas.height - 20 * ratio);
}

/** The marker under a point of the canvas. */
function markerAt(x, y) {
  let best = null, least = 8;
  for (const marker of markers) {
    if (marker.row < 0 || Math.abs(y - marker.row * LANE - LANE / 2) > LANE / 2) continue;
    const away = Math.abs(x - eventX(marker.time));
    if (away < least) { least = away; best = marker; }
  }
  return best;
}

const sayMarker = (marker) => (marker ? `${marker.time.toFixed(2)} s: ${marker.text}` : '');
