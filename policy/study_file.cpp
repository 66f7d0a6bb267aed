// SPDX-License-Identifier: BSD-3-Clause
#include "policy/study_file.h"

#include <cstddef>
#include <utility>
#include <vector>

#include "policy/network_parameters.h"
#include "policy/text.h"
#include "rt/base/config_tree.h"

namespace sandrunner {
namespace {

/// Columns [first, first + count) of a matrix; without a second dimension if that is one column.
Tensor columns_of(const Tensor& matrix, std::size_t first, std::size_t count) {
  const std::size_t rows = matrix.shape[0], columns = matrix.shape[1];
  Tensor part{{rows}, {}};
  if (count > 1) part.shape.push_back(count);
  for (std::size_t row = 0; row < rows; ++row) {
    const float* const begin = &matrix.values[row * columns + first];
    part.values.insert(part.values.end(), begin, begin + count);
  }
  return part;
}

}  // namespace

void renew_study_file(const std::string& path, TensorFile& content) {
  std::string& format = content.metadata.at("sandrunner.format");
  if (format != "study 1") return;
  format = "1";
  const auto config = content.metadata.find("provenance.config");
  if (config == content.metadata.end()) {
    fail_file(path, "metadata key 'provenance.config' is missing, which holds the wiring");
  }
  ConfigTree tree;
  tree.add_text(config->second, "'" + path + "': provenance.config");
  content.metadata["sandrunner.encoder"] = tree.text("network.encoder", "");
  content.metadata["sandrunner.actor"] = tree.text("network.actor", "");

  const auto lstm = content.tensors.find("encoder");
  if (lstm == content.tensors.end()) return;
  const std::vector<std::size_t> shape = {4 * kHiddenSize, kEncoderInputSize + 1 + kHiddenSize};
  if (lstm->second.shape != shape) {
    fail_file(path, "tensor 'encoder' has shape [{}], expected [{}]",
              printable(joined(lstm->second.shape, ", ")), joined(shape, ", "));
  }
  const Tensor matrix = std::move(content.tensors.extract(lstm).mapped());
  content.tensors["encoder.weight_ih"] = columns_of(matrix, 0, kEncoderInputSize);
  content.tensors["encoder.bias_ih"] = columns_of(matrix, kEncoderInputSize, 1);
  content.tensors["encoder.weight_hh"] = columns_of(matrix, kEncoderInputSize + 1, kHiddenSize);
  content.tensors["encoder.bias_hh"] = {{shape[0]}, std::vector<float>(shape[0])};
}

}  // namespace sandrunner
