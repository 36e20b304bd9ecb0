// --- plots: signals over time -----------------------------------------------------------------------------

const DEFAULT_PANES = [
  ["true_pitch", "imu_pitch", "true_roll", "imu_roll"],
  ["true_left_load", "true_right_load"],
  ["planned_zmp_y", "zmp_y", "true_zmp_y"],
  ["left_knee_target", "left_knee_true"],
];
const AXIS_WIDTH = 58;
const SHORTEST_RANGE_US = 20e3;
const LOWEST_RANGE = 1e-6;  // of values, in their unit: less is noise
const LIVE_RANGE_US = 10e6;  // of a live run, until the user zooms
const DASHES = [[], [7, 3], [2, 2], [9, 3, 2, 3]];

// Draws a signal as a polyline; where several samples share a pixel, from their minimum to their maximum.
function drawSignal(context, times, values, range, x, y) {
  const first = Math.max(0, indexAtOrBefore(times, range.from));
  const last = Math.min(times.length - 1, indexAtOrBefore(times, range.to) + 1);
  context.beginPath();
  let drawing = false;
  let column = NaN;
  let low = 0;
  let high = 0;
  let end = 0;
  const flush = () => {
    if (low < high) {
      context.lineTo(column, y(low));
      context.lineTo(column, y(high));
    }
    context.lineTo(column, y(end));
  };
  for (let i = first; i <= last; ++i) {
    const value = values[i];
    if (!Number.isFinite(value)) {
      if (drawing) flush();
      drawing = false;
      continue;
    }
    const px = Math.round(2 * x(times[i])) / 2;
    if (!drawing) {
      context.moveTo(px, y(value));
      drawing = true;
      column = px;
      low = high = end = value;
    } else if (px === column) {
      low = Math.min(low, value);
      high = Math.max(high, value);
      end = value;
    } else {
      flush();
      column = px;
      low = high = end = value;
      context.lineTo(px, y(value));
    }
  }
  if (drawing) flush();
  context.stroke();
}

function drawTimeTicks(context, range, x, top, bottom, colours, withText) {
  const step = niceStep(range.to - range.from, Math.max(2, (x(range.to) - x(range.from)) / 80));
  const decimals = Math.max(0, -Math.floor(Math.log10(1e-6 * step)));
  context.strokeStyle = colours.rule;
  context.fillStyle = colours.dim;
  context.lineWidth = 1;
  context.textAlign = "center";
  context.textBaseline = "top";
  for (let i = Math.ceil(range.from / step); i * step <= range.to; ++i) {
    const px = Math.round(x(i * step)) + 0.5;
    context.beginPath();
    context.moveTo(px, top);
    context.lineTo(px, bottom);
    context.stroke();
    if (!withText) continue;
    const text = (1e-6 * i * step).toFixed(Math.min(6, decimals)) + " s";
    const half = context.measureText(text).width / 2;
    context.fillText(text, Math.min(Math.max(px, x(range.from) + half), x(range.to) + 1 - half), bottom + 3);
  }
}

// Signals of one unit over the common range of time.
class Pane {
  constructor(plots, names) {
    this.plots = plots;
    this.names = names;
    this.legend = element("div", {className: "legend"});
    this.canvas = element("canvas");
    this.canvas.setAttribute("role", "img");
    this.box = element("div", {className: "pane"}, [this.legend, this.canvas]);
    this.cache_ = document.createElement("canvas");
    listenToPlot(plots, this.canvas);
    this.makeLegend();
  }
  get unit() { return this.plots.run.signalByName.get(this.names[0]).unit; }

  makeLegend() {
    const colours = theme();
    this.values_ = this.names.map(() => element("b"));
    this.series_ = seriesOf(this.names);
    this.legend.replaceChildren(...this.names.map((name, i) => {
      const swatch = element("i");
      swatch.style.background = colours.series[this.series_[i] % colours.series.length];
      const remove = element("button", {className: "chip", title: "Remove " + name},
                             [swatch, name + " ", this.values_[i], element("span", {textContent: "×"})]);
      remove.addEventListener("click", () => this.plots.toggle(name));
      return remove;
    }));
    this.canvas.setAttribute("aria-label", "Plot of " + this.names.join(", "));
  }
  showValues(sample, otherSample) {
    this.names.forEach((name, i) => {
      const {run, other} = this.plots;
      const signal = run.signalByName.get(name);
      let text = valueText(signal, run.plottedValue(name, sample));
      if (other && other.signalByName.has(name)) text += " | " + valueText(signal, other.plottedValue(name, otherSample));
      this.values_[i].textContent = text;
    });
  }

