// What if: the ended or replayed mission anew from a moment on, with robots at other places or other values, beside the original.

const whatIf = {
  /** The newest data of the run (facts and data); null where the server makes no branches. */
  source: null,
  /** Places of moved robots (m), by name. */
  places: new Map(),

  offer(source) {
    this.source = source;
    control('what-if').hidden = false;
    clock.redraw();
  },

  /** Moves a robot of the original. */
  place(name, [x, y]) {
    this.places.set(name, [x, y].map((metres) => Number(metres.toFixed(3))));
    clock.pause();
  },

  /** Time of the change (s): that of the shown state, a multiple of the tick. */
  at: () => Number((clock.viewers[0].open.at(clock.t).tick * clock.viewers[0].open.facts.tick_period_s).toFixed(9)),

  change() {
    const set = control('what-if-set').value.split('\n').map((line) => line.trim()).filter(Boolean);
    return { at_s: this.at(), place: [...this.places].map(([name, place]) => `${name}=${place}`), set };
  },

  draw() {
    if (!this.source) return;
    const { at_s: at, place } = this.change();
    const text = `From ${timeText(at)} s on, ${place.length ? `with ${place.join(', ')}` : 'with other values'}`;
    if (control('what-if-change').textContent !== text) control('what-if-change').textContent = text;
  },

  say(...parts) { control('what-if-made').replaceChildren(...parts); },

  async go() {
    const change = this.change();
    control('go-on').disabled = true;
    this.say('The branch is being run …');
    try {
      const { run, made } = await world.ask({ branch: change });
      const branch = { facts: run.facts, data: await unpack(run.data) };
      showRuns([this.source, branch], made.comparison);
      // Both are shown to their ends.
      clock.isRunning = false;
      world.show(null);
      clock.pause();
      clock.seek(change.at_s);
      this.say(`Second run: ${made.log}, digest ${made.digest}. The same again: `, element('code', { textContent: made.command }));
    } catch (error) {
      this.say(error.message);
    }
    control('go-on').disabled = false;
  },

  clear() {
    this.places.clear();
    control('what-if-set').value = '';
    this.say();
    this.close();
    clock.redraw();
  },

  /** Shows the run alone again. */
  close() {
    if (!this.source || clock.viewers.length === 1) return;
    const { live: state } = this.source.facts;
    showRuns([this.source]);
    clock.grow(clock.end, state);
    world.show(state.control);
  },
};

control('go-on').addEventListener('click', () => whatIf.go());
control('what-if-clear').addEventListener('click', () => whatIf.clear());
