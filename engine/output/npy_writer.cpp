// SPDX-License-Identifier: MIT
#include "output/npy_writer.hpp"

#include <bit>
#include <cstddef>

#include "core/error.hpp"
#include "output/atomic_file.hpp"

namespace sheaf {
namespace {

static_assert(std::endian::native == std::endian::little, "values are written as they lie in memory");

constexpr std::size_t alignment = 64;
constexpr std::size_t max_dictionary_bytes = 0xffff;  // version 1.0 has a 16-bit length

void write_array(const std::string& path, const std::string& descr, std::span<const std::byte> data,
                 const NpyShape& shape) {
  const std::string header = npy_header(descr, shape);
  AtomicFile file(path);
  file.write(std::as_bytes(std::span(header)));
  file.write(data);
  file.commit();
}

template <typename T>
void write_numbers(const std::string& path, const char* descr, std::span<const T> values, const NpyShape& shape) {
  // In 128 bits, so that a product that wraps around cannot fit by chance; it stops growing once past every count.
  __extension__ using Wide = unsigned __int128;
  Wide count = 1;
  bool empty = false;
  for (const std::uint64_t side : shape) {
    empty = empty || side == 0;
    if (count <= values.size()) count *= side;
  }
  if (empty) count = 0;
  if (count != values.size())
    throw Error(ErrorKind::usage, path + ": the shape does not hold " + std::to_string(values.size()) + " values");
  write_array(path, descr, std::as_bytes(values), shape);
}

}  // namespace

std::string npy_header(const std::string& descr, const NpyShape& shape) {
  std::string sides;
  for (std::size_t i = 0; i < shape.size(); ++i) sides += (i > 0 ? ", " : "") + std::to_string(shape[i]);
  if (shape.size() == 1) sides += ",";  // a Python tuple of one
  std::string dictionary = "{'descr': " + descr + ", 'fortran_order': False, 'shape': (" + sides + "), }";
  std::string header("\x93NUMPY\x01\x00", 8);
  const std::size_t before = header.size() + 2;
  const std::size_t whole = (before + dictionary.size() + 1 + alignment - 1) / alignment * alignment;
  dictionary.append(whole - before - dictionary.size() - 1, ' ');
  dictionary += '\n';
  if (dictionary.size() > max_dictionary_bytes) throw Error(ErrorKind::usage, "npy: too many dimensions");
  header += static_cast<char>(dictionary.size() & 0xff);
  header += static_cast<char>(dictionary.size() >> 8);
  return header + dictionary;
}

void write_npy(const std::string& path, std::span<const float> values, const NpyShape& shape) {
  write_numbers(path, "'<f4'", values, shape);
}

void write_npy(const std::string& path, std::span<const double> values, const NpyShape& shape) {
  write_numbers(path, "'<f8'", values, shape);
}

void write_npy(const std::string& path, std::span<const HitRecord> hits) {
  write_array(path, "[('t', '<f4'), ('triangle', '<i4'), ('u', '<f4'), ('v', '<f4')]", std::as_bytes(hits),
              {hits.size()});
}

}  // namespace sheaf
