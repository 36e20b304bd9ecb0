// --- timeline: states, events, pushes and the cursor over the whole run -----------------------------------

// Events by what they mean: mark and colour.
const EVENT_LOOKS = {
  command: {mark: "▸", colour: "#0072b2"}, velocity: {mark: "▸", colour: "#0072b2"},
  push: {mark: "◆", colour: MARKS.push}, release: {mark: "◇", colour: "#00825f"},
  state: {mark: "|", colour: "#6b7280"}, end: {mark: "■", colour: "#6b7280"},
};
const BAD_EVENTS = new Set(["fall", "fall_foreseen", "cut_off", "motion_failed", "recovery_failed", "fault", "emergency_stop",
                            "low_supply", "emergency", "scenario_fault", "error", "interrupted", "left_out"]);
function eventLook(kind) {
  return BAD_EVENTS.has(kind) ? {mark: "▲", colour: "#d55e00"}
                              : EVENT_LOOKS[kind] || {mark: "●", colour: "#00825f"};
}

// Intervals of equal value of the state signal: {from, to, name}.
function stateIntervals(run) {
  const signal = run.stateSignal;
  if (!signal || run.times.length === 0) return [];
  const intervals = [];
  const {values} = signal;
  for (let i = 0; i < values.length; ++i) {
    const last = intervals[intervals.length - 1];
    if (last && last.value === values[i]) continue;
    if (last) last.to = run.times[i];
    intervals.push({from: run.times[i], to: run.end, value: values[i],
                    name: signal.names.get(values[i]) || String(values[i])});
  }
  return intervals;
}

class Timeline {
  constructor(page, plots, onPick) {
    this.run = page.run;
    this.difference = page.difference;
    this.plots = plots;
    this.canvas = byId("timeline");
    this.cache_ = document.createElement("canvas");
    this.runs_ = page.other ? [page.run, page.other] : [page.run];
    this.time = this.run.start;
    this.readStates_();
    let dragging = false;
    const pick = (event) => onPick(this.toTime_(event.clientX - this.canvas.getBoundingClientRect().left));
    this.canvas.addEventListener("pointerdown", (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      dragging = true;
      this.canvas.focus();
      const near = this.eventsNear_(event);
      if (near.length) onPick(near[0].time);
      else pick(event);
      event.preventDefault();
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (dragging) pick(event);
      else this.hover_(event);
    });
    for (const name of ["pointerup", "pointercancel"]) this.canvas.addEventListener(name, () => { dragging = false; });
    this.canvas.addEventListener("pointerleave", () => tooltip.hide());
    this.showLimits_();
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }
  readStates_() {
    this.bands = this.runs_.map(stateIntervals);
    const states = [...new Set(this.bands.flat().map((interval) => interval.name))];
    if (String(states) === String(this.states)) return;
    this.states = states;
    this.makeLegend_();
  }
  showLimits_() {
    this.canvas.setAttribute("aria-valuemin", (1e-6 * this.run.start).toFixed(3));
    this.canvas.setAttribute("aria-valuemax", (1e-6 * this.run.end).toFixed(3));
  }
  // After a run has grown.
  grow() {
    this.readStates_();
    this.showLimits_();
    this.draw();
  }
  colour_(name) { return stateColour(name, this.states.indexOf(name)); }
  makeLegend_() {
    byId("legend").replaceChildren(...this.states.map((name) => {
      const swatch = element("i");
      swatch.style.background = this.colour_(name);
      return element("span", {}, [swatch, name]);
    }));
  }
  stateAt(time) {
    const band = this.bands[0];
    const i = indexAtOrBefore(band.map((interval) => interval.from), time);
    return band.length ? band[Math.max(0, i)].name : "";
  }
  toX_(time) {
    const {from, to} = this.plots.whole;
    return 8 + (time - from) / (to - from) * (this.canvas.clientWidth - 16);
  }
  toTime_(px) {
    const {from, to} = this.plots.whole;
    return from + (px - 8) / Math.max(1, this.canvas.clientWidth - 16) * (to - from);
  }

  // Rows from the top: ticks with the run's times, states (one band per run), events.
  rows_() { return {band: 4, bandHeight: this.bands.length > 1 ? 11 : 18, marks: 36, ticks: 46}; }

