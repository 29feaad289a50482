import { DoubleSide, MeshLambertMaterial } from "three";

/** The outline of this id leaves the solid thing inside as it is: see outlineMaterial. */
export const kSelectedOutline = 1;

export const foundMaterial = () => new MeshLambertMaterial({ flatShading: true, side: DoubleSide });

/** Frees the GPU resources of a mesh, except geometries, which `Meshes` keeps. */
export const freeMaterials = (group) => group.traverse((thing) => thing.material?.dispose());
