import {
  Color,
  DirectionalLight,
  DoubleSide,
  Group,
  HemisphereLight,
  Matrix4,
  Mesh,
  MeshLambertMaterial,
  PerspectiveCamera,
  Raycaster,
  Scene,
  Sphere,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";

import { element } from "../dom.js";
import { makeAxes } from "./axes.js";
import { distanceToSee, frameOf } from "./frame.js";
import { Lens } from "./lens.js";
import { outlineMaterial, Picture } from "./picture.js";
import { pickPoint } from "./pick_point.js";
import { Pilot } from "./pilot.js";
import { makeRayPoints } from "./ray_points.js";
import { RulerLine } from "./ruler_line.js";
import { colorScanPoints, makeScanPoints } from "./scan_points.js";
import { SeenParts } from "./seen_parts.js";
import { Sensor } from "./sensor.js";
import { planesOf } from "./slab.js";
import { makeTurnAxes } from "./turn_axes.js";
import { makeTurned } from "./turned_model.js";

const kFieldOfView = 40; // [degrees]
const kMostPixels = 5e6; // of a picture: beyond it high resolutions cost more than they show
const kStray = 0.005; // share of a scan's points that need not be seen when all of it is
const kRoom = 1.6; // radii of a thing that are seen around its center when it is looked at
const kSurroundings = 4; // the same where what lies around it decides
const kRestSeconds = 0.15; // after which the view counts as at rest
const kSlowMs = 120; // of a picture: then coarse ones follow until the view is at rest
const kPauseMs = 1000; // of the hand, which tells nothing of how slow pictures are
const kCoarse = 0.4; // of the resolution
const kDim = 0.8; // share of the ground in points that do not count
const kSelected = 1; // outlineMaterial: the solid thing inside stays as it is

const foundMaterial = () => new MeshLambertMaterial({ flatShading: true, side: DoubleSide });

/** Frees the GPU resources of a mesh, except geometries, which `Meshes` keeps. */
const freeMaterials = (group) => group.traverse((thing) => thing.material?.dispose());
/** Frees all geometries except that of the model, which is reused. */
const freeGeometries = (model) =>
  model.traverse(({ geometry }) => geometry !== model.geometry && geometry?.dispose());

/**
 * The 3-D view: one scan with posed models, or a single model.
 *
 * It draws only after a change; until the drawing is complete and its marks are placed, its canvas
 * has `aria-busy`. Things are posed in the scan's frame. Callbacks: `onPick(id)` gets the clicked
 * thing (null: none); `onAsk(point)` gets the clicked point of the scan; `onLook(point, distance)`
 * gets the camera's target, in the scan's frame and unit; `onScale(length)` gets the length of a
 * pixel there, in the unit of the displayed object (null: none); `onDraw(lens)` gets the projection
 * of the scan in the drawn picture (null: no scan).
 */
export class SceneView {
  #canvas;
  #marks;
  #renderer;
  #picture;
  #camera = new PerspectiveCamera(kFieldOfView);
  #pilot;
  #solid = new Scene();
  #outlined = new Scene();
  #lamp = new DirectionalLight("#ffffff", 2.2);
  #axes = makeAxes();
  #seenParts = new SeenParts();
  #sensor;
  #ruler;
  #planes = []; // of the section
  #traced = new Set(); // ids of things whose outlines alone are drawn; then no thing is solid
  #frame = null;
  #points = null;
  #rays = null;
  #found = new Group();
  #model = null; // shown by itself
  #things = []; // { id, kind, mesh, outline, mark, center, place, radius, color, alternatives }
  #layers = { scan: true, found: true, rejected: false };
  #selected = null;
  #asked = 0;
  #rest = 0; // timer until it counts as at rest
  #settled = 0; // how often it came to rest
  #isNew = false; // no mark was placed yet
  #isCoarse = false;
  #lastDrawn = 0;
  #alike = []; // see #prepare

  /** Whether a click asks about a position of the scan instead of selecting a thing. */
  asks = false;

  onPick = () => {};
  onAsk = () => {};
  onLook = () => {};
  onScale = () => {};
  onDraw = () => {};

  /** Errors: WebGL 2 is unavailable. */
  constructor(canvas, marks) {
    this.#canvas = canvas;
    this.#marks = marks;
    this.#renderer = new WebGLRenderer({ canvas, antialias: false, powerPreference: "default" });
    this.#renderer.localClippingEnabled = true;
    this.#renderer.debug.checkShaderErrors = false; // which waits for their compilation
    this.#picture = new Picture(this.#renderer);
    this.#pilot = new Pilot(this.#camera, canvas, () => this.#draw());
    this.#solid.add(new HemisphereLight("#ffffff", "#6f7680", 1.4), this.#camera, this.#found);
    this.#lamp.position.set(-0.4, 0.6, 1);
    this.#camera.add(this.#lamp);
    this.#sensor = new Sensor(marks);
    this.#ruler = new RulerLine(marks);
    this.#solid.add(this.#axes, this.#sensor.pyramid);
    this.#camera.position.set(0, 0.5, 3);
    this.readColors();
    this.#prepare();

    new ResizeObserver(() => this.#resize()).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.readColors());
    canvas.addEventListener("webglcontextrestored", () => this.#draw());
    this.#listenForPicks();
  }

  /**
   * Draws a small scan and a found model once, in a few pixels. Shader programs are compiled at
   * their first use, for which the page would otherwise wait while it draws pictures of many
   * points. The drawn objects stay, as unused programs are discarded.
   */
  #prepare() {
    const corners = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]);
    const points = makeScanPoints(corners, frameOf(corners));
    points.material.uniforms.color.value = points.material.uniforms.dim.value = this.colors.scan;
    const mesh = new Mesh(points.geometry, foundMaterial());
    // SeenParts draws outlines among solid objects, whose lights require another shader program.
    const [outline, seen] = [0, 1].map(
      () => new Mesh(points.geometry, outlineMaterial(kSelected, new Color())),
    );
    this.#alike.push(points, mesh, outline, seen);
    for (const thing of this.#alike) thing.frustumCulled = false;
    this.#solid.add(points, mesh, seen);
    this.#outlined.add(outline);
    const hidden = this.#solid.children.filter(({ visible }) => !visible);
    for (const thing of hidden) thing.visible = true;
    this.#picture.render(this.#solid, this.#outlined, this.#camera, 1, 1);
    for (const thing of hidden) thing.visible = false;
    for (const thing of this.#alike) thing.removeFromParent();
  }

  /** Reads the colors of the scene from the style sheet. */
  readColors() {
    const style = getComputedStyle(this.#canvas);
    const color = (name) => new Color(style.getPropertyValue(name).trim());
    this.colors = {
      scan: color("--scan"),
      selected: color("--selected"),
      rejected: color("--rejected"),
      doubt: color("--doubt"),
    };
    this.#solid.background = color("--view");
    this.#inkPoints();
    this.#sensor.setColor(this.colors.rejected);
    for (const thing of this.#things) this.#paint(thing);
    this.#draw();
  }

  #inkPoints() {
    if (!this.#points) return;
    const { color, dim } = this.#points.material.uniforms;
    color.value = this.colors.scan;
    dim.value = this.colors.scan.clone().lerp(this.#solid.background, kDim);
  }

  /** positions  x, y, z of each point; viewpoint  of the sensor; both in the scan's frame */
  showScan(positions, viewpoint) {
    this.clear();
    if (!positions.length) return;
    this.#frame = frameOf(positions, viewpoint);
    this.#points = makeScanPoints(positions, this.#frame);
    this.#inkPoints();
    this.#solid.add(this.#points);
    this.#arrange();
    this.fit(false);
  }

  /** Removes the scan and everything posed in it. */
  clear() {
    this.closeModel();
    this.setThings([]);
    this.#points?.removeFromParent();
    this.#points?.geometry.dispose();
    this.#points?.material.uniforms.palette.value.dispose();
    this.#points?.material.dispose();
    this.#points = null;
    this.#frame = null;
    this.#planes = [];
    this.#traced.clear();
    this.#ruler.set([], "");
    this.#draw();
  }

  /**
   * Poses models in the scan.
   *
   * things  [{ id, kind: "found", "rejected" or "why", geometry, pose: Matrix4 from the geometry's
   *         points to the scan's frame, color, label, alternatives: other such poses }]
   */
  setThings(things) {
    this.showRays(null);
    this.#selected = null;
    freeMaterials(this.#found);
    for (const { outline } of this.#things) freeMaterials(outline);
    this.#found.clear();
    this.#outlined.clear();
    for (const { mark } of this.#things) mark.remove();
    this.#things = this.#frame ? things.map((thing, k) => this.#make(thing, k)) : [];
    this.#isNew = true;
    this.#arrange();
    if (this.#pilot.isFitted && !this.#model) this.fit(false);
  }

  #make(thing, index) {
    const matrix = this.#frame.toWorld.clone().multiply(thing.pose);
    const pose = (mesh, world) => {
      mesh.matrixAutoUpdate = false;
      mesh.matrix.copy(world);
      return mesh;
    };
    const outline = new Group();
    const addOutline = (world, id) =>
      outline.add(pose(new Mesh(thing.geometry, outlineMaterial(id, new Color())), world));
    addOutline(matrix, thing.kind === "found" ? kSelected : index + 2);
    for (const alternative of thing.alternatives ?? []) {
      addOutline(this.#frame.toWorld.clone().multiply(alternative), index + 2);
    }
    this.#outlined.add(outline);
    let mesh = null;
    if (thing.kind === "found") {
      mesh = pose(new Mesh(thing.geometry, foundMaterial()), matrix);
      mesh.userData.id = thing.id;
      this.#found.add(mesh);
    }
    const sphere = new Sphere().copy(thing.geometry.boundingSphere).applyMatrix4(matrix);
    const mark = element("span", { className: `mark ${thing.kind}` }, thing.label);
    mark.style.setProperty("--ink", thing.color ?? "");
    this.#marks.append(mark);
    const { min, max } = thing.geometry.boundingBox;
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((k) =>
      new Vector3(k & 1 ? max.x : min.x, k & 2 ? max.y : min.y, k & 4 ? max.z : min.z).applyMatrix4(
        matrix,
      ),
    );
    const made = {
      ...thing,
      corners: thing.kind === "found" ? corners : [],
      matrix,
      outline,
      mesh,
      mark,
      center: sphere.center,
      place: sphere.center, // of the mark
      radius: sphere.radius,
    };
    this.#paint(made);
    return made;
  }

  #paint(thing) {
    const fades = this.#selected !== null && thing.id !== this.#selected;
    thing.mesh?.material.color.set(thing.color ?? 0).lerp(this.colors.scan, fades ? 0.6 : 0);
    const ink = thing.id === this.#selected ? this.colors.selected : this.colors.rejected;
    for (const { material } of thing.outline.children) {
      material.uniforms.color.value.copy(ink).lerp(this.colors.scan, fades ? 0.5 : 0);
    }
  }

  /** Shows the verdicts of rays for a pose, see makeRayPoints; null: none. */
  showRays(rays, offset) {
    this.#rays?.removeFromParent();
    this.#rays?.geometry.dispose();
    this.#rays?.material.dispose();
    this.#rays = rays && this.#frame ? makeRayPoints(rays, offset, this.#frame) : null;
    if (this.#rays) this.#solid.add(this.#rays);
    this.#arrange();
  }

  /** Shows or hides { scan, found, rejected }. */
  setLayers(layers) {
    Object.assign(this.#layers, layers);
    this.#arrange();
  }

  /**
   * Colors the scan: see colorScanPoints.
   *
   * traced  ids of things to draw as outlines; with any, no thing is solid and hides points
   */
  colorScan(coloring, traced = []) {
    if (!this.#points) return;
    colorScanPoints(this.#points, coloring);
    this.#traced = new Set(traced);
    this.#arrange();
  }

  /** Clips the scan and the models posed in it to a slab; see planesOf. */
  setSlab(slab) {
    this.#planes = this.#frame ? planesOf(slab, this.#frame.toWorld) : [];
    this.#arrange();
  }

  /** Draws a ruler between two points of the scan's frame, or its first end alone. */
  setRuler(points, text) {
    const places = points.map((point) => new Vector3(...point).applyMatrix4(this.#frame.toWorld));
    this.#ruler.set(places, text);
    this.#draw();
  }

  /** Unit vectors of the scan's frame: up, and the view direction of the camera. */
  get up() {
    return this.#inScan(new Vector3(0, 1, 0));
  }

  get forward() {
    return this.#inScan(this.#camera.getWorldDirection(new Vector3()));
  }

  #inScan(direction) {
    return direction.transformDirection(this.#frame.toWorld.clone().invert()).toArray();
  }

  /** Whether the section keeps this position of the world. */
  #isLeft(place) {
    return this.#planes.every((plane) => plane.distanceToPoint(place) >= 0);
  }

  #shows(thing) {
    return !this.#model && (this.#layers[thing.kind] || thing.id === this.#selected);
  }

  #arrange() {
    const chosen = this.#things.find((thing) => thing.id === this.#selected);
    if (this.#points) {
      this.#points.visible = this.#layers.scan && !this.#model;
      this.#points.material.clippingPlanes = this.#planes;
    }
    for (const thing of this.#things) {
      const shown = this.#shows(thing);
      const isOutline =
        thing.kind === "rejected" || thing === chosen || this.#traced.has(thing.id);
      const isHollow = this.#traced.size || (this.#rays && thing === chosen);
      if (thing.mesh) thing.mesh.visible = shown && !isHollow;
      thing.outline.visible = shown && isOutline;
      for (const { material } of [thing.mesh, ...thing.outline.children].filter(Boolean)) {
        material.clippingPlanes = this.#planes;
      }
      thing.mark.hidden = !shown;
      thing.mark.classList.toggle("selected", thing === chosen);
      this.#paint(thing);
    }
    this.#sensor.show(this.#model ? null : (this.#frame?.sensor ?? null));
    if (this.#rays) this.#rays.visible = !this.#model;
    this.#axes.visible = Boolean(chosen) && !this.#model;
    if (chosen) {
      const length = (1.1 * chosen.radius) / chosen.matrix.getMaxScaleOnAxis();
      this.#axes.matrix.copy(chosen.matrix).scale(new Vector3().setScalar(length));
    }
    this.#draw();
  }

  /** Highlights the thing with this id and flies to it; null: none. */
  select(id) {
    this.#selected = id;
    this.#arrange();
    const thing = this.#things.find((other) => other.id === id);
    if (!thing || this.#model) return;
    const room = thing.kind === "why" ? kSurroundings : kRoom;
    const half = Math.atan(
      Math.tan((kFieldOfView * Math.PI) / 360) * Math.min(1, this.#camera.aspect),
    );
    this.#pilot.flyTo(thing.center, this.#pilot.back, (room * thing.radius) / Math.sin(half));
  }

  /**
   * Shows a single model until closeModel().
   *
   * axes    of its symmetries: see makeTurnAxes
   * turned  an object drawn over it, if any: see makeTurned
   */
  showModel(geometry, color, axes = [], turned = null) {
    this.closeModel(false);
    this.#pilot.keepPlace();
    const material = new MeshLambertMaterial({
      color: color,
      flatShading: true,
      side: DoubleSide,
    });
    const mesh = new Mesh(geometry, material);
    mesh.matrixAutoUpdate = false;
    this.#model = { mesh, frame: frameOf(geometry.attributes.position.array, null) };
    mesh.matrix.copy(this.#model.frame.toWorld);
    mesh.add(makeTurnAxes(axes, this.#model.frame.radius, this.colors.selected));
    if (turned) mesh.add(makeTurned(geometry, turned, this.#model.frame.radius, this.colors.doubt));
    this.#solid.add(mesh);
    this.#arrange();
    this.fit(false);
  }

  get showsModel() {
    return this.#model !== null;
  }

  /** Shows the scan again, from the previous position. */
  closeModel(back = true) {
    if (this.#model) {
      this.#model.mesh.removeFromParent();
      freeMaterials(this.#model.mesh);
      freeGeometries(this.#model.mesh);
      this.#model = null;
    }
    if (!back) return;
    this.#pilot.returnToPlace();
    this.#arrange();
  }

  /** Shows everything, from the sensor's position. */
  fit(flies = true) {
    const frame = this.#model?.frame ?? this.#frame;
    if (!frame) return;
    const up = Math.tan((kFieldOfView * Math.PI) / 360);
    const field = { across: up * this.#camera.aspect, up };
    const corners = this.#model ? [] : this.#things.flatMap((thing) => thing.corners);
    const distance = Math.max(
      distanceToSee(frame.sample, frame.direction, field, this.#model ? 0 : kStray),
      corners.length ? distanceToSee(corners, frame.direction, field) : 0,
    );
    this.#pilot.flyTo(new Vector3(), frame.direction, distance, flies);
    this.#pilot.isFitted = true;
  }

  #listenForPicks() {
    const caster = new Raycaster();
    const start = new Vector2();
    this.#canvas.addEventListener("pointerdown", (event) =>
      start.set(event.clientX, event.clientY),
    );
    this.#canvas.addEventListener("click", (event) => {
      const moved = start.distanceTo(new Vector2(event.clientX, event.clientY)) > 4;
      if (moved || this.#model || !this.#frame) return;
      const { offsetX, offsetY } = event;
      const { clientWidth, clientHeight } = this.#canvas;
      if (this.asks) {
        const point = this.#pointAt(offsetX, offsetY);
        if (point) this.onAsk(point);
        return;
      }
      caster.setFromCamera(
        new Vector2((2 * offsetX) / clientWidth - 1, 1 - (2 * offsetY) / clientHeight),
        this.#camera,
      );
      const hit = caster
        .intersectObjects(
          this.#things.filter((thing) => this.#shows(thing) && thing.mesh).map(({ mesh }) => mesh),
          false,
        )
        .find(({ point }) => this.#isLeft(point));
      this.onPick(hit ? hit.object.userData.id : null);
    });
  }

  /** The visible point of the scan at a position of the canvas, in the scan's frame, or null. */
  #pointAt(x, y) {
    const { clientWidth, clientHeight } = this.#canvas;
    const project = new Matrix4()
      .multiplyMatrices(this.#camera.projectionMatrix, this.#camera.matrixWorldInverse)
      .multiply(this.#points.matrix);
    const centered = this.#points.geometry.getAttribute("position").array;
    const isSeen = (at) => this.#isLeft(new Vector3(...at).applyMatrix4(this.#points.matrix));
    const point = pickPoint(centered, project, x, y, clientWidth, clientHeight, isSeen);
    return point && this.#frame.center.clone().add(new Vector3(...point)).toArray();
  }

  /** The point of the scan at the center of the view, or null. */
  pointInTheMiddle() {
    if (!this.#frame || this.#model) return null;
    return this.#pointAt(this.#canvas.clientWidth / 2, this.#canvas.clientHeight / 2);
  }

  #resize() {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    if (!width || !height) return;
    const full = Math.min(devicePixelRatio, 2, Math.sqrt(kMostPixels / (width * height)));
    const ratio = this.#isCoarse ? kCoarse * full : full;
    this.#renderer.setPixelRatio(ratio);
    this.#renderer.setSize(width, height, false);
    this.#picture.resize(this.#canvas.width, this.#canvas.height, ratio);
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
    this.#draw();
  }

  #draw() {
    this.#canvas.setAttribute("aria-busy", true);
    this.#asked ||= requestAnimationFrame(() => {
      this.#asked = 0;
      this.#drawNow();
    });
  }

  /** Without a GPU, a rotating view must first follow the user, and be sharp at rest. */
  #setCoarse(isCoarse) {
    if (this.#isCoarse === isCoarse) return;
    this.#isCoarse = isCoarse;
    this.#resize();
  }

  #drawNow() {
    const since = performance.now() - this.#lastDrawn;
    if (this.#pilot.isDragged && since > kSlowMs && since < kPauseMs) this.#setCoarse(true);
    this.#lastDrawn = performance.now();
    const { distance } = this.#pilot;
    this.#camera.near = Math.max(0.002, distance / 100);
    this.#camera.far = distance + 20;
    this.#camera.updateProjectionMatrix();
    const smallest = 1.2 * this.#renderer.getPixelRatio();
    const pixelsPerUnit = this.#setPointSize(this.#canvas.height, smallest);
    this.#sensor.prepare(this.#camera, this.#pilot.target);
    const spacing = this.#points?.material.uniforms.spacing.value ?? 0;
    this.#picture.render(this.#solid, this.#outlined, this.#camera, pixelsPerUnit, spacing);
    clearTimeout(this.#rest);
    this.#rest = 0;
    if (this.#isNew) this.#settle();
    else this.#rest = setTimeout(() => this.#comeToRest(), 1000 * kRestSeconds);
    this.#placeMarks();
    this.#tellLook(distance);
    this.onDraw(this.#lens());
  }

  #lens() {
    if (!this.#frame || this.#model) return null;
    const { clientWidth, clientHeight } = this.#canvas;
    return new Lens(this.#frame, this.#camera, clientWidth, clientHeight);
  }

  #comeToRest() {
    this.#rest = 0;
    if (this.#isCoarse && !this.#pilot.isDragged) this.#setCoarse(false);
    else this.#settle();
  }

  /**
   * At rest, places the marks on visible parts of their things; they stay there when the view
   * rotates.
   */
  async #settle() {
    this.#isNew = false;
    const turn = ++this.#settled;
    const things = this.#things;
    const seen = things.filter(({ mesh }) => mesh?.visible);
    const places = seen.length ? await this.#findSeen(seen.map(({ mesh }) => mesh)) : [];
    // Other things are shown by now, or the viewpoint has changed.
    if (things !== this.#things || turn !== this.#settled) return;
    seen.forEach((thing, k) => {
      thing.place = places[k] ?? thing.center;
      thing.mark.classList.toggle("behind", !places[k]);
    });
    if (seen.length) this.#placeMarks();
    if (!this.#asked && !this.#rest) this.#canvas.setAttribute("aria-busy", false);
  }

  #findSeen(meshes) {
    const hidden = [this.#axes, this.#sensor.pyramid].filter((thing) => thing.visible);
    for (const thing of hidden) thing.visible = false;
    const finding = this.#seenParts.find(
      this.#renderer,
      this.#solid,
      this.#camera,
      meshes,
      ({ point }) => this.#isLeft(point),
      (height) => this.#setPointSize(height, 1),
    );
    for (const thing of hidden) thing.visible = true;
    return finding;
  }

  /**
   * Sets the point size for a picture of this height [pixel]; smallest  size of a point. Returns
   * pixelsPerUnit.
   */
  #setPointSize(height, smallest) {
    const pixelsPerUnit = height / 2 / Math.tan((kFieldOfView * Math.PI) / 360);
    const uniforms = this.#points?.material.uniforms;
    if (!uniforms) return pixelsPerUnit;
    uniforms.pixelsPerUnit.value = pixelsPerUnit;
    uniforms.smallest.value = smallest;
    return pixelsPerUnit;
  }

  #placeMarks() {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    for (const thing of this.#things) {
      if (thing.mark.hidden) continue;
      const seen = thing.place.clone().project(this.#camera);
      const x = (((seen.x + 1) / 2) * width).toFixed(1);
      const y = (((1 - seen.y) / 2) * height).toFixed(1);
      const { style } = thing.mark;
      style.visibility = Math.abs(seen.z) < 1 ? "visible" : "hidden";
      style.transform = `translate(${x}px, ${y}px) translate(-50%, -50%)`;
    }
    this.#sensor.place(this.#camera, width, height);
    this.#ruler.place(this.#camera, width, height, !this.#model);
  }

  #tellLook(distance) {
    const shown = this.#model?.frame ?? this.#frame;
    const halfHeight = distance * Math.tan((kFieldOfView * Math.PI) / 360);
    this.onScale(shown ? (2 * halfHeight * shown.radius) / this.#canvas.clientHeight : null);
    const frame = this.#model ? null : this.#frame;
    if (!frame) return this.onLook(null);
    const point = this.#pilot.target
      .clone()
      .applyMatrix4(new Matrix4().copy(frame.toWorld).invert());
    return this.onLook(point.toArray(), distance * frame.radius);
  }
}
