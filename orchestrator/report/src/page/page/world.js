// Control of the running mission or replay by its page, where the server offers it.

const PACES = ['0.1', '0.25', '0.5', '1', '2', '5', '10', '50', '1000'];

const world = {
  /** What pages hold: paused, pace (null: as fast as possible); null without control. */
  state: null,

  /** Sends an order; returns the answer of the server, throws its words for a refusal. */
  async ask(order) {
    const response = await fetch(`/${location.hash.slice(1)}`, { method: 'POST', body: JSON.stringify(order) });
    const words = await response.text();
    if (!response.ok) throw new Error(words);
    return JSON.parse(words);
  },

  async order(order) {
    try {
      this.show(await this.ask(order));
    } catch (error) {
      sayLive(error.message);
    }
  },

  show(state) {
    this.state = clock.isRunning ? state : null;
    control('world').hidden = !this.state;
    document.body.classList.toggle('controlled', Boolean(this.state));
    if (!this.state) return;
    control('hold').textContent = state.paused ? 'Resume run' : 'Pause run';
    const pace = state.pace === null ? 'max' : String(state.pace);
    if (![...control('pace').options].some(({ value }) => value === pace)) this.offer(pace);
    control('pace').value = pace;
  },

  offer(pace) {
    control('pace').append(element('option', { value: pace, textContent: pace === 'max' ? pace : `${pace}×` }));
  },

  hold() { if (this.state) this.order(this.state.paused ? 'go' : 'pause'); },
  step() { if (this.state) this.order('step'); },
  changePace(by) {
    if (!this.state) return;
    const paces = PACES.map(Number);
    const now = this.state.pace ?? Infinity;
    const next = by > 0 ? paces.find((pace) => pace > now) : paces.findLast((pace) => pace < now);
    if (next) this.order({ pace: next });
  },
};

PACES.forEach((pace) => world.offer(pace));
control('hold').addEventListener('click', () => world.hold());
control('step').addEventListener('click', () => world.step());
control('pace').addEventListener('change', () => world.order({ pace: Number(control('pace').value) }));
