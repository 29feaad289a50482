import { Color, Group, Mesh, Sphere, Vector2, Vector3 } from "three";

import { element } from "../dom.js";
import { foundMaterial, freeMaterials, kSelectedOutline } from "./materials.js";
import { outlineMaterial } from "./picture.js";

function posed(mesh, world) {
  mesh.matrixAutoUpdate = false;
  mesh.matrix.copy(world);
  return mesh;
}

function cornersOf({ min, max }, matrix) {
  const corner = (k) =>
    new Vector3(k & 1 ? max.x : min.x, k & 2 ? max.y : min.y, k & 4 ? max.z : min.z);
  return [0, 1, 2, 3, 4, 5, 6, 7].map((k) => corner(k).applyMatrix4(matrix));
}

function makeMark({ kind, label, color }) {
  const mark = element("span", { className: `mark ${kind}` }, label);
  mark.style.setProperty("--ink", color ?? "");
  return mark;
}

/**
 * The models posed in a scan, with their outlines and their marks.
 *
 * A thing is { id, kind, mesh, outline, mark, center, place: of the mark, radius, color, corners,
 * matrix }; only what was found has a mesh.
 */
export class PosedThings {
  #outlined;
  #marks;
  #found = new Group();
  #things = [];

  /** solid, outlined  scenes; marks  the element of the marks */
  constructor(solid, outlined, marks) {
    this.#outlined = outlined;
    this.#marks = marks;
    solid.add(this.#found);
  }

  get all() {
    return this.#things;
  }

  /** The thing with this id, or undefined. */
  find(id) {
    return this.#things.find((thing) => thing.id === id);
  }

  /**
   * Replaces the things.
   *
   * things   [{ id, kind: "found", "rejected" or "why", geometry, pose: Matrix4 from the geometry's
   *          points to the scan's frame, color, label, alternatives: other such poses }]
   * toWorld  Matrix4 from the scan's frame
   */
  set(things, toWorld) {
    freeMaterials(this.#found);
    for (const { outline } of this.#things) freeMaterials(outline);
    this.#found.clear();
    this.#outlined.clear();
    for (const { mark } of this.#things) mark.remove();
    this.#things = things.map((thing, k) => this.#make(thing, k, toWorld));
  }

  #make(thing, index, toWorld) {
    const isFound = thing.kind === "found";
    const matrix = toWorld.clone().multiply(thing.pose);
    const outline = this.#makeOutline(thing, index, toWorld);
    let mesh = null;
    if (isFound) {
      mesh = posed(new Mesh(thing.geometry, foundMaterial()), matrix);
      mesh.userData.id = thing.id;
      this.#found.add(mesh);
    }
    const sphere = new Sphere().copy(thing.geometry.boundingSphere).applyMatrix4(matrix);
    const mark = makeMark(thing);
    this.#marks.append(mark);
    return {
      ...thing,
      corners: isFound ? cornersOf(thing.geometry.boundingBox, matrix) : [],
      matrix,
      outline,
      mesh,
      mark,
      center: sphere.center,
      place: sphere.center,
      radius: sphere.radius,
    };
  }

  #makeOutline(thing, index, toWorld) {
    const outline = new Group();
    const add = (pose, id) => {
      const mesh = new Mesh(thing.geometry, outlineMaterial(id, new Color()));
      outline.add(posed(mesh, toWorld.clone().multiply(pose)));
    };
    add(thing.pose, thing.kind === "found" ? kSelectedOutline : index + 2);
    for (const alternative of thing.alternatives ?? []) add(alternative, index + 2);
    this.#outlined.add(outline);
    return outline;
  }

  /** Colors the things; with a selected id, all others fade. */
  paint(colors, selected) {
    for (const thing of this.#things) {
      const fades = selected !== null && thing.id !== selected;
      thing.mesh?.material.color.set(thing.color ?? 0).lerp(colors.scan, fades ? 0.6 : 0);
      const ink = thing.id === selected ? colors.selected : colors.rejected;
      for (const { material } of thing.outline.children) {
        material.uniforms.color.value.copy(ink).lerp(colors.scan, fades ? 0.5 : 0);
      }
    }
  }

  /**
   * Shows and hides the things, their outlines and their marks.
   *
   * isShown(thing)  whether any of it is visible
   * looks           { selected: an id; traced: ids of things whose outlines alone are drawn, with any
   *                 no thing is solid; hasRays: whether rays of the selected thing are shown; planes:
   *                 of the section }
   */
  arrange(isShown, { selected, traced, hasRays, planes }) {
    for (const thing of this.#things) {
      const shown = isShown(thing);
      const isSelected = thing.id === selected;
      const isOutline = thing.kind === "rejected" || isSelected || traced.has(thing.id);
      const isHollow = traced.size || (hasRays && isSelected);
      if (thing.mesh) thing.mesh.visible = shown && !isHollow;
      thing.outline.visible = shown && isOutline;
      for (const { material } of [thing.mesh, ...thing.outline.children].filter(Boolean)) {
        material.clippingPlanes = planes;
      }
      thing.mark.hidden = !shown;
      thing.mark.classList.toggle("selected", isSelected);
    }
  }

  /** The visible thing that a point of the canvas shows, by its id; null: none. */
  idAt(pointer, camera, caster, isVisible) {
    caster.setFromCamera(new Vector2(...pointer), camera);
    const meshes = this.#things.filter(isVisible.thing).flatMap(({ mesh }) => mesh ?? []);
    const hit = caster
      .intersectObjects(meshes, false)
      .find(({ point }) => isVisible.place(point));
    return hit ? hit.object.userData.id : null;
  }

  /** Moves the marks to their places in a canvas of this size. */
  placeMarks(camera, width, height) {
    for (const { mark, place } of this.#things) {
      if (mark.hidden) continue;
      const seen = place.clone().project(camera);
      const x = (((seen.x + 1) / 2) * width).toFixed(1);
      const y = (((1 - seen.y) / 2) * height).toFixed(1);
      mark.style.visibility = Math.abs(seen.z) < 1 ? "visible" : "hidden";
      mark.style.transform = `translate(${x}px, ${y}px) translate(-50%, -50%)`;
    }
  }
}
