// Divides scene files by the grammar that `mbd grammar` prints, with the tokenizer of Visual Studio Code, and says what has no scope or the wrong one.
//
//     npm install --prefix FOLDER vscode-textmate@9.3.2 vscode-oniguruma@2.0.1
//     node tests/scripts/grammar.mjs FOLDER target/debug/mbd [FILE …]
//
// Without files: the ready scenes, as `mbd convert NAME --to mbd` writes them, and the scene files of the repository.

import { execFileSync } from 'node:child_process';
import { readFileSync, readdirSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const [folder, program, ...files] = process.argv.slice(2);
const require = createRequire(join(resolve(folder), 'node_modules', 'any.js'));
const { Registry, INITIAL, parseRawGrammar } = require('vscode-textmate');
const oniguruma = require('vscode-oniguruma');

const mbd = (...words) => execFileSync(program, words, { encoding: 'utf8' });
await oniguruma.loadWASM(readFileSync(require.resolve('vscode-oniguruma/release/onig.wasm')).buffer);
const registry = new Registry({
  onigLib: Promise.resolve({
    createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
    createOnigString: (text) => new oniguruma.OnigString(text),
  }),
  loadGrammar: async () => parseRawGrammar(mbd('grammar'), 'mbd.tmLanguage.json'),
});
const grammar = await registry.loadGrammar('source.mbd');

/** Every token of a text that is not blank: its text, its innermost scope, its line. */
function tokens(text) {
  const found = [];
  let stack = INITIAL;
  text.split('\n').forEach((line, number) => {
    const divided = grammar.tokenizeLine(line, stack);
    stack = divided.ruleStack;
    for (const { startIndex, endIndex, scopes } of divided.tokens) {
      const [part, scope, before] = [line.slice(startIndex, endIndex), scopes[scopes.length - 1], found[found.length - 1]];
      // A string is divided at its quotes.
      if (before && before.line === number + 1 && before.end === startIndex && scope === before.scope && scope.startsWith('string')) before.part += part;
      else if (part.trim()) found.push({ part, scope, line: number + 1 });
      if (found.length) found[found.length - 1].end = endIndex;
    }
  });
  return found;
}

const wrong = [];
const expect = (holds, what) => { if (!holds) wrong.push(what); };

/** What stands for each kind of word in one text. */
const SAMPLE = `/// A model.
pub model Sample<T> {
    gravity: [0.0, 0.0, -9.81] m/s^2; // down
    /* a /* nested */ comment */
    const L = 1.5e-3 km;
    param k = 5 kN/m in 1 kN/m ..= 10 kN/m;
    body link[i in 0..2] { mass: 2 kg, shape: capsule { radius: 5 cm, length: 1 m }, frame tip at [0, 0, L] m rotated rpy(90 deg, 0, 0) }
    joint pin: hinge from world to link[0].tip { axis: y, start: 30 deg }
    load push on link[0] = [sin(2 rad/s * time) * 1 N, 0, 0];
    event low = link[0].com.position.z falls 0 m { then: scene "next.mbd" }
    smooth table rho = { 0 km: 1 kg/m^3, 1 km: 2 kg/m^3 };
    input wind: m/s = 2 m/s;
    output turn = pin.angle in deg;
}

[run]
until = "2 s" # the end
tolerance = 1e-8

[run.start]
pin.angle = "10 deg"
`;
const sample = tokens(SAMPLE);
/** The scope of a part on the line that begins so. */
const scope = (line, part) => {
  const number = SAMPLE.split('\n').findIndex((text) => text.trim().startsWith(line)) + 1;
  const token = sample.find((token) => token.line === number && token.part.trim() === part);
  return token ? token.scope : `no token \`${part}\``;
};
for (const [line, part, wanted] of [
  ['/// A', '/// A model.', 'comment.line.documentation.mbd'],
  ['pub', 'pub', 'storage.type.mbd'],
  ['pub', 'Sample', 'entity.name.type.mbd'],
  ['gravity', 'gravity', 'keyword.declaration.mbd'],
  ['gravity', '9.81', 'constant.numeric.mbd'],
  ['gravity', 'm/s^2', 'keyword.other.unit.mbd'],
  ['gravity', '// down', 'comment.line.double-slash.mbd'],
  ['/* a', 'comment', 'comment.block.mbd'],
  ['const', 'L', 'entity.name.variable.mbd'],
  ['const', '1.5e-3', 'constant.numeric.mbd'],
  ['const', 'km', 'keyword.other.unit.mbd'],
  ['param', 'kN/m', 'keyword.other.unit.mbd'],
  ['param', 'in', 'keyword.control.mbd'],
  ['param', '..=', 'keyword.operator.mbd'],
  ['body', 'body', 'keyword.declaration.mbd'],
  ['body', 'link', 'entity.name.variable.mbd'],
  ['body', 'mass', 'variable.parameter.mbd'],
  ['body', 'capsule', 'support.type.mbd'],
  ['body', 'tip', 'entity.name.variable.mbd'],
  ['body', 'at', 'keyword.control.mbd'],
  ['body', 'rotated', 'keyword.control.mbd'],
  ['body', 'rpy', 'support.function.mbd'],
  ['joint', 'pin', 'entity.name.variable.mbd'],
  ['joint', 'hinge', 'support.type.mbd'],
  ['joint', 'world', 'constant.language.mbd'],
  ['joint', 'start', 'variable.parameter.mbd'],
  ['joint', 'y', 'variable.other.mbd'],
  ['load', 'on', 'keyword.control.mbd'],
  ['load', 'sin', 'support.function.mbd'],
  ['load', 'time', 'constant.language.mbd'],
  ['event', 'falls', 'keyword.control.mbd'],
  ['event', '"next.mbd"', 'string.quoted.double.mbd'],
  ['smooth', 'smooth', 'keyword.declaration.mbd'],
  ['smooth', 'rho', 'entity.name.variable.mbd'],
  ['input', 'm/s', 'keyword.other.unit.mbd'],
  ['output', 'angle', 'variable.other.property.mbd'],
  ['output', 'deg', 'keyword.other.unit.mbd'],
  ['[run]', '[run]', 'entity.name.section.mbd'],
  ['until', 'until', 'variable.other.key.mbd'],
  ['until', '"2 s"', 'string.quoted.double.mbd'],
  ['until', '# the end', 'comment.line.number-sign.mbd'],
  ['tolerance', '1e-8', 'constant.numeric.mbd'],
  ['[run.start]', '[run.start]', 'entity.name.section.mbd'],
  ['pin.angle', 'pin.angle', 'variable.other.key.mbd'],
]) expect(scope(line, part) === wanted, `\`${part}\` in \`${line}…\` is ${scope(line, part)}, not ${wanted}`);

// Nothing of a scene is without a scope of its own.
const root = join(dirname(fileURLToPath(import.meta.url)), '..', '..');
const texts = files.map((file) => [file, readFileSync(file, 'utf8')]);
if (!files.length) {
  for (const { name } of JSON.parse(mbd('list', '--json'))) texts.push([name, mbd('convert', name, '--to', 'mbd')]);
  const scenes = join(root, 'models', 'scenes');
  for (const file of readdirSync(scenes).filter((name) => name.endsWith('.mbd'))) texts.push([file, readFileSync(join(scenes, file), 'utf8')]);
}
let count = 0;
for (const [name, text] of texts) {
  for (const { part, scope, line } of tokens(text)) {
    count += 1;
    expect(scope !== 'source.mbd', `${name}:${line}: \`${part.trim()}\` has no scope`);
  }
}
console.log(`${texts.length} scenes, ${count} tokens`);
if (wrong.length) {
  console.error(wrong.slice(0, 60).join('\n'));
  process.exit(1);
}
