// SPDX-License-Identifier: MIT
#include "output/npy_writer.hpp"

#include <cstring>
#include <limits>

#include "output_support.hpp"

namespace sheaf {
namespace {

using test::contents;
using test::error_of;

class NpyWriterTest : public test::OutputTest {};

// Written out by hand from the description of format 1.0: magic, version, 16-bit little-endian length, dictionary
// padded with spaces and ended by a newline so that everything before the data is a multiple of 64 bytes.
std::string header_128(const std::string& dictionary) {
  std::string header("\x93NUMPY\x01\x00\x76\x00", 10);
  header += dictionary;
  header.resize(127, ' ');
  return header + '\n';
}

TEST_F(NpyWriterTest, FloatHeaderBytes) {
  EXPECT_EQ(npy_header("'<f4'", {3, 4}), header_128("{'descr': '<f4', 'fortran_order': False, 'shape': (3, 4), }"));
  EXPECT_EQ(npy_header("'<f8'", {3}), header_128("{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }"));
  EXPECT_EQ(npy_header("'<f4'", {}), header_128("{'descr': '<f4', 'fortran_order': False, 'shape': (), }"));
}

TEST_F(NpyWriterTest, EveryHeaderIsAligned) {
  NpyShape shape;
  for (int sides = 0; sides < 60; ++sides, shape.push_back(123456)) {
    const std::string header = npy_header("'<f4'", shape);
    EXPECT_EQ(header.size() % 64, 0u);
    EXPECT_EQ(header.back(), '\n');
    const std::size_t length = static_cast<unsigned char>(header[8]) + 256u * static_cast<unsigned char>(header[9]);
    EXPECT_EQ(length + 10, header.size());
  }
  EXPECT_THROW((void)npy_header("'<f4'", NpyShape(20000, 123456)), Error);
}

TEST_F(NpyWriterTest, FloatsFollowLittleEndian) {
  const std::vector<float> values{1.0f, -2.5f};
  write_npy(path("a.npy"), values, {2, 1});
  const std::string data = contents(path("a.npy")).substr(128);
  EXPECT_EQ(data, std::string("\x00\x00\x80\x3f\x00\x00\x20\xc0", 8));
}

TEST_F(NpyWriterTest, Doubles) {
  write_npy(path("a.npy"), std::vector<double>{1.0, 0.1, -3e300}, {3});
  const std::string file = contents(path("a.npy"));
  ASSERT_EQ(file.size(), 128u + 24u);
  EXPECT_NE(file.find("'<f8'"), std::string::npos);
  double last = 0;
  std::memcpy(&last, file.data() + 128 + 16, 8);
  EXPECT_EQ(last, -3e300);
}

TEST_F(NpyWriterTest, HitRecords) {
  const std::vector<HitRecord> hits{{1.0f, 7, 0.25f, 0.5f}, {std::numeric_limits<float>::infinity(), -1, 0, 0}};
  write_npy(path("h.npy"), hits);
  EXPECT_EQ(contents(path("h.npy")),
            header_128("{'descr': [('t', '<f4'), ('triangle', '<i4'), ('u', '<f4'), ('v', '<f4')], "
                       "'fortran_order': False, 'shape': (2,), }") +
                std::string("\x00\x00\x80\x3f\x07\x00\x00\x00\x00\x00\x80\x3e\x00\x00\x00\x3f"
                            "\x00\x00\x80\x7f\xff\xff\xff\xff\x00\x00\x00\x00\x00\x00\x00\x00",
                            32));
}

TEST_F(NpyWriterTest, EmptyArrays) {
  write_npy(path("a.npy"), std::vector<float>{}, {0, 3, 3});
  EXPECT_EQ(contents(path("a.npy")), npy_header("'<f4'", {0, 3, 3}));
  write_npy(path("b.npy"), std::vector<float>{}, {1ull << 40, 1ull << 40, 0});
  write_npy(path("h.npy"), std::vector<HitRecord>{});
  EXPECT_NE(contents(path("h.npy")).find("'shape': (0,)"), std::string::npos);
}

TEST_F(NpyWriterTest, ShapeMustFit) {
  const std::vector<float> six(6);
  EXPECT_EQ(error_of(ErrorKind::usage,
                     [&] {
                       write_npy("a.npy", six, {2, 4});
                     }),
            "a.npy: the shape does not hold 6 values");
  EXPECT_EQ(error_of(ErrorKind::usage, [&] { write_npy("a.npy", six, {}); }),
            "a.npy: the shape does not hold 6 values");
  // 2 · (2^63 + 3) is 6 in 64 bits.
  EXPECT_EQ(error_of(ErrorKind::usage,
                     [&] {
                       write_npy("a.npy", six, {2, (1ull << 63) + 3});
                     }),
            "a.npy: the shape does not hold 6 values");
}

TEST_F(NpyWriterTest, UnwritablePlace) {
  EXPECT_EQ(error_of(ErrorKind::io, [&] { write_npy(path("no/a.npy"), std::vector<HitRecord>(1)); }),
            path("no/a.npy") + ": cannot create: No such file or directory");
}

}  // namespace
}  // namespace sheaf
