// The differences of the two runs of a page, above them.

/** A row of values: the key, and both values. */
function differenceRow(key, a, b) {
  const cells = [key, a ?? 'none', b ?? 'none'].map((textContent) => element('td', { textContent: textContent === '' ? 'none' : textContent }));
  return element('tr', {}, ...cells);
}

/** A table of rows below a heading, folded if it is long; at most 40 rows. */
function differenceTable(title, rows) {
  const names = ['', 'first run', 'second run'].map((textContent) => element('th', { textContent }));
  const more = rows.length > 40 ? [element('p', { className: 'hint', textContent: `and ${rows.length - 40} others` })] : [];
  const table = element('div', { className: 'scroll' }, element('table', {}, element('tr', {}, ...names), ...rows.slice(0, 40)), ...more);
  return element('details', { open: rows.length <= 6 }, element('summary', { textContent: `${title} (${rows.length})` }), table);
}

/** Shows what differs; returns the time of the first difference (s), NaN without one. */
function showDifference({ error, report }) {
  const host = control('difference');
  host.hidden = false;
  if (error) {
    host.append(element('p', { textContent: `The runs cannot be compared: ${error}` }));
    return NaN;
  }
  const { first, scenario, results } = report;
  const head = element('p', {});
  host.append(head);
  if (first) {
    const go = element('button', { textContent: `${timeText(first.time_s)} s`, title: 'Go to the first difference' });
    go.addEventListener('click', () => clock.seek(first.time_s));
    head.append('The histories differ from ', go, ' on.');
  } else {
    head.append(report.whole ? 'The histories are equal.' : 'The histories are equal as far as both logs go.');
  }
  const change = ({ process, topic, robot, field, a, b }) => differenceRow(
    `${process}, ${topic}${field ? `: ${field}` : ''}${robot ? ` of ${robot}` : ''}`, a, b);
  const value = ({ key, a, b }) => differenceRow(key, a, b);
  if (scenario.length) host.append(differenceTable('Keys of the scenario that differ', scenario.map(value)));
  if (first) host.append(differenceTable('Processes that answered the same inputs otherwise', first.causes.map(change)));
  if (results.length) host.append(differenceTable('Results that differ', results.map(value)));
  return first ? first.time_s : NaN;
}
