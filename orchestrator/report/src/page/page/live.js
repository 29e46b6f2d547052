// The data of a running mission: a stream of lines from the server of the page, each with all data so far.

/** The runs in the page; without one it shows the running mission of its server. */
const scripts = [...document.querySelectorAll('script.facts')];
const isLive = scripts.length === 0;

const sleep = (ms) => new Promise((done) => { setTimeout(done, ms); });

function sayLive(text) {
  control('live-state').hidden = false;
  control('live-state').textContent = text;
}

const live = {
  /** The newest line, until it is taken; and what waits for it. */
  line: null, arrived: () => {}, isOver: false,

  put(line) {
    this.line = line;
    this.arrived();
  },

  async next() {
    while (this.line === null) await new Promise((done) => { this.arrived = done; });
    const { error, facts, data } = JSON.parse(this.line);
    this.line = null;
    if (error) throw new Error(error);
    return { facts, data: await unpack(data) };
  },

  /** Reads the stream to the end of the mission; begins again after a break. */
  async read() {
    while (!this.isOver) {
      try {
        const response = await fetch(`/${location.hash.slice(1)}`, { cache: 'no-store' });
        if (!response.ok) {
          sayLive(await response.text());
          return;
        }
        sayLive('live');
        await this.readLines(response.body.pipeThrough(new TextDecoderStream()).getReader());
      } catch { /* A break of the connection. */ }
      if (!this.isOver) {
        sayLive('no connection; trying again');
        await sleep(1000);
      }
    }
  },

  async readLines(reader) {
    let parts = [];
    for (;;) {
      const { value, done } = await reader.read();
      if (done) return;
      const lines = value.split('\n');
      while (lines.length > 1) {
        const line = [...parts, lines.shift()].join('');
        parts = [];
        this.isOver = line.includes('"ended":true,"now_s"') || line.startsWith('{"error"');
        this.put(line);
      }
      parts.push(lines[0]);
    }
  },
};

let isPressed = false;
/** Waits until the reader drags nothing and has no list open: new data replace the elements. */
async function untilFree() {
  while (isPressed || document.activeElement?.tagName === 'SELECT') await sleep(50);
}

/** Shows whether the mission has ended; the server may make branches of it then, and of a replay at any time. */
function offerBranches(source) {
  const { ended, control: controlled, replayed } = source.facts.live;
  if (controlled && (replayed || (ended && source.facts.digest))) whatIf.offer(source);
  if (!ended) return;
  sayLive('ended');
  control('live').hidden = true;
}

/** Shows the present of the running mission. */
function followLive() {
  whatIf.close();
  if (clock.isRunning) clock.follow();
}

/** Shows newer data as they come, to those of the end. */
async function showLive(ended) {
  for (const [name, pressed] of [['pointerdown', true], ['pointerup', false], ['pointercancel', false]]) {
    document.addEventListener(name, () => { isPressed = pressed; }, { capture: true });
  }
  document.addEventListener('change', (event) => { if (event.target.tagName === 'SELECT') event.target.blur(); });
  try {
    while (!ended) {
      const source = await live.next();
      await untilFree();
      const began = performance.now();
      // A branch stays beside the data that it had.
      if (clock.viewers.length === 1) {
        mount(source);
        clock.grow(clock.viewers[0].end, source.facts.live);
        world.show(source.facts.live.control);
      }
      offerBranches(source);
      ({ ended } = source.facts.live);
      // A slow machine shows fewer of them.
      await sleep(3 * (performance.now() - began));
    }
  } catch (error) {
    sayLive(error.message);
  }
}
