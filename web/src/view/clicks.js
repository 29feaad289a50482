import { Vector2 } from "three";

// A pointer that moves farther between press and release drags [pixel].
const kDrag = 4;

/** Calls onClick(x, y) with the place of each click on the canvas that does not end a drag [pixel]. */
export function listenForClicks(canvas, onClick) {
  const start = new Vector2();
  canvas.addEventListener("pointerdown", ({ clientX, clientY }) => start.set(clientX, clientY));
  canvas.addEventListener("click", ({ clientX, clientY, offsetX, offsetY }) => {
    if (start.distanceTo(new Vector2(clientX, clientY)) > kDrag) return;
    onClick(offsetX, offsetY);
  });
}
