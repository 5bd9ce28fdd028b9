// The stage: Bokeh's figure, what is drawn on it, and which part of the plane it shows.

class Stage {
  static async open(item, runs, extent) {
    const views = await Bokeh.embed.embed_item(item);
    const stage = new Stage();
    Object.assign(stage, { runs, extent, painted: () => {} });
    stage.plot = Bokeh.documents[0].get_model_by_name("plot");
    stage.follow(views.get_one(stage.plot));
    await stage.laidOut();
    stage.whole();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => stage.dress());
    stage.dress();
    return stage;
  }

  // Told after every picture that has really been painted; windows, and numbers at the axes, change the frame's size.
  follow(view) {
    const paint = view.paint;
    view.paint = () => {
      paint.call(view);
      if (this.size) this.keepProportions();
      this.painted();
    };
  }

  async laidOut() {
    while (!this.plot.inner_width) await new Promise((next) => requestAnimationFrame(next));
  }

  named(name) {
    return Bokeh.documents[0].get_model_by_name(name);
  }

  draw(t) {
    this.runs.forEach((run, k) => {
      const { x, y, tension } = run.shapeAt(t);
      const n = x.length - 1;
      this.named(`nodes${k}`).data = { x, y };
      this.named(`ends${k}`).data = { x: [x[0], x[n]], y: [y[0], y[n]], marker: [run.top_marker, run.end_marker] };
      if (tension) {
        const [x0, y0, x1, y1] = [x.subarray(0, n), y.subarray(0, n), x.subarray(1), y.subarray(1)];
        this.named(`links${k}`).data = { x0, y0, x1, y1, tension };
      }
    });
  }

  // A run's nodes as they are drawn now.
  drawn(k) {
    const { x, y } = this.named(`nodes${k}`).data;
    return { x: [...x], y: [...y] };
  }

  // With tensions, a run's own colour stays as a rim where there are two.
  colourByTension(yes) {
    this.runs.forEach((run, k) => {
      const coloured = yes && run.tension !== undefined;
      const rim = coloured && this.runs.length > 1;
      this.named(`pulls${k}`).visible = coloured;
      this.named(`line${k}`).visible = !coloured || rim;
      this.named(`line${k}`).glyph.line_width = rim ? 7 : 3;
    });
  }

  // --- which part of the plane: a metre is as long across as it is down ---

  look(x, y, metresPerPixel) {
    this.size = [this.plot.inner_width, this.plot.inner_height];
    const [w, h] = this.size.map((pixels) => (pixels * metresPerPixel) / 2);
    this.plot.x_range.setv({ start: x - w, end: x + w });
    this.plot.y_range.setv({ start: y + h, end: y - h });
  }

  // What is looked at now; mouse and fingers may have moved it.
  looked() {
    const { x_range: across, y_range: down } = this.plot;
    const width = this.size[0];
    return [(across.start + across.end) / 2, (down.start + down.end) / 2, (across.end - across.start) / width];
  }

  whole() {
    const { left, right, top, bottom } = this.extent;
    const across = (1.12 * (right - left)) / this.plot.inner_width;
    const down = (1.12 * (bottom - top)) / this.plot.inner_height;
    this.look((left + right) / 2, (top + bottom) / 2, Math.max(across, down, 1e-3));
    this.wholeIs = String(this.looked());
  }

  zoom(factor) {
    const [x, y, metresPerPixel] = this.looked();
    this.look(x, y, metresPerPixel / factor);
  }

  keepProportions() {
    if (this.plot.inner_width === this.size[0] && this.plot.inner_height === this.size[1]) return;
    if (String(this.looked()) === this.wholeIs) this.whole();
    else this.look(...this.looked());
  }

  // Axes and grid in the page's own colours, light or dark.
  dress() {
    const style = getComputedStyle(document.documentElement);
    const [ink, line] = ["--faint", "--line"].map((name) => style.getPropertyValue(name).trim());
    for (const axis of [...this.plot.below, ...this.plot.left]) {
      if (axis.axis_label === undefined) continue;
      axis.setv({ axis_line_color: line, major_tick_line_color: line, minor_tick_line_color: null });
      axis.setv({ major_label_text_color: ink, axis_label_text_color: ink, axis_label_text_font_style: "normal" });
    }
    for (const grid of this.plot.center) if (grid.grid_line_color !== undefined) grid.grid_line_color = line;
  }
}
