// probe_grid.mjs MODULE FILE: the probes that three.js has after the module of ivory export has loaded the file: where
// each stands, and its irradiance at one normal.
import { readFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { fromPackage } from './packages.mjs';

const THREE = await fromPackage('three/build/three.module.js');
const { KTX2Loader } = await fromPackage('three/examples/jsm/loaders/KTX2Loader.js');
const { LightProbeGridWebGL } = await fromPackage('three/examples/jsm/lighting/LightProbeGridWebGL.js');
const { makeProbeGrid } = await import(pathToFileURL(process.argv[2]));

const loader = new KTX2Loader();
loader.workerConfig = {};  // what detectSupport() finds serves Basis textures only
const grid = makeProbeGrid(await loader._createTexture(new Uint8Array(readFileSync(process.argv[3])).buffer),
  LightProbeGridWebGL);

const { x: nx, y: ny, z: nz } = grid.resolution;
const { data, width, height } = grid.texture.image;
const number = (x, y, z, c) => {
  const value = data[4 * ((z * height + y) * width + x) + c];
  return data instanceof Uint16Array ? THREE.DataUtils.fromHalfFloat(value) : value;
};
const n = new THREE.Vector3(0.48, 0.64, -0.6);
const probes = [];
for (let k = 0; k < nz; k++) for (let j = 0; j < ny; j++) for (let i = 0; i < nx; i++) {
  const sh = new THREE.SphericalHarmonics3();
  const numbers = [];
  for (let t = 0; t < 7; t++) for (let c = 0; c < 4; c++) numbers.push(number(i, j, t * (nz + 2) + 1 + k, c));
  sh.fromArray(numbers);
  probes.push({
    position: grid.getProbePosition(i, j, k, new THREE.Vector3()).toArray(),
    e: sh.getIrradianceAt(n, new THREE.Vector3()).toArray(),
  });
}
console.log(JSON.stringify({ probes, filter: grid.texture.minFilter }));
