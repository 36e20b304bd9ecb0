// --- live: a run that grows ------------------------------------------------------------------------------
// Format of the stream: batch.h. Texts are JSON; the first one describes the stream.

const WINDOW_US = 120e6;        // the page keeps the last two minutes
const WINDOW_SLACK_US = 10e6;   // and forgets older samples in steps
const MAX_TEXTS = 20000;        // different contents of frames
const NO_TEXT = 65535;                // in the stream
const NO_TEXT_INDEX = 0xffffffff;     // in the page
const RETRY_MS = 1500;

// A column of numbers that grows at its end and is cut at its beginning.
class Growing {
  constructor(Type, stride = 1) {
    this.array_ = new Type(1024 * stride);
    this.stride_ = stride;
    this.length = 0;  // in rows
  }
  // Returns the index at which the numbers of a new row are to be written.
  addRow() {
    const at = this.length++ * this.stride_;
    if (at + this.stride_ > this.array_.length) {
      const larger = new this.array_.constructor(2 * this.array_.length);
      larger.set(this.array_);
      this.array_ = larger;
    }
    return at;
  }
  push(value) {
    const at = this.addRow();
    this.array_[at] = value;
  }
  get array() { return this.array_; }
  get view() { return this.array_.subarray(0, this.length * this.stride_); }
  cut(rows) {
    this.array_.copyWithin(0, rows * this.stride_, this.length * this.stride_);
    this.length -= rows;
  }
}

