// --- lists: events, CAN frames and signals at the cursor --------------------------------------------------

class EventList {
  constructor(run, onPick) {
    this.run = run;
    this.onPick = onPick;
    this.list = byId("event-list");
    byId("event-filter").addEventListener("input", () => this.filter_());
    this.fill_();
  }
  fill_() {
    const {run} = this;
    this.list.replaceChildren();
    this.rows = run.events.map((event) => {
      const look = eventLook(event.kind);
      const mark = element("i", {textContent: look.mark});
      mark.style.color = look.colour;
      const row = element("button", {}, [element("time", {textContent: secondsText(event.time)}), mark,
                                         element("span", {textContent: event.text})]);
      row.title = event.kind.replace(/_/g, " ");
      row.addEventListener("click", () => this.onPick(event.time));
      const item = element("li", {}, [row]);
      this.list.append(item);
      return item;
    });
    this.times_ = run.events.map((event) => event.time);
    this.current = -1;
    this.filter_();
  }
  // After a run has grown.
  grow(time) {
    if (this.rows.length === this.run.events.length) return;
    this.fill_();
    this.setTime(time);
  }
  filter_() {
    const wanted = byId("event-filter").value.trim().toLowerCase();
    let shown = 0;
    this.rows.forEach((row, i) => {
      const {kind, text: sentence} = this.run.events[i];
      row.hidden = !(kind + " " + sentence).toLowerCase().includes(wanted);
      shown += row.hidden ? 0 : 1;
    });
    byId("event-count").textContent = shown + (shown === 1 ? " event" : " events");
  }
  setTime(time) {
    const now = indexAtOrBefore(this.times_, time);
    if (now === this.current) return;
    if (this.rows[this.current]) this.rows[this.current].removeAttribute("aria-current");
    this.current = now;
    const row = this.rows[now];
    if (!row) {
      this.list.scrollTop = 0;
      return;
    }
    row.setAttribute("aria-current", "true");
    const top = row.offsetTop - this.list.offsetTop;
    if (top < this.list.scrollTop || top + row.offsetHeight > this.list.scrollTop + this.list.clientHeight) {
      this.list.scrollTop = top - this.list.clientHeight / 3;
    }
  }
}

const CAN_KINDS = ["NMT", "SYNC", "EMCY", "TIME", "PDO", "SDO", "heartbeat", "LSS", "other"];
const ROW_PX = 22;
const HIGHEST_PX = 6e6;  // browsers limit the height of an element

// The frames that pass the filters. Only the visible rows exist.
class CanTable {
  constructor(run, onPick) {
    this.run = run;
    this.frames = run.frames;
    this.onPick = onPick;
    this.list = byId("can-list");
    this.space = byId("can-space");
    this.box = byId("can-rows");
    this.rows_ = [];
    this.first = 0;
    this.time = run.start;
    this.kinds = new Set();
    this.offered_ = new Set();
    this.offer_();
    byId("can-node").addEventListener("change", () => this.filter());
    byId("can-filter").addEventListener("input", () => {
      clearTimeout(this.typing_);
      this.typing_ = setTimeout(() => this.filter(), 150);
    });
    this.list.addEventListener("scroll", () => this.onScroll_());
    this.list.addEventListener("keydown", (event) => {
      const by = {ArrowUp: -1, ArrowDown: 1, PageUp: -20, PageDown: 20}[event.key];
      if (!by || !this.shown.length) return;
      const next = Math.min(this.shown.length - 1, Math.max(0, this.row + by));
      this.onPick(this.frames.times[this.shown[next]]);
      event.preventDefault();
      event.stopPropagation();
    });
    new ResizeObserver(() => this.show_()).observe(this.list);
    this.filtered_ = false;
  }

