// SPDX-License-Identifier: BSD-3-Clause
// node onnx_steps.mjs POLICY.onnx OBSERVATIONS OUT: steps an exported policy with onnxruntime-web (npm), found from the
// folder in NODE_FOLDER. OBSERVATIONS: rows of 33 float32. OUT: a row of 12 joint targets and 8 estimates for each.
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";

const ort = createRequire(process.env.NODE_FOLDER + "/")("onnxruntime-web");
ort.env.wasm.numThreads = 1;
const [model, observations, out] = process.argv.slice(2);
const session = await ort.InferenceSession.create(readFileSync(model));
const bytes = readFileSync(observations);
const rows = new Float32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4);
const answers = new Float32Array((rows.length / 33) * 20);
let [h, c] = [0, 1].map(() => new ort.Tensor("float32", new Float32Array(64), [1, 1, 64]));
for (let k = 0; k < rows.length / 33; ++k) {
  const observation = new ort.Tensor("float32", rows.slice(33 * k, 33 * (k + 1)), [1, 33]);
  const step = await session.run({ observation, h, c });
  answers.set(step.joint_target.data, 20 * k);
  answers.set(step.estimate.data, 20 * k + 12);
  [h, c] = [step.h_out, step.c_out];
}
writeFileSync(out, Buffer.from(answers.buffer));
