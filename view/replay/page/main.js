// --- main: one cursor for everything ----------------------------------------------------------------------

const PLOT_GROWTH_MS = 40;    // between drawings of the plots of a live run
const FRAME_MS = 17;
const MAX_REST_MS = 2000;     // between drawings
const SLOW_GROWTH_MS = 200;   // between updates of time line, footprints and lists

const PHONE = window.matchMedia("(max-width: 760px), (max-height: 500px) and (orientation: landscape)");  // style.css

class Page {
  constructor({run, other, difference, stream = null}) {
    Object.assign(this, {run, other, difference});
    this.end = Math.max(run.end, other ? other.end : 0);
    this.time = run.start;
    this.playing = false;
    const pick = (time) => this.setTime(time);
    this.view = new View(this, (text) => this.fail(text));
    this.plots = new Plots(this, pick, () => this.plotsChanged_());
    this.timeline = new Timeline(this, this.plots, pick);
    this.events = new EventList(run, pick);
    this.can = new CanTable(run, pick);
    this.signalList = new SignalList(run, this.plots);
    this.parts = [this.view, this.plots, this.timeline, this.events, this.can, this.signalList];
    this.describe_();
    this.makeLayers_();
    this.makeViews_();
    this.listen_();
    this.showTab(PHONE.matches ? "plots" : "events");
    this.following = false;  // a live run's newest moment
    this.setTime(this.timeOfAddress_());
    if (stream) this.followRun_(stream);
  }

  // --- a run that grows ---
  followRun_(stream) {
    this.panel = new LivePanel(this, stream);
    this.goLive();
    let drawn = -Infinity;   // times of the last drawing of plots, and of the rest
    let grown = -Infinity;
    let pending = false;
    let asked = 0;   // time of the request for the next drawing
    let rest = 0;    // pause before it
    const show = (now) => {
      pending = false;
      this.run.refresh();
      this.end = this.run.end;
      if (now - grown >= SLOW_GROWTH_MS) {
        grown = now;
        for (const part of [this.view, this.timeline]) part.grow();
        this.events.grow(this.time);
        this.can.grow(this.run.cuts);
        this.panel.show();
      }
      if (now - drawn >= PLOT_GROWTH_MS) {
        drawn = now;
        this.plots.grow(this.following);
      }
      if (this.following) this.show_(this.end);
      else if (this.time < this.run.start) this.show_(this.run.start);
      // A browser that draws too slowly, as without a graphics processor, rests as long as it draws.
      const busy = performance.now() - asked;
      rest = busy > 2 * FRAME_MS ? Math.min(busy, MAX_REST_MS) : 0;
    };
    stream.onGrowth = () => {
      if (pending) return;
      pending = true;
      setTimeout(() => {
        asked = performance.now();
        requestAnimationFrame(show);
      }, rest);
    };
    stream.onFailure = (error) => this.fail("The stream cannot be read: " + error.message);
    // The last message may come while the slow parts rest.
    stream.onEnd = () => setTimeout(stream.onGrowth, 2 * SLOW_GROWTH_MS);
  }
  goLive() {
    if (!this.panel) return this.setTime(this.end);
    this.playing = false;
    this.following = true;
    this.show_(this.end);
    this.showPlaying_();
    this.panel.show();
  }

  fail(text) {
    const box = byId("failure");
    box.textContent = text;
    box.hidden = false;
  }

  describe_() {
    const facts = (run) => [["robot", run.scene.robot], ["seed", run.json.seed], ["stepper", run.json.stepper],
                            ["version", run.json.version], ["duration", run.live ? "" : secondsText(run.end, 2)]];
    const show = (list, pairs) => list.replaceChildren(...pairs.filter(([, value]) => value).flatMap(([name, value]) =>
      [element("dt", {textContent: name}), element("dd", {textContent: value})]));
    show(byId("facts"), facts(this.run).slice(1, 4));
    show(byId("about-facts"), [
      ...facts(this.run), ["signals", String(this.run.signals.length)],
      ...(this.run.live ? [] : [
        ["recording", this.run.json.complete ? "complete" : "interrupted: read up to its last whole block"],
        ["ticks", String(this.run.times.length)], ["frames", String(this.run.frames.count)]]),
      ...(this.other ? facts(this.other).map(([name, value]) => ["second run, " + name, value]) : [])]);
    byId("scenario").textContent = this.run.json.scenario;
    if (!this.run.json.complete) byId("facts").append(element("dd", {className: "warning", textContent: "interrupted"}));
    if (!this.other) return;
    const badge = byId("difference");
    badge.hidden = false;
    if (this.difference) {
      badge.textContent = "≠ first difference at " + secondsText(this.difference.time);
      badge.title = this.difference.text;
      badge.addEventListener("click", () => this.showDifference());
    } else {
      badge.textContent = "= both runs are the same";
      badge.disabled = true;
    }
  }

