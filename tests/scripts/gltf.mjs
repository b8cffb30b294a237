// Holds animated glTF files against the validator of the Khronos Group: no error, no warning, no hint.
//
//     npm install --prefix FOLDER gltf-validator@2.0.0-dev.3.10
//     node tests/scripts/gltf.mjs FOLDER FILE.glb …

import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join, resolve } from 'node:path';

const [folder, ...files] = process.argv.slice(2);
const require = createRequire(join(resolve(folder), 'node_modules', 'any.js'));
const { validateBytes } = require('gltf-validator');

const wrong = [];
for (const file of files) {
  const { issues, info } = await validateBytes(new Uint8Array(readFileSync(file)));
  for (const { code, message, pointer } of issues.messages) wrong.push(`${file}: ${code} at ${pointer}: ${message}`);
  if (info.animationCount !== 1) wrong.push(`${file}: ${info.animationCount} animations, not one`);
}
console.log(`${files.length} files of glTF`);
if (!files.length) wrong.push('no file was given');
if (wrong.length) {
  console.error(wrong.slice(0, 60).join('\n'));
  process.exit(1);
}