  // Offers kinds and nodes of the frames that there are.
  offer_() {
    this.offeredGroups_ = this.frames.groups.length;
    const present = CAN_KINDS.filter((kind) => this.frames.groups.some((group) => group.kind === kind));
    for (const kind of present) if (!this.offered_.has(kind)) this.kinds.add(kind);
    this.offered_ = new Set(present);
    byId("can-kinds").replaceChildren(...present.map((kind) => {
      const button = element("button", {textContent: kind, title: "Show or hide frames of this kind"});
      button.setAttribute("aria-pressed", String(this.kinds.has(kind)));
      button.addEventListener("click", () => {
        const shown = !this.kinds.has(kind);
        if (shown) this.kinds.add(kind);
        else this.kinds.delete(kind);
        button.setAttribute("aria-pressed", String(shown));
        this.filter();
      });
      return button;
    }));
    const nodes = [...new Set(this.frames.groups.map((group) => group.node))].sort((a, b) => a - b);
    const chosen = byId("can-node").value;
    byId("can-node").replaceChildren(element("option", {value: "", textContent: "all nodes"}), ...nodes.map((node) =>
      element("option", {value: String(node), textContent: node + " " + this.frames.nodeName({node})})));
    byId("can-node").value = chosen;
  }
  // After a run has grown. Cutting its beginning changes the numbers of all frames.
  grow(cuts) {
    if (this.offeredGroups_ !== this.frames.groups.length) this.offer_();
    if (cuts !== this.cuts_) this.filtered_ = false;
    this.cuts_ = cuts;
    if (!this.active) return;
    if (this.filtered_) this.filterRest_();
    else this.filter();
  }

  // Filtering costs time with many frames, so it waits until the table is seen.
  get active() { return this.list.clientHeight > 0; }

  // Returns which frames of a group a text selects: all, none, or those of some texts.
  matches_(group, words) {
    const own = [group.identifier.toString(16).padStart(3, "0"), group.kind, this.frames.nodeName(group),
                 group.message ? group.message.name : "",
                 ...(group.message ? group.message.signals.map((signal) => signal.name) : [])].join(" ").toLowerCase();
    return words.filter((word) => !own.includes(word.replace(/^0x/, "")));
  }
  filter() {
    this.filtered_ = true;
    this.shown = [];
    this.seen_ = 0;  // frames that have been filtered
    this.texts_ = new Map();
    this.filterRest_();
    this.setTime(this.time, true);
  }
  filterRest_() {
    const words = byId("can-filter").value.trim().toLowerCase().split(/\s+/).filter(Boolean);
    const node = byId("can-node").value;
    const rest = this.frames.groups.map((group) =>
      this.kinds.has(group.kind) && (node === "" || group.node === Number(node)) ? this.matches_(group, words) : null);
    const texts = this.texts_;
    const textPasses = (frame, left) => {
      const index = this.frames.textIndex(frame);
      if (index === NONE) return false;
      const key = left.join(" ") + "\n" + index;
      if (!texts.has(key)) {
        const text = this.frames.texts[index].toLowerCase();
        texts.set(key, left.every((word) => text.includes(word)));
      }
      return texts.get(key);
    };
    const {shown} = this;
    for (let frame = this.seen_; frame < this.frames.count; ++frame) {
      const left = rest[this.frames.groupOf[frame]];
      if (left && (left.length === 0 || textPasses(frame, left))) shown.push(frame);
    }
    this.seen_ = this.frames.count;
    const format = (n) => n.toLocaleString("en-GB");
    byId("can-count").textContent = shown.length === this.frames.count
      ? format(shown.length) + " frames" : format(shown.length) + " of " + format(this.frames.count);
    this.list.setAttribute("aria-rowcount", String(shown.length));
    this.space.style.height = Math.min(HIGHEST_PX, ROW_PX * shown.length) + "px";
  }
  get visibleRows_() { return Math.ceil(this.list.clientHeight / ROW_PX); }
  get mostFirst_() { return Math.max(0, this.shown.length - Math.floor(this.list.clientHeight / ROW_PX)); }