  // The layers of the view: name, key of the setting, what shows or hides it.
  makeLayers_() {
    const {robot, balance, ghost} = this.view;
    const layer = (name) => (on) => { balance.layers[name].visible = on; };
    this.layers = new Map();
    const add = (key, text, mark, colour, on, set) => {
      const box = element("input", {type: "checkbox", checked: on});
      const sign = element("i", {textContent: mark});
      sign.style.color = colour;
      const label = element("label", {}, [box, sign, text]);
      const apply = () => {
        set(box.checked);
        this.view.request();
      };
      box.addEventListener("change", apply);
      this.layers.set(key, {box, apply});
      byId("layer-list").append(label);
      set(on);
    };
    add("robot", "robot", "▣", "", true, (on) => { robot.group.visible = on; });
    add("boxes", "collision boxes", "□", "", false, (on) => {
      robot.setBoxes(on);
      if (ghost) ghost.setBoxes(on);
    });
    add("translucent", "translucent", "◫", "", false, (on) => robot.setTranslucent(on));
    if (ghost) add("ghost", "second run", "▣", GHOST_COLOUR, true, (on) => { ghost.group.visible = on; });
    const parts = (marks) => byId("layer-list").lastElementChild.append(...marks.map(([mark, name]) => {
      const part = element("span", {textContent: mark + " " + name});
      part.style.color = name === "true" ? "" : MARKS[name];  // the true ZMP is as dark or light as texts
      return part;
    }));
    add("footprints", "footprints:", "", "", true, layer("footprints"));
    parts([["▭", "left"], ["▭", "right"]]);
    add("polygon", "support polygon", "⬠", MARKS.support, true, layer("polygon"));
    add("zmp", "ZMP:", "", "", true, layer("zmp"));
    parts([["○", "planned"], ["✕", "measured"], ["●", "true"]]);
    add("com", "centre of mass", "●", MARKS.com, true, layer("com"));
    add("contacts", "contact forces, 12 mm/N", "↑", MARKS.contact, true, layer("contacts"));
    add("pushes", "pushes, 20 mm/N", "→", MARKS.push, true, layer("pushes"));
    if (PHONE.matches) byId("layers").open = false;
  }
  // Buttons and keys of the directions to look from.
  makeViews_() {
    byId("follow").before(...LOOKS.views.map(({key, name}) => {
      const button = element("button", {textContent: name, title: `View: ${name} (${key})`});
      button.addEventListener("click", () => this.view.look(key));
      return button;
    }));
    byId("view-names").textContent = "views: " + LOOKS.views.map((view) => view.name).join(", ");
  }
  toggleLayer(key) {
    const {box, apply} = this.layers.get(key);
    box.checked = !box.checked;
    apply();
  }

