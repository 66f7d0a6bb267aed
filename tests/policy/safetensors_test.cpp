// SPDX-License-Identifier: BSD-3-Clause
#include "policy/safetensors.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <limits>

#include "rt/base/errors.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

/// A file of this header and `data_bytes` zeros.
std::string file_bytes(const std::string& header, std::size_t data_bytes) {
  std::string bytes(8, '\0');
  const std::uint64_t length = header.size();
  std::memcpy(bytes.data(), &length, sizeof(length));
  return bytes + header + std::string(data_bytes, '\0');
}

/// The error of reading `bytes`; "" if there is none.
std::string read_error(const std::string& bytes) {
  const TemporaryFolder folder;
  write_file(folder.path("a.safetensors"), bytes);
  return error_of([&] { read_safetensors(folder.path("a.safetensors")); });
}

TEST(SafetensorsTest, ReadsBackWhatItWrote) {
  const TemporaryFolder folder;
  TensorFile file;
  file.metadata = {{"note", "two\nlines"}};
  file.tensors["b"] = {{2, 3}, {1, 2, 3, 4, 5, 6}};
  file.tensors["a"] = {{}, {0.1f}};
  file.tensors["empty"] = {{0, 5}, {}};
  write_safetensors(folder.path("x"), file);
  const TensorFile again = read_safetensors(folder.path("x"));
  EXPECT_EQ(again.metadata, file.metadata);
  ASSERT_EQ(again.tensors.size(), 3u);
  for (const auto& [name, tensor] : file.tensors) {
    EXPECT_EQ(again.tensors.at(name).shape, tensor.shape);
    EXPECT_EQ(again.tensors.at(name).values, tensor.values);
  }
  EXPECT_EQ(folder.number_of_files(), 1u);
}

TEST(SafetensorsTest, ReadsAHeaderAsOtherWritersPadIt) {
  EXPECT_EQ(
      read_error(file_bytes(R"({"a":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}}   )", 8)),
      "");
}

TEST(SafetensorsTest, RefusesADeepOrHugeHeaderAtOnce) {
  EXPECT_NE(read_error(file_bytes(std::string(1'000'000, '['), 0)).find("nested more than 3 deep"),
            std::string::npos);
  std::string huge;
  huge.resize(30'000'000, '[');
  EXPECT_NE(
      read_error(file_bytes(huge, 0)).find("header of 30000000 bytes, expected at most 1048576"),
      std::string::npos);
}