  // Lowest and highest value in the range of time, with a margin.
  limits_(range) {
    let low = Infinity;
    let high = -Infinity;
    for (const run of this.plots.runs) {
      const first = Math.max(0, indexAtOrBefore(run.times, range.from));
      const last = indexAtOrBefore(run.times, range.to);
      for (const name of this.names) {
        const signal = run.signalByName.get(name);
        if (!signal) continue;
        const values = signal.plotted;
        for (let i = first; i <= last; ++i) {
          if (values[i] < low) low = values[i];
          if (values[i] > high) high = values[i];
        }
      }
    }
    if (!(low <= high)) return {low: -1, high: 1};
    const margin = high - low < LOWEST_RANGE ? Math.max(1e-6, 0.1 * Math.abs(low) || 1) : 0.06 * (high - low);
    return {low: low - margin, high: high + margin};
  }

  // Draws everything but the cursor into a cache.
  draw() {
    const {context, width, height} = fittedContext(this.canvas);
    if (width === 0 || height === 0) return;
    const colours = theme();
    const {range, runs, run} = this.plots;
    const {low, high} = this.limits_(range);
    const bottom = height - (this.plots.isLast(this) ? 18 : 3);
    const x = this.plots.toX(width);
    const y = (value) => 3 + (high - value) / (high - low) * (bottom - 3);
    context.font = "11px system-ui, sans-serif";
    drawTimeTicks(context, range, x, 3, bottom, colours, this.plots.isLast(this));

    const shown = shownUnit(this.unit);
    const step = niceStep((high - low) * shown.factor, Math.max(2, (bottom - 3) / 26));
    const signal = run.signalByName.get(this.names[0]);
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (let i = Math.ceil(low * shown.factor / step); i * step <= high * shown.factor; ++i) {
      const py = Math.round(y(i * step / shown.factor)) + 0.5;
      context.strokeStyle = colours.rule;
      context.beginPath();
      context.moveTo(AXIS_WIDTH, py);
      context.lineTo(width, py);
      context.stroke();
      context.fillStyle = colours.dim;
      const named = signal.names.get(i * step);
      const text = named ? named.slice(0, 9) : formatNumber(Number((i * step).toPrecision(9)));
      if (py > 8 && py < bottom - 4) context.fillText(text, AXIS_WIDTH - 5, py);
    }
    context.save();
    context.translate(9, (bottom + 3) / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    context.fillStyle = colours.ink;
    context.fillText(shown.text, 0, 0);
    context.restore();

    context.save();
    context.beginPath();
    context.rect(AXIS_WIDTH, 0, width - AXIS_WIDTH, bottom + 1);
    context.clip();
    context.lineJoin = "round";
    runs.forEach((one, r) => this.names.forEach((name, i) => {
      if (!one.signalByName.has(name)) return;
      context.strokeStyle = colours.series[this.series_[i] % colours.series.length];
      context.lineWidth = r === 0 ? 1.5 : 1.1;
      context.globalAlpha = r === 0 ? 1 : 0.75;
      context.setLineDash(r === 0 ? DASHES[Math.floor(i / colours.series.length) % DASHES.length] : [4, 3]);
      drawSignal(context, one.times, one.signalByName.get(name).plotted, range, x, y);
    }));
    context.restore();
    this.bottom_ = bottom;
    this.cache_.width = this.canvas.width;
    this.cache_.height = this.canvas.height;
    if (this.canvas.width && this.canvas.height) this.cache_.getContext("2d").drawImage(this.canvas, 0, 0);
  }

  // Draws the cursor over the cached plot.
  drawCursor() {
    if (!this.cache_.width || !this.cache_.height) return;
    const {context, width} = fittedContext(this.canvas);
    context.save();
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.cache_, 0, 0);
    context.restore();
    const colours = theme();
    const px = this.plots.toX(width)(this.plots.time);
    this.cursorX = px;
    if (px >= AXIS_WIDTH && px <= width) {
      context.strokeStyle = colours.cursor;
      context.lineWidth = 1.5;
      context.beginPath();
      context.moveTo(px, 0);
      context.lineTo(px, this.bottom_);
      context.stroke();
    }
  }
}

