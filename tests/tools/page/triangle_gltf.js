// A triangle with a texture as glTF, in one file and in three.
"use strict";

const kPositions = Float32Array.of(-1, -1, 0, 1, -1, 0, 0, 1, 0);
const kTextureCoordinates = Float32Array.of(0, 1, 1, 1, 0.5, 0);
const kNumbers = Buffer.concat([kPositions, kTextureCoordinates].map((array) => Buffer.from(array.buffer)));

function json_of(buffer, image, views) {
  return JSON.stringify({
    asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, TEXCOORD_0: 1 }, material: 0 }] }],
    materials: [{ doubleSided: true, pbrMetallicRoughness: { baseColorTexture: { index: 0 }, metallicFactor: 0 } }],
    textures: [{ source: 0 }],
    images: [image],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 3, type: "VEC3", min: [-1, -1, 0], max: [1, 1, 0] },
      { bufferView: 1, componentType: 5126, count: 3, type: "VEC2" },
    ],
    bufferViews: [{ buffer: 0, byteLength: 36 }, { buffer: 0, byteOffset: 36, byteLength: 24 }, ...views],
    buffers: [buffer],
  });
}

const padded = (bytes, with_what) => Buffer.concat([bytes, Buffer.alloc(-bytes.length & 3, with_what)]);

function chunk(name, bytes) {
  const head = Buffer.alloc(8);
  head.writeUInt32LE(bytes.length, 0);
  head.write(name, 4, "latin1");
  return Buffer.concat([head, bytes]);
}

/** {name: bytes} of a .gltf, whose texture is `png`. */
exports.triangle_gltf = (png) => ({
  "triangle.gltf": Buffer.from(json_of({ byteLength: kNumbers.length, uri: "triangle.bin" }, { uri: "base.png" }, [])),
  "triangle.bin": kNumbers,
  "base.png": png,
});

/** The same as one .glb. */
exports.triangle_glb = (png) => {
  const bytes = padded(Buffer.concat([kNumbers, png]), 0);
  const json = json_of({ byteLength: bytes.length }, { bufferView: 2, mimeType: "image/png" },
                       [{ buffer: 0, byteOffset: kNumbers.length, byteLength: png.length }]);
  const chunks = Buffer.concat([chunk("JSON", padded(Buffer.from(json), " ")), chunk("BIN\0", bytes)]);
  const head = Buffer.from("glTF\x02\x00\x00\x00\x00\x00\x00\x00", "latin1");
  head.writeUInt32LE(head.length + chunks.length, 8);
  return Buffer.concat([head, chunks]);
};
