// --- data: the run in the page ---------------------------------------------------------------------------
// Format: replay_data.h, column_pack.h. Times are in microseconds, lengths in metres, forces in newtons.

const NONE = -1;

function bytesOfBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

async function unzipped(bytes) {
  if (typeof DecompressionStream === "undefined") {
    throw new Error("This browser cannot unpack gzip (DecompressionStream): use Chrome 80, Firefox 113, " +
                    "Safari 16.4 or a later one.");
  }
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Reverses ColumnPack: residuals of a prediction from the numbers before, their bytes by significance.
function decodeColumn(bytes, column) {
  const {at, count, order, planes} = column;
  const quantum = column.quantum === undefined ? 1 : column.quantum;
  const none = column.none === undefined ? Infinity : column.none;
  const values = new Float64Array(count);
  let last = 0;
  let beforeLast = 0;
  for (let i = 0; i < count; ++i) {
    let residual = 0;
    for (let plane = planes - 1; plane >= 0; --plane) residual = residual * 256 + bytes[at + plane * count + i];
    let value = residual % 2 === 0 ? residual / 2 : -(residual + 1) / 2;
    if (order === 1) value += last;
    if (order === 2) value += 2 * last - beforeLast;
    beforeLast = last;
    last = value;
    values[i] = value === none ? NaN : value * quantum;
  }
  return values;
}

// Returns the index of the last number that is not above `value`, or -1.
function indexAtOrBefore(sorted, value) {
  let low = 0;
  let high = sorted.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (sorted[middle] <= value) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

// A recorded number over time; its values are decoded when they are first needed.
class Signal {
  constructor(json, bytes) {
    this.name = json.name;
    this.unit = json.unit;
    this.names = new Map(json.names);
    this.json_ = json.values;
    this.bytes_ = bytes;
  }
  get values() {
    if (!this.values_) this.values_ = decodeColumn(this.bytes_, this.json_);
    return this.values_;
  }
  // The values as plots show them: without the jumps of an angle.
  get plotted() {
    if (this.plottedOf_ !== this.values) {
      this.plottedOf_ = this.values;
      this.plotted_ = unwrapped(this.values, this.unit);
    }
    return this.plotted_;
  }
}

// The frames on the bus. A frame belongs to a group (identifier, length); groups share what all frames have in
// common.
class Frames {
  constructor(json, network, bytes) {
    this.times = decodeColumn(bytes, json.times);
    this.groupOf = Uint16Array.from(decodeColumn(bytes, json.group));
    this.texts = json.texts;
    this.bytes_ = bytes;
    this.nodeNames = new Map(network.nodes.map((node) => [node.id, node.name]));
    this.nodes_ = network.nodes;
    this.messages_ = new Map(network.messages.map((message) => [message.identifier, message]));
    this.groups = json.groups;
    for (const group of this.groups) this.complete_(group);
  }
  // Adds the message of a group, and its sender.
  complete_(group) {
    const message = this.messages_.get(group.identifier);
    group.message = group.kind === "PDO" && !group.remote && message ? message : null;
    // Some PDOs of the controller use identifiers that belong to no node.
    const sender = group.message && this.nodes_.find((node) => node.name === message.sender);
    if (sender && !this.nodeNames.has(group.node)) group.node = sender.id;
  }
  get count() { return this.times.length; }

  // Ordinal of each frame in its group.
  get ordinals() {
    if (!this.ordinals_) {
      const next = new Uint32Array(this.groups.length);
      this.ordinals_ = Uint32Array.from(this.groupOf, (group) => next[group]++);
    }
    return this.ordinals_;
  }
  column_(group, key, json) {
    group.decoded = group.decoded || new Map();
    if (!group.decoded.has(key)) group.decoded.set(key, decodeColumn(this.bytes_, json));
    return group.decoded.get(key);
  }
  // Index of the frame's text; NONE for a PDO.
  textIndex(frame) {
    const group = this.groups[this.groupOf[frame]];
    return group.texts ? this.column_(group, "text", group.texts)[this.ordinals[frame]] : NONE;
  }
  data(frame) {
    const group = this.groups[this.groupOf[frame]];
    return group.bytes.map((json, i) => this.column_(group, i, json)[this.ordinals[frame]]);
  }
  nodeName(group) {
    return group.node === 0 ? "all" : this.nodeNames.get(group.node) || "node " + group.node;
  }
  // The content as text: values with units of a PDO, else what the frame does.
  content(frame) {
    const group = this.groups[this.groupOf[frame]];
    if (!group.message) {
      const text = this.textIndex(frame);
      return text === NONE ? "" : this.texts[text];
    }
    const data = this.data(frame);
    const readings = [];
    for (const signal of group.message.signals) {
      if (signal.start + signal.size > 8 * data.length) continue;
      const raw = rawValue(data, signal);
      const named = signal.names.find(([value]) => value === raw);
      readings.push(signal.name + " = " +
                    (named ? named[1] : formatNumber(raw * signal.factor) + (signal.unit ? " " + unitText(signal.unit) : "")));
    }
    return group.message.name + ": " + readings.join(", ");
  }
}

// Little-endian bits of a frame's data.
function rawValue(data, signal) {
  let bits = 0n;
  for (let i = data.length - 1; i >= 0; --i) bits = bits << 8n | BigInt(data[i]);
  bits >>= BigInt(signal.start);
  return Number(signal.signed ? BigInt.asIntN(signal.size, bits) : BigInt.asUintN(signal.size, bits));
}

class Run {
  constructor(json, network, bytes) {
    this.json = json;
    this.scene = json.scene;
    this.times = decodeColumn(bytes, json.times);
    this.events = json.events;
    this.pushes = json.pushes;
    this.signals = json.signals.map((signal) => new Signal(signal, bytes));
    this.signalByName = new Map(this.signals.map((signal) => [signal.name, signal]));
    this.frames = new Frames(json.frames, network, bytes);
    this.poses = json.poses.map((pose) => ({
      position: pose.position.map((column) => decodeColumn(bytes, column)),
      quaternion: pose.quaternion.map((column) => decodeColumn(bytes, column)),
    }));
    const contacts = json.contacts;
    const counts = decodeColumn(bytes, contacts.counts);
    const first = new Uint32Array(counts.length + 1);
    for (let i = 0; i < counts.length; ++i) first[i + 1] = first[i] + counts[i];
    this.contacts = {
      first,
      link: decodeColumn(bytes, contacts.link),
      otherLink: decodeColumn(bytes, contacts.other_link),
      position: contacts.position.map((column) => decodeColumn(bytes, column)),
      force: contacts.force.map((column) => decodeColumn(bytes, column)),
    };
    this.bytes = bytes;
  }
  get start() { return this.times.length ? this.times[0] : 0; }
  get end() { return this.times.length ? this.times[this.times.length - 1] : 0; }

  // Index of the sample that holds at a time.
  sampleAt(time) { return Math.max(0, indexAtOrBefore(this.times, time)); }
  // The signal's value at a sample; NaN without one.
  value(name, sample) {
    const signal = this.signalByName.get(name);
    return signal && sample < this.times.length ? signal.values[sample] : NaN;
  }
  plottedValue(name, sample) {
    const signal = this.signalByName.get(name);
    return signal && sample < this.times.length ? signal.plotted[sample] : NaN;
  }
  vector(names, sample) { return names.map((name) => this.value(name, sample)); }
  // The signal whose value names are the states of the controller.
  get stateSignal() {
    const named = this.signals.filter((signal) => signal.names.size > 0);
    return named.find((signal) => /^state/.test(signal.name)) || named[0] || null;
  }
}

// The header and the columns of replay_data.h.
function parseData(bytes) {
  const length = new DataView(bytes.buffer, bytes.byteOffset).getUint32(0, true);
  return {header: JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + length))), columns: bytes.subarray(4 + length)};
}

async function readPage() {
  const text = document.getElementById("data").textContent;
  if (text === "live") return readStream();
  const {header, columns} = parseData(await unzipped(bytesOfBase64(text)));
  document.getElementById("data").textContent = "";
  return {
    run: new Run(header.run, header.network, columns),
    other: header.other ? new Run(header.other, header.network, columns) : null,
    difference: header.first_difference || null,
  };
}