// Dragging moves the cursor, the wheel and two fingers zoom, Shift-dragging moves along.
function listenToPlot(plots, canvas) {
  const pointers = new Map();
  const timeAt = (clientX) => plots.toTime(canvas.clientWidth)(clientX - canvas.getBoundingClientRect().left);
  let before = null;
  canvas.addEventListener("pointerdown", (event) => {
    if (event.button > 1) return;
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, event.clientX);
    before = event.clientX;
    if (pointers.size === 1 && !event.shiftKey && event.button === 0) plots.onPick(timeAt(event.clientX));
    event.preventDefault();
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!pointers.has(event.pointerId)) {
      plots.hover(canvas, event, timeAt(event.clientX));
      return;
    }
    const spread = () => {
      const [a, b] = [...pointers.values()];
      return {width: Math.max(8, Math.abs(a - b)), middle: (a + b) / 2};
    };
    if (pointers.size === 2) {
      const old = spread();
      pointers.set(event.pointerId, event.clientX);
      const now = spread();
      plots.zoom(old.width / now.width, timeAt(now.middle));
      plots.shift(timeAt(old.middle) - timeAt(now.middle));
    } else if (event.shiftKey || event.buttons === 4) {
      plots.shift(timeAt(before) - timeAt(event.clientX));
      pointers.set(event.pointerId, event.clientX);
    } else {
      plots.onPick(timeAt(event.clientX));
      pointers.set(event.pointerId, event.clientX);
    }
    before = event.clientX;
  });
  const end = (event) => pointers.delete(event.pointerId);
  canvas.addEventListener("pointerup", end);
  canvas.addEventListener("pointercancel", end);
  canvas.addEventListener("pointerleave", () => tooltip.hide());
  canvas.addEventListener("wheel", (event) => {
    if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) {
      const share = (event.deltaX || event.deltaY) / canvas.clientWidth;
      plots.shift(share * (plots.range.to - plots.range.from));
    } else {
      plots.zoom(Math.exp(0.0016 * event.deltaY), timeAt(event.clientX));
    }
    event.preventDefault();
  }, {passive: false});
  canvas.addEventListener("dblclick", () => plots.setRange(plots.whole.from, plots.whole.to));
}

class Plots {
  constructor(page, onPick, onChange) {
    this.run = page.run;
    this.other = page.other;
    this.runs = page.other ? [page.run, page.other] : [page.run];
    this.onPick = onPick;
    this.onChange = onChange;
    this.whole = this.wholeRange_();
    this.range = {...this.whole};
    this.followed_ = LIVE_RANGE_US;
    this.time = this.run.start;
    this.box = byId("panes");
    this.panes = DEFAULT_PANES.map((names) => names.filter((name) => this.run.signalByName.has(name)))
      .filter((names) => names.length > 0).map((names) => new Pane(this, names));
    this.fill_();
    byId("signal-names").replaceChildren(...this.run.signals.map((signal) => element("option", {value: signal.name})));
    const box = byId("add-signal");
    box.addEventListener("input", () => {
      this.note_("");
      if (this.run.signalByName.has(box.value)) this.addFrom_(box, box.value);
    });
    // Enter, or another way to finish a name.
    box.addEventListener("change", () => this.addNamed_(box));
    byId("whole").addEventListener("click", () => this.setRange(this.whole.from, this.whole.to));
    byId("two-seconds").addEventListener("click", () => this.showTwoSeconds());
    new ResizeObserver(() => this.draw()).observe(this.box);
  }
  addFrom_(box, name) {
    if (!this.shows(name)) this.toggle(name);
    box.value = "";
    this.note_("");
  }
  // Adds the signal whose name has all words of a text, or says why there is no such signal.
  addNamed_(box) {
    const words = box.value.trim().toLowerCase().split(/\s+/).filter(Boolean);
    if (!words.length) return;
    const found = this.run.signals.filter((signal) => words.every((word) => signal.name.toLowerCase().includes(word)));
    if (found.length === 1) this.addFrom_(box, found[0].name);
    else if (found.length === 0) this.note_(`No signal is named “${box.value.trim()}”: the tab Signals lists all.`);
    else this.note_(`“${box.value.trim()}” is in the names of ${found.length} signals, such as ${found[0].name}: choose one.`);
  }
  note_(text) {
    byId("signal-note").textContent = text;
    byId("signal-note").hidden = !text;
  }
  wholeRange_() { return {from: this.run.start, to: Math.max(this.run.end, this.run.start + SHORTEST_RANGE_US)}; }
  // After a run has grown: at its end, the range moves along.
  grow(follows) {
    const isWhole = this.range.from <= this.whole.from && this.range.to >= this.whole.to;
    this.whole = this.wholeRange_();
    const {from, to} = this.whole;
    if (follows) this.range = {from: Math.max(from, to - this.followed_), to};
    else if (isWhole) this.range = {...this.whole};
    this.draw();
  }
  fill_() {
    this.box.replaceChildren(...this.panes.map((pane) => pane.box));
    if (!this.panes.length) {
      this.box.append(element("p", {className: "empty", textContent: "Add a signal above, or in the tab Signals."}));
    }
    this.draw();
  }
  isLast(pane) { return pane === this.panes[this.panes.length - 1]; }
  toX(width) {
    const {from, to} = this.range;
    return (time) => AXIS_WIDTH + (time - from) / (to - from) * (width - AXIS_WIDTH - 1);
  }
  toTime(width) {
    const {from, to} = this.range;
    return (px) => from + (px - AXIS_WIDTH) / Math.max(1, width - AXIS_WIDTH - 1) * (to - from);
  }
  shows(name) { return this.panes.some((pane) => pane.names.includes(name)); }

