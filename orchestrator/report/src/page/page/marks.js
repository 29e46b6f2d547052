// Topics that declare how their elements are drawn: lines, and points as lines without length.

/** Messages of a topic and a sender: their times and the places of their lines. */
const markStreams = new Map();
{
  let begin = 0;
  lists['marks.time'].forEach((time, i) => {
    const topic = lists['marks.topic'][i], count = lists['marks.count'][i];
    const key = `${topic} ${lists['marks.sender'][i]}`;
    if (!markStreams.has(key)) markStreams.set(key, { topic, time: [], begin: [], count: [] });
    const of = markStreams.get(key);
    of.time.push(time); of.begin.push(begin); of.count.push(count);
    begin += count;
  });
}
const markColour = (topic) => colours.curves[(topic + 3) % colours.curves.length];

/** Lines of a topic at a time: both ends of each (m). */
function marksAt(topic, t) {
  const found = [];
  for (const of of markStreams.values()) {
    const i = of.topic === topic ? lastUpTo(of.time, ticksOf(t)) : -1;
    if (i < 0 || t - of.time[i] / 1e4 > 1) continue;
    for (let n = of.begin[i]; n < of.begin[i] + of.count[i]; n++) {
      found.push([2 * n, 2 * n + 1].map((end) => [xOf(lists['marks.x'][end]), yOf(lists['marks.y'][end])]));
    }
  }
  return found;
}

function drawMarkTopics(t) {
  inMetres(paint);
  paint.lineCap = 'round';
  facts.marks.forEach((name, topic) => {
    if (!shown[`marks ${name}`]) return;
    paint.strokeStyle = markColour(topic);
    for (const [from, to] of marksAt(topic, t)) {
      paint.lineWidth = (from[0] === to[0] && from[1] === to[1] ? 8 : 2) / view.scale;
      paint.beginPath();
      paint.moveTo(...from);
      paint.lineTo(...to);
      paint.stroke();
    }
  });
  paint.lineCap = 'butt';
}
