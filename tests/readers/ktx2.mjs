// ktx2.mjs FILE: what ktx-parse and three.js' KTX2Loader read: header, notes and the first values.
import { readFileSync } from 'node:fs';
import { fromPackage } from './packages.mjs';

const bytes = new Uint8Array(readFileSync(process.argv[2]));
const { read } = await fromPackage('ktx-parse/dist/index.mjs');
const c = read(bytes);
const out = {
  vkFormat: c.vkFormat, typeSize: c.typeSize, width: c.pixelWidth, height: c.pixelHeight, depth: c.pixelDepth,
  layers: c.layerCount, faces: c.faceCount, levels: c.levels.length, scheme: c.supercompressionScheme,
  samples: c.dataFormatDescriptor[0].samples.length, bytesPlane: c.dataFormatDescriptor[0].bytesPlane[0],
  transfer: c.dataFormatDescriptor[0].transferFunction, primaries: c.dataFormatDescriptor[0].colorPrimaries,
  keys: Object.keys(c.keyValue), writer: c.keyValue.KTXwriter,
  uncompressed: c.levels.map((level) => level.uncompressedByteLength),
};
if (c.faceCount === 1) {
  const { KTX2Loader } = await fromPackage('three/examples/jsm/loaders/KTX2Loader.js');
  const loader = new KTX2Loader();
  loader.workerConfig = {};  // what detectSupport() finds serves Basis textures only
  const texture = await loader._createTexture(bytes.buffer);
  out.three = {
    isData3DTexture: texture.isData3DTexture === true, type: texture.type, width: texture.image.width,
    height: texture.image.height, depth: texture.image.depth, data: Array.from(texture.image.data.slice(0, 64)),
  };
}
console.log(JSON.stringify(out));