class LiveFrames extends Frames {
  constructor(json, network, bytes, kinds) {
    super(json, network, bytes);
    this.kinds_ = kinds;
    this.columns_ = {times: new Growing(Float64Array), groupOf: new Growing(Uint16Array), textOf: new Growing(Uint32Array),
                     data: new Growing(Uint8Array, 8)};
    this.groupByKey_ = new Map();
    this.forgetTexts_();
    this.refresh();
  }
  refresh() {
    this.times = this.columns_.times.view;
    this.groupOf = this.columns_.groupOf.view;
  }
  // Adds the frames of a batch that are newer than the last one.
  append(view, count, texts) {
    const {times, groupOf, textOf, data} = this.columns_;
    for (let i = 0, at = 0; i < count; ++i, at += 24) {
      const time = view.getFloat64(at, true);
      if (times.length && time <= times.array[times.length - 1]) continue;
      times.push(time);
      groupOf.push(this.group_(view, at));
      const text = view.getUint16(at + 14, true);
      textOf.push(text === NO_TEXT ? NO_TEXT_INDEX : this.intern_(texts[text]));
      const row = data.addRow();
      for (let k = 0; k < 8; ++k) data.array[row + k] = view.getUint8(at + 16 + k);
    }
  }
  group_(view, at) {
    const identifier = view.getUint16(at + 8, true);
    const size = view.getUint8(at + 10);
    const remote = view.getUint8(at + 11) !== 0;
    const key = identifier + 65536 * (size + (remote ? 16 : 0));
    if (!this.groupByKey_.has(key)) {
      this.groupByKey_.set(key, this.groups.length);
      const group = {identifier, size, remote, kind: this.kinds_[view.getUint8(at + 12)], node: view.getUint8(at + 13)};
      this.complete_(group);
      this.groups.push(group);
    }
    return this.groupByKey_.get(key);
  }
  intern_(text) {
    if (!this.textIndices_.has(text)) {
      this.textIndices_.set(text, this.texts.length);
      this.texts.push(text);
    }
    return this.textIndices_.get(text);
  }
  forgetTexts_() {
    this.texts = [];
    this.textIndices_ = new Map();
  }
  textIndex(frame) {
    const text = this.columns_.textOf.array[frame];
    return text === NO_TEXT_INDEX ? NONE : text;
  }
  data(frame) {
    const group = this.groups[this.groupOf[frame]];
    return group.remote ? [] : [...this.columns_.data.array.subarray(8 * frame, 8 * frame + group.size)];
  }
  cut(time) {
    const count = indexAtOrBefore(this.columns_.times.view, time) + 1;
    for (const column of Object.values(this.columns_)) column.cut(count);
    if (this.texts.length <= MAX_TEXTS) return;
    const {texts} = this;
    const {view} = this.columns_.textOf;
    this.forgetTexts_();
    for (let i = 0; i < view.length; ++i) if (view[i] !== NO_TEXT_INDEX) view[i] = this.intern_(texts[view[i]]);
  }
}
// A run that is still going on. refresh() shows what has been appended.
class LiveRun extends Run {
  constructor(json, network, bytes, kinds) {
    super(json, network, bytes);
    this.live = true;
    this.frames = new LiveFrames(json.frames, network, bytes, kinds);
    const numbers = (count) => Array.from({length: count}, () => new Growing(Float32Array));
    this.columns_ = {times: new Growing(Float64Array), poses: this.poses.map(() => numbers(7)), values: numbers(this.signals.length),
                     ends: new Growing(Uint32Array), contacts: numbers(8)};
    this.lost = {samples: 0, frames: 0};
    this.cuts = 0;
    this.refresh();
  }
  // All columns that have a row per sample.
  get sampleColumns_() {
    const {times, poses, values, ends} = this.columns_;
    return [times, ends, ...poses.flat(), ...values];
  }
  append(buffer) {
    for (let at = 0; at < buffer.byteLength;) {
      const [size, jsonSize, samples, contacts, frames, links, signals] = new Uint32Array(buffer, at, 8);
      let from = at + 32;
      const take = (Type, count) => {
        const numbers = new Type(buffer, from, count);
        from += numbers.byteLength;
        return numbers;
      };
      const times = take(Float64Array, samples);
      const frameBytes = take(Uint8Array, 24 * frames);
      const poses = take(Float32Array, 7 * links * samples);
      const values = take(Float32Array, signals * samples);
      const counts = take(Uint32Array, samples);
      const forces = take(Float32Array, 8 * contacts);
      const text = new TextDecoder().decode(new Uint8Array(buffer, at + size - jsonSize, jsonSize)).trim();
      const json = text ? JSON.parse(text) : {};
      this.appendSamples_(times, poses, values, counts, forces);
      this.frames.append(new DataView(buffer, frameBytes.byteOffset, frameBytes.byteLength), frames, json.texts || []);
      for (const event of json.events || []) this.insert_(this.events, event, event.time, (one) => one.time);
      for (const push of json.pushes || []) this.insert_(this.pushes, push, push.start, (one) => one.start);
      if (json.lost) {
        this.lost.samples += json.lost.samples;
        this.lost.frames += json.lost.frames;
      }
      at += size;
    }
    this.cut_();
  }
  // In order of time, and once: after a lost connection the stream repeats some.
  insert_(list, one, time, timeOf) {
    let place = list.length;
    while (place > 0 && timeOf(list[place - 1]) > time) --place;
    const text = JSON.stringify(one);
    for (let i = place - 1; i >= 0 && timeOf(list[i]) === time; --i) if (JSON.stringify(list[i]) === text) return;
    list.splice(place, 0, one);
  }
  appendSamples_(times, poses, values, counts, forces) {
    const {columns_} = this;
    const links = this.poses.length;
    let contact = 0;
    times.forEach((time, sample) => {
      const firstContact = contact;
      contact += counts[sample];
      if (columns_.times.length && time <= columns_.times.array[columns_.times.length - 1]) return;
      columns_.times.push(time);
      columns_.poses.forEach((pose, link) => pose.forEach((column, k) => column.push(poses[7 * (links * sample + link) + k])));
      columns_.values.forEach((column, k) => column.push(values[columns_.values.length * sample + k]));
      for (let c = firstContact; c < contact; ++c) columns_.contacts.forEach((column, k) => column.push(forces[8 * c + k]));
      columns_.ends.push(columns_.contacts[0].length);
    });
  }
  cut_() {
    const {times, ends, contacts} = this.columns_;
    if (times.length === 0 || times.array[times.length - 1] - times.array[0] < WINDOW_US + WINDOW_SLACK_US) return;
    const until = times.array[times.length - 1] - WINDOW_US;
    const rows = indexAtOrBefore(times.view, until) + 1;
    const cutContacts = ends.array[rows - 1];
    for (const column of this.sampleColumns_) column.cut(rows);
    for (let i = 0; i < ends.length; ++i) ends.array[i] -= cutContacts;
    for (const column of contacts) column.cut(cutContacts);
    this.frames.cut(until);
    ++this.cuts;
  }
  refresh() {
    const {times, poses, values, ends, contacts} = this.columns_;
    this.times = times.view;
    poses.forEach((pose, link) => {
      this.poses[link] = {position: pose.slice(0, 3).map((column) => column.view), quaternion: pose.slice(3).map((column) => column.view)};
    });
    this.signals.forEach((signal, i) => { signal.values_ = values[i].view; });
    const first = new Uint32Array(ends.length + 1);
    first.set(ends.view, 1);
    const [link, otherLink, x, y, z, fx, fy, fz] = contacts.map((column) => column.view);
    this.contacts = {first, link, otherLink, position: [x, y, z], force: [fx, fy, fz]};
    this.frames.refresh();
  }
}