  onScroll_() {
    if (!this.shown) return;
    const range = this.list.scrollHeight - this.list.clientHeight;
    const first = range > 0 ? Math.round(this.list.scrollTop / range * this.mostFirst_) : 0;
    if (this.scrollsTo_ !== undefined && Math.abs(this.list.scrollTop - this.scrollsTo_) < 2) {
      this.scrollsTo_ = undefined;
      return;
    }
    this.first = first;
    this.show_();
  }
  setTime(time, always = false) {
    this.time = time;
    if (!this.active) return;
    if (!this.filtered_) {
      this.filter();
      return;
    }
    const row = this.rowAt_(time);
    if (row === this.row && !always) return;
    this.row = row;
    // The row of the cursor stays in the middle third.
    const visible = Math.max(1, Math.floor(this.list.clientHeight / ROW_PX));
    if (always || row < this.first + visible / 3 || row > this.first + 2 * visible / 3) {
      this.first = Math.min(this.mostFirst_, Math.max(0, Math.round(row - visible / 2)));
      const range = this.list.scrollHeight - this.list.clientHeight;
      this.list.scrollTop = this.mostFirst_ > 0 ? this.first / this.mostFirst_ * range : 0;
      this.scrollsTo_ = this.list.scrollTop;
    }
    this.show_();
  }
  // Row of the last shown frame up to this time, or -1.
  rowAt_(time) {
    const frame = indexAtOrBefore(this.frames.times, time);
    return indexAtOrBefore(this.shown, frame);
  }
  show_() {
    if (!this.active || !this.shown) return;
    while (this.rows_.length < this.visibleRows_) this.rows_.push(this.makeRow_());
    this.box.style.transform = `translateY(${this.list.scrollTop}px)`;
    this.rows_.forEach((row, i) => this.fillRow_(row, this.first + i));
  }
  makeRow_() {
    const cells = Array.from({length: 6}, () => element("span"));
    for (const cell of cells) cell.setAttribute("role", "cell");
    const node = element("div", {className: "row"}, cells);
    node.setAttribute("role", "row");
    const row = {node, cells, frame: NONE};
    node.addEventListener("click", () => { if (row.frame !== NONE) this.onPick(this.frames.times[row.frame]); });
    this.box.append(node);
    return row;
  }
  fillRow_(row, index) {
    row.node.hidden = index >= this.shown.length || index >= this.first + this.visibleRows_;
    row.frame = row.node.hidden ? NONE : this.shown[index];
    if (row.node.hidden) return;
    const group = this.frames.groups[this.frames.groupOf[row.frame]];
    const data = this.frames.data(row.frame).map((byte) => byte.toString(16).toUpperCase().padStart(2, "0"));
    const texts = [(1e-6 * this.frames.times[row.frame]).toFixed(6),
                   group.identifier.toString(16).toUpperCase().padStart(3, "0"), group.kind,
                   this.frames.nodeName(group), group.remote ? "remote " + group.size : data.join(" "),
                   this.frames.content(row.frame)];
    texts.forEach((text, i) => { row.cells[i].textContent = text; });
    row.node.title = texts[3] + ": " + texts[4] + "\n" + texts[5];
    row.node.dataset.kind = group.kind;
    row.node.setAttribute("aria-rowindex", String(index + 1));
    if (index === this.row) row.node.setAttribute("aria-current", "true");
    else row.node.removeAttribute("aria-current");
  }
}

class SignalList {
  constructor(run, plots) {
    this.run = run;
    this.plots = plots;
    this.list = byId("signal-list");
    this.rows = run.signals.map((signal) => {
      const value = element("b");
      const row = element("button", {title: "Show or hide the plot"}, [element("span", {textContent: signal.name}), value]);
      row.addEventListener("click", () => plots.toggle(signal.name));
      this.list.append(row);
      return {row, value, signal};
    });
    byId("signal-filter").addEventListener("input", () => this.filter_());
    this.filter_();
    this.showPlotted();
  }
  filter_() {
    const words = byId("signal-filter").value.trim().toLowerCase().split(/\s+/).filter(Boolean);
    let shown = 0;
    for (const {row, signal} of this.rows) {
      row.hidden = !words.every((word) => signal.name.toLowerCase().includes(word));
      shown += row.hidden ? 0 : 1;
    }
    byId("signal-count").textContent = shown + " signals; a click plots";
  }
  showPlotted() {
    for (const {row, signal} of this.rows) row.setAttribute("aria-pressed", String(this.plots.shows(signal.name)));
  }
  setTime(time) {
    if (this.list.clientHeight === 0) return;
    const sample = this.run.sampleAt(time);
    for (const {row, value, signal} of this.rows) {
      if (!row.hidden) value.textContent = valueText(signal, this.run.value(signal.name, sample));
    }
  }
}
