import { svg } from "./svg.js";

// The radii of a handle, as drawn and for fingers [pixel].
const kSize = 6;
const kReach = 16;

/** A dot that the user drags. */
export class Handle {
  #shown = svg("g", { class: "handle" });

  /**
   * label  shown beside it, if any; onDrag({ x, y })  in the layer [pixel]; onStart()  called
   *        before
   */
  constructor(layer, { title, label = "", onStart = () => {}, onDrag }) {
    this.#shown.append(svg("circle", { class: "reach", r: kReach }), svg("circle", { r: kSize }));
    this.#shown.append(svg("text", { x: 10, y: -6 }, label), svg("title", {}, title));
    layer.append(this.#shown);
    const place = ({ clientX, clientY }) => {
      const { left, top } = layer.getBoundingClientRect();
      return { x: clientX - left, y: clientY - top };
    };
    this.#shown.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      this.#shown.setPointerCapture(event.pointerId);
      onStart();
    });
    this.#shown.addEventListener("pointermove", (event) => {
      if (this.#shown.hasPointerCapture(event.pointerId)) onDrag(place(event));
    });
  }

  /** at  { x, y }, or null: hidden; behind  whether another part of its guide is in front of it */
  place(at, behind = false) {
    this.#shown.classList.toggle("gone", !at);
    this.#shown.classList.toggle("behind", behind);
    if (at) this.#shown.setAttribute("transform", `translate(${at.x} ${at.y})`);
  }
}