// The connection to the simulation. It calls onFirst with the data of a page as soon as there is a sample, and then
// onGrowth after each message and onChange when the connection or a text changes.
class Stream {
  constructor() {
    this.state = "connecting";  // "live", "lost", "ended"
    this.note = "";
    this.refused = "";
    this.dropped = 0;
    this.control = null;
    this.onFirst = this.onFailure = this.onGrowth = this.onChange = this.onEnd = () => {};
    this.connect_();
  }
  connect_() {
    const path = window.location.pathname.replace(/\/?$/, "/stream");
    this.socket_ = new WebSocket("ws://" + window.location.host + path);
    this.socket_.binaryType = "arraybuffer";
    this.greeted_ = false;
    this.socket_.addEventListener("message", ({data}) => {
      try {
        if (typeof data === "string") this.hear_(JSON.parse(data));
        else this.take_(data);
      } catch (error) {
        this.onFailure(error);
        throw error;
      }
    });
    this.socket_.addEventListener("close", () => {
      if (this.state === "ended") return;
      this.change_("lost");
      setTimeout(() => this.connect_(), RETRY_MS);
    });
  }
  change_(state) {
    this.state = state;
    this.onChange();
  }
  hear_(text) {
    if (text.keys) this.control = text;
    if (text.note !== undefined) this.note = text.note;
    if (text.dropped !== undefined) this.dropped = text.dropped;
    if (text.note !== undefined) this.refused = "";
    if (text.refused !== undefined) this.refused = text.refused;
    if (text.end) {
      this.state = "ended";
      this.onEnd();
    }
    this.onChange();
  }
  take_(buffer) {
    if (!this.greeted_) {
      this.greeted_ = true;
      if (!this.run) {
        const {header, columns} = parseData(new Uint8Array(buffer));
        this.run = new LiveRun(header.run, header.network, columns, this.control.kinds);
      }
      return;
    }
    if (this.state !== "ended" && this.state !== "live") this.change_("live");
    this.run.append(buffer);
    if (!this.shown_ && this.run.columns_.times.length) {
      this.shown_ = true;
      this.run.refresh();
      this.onFirst({run: this.run, other: null, difference: null, stream: this});
    }
    this.onGrowth();
  }
  press(key) {
    if (this.socket_.readyState === WebSocket.OPEN) this.socket_.send(key);
  }
}

