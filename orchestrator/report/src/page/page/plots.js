// Curves over time, of two runs over each other, and histograms.

const plots = [];
const plotsHost = $('plots');
const PAD = { left: 52, right: 12, top: 8, bottom: 22 };

/** Formats a number with the digits that a range of this size needs: three; without one, of its own size. */
function short(value, span = Math.abs(value)) {
  if (!Number.isFinite(value)) return '–';
  if (Number.isInteger(value) || span === 0) return String(+value.toPrecision(3));
  const digits = Math.max(0, Math.min(6, 2 - Math.floor(Math.log10(span))));
  const text = value.toFixed(digits);
  return Number(text) === 0 ? '0' : text;
}

/** Adds a plot with these curves, whose numbers are lists of the page or their own; returns it. */
function addPlot({ title, unit, steps, curves }) {
  const box = element('section', { className: 'plot' }, element('h3', { textContent: unit ? `${title} [${unit}]` : title }));
  const canvas = element('canvas');
  canvas.setAttribute('aria-label', title);
  const legend = element('div', { className: 'legend' });
  box.append(canvas, legend);
  plotsHost.append(box);
  const plot = { box, title, canvas, unit, steps, picture: null, curves: [] };
  curves.forEach(({ name, robot, method, list, range, time, values }, i) => {
    if (range) {
      const packed = lists[`curve.${list}.value`];
      time = lists[`curve.${list}.time`];
      values = new Float64Array(packed.length);
      const step = (range.max - range.min) / 65534;
      for (let k = 0; k < values.length; k++) values[k] = packed[k] === 65535 ? NaN : range.min + packed[k] * step;
    }
    const button = element('button', { title: 'Hide or show' });
    const dash = element('span', { className: 'dash' });
    const label = element('span');
    button.append(dash, label);
    // What each run of the page has of it.
    const ofRun = { time, values, colour: () => curveColour({ robot, method, i }) };
    const curve = { name, on: !before?.hidden.includes(`${title} ${name}`), button, label, dash, runs: [ofRun] };
    button.setAttribute('aria-pressed', String(curve.on));
    button.addEventListener('click', () => {
      curve.on = !curve.on;
      button.setAttribute('aria-pressed', String(curve.on));
      plot.picture = null;
      clock.redraw();
    });
    legend.append(button);
    plot.curves.push(curve);
  });
  canvas.addEventListener('pointerdown', (event) => {
    const seek = (e) => clock.seek((e.offsetX - PAD.left) / (canvas.clientWidth - PAD.left - PAD.right) * axisEnd());
    seek(event);
    canvas.setPointerCapture(event.pointerId);
    canvas.onpointermove = seek;
    canvas.onpointerup = canvas.onpointercancel = () => { canvas.onpointermove = null; };
  });
  plots.push(plot);
  return plot;
}
facts.plots.forEach(addPlot);
$('figures-title').hidden = plots.length === 0;

function curveColour(curve) {
  if (curve.method !== null) return methodColour(curve.method);
  return facts.robots[curve.robot] ? robotColour(curve.robot) : colours.curves[curve.i % colours.curves.length];
}

/** Draws the curves of another run over those of this one. */
function adoptPlots(others) {
  for (const theirs of others) {
    const ours = plots.find(({ title, unit }) => title === theirs.title && unit === theirs.unit);
    if (!ours) {
      for (const curve of theirs.curves) curve.runs.unshift(null);
      plotsHost.append(theirs.box);
      plots.push(theirs);
      continue;
    }
    for (const curve of theirs.curves) {
      const same = ours.curves.find(({ name }) => name === curve.name);
      if (same) { same.runs.push(curve.runs[0]); continue; }
      curve.runs.unshift(null);
      curve.button.addEventListener('click', () => { ours.picture = null; });
      ours.box.querySelector('.legend').append(curve.button);
      ours.curves.push(curve);
    }
  }
}

const plotX = (canvas, t) => PAD.left + (canvas.clientWidth - PAD.left - PAD.right) * (end > 0 ? t / axisEnd() : 0);

