// --- view: camera, light and layers -----------------------------------------------------------------------

const VIEW_HEIGHTS = 2.4;      // distance of the views of LOOKS, in heights of the robot
const FIRST_VIEW = "4";        // three-quarter
const CLEARANCE_M = 0.02;      // of the camera above the floor, as in the studio (camera_control.h)
const LOWEST_LOOK = 6 * Math.PI / 180;  // above the horizon, after a look at the robot

// The direction from which a camera of this azimuth and elevation looks, in radians; not quite from the zenith.
function direction(azimuth, elevation) {
  const above = Math.min(elevation, Math.PI / 2 - 1e-3);
  return new THREE.Vector3(Math.cos(above) * Math.cos(azimuth), Math.cos(above) * Math.sin(azimuth), Math.sin(above));
}
const GHOST_COLOUR = "#8a5cf6";

class View {
  constructor(page, onError) {
    this.page = page;
    this.canvas = byId("canvas3d");
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(35, 1, 0.02, 60);
    this.camera.up.set(0, 0, 1);
    const context = this.canvas.getContext("webgl", {antialias: true});
    if (context) {
      this.renderer = new THREE.WebGLRenderer({canvas: this.canvas, context, antialias: true});
    } else {
      onError("This browser offers no WebGL, so the robot cannot be drawn; everything else works.");
    }
    if (this.renderer) {
      this.renderer.shadowMap.enabled = true;
      this.renderer.shadowMap.type = THREE.PCFSoftShadowMap;
      this.renderer.gammaOutput = true;
      this.renderer.gammaFactor = 2.2;
    }
    this.makeLight_();
    this.robot = new Robot(page.run);
    this.scene.add(this.robot.group);
    this.ghost = page.other ? new Robot(page.other, {ghostColour: GHOST_COLOUR}) : null;
    if (this.ghost) this.scene.add(this.ghost.group);
    this.balance = new Balance(page.run, this.robot);
    this.scene.add(...this.balance.groups);
    this.floors = page.run.scene.planes.map(makeFloor);
    if (this.floors.length) this.scene.add(...this.floors);
    this.ground = makeGround(page.run);
    this.scene.add(this.ground);
    this.labels = new THREE.Group();
    this.scene.add(this.labels);

    this.controls = new THREE.OrbitControls(this.camera, this.canvas);
    this.controls.enableKeys = false;
    this.controls.screenSpacePanning = true;
    this.controls.minDistance = 0.08;
    this.controls.maxDistance = 20;
    this.controls.addEventListener("change", () => {
      this.keepAboveFloor_();
      this.request();
    });
    this.target_ = this.controls.target.clone();  // when the camera was looked at last
    this.follow = true;
    this.base_ = new THREE.Vector3();
    this.height_ = this.robotHeight_();
    this.robot.setTime(page.run.start);
    this.base_.copy(this.basePosition_());
    this.setTheme();
    this.look(FIRST_VIEW);
    this.listen_();
  }

  makeLight_() {
    this.sky_ = new THREE.HemisphereLight(0xffffff, 0x777788, 0.75);
    this.sky_.position.set(0, 0, 1);
    this.sun_ = new THREE.DirectionalLight(0xffffff, 0.8);
    this.sun_.castShadow = true;
    this.sun_.shadow.mapSize.set(1024, 1024);
    this.sun_.shadow.radius = 2.5;
    this.sun_.shadow.bias = -0.0008;
    const box = this.sun_.shadow.camera;
    box.left = box.bottom = -0.7;
    box.right = box.top = 0.7;
    box.near = 0.1;
    box.far = 4;
    this.fill_ = new THREE.DirectionalLight(0xffffff, 0.22);
    this.scene.add(this.sky_, this.sun_, this.sun_.target, this.fill_, this.fill_.target);
  }