function readStream() {
  const stream = new Stream();
  return new Promise((resolve, reject) => {
    stream.onFirst = resolve;
    stream.onFailure = reject;
  });
}

const KEY_SIGNS = {ArrowUp: "↑", ArrowDown: "↓", ArrowLeft: "←", ArrowRight: "→", Enter: "↵", " ": "space", "-": "−"};

// What only a live page has: the state of the connection, the button Live, and the keys that drive the robot.
class LivePanel {
  constructor(page, stream) {
    this.page = page;
    this.stream = stream;
    this.driving = false;
    document.body.dataset.live = "true";
    byId("live-state").hidden = byId("live").hidden = false;
    byId("live").addEventListener("click", () => page.goLive());
    byId("kept").hidden = false;
    byId("kept").textContent = `This page keeps the last ${1e-6 * WINDOW_US} s of the run, with numbers of 32 bits. ` +
        "Events appear when their text is final, a second late.";
    byId("accuracy").hidden = true;
    this.keys_ = new Set(stream.control.keys.flatMap((row) => row.keys));
    if (this.keys_.size) this.makeDrive_();
    stream.onChange = () => this.show();
    this.show();
  }
  makeDrive_() {
    byId("drive").hidden = false;
    byId("drive-switch").addEventListener("click", () => this.setDriving(!this.driving));
    byId("drive-keys").replaceChildren(...this.stream.control.keys.map(({keys, name}) => {
      const signs = keys.map((key) => KEY_SIGNS[key] || key).join(" ");
      const button = element("button", {title: name}, [element("kbd", {textContent: signs}), " " + name]);
      button.dataset.key = keys[0];
      if (name === "emergency stop") button.className = "danger";
      button.addEventListener("pointerdown", (event) => event.preventDefault());  // the focus stays
      button.addEventListener("click", () => this.stream.press(keys[0]));
      return button;
    }));
  }
  get mayDrive() { return this.keys_.size > 0 && !this.stream.control.refusal && this.stream.state === "live"; }
  setDriving(driving) {
    this.driving = driving && this.mayDrive;
    if (this.driving) this.page.goLive();
    this.show();
  }
  // Whether a key goes to the robot instead of the page.
  takes(event) {
    if (!this.driving) return false;
    if (event.key === "Escape") {
      this.setDriving(false);
      return true;
    }
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (!this.keys_.has(key)) return false;
    this.stream.press(key);
    event.preventDefault();
    return true;
  }
  show() {
    const {stream, page} = this;
    if (this.driving && !this.mayDrive) this.driving = false;
    const state = byId("live-state");
    const lost = stream.run.lost;
    const gone = stream.dropped + lost.samples + lost.frames;
    state.dataset.state = stream.state;
    state.textContent = {live: "● live", lost: "✕ connection lost, trying again", ended: "■ the run has ended",
                         connecting: "… connecting"}[stream.state] + (gone ? `; ${gone} records left out` : "");
    state.title = gone ? `This page was too slow for ${lost.samples} samples and ${lost.frames} frames, ` +
        `the machine for ${stream.dropped} records. The files of the run are not affected by the page.` : "";
    byId("live").setAttribute("aria-pressed", String(page.following));
    if (!this.keys_.size) return;
    const {refusal} = stream.control;
    const toggle = byId("drive-switch");
    toggle.hidden = Boolean(refusal);
    toggle.disabled = !this.mayDrive;
    toggle.setAttribute("aria-pressed", String(this.driving));
    toggle.textContent = this.driving ? "Driving: keys go to the robot (Esc)" : "Drive";
    byId("drive-keys").hidden = !this.driving;
    document.body.dataset.driving = String(this.driving);
    const note = byId("drive-note");
    note.textContent = refusal || stream.refused || (this.driving ? stream.note : "");
    note.hidden = !note.textContent;
    note.classList.toggle("warning", Boolean(stream.refused));
  }
}
