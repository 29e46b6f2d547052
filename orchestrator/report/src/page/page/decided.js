// Shares of the recorded outcomes among continuations (`protean decided`), against the time of branching.

if (facts.decided) {
  const { log, threshold, moments, decisions, change } = facts.decided;
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

  /** Draws the threshold, and of each shown curve the interval and the bracket of the decision. */
  plot.under = (ctx, x, y) => {
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

  const hint = element('p', { className: 'hint', textContent: 'Click a moment: how two of its continuations are shown side by side.' });
  const commands = element('pre', { hidden: true });
  plot.box.append(hint, commands);
  const quoted = (word) => (/^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`);

  /** Shows the commands for two continuations from the moment next to a time: with the recorded outcome, and with another. */
  function showMoment(t) {
    const i = plot.curves.findIndex(({ on }) => on);
    if (i < 0) return;
    const decision = decisions[i];
    const nearest = moments.reduce((a, b) => (Math.abs(b.time_s - t) < Math.abs(a.time_s - t) ? b : a));
    const found = outcomesOf(nearest, decision.robot);
    const pair = ['same', 'other'].map((name) => ({
      name, of: found.find(({ outcome }) => (outcome === decision.outcome) === (name === 'same')),
    })).filter(({ of }) => of);
    const counted = found.map(({ outcome, count }) => `${words(outcome)} in ${count}`).join(', ');
    hint.textContent = `${decision.robot} from ${timeText(nearest.time_s)} s on: ${counted} of ${nearest.continuations} continuations.`;
    const options = ['set', 'draw', 'replace', 'command', 'place', 'reseed'].flatMap((key) => (change[key] ?? []).map((text) => `--${key}=${text}`));
    if (change.for !== undefined) options.push(`--for=${change.for}`);
    const branch = ['protean', 'branch', log, `--at=${+nearest.time_s.toFixed(9)}`, ...options];
    const lines = pair.map(({ name, of }) => [...branch, `--seed=${of.stream}`, `--out=${name}.mcap`]);
    lines.push(['protean', 'report', ...pair.map(({ name }) => `${name}.mcap`), '--open']);
    commands.textContent = lines.map((line) => line.map(quoted).join(' ')).join('\n');
    commands.hidden = false;
  }
  plot.canvas.addEventListener('click', () => showMoment(clock.t));
}
