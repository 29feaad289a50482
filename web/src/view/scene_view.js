import {
  Color,
  DirectionalLight,
  HemisphereLight,
  Matrix4,
  PerspectiveCamera,
  Raycaster,
  Scene,
  Vector3,
} from "three";

import { makeAxes } from "./axes.js";
import { listenForClicks } from "./clicks.js";
import { DrawLoop } from "./draw_loop.js";
import { distanceToSee } from "./frame.js";
import { Lens } from "./lens.js";
import { Pilot } from "./pilot.js";
import { PosedThings } from "./posed_things.js";
import { makeRayPoints } from "./ray_points.js";
import { RulerLine } from "./ruler_line.js";
import { ScanCloud } from "./scan_cloud.js";
import { SeenParts } from "./seen_parts.js";
import { Sensor } from "./sensor.js";
import { SingleModel } from "./single_model.js";
import { planesOf } from "./slab.js";
import { warmUp } from "./warm_up.js";

// [degrees]
const kFieldOfView = 40;
// The tangent of half of it.
const kTangent = Math.tan((kFieldOfView * Math.PI) / 360);
// The share of a scan's points that may be out of sight when all of it is shown.
const kStray = 0.005;
// The radius of what is visible around the center of a selected thing, in radii of the thing.
const kRoom = 1.6;
// The same where the surroundings decide.
const kSurroundings = 4;

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
  #camera = new PerspectiveCamera(kFieldOfView);
  #loop;
  #pilot;
  #solid = new Scene();
  #outlined = new Scene();
  #axes = makeAxes();
  #seenParts = new SeenParts();
  #sensor;
  #ruler;
  #things;
  // The planes of the section.
  #planes = [];
  // The ids of things whose outlines alone are drawn; with any, no thing is solid.
  #traced = new Set();
  #scan = new ScanCloud(this.#solid);
  #rays = null;
  // The model that is shown by itself.
  #model = null;
  #layers = { scan: true, found: true, rejected: false };
  #selected = null;
  // How often the view came to rest.
  #settled = 0;
  // Whether the marks of new things are still to be placed.
  #isNew = false;
  // Objects that keep their shader programs: see warmUp.
  #warm;
  #caster = new Raycaster();

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
    this.#loop = new DrawLoop(canvas, this.#camera, {
      isDragged: () => this.#pilot.isDragged,
      isNew: () => this.#isNew,
      draw: () => this.#drawPicture(),
      settle: () => this.#settle(),
    });
    this.#pilot = new Pilot(this.#camera, canvas, () => this.#draw());
    this.#sensor = new Sensor(marks);
    this.#ruler = new RulerLine(marks);
    this.#things = new PosedThings(this.#solid, this.#outlined, marks);
    this.#light();
    this.#solid.add(this.#camera, this.#axes, this.#sensor.pyramid);
    this.#camera.position.set(0, 0.5, 3);
    this.readColors();
    const scenes = { solid: this.#solid, outlined: this.#outlined };
    this.#warm = warmUp(this.#loop.picture, scenes, this.#camera, this.colors.scan);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.readColors());
    listenForClicks(canvas, (x, y) => this.#onClick(x, y));
  }

  #light() {
    const lamp = new DirectionalLight("#ffffff", 2.2);
    lamp.position.set(-0.4, 0.6, 1);
    this.#camera.add(lamp);
    this.#solid.add(new HemisphereLight("#ffffff", "#6f7680", 1.4));
  }

  #draw() {
    this.#loop.request();
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
    this.#scan.ink(this.colors.scan, this.#solid.background);
    this.#sensor.setColor(this.colors.rejected);
    this.#things.paint(this.colors, this.#selected);
    this.#draw();
  }

  /** positions  x, y, z of each point; viewpoint  of the sensor; both in the scan's frame */
  showScan(positions, viewpoint) {
    this.clear();
    if (!positions.length) return;
    this.#scan.show(positions, viewpoint);
    this.#scan.ink(this.colors.scan, this.#solid.background);
    this.#arrange();
    this.fit(false);
  }

  /** Removes the scan and everything posed in it. */
  clear() {
    this.closeModel();
    this.setThings([]);
    this.#scan.clear();
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
    this.#things.set(this.#frame ? things : [], this.#frame?.toWorld);
    this.#isNew = true;
    this.#arrange();
    if (this.#pilot.isFitted && !this.#model) this.fit(false);
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
    if (!this.#frame) return;
    this.#scan.color(coloring);
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

  get #frame() {
    return this.#scan.frame;
  }

  /** Whether the section keeps this position of the world. */
  #isLeft(place) {
    return this.#planes.every((plane) => plane.distanceToPoint(place) >= 0);
  }

  #shows(thing) {
    return !this.#model && (this.#layers[thing.kind] || thing.id === this.#selected);
  }

  #arrange() {
    const chosen = this.#things.find(this.#selected);
    this.#scan.arrange(this.#layers.scan && !this.#model, this.#planes);
    this.#things.arrange((thing) => this.#shows(thing), {
      selected: this.#selected,
      traced: this.#traced,
      hasRays: this.#rays !== null,
      planes: this.#planes,
    });
    this.#things.paint(this.colors, this.#selected);
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
    const thing = this.#things.find(id);
    if (!thing || this.#model) return;
    const room = thing.kind === "why" ? kSurroundings : kRoom;
    const half = Math.atan(kTangent * Math.min(1, this.#camera.aspect));
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
    const { selected, doubt } = this.colors;
    const colors = { model: color, axes: selected, turned: doubt };
    this.#model = new SingleModel(geometry, { axes, turned }, colors);
    this.#solid.add(this.#model.mesh);
    this.#arrange();
    this.fit(false);
  }

  get showsModel() {
    return this.#model !== null;
  }

  /** Shows the scan again, from the previous position. */
  closeModel(back = true) {
    this.#model?.dispose();
    this.#model = null;
    if (!back) return;
    this.#pilot.returnToPlace();
    this.#arrange();
  }

  /** Shows everything, from the sensor's position. */
  fit(flies = true) {
    const frame = this.#model?.frame ?? this.#frame;
    if (!frame) return;
    const field = { across: kTangent * this.#camera.aspect, up: kTangent };
    const corners = this.#model ? [] : this.#things.all.flatMap((thing) => thing.corners);
    const distance = Math.max(
      distanceToSee(frame.sample, frame.direction, field, this.#model ? 0 : kStray),
      corners.length ? distanceToSee(corners, frame.direction, field) : 0,
    );
    this.#pilot.flyTo(new Vector3(), frame.direction, distance, flies);
    this.#pilot.isFitted = true;
  }

  #onClick(x, y) {
    if (this.#model || !this.#frame) return;
    if (this.asks) {
      const point = this.#pointAt([x, y]);
      if (point) this.onAsk(point);
      return;
    }
    const { clientWidth, clientHeight } = this.#canvas;
    const pointer = [(2 * x) / clientWidth - 1, 1 - (2 * y) / clientHeight];
    const isVisible = {
      thing: (thing) => this.#shows(thing),
      place: (place) => this.#isLeft(place),
    };
    this.onPick(this.#things.idAt(pointer, this.#camera, this.#caster, isVisible));
  }

  #pointAt(place) {
    return this.#scan.pointAt(place, this.#canvas, this.#camera, (point) => this.#isLeft(point));
  }

  /** The point of the scan at the center of the view, or null. */
  pointInTheMiddle() {
    if (!this.#frame || this.#model) return null;
    return this.#pointAt([this.#canvas.clientWidth / 2, this.#canvas.clientHeight / 2]);
  }

  #drawPicture() {
    const { distance } = this.#pilot;
    this.#camera.near = Math.max(0.002, distance / 100);
    this.#camera.far = distance + 20;
    this.#camera.updateProjectionMatrix();
    const { picture, renderer } = this.#loop;
    const pixelsPerUnit = this.#setPointSize(this.#canvas.height, 1.2 * renderer.getPixelRatio());
    this.#sensor.prepare(this.#camera, this.#pilot.target);
    picture.render(this.#solid, this.#outlined, this.#camera, pixelsPerUnit, this.#scan.spacing);
    this.#placeMarks();
    this.#tellLook(distance);
    this.onDraw(this.#lens());
  }

  #lens() {
    if (!this.#frame || this.#model) return null;
    const { clientWidth, clientHeight } = this.#canvas;
    return new Lens(this.#frame, this.#camera, clientWidth, clientHeight);
  }

  /**
   * At rest, places the marks on visible parts of their things; they stay there when the view
   * rotates.
   */
  async #settle() {
    this.#isNew = false;
    const turn = ++this.#settled;
    const things = this.#things.all;
    const seen = things.filter(({ mesh }) => mesh?.visible);
    const places = seen.length ? await this.#findSeen(seen.map(({ mesh }) => mesh)) : [];
    // Other things are shown by now, or the viewpoint has changed.
    if (things !== this.#things.all || turn !== this.#settled) return;
    seen.forEach((thing, k) => {
      thing.place = places[k] ?? thing.center;
      thing.mark.classList.toggle("behind", !places[k]);
    });
    if (seen.length) this.#placeMarks();
    if (!this.#loop.isPending) this.#canvas.setAttribute("aria-busy", false);
  }

  #findSeen(meshes) {
    const hidden = [this.#axes, this.#sensor.pyramid].filter((thing) => thing.visible);
    for (const thing of hidden) thing.visible = false;
    const finding = this.#seenParts.find(
      this.#loop.renderer,
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
    const pixelsPerUnit = height / 2 / kTangent;
    this.#scan.setPointSize(smallest, pixelsPerUnit);
    return pixelsPerUnit;
  }

  #placeMarks() {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    this.#things.placeMarks(this.#camera, width, height);
    this.#sensor.place(this.#camera, width, height);
    this.#ruler.place(this.#camera, width, height, !this.#model);
  }

  #tellLook(distance) {
    const shown = this.#model?.frame ?? this.#frame;
    const halfHeight = distance * kTangent;
    this.onScale(shown ? (2 * halfHeight * shown.radius) / this.#canvas.clientHeight : null);
    const frame = this.#model ? null : this.#frame;
    if (!frame) return this.onLook(null);
    const point = this.#pilot.target
      .clone()
      .applyMatrix4(new Matrix4().copy(frame.toWorld).invert());
    return this.onLook(point.toArray(), distance * frame.radius);
  }
}
