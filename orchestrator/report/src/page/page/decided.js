// Shares of the recorded outcomes among continuations (`protean decided`), against the time of branching.

if (facts.decided) {
  const { log, threshold, moments, decisions, change, examples } = facts.decided;
  const z2 = 3.8415;

  /** Outcomes of a robot among the continuations from a moment. */
  const outcomesOf = (moment, robot) => moment.robots.find((own) => own.robot === robot).outcomes;

  /** Share of an outcome at a moment, and its 95 % interval. */
  function shareOf(moment, { robot, outcome }) {
    // Wilson's interval of none.
    const none = { share: 0, interval: { low: 0, high: z2 / (moment.continuations + z2) } };
    return outcomesOf(moment, robot).find((own) => own.outcome === outcome) ?? none;
  }

  const curves = decisions.map((decision) => {
    const before = moments.filter(({ time_s: t }) => t <= decision.time_s);
    const shares = before.map((moment) => shareOf(moment, decision));
    return {
      name: `${decision.robot} ${words(decision.outcome)}`, method: null,
      robot: facts.robots.findIndex(({ name }) => name === decision.robot),
      time: before.map(({ time_s: t }) => ticksOf(t)), values: shares.map(({ share }) => 100 * share),
      low: shares.map(({ interval }) => 100 * interval.low), high: shares.map(({ interval }) => 100 * interval.high),
    };
  });
  const plot = addPlot({ title: 'Continuations with the recorded outcome', unit: '%', steps: false, curves });
  plot.most = 100;
  $('event-words').after(plot.box);

  let yOf = () => 0;
  /** Draws the threshold, and of each shown curve the interval and the bracket of the decision. */
  plot.under = (ctx, x, y) => {
    yOf = y;
    ctx.strokeStyle = colours.faint;
    ctx.beginPath(); ctx.moveTo(x(0), y(100 * threshold)); ctx.lineTo(x(axisEnd()), y(100 * threshold)); ctx.stroke();
    curves.forEach(({ time, low, high }, i) => {
      if (!plot.curves[i].on) return;
      ctx.fillStyle = plot.curves[i].runs[0].colour();
      const edge = (values) => values.map((value, k) => [x(time[k] / 1e4), y(value)]);
      ctx.globalAlpha = 0.18;
      ctx.beginPath();
      for (const point of [...edge(high), ...edge(low).reverse()]) ctx.lineTo(...point);
      ctx.fill();
      const [from, to] = decisions[i].between_s ?? [decisions[i].time_s, decisions[i].time_s];
      ctx.globalAlpha = 0.45;
      ctx.fillRect(x(from), y(100), Math.max(2, x(to) - x(from)), y(0) - y(100));
      ctx.globalAlpha = 1;
    });
  };

  const hint = element('p', { className: 'hint', textContent: 'Click a moment: two of its continuations, with different outcomes, are shown side by side.' });
  const open = element('button', { textContent: 'Continuations from here' });
  const host = element('div', { className: 'continuations' });
  plot.box.append(hint, open, host);
  const quoted = (word) => (/^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`);

  /** The command that records a continuation. */
  function command({ time_s: t, stream }) {
    const options = ['set', 'draw', 'replace', 'command', 'place', 'reseed'].flatMap((key) => (change[key] ?? []).map((text) => `--${key}=${text}`));
    if (change.for !== undefined) options.push(`--for=${change.for}`);
    const branch = ['protean', 'branch', log, `--at=${+t.toFixed(9)}`, ...options, `--seed=${stream}`];
    return branch.map(quoted).join(' ');
  }

  /** A continuation as a run: with the map of this one, and without its layers. */
  async function runOf({ changes, lists: states, data: packed, ...example }) {
    return {
      facts: {
        ...facts, ...example, ground: { ...facts.ground, changes }, robots: facts.robots.map((robot) => ({ ...robot, sweeps: 0 })),
        decided: null, coverage: null, predictions: null, attacks: [], patrols: [], plots: [], latency: [], missing: [],
        lists: [...facts.lists.map((list) => ({ ...list, length: 0 })), ...states],
      },
      data: await unpack(packed),
    };
  }

  /** Shows the map of a run alone in a part of the page. */
  function showMap(parent, run) {
    const root = ownTree(parent);
    const [whole] = root.querySelectorAll('.viewer');
    whole.classList.add('bare');
    const made = viewer(root, run.facts, run.data, null, false);
    root.getElementById('events').remove();
    return made;
  }

  let wanted;
  /** Plays the continuations from the moment next to a time beside each other: with the two most frequent outcomes of a robot. */
  async function showMoment(t, y) {
    const nearest = (all) => all.reduce((a, b) => (Math.abs(b.time_s - t) < Math.abs(a.time_s - t) ? b : a));
    const choice = decisions.map((decision, i) => {
      const own = moments.filter(({ time_s: at }) => at <= decision.time_s && examples.some((example) => example.time_s === at));
      return { decision, on: plot.curves[i].on && own.length > 0, moment: own.length && nearest(own) };
    }).filter(({ on }) => on);
    if (!choice.length) return;
    const away = ({ decision, moment }) => Math.abs(yOf(100 * shareOf(moment, decision).share) - y);
    const { decision: { robot }, moment } = y === undefined ? choice[0] : choice.reduce((a, b) => (away(b) < away(a) ? b : a));
    const outcomes = [...outcomesOf(moment, robot)].sort((a, b) => b.count - a.count);
    const counted = outcomes.map(({ outcome, count }) => `${words(outcome)} in ${count}`).join(', ');
    hint.textContent = `${robot} from ${timeText(moment.time_s)} s on: ${counted} of ${moment.continuations} continuations.`;
    const pair = outcomes.slice(0, 2).map(({ stream }) => examples.find((own) => own.time_s === moment.time_s && own.stream === stream));
    wanted = pair;
    const runs = await Promise.all(pair.map(runOf));
    if (wanted !== pair) return;
    clock.viewers.splice(1).forEach((run) => run.close());
    host.replaceChildren();
    runs.forEach((run, i) => {
      const { outcome, share, interval: { low, high }, stream } = outcomes[i];
      const [whole, least, most] = [share, low, high].map((part) => (100 * part).toFixed(0));
      const map = element('div');
      host.append(element('section', {}, element('b', { textContent: `${robot} ${words(outcome)}` }),
        `: ${whole} % (${least} to ${most} %), stream ${stream}`, map, element('pre', { textContent: command(pair[i]) })));
      clock.viewers.push(showMap(map, run));
    });
    clock.end = Math.max(...clock.viewers.map((run) => run.end));
    control('scrub').max = clock.end;
    refreshAll();
    clock.seek(moment.time_s);
    clock.play();
    host.scrollIntoView({ block: 'nearest' });
  }
  plot.canvas.addEventListener('click', (event) => showMoment(clock.t, event.offsetY));
  open.addEventListener('click', () => showMoment(clock.t));
}
