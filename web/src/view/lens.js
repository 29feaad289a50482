import { Matrix4, Ray, Vector3, Vector4 } from "three";

// What is nearer to the eye is not drawn, in distances of the near plane of the camera.
const kNear = 1e-3;

/** The projection of positions in the scan's frame, as drawn, to a canvas [pixel]. */
export class Lens {
  #toClip;
  #toFrame;
  #near;

  /**
   * frame          frameOf() the scan; camera  in the world
   * width, height  of the canvas
   */
  constructor({ toWorld, center, radius }, camera, width, height) {
    const { projectionMatrix, matrixWorldInverse } = camera;
    this.#toClip = new Matrix4().multiplyMatrices(projectionMatrix, matrixWorldInverse);
    this.#toClip.multiply(toWorld);
    this.#toFrame = this.#toClip.clone().invert();
    this.#near = kNear * camera.near;
    this.width = width;
    this.height = height;
    const toFrame = toWorld.clone().invert();
    this.eye = camera.position.clone().applyMatrix4(toFrame);
    this.up = new Vector3(0, 1, 0).transformDirection(toFrame);
    this.center = center.clone();
    this.radius = radius;
  }

  #clip(place) {
    return new Vector4(place.x, place.y, place.z, 1).applyMatrix4(this.#toClip);
  }

  #pixel({ x, y, w }) {
    return { x: ((x / w + 1) * this.width) / 2, y: ((1 - y / w) * this.height) / 2 };
  }

  /** { x, y } of a position; null: it is behind the eye. */
  project(place) {
    const clip = this.#clip(place);
    return clip.w > this.#near ? this.#pixel(clip) : null;
  }

  /** The part of a line segment in front of the eye: [{ x, y }, { x, y }], or null. */
  line(from, to) {
    const [a, b] = [this.#clip(from), this.#clip(to)];
    if (Math.max(a.w, b.w) <= this.#near) return null;
    const cut = (near, far) =>
      near.w > this.#near ? near : near.lerp(far, (this.#near - near.w) / (far.w - near.w));
    return [this.#pixel(cut(a, b)), this.#pixel(cut(b, a))];
  }

  /** Whether a position is within the canvas. */
  shows(x, y, z) {
    const { elements: m } = this.#toClip;
    const w = m[3] * x + m[7] * y + m[11] * z + m[15];
    const across = m[0] * x + m[4] * y + m[8] * z + m[12];
    const up = m[1] * x + m[5] * y + m[9] * z + m[13];
    return w > 0 && Math.abs(across) <= w && Math.abs(up) <= w;
  }

  /** The ray from the eye through a pixel. */
  ray(x, y) {
    const through = new Vector3((2 * x) / this.width - 1, 1 - (2 * y) / this.height, 0.5);
    return new Ray(this.eye.clone(), through.applyMatrix4(this.#toFrame).sub(this.eye).normalize());
  }
}