  // --- time ---
  setTime(time) {
    if (this.following) {
      this.following = false;
      this.showPlaying_();
      this.panel.show();
    }
    this.show_(time);
  }
  show_(time) {
    this.time = Math.min(this.end, Math.max(this.run.start, time));
    for (const part of this.parts) part.setTime(this.time);
    byId("time").textContent = secondsText(this.time);
    byId("state").textContent = this.timeline.stateAt(this.time);
    byId("hud").textContent = secondsText(this.time);
  }
  step(ticks) {
    this.pause();
    const {times} = this.run;
    const at = indexAtOrBefore(times, this.time);
    // Between two ticks a step back leads to the one before.
    const next = ticks < 0 && times[at] < this.time ? at + ticks + 1 : at + ticks;
    this.setTime(times[Math.min(times.length - 1, Math.max(0, next))]);
  }
  jump(by) { this.setTime(this.time + by); }
  jumpToEvent(direction) {
    const times = this.run.events.map((event) => event.time);
    const next = direction > 0 ? times.find((time) => time > this.time)
                               : times.filter((time) => time < this.time).pop();
    if (next !== undefined) this.setTime(next);
  }
  showDifference() {
    if (!this.difference) return;
    this.pause();
    this.setTime(this.difference.time);
    this.plots.showTwoSeconds();
    this.announce_(this.difference.text);
  }
  announce_(text) {
    const box = byId("difference").getBoundingClientRect();
    tooltip.show(text, box.left, box.bottom - 14);
    setTimeout(() => tooltip.hide(), 6000);
  }
  get speed() { return Number(byId("speed").value); }
  play() {
    if (this.playing) return;
    if (this.panel && this.time >= this.end) return this.goLive();
    if (this.time >= this.end) this.setTime(this.run.start);
    this.playing = true;
    this.showPlaying_();
    let last = performance.now();
    const frame = (now) => {
      if (!this.playing) return;
      this.setTime(this.time + Math.max(0, now - last) * 1e3 * this.speed);
      last = now;
      if (this.time >= this.end && this.panel) this.goLive();
      else if (this.time >= this.end) this.pause();
      else requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }
  pause() {
    this.playing = false;
    if (this.following) this.setTime(this.time);
    this.showPlaying_();
  }
  togglePlay() { this.playing || this.following ? this.pause() : this.play(); }
  showPlaying_() {
    const moves = this.playing || this.following;
    byId("play").querySelector("path").setAttribute("d", moves ? "M3 2h3v12H3zM10 2h3v12h-3z" : "M4 2l10 6-10 6z");
    byId("play").setAttribute("aria-label", moves ? "Pause" : "Play");
  }
  changeSpeed(by) {
    const select = byId("speed");
    select.selectedIndex = Math.min(select.length - 1, Math.max(0, select.selectedIndex + by));
  }
  // #t=3.21
  timeOfAddress_() {
    const match = /[#&]t=([0-9.]+)/.exec(window.location.hash);
    return match ? 1e6 * Number(match[1]) : this.run.start;
  }

  // --- panels ---
  showTab(name) {
    document.body.dataset.tab = name;
    for (const tab of document.querySelectorAll("[role=tab]")) {
      const selected = tab.dataset.tab === name;
      tab.setAttribute("aria-selected", String(selected));
      tab.tabIndex = selected ? 0 : -1;
    }
    for (const part of [this.events, this.can, this.signalList]) part.setTime(this.time);
    this.plots.draw();
  }
  plotsChanged_() {
    if (this.signalList) this.signalList.showPlotted();
    if (this.timeline) this.timeline.draw();
  }
  toggleFollow() {
    this.view.setFollow(!this.view.follow);
    byId("follow").setAttribute("aria-pressed", String(this.view.follow));
  }
  toggleDegrees() {
    settings.degrees = !settings.degrees;
    byId("degrees").setAttribute("aria-pressed", String(settings.degrees));
    this.plots.draw();
    this.show_(this.time);
  }
  showHelp() {
    if (byId("help").open) byId("help").close();
    else byId("help").showModal();
  }

  // --- input ---
  listen_() {
    // A closed dialog may keep the focus on its button, which would then take the space bar from the player.
    byId("help").addEventListener("close", () => document.activeElement.blur());
    const click = (id, action) => byId(id).addEventListener("click", action);
    click("play", () => this.togglePlay());
    click("step-back", () => this.step(-1));
    click("step-on", () => this.step(1));
    click("to-start", () => this.setTime(this.run.start));
    click("to-end", () => this.goLive());
    click("follow", () => this.toggleFollow());
    click("look", () => this.view.lookAtRobot());
    click("degrees", () => this.toggleDegrees());
    click("help-button", () => this.showHelp());
    const tabs = [...document.querySelectorAll("[role=tab]")];
    for (const tab of tabs) tab.addEventListener("click", () => this.showTab(tab.dataset.tab));
    byId("tabs").addEventListener("keydown", (event) => {
      const by = {ArrowLeft: -1, ArrowRight: 1}[event.key];
      if (!by) return;
      const seen = tabs.filter((tab) => tab.offsetWidth > 0);
      const next = seen[(seen.indexOf(document.activeElement) + by + seen.length) % seen.length];
      next.focus();
      this.showTab(next.dataset.tab);
      event.preventDefault();
      event.stopPropagation();
    });
    document.addEventListener("keydown", (event) => this.onKey_(event));
    window.addEventListener("hashchange", () => this.setTime(this.timeOfAddress_()));
    darkQuery.addEventListener("change", () => {
      this.view.setTheme();
      this.plots.setTheme();
      this.timeline.draw();
    });
    PHONE.addEventListener("change", () => {
      if (!PHONE.matches && document.body.dataset.tab === "plots") this.showTab("events");
    });
    listenToSplit(byId("split-x"), "--split-x", byId("main"), (event, box) => (event.clientX - box.left) / box.width);
    listenToSplit(byId("split-y"), "--split-y", byId("side"), (event, box) => (event.clientY - box.top) / box.height);
  }
  onKey_(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (byId("help").open && event.key !== "?") return;
    const target = event.target;
    const types = target instanceof HTMLInputElement && target.type !== "checkbox";
    if (types || target instanceof HTMLSelectElement) {
      if (event.key !== "Escape") return;
      // Browsers empty a search field without saying so to its listeners.
      if (target.type === "search" && target.value) {
        target.value = "";
        target.dispatchEvent(new Event("input", {bubbles: true}));
      }
      target.blur();
      event.preventDefault();
      return;
    }
    if (this.panel && this.panel.takes(event)) return;
    if (target.getAttribute && target.getAttribute("role") === "separator") return;
    const onButton = target instanceof HTMLButtonElement || target instanceof HTMLInputElement || target.tagName === "SUMMARY";
    if (onButton && event.key === " ") return;  // presses the button
    const {keys: shared} = LOOKS;  // with the studio
    const keys = {
      [shared.play]: () => this.togglePlay(),
      [shared.tick]: () => this.step(1),
      [shared.tick_back]: () => this.step(-1),
      [shared.begin]: () => this.setTime(this.run.start),
      [shared.end]: () => this.goLive(),
      [shared.look]: () => this.view.lookAtRobot(),
      [shared.follow]: () => this.toggleFollow(),
      ...Object.fromEntries(LOOKS.views.map(({key}) => [key, () => this.view.look(key)])),
      ArrowLeft: () => (event.shiftKey ? this.jump(-1e6) : this.step(-1)),
      ArrowRight: () => (event.shiftKey ? this.jump(1e6) : this.step(1)),
      "<": () => this.changeSpeed(-1),
      ">": () => this.changeSpeed(1),
      n: () => this.jumpToEvent(1),
      p: () => this.jumpToEvent(-1),
      b: () => this.toggleLayer("boxes"),
      t: () => this.toggleLayer("translucent"),
      w: () => this.plots.setRange(this.plots.whole.from, this.plots.whole.to),
      z: () => this.plots.showTwoSeconds(),
      d: () => this.showDifference(),
      "?": () => this.showHelp(),
    };
    const action = keys[event.key] || keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action) return;
    action();
    event.preventDefault();
  }
}

// A bar that divides two panels: its position is a share of the box, in a variable of the style.
function listenToSplit(bar, variable, container, shareOf) {
  const root = document.documentElement;
  const low = Number(bar.getAttribute("aria-valuemin"));
  const high = Number(bar.getAttribute("aria-valuemax"));
  const set = (percent) => {
    const value = Math.min(high, Math.max(low, percent));
    root.style.setProperty(variable, value + "%");
    bar.setAttribute("aria-valuenow", value.toFixed(0));
  };
  const now = () => parseFloat(getComputedStyle(root).getPropertyValue(variable));
  set(now());
  bar.addEventListener("pointerdown", (event) => {
    bar.setPointerCapture(event.pointerId);
    const move = (moved) => set(100 * shareOf(moved, container.getBoundingClientRect()));
    bar.addEventListener("pointermove", move);
    bar.addEventListener("pointerup", () => bar.removeEventListener("pointermove", move), {once: true});
    event.preventDefault();
  });
  bar.addEventListener("keydown", (event) => {
    const by = {ArrowLeft: -2, ArrowUp: -2, ArrowRight: 2, ArrowDown: 2}[event.key];
    if (!by) return;
    set(now() + by);
    event.preventDefault();
  });
}

readPage().then((data) => {
  const page = new Page(data);
  // What tests and the console may use.
  window.koboshi = page;
  page.view.render();
  page.readyMs = performance.now();
  document.body.dataset.ready = "true";
}).catch((error) => {
  const box = byId("failure");
  box.textContent = "The run cannot be shown: " + error.message;
  box.hidden = false;
  throw error;
});
