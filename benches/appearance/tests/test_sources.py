"""Materials that are written for other programs."""

import json

import numpy as np

import gltf
import sources


def test_materials_are_folders_with_a_document(tmp_path):
    data = tmp_path / "data"
    gltf.save(make(data / "maps") / "mail_normal.png", np.full((4, 4, 3), 0.5))
    gltf.write_plane(make(data / "materials" / "slate"), "slate", {"normal": "n.png"})
    sources.write(tmp_path / "out", 32, data)
    names = [folder.name for folder in (tmp_path / "out").iterdir()]
    assert {"mail", "slate", "gravel", "knurled"} <= set(names)
    for name in names:
        document = json.loads((tmp_path / "out" / name / f"{name}.gltf").read_text())
        assert document["materials"][0]["name"] == name


def make(folder):
    """Makes a folder and returns it."""
    folder.mkdir(parents=True)
    return folder
