// How many texels of a normal map lie on a surface, and in a pixel.
import { Triangle, Vector2 } from 'three';

/** Returns the name that three.js gives to a set of texture coordinates. */
const attribute = (channel) => (channel ? `uv${channel}` : 'uv');

/** Returns the areas of the triangles of a mesh: [in square units, in texels of its normal map]. */
function areas({ geometry, material, matrixWorld }) {
  const { channel, repeat, image } = material.normalMap;
  const { position, [attribute(channel)]: uv } = geometry.attributes;
  const texels = new Vector2(image.width, image.height).multiply(repeat);
  const [inSpace, inMap] = [new Triangle(), new Triangle()];
  const corners = ['a', 'b', 'c'];
  const { index } = geometry;
  const sums = [0, 0];
  for (let first = 0; first < (index ?? position).count; first += 3) {
    for (const [i, corner] of corners.entries()) {
      const at = index ? index.getX(first + i) : first + i;
      inSpace[corner].fromBufferAttribute(position, at).applyMatrix4(matrixWorld);
      inMap[corner].set(uv.getX(at) * texels.x, uv.getY(at) * texels.y, 0);
    }
    sums[0] += inSpace.getArea();
    sums[1] += inMap.getArea();
  }
  return sums;
}

/** Returns the mean number of texels along a unit of the surfaces that have a normal map, or 0 if there are none. */
export function texelsPerUnit(object) {
  let [units, texels] = [0, 0];
  object.updateWorldMatrix(true, true);
  object.traverse((mesh) => {
    const { channel } = mesh.material?.normalMap ?? {};
    if (channel === undefined || !mesh.geometry.attributes[attribute(channel)]) return;
    const [inSpace, inMap] = areas(mesh);
    [units, texels] = [units + inSpace, texels + inMap];
  });
  return units > 0 ? Math.sqrt(texels / units) : 0;
}

/** Returns the sentence on the texels that a pixel covers along each side, or nothing if that is not known. */
export function footprint(texels) {
  const side = texels.toFixed(texels < 10 ? 1 : 0);
  return texels > 0 ? `A pixel covers about ${side} x ${side} texels.` : '';
}