  // Height of the robot in its first pose: how large everything is drawn.
  robotHeight_() {
    this.robot.setTime(this.page.run.start);
    const box = new THREE.Box3();
    for (const link of this.robot.links) {
      for (const mesh of link.visuals.children) {
        mesh.geometry.computeBoundingBox();
        box.union(mesh.geometry.boundingBox.clone().applyMatrix4(mesh.matrixWorld));
      }
    }
    return box.isEmpty() ? 0.4 : Math.max(0.05, box.max.z - box.min.z);
  }
  basePosition_() {
    const base = this.robot.links[0];
    return base ? new THREE.Vector3(base.position.x, base.position.y, 0) : new THREE.Vector3();
  }

  // Looks at the robot from the direction of a key of LOOKS.
  look(key) {
    const {azimuth_deg: azimuth, elevation_deg: elevation} = LOOKS.views.find((view) => view.key === key);
    const target = this.basePosition_();
    target.z = 0.5 * this.height_;
    this.viewKey = key;
    this.aim_(target, direction(azimuth * Math.PI / 180, elevation * Math.PI / 180));
  }
  // Looks at the robot, wherever it and the camera are, from about the same direction.
  lookAtRobot() {
    const box = new THREE.Box3().setFromPoints(this.robot.links.map((link) => link.position));
    const target = box.isEmpty() ? this.basePosition_() : box.getCenter(new THREE.Vector3());
    const from = this.camera.position.clone().sub(this.controls.target);
    const elevation = Math.atan2(from.z, Math.hypot(from.x, from.y));
    this.aim_(target, direction(Math.atan2(from.y, from.x), Math.max(LOWEST_LOOK, elevation)));
  }
  aim_(target, from) {
    const narrow = Math.max(1, 0.9 / this.camera.aspect);
    this.controls.target.copy(target);
    this.camera.position.copy(from).multiplyScalar(VIEW_HEIGHTS * this.height_ * narrow).add(target);
    this.target_.copy(target);
    this.controls.update();
    this.keepAboveFloor_();
    this.request();
  }

  // Keeps the camera above the floor and its target not below: a movement is lifted, a turn raised, as raise_above() and
  // lift_above() of the studio do (camera_control.cc).
  keepAboveFloor_() {
    const {target} = this.controls;
    const {position} = this.camera;
    const moves = !target.equals(this.target_);
    for (const {normal, offset} of this.page.run.scene.planes) {
      const n = new THREE.Vector3().fromArray(normal);
      const deep = Math.max(0, offset - n.dot(target), moves ? offset + CLEARANCE_M - n.dot(position) : 0) / n.z;
      target.z += deep;
      position.z += deep;
      const from = position.clone().sub(target);
      const distance = from.length();
      const azimuth = Math.atan2(from.y, from.x);
      const along = n.x * Math.cos(azimuth) + n.y * Math.sin(azimuth);
      const wanted = (offset + CLEARANCE_M - n.dot(target)) / distance / Math.hypot(along, n.z);
      const lowest = Math.atan2(n.z, along) - Math.acos(Math.min(1, Math.max(-1, wanted)));
      if (wanted <= -1 || Math.atan2(from.z, Math.hypot(from.x, from.y)) >= lowest - 1e-9) continue;
      position.copy(direction(azimuth, lowest)).multiplyScalar(distance).add(target);
      this.camera.lookAt(target);
    }
    this.target_.copy(target);
  }

  setTheme() {
    const colours = theme();
    this.scene.background = new THREE.Color(colours.background);  // shown as it is
    for (const {uniforms} of this.floors) {
      // The shader writes these as they are.
      uniforms.floorColour.value.set(colours.floor);
      uniforms.lineColour.value.set(colours.line);
      uniforms.backColour.value.set(colours.background);
    }
    this.balance.setTheme();
    this.makeMetreLabels_(colours.dim);
    this.request();
  }

