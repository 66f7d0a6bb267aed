// SPDX-License-Identifier: BSD-3-Clause
// File: magic (8 bytes) | version (u32) | number of sections (u32) | size of the file (u64) |
// config hash (u64) | architecture | name, bytes of each section | FNV-1a checksum of all before
// (u64). Little-endian; strings and byte arrays are preceded by their length (u64).
#include "tools/train/data/checkpoint.h"

#include <fmt/format.h>

#include <string_view>

#include "rt/base/errors.h"
#include "rt/base/input_file.h"
#include "rt/base/output_files.h"

namespace sandrunner::learner {
namespace {

constexpr std::string_view kMagic = "SRTRAIN\n";
constexpr std::uint32_t kVersion = 1;

struct Header {
  char magic[8];
  std::uint32_t version;
  std::uint32_t sections;
  std::uint64_t file_size;
  std::uint64_t config_hash;
};
static_assert(sizeof(Header) == 32, "no padding");

template <typename T>
void append(std::vector<char>& out, const T& value) {
  const std::size_t size = out.size();
  out.resize(size + sizeof(T));
  std::memcpy(out.data() + size, &value, sizeof(T));
}

template <typename Bytes>
void append_bytes(std::vector<char>& out, const Bytes& bytes) {
  append(out, static_cast<std::uint64_t>(bytes.size()));
  out.insert(out.end(), bytes.begin(), bytes.end());
}

std::vector<char> encode(const Checkpoint& checkpoint) {
  std::vector<char> out(sizeof(Header));
  append_bytes(out, checkpoint.architecture);
  for (const auto& [name, bytes] : checkpoint.sections) {
    append_bytes(out, name);
    append_bytes(out, bytes);
  }
  Header header{};
  std::memcpy(header.magic, kMagic.data(), sizeof(header.magic));
  header.version = kVersion;
  header.sections = static_cast<std::uint32_t>(checkpoint.sections.size());
  header.file_size = out.size() + sizeof(std::uint64_t);
  header.config_hash = checkpoint.config_hash;
  std::memcpy(out.data(), &header, sizeof(header));
  append(out, fnv1a({out.data(), out.size()}));
  return out;
}

/// Takes bytes from the front of a file whose checksum was right; a length beyond its end is still
/// refused.
class Reader {
 public:
  Reader(std::string_view bytes, const std::string& path) : bytes_(bytes), path_(path) {}

  std::string_view take() {
    std::uint64_t size = 0;
    const std::string_view head = take(sizeof(size));
    std::memcpy(&size, head.data(), sizeof(size));
    return take(size);
  }
  std::string_view take(std::uint64_t size) {
    if (size > bytes_.size()) {
      throw InputError(fmt::format("{}: damaged checkpoint: {} bytes announced where {} are left",
                                   path_, size, bytes_.size()));
    }
    const std::string_view taken = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return taken;
  }

 private:
  std::string_view bytes_;
  const std::string& path_;
};

}  // namespace

std::uint64_t fnv1a(std::string_view bytes, std::uint64_t hash) {
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return hash;
}

const std::vector<char>& Checkpoint::section(const std::string& name,
                                             std::size_t expected_bytes) const {
  const auto found = sections.find(name);
  if (found == sections.end()) {
    throw InputError(fmt::format("{}: checkpoint has no section '{}'", source, name));
  }
  if (found->second.size() != expected_bytes) {
    throw InputError(fmt::format("{}: section '{}' has {} bytes, expected {}", source, name,
                                 found->second.size(), expected_bytes));
  }
  return found->second;
}

void save_checkpoint(const Checkpoint& checkpoint, const std::string& path) {
  const std::vector<char> bytes = encode(checkpoint);
  write_file(path, {bytes.data(), bytes.size()});
}

Checkpoint load_checkpoint(const std::string& path) {
  const std::string bytes = read_input_file(path, "a training checkpoint");

  Header header{};
  if (bytes.size() < sizeof(header) + sizeof(std::uint64_t)) {
    throw InputError(fmt::format("{}: no training checkpoint: {} bytes", path, bytes.size()));
  }
  std::memcpy(&header, bytes.data(), sizeof(header));
  if (std::string_view(header.magic, sizeof(header.magic)) != kMagic) {
    throw InputError(
        fmt::format("{}: no training checkpoint: it does not begin with SRTRAIN", path));
  }
  if (header.version != kVersion) {
    throw InputError(
        fmt::format("{}: checkpoint version {}, expected {}", path, header.version, kVersion));
  }
  if (header.file_size != bytes.size()) {
    throw InputError(fmt::format("{}: truncated checkpoint: {} bytes, expected {}", path,
                                 bytes.size(), header.file_size));
  }
  const std::size_t end = bytes.size() - sizeof(std::uint64_t);
  std::uint64_t checksum = 0;
  std::memcpy(&checksum, bytes.data() + end, sizeof(checksum));
  if (checksum != fnv1a({bytes.data(), end})) {
    throw InputError(fmt::format("{}: damaged checkpoint: its checksum does not match", path));
  }

  Checkpoint checkpoint;
  checkpoint.source = path;
  checkpoint.config_hash = header.config_hash;
  Reader reader(std::string_view(bytes).substr(sizeof(header), end - sizeof(header)), path);
  checkpoint.architecture = reader.take();
  for (std::uint32_t i = 0; i < header.sections; ++i) {
    const std::string name(reader.take());
    const std::string_view content = reader.take();
    checkpoint.sections[name].assign(content.begin(), content.end());
  }
  return checkpoint;
}

}  // namespace sandrunner::learner
