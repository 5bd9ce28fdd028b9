// The player: time, controls, keys. It starts at the first recorded moment, standing.

const part = (id) => document.getElementById(id);
const carried = (id) => JSON.parse(part(id).textContent);

class Player {
  constructor(runs, stage) {
    Object.assign(this, { runs, stage, playing: false, speed: 1, paints: [] });
    this.times = recordedTimes(runs);
    this.time = this.times[0];
    this.stage.painted = () => this.count(performance.now());
    this.cells = runs.map((run, k) => run.values.map(({ name }) => part(`value-${name}-${k}`)));
    this.clocks = [part("clock"), ...document.querySelectorAll(".clock")];
    this.listen();
    this.seek(this.time);
  }

  get end() {
    return this.times[this.times.length - 1];
  }

  // --- time ---

  play() {
    if (this.playing) return;
    if (this.time >= this.end) this.time = this.times[0];
    this.playing = true;
    this.before = undefined;
    this.sayPlaying();
    this.next();
  }

  next() {
    this.asked = requestAnimationFrame((now) => this.tick(now));
  }

  // Standing, the picture is always of a recorded moment: the one that was passed last.
  pause() {
    this.playing = false;
    cancelAnimationFrame(this.asked);
    this.sayPlaying();
    this.seek(this.times[this.passed(this.time)]);
  }

  tick(now) {
    const wait = this.before === undefined ? 0 : (now - this.before) / 1000;
    this.before = now;
    this.time = Math.min(this.time + this.speed * wait, this.end);
    this.show();
    if (this.time >= this.end) this.pause();
    else this.next();
  }

  // To the recorded moment nearest to t.
  seek(t) {
    const k = this.passed(t);
    const next = this.times[k + 1];
    this.time = next !== undefined && next - t < t - this.times[k] ? next : this.times[k];
    this.show();
  }

  step(moments) {
    this.stopAt(Math.max(0, Math.min(this.passed(this.time) + moments, this.times.length - 1)));
  }

  stopAt(moment) {
    if (this.playing) this.pause();
    this.seek(this.times[moment]);
  }

  passed(t) {
    let k = Math.round(((t - this.times[0]) / (this.end - this.times[0] || 1)) * (this.times.length - 1));
    k = Math.max(0, Math.min(k, this.times.length - 1));
    while (k > 0 && this.times[k] > t) k--;
    while (k + 1 < this.times.length && this.times[k + 1] <= t) k++;
    return k;
  }

  // --- what is shown ---

  show() {
    this.stage.draw(this.time);
    const clock = `${this.time.toFixed(2)} s`;
    for (const shown of this.clocks) shown.textContent = clock;
    part("time").value = this.passed(this.time);
    part("time").setAttribute("aria-valuetext", clock);
    this.runs.forEach((run, k) => {
      run.valuesAt(this.time).forEach((value, i) => (this.cells[k][i].textContent = readable(value)));
      part(`ended-${k}`)?.toggleAttribute("data-reached", this.time >= run.last);
    });
  }

  sayPlaying() {
    part("play").textContent = this.playing ? "Pause" : "Play";
  }

  // Pictures painted in the last second.
  count(now) {
    this.paints.push(now);
    while (now - this.paints[0] > 1000) this.paints.shift();
    if (this.playing && this.paints.length > 1) part("rate").textContent = `${Math.round(this.rate())} pictures/s`;
  }

  rate() {
    const seconds = (this.paints[this.paints.length - 1] - this.paints[0]) / 1000;
    return seconds > 0 ? (this.paints.length - 1) / seconds : 0;
  }

  setSpeed(speed) {
    this.speed = speed;
    part("speed").value = String(speed);
  }

  faster(by) {
    const speeds = [...part("speed").options].map((option) => Number(option.value));
    const k = speeds.indexOf(this.speed) + by;
    this.setSpeed(speeds[Math.max(0, Math.min(k, speeds.length - 1))]);
  }

  colour(yes) {
    if (part("colours")) part("colours").checked = yes;
    this.stage.colourByTension(yes);
  }

  // --- controls and keys ---

  listen() {
    part("time").max = this.times.length - 1;
    part("play").addEventListener("click", () => this.toggle());
    part("time").addEventListener("input", (event) => this.stopAt(Number(event.target.value)));
    part("speed").addEventListener("change", (event) => this.setSpeed(Number(event.target.value)));
    part("closer").addEventListener("click", () => this.stage.zoom(1.25));
    part("wider").addEventListener("click", () => this.stage.zoom(0.8));
    part("whole").addEventListener("click", () => this.stage.whole());
    part("colours")?.addEventListener("change", (event) => this.colour(event.target.checked));
    this.colour(part("colours")?.checked ?? false);
    document.addEventListener("keydown", (event) => this.key(event));
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  key(event) {
    const { key, target } = event;
    if (event.ctrlKey || event.altKey || event.metaKey || target.closest("select")) return;
    if (key === " " && target.closest("button, summary, input[type=checkbox]")) return; // it presses what has the focus
    const many = event.shiftKey ? 10 : 1;
    const does = {
      " ": () => this.toggle(),
      ArrowRight: () => this.step(many),
      ArrowLeft: () => this.step(-many),
      ArrowUp: () => this.faster(1),
      ArrowDown: () => this.faster(-1),
      Home: () => this.step(-Infinity),
      End: () => this.step(Infinity),
      "+": () => this.stage.zoom(1.25),
      "=": () => this.stage.zoom(1.25),
      "-": () => this.stage.zoom(0.8),
      0: () => this.stage.whole(),
      t: () => part("colours") && this.colour(!part("colours").checked),
    }[key.length === 1 ? key.toLowerCase() : key];
    if (!does) return;
    event.preventDefault();
    does();
  }
}

// Six digits, as in the tables of a run.
const readable = (value) => {
  const size = Math.abs(value);
  return size !== 0 && (size < 1e-4 || size >= 1e7) ? value.toExponential(3) : String(Number(value.toPrecision(6)));
};

const runs = carried("runs").map((run) => new Run(run));
const stage = await Stage.open(carried("figure"), runs, carried("extent"));
const player = new Player(runs, stage);

// For scripts: what is drawn at present, and the player's own controls.
window.cablefmu = {
  shape: (k = 0) => ({ time: player.time, ...stage.drawn(k) }),
  view: () => ({
    x: [stage.plot.x_range.start, stage.plot.x_range.end],
    y: [stage.plot.y_range.start, stage.plot.y_range.end],
    width: stage.plot.inner_width,
    height: stage.plot.inner_height,
  }),
  seek: (t) => player.seek(t),
  play: () => player.play(),
  pause: () => player.pause(),
  isPlaying: () => player.playing,
  rate: () => player.rate(),
};
