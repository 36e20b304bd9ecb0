// --- balance: what explains the robot's balance, drawn in the world ---------------------------------------

const LOADED_N = 1;              // a foot with less load counts as unloaded (sim_board/world/foot.h)
const ARROW_M_PER_N = 0.012;     // length of force arrows
const SHORTEST_ARROW_N = 0.05;   // smaller forces are not drawn
const PUSH_M_PER_N = 0.02;
const PUSH_SHOWN_US = 250e3;     // a push shorter than this stays visible, faded
const TRAIL_US = 1e6;
const LIFT_M = 0.0004;           // of marks above the ground

const ZMP_MARKS = [
  {name: "planned ZMP", colour: "planned", signals: ["planned_zmp_x", "planned_zmp_y"]},
  {name: "measured ZMP", colour: "measured", signals: ["zmp_x", "zmp_y"]},
  {name: "true ZMP", colour: "true", signals: ["true_zmp_x", "true_zmp_y"]},
];

// Convex hull of points {x, y}, counter-clockwise (Andrew's monotone chain).
function convexHull(points) {
  const sorted = points.slice().sort((a, b) => a.x - b.x || a.y - b.y);
  const turn = (o, a, b) => (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
  const half = (list) => {
    const chain = [];
    for (const p of list) {
      while (chain.length > 1 && turn(chain[chain.length - 2], chain[chain.length - 1], p) <= 1e-12) chain.pop();
      chain.push(p);
    }
    chain.pop();
    return chain;
  };
  return sorted.length < 3 ? sorted : half(sorted).concat(half(sorted.reverse()));
}

// Intervals of samples in which each sole bears load. Gaps below 30 ms and contacts below 60 ms are bounces.
function supportPhases(run) {
  const {first, link, otherLink, force} = run.contacts;
  return run.scene.soles.map((sole) => {
    const phases = [];
    let begin = -1;
    const loaded = (i) => {
      let load = 0;
      for (let c = first[i]; c < first[i + 1]; ++c) {
        if (link[c] === sole.link && otherLink[c] === NONE) load += force[2][c];
      }
      return load >= LOADED_N;
    };
    for (let i = 0; i < run.times.length; ++i) {
      const bears = sole.link >= 0 && sole.corners.length > 2 && loaded(i);
      if (bears && begin < 0) {
        const last = phases[phases.length - 1];
        if (last && run.times[i] - run.times[last.end] < 30e3) begin = phases.pop().begin;
        else begin = i;
      }
      if (begin >= 0 && (!bears || i === run.times.length - 1)) {
        phases.push({begin, end: Math.max(begin, bears ? i : i - 1)});
        begin = -1;
      }
    }
    return phases.filter((phase) => run.times[phase.end] - run.times[phase.begin] >= 60e3);
  });
}

// Outlines of the soles where they landed, in order of time.
class Footprints {
  constructor(run, group = new THREE.Group()) {
    this.run = run;
    this.group = group;
    const phases = supportPhases(run);
    this.sides = run.scene.soles.map((sole, side) => this.side_(sole, phases[side], MARKS[["left", "right"][side % 2]]));
  }
  side_(sole, phases, colour) {
    const corners = sole.corners.length;
    const lines = [];
    const areas = [];
    const pose = new THREE.Matrix4();
    const one = new THREE.Vector3(1, 1, 1);
    for (const phase of phases) {
      // The sole lies still soon after the touchdown.
      const settled = this.run.sampleAt(this.run.times[phase.begin] + 60e3);
      const {position, quaternion} = this.run.poses[sole.link];
      pose.compose(new THREE.Vector3(...position.map((p) => p[settled])),
                   new THREE.Quaternion(...quaternion.map((q) => q[settled])).normalize(), one);
      const points = sole.corners.map((corner) => new THREE.Vector3().fromArray(corner).applyMatrix4(pose));
      for (let i = 0; i < corners; ++i) {
        const next = points[(i + 1) % corners];
        lines.push(points[i].x, points[i].y, points[i].z + LIFT_M, next.x, next.y, next.z + LIFT_M);
        if (i < 2) continue;
        for (const p of [points[0], points[i - 1], points[i]]) areas.push(p.x, p.y, p.z + LIFT_M);
      }
    }
    const geometryOf = (numbers) => new THREE.BufferGeometry().setAttribute(
        "position", new THREE.Float32BufferAttribute(numbers, 3));
    const outline = new THREE.LineSegments(geometryOf(lines), new THREE.LineBasicMaterial(
        {color: linearColour(colour), transparent: true, opacity: 0.85}));
    const area = new THREE.Mesh(geometryOf(areas), new THREE.MeshBasicMaterial(
        {color: linearColour(colour), transparent: true, opacity: 0.13, side: THREE.DoubleSide, depthWrite: false}));
    outline.frustumCulled = area.frustumCulled = false;
    area.renderOrder = -1;
    this.group.add(outline, area);
    return {times: phases.map((phase) => this.run.times[phase.begin]), corners, outline, area};
  }
  setTime(time) {
    this.landed = 0;
    for (const side of this.sides) {
      const count = indexAtOrBefore(side.times, time) + 1;
      side.outline.geometry.setDrawRange(0, 2 * side.corners * count);
      side.area.geometry.setDrawRange(0, 3 * Math.max(0, side.corners - 2) * count);
      this.landed += count;
    }
  }
}

// A line whose points change.
class MovingLine {
  constructor(capacity, material, loop = false) {
    this.positions = new Float32Array(3 * capacity);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(this.positions, 3));
    this.object = loop ? new THREE.LineLoop(geometry, material) : new THREE.Line(geometry, material);
    this.object.frustumCulled = false;
  }
  set(points) {
    const count = Math.min(points.length, this.positions.length / 3);
    for (let i = 0; i < count; ++i) points[i].toArray(this.positions, 3 * i);
    this.object.geometry.attributes.position.needsUpdate = true;
    this.object.geometry.setDrawRange(0, count);
    this.object.visible = count > 1;
  }
}