  // Adds a signal to the last pane of its unit that has room, or removes it.
  toggle(name) {
    const present = this.panes.find((pane) => pane.names.includes(name));
    if (present) {
      present.names = present.names.filter((one) => one !== name);
      if (present.names.length) present.makeLegend();
      else this.panes = this.panes.filter((pane) => pane !== present);
    } else {
      const {unit} = this.run.signalByName.get(name);
      const room = [...this.panes].reverse().find((pane) => pane.unit === unit && pane.names.length < 6);
      if (room) {
        room.names.push(name);
        room.makeLegend();
      } else {
        this.panes.push(new Pane(this, [name]));
      }
    }
    this.fill_();
    this.setTime(this.time);
    this.onChange();
  }

  setRange(from, to) {
    const length = Math.min(Math.max(to - from, SHORTEST_RANGE_US), this.whole.to - this.whole.from);
    const begin = Math.min(Math.max(from, this.whole.from), this.whole.to - length);
    this.range = {from: begin, to: begin + length};
    this.followed_ = length >= this.whole.to - this.whole.from ? Infinity : length;
    this.draw();
    this.onChange();
  }
  zoom(factor, about) {
    const {from, to} = this.range;
    this.setRange(about - (about - from) * factor, about + (to - about) * factor);
  }
  shift(by) { this.setRange(this.range.from + by, this.range.to + by); }
  showTwoSeconds() { this.setRange(this.time - 1e6, this.time + 1e6); }

  draw() {
    for (const pane of this.panes) {
      pane.draw();
      pane.drawCursor();
    }
    byId("plot-range").textContent = (1e-6 * this.range.from).toFixed(2) + " – " + secondsText(this.range.to, 2);
  }
  setTheme() {
    for (const pane of this.panes) pane.makeLegend();
    this.draw();
    this.setTime(this.time);
  }
  setTime(time) {
    this.time = time;
    const sample = this.run.sampleAt(time);
    const otherSample = this.other ? this.other.sampleAt(time) : 0;
    const {from, to} = this.range;
    if ((time < from || time > to) && to - from < this.whole.to - this.whole.from) {
      // Turns the page when the cursor leaves it.
      const length = to - from;
      this.setRange(time < from ? time - 0.9 * length : time - 0.1 * length, 0);
      this.setRange(time - (time < from ? 0.9 : 0.1) * length, time + (time < from ? 0.1 : 0.9) * length);
    }
    for (const pane of this.panes) {
      pane.drawCursor();
      pane.showValues(sample, otherSample);
    }
  }
  hover(canvas, event, time) {
    const pane = this.panes.find((one) => one.canvas === canvas);
    if (!pane || event.pointerType === "touch" || time < this.range.from) {
      tooltip.hide();
      return;
    }
    const sample = this.run.sampleAt(time);
    const lines = pane.names.map((name) => name + "  " + valueText(this.run.signalByName.get(name), this.run.plottedValue(name, sample)));
    tooltip.show([secondsText(this.run.times[sample]), ...lines].join("\n"), event.clientX, event.clientY);
  }
}
