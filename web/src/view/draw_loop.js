import { WebGLRenderer } from "three";

import { Picture } from "./picture.js";

// The most pixels of a picture: beyond it high resolutions cost more than they show.
const kMostPixels = 5e6;
// After this time without a picture the view counts as at rest.
const kRestSeconds = 0.15;
// After a picture that took longer, coarse ones follow until the view is at rest.
const kSlowMs = 120;
// A longer time between pictures is a pause of the hand, which says nothing of how slow they are.
const kPauseMs = 1000;
// The resolution of coarse pictures, as a share of the full one.
const kCoarse = 0.4;

/**
 * When pictures of the view are drawn, and in which resolution.
 *
 * Drawn is only after a change. Until the drawing is complete and the view is settled, the canvas has
 * `aria-busy`.
 */
export class DrawLoop {
  #canvas;
  #camera;
  #steps;
  #renderer;
  #picture;
  // Requests of a picture, and of the rest after it; 0: none.
  #asked = 0;
  #rest = 0;
  #isCoarse = false;
  #lastDrawn = 0;

  /**
   * steps  { isDragged(): whether the user turns the view; isNew(): whether it is to be settled at
   *        once; draw(): draws a picture; settle(): called at rest }
   * Errors: WebGL 2 is unavailable.
   */
  constructor(canvas, camera, steps) {
    this.#canvas = canvas;
    this.#camera = camera;
    this.#steps = steps;
    this.#renderer = new WebGLRenderer({ canvas, antialias: false, powerPreference: "default" });
    this.#renderer.localClippingEnabled = true;
    // The check would wait for the compilation of the shaders.
    this.#renderer.debug.checkShaderErrors = false;
    this.#picture = new Picture(this.#renderer);
    new ResizeObserver(() => this.#resize()).observe(canvas);
    canvas.addEventListener("webglcontextrestored", () => this.request());
  }

  get renderer() {
    return this.#renderer;
  }

  get picture() {
    return this.#picture;
  }

  /** Whether a picture, or the rest after one, is still to come. */
  get isPending() {
    return this.#asked !== 0 || this.#rest !== 0;
  }

  /** Requests a picture. */
  request() {
    this.#canvas.setAttribute("aria-busy", true);
    this.#asked ||= requestAnimationFrame(() => {
      this.#asked = 0;
      this.#draw();
    });
  }

  #draw() {
    const since = performance.now() - this.#lastDrawn;
    if (this.#steps.isDragged() && since > kSlowMs && since < kPauseMs) this.#setCoarse(true);
    this.#lastDrawn = performance.now();
    this.#steps.draw();
    clearTimeout(this.#rest);
    this.#rest = 0;
    if (this.#steps.isNew()) this.#steps.settle();
    else this.#rest = setTimeout(() => this.#comeToRest(), 1000 * kRestSeconds);
  }

  #comeToRest() {
    this.#rest = 0;
    if (this.#isCoarse && !this.#steps.isDragged()) this.#setCoarse(false);
    else this.#steps.settle();
  }

  /** Without a GPU, a rotating view must first follow the user, and be sharp at rest. */
  #setCoarse(isCoarse) {
    if (this.#isCoarse === isCoarse) return;
    this.#isCoarse = isCoarse;
    this.#resize();
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
    this.request();
  }
}
