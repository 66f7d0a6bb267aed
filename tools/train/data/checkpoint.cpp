// SPDX-License-Identifier: BSD-3-Clause
// File: magic (8 bytes) | version (u32) | number of sections (u32) | size of the file (u64) |
// config hash (u64) | architecture | name, bytes of each section | FNV-1a checksum of all before
// (u64). Little-endian; strings and byte arrays are preceded by their length (u64).
#include "tools/train/data/checkpoint.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>

#include "rt/base/errors.h"

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

std::uint64_t fnv1a(const char* data, std::size_t size) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (std::size_t i = 0; i < size; ++i) {
    hash = (hash ^ static_cast<unsigned char>(data[i])) * 0x100000001b3ULL;
  }
  return hash;
}

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
  append(out, fnv1a(out.data(), out.size()));
  return out;
}

/// A file descriptor that closes itself.
class File {
 public:
  File(const std::string& path, int flags) : descriptor_(::open(path.c_str(), flags, 0644)) {}
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  bool is_open() const { return descriptor_ >= 0; }
  bool write_all(const std::vector<char>& bytes) const {
    std::size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t count = ::write(descriptor_, bytes.data() + done, bytes.size() - done);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) return false;
      done += static_cast<std::size_t>(count);
    }
    return true;
  }
  bool flush() const { return ::fsync(descriptor_) == 0; }

 private:
  int descriptor_;
};

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
  const std::string temporary = path + ".tmp";
  const auto fail = [&](const std::string& what) {
    const std::string reason = std::generic_category().message(errno);
    ::unlink(temporary.c_str());
    throw InputError(fmt::format("{}: cannot {} checkpoint: {}", path, what, reason));
  };
  {
    const File file(temporary, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC);
    if (!file.is_open()) fail("create");
    if (!file.write_all(bytes) || !file.flush()) fail("write");
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) fail("rename");
  // Makes the new name itself survive a power cut. Some file systems do not offer it: not an error.
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const File directory(folder.empty() ? "." : folder.string(), O_RDONLY | O_CLOEXEC);
  if (directory.is_open()) directory.flush();
}

Checkpoint load_checkpoint(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("{}: cannot open checkpoint", path));
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (file.bad()) throw InputError(fmt::format("{}: cannot read checkpoint", path));

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
  if (checksum != fnv1a(bytes.data(), end)) {
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
