// --- scene: robot and ground as three.js objects ---------------------------------------------------------

const CREASE = Math.cos(35 * Math.PI / 180);  // sharper edges are shaded as edges
const MAX_EDGE_TRIANGLES = 6000;              // outlines of finer meshes would be a black mass

function linearColour(text) { return new THREE.Color(text).convertSRGBToLinear(); }

// Triangles with one normal per corner, averaged over the adjacent triangles that meet it smoothly.
function meshGeometry(mesh, bytes) {
  const [x, y, z] = mesh.vertices.map((column) => decodeColumn(bytes, column));
  const corners = mesh.triangles.map((column) => decodeColumn(bytes, column));
  const count = corners[0].length;
  const positions = new Float32Array(9 * count);
  const normals = new Float32Array(9 * count);
  const faces = new Float32Array(3 * count);  // twice the area times the unit normal
  // Vertices at the same place count as one, as in a mesh from triangles.
  const places = new Map();
  const place = new Uint32Array(x.length);
  for (let i = 0; i < x.length; ++i) {
    const key = x[i] + "," + y[i] + "," + z[i];
    if (!places.has(key)) places.set(key, places.size);
    place[i] = places.get(key);
  }
  const adjacent = Array.from({length: places.size}, () => []);
  const a = new THREE.Vector3();
  const b = new THREE.Vector3();
  for (let i = 0; i < count; ++i) {
    for (let k = 0; k < 3; ++k) {
      const v = corners[k][i];
      positions.set([x[v], y[v], z[v]], 9 * i + 3 * k);
      adjacent[place[v]].push(i);
    }
    const p = positions.subarray(9 * i, 9 * i + 9);
    a.set(p[3] - p[0], p[4] - p[1], p[5] - p[2]);
    b.set(p[6] - p[0], p[7] - p[1], p[8] - p[2]);
    a.cross(b).toArray(faces, 3 * i);
  }
  const face = new THREE.Vector3();
  const other = new THREE.Vector3();
  const sum = new THREE.Vector3();
  for (let i = 0; i < count; ++i) {
    face.fromArray(faces, 3 * i);
    const size = face.length();
    for (let k = 0; k < 3; ++k) {
      sum.set(0, 0, 0);
      for (const j of adjacent[place[corners[k][i]]]) {
        other.fromArray(faces, 3 * j);
        if (other.dot(face) >= CREASE * size * other.length()) sum.add(other);
      }
      sum.normalize().toArray(normals, 9 * i + 3 * k);
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
  geometry.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
  return geometry;
}

// Equal meshes have the same columns and share a geometry.
const meshGeometries = new Map();
function shapeGeometry(shape, bytes) {
  if (shape.box) return new THREE.BoxBufferGeometry(...shape.box);
  const key = shape.mesh.vertices[0].at + "," + shape.mesh.triangles[0].at;
  if (!meshGeometries.has(key)) meshGeometries.set(key, meshGeometry(shape.mesh, bytes));
  return meshGeometries.get(key);
}

// Adds the sharp edges of a mesh as lines.
function addEdges(mesh, material) {
  if (mesh.geometry.attributes.position.count > 3 * MAX_EDGE_TRIANGLES) return;
  const {geometry} = mesh;
  geometry.userData = geometry.userData || {};
  geometry.userData.edges = geometry.userData.edges || new THREE.EdgesGeometry(geometry, 35);
  const {edges} = geometry.userData;
  if (edges.attributes.position.count) mesh.add(new THREE.LineSegments(edges, material));
}

function place(object, shape) {
  object.position.fromArray(shape.position);
  object.quaternion.fromArray(shape.quaternion);
  return object;
}

// The robot of a run: a group per link, with its visuals and its collision boxes.
class Robot {
  constructor(run, {ghostColour = null} = {}) {
    this.run = run;
    this.ghost = ghostColour !== null;
    this.group = new THREE.Group();
    this.materials_ = new Map();
    this.edges_ = new THREE.LineBasicMaterial({color: 0x000000, transparent: true, opacity: 0.28});
    this.ghostColour_ = ghostColour;
    this.links = run.scene.links.map((link) => {
      const group = new THREE.Group();
      group.name = link.name;
      group.visuals = this.shapes_(link.visuals.length ? link.visuals : link.collisions, link);
      group.collisions = this.shapes_(link.collisions, link);
      group.add(group.visuals, group.collisions);
      this.group.add(group);
      return group;
    });
    this.setBoxes(false);
    this.position_ = new THREE.Vector3();
    this.quaternion_ = new THREE.Quaternion();
  }

  material_(colour) {
    if (!this.materials_.has(colour)) {
      this.materials_.set(colour, new THREE.MeshStandardMaterial({
        color: linearColour(this.ghostColour_ || colour), roughness: 0.62, metalness: 0.08,
        transparent: this.ghost, opacity: this.ghost ? 0.32 : 1, depthWrite: !this.ghost,
      }));
    }
    return this.materials_.get(colour);
  }

  shapes_(shapes, link) {
    const group = new THREE.Group();
    for (const shape of shapes) {
      const geometry = shapeGeometry(shape, this.run.bytes);
      const mesh = place(new THREE.Mesh(geometry, this.material_(shape.colour)), shape);
      mesh.castShadow = !this.ghost;
      mesh.receiveShadow = !this.ghost;
      mesh.userData.tooltip = () => link.name + ", " + formatNumber(1000 * link.mass) + " g";
      group.add(mesh);
      if (!this.ghost) addEdges(mesh, this.edges_);
    }
    return group;
  }

  setBoxes(boxes) {
    for (const link of this.links) {
      link.visuals.visible = !boxes;
      link.collisions.visible = boxes;
    }
  }
  setTranslucent(translucent) {
    if (this.ghost) return;
    for (const material of this.materials_.values()) {
      material.transparent = translucent;
      material.opacity = translucent ? 0.38 : 1;
      material.needsUpdate = true;
    }
    for (const link of this.links) link.traverse((object) => {
      if (object.isMesh) object.castShadow = !translucent;
    });
  }

  // Poses between two ticks are interpolated; at a tick they are the recorded ones.
  setTime(time) {
    const {run} = this;
    if (run.times.length === 0) return;
    const i = run.sampleAt(time);
    const j = Math.min(i + 1, run.times.length - 1);
    const span = run.times[j] - run.times[i];
    const share = span > 0 ? Math.min(1, Math.max(0, (time - run.times[i]) / span)) : 0;
    this.links.forEach((link, k) => {
      const {position, quaternion} = run.poses[k];
      link.position.set(position[0][i], position[1][i], position[2][i]);
      link.quaternion.set(quaternion[0][i], quaternion[1][i], quaternion[2][i], quaternion[3][i]).normalize();
      if (share > 0) {
        link.position.lerp(this.position_.set(position[0][j], position[1][j], position[2][j]), share);
        this.quaternion_.set(quaternion[0][j], quaternion[1][j], quaternion[2][j], quaternion[3][j]).normalize();
        link.quaternion.slerp(this.quaternion_, share);
      }
    });
    this.group.updateMatrixWorld(true);
  }
}

// A floor with lines every 0.1 m and 1 m that fades into the background.
const GRID_VERTEX = `
varying vec3 world;
varying vec2 place;
void main() {
  place = position.xy;
  world = (modelMatrix * vec4(position, 1.0)).xyz;
  gl_Position = projectionMatrix * viewMatrix * vec4(world, 1.0);
}`;
const GRID_FRAGMENT = `
uniform vec3 floorColour;
uniform vec3 lineColour;
uniform vec3 backColour;
uniform vec3 eye;
uniform vec3 centre;
varying vec3 world;
varying vec2 place;
float lines(float pitch, float width) {
  vec2 p = place / pitch;
  vec2 pixel = max(fwidth(p), vec2(1e-6));
  vec2 distance = abs(fract(p - 0.5) - 0.5) / pixel;
  vec2 dense = clamp(1.0 - 2.0 * pixel, 0.0, 1.0);
  vec2 line = clamp(width - distance, 0.0, 1.0) * dense;
  return max(line.x, line.y);
}
void main() {
  float fade = 1.0 - smoothstep(1.2, 5.0, length(world - centre));
  float line = max(0.42 * lines(0.1, 1.0), 0.95 * lines(1.0, 1.4));
  gl_FragColor = vec4(mix(backColour, mix(floorColour, lineColour, line), fade), 1.0);
}`;

function makeFloor(plane) {
  const group = new THREE.Group();
  const normal = new THREE.Vector3().fromArray(plane.normal);
  group.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), normal);
  group.position.copy(normal).multiplyScalar(plane.offset);
  const uniforms = {};
  for (const name of ["floorColour", "lineColour", "backColour"]) uniforms[name] = {value: new THREE.Color()};
  for (const name of ["eye", "centre"]) uniforms[name] = {value: new THREE.Vector3()};
  const geometry = new THREE.PlaneBufferGeometry(200, 200);
  const grid = new THREE.Mesh(geometry, new THREE.ShaderMaterial({
    uniforms, vertexShader: GRID_VERTEX, fragmentShader: GRID_FRAGMENT, extensions: {derivatives: true},
    polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 4,
  }));
  grid.renderOrder = -3;
  const shadow = new THREE.Mesh(geometry, new THREE.ShadowMaterial({
    opacity: 0.3, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 2, depthWrite: false,
  }));
  shadow.receiveShadow = true;
  shadow.renderOrder = -2;
  group.add(grid, shadow);
  group.uniforms = uniforms;
  return group;
}

function makeGround(run) {
  const group = new THREE.Group();
  for (const shape of run.scene.ground) {
    const material = new THREE.MeshStandardMaterial({
      color: linearColour(shape.colour), roughness: 0.9, side: THREE.DoubleSide});
    const geometry = shapeGeometry(shape, run.bytes);
    const mesh = place(new THREE.Mesh(geometry, material), shape);
    mesh.receiveShadow = true;
    mesh.castShadow = true;
    mesh.userData.tooltip = () => shape.name || "ground";
    addEdges(mesh, new THREE.LineBasicMaterial({color: 0x000000, transparent: true, opacity: 0.25}));
    group.add(mesh);
  }
  return group;
}

// A text that faces the camera; its height is in metres.
function makeLabel(text, colour, height) {
  const canvas = document.createElement("canvas");
  canvas.width = 256;
  canvas.height = 64;
  const context = canvas.getContext("2d");
  context.font = "44px system-ui, sans-serif";
  context.fillStyle = colour;
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.fillText(text, 128, 34);
  const texture = new THREE.CanvasTexture(canvas);
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial(
      {map: texture, transparent: true, depthWrite: false, opacity: 0.85}));
  sprite.scale.set(4 * height, height, 1);
  return sprite;
}