function drawPlotPicture(plot) {
  const { canvas } = plot;
  fitCanvas(canvas);
  const ratio = window.devicePixelRatio || 1;
  plot.picture = document.createElement('canvas');
  plot.picture.width = canvas.width;
  plot.picture.height = canvas.height;
  const ctx = plot.picture.getContext('2d');
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  let least = 0, most = plot.most ?? 0;
  for (const { runs } of plot.curves.filter(({ on }) => on)) {
    for (const value of runs.flatMap((run) => (run ? [...run.values] : []))) {
      if (value < least) least = value;
      if (value > most) most = value;
    }
  }
  if (most === least) most = least + 1;
  plot.span = most - least;
  const bottom = canvas.clientHeight - PAD.bottom, high = bottom - PAD.top;
  const y = (value) => bottom - (value - least) / (most - least) * high;
  ctx.font = '12px system-ui, sans-serif';
  ctx.textBaseline = 'middle';
  ctx.lineWidth = 1;
  // Numbers of things are whole.
  for (const value of axisSteps(least, most, 4).filter((step) => plot.unit || Number.isInteger(step))) {
    ctx.strokeStyle = colours.line;
    ctx.beginPath(); ctx.moveTo(PAD.left, y(value)); ctx.lineTo(canvas.clientWidth - PAD.right, y(value)); ctx.stroke();
    ctx.fillStyle = colours.faint;
    ctx.textAlign = 'right';
    ctx.fillText(String(value), PAD.left - 6, y(value));
  }
  for (const t of axisSteps(0, axisEnd(), 6)) fillInside(ctx, `${t} s`, plotX(canvas, t), bottom + 12, canvas.clientWidth);
  if (clock.difference <= axisEnd()) {
    ctx.fillStyle = colours.evader;
    ctx.fillRect(plotX(canvas, clock.difference) - 0.5, PAD.top, 1, high);
  }
  plot.under?.(ctx, (t) => plotX(canvas, t), y);
  for (const curve of plot.curves) {
    curve.dash.style.background = (curve.runs[0] ?? curve.runs[1]).colour();
    if (curve.on) curve.runs.forEach((run, second) => { if (run) drawCurve(run, second); });
  }

  function drawCurve(run, second) {
    ctx.strokeStyle = run.colour();
    ctx.setLineDash(second ? [5, 4] : []);
    ctx.lineWidth = 1.5;
    ctx.lineJoin = 'round';
    ctx.beginPath();
    let before = NaN;
    for (let i = 0; i < run.values.length; i++) {
      const value = run.values[i];
      if (!Number.isNaN(value)) {
        const x = plotX(canvas, run.time[i] / 1e4);
        if (Number.isNaN(before)) ctx.moveTo(x, y(value));
        else {
          if (plot.steps) ctx.lineTo(x, y(before));
          ctx.lineTo(x, y(value));
        }
      }
      before = value;
    }
    ctx.stroke();
  }
}

function drawPlots(t) {
  for (const plot of plots) {
    const { canvas } = plot;
    const box = canvas.getBoundingClientRect();
    // Plots outside the window are drawn once, for print.
    if (plot.picture && (box.bottom < 0 || box.top > window.innerHeight)) continue;
    if (!plot.picture) drawPlotPicture(plot);
    const ratio = window.devicePixelRatio || 1;
    const ctx = canvas.getContext('2d');
    ctx.setTransform(1, 0, 0, 1, 0, 0);
    ctx.clearRect(0, 0, canvas.width, canvas.height);
    ctx.drawImage(plot.picture, 0, 0);
    ctx.fillStyle = colours.ink;
    ctx.globalAlpha = 0.7;
    ctx.fillRect(Math.round((plotX(canvas, t) - 0.5) * ratio), PAD.top * ratio, Math.max(1, Math.round(ratio)),
      canvas.height - (PAD.top + PAD.bottom) * ratio);
    ctx.globalAlpha = 1;
    for (const curve of plot.curves) {
      const values = curve.runs.map((run) => {
        const i = run ? lastUpTo(run.time, ticksOf(t)) : -1;
        return i < 0 ? '–' : short(run.values[i], plot.span);
      });
      const text = `${curve.name} ${values.join(' | ')}`;
      if (curve.label.textContent !== text) curve.label.textContent = text;
    }
  }
}

