// Calls a function of the module: node call.mjs MODULE FUNCTION <INPUT.json >OUTPUT.json
import { readFileSync, writeSync } from "node:fs";

const { instance } = await WebAssembly.instantiate(readFileSync(process.argv[2]), {});
const { put, get, [process.argv[3]]: call } = instance.exports;
for (const byte of readFileSync(0)) put(byte);
const output = Buffer.alloc(call());
for (let at = 0; at < output.length; at++) output[at] = get(at);
for (let at = 0; at < output.length; ) at += writeSync(1, output, at);