  // Metres along x and y where the robot goes.
  metreRanges_() {
    return this.page.run.poses[0].position.slice(0, 2).map((values) => {
      let low = 0;
      let high = 0;
      for (const value of values) {
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
      return [Math.max(-50, Math.floor(low)), Math.min(50, Math.ceil(high + 0.5))];
    });
  }
  makeMetreLabels_(colour) {
    for (const label of this.labels.children) {
      label.material.map.dispose();
      label.material.dispose();
    }
    this.labels.remove(...this.labels.children);
    if (!this.robot.links.length) return;
    const put = (text, px, py) => {
      const label = makeLabel(text, colour, 0.035);
      label.position.set(px, py, 0.012);
      this.labels.add(label);
    };
    const ranges = this.metreRanges_();
    this.labelled_ = String(ranges);
    const [[lowX, highX], [lowY, highY]] = ranges;
    for (let i = lowX; i <= highX; ++i) put(i === 0 ? "x = y = 0" : "x = " + i + " m", i, 0);
    for (let i = lowY; i <= highY; ++i) if (i !== 0) put("y = " + i + " m", 0, i);
  }
  // Shows what follows from the whole of a run that has grown.
  grow() {
    this.balance.grow();
    if (this.robot.links.length && String(this.metreRanges_()) !== this.labelled_) this.makeMetreLabels_(theme().dim);
    this.request();
  }

  setTime(time) {
    this.robot.setTime(time);
    if (this.ghost) this.ghost.setTime(time);
    this.balance.setTime(time);
    const base = this.basePosition_();
    if (this.follow) {
      const moved = base.clone().sub(this.base_);
      this.camera.position.add(moved);
      this.controls.target.add(moved);
      this.keepAboveFloor_();
    }
    this.base_.copy(base);
    this.request();
  }

  setFollow(follow) {
    this.follow = follow;
    if (!follow) return;
    const offset = this.camera.position.clone().sub(this.controls.target);
    const base = this.basePosition_();
    this.controls.target.set(base.x, base.y, this.controls.target.z);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.request();
  }

  request() {
    if (this.pending_) return;
    this.pending_ = true;
    requestAnimationFrame(() => {
      this.pending_ = false;
      this.render();
    });
  }

  render() {
    if (!this.renderer) return;
    const width = this.canvas.parentElement.clientWidth;
    const height = this.canvas.parentElement.clientHeight;
    if (width === 0 || height === 0) return;
    if (width !== this.width_ || height !== this.height_px_ || window.devicePixelRatio !== this.ratio_) {
      this.width_ = width;
      this.height_px_ = height;
      this.ratio_ = window.devicePixelRatio;
      this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
      this.renderer.setSize(width, height, false);
      this.camera.aspect = width / height;
      this.camera.updateProjectionMatrix();
      if (!this.sized_) {
        this.sized_ = true;
        this.look(this.viewKey);
      }
    }
    const target = this.basePosition_();
    this.sun_.target.position.copy(target);
    this.sun_.position.copy(target).add(new THREE.Vector3(0.55, 0.75, 1.9));
    this.fill_.target.position.copy(target);
    this.fill_.position.copy(target).add(new THREE.Vector3(-1, -1, 0.6));
    for (const {uniforms} of this.floors) {
      uniforms.eye.value.copy(this.camera.position);
      uniforms.centre.value.copy(this.controls.target).setZ(0);
    }
    this.renderer.render(this.scene, this.camera);
  }

  listen_() {
    const rays = new THREE.Raycaster();
    const place = new THREE.Vector2();
    this.canvas.addEventListener("pointermove", (event) => {
      if (event.buttons !== 0 || event.pointerType === "touch") {
        tooltip.hide();
        return;
      }
      const box = this.canvas.getBoundingClientRect();
      place.set((event.clientX - box.left) / box.width * 2 - 1, 1 - (event.clientY - box.top) / box.height * 2);
      rays.setFromCamera(place, this.camera);
      const layers = Object.values(this.balance.layers).filter((layer) => layer.visible);
      const visible = (object) => !object || (object.visible && visible(object.parent));
      const hit = rays.intersectObjects([...layers, this.robot.group, this.ground], true)
        .filter(({object}) => object.userData.tooltip && visible(object))
        .sort((a, b) => (b.object.renderOrder - a.object.renderOrder) || (a.distance - b.distance))[0];
      if (hit) tooltip.show(hit.object.userData.tooltip(), event.clientX, event.clientY);
      else tooltip.hide();
    });
    this.canvas.addEventListener("pointerleave", () => tooltip.hide());
    new ResizeObserver(() => this.request()).observe(this.canvas.parentElement);
  }
}
