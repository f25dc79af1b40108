// distant.mjs READER FILE: E / pi at the normals +x -x +y -y +z -z of a glTF scene, as the reader's own code has it.
import { readFileSync } from 'node:fs';
import { fromPackage } from './packages.mjs';

const normals = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];

const readers = {
  async three(text) {
    const THREE = await fromPackage('three/build/three.module.js');
    const probe = new THREE.ObjectLoader().parse(JSON.parse(text));
    if (!probe.isLightProbe) throw new Error('no LightProbe');
    return normals.map((n) => probe.sh.getIrradianceAt(new THREE.Vector3(...n), new THREE.Vector3())
      .multiplyScalar(probe.intensity / Math.PI).toArray());
  },
  // The loader's steps (EXT_lights_image_based.ts), and computeEnvironmentIrradiance() on its pre-scaled harmonics.
  async babylon(text) {
    const { SphericalHarmonics, SphericalPolynomial } =
      await fromPackage('@babylonjs/core/Maths/sphericalPolynomial.js');
    const file = JSON.parse(text);
    const light = file.extensions ? file.extensions.EXT_lights_image_based.lights[0] : file;
    const harmonics = SphericalHarmonics.FromArray(light.irradianceCoefficients);
    harmonics.scaleInPlace(light.intensity ?? 1);
    harmonics.convertIrradianceToLambertianRadiance();
    const s = SphericalPolynomial.FromHarmonics(harmonics).preScaledHarmonics;
    // The root of a glTF scene in a left-handed one: rotation [0 1 0 0] after scaling [1 1 -1].
    return normals.map(([x, y, z]) => [-x, y, z]).map(([x, y, z]) => ['x', 'y', 'z'].map((c) =>
      s.l00[c] + s.l1_1[c] * y + s.l10[c] * z + s.l11[c] * x + s.l2_2[c] * (y * x) + s.l2_1[c] * (y * z) +
      s.l20[c] * (3 * z * z - 1) + s.l21[c] * (z * x) + s.l22[c] * (x * x - y * y)));
  },
};

console.log(JSON.stringify(await readers[process.argv[2]](readFileSync(process.argv[3], 'utf8'))));
