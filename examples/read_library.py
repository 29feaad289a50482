#!/usr/bin/env python3
"""Read a model library without Trivet, and check it. Needs h5py, numpy and xxhash.

usage: read_library.py LIBRARY.h5      a row a model; ends with 65 where the file is damaged
"""
import argparse
import sys
from dataclasses import dataclass, field

import h5py
import numpy as np
import xxhash

from point_pairs import Quantization

DAMAGED, MISSING = 65, 66  # exit codes, as those of trivet


class LibraryError(Exception):
    """The file breaks the format of docs/format.md; the message names the object."""


@dataclass(frozen=True)
class PairTable:
    """The point pairs of a model by their feature. Lengths in the library's unit."""
    points: np.ndarray  # [n, 3]
    normals: np.ndarray  # [n, 3], unit vectors
    offsets: np.ndarray  # [cells + 1]: where the entries of a cell begin
    entries: np.ndarray  # [pairs, 2]: reference (a row of points), turn in 1/65536 of a full one
    quantization: Quantization
    num_references: int  # pairs begin at points below it


@dataclass(frozen=True)
class Model:
    """A trained model. Lengths in the library's unit, frame of the model's source."""
    name: str
    diameter: float
    centre: np.ndarray  # [3]
    sample_spacing: float
    vertices: np.ndarray  # [n, 3]
    triangles: np.ndarray  # [n, 3], rows of vertices
    samples: np.ndarray  # [n, 3], evenly over the visible surface
    sample_normals: np.ndarray  # [n, 3], outward unit vectors
    sample_views: np.ndarray  # [n, 4], one bit for each of 256 directions
    symmetry_axis: tuple[np.ndarray, np.ndarray] | None  # unit direction [3], a point [3]
    symmetry_poses: np.ndarray  # [n, 4, 4], without the identity
    pairs: PairTable
    num_features: int  # Tri-Spin-Images at all scales


@dataclass(frozen=True)
class Library:
    unit: str  # unit of all lengths: m or mm
    producer: str
    models: dict[str, Model] = field(default_factory=dict)


def _field(name: str, data: bytes) -> bytes:
    return name.encode() + b"\0" + len(data).to_bytes(8, "little") + data


def digest(found: h5py.Group | h5py.Dataset) -> str:
    """XXH3-128 of names, types, shapes and attributes of an object and of all below it."""
    text = b""
    for name in sorted(found.attrs):
        if name != "checksum":
            size = h5py.h5a.open(found.id, name.encode()).dtype.itemsize
            text += _field(name, np.asarray(found.attrs[name]).tobytes().ljust(size, b"\0"))
    if isinstance(found, h5py.Dataset):
        text += _field("/type", found.dtype.name.encode())
        text += _field("/shape", b"".join(n.to_bytes(8, "little") for n in found.shape))
    else:
        for name in sorted(found):
            text += _field("/" + name, digest(found[name]).encode())
    return xxhash.xxh3_128_hexdigest(text)


def _expect(what: str, expected: str, found: str) -> None:
    if found != expected:
        raise LibraryError(f"{what}: expected checksum {expected}, found {found}")


def check_checksums(file: h5py.File) -> int:
    """Check every dataset and all that describes them; returns the number of datasets.

    Raises LibraryError, which names the first wrong one.
    """
    datasets: list[h5py.Dataset] = []
    file.visititems(lambda _, found: datasets.append(found) if isinstance(found, h5py.Dataset)
                    else None)
    for found in datasets:
        _expect(found.name, text(found, "xxh3_128"), xxhash.xxh3_128_hexdigest(found[()].tobytes()))
    _expect("/@checksum", text(file, "checksum"), digest(file))
    if "directory" in file:
        _expect("/directory@models_digest", text(file["directory"], "models_digest"),
                digest(file["models"]))
    return len(datasets)


def text(found: h5py.HLObject, name: str) -> str:
    """An attribute, without its padding."""
    if name not in found.attrs:
        raise LibraryError(f"{found.name}@{name}: expected this attribute, found none")
    return bytes(found.attrs[name]).rstrip(b"\0").decode()


def _read_model(name: str, group: h5py.Group) -> Model:
    attributes, table = group.attrs, group["ppf"]
    direction = attributes["symmetry_axis_direction"]
    return Model(
        name=name,
        diameter=float(attributes["diameter"]),
        centre=attributes["centre"],
        sample_spacing=float(attributes["sample_spacing"]),
        vertices=group["vertices"][()].T,
        triangles=group["triangles"][()].T,
        samples=group["samples"][()].T,
        sample_normals=group["sample_normals"][()].T,
        sample_views=group["sample_views"][()],
        symmetry_axis=(direction, attributes["symmetry_axis_point"]) if direction.any() else None,
        symmetry_poses=group["symmetry_poses"][()],
        pairs=PairTable(
            points=table["points"][()].T,
            normals=table["normals"][()].T,
            offsets=table["offsets"][()],
            entries=table["entries"][()],
            quantization=Quantization(float(table.attrs["distance_step"]),
                                      int(table.attrs["num_distance_bins"]),
                                      int(table.attrs["num_angle_bins"])),
            num_references=int(table.attrs["num_references"])),
        num_features=sum(len(group[scale]["features"])
                         for scale in ("trisi", "trisi_2x", "trisi_4x") if scale in group))


def read_library(path: str) -> Library:
    """Open a library, check all of its checksums, and take its models as plain arrays.

    Raises FileNotFoundError, or LibraryError where the file is none or is damaged.
    """
    try:
        with h5py.File(path) as file:
            if "format" not in file.attrs or text(file, "format") != "trivet-library":
                raise LibraryError("/@format: expected trivet-library")
            if (major := int(file.attrs["format_version_major"])) != 1:
                raise LibraryError(f"written by {text(file, 'producer')}: expected version 1 of "
                                   f"the format, found {major}")
            check_checksums(file)
            models = {name: _read_model(name, group) for name, group in file["models"].items()}
            return Library(text(file, "length_unit"), text(file, "producer"), models)
    except FileNotFoundError:
        raise
    except (KeyError, OSError, RuntimeError) as error:  # HDF5 itself found damage
        raise LibraryError(str(error)) from error


def symmetries(model: Model) -> str:
    names = ["axis"] if model.symmetry_axis else []
    names += [str(len(model.symmetry_poses))] if len(model.symmetry_poses) else []
    return " + ".join(names) or "none"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("library")
    path = parser.parse_args().library
    try:
        library = read_library(path)
    except FileNotFoundError:
        print(f"error: {path}: no such file", file=sys.stderr)
        return MISSING
    except LibraryError as error:
        print(f"error: {path}: {error}", file=sys.stderr)
        return DAMAGED
    print(f"{'model':24} {'vertices':>8} {'samples':>8} {'pairs':>9} {'features':>8} "
          f"{'diameter':>10} {'symmetries':>10}")
    for name, model in library.models.items():
        print(f"{name:24} {len(model.vertices):8} {len(model.samples):8} "
              f"{len(model.pairs.entries):9} {model.num_features:8} "
              f"{model.diameter:7.5g} {library.unit:2} {symmetries(model):>10}")
    print(f"{len(library.models)} models by {library.producer}; all checksums are right")
    return 0


if __name__ == "__main__":
    sys.exit(main())