TEST(SafetensorsTest, PrintsALongShapeShort) {
  std::string sizes = "1";
  for (int i = 0; i < 100'000; ++i) sizes += ",1";
  const std::string error = read_error(
      file_bytes(R"({"a":{"dtype":"F32","shape":[)" + sizes + R"(],"data_offsets":[0,8]}})", 8));
  EXPECT_NE(error.find("do not fit the shape [1, 1, 1, "), std::string::npos) << error;
  EXPECT_LT(error.size(), 250u);
}

struct BadHeader {
  const char* name;
  const char* header;
  std::size_t data_bytes;
  const char* message;
};

void PrintTo(const BadHeader& bad, std::ostream* stream) { *stream << bad.message; }

class SafetensorsBadHeaderTest : public testing::TestWithParam<BadHeader> {};

TEST_P(SafetensorsBadHeaderTest, IsRefusedInOneLineThatNamesFileAndCause) {
  const std::string message = read_error(file_bytes(GetParam().header, GetParam().data_bytes));
  EXPECT_NE(message.find("a.safetensors': "), std::string::npos) << message;
  EXPECT_NE(message.find(GetParam().message), std::string::npos) << message;
}

INSTANTIATE_TEST_SUITE_P(
    All, SafetensorsBadHeaderTest,
    testing::Values(
        BadHeader{"NotJson", R"({"a":)", 0, "header is not valid JSON at byte"},
        BadHeader{"NotUtf8", "{\"\xff\":1}", 0, "header is not valid JSON at byte"},
        BadHeader{"NotAnObject", "[1]", 0, "header is not a JSON object"},
        BadHeader{"EntryNotAnObject", R"({"a":1})", 0, "tensor 'a': header entry is not an object"},
        BadHeader{"ControlCharacters", R"({"a\nb":1})", 0, "tensor 'a?b': header entry"},
        BadHeader{"NoShape", R"({"a":{"dtype":"F32","data_offsets":[0,4]}})", 4,
                  "tensor 'a': shape is missing"},
        BadHeader{"ExtraKey", R"({"a":{"dtype":"F32","shape":[1],"data_offsets":[0,4],"x":0}})", 4,
                  "tensor 'a': header entry has 4 keys"},
        BadHeader{"HalfPrecision", R"({"a":{"dtype":"F16","shape":[2],"data_offsets":[0,4]}})", 4,
                  "tensor 'a': dtype is F16, expected F32"},
        BadHeader{"NegativeSize", R"({"a":{"dtype":"F32","shape":[-1],"data_offsets":[0,4]}})", 4,
                  "tensor 'a': shape is not an array of natural numbers"},
        BadHeader{"SizeTwoTo64",
                  R"({"a":{"dtype":"F32","shape":[4294967296,4294967296],)"
                  R"("data_offsets":[0,0]}})",
                  0, "tensor 'a': 0 bytes of data do not fit the shape"},
        BadHeader{"OtherSize", R"({"a":{"dtype":"F32","shape":[3],"data_offsets":[0,8]}})", 8,
                  "tensor 'a': 8 bytes of data do not fit the shape [3]"},
        BadHeader{"BeyondTheEnd", R"({"a":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}})", 4,
                  "tensor 'a': data_offsets do not lie in the 4 bytes of data"},
        BadHeader{"Backwards", R"({"a":{"dtype":"F32","shape":[1],"data_offsets":[4,0]}})", 4,
                  "tensor 'a': data_offsets do not lie in"},
        BadHeader{"Overlap",
                  R"({"a":{"dtype":"F32","shape":[2],"data_offsets":[0,8]},)"
                  R"("b":{"dtype":"F32","shape":[1],"data_offsets":[4,8]}})",
                  8, "tensor 'b': data begin at byte 4, expected 8"},
        BadHeader{"Gap", R"({"a":{"dtype":"F32","shape":[1],"data_offsets":[4,8]}})", 8,
                  "tensor 'a': data begin at byte 4, expected 0"},
        BadHeader{"DataLeftOver", R"({"a":{"dtype":"F32","shape":[1],"data_offsets":[0,4]}})", 8,
                  "8 bytes of data, expected 4"},
        BadHeader{"Twice",
                  R"({"a":{"dtype":"F32","shape":[1],"data_offsets":[0,4]},)"
                  R"("a":{"dtype":"F32","shape":[1],"data_offsets":[0,4]}})",
                  4, "header has the key 'a' twice"},
        BadHeader{"MetadataNotText", R"({"__metadata__":{"k":1}})", 0,
                  "__metadata__ 'k' is not a string"}),
    [](const auto& test) { return test.param.name; });

TEST(SafetensorsTest, RefusesAHeaderLengthBeyondTheFile) {
  EXPECT_NE(read_error(std::string(100, '\xff'))
                .find("is not a safetensors file, or is cut short: found"),
            std::string::npos);
  EXPECT_NE(read_error("short").find("5 bytes are too few"), std::string::npos);
}

TEST(SafetensorsTest, RefusesValuesThatAreNotFinite) {
  std::string bytes = file_bytes(R"({"a":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}})", 4);
  const float infinity = std::numeric_limits<float>::infinity();
  bytes.append(reinterpret_cast<const char*>(&infinity), sizeof(infinity));
  EXPECT_NE(read_error(bytes).find("tensor 'a': value 1 is not finite"), std::string::npos);
}

TEST(SafetensorsTest, RefusesWhatIsNotARegularFile) {
  const TemporaryFolder folder;
  EXPECT_THROW(read_safetensors(folder.path("")), InputError);
  EXPECT_THROW(read_safetensors(folder.path("absent")), InputError);
  EXPECT_THROW(read_safetensors("/dev/zero"), InputError);
}

TEST(SafetensorsTest, UnwritableTargetLeavesNothingBehind) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path("folder"));
  TensorFile file;
  file.tensors["a"] = {{1}, {1.0f}};
  EXPECT_THROW(write_safetensors(folder.path("folder"), file), InputError);
  EXPECT_THROW(write_safetensors(folder.path("absent/x"), file), InputError);
  file.tensors["a"].values[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(write_safetensors(folder.path("x"), file), InputError);
  file.tensors["a"] = {{2}, {1.0f}};
  EXPECT_THROW(write_safetensors(folder.path("x"), file), InputError);
  EXPECT_EQ(folder.number_of_files(), 1u);
}

}  // namespace
}  // namespace sandrunner
