// The runs that the page carries, and where their nodes are at any time.

const bytesOf = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;
const doublesOf = (packed) => new Float64Array(bytesOf(packed.data));

// Rows of whole steps: value = low + step * counted. Machines that browsers run on are little-endian, as the data is.
class Rows {
  constructor({ low, step, columns, data }) {
    Object.assign(this, { low, step, columns, counted: new Uint16Array(bytesOf(data)) });
  }

  // Between row k and the next, at the fraction w of the way.
  between(k, w) {
    const row = new Float64Array(this.columns);
    const here = k * this.columns;
    const next = w > 0 ? here + this.columns : here;
    for (let i = 0; i < this.columns; i++) {
      row[i] = this.low + this.step * ((1 - w) * this.counted[here + i] + w * this.counted[next + i]);
    }
    return row;
  }
}

class Run {
  constructor({ time, x, y, tension, values, ...words }) {
    Object.assign(this, words);
    this.time = doublesOf(time);
    this.x = new Rows(x);
    this.y = new Rows(y);
    this.tension = tension && new Rows(tension);
    this.values = values.map(({ values: packed, ...about }) => ({ ...about, values: doublesOf(packed) }));
  }

  get last() {
    return this.time[this.time.length - 1];
  }

  // Row at or before t, and the fraction of the way to the next; first and last row hold beyond the ends.
  place(t) {
    let low = 0;
    let high = this.time.length - 1;
    if (t >= this.time[high]) return [high, 0];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.time[middle] <= t) low = middle;
      else high = middle;
    }
    const step = this.time[high] - this.time[low];
    return [low, step > 0 ? Math.max(0, (t - this.time[low]) / step) : 0];
  }

  shapeAt(t) {
    const [k, w] = this.place(t);
    return { x: this.x.between(k, w), y: this.y.between(k, w), tension: this.tension?.between(k, w) };
  }

  valuesAt(t) {
    const [k, w] = this.place(t);
    return this.values.map(({ values }) => (w > 0 ? (1 - w) * values[k] + w * values[k + 1] : values[k]));
  }
}

// All times that were recorded in any of the runs, each once: what arrows and the slider step through.
const recordedTimes = (runs) => {
  const all = runs.flatMap((run) => [...run.time]).sort((a, b) => a - b);
  const same = 1e-9 * Math.max(1, Math.abs(all[all.length - 1]));
  return all.filter((t, k) => k === 0 || t - all[k - 1] > same);
};
