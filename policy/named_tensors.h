// SPDX-License-Identifier: BSD-3-Clause
// A network's numbers by the names that they have in a file.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "policy/safetensors.h"

namespace sandrunner {

/// A dense layer: weight (outputs, inputs) row-major, bias (outputs).
struct DenseParameters {
  std::vector<float> weight;
  std::vector<float> bias;
};

/// One tensor: its name in the policy file, its shape and its values.
struct NamedTensor {
  std::string name;
  std::vector<std::size_t> shape;
  std::vector<float>* values;

  /// Number of values that `shape` asks for.
  std::size_t size() const;
};

/// Adds "<name>.weight" and "<name>.bias".
void add_layer(const std::string& name, int inputs, int outputs, DenseParameters& layer,
               std::vector<NamedTensor>& tensors);

/// Moves each of `wanted` out of the tensors of the file `path`. Throws InputError if one is
/// missing or of another shape.
void take_tensors(const std::string& path, const std::vector<NamedTensor>& wanted,
                  std::map<std::string, Tensor>& tensors);
/// Throws InputError if `tensors` holds one.
void expect_no_tensors(const std::string& path, const std::map<std::string, Tensor>& tensors);
/// Copies each into the content of the file `path`. Throws InputError for one of another size.
void put_tensors(const std::string& path, const std::vector<NamedTensor>& tensors,
                 TensorFile& content);

}  // namespace sandrunner
