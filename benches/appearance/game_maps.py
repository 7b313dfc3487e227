"""Maps of games that are older than glTF: how they are found, and how they become glTF planes."""

from PIL import Image

import gltf

LEAST, MOST = 128, 1024


def images_of(data, kinds):
    """Returns the images below a folder by their paths in lower case, without the endings, which are `kinds`."""
    found = {}
    for kind in kinds:
        for path in sorted(data.rglob("*.*")):
            if path.suffix.lower() == kind:
                found.setdefault(path.relative_to(data).with_suffix("").as_posix().lower(), path)
    return found


def beside(images, stem, ends):
    """Returns the first image whose path is `stem` with one of the ends; `None` if there is none."""
    return next(filter(None, (images.get(stem + end) for end in ends)), None)


def write_material(target, normals, most_below, gloss, orm_of, colour, **factors):
    """Writes a material to the folder `target`, whose name it gets. The paths of `gloss` and `colour` are `None` where
    the material has none. `orm_of` makes the roughness texture of the map of gloss, in the size of the textures, and
    `factors` are those of `gltf.write_plane`. Returns whether the normals can be used: they are not small, and at most
    the share `most_below` of them points below the surface."""
    normals = Image.open(normals).convert("RGB")
    if min(normals.size) < LEAST or below(normals) > most_below:
        return False
    size = tuple(min(MOST, 1 << (side.bit_length() - 1)) for side in normals.size)
    target.mkdir(parents=True, exist_ok=True)
    images = {"normal": normals.resize(size, Image.Resampling.BOX)}
    if gloss:
        images["orm"] = orm_of(Image.open(gloss).convert("RGB").resize(size))
    if colour:
        images["colour"] = Image.open(colour).convert("RGB").resize(size)
    files = {key: f"{key}.png" for key in images}
    for key, file in files.items():
        images[key].save(target / file)
    gltf.write_plane(target, target.name, files, **factors)
    return True


def below(normals):
    """Returns the share of texels whose normals point below the surface."""
    histogram = normals.getchannel("B").histogram()
    return sum(histogram[:128]) / sum(histogram)
