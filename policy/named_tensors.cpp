// SPDX-License-Identifier: BSD-3-Clause
#include "policy/named_tensors.h"

#include <functional>
#include <numeric>
#include <utility>

#include "policy/text.h"

namespace sandrunner {

std::size_t NamedTensor::size() const {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

void add_layer(const std::string& name, int inputs, int outputs, DenseParameters& layer,
               std::vector<NamedTensor>& tensors) {
  const auto rows = static_cast<std::size_t>(outputs);
  tensors.push_back({name + ".weight", {rows, static_cast<std::size_t>(inputs)}, &layer.weight});
  tensors.push_back({name + ".bias", {rows}, &layer.bias});
}

void take_tensors(const std::string& path, const std::vector<NamedTensor>& wanted,
                  std::map<std::string, Tensor>& tensors) {
  for (const NamedTensor& want : wanted) {
    auto node = tensors.extract(want.name);
    if (node.empty()) fail_file(path, "tensor '{}' is missing", want.name);
    if (node.mapped().shape != want.shape) {
      fail_file(path, "tensor '{}' has shape [{}], expected [{}]", want.name,
                printable(joined(node.mapped().shape, ", ")), joined(want.shape, ", "));
    }
    *want.values = std::move(node.mapped().values);
  }
}

void expect_no_tensors(const std::string& path, const std::map<std::string, Tensor>& tensors) {
  if (!tensors.empty()) {
    fail_file(path, "unknown tensor '{}'", printable(tensors.begin()->first));
  }
}

void put_tensors(const std::string& path, const std::vector<NamedTensor>& tensors,
                 TensorFile& content) {
  for (const NamedTensor& tensor : tensors) {
    if (tensor.values->size() != tensor.size()) {
      fail_file(path, "tensor '{}' has {} values, expected {}", tensor.name, tensor.values->size(),
                tensor.size());
    }
    content.tensors[tensor.name] = {tensor.shape, *tensor.values};
  }
}

}  // namespace sandrunner
