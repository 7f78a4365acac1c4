// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>

#include "scene/meshopt.hpp"

namespace sheaf::meshopt {
namespace {

constexpr std::uint8_t triangles_version = 0xe1, indices_version = 0xd1;
constexpr std::size_t codes_size = 16, indices_tail_size = 4;

template <class Word>
Word from_zigzag(Word v) {
  return (v & 1u) != 0 ? ~(v >> 1) : v >> 1;
}

class Bytes {
 public:
  explicit Bytes(In data) : data_(data) {}

  [[nodiscard]] std::uint8_t byte() {
    if (data_.empty()) return valid_ = false, std::uint8_t{0};
    const std::uint8_t value = data_.front();
    data_ = data_.subspan(1);
    return value;
  }

  // Seven bits a byte, the low ones first; bits beyond the 32nd are ignored.
  [[nodiscard]] std::uint32_t number() {
    std::uint32_t value = 0;
    for (int i = 0; i < 5; ++i) {
      const std::uint8_t next = byte();
      value |= (next & 127u) << 7 * i;
      if (next < 128) return value;
    }
    valid_ = false;
    return 0;
  }

  [[nodiscard]] bool at_end() const { return valid_ && data_.empty(); }
  [[nodiscard]] bool valid() const { return valid_; }
  void invalidate() { valid_ = false; }

 private:
  In data_;
  bool valid_ = true;
};

// The sixteen last values; 0 is the newest.
template <class T>
class Recent {
 public:
  void push(const T& value) { values_[count_++ % values_.size()] = value; }
  [[nodiscard]] bool has(std::size_t age) const { return age < std::min(count_, values_.size()); }
  [[nodiscard]] const T& at(std::size_t age) const { return values_[(count_ - 1 - age) % values_.size()]; }

 private:
  std::array<T, 16> values_{};
  std::size_t count_ = 0;
};

void write_index(std::uint32_t index, std::size_t stride, std::uint8_t* out) {
  for (std::size_t b = 0; b < stride; ++b) out[b] = static_cast<std::uint8_t>(index >> 8 * b);
}

struct Triangle {
  std::uint32_t a = 0, b = 0, c = 0;
};

class TriangleReader {
 public:
  TriangleReader(In data, In table) : data_(data), table_(table) {}

  [[nodiscard]] Triangle read(std::uint8_t code) {
    if (code >> 4 < 15) return on_edge(code >> 4, code & 15u);
    return (code & 15) < 14 ? by_table(table_[code & 15]) : by_data(code == 0xff);
  }
  [[nodiscard]] bool valid() const { return data_.valid(); }
  [[nodiscard]] bool at_end() const { return data_.at_end(); }

 private:
  struct Edge {
    std::uint32_t a = 0, b = 0;
  };

  std::uint32_t recent(std::size_t age) {
    if (vertices_.has(age)) return vertices_.at(age);
    data_.invalidate();
    return 0;
  }
  std::uint32_t coded() { return last_ += from_zigzag(data_.number()); }

  // The vertex that a half of a table's byte stands for; 15 only where the stream holds the byte.
  std::uint32_t by_nibble(unsigned nibble) {
    if (nibble == 0) return next_++;
    return nibble == 15 ? coded() : recent(nibble - 1);
  }

  Triangle on_edge(std::size_t edge, unsigned vertex) {
    if (!edges_.has(edge)) return data_.invalidate(), Triangle{};
    const auto [a, b] = edges_.at(edge);
    const bool known = vertex > 0 && vertex < 13;
    std::uint32_t c = 0;
    if (vertex == 0) c = next_++;
    if (known) c = recent(vertex);
    if (vertex == 13) c = --last_;
    if (vertex == 14) c = ++last_;
    if (vertex == 15) c = coded();
    edges_.push({c, b});
    edges_.push({a, c});
    if (!known) vertices_.push(c);
    return {a, b, c};
  }

  Triangle by_table(unsigned halves) {
    const std::uint32_t a = next_++;
    return free(a, halves);
  }

  Triangle by_data(bool first_is_coded) {
    const unsigned halves = data_.byte();
    if (halves == 0) next_ = 0;
    const std::uint32_t a = first_is_coded ? coded() : next_++;
    return free(a, halves);
  }

  Triangle free(std::uint32_t a, unsigned halves) {
    const unsigned high = halves >> 4, low = halves & 15;
    const std::uint32_t b = by_nibble(high);
    const std::uint32_t c = by_nibble(low);
    edges_.push({b, a});
    edges_.push({c, b});
    edges_.push({a, c});
    vertices_.push(a);
    if (high == 0 || high == 15) vertices_.push(b);
    if (low == 0 || low == 15) vertices_.push(c);
    return {a, b, c};
  }

  Bytes data_;
  In table_;
  std::uint32_t next_ = 0, last_ = 0;
  Recent<Edge> edges_;
  Recent<std::uint32_t> vertices_;
};

bool is_valid_table(In table) {
  const auto full = [](std::uint8_t halves) { return halves >> 4 == 15 || (halves & 15) == 15; };
  return table[14] == 0 && table[15] == 0 && std::ranges::none_of(table, full);
}

}  // namespace

bool decode_triangles(In stream, std::size_t stride, Out out) {
  const std::size_t count = out.size() / stride / 3;
  if (stream.size() < least_bytes(Mode::triangles, count * 3, stride) || stream.front() != triangles_version)
    return false;
  const In table = stream.last(codes_size), codes = stream.subspan(1, count);
  if (!is_valid_table(table)) return false;
  TriangleReader reader(stream.subspan(1 + count, stream.size() - 1 - count - codes_size), table);
  for (std::size_t t = 0; t < count && reader.valid(); ++t) {
    const Triangle triangle = reader.read(codes[t]);
    write_index(triangle.a, stride, &out[3 * t * stride]);
    write_index(triangle.b, stride, &out[(3 * t + 1) * stride]);
    write_index(triangle.c, stride, &out[(3 * t + 2) * stride]);
  }
  return reader.at_end();
}

bool decode_indices(In stream, std::size_t stride, Out out) {
  const std::size_t count = out.size() / stride;
  if (stream.size() < least_bytes(Mode::indices, count, stride) || stream.front() != indices_version) return false;
  Bytes data(stream.subspan(1, stream.size() - 1 - indices_tail_size));
  std::array<std::uint32_t, 2> last{};
  for (std::size_t i = 0; i < count && data.valid(); ++i) {
    const std::uint32_t coded = data.number();
    std::uint32_t& baseline = last[coded & 1];
    baseline += from_zigzag(coded >> 1);
    write_index(baseline, stride, &out[i * stride]);
  }
  return data.at_end();
}

}  // namespace sheaf::meshopt
