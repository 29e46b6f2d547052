// The events of the run on a time axis; of two runs on one axis.

const LANES = [
  { text: 'caught', kinds: ['captured'], colour: 'pursuer' },
  { text: 'escaped, arrived', kinds: ['escaped', 'goal_reached'], colour: 'exit' },
  { text: 'pursuits', kinds: ['sighted', 'lost', 'returned'], colour: 'pursuer' },
  { text: 'obstacles', kinds: ['obstacle', 'pushed_out', 'trapped', 'released'], colour: 'obstacle' },
  { text: 'contacts', kinds: ['contact_begin', 'contact_end'], colour: 'evader' },
  { text: 'command errors', kinds: ['invalid_command', 'missing_command'], colour: 'belief-ink' },
  { text: 'standstills, ends', kinds: ['stands', 'timed_out', 'game_over'], colour: 'ink' },
];
const eventsCanvas = $('events');
const LANE = 17, GUTTER = 118, RIGHT = 14;

/** Markers: time, lane, text; `small` for one of many. */
const markers = facts.events.map(([time, kind, , , , , , text]) => {
  const name = facts.event_kinds[kind];
  return { time, lane: LANES.findIndex((lane) => lane.kinds.includes(name)), text };
});
/** Time at which the page opens: shortly before the first event that decides something, else early in the run. */
const opening = (() => {
  const first = (...kinds) => facts.events.find(([, kind]) => kinds.includes(facts.event_kinds[kind]))?.[0];
  const decisive = first('captured', 'escaped', 'goal_reached') ?? first('obstacle');
  return decisive === undefined ? end / 4 : Math.max(0, decisive - 5);
})();
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
/** The markers on the axis: those of this run, and of another one on the same axis. */
let shownMarkers = markers, usedLanes = [];
function layRows() {
  usedLanes = LANES.map((_, i) => i).filter((i) => shownMarkers.some((m) => m.lane === i));
  for (const marker of shownMarkers) marker.row = usedLanes.indexOf(marker.lane);
}
layRows();
/** Markers of this run for the axis of another one, with the names of their lanes. */
const sharedMarkers = () => markers.map((marker) => ({ ...marker, lane: LANES[marker.lane] }));
/** Shows the markers of another run on this axis. */
function adoptEvents(others) {
  const added = others.map((marker) => {
    if (!marker.lane) return { ...marker, lane: -1 };
    if (!LANES.some(({ text }) => text === marker.lane.text)) LANES.push(marker.lane);
    const lane = LANES.findIndex(({ text }) => text === marker.lane.text);
    return { ...marker, lane, second: true, text: `second run: ${marker.text}` };
  });
  shownMarkers = [...markers, ...added];
  layRows();
}
const markerTimes = markers.map((m) => m.time);

/** End of the axes of time (s): that of the longest run on the page. */
const axisEnd = () => Math.max(end, clock.end);
const eventX = (t) => GUTTER + (eventsCanvas.clientWidth - GUTTER - RIGHT) * (end > 0 ? t / axisEnd() : 0);
const eventT = (x) => Math.min(axisEnd(), Math.max(0, (x - GUTTER) / (eventsCanvas.clientWidth - GUTTER - RIGHT) * axisEnd()));
let eventPicture = null;

/** Writes a centred text, moved so that it stays inside the canvas. */
function fillInside(ctx, text, x, y, width) {
  const half = ctx.measureText(text).width / 2 + 1;
  ctx.textAlign = 'center';
  ctx.fillText(text, Math.max(half, Math.min(x, width - half)), y);
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
  for (const t of axisSteps(0, axisEnd(), Math.max(2, Math.min(10, (eventsCanvas.clientWidth - GUTTER) / 60)))) {
    ctx.strokeStyle = colours.line;
    ctx.beginPath(); ctx.moveTo(eventX(t), 0); ctx.lineTo(eventX(t), bottom); ctx.stroke();
    ctx.fillStyle = colours.faint;
    fillInside(ctx, `${t} s`, eventX(t), bottom + 11, eventsCanvas.clientWidth);
  }
  if (clock.difference <= axisEnd()) {
    ctx.fillStyle = colours.evader;
    ctx.fillRect(eventX(clock.difference) - 1, 0, 2, bottom);
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
  for (const marker of shownMarkers) {
    if (marker.row < 0) continue;
    const x = eventX(marker.time), y = marker.row * LANE + LANE / 2;
    ctx.fillStyle = ctx.strokeStyle = colours[marker.colour || LANES[marker.lane].colour];
    ctx.lineWidth = 2;
    // Those of the second run are open, so that both are seen.
    if (marker.second) {
      ctx.beginPath();
      if (marker.small) { ctx.moveTo(x, y + 2); ctx.lineTo(x, y + 6); } else ctx.arc(x, y, 7, 0, 2 * Math.PI);
      ctx.stroke();
    } else if (marker.small) ctx.fillRect(x - 1, y - 6, 2, 12);
    else { ctx.beginPath(); ctx.arc(x, y, 5, 0, 2 * Math.PI); ctx.fill(); }
  }
}

function drawEvents(t) {
  const text = eventText(t);
  if ($('event-words').textContent !== text) $('event-words').textContent = text;
  if (!eventsCanvas.isConnected) return;
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
  for (const marker of shownMarkers) {
    if (marker.row < 0 || Math.abs(y - marker.row * LANE - LANE / 2) > LANE / 2) continue;
    const away = Math.abs(x - eventX(marker.time));
    if (away < least) { least = away; best = marker; }
  }
  return best;
}

/** The marker under the pointer. */
let hovered = null;

/** Text of the marker under the pointer, else of the last ones up to a time. */
function eventText(t) {
  const last = lastUpTo(markerTimes, t + 1e-6);
  const shownOnes = hovered ? [hovered] : markers.filter((marker) => last >= 0 && Math.abs(marker.time - markerTimes[last]) < 1e-6);
  if (!shownOnes.length) return markers.length ? 'no event so far' : '';
  const others = shownOnes.length > 3 ? [`${shownOnes.length - 3} more`] : [];
  return `${timeText(shownOnes[0].time)} s: ${[...shownOnes.slice(0, 3).map(({ text }) => text), ...others].join(', ')}`;
}