  draw() {
    const {context, width, height} = fittedContext(this.canvas);
    if (width === 0 || height === 0) return;
    const colours = theme();
    const rows = this.rows_();
    context.font = "11px system-ui, sans-serif";
    const {from, to} = this.plots.range;
    if (to - from < this.plots.whole.to - this.plots.whole.from) {
      context.fillStyle = colours.accent;
      context.globalAlpha = 0.16;
      context.fillRect(this.toX_(from), 0, this.toX_(to) - this.toX_(from), height);
      context.globalAlpha = 1;
    }
    drawTimeTicks(context, this.plots.whole, (time) => this.toX_(time), rows.band, rows.ticks, colours, true);
    this.bands.forEach((band, r) => this.drawBand_(context, band, rows.band + r * (rows.bandHeight + 1), rows.bandHeight));
    context.fillStyle = MARKS.push;
    for (const push of this.run.pushes) {
      const left = this.toX_(push.start);
      context.fillRect(left, rows.marks + 6, Math.max(2, this.toX_(push.end) - left), 3);
    }
    context.textAlign = "center";
    context.textBaseline = "middle";
    for (const event of this.run.events) {
      const look = eventLook(event.kind);
      context.fillStyle = colours.dark ? lighter(look.colour) : look.colour;
      context.fillText(look.mark, this.toX_(event.time), rows.marks);
    }
    if (this.difference) {
      const px = this.toX_(this.difference.time);
      context.strokeStyle = context.fillStyle = GHOST_COLOUR;
      context.lineWidth = 2;
      context.setLineDash([4, 2]);
      context.beginPath();
      context.moveTo(px, 0);
      context.lineTo(px, rows.ticks);
      context.stroke();
      context.setLineDash([]);
      context.textAlign = px > width - 90 ? "right" : "left";
      context.font = "bold 11px system-ui, sans-serif";
      context.fillText("≠", px + (px > width - 90 ? -4 : 4), rows.marks);
    }
    this.cache_.width = this.canvas.width;
    this.cache_.height = this.canvas.height;
    this.cache_.getContext("2d").drawImage(this.canvas, 0, 0);
    this.drawCursor_();
  }
  drawBand_(context, band, top, height) {
    context.textAlign = "left";
    context.textBaseline = "middle";
    for (const interval of band) {
      const left = this.toX_(interval.from);
      const width = Math.max(1, this.toX_(interval.to) - left);
      const colour = this.colour_(interval.name);
      context.fillStyle = colour;
      context.fillRect(left, top, width, height);
      if (width < context.measureText(interval.name).width + 8 || height < 12) continue;
      context.fillStyle = inkOn(colour);
      context.fillText(interval.name, left + 4, top + height / 2 + 0.5);
    }
  }
  drawCursor_() {
    if (!this.cache_.width || !this.cache_.height) return;
    const {context, height} = fittedContext(this.canvas);
    context.save();
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.cache_, 0, 0);
    context.restore();
    const px = this.toX_(this.time);
    this.cursorX = px;
    context.fillStyle = context.strokeStyle = theme().cursor;
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(px, 2);
    context.lineTo(px, height - 14);
    context.stroke();
    context.beginPath();
    context.moveTo(px - 6, 0);
    context.lineTo(px + 6, 0);
    context.lineTo(px, 8);
    context.fill();
  }
  setTime(time) {
    this.time = time;
    this.drawCursor_();
    this.canvas.setAttribute("aria-valuenow", (1e-6 * time).toFixed(3));
    this.canvas.setAttribute("aria-valuetext", secondsText(time) + ", " + this.stateAt(time));
  }
  eventsNear_(pointer) {
    const box = this.canvas.getBoundingClientRect();
    const x = pointer.clientX - box.left;
    const rows = this.rows_();
    if (Math.abs(pointer.clientY - box.top - rows.marks) > 9) return [];
    return this.run.events.filter((event) => Math.abs(this.toX_(event.time) - x) < 6)
      .sort((a, b) => Math.abs(this.toX_(a.time) - x) - Math.abs(this.toX_(b.time) - x));
  }
  hover_(pointer) {
    const box = this.canvas.getBoundingClientRect();
    const near = this.eventsNear_(pointer).sort((a, b) => a.time - b.time).slice(0, 6);
    const time = Math.max(this.run.start, Math.min(this.run.end, this.toTime_(pointer.clientX - box.left)));
    const lines = near.map((event) => secondsText(event.time) + "  " + event.text);
    if (this.difference && Math.abs(this.toX_(this.difference.time) - (pointer.clientX - box.left)) < 5) {
      lines.push(secondsText(this.difference.time) + "  First difference: " + this.difference.text);
    }
    if (!lines.length) lines.push(secondsText(time) + "  " + this.stateAt(time));
    tooltip.show(lines.join("\n"), pointer.clientX, pointer.clientY - 30);
  }
}

// The colour, halfway to white.
function lighter(colour) {
  return "#" + [1, 3, 5].map((i) => Math.round((parseInt(colour.slice(i, i + 2), 16) + 255) / 2).toString(16).padStart(2, "0")).join("");
}