class Arrow {
  constructor(colour, radius) {
    this.group = new THREE.Group();
    this.material = new THREE.MeshBasicMaterial({color: linearColour(colour), transparent: true});
    this.radius_ = radius;
    this.shaft_ = new THREE.Mesh(new THREE.CylinderBufferGeometry(1, 1, 1, 12).translate(0, 0.5, 0), this.material);
    this.head_ = new THREE.Mesh(new THREE.ConeBufferGeometry(1, 1, 16).translate(0, 0.5, 0), this.material);
    this.group.add(this.shaft_, this.head_);
    this.group.visible = false;
    this.text = "";
    for (const mesh of [this.shaft_, this.head_]) mesh.userData.tooltip = () => this.text;
  }
  // An arrow from `start` along a vector.
  set(start, vector) {
    const length = vector.length();
    this.group.visible = length > 0;
    if (!this.group.visible) return;
    const head = Math.min(0.45 * length, 5 * this.radius_);
    this.group.position.copy(start);
    this.group.quaternion.setFromUnitVectors(Arrow.up_, vector.clone().normalize());
    this.shaft_.scale.set(this.radius_, Math.max(1e-6, length - head), this.radius_);
    this.head_.scale.set(2.6 * this.radius_, head, 2.6 * this.radius_);
    this.head_.position.y = length - head;
  }
  hide() { this.group.visible = false; }
}
Arrow.up_ = new THREE.Vector3(0, 1, 0);

// Marks of a point on the ground: ring, cross and disc.
function zmpMark(index, colour) {
  const material = new THREE.MeshBasicMaterial(
      {color: linearColour(colour), side: THREE.DoubleSide, transparent: true, depthTest: false});
  const group = new THREE.Group();
  if (index === 0) {
    group.add(new THREE.Mesh(new THREE.RingBufferGeometry(0.0068, 0.0088, 40), material));
  } else if (index === 1) {
    for (const angle of [Math.PI / 4, -Math.PI / 4]) {
      const bar = new THREE.Mesh(new THREE.PlaneBufferGeometry(0.017, 0.0026), material);
      bar.rotation.z = angle;
      group.add(bar);
    }
  } else {
    group.add(new THREE.Mesh(new THREE.CircleBufferGeometry(0.0042, 32), material));
  }
  group.traverse((object) => { object.renderOrder = 6; });
  group.material = material;
  return group;
}