/** Formats a duration in microseconds, in a suitable unit. */
function duration(us) {
  if (us < 1) return `${(us * 1e3).toFixed(0)} ns`;
  if (us < 1e3) return `${us < 10 ? us.toFixed(1) : us.toFixed(0)} µs`;
  if (us < 1e6) return `${us < 1e4 ? (us / 1e3).toFixed(1) : (us / 1e3).toFixed(0)} ms`;
  return `${(us / 1e6).toFixed(1)} s`;
}

const histograms = facts.latency.filter((hop) => hop.histogram).map((hop) => {
  const canvas = element('canvas');
  canvas.setAttribute('aria-label', `Histogram of ${hop.name}`);
  const { p50, p90, p99, max, count } = hop.us;
  const text = `${count} · p50 ${duration(p50)} · p90 ${duration(p90)} · p99 ${duration(p99)} · max ${duration(max)}`;
  $('latency').append(element('section', { className: 'plot' },
    element('h3', { textContent: words(hop.name) }), canvas, element('div', { className: 'legend', textContent: text })));
  return { canvas, hop };
});
const firstPart = Math.min(...histograms.map(({ hop }) => hop.histogram.first));
const lastPart = Math.max(...histograms.map(({ hop }) => hop.histogram.first + hop.histogram.counts.length));
if (!facts.latency.length) {
  $('latency-title').nextElementSibling.textContent = 'Not in this log: the run had no processes of their own, or was cut, or is of another version.';
}

/** All histograms on the same axis, so that they can be compared. */
function drawHistograms() {
  const from = Math.floor(firstPart / facts.per_decade), to = Math.ceil(lastPart / facts.per_decade);
  for (const { canvas, hop } of histograms) {
    fitCanvas(canvas);
    const ratio = window.devicePixelRatio || 1;
    const ctx = canvas.getContext('2d');
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    ctx.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
    const left = 14, right = canvas.clientWidth - 14, bottom = canvas.clientHeight - 20;
    const x = (decade) => left + (decade - from) / (to - from) * (right - left);
    ctx.font = '12px system-ui, sans-serif';
    ctx.textAlign = 'center';
    ctx.textBaseline = 'middle';
    // Labels need 58 px, the last one more: it is moved inside.
    const apart = Math.ceil(58 / Math.max(x(from + 1) - x(from), 1));
    for (let decade = from; decade <= to; decade++) {
      ctx.strokeStyle = colours.line;
      ctx.beginPath(); ctx.moveTo(x(decade), 4); ctx.lineTo(x(decade), bottom); ctx.stroke();
      if ((decade - from) % apart !== 0) continue;
      ctx.fillStyle = colours.faint;
      const [number, unit] = duration(10 ** decade / 1e3).split(' ');
      fillInside(ctx, `${+number} ${unit}`, x(decade), bottom + 11, canvas.clientWidth);
    }
    const { first, counts } = hop.histogram;
    const most = Math.max(...counts);
    ctx.fillStyle = colours.pursuer;
    counts.forEach((count, i) => {
      const a = x((first + i) / facts.per_decade), b = x((first + i + 1) / facts.per_decade);
      const h = count === 0 ? 0 : Math.max(1, count / most * (bottom - 6));
      ctx.fillRect(a + 0.5, bottom - h, Math.max(1, b - a - 1), h);
    });
    for (const us of [hop.us.p50, hop.us.p99]) {
      const at = x(Math.log10(Math.max(us * 1e3, 1)));
      ctx.strokeStyle = colours.evader;
      ctx.lineWidth = 1.5;
      ctx.beginPath(); ctx.moveTo(at, 4); ctx.lineTo(at, bottom); ctx.stroke();
      ctx.lineWidth = 1;
    }
  }
}
