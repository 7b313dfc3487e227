// Compresses the geometry of a glTF with other people's encoders.
import draco3d from 'draco3d';
import { MeshoptEncoder } from 'meshoptimizer';

const WIDTHS = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };
const DRACO_TYPES = { POSITION: 'POSITION', NORMAL: 'NORMAL', TEXCOORD_0: 'TEX_COORD', TANGENT: 'GENERIC' };

/** Returns the values of an accessor of a document whose only buffer is `bin`. */
function read(gltf, bin, index) {
  const { bufferView, count, type, componentType } = gltf.accessors[index];
  const { byteOffset = 0 } = gltf.bufferViews[bufferView];
  const Values = { 5123: Uint16Array, 5126: Float32Array }[componentType];
  return new Values(bin.buffer.slice(bin.byteOffset + byteOffset), 0, count * WIDTHS[type]);
}

const embedded = (bytes) => ({
  byteLength: bytes.length,
  uri: `data:application/octet-stream;base64,${Buffer.from(bytes).toString('base64')}`,
});

/** Returns a copy of a document with one mesh whose geometry is compressed by Draco, in KHR_draco_mesh_compression. */
export async function withDraco(gltf, bin) {
  const copy = structuredClone(gltf);
  const draco = await draco3d.createEncoderModule();
  const [encoder, builder, mesh] = [new draco.Encoder(), new draco.MeshBuilder(), new draco.Mesh()];
  const [primitive] = copy.meshes[0].primitives;
  const indices = read(copy, bin, primitive.indices);
  builder.AddFacesToMesh(mesh, indices.length / 3, Uint32Array.from(indices));
  const attributes = {};
  for (const [name, index] of Object.entries(primitive.attributes)) {
    const { count, type } = copy.accessors[index];
    attributes[name] = builder.AddFloatAttributeToMesh(
      mesh,
      draco[DRACO_TYPES[name]],
      count,
      WIDTHS[type],
      read(copy, bin, index),
    );
    delete copy.accessors[index].bufferView;
  }
  delete copy.accessors[primitive.indices].bufferView;
  // The sequential encoding keeps the number and the order of vertices, which the accessors state.
  encoder.SetEncodingMethod(draco.MESH_SEQUENTIAL_ENCODING);
  const out = new draco.DracoInt8Array();
  const length = encoder.EncodeMeshToDracoBuffer(mesh, out);
  const bytes = Uint8Array.from({ length }, (_, i) => out.GetValue(i));
  copy.buffers = [embedded(bytes)];
  copy.bufferViews = [{ buffer: 0, byteLength: length }];
  primitive.extensions = { KHR_draco_mesh_compression: { bufferView: 0, attributes } };
  copy.extensionsUsed = copy.extensionsRequired = ['KHR_draco_mesh_compression'];
  return copy;
}

/** Returns a copy of a document whose buffer views are compressed by meshoptimizer, in EXT_meshopt_compression. */
export async function withMeshopt(gltf, bin) {
  await MeshoptEncoder.ready;
  const copy = structuredClone(gltf);
  let [size, parts] = [0, []];
  for (const accessor of copy.accessors) {
    const view = copy.bufferViews[accessor.bufferView];
    const isIndex = accessor.type === 'SCALAR';
    const mode = isIndex ? 'TRIANGLES' : 'ATTRIBUTES';
    const byteStride = isIndex ? 2 : 4 * WIDTHS[accessor.type];
    const values = new Uint8Array(bin.buffer, bin.byteOffset + (view.byteOffset ?? 0), view.byteLength);
    const bytes = MeshoptEncoder.encodeGltfBuffer(values, accessor.count, byteStride, mode);
    view.buffer = 1;
    view.extensions = {
      EXT_meshopt_compression: {
        buffer: 0,
        byteOffset: size,
        byteLength: bytes.length,
        byteStride,
        count: accessor.count,
        mode,
      },
    };
    parts.push(bytes, new Uint8Array(-bytes.length & 3));
    size += bytes.length + (-bytes.length & 3);
  }
  copy.buffers = [
    embedded(Buffer.concat(parts)),
    { byteLength: bin.length, extensions: { EXT_meshopt_compression: { fallback: true } } },
  ];
  copy.extensionsUsed = copy.extensionsRequired = ['EXT_meshopt_compression'];
  return copy;
}
