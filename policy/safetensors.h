// SPDX-License-Identifier: BSD-3-Clause
// Reader and writer of the safetensors container (https://github.com/huggingface/safetensors,
// "Format"), for tensors of float32 only: 8 bytes of header length (little-endian), a JSON header,
// the data.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace sandrunner {

/// Dense float32 tensor, row-major.
struct Tensor {
  std::vector<std::size_t> shape;
  std::vector<float> values;
};

/// Content of a safetensors file.
struct TensorFile {
  std::map<std::string, std::string> metadata;
  std::map<std::string, Tensor> tensors;
};

/// Reads a whole file. Throws InputError, naming the file and the tensor, for anything that is not
/// a well-formed file of finite float32 tensors that fill the data area without gap or overlap.
TensorFile read_safetensors(const std::string& path);

/// The same from memory; `name` stands for the file in errors.
TensorFile parse_safetensors(std::string_view bytes, const std::string& name);

/// Afterwards the file is whole, or as it was and InputError is thrown: it cannot be written, or a
/// tensor is malformed.
void write_safetensors(const std::string& path, const TensorFile& file);

}  // namespace sandrunner
