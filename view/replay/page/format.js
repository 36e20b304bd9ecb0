// --- format: numbers, units, colours ---------------------------------------------------------------------

const UNITS = {rad: "rad", rad_per_s: "rad/s", permille: "‰", m_per_s: "m/s", m_per_s2: "m/s²", Nm: "N m",
               degC: "°C", deg: "°"};
const ANGLES = {rad: "°", rad_per_s: "°/s"};
const DEGREES = 180 / Math.PI;

const settings = {degrees: true};

function unitText(unit) { return UNITS[unit] || unit; }

// Factor and unit in which a recorded unit is shown.
function shownUnit(unit) {
  return settings.degrees && ANGLES[unit] ? {factor: DEGREES, text: ANGLES[unit]}
                                          : {factor: 1, text: unitText(unit)};
}

function formatNumber(value) {
  if (!Number.isFinite(value)) return "–";
  const magnitude = Math.abs(value);
  if (magnitude >= 1e7 || (magnitude > 0 && magnitude < 1e-5)) return value.toExponential(3).replace("-", "−");
  return String(Number(value.toPrecision(5))).replace("-", "−");
}

function valueText(signal, value) {
  if (!Number.isFinite(value)) return "–";
  if (signal.names.has(value)) return signal.names.get(value);
  const shown = shownUnit(signal.unit);
  return formatNumber(value * shown.factor) + (shown.text ? " " + shown.text : "");
}

function secondsText(time, decimals = 3) { return (1e-6 * time).toFixed(decimals) + " s"; }

function lengthText(metres) {
  return Math.abs(metres) < 0.9995 ? formatNumber(1000 * metres) + " mm" : formatNumber(metres) + " m";
}

// Steps of an axis: 1, 2 or 5 times a power of ten.
function niceStep(range, count) {
  const rough = range / Math.max(1, count);
  const power = Math.pow(10, Math.floor(Math.log10(rough)));
  for (const factor of [1, 2, 5]) if (factor * power >= rough) return factor * power;
  return 10 * power;
}

// After Okabe and Ito, with lightness for the background: distinguishable with any colour vision.
const SERIES = {
  light: ["#0072b2", "#d55e00", "#00825f", "#b2467f", "#8a6a00", "#3b9bd6", "#5b4bc4", "#555555"],
  dark: ["#56b4e9", "#f08c3c", "#2fc79a", "#e892c0", "#f0e442", "#7aa5ff", "#b7a4ff", "#c0c4cc"],
};
// The colours of marks, those of the studio and of the figures (looks.h).
const MARKS = LOOKS.colours;
const DARK_TRUE = "#e4e9f0";  // of the true ZMP, on a dark background
function markColour(name) { return name === "true" && darkQuery.matches ? DARK_TRUE : MARKS[name]; }

// The places in SERIES of the signals of a plot: the roles and sides of MARKS where there are any.
function seriesOf(names) {
  const mirrored = names.length === 2 && names[0] !== names[1] &&
      names[0].replace(/left_/, "right_") === names[1].replace(/left_/, "right_");
  const roles = {planned_: 1, true_: 7, "": 0};
  return names.map((name, i) => {
    if (mirrored) return name.includes("left_") ? 2 : 3;
    const zmp = /^(planned_|true_|)zmp_[xy]$/.exec(name);
    return zmp ? roles[zmp[1]] : i;
  });
}

// A whole turn in the unit of an angle, 0 for any other unit; and the values of a signal without the jumps of a turn at
// the ends of an angle's range.
function turnOf(unit) { return {rad: 2 * Math.PI, deg: 360}[unit] || 0; }
function unwrapped(values, unit) {
  const turn = turnOf(unit);
  if (turn === 0) return values;
  let last = NaN;
  return Float64Array.from(values, (value) => {
    if (!Number.isFinite(value)) return value;
    const continued = value + turn * Math.round((last - value) / turn);
    last = Math.abs(continued - last) < turn / 4 ? continued : value;
    return last;
  });
}

// States that mean the same look the same in every run; others get colours in their order.
const STATE_COLOURS = {
  boot: "#6b7280", limp: "#9aa1ab", enabling: "#8ecdf0", "soft start": "#56b4e9", standing: "#12a37b",
  motion: "#0072b2", walking: "#3a5fd0", fault: "#7a1022", "emergency stop": "#b00020", "low battery": "#a8963a",
  falling: "#d55e00", fallen: "#b2467f", righting: "#e69f00", rolling: "#f2c14e", rising: "#f0e442",
  steadying: "#c9d94e", "sitting down": "#8c7a1f",
};
function stateColour(name, index) {
  return STATE_COLOURS[name.replace(/_/g, " ")] || SERIES.light[index % SERIES.light.length];
}

// Black or white, whichever reads better on a colour (#rrggbb).
function inkOn(colour) {
  const [red, green, blue] = [1, 3, 5].map((i) => parseInt(colour.slice(i, i + 2), 16));
  return 0.299 * red + 0.587 * green + 0.114 * blue > 140 ? "#111" : "#fff";
}

const darkQuery = window.matchMedia("(prefers-color-scheme: dark)");
function theme() {
  const style = getComputedStyle(document.documentElement);
  const get = (name) => style.getPropertyValue(name).trim();
  return {dark: darkQuery.matches, background: get("--view"), floor: get("--floor"), line: get("--grid"),
          ink: get("--ink"), dim: get("--dim"), rule: get("--rule"), panel: get("--panel"),
          accent: get("--accent"), cursor: get("--cursor"), series: SERIES[darkQuery.matches ? "dark" : "light"]};
}

function element(tag, properties = {}, children = []) {
  const node = Object.assign(document.createElement(tag), properties);
  node.append(...children);
  return node;
}
function byId(id) { return document.getElementById(id); }

// Fits a canvas to its box; returns its context in CSS pixels.
function fittedContext(canvas) {
  const scale = window.devicePixelRatio || 1;
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  const w = Math.round(width * scale);
  const h = Math.round(height * scale);
  if (canvas.width !== w || canvas.height !== h) {
    canvas.width = w;
    canvas.height = h;
  }
  const context = canvas.getContext("2d");
  context.setTransform(scale, 0, 0, scale, 0, 0);
  context.clearRect(0, 0, width, height);
  return {context, width, height};
}

const tooltip = {
  show(text, x, y) {
    const box = byId("tooltip");
    box.textContent = text;
    box.hidden = false;
    const left = Math.min(x + 14, window.innerWidth - box.offsetWidth - 6);
    const below = y + 16 + box.offsetHeight < window.innerHeight;
    box.style.left = Math.max(4, left) + "px";
    box.style.top = (below ? y + 16 : y - box.offsetHeight - 10) + "px";
  },
  hide() { byId("tooltip").hidden = true; },
};
