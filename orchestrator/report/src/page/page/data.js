// Content of the log: facts, and lists of numbers.

const $ = (id) => root.getElementById(id);

/** Decodes the lists by name: bytes are grouped by significance, numbers are differences. */
function unpackLists() {
  const lists = {};
  for (const { name, at, length, bytes, differences } of facts.lists) {
    const list = new [0, Uint8Array, Uint16Array, 0, Uint32Array][bytes](length);
    for (let worth = 0; worth < bytes; worth++) {
      const from = at + worth * length;
      for (let i = 0; i < length; i++) list[i] |= data[from + i] << (8 * worth);
    }
    for (let k = 0; k < differences; k++) for (let i = 1; i < length; i++) list[i] += list[i - 1];
    lists[name] = list;
  }
  return lists;
}

/** Seconds in the time unit of the lists. */
const ticksOf = (seconds) => Math.round(seconds * 1e4);

const lists = unpackLists();
const { raster } = facts;
const xOf = (n) => raster.origin[0] + n * raster.step;
const yOf = (n) => raster.origin[1] + n * raster.step;
const frames = lists.time.length;
const end = Math.max(facts.end_s, lists.time[frames - 1] / 1e4);
const STATUS = ['active', 'caught', 'escaped', 'timed_out', 'goal_reached', 'disabled'];

/** Index of the state at a time. */
const frameAt = (t) => Math.max(0, lastUpTo(lists.time, ticksOf(t)));

/** State of a robot. */
function robotAt(robot, frame) {
  const i = robot * frames + frame;
  const flags = lists.flags[i];
  return {
    x: xOf(lists.x[i]), y: yOf(lists.y[i]), theta: lists.theta[i] / 65536 * 2 * Math.PI,
    status: flags & 15, inContact: (flags & 16) !== 0, failSafe: (flags & 32) !== 0, present: (flags & 64) !== 0,
  };
}

/** State of a robot between two states of the world, for a smooth motion. */
function robotBetween(robot, t) {
  const frame = frameAt(t);
  const here = robotAt(robot, frame);
  if (frame + 1 >= frames) return here;
  const [from, to] = [lists.time[frame] / 1e4, lists.time[frame + 1] / 1e4];
  const part = Math.min(1, Math.max(0, (t - from) / (to - from)));
  const next = robotAt(robot, frame + 1);
  const turn = Math.atan2(Math.sin(next.theta - here.theta), Math.cos(next.theta - here.theta));
  return {
    ...here,
    x: here.x + part * (next.x - here.x), y: here.y + part * (next.y - here.y), theta: here.theta + part * turn,
  };
}

/** A layer's items by robot: times, begin and count of their parts. */
function byRobot(name) {
  const robots = new Map();
  const time = lists[`${name}.time`], robot = lists[`${name}.robot`], count = lists[`${name}.count`];
  let begin = 0;
  for (let i = 0; i < time.length; i++) {
    let of = robots.get(robot[i]);
    if (!of) robots.set(robot[i], of = { time: [], item: [], begin: [], count: [] });
    of.time.push(time[i]); of.item.push(i); of.begin.push(begin); of.count.push(count[i]);
    begin += count[i];
  }
  return robots;
}

const layerItems = {};
for (const name of ['beliefs', 'plans', 'trees', 'scans', 'predictions', 'verdicts', 'dominance']) layerItems[name] = byRobot(name);

/** The last item of a robot in a layer up to a time: index, begin and count of its parts, age (s). */
function latest(name, robot, t) {
  const of = layerItems[name].get(robot);
  const i = of ? lastUpTo(of.time, ticksOf(t)) : -1;
  return i < 0 ? null : { item: of.item[i], begin: of.begin[i], count: of.count[i], age: t - of.time[i] / 1e4 };
}
