import { Spherical, Vector3 } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

const kFlightSeconds = 0.45;
// The turn of an arrow key.
const kTurn = Math.PI / 24;

/** Moves the camera: by mouse, touch and keys, and in animated flights. */
export class Pilot {
  #camera;
  #controls;
  #onMove;
  #flight = 0;
  // The place to return to: { position, target }.
  #kept = null;

  /** Whether the user is dragging the camera. */
  isDragged = false;
  /**
   * Whether the camera is where everything is visible: neither user nor flight has moved it since.
   */
  isFitted = false;

  /** onMove  called when the camera has moved, and when the user ends a drag */
  constructor(camera, canvas, onMove) {
    this.#camera = camera;
    this.#onMove = onMove;
    this.#controls = new OrbitControls(camera, canvas);
    this.#controls.zoomToCursor = true;
    this.#controls.addEventListener("change", onMove);
    this.#controls.addEventListener("start", () => {
      this.isDragged = true;
      this.#leave();
    });
    this.#controls.addEventListener("end", () => {
      this.isDragged = false;
      onMove();
    });
    canvas.addEventListener("keydown", (event) => this.#onKey(event));
  }

  /** The point that the camera faces and orbits. */
  get target() {
    return this.#controls.target;
  }
  get distance() {
    return this.#camera.position.distanceTo(this.target);
  }
  /** The unit vector from the target to the camera. */
  get back() {
    return this.#camera.position.clone().sub(this.target).normalize();
  }

  /** direction  from the target to the camera; flies  false: the camera jumps */
  flyTo(target, direction, distance, flies = true) {
    this.#leave();
    const position = target.clone().addScaledVector(direction, distance);
    const from = { position: this.#camera.position.clone(), target: this.target.clone() };
    const still = !flies || matchMedia("(prefers-reduced-motion: reduce)").matches;
    const start = performance.now();
    const step = (now) => {
      const part = still ? 1 : Math.min(1, Math.max(0, now - start) / 1000 / kFlightSeconds);
      const eased = part * part * (3 - 2 * part);
      this.#camera.position.lerpVectors(from.position, position, eased);
      this.target.lerpVectors(from.target, target, eased);
      this.#moved();
      if (part < 1) this.#flight = requestAnimationFrame(step);
    };
    step(start);
  }

  /** Stores the camera's position, unless one is already stored. */
  keepPlace() {
    this.#kept ??= { position: this.#camera.position.clone(), target: this.target.clone() };
  }

  /** Returns to the stored position, and clears it. */
  returnToPlace() {
    if (!this.#kept) return;
    cancelAnimationFrame(this.#flight);
    this.#camera.position.copy(this.#kept.position);
    this.target.copy(this.#kept.target);
    this.#controls.update();
    this.#kept = null;
  }

  #moved() {
    this.#controls.update();
    this.#onMove();
  }

  /** The user, or a flight, moves the camera away. */
  #leave() {
    cancelAnimationFrame(this.#flight);
    this.isFitted = false;
  }

  #onKey(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const nearer = { "+": 0.85, "=": 0.85, "-": 1 / 0.85 }[event.key];
    const turn = turns[event.key];
    if (!turn && !nearer) return;
    event.preventDefault();
    this.#leave();
    const offset = this.#camera.position.clone().sub(this.target);
    if (turn && event.shiftKey) {
      const step = offset.length() * 0.05;
      const across = new Vector3().setFromMatrixColumn(this.#camera.matrix, turn[0] ? 0 : 1);
      this.target.addScaledVector(across, step * (turn[0] || -turn[1]));
    } else if (turn) {
      const angles = new Spherical().setFromVector3(offset);
      angles.theta += kTurn * turn[0];
      angles.phi += kTurn * turn[1];
      offset.setFromSpherical(angles.makeSafe());
    } else {
      offset.multiplyScalar(nearer);
    }
    this.#camera.position.copy(this.target).add(offset);
    this.#moved();
  }
}
