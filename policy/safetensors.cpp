// SPDX-License-Identifier: BSD-3-Clause
#include "policy/safetensors.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "policy/text.h"
#include "rt/base/input_file.h"
#include "rt/base/output_files.h"

namespace sandrunner {
namespace {

static_assert(std::endian::native == std::endian::little, "the format is little-endian");

using Json = nlohmann::json;
constexpr std::size_t kLengthBytes = 8;
// A policy's header has some kilobytes; each value is held by an object of the parser.
constexpr std::size_t kMaxHeaderBytes = std::size_t{1} << 20;
constexpr int kMaxHeaderDepth = 3;  // of the sizes in "shape": header, tensor, array
// The parser looks through all siblings of an object when that ends: its time is the square of
// their number.
constexpr std::size_t kMaxKeys = 1000;  // of an object
constexpr int kMaxObjects = 2;          // in each other: the header, a tensor

/// Parses the header; a key that occurs twice in one object is an error, and so is deeper nesting
/// than the format has, or more than a policy has.
Json parse_header(const std::string& path, std::string_view text) {
  std::vector<std::set<std::string>> open_objects;
  const auto watch_keys = [&](int depth, Json::parse_event_t event, Json& parsed) {
    if (depth > kMaxHeaderDepth) {
      fail_file(path, "header is nested more than {} deep", kMaxHeaderDepth);
    }
    if (event == Json::parse_event_t::object_start) {
      if (depth >= kMaxObjects) {
        fail_file(path, "header has objects nested more than {} deep", kMaxObjects);
      }
      open_objects.emplace_back();
    } else if (event == Json::parse_event_t::object_end) {
      open_objects.pop_back();
    } else if (event == Json::parse_event_t::key) {
      const auto key = parsed.get<std::string>();
      if (!open_objects.back().insert(key).second) {
        fail_file(path, "header has the key '{}' twice", printable(key));
      }
      if (open_objects.back().size() > kMaxKeys) {
        fail_file(path, "header has an object with more than {} keys", kMaxKeys);
      }
    }
    return true;
  };
  try {
    return Json::parse(text.begin(), text.end(), watch_keys);
  } catch (const Json::parse_error& error) {
    fail_file(path, "header is not valid JSON at byte {}", error.byte);
  } catch (const Json::exception&) {
    fail_file(path, "header is not valid JSON: a number is too large");
  }
}

struct TensorEntry {
  std::string name;
  std::vector<std::size_t> shape;
  std::size_t begin = 0;
  std::size_t end = 0;
};

std::vector<std::size_t> read_sizes(const std::string& path, const std::string& tensor,
                                    const char* key, const Json& json) {
  if (!json.is_array() || !std::all_of(json.begin(), json.end(),
                                       [](const Json& n) { return n.is_number_unsigned(); })) {
    fail_file(path, "tensor '{}': {} is not an array of natural numbers", tensor, key);
  }
  return json.get<std::vector<std::size_t>>();
}

TensorEntry read_entry(const std::string& path, const std::string& name, const Json& json,
                       std::size_t data_bytes) {
  const std::string tensor = printable(name);
  if (!json.is_object()) fail_file(path, "tensor '{}': header entry is not an object", tensor);
  for (const char* key : {"dtype", "shape", "data_offsets"}) {
    if (!json.contains(key)) fail_file(path, "tensor '{}': {} is missing", tensor, key);
  }
  if (json.size() != 3) {
    fail_file(path, "tensor '{}': header entry has {} keys, expected dtype, shape, data_offsets",
              tensor, json.size());
  }
  const Json& dtype = json["dtype"];
  if (dtype != "F32") {
    fail_file(path, "tensor '{}': dtype is {}, expected F32", tensor,
              dtype.is_string() ? printable(dtype.get<std::string>()) : "not a string");
  }
  const auto offsets = read_sizes(path, tensor, "data_offsets", json["data_offsets"]);
  if (offsets.size() != 2 || offsets[0] > offsets[1] || offsets[1] > data_bytes) {
    fail_file(path, "tensor '{}': data_offsets do not lie in the {} bytes of data", tensor,
              data_bytes);
  }
  TensorEntry entry{name, read_sizes(path, tensor, "shape", json["shape"]), offsets[0], offsets[1]};
  const std::size_t bytes = entry.end - entry.begin;
  std::size_t values = 1;
  for (const std::size_t n : entry.shape) {
    // The limit keeps the product from overflowing.
    values = n == 0 || values <= data_bytes / n ? values * n : data_bytes + 1;
  }
  if (bytes != sizeof(float) * values) {
    fail_file(path, "tensor '{}': {} bytes of data do not fit the shape [{}]", tensor, bytes,
              printable(joined(entry.shape, ", ")));
  }
  return entry;
}

void check_finite(const std::string& path, const std::string& name, const Tensor& tensor) {
  const auto bad = std::find_if(tensor.values.begin(), tensor.values.end(),
                                [](float value) { return !std::isfinite(value); });
  if (bad != tensor.values.end()) {
    fail_file(path, "tensor '{}': value {} is not finite", printable(name),
              bad - tensor.values.begin());
  }
}

std::map<std::string, std::string> read_metadata(const std::string& path, const Json& json) {
  std::map<std::string, std::string> metadata;
  if (!json.is_object()) fail_file(path, "__metadata__ is not an object");
  for (const auto& [key, value] : json.items()) {
    if (!value.is_string()) {
      fail_file(path, "__metadata__ '{}' is not a string", printable(key));
    }
    metadata[key] = value.get<std::string>();
  }
  return metadata;
}

// What a file is that people take for a policy; empty: nothing that is known.
std::string_view kind_of(std::string_view bytes) {
  constexpr std::pair<std::string_view, std::string_view> kKinds[] = {
      {"PK\x03\x04", "a zip archive (a checkpoint of PyTorch, or .npz)"},
      {"\x80\x02", "a pickle (an old checkpoint of PyTorch)"},
      {"\x93NUMPY", "an array of numpy"},
      {"\x89HDF", "an HDF5 file"},
      {"\x89MCAP", "a recording"},
      {"\x08", "an ONNX file"},
      {"<", "XML"},
      {"{", "JSON"},
  };
  for (const auto& [begin, kind] : kKinds) {
    // The length of a header of eight bytes begins like some of them, and is followed by zeros.
    if (bytes.starts_with(begin) && !bytes.substr(3).starts_with(std::string_view("\0\0\0", 3))) {
      return kind;
    }
  }
  const bool is_text = std::ranges::all_of(bytes.substr(0, 64), [](unsigned char c) {
    return (c >= ' ' && c < 127) || c == '\n' || c == '\r' || c == '\t';
  });
  return is_text ? "text" : "";
}

}  // namespace

TensorFile read_safetensors(const std::string& path) {
  return parse_safetensors(read_input_file(path, "a policy file"), path);
}

TensorFile parse_safetensors(std::string_view bytes, const std::string& path) {
  std::uint64_t header_bytes = 0;
  if (bytes.size() < kLengthBytes) {
    fail_file(path, "{} bytes are too few for a safetensors file", bytes.size());
  }
  std::memcpy(&header_bytes, bytes.data(), kLengthBytes);
  if (header_bytes > bytes.size() - kLengthBytes) {
    if (const std::string_view kind = kind_of(bytes); !kind.empty()) {
      fail_file(
          path,
          "found {}, expected a policy file (safetensors); tools/policy/README.md says how to "
          "convert one",
          kind);
    }
    fail_file(
        path,
        "is not a safetensors file, or is cut short: found a header of {} bytes in a file of {}",
        header_bytes, bytes.size());
  }
  if (header_bytes > kMaxHeaderBytes) {
    fail_file(path, "a header of {} bytes, expected at most {}", header_bytes, kMaxHeaderBytes);
  }
  const std::string_view data = bytes.substr(kLengthBytes + header_bytes);
  const Json header = parse_header(path, bytes.substr(kLengthBytes, header_bytes));
  if (!header.is_object()) fail_file(path, "header is not a JSON object");

  TensorFile file;
  std::vector<TensorEntry> entries;
  for (const auto& [name, json] : header.items()) {
    if (name == "__metadata__") {
      file.metadata = read_metadata(path, json);
    } else {
      entries.push_back(read_entry(path, name, json, data.size()));
    }
  }
  std::sort(entries.begin(), entries.end(), [](const TensorEntry& a, const TensorEntry& b) {
    return std::pair(a.begin, a.end) < std::pair(b.begin, b.end);
  });
  std::size_t end = 0;
  for (const TensorEntry& entry : entries) {
    if (entry.begin != end) {
      fail_file(path, "tensor '{}': data begin at byte {}, expected {}", printable(entry.name),
                entry.begin, end);
    }
    end = entry.end;
    Tensor tensor{entry.shape, std::vector<float>((entry.end - entry.begin) / sizeof(float))};
    std::copy_n(data.data() + entry.begin, entry.end - entry.begin,
                reinterpret_cast<char*>(tensor.values.data()));
    check_finite(path, entry.name, tensor);
    file.tensors.emplace(entry.name, std::move(tensor));
  }
  if (end != data.size()) {
    fail_file(path, "{} bytes of data, expected {}", data.size(), end);
  }
  return file;
}

void write_safetensors(const std::string& path, const TensorFile& file) {
  Json header = Json::object();
  if (!file.metadata.empty()) header["__metadata__"] = file.metadata;
  std::size_t end = 0;
  for (const auto& [name, tensor] : file.tensors) {
    check_finite(path, name, tensor);
    const std::size_t begin = std::exchange(end, end + sizeof(float) * tensor.values.size());
    header[name] = {{"dtype", "F32"}, {"shape", tensor.shape}, {"data_offsets", {begin, end}}};
    read_entry(path, name, header[name], end);
  }
  std::string text;
  try {
    text = header.dump();
  } catch (const Json::type_error&) {
    fail_file(path, "metadata is not valid UTF-8");
  }
  text.resize((text.size() + 7) / 8 * 8, ' ');  // the data are aligned

  WholeFile output(path);
  const std::uint64_t header_bytes = text.size();
  output.write({reinterpret_cast<const char*>(&header_bytes), sizeof(header_bytes)});
  output.write(text);
  for (const auto& [name, tensor] : file.tensors) {
    output.write({reinterpret_cast<const char*>(tensor.values.data()),
                  sizeof(float) * tensor.values.size()});
  }
  output.keep();
}

}  // namespace sandrunner