class Balance {
  constructor(run, robot) {
    this.run = run;
    this.robot = robot;
    this.layers = {polygon: new THREE.Group(), zmp: new THREE.Group(), com: new THREE.Group(),
                   contacts: new THREE.Group(), pushes: new THREE.Group()};
    this.footprints = new Footprints(run);
    this.layers.footprints = this.footprints.group;
    this.makePolygon_();
    this.makeZmp_();
    this.makeCom_();
    this.contactArrows_ = [];
    this.pushArrows_ = [];
    this.now = {};
  }
  // Footprints of a run that has grown.
  grow() {
    const {group} = this.footprints;
    for (const old of group.children) {
      old.geometry.dispose();
      old.material.dispose();
    }
    group.remove(...group.children);
    this.footprints = new Footprints(this.run, group);
    this.footprints.setTime(this.time_);
  }
  get groups() { return Object.values(this.layers); }

  makePolygon_() {
    const colour = linearColour(MARKS.support);
    this.polygonEdge_ = new MovingLine(64, new THREE.LineBasicMaterial({color: colour, transparent: true}), true);
    this.polygonArea_ = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshBasicMaterial(
        {color: colour, transparent: true, opacity: 0.22, side: THREE.DoubleSide, depthWrite: false}));
    this.polygonArea_.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(9 * 64), 3));
    this.polygonArea_.frustumCulled = false;
    this.layers.polygon.add(this.polygonEdge_.object, this.polygonArea_);
  }
  makeZmp_() {
    this.zmp_ = ZMP_MARKS.filter((mark) => mark.signals.every((name) => this.run.signalByName.has(name)))
      .map((mark) => {
        const index = ZMP_MARKS.indexOf(mark);
        const colour = markColour(mark.colour);
        const object = zmpMark(index, colour);
        const trail = new MovingLine(256, new THREE.LineBasicMaterial(
            {color: linearColour(colour), transparent: true, opacity: 0.7, depthTest: false}));
        trail.object.renderOrder = 5;
        this.layers.zmp.add(object, trail.object);
        object.traverse((part) => { part.userData.tooltip = () => this.zmpText_(mark); });
        return {mark, object, trail};
      });
  }
  setTheme() {
    for (const {mark, object, trail} of this.zmp_) {
      for (const material of [object.material, trail.object.material]) material.color = linearColour(markColour(mark.colour));
    }
  }
  makeCom_() {
    const colour = linearColour(MARKS.com);
    this.com_ = new THREE.Mesh(new THREE.SphereBufferGeometry(0.0085, 24, 16), new THREE.MeshBasicMaterial(
        {color: colour, depthTest: false, transparent: true, opacity: 0.95}));
    this.comFoot_ = new THREE.Mesh(new THREE.CircleBufferGeometry(0.0065, 24), new THREE.MeshBasicMaterial(
        {color: colour, depthTest: false, transparent: true, opacity: 0.95}));
    this.comLine_ = new MovingLine(2, new THREE.LineBasicMaterial(
        {color: colour, transparent: true, opacity: 0.8, depthTest: false}));
    this.comLine_.object.renderOrder = 4;
    this.com_.renderOrder = this.comFoot_.renderOrder = 5;
    this.com_.userData.tooltip = () => "centre of mass, " +
        this.now.com.toArray().map((x, i) => "xyz"[i] + " " + lengthText(x)).join(", ");
    this.layers.com.add(this.com_, this.comFoot_, this.comLine_.object);
  }
  zmpText_(mark) {
    const [x, y] = this.run.vector(mark.signals, this.now.sample);
    return `${mark.name}, x ${lengthText(x)}, y ${lengthText(y)}`;
  }

  setTime(time) {
    const {run} = this;
    this.time_ = time;
    const sample = run.sampleAt(time);
    const com = run.vector(["true_com_x", "true_com_y", "true_com_z"], sample);
    this.now = {sample, com: new THREE.Vector3(...com), comKnown: com.every(Number.isFinite)};
    if (run.times.length === 0) return;
    this.footprints.setTime(time);
    const ground = this.setContacts_(sample);
    this.setPolygon_(sample);
    this.setZmp_(time, sample, ground);
    this.setCom_(ground);
    this.setPushes_(time);
  }

  // Returns the height of the ground under the robot.
  setContacts_(sample) {
    const {first, link, otherLink, position, force} = this.run.contacts;
    let used = 0;
    let heights = 0;
    let grounded = 0;
    for (let c = first[sample]; c < first[sample + 1]; ++c) {
      const f = new THREE.Vector3(force[0][c], force[1][c], force[2][c]);
      const p = new THREE.Vector3(position[0][c], position[1][c], position[2][c]);
      if (otherLink[c] === NONE) {
        heights += p.z;
        ++grounded;
      }
      if (f.length() < SHORTEST_ARROW_N) continue;
      if (used === this.contactArrows_.length) {
        const arrow = new Arrow(MARKS.contact, 0.0016);
        this.layers.contacts.add(arrow.group);
        this.contactArrows_.push(arrow);
      }
      const arrow = this.contactArrows_[used++];
      const links = this.run.scene.links;
      arrow.text = `${formatNumber(f.length())} N on ${links[link[c]] ? links[link[c]].name : "the robot"}` +
                   (otherLink[c] === NONE ? " from the ground" : ` from ${links[otherLink[c]].name}`);
      arrow.set(p, f.multiplyScalar(ARROW_M_PER_N));
    }
    this.now.contacts = used;
    for (const arrow of this.contactArrows_.slice(used)) arrow.hide();
    return grounded ? heights / grounded : 0;
  }
  setPolygon_(sample) {
    const {first, otherLink, position, force} = this.run.contacts;
    const points = [];
    for (let c = first[sample]; c < first[sample + 1]; ++c) {
      if (otherLink[c] !== NONE || force[2][c] <= 0) continue;
      points.push(new THREE.Vector3(position[0][c], position[1][c], position[2][c] + 2 * LIFT_M));
    }
    const hull = convexHull(points);
    this.now.supportCorners = hull.length;
    this.polygonEdge_.set(hull);
    const corners = this.polygonArea_.geometry.attributes.position;
    const triangles = Math.max(0, Math.min(hull.length - 2, 62));
    for (let i = 0; i < triangles; ++i) {
      [hull[0], hull[i + 1], hull[i + 2]].forEach((p, k) => p.toArray(corners.array, 9 * i + 3 * k));
    }
    corners.needsUpdate = true;
    this.polygonArea_.geometry.setDrawRange(0, 3 * triangles);
  }
  setZmp_(time, sample, ground) {
    const {run} = this;
    const begin = run.sampleAt(time - TRAIL_US);
    for (const {mark, object, trail} of this.zmp_) {
      const [x, y] = run.vector(mark.signals, sample);
      object.visible = Number.isFinite(x) && Number.isFinite(y);
      if (object.visible) object.position.set(x, y, ground + 3 * LIFT_M);
      const points = [];
      for (let i = begin; i <= sample; ++i) {
        const [px, py] = run.vector(mark.signals, i);
        if (Number.isFinite(px) && Number.isFinite(py)) points.push(new THREE.Vector3(px, py, ground + 3 * LIFT_M));
      }
      trail.set(points);
    }
  }
  setCom_(ground) {
    this.layers.com.children.forEach((child) => { child.visible = this.now.comKnown; });
    if (!this.now.comKnown) return;
    this.com_.position.copy(this.now.com);
    this.comFoot_.position.set(this.now.com.x, this.now.com.y, ground + 3 * LIFT_M);
    this.comLine_.set([this.com_.position, this.comFoot_.position]);
  }
  setPushes_(time) {
    this.now.pushes = 0;
    this.run.pushes.forEach((push, i) => {
      if (i === this.pushArrows_.length) {
        this.pushArrows_.push(new Arrow(MARKS.push, 0.0042));
        this.layers.pushes.add(this.pushArrows_[i].group);
      }
      const arrow = this.pushArrows_[i];
      const end = Math.max(push.end, push.start + PUSH_SHOWN_US);
      if (time < push.start || time > end || !this.robot.links[push.link]) {
        arrow.hide();
        return;
      }
      const link = this.robot.links[push.link];
      const tip = link.localToWorld(new THREE.Vector3().fromArray(push.position));
      const force = new THREE.Vector3().fromArray(push.force);
      const vector = force.clone().multiplyScalar(PUSH_M_PER_N);
      if (vector.length() > 0.3) vector.setLength(0.3);
      arrow.material.opacity = time <= push.end ? 1 : 0.45;
      arrow.text = `push of ${formatNumber(force.length())} N on ${link.name}, ` +
                   `${secondsText(push.start)} to ${secondsText(push.end)}`;
      arrow.set(tip.sub(vector), vector);  // the point of the arrow is where the force acts
      ++this.now.pushes;
    });
  }
}
