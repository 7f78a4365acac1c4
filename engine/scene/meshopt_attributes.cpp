// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "scene/meshopt.hpp"

namespace sheaf::meshopt {
namespace {

constexpr std::uint8_t attributes_version_0 = 0xa0;
constexpr std::size_t group_size = 16, block_bytes = 8192, most_block_elements = 256;

std::size_t block_elements(std::size_t stride) {
  return std::min(block_bytes / stride & ~(group_size - 1), most_block_elements);
}

// Baseline and channel modes; what comes before is padded so that it takes at least 32 and 24 bytes.
std::size_t tail_size(bool second, std::size_t stride) { return second ? stride + stride / 4 : stride; }
std::size_t padded_tail_size(bool second, std::size_t stride) {
  return std::max<std::size_t>(tail_size(second, stride), second ? 24 : 32);
}

template <class Word>
Word from_zigzag(Word v) {
  return static_cast<Word>((v & 1u) != 0 ? ~(v >> 1) : v >> 1);
}

// Deltas of one block, one array for each byte of an element.
using Deltas = std::array<std::uint8_t, most_block_elements>;

class AttributeReader {
 public:
  AttributeReader(In stream, std::size_t stride)
      : second_(stream.front() == attributes_version_1),
        stride_(stride),
        tail_(stream.last(tail_size(second_, stride))),
        data_(stream.subspan(1, stream.size() - 1 - padded_tail_size(second_, stride))) {
    std::copy_n(tail_.begin(), stride, previous_.begin());
  }

  [[nodiscard]] bool read(Out out) {
    if (!channels_are_valid()) return false;
    const std::size_t most = block_elements(stride_);
    while (!out.empty()) {
      const std::size_t elements = std::min(out.size() / stride_, most);
      if (!read_block(elements, out.first(elements * stride_))) return false;
      out = out.subspan(elements * stride_);
    }
    return data_.empty();
  }

 private:
  [[nodiscard]] std::uint8_t channel(std::size_t index) const { return second_ ? tail_[stride_ + index] : 0; }

  // 0: bytes, 1: pairs, 2: words, which alone have a rotation in the high bits.
  [[nodiscard]] bool channels_are_valid() const {
    for (std::size_t c = 0; c < stride_ / 4; ++c)
      if ((channel(c) & 15) > 2 || ((channel(c) & 15) < 2 && channel(c) > 15)) return false;
    return true;
  }

  // Nothing where the stream ends before.
  [[nodiscard]] const std::uint8_t* take(std::size_t size) {
    if (data_.size() < size) return nullptr;
    const std::uint8_t* const taken = data_.data();
    data_ = data_.subspan(size);
    return taken;
  }

  // Sixteen deltas of `bits` each; all bits set stand for a whole byte that follows after the sixteen.
  [[nodiscard]] bool read_group(unsigned bits, std::uint8_t* deltas) {
    if (bits == 0) return std::fill_n(deltas, group_size, std::uint8_t{0}), true;
    const std::uint8_t* const packed = take(group_size * bits / 8);
    if (packed == nullptr) return false;
    if (bits == 8) return std::copy_n(packed, group_size, deltas), true;
    const unsigned sentinel = (1u << bits) - 1, per_byte = 8 / bits;
    for (unsigned i = 0; i < group_size; ++i) {
      // Single bits begin at the least significant one, the others at the most significant ones.
      const unsigned place = i % per_byte, shift = bits == 1 ? place : 8 - bits * (place + 1);
      const unsigned value = packed[i / per_byte] >> shift & sentinel;
      const std::uint8_t* const whole = value == sentinel ? take(1) : nullptr;
      if (value == sentinel && whole == nullptr) return false;
      deltas[i] = whole != nullptr ? *whole : static_cast<std::uint8_t>(value);
    }
    return true;
  }

  [[nodiscard]] bool read_groups(const std::array<unsigned, 4>& bits, std::size_t groups, Deltas& deltas) {
    const std::uint8_t* const header = take((groups + 3) / 4);
    if (header == nullptr) return false;
    for (std::size_t g = 0; g < groups; ++g)
      if (!read_group(bits[header[g / 4] >> g % 4 * 2 & 3], &deltas[g * group_size])) return false;
    return true;
  }

  // The deltas of one byte of the block's elements.
  [[nodiscard]] bool read_byte(unsigned control, std::size_t elements, Deltas& deltas) {
    static constexpr std::array<unsigned, 4> few{0, 1, 2, 4}, many{1, 2, 4, 8}, version_0{0, 2, 4, 8};
    const std::size_t groups = (elements + group_size - 1) / group_size;
    if (!second_) return read_groups(version_0, groups, deltas);
    if (control < 2) return read_groups(control == 0 ? few : many, groups, deltas);
    const std::uint8_t* const literal = control == 3 ? take(elements) : nullptr;
    if (control == 3 && literal == nullptr) return false;
    if (literal != nullptr)
      std::copy_n(literal, elements, deltas.begin());
    else
      deltas.fill(0);
    return true;
  }

  [[nodiscard]] bool read_block(std::size_t elements, Out out) {
    const std::uint8_t* const controls = second_ ? take(stride_ / 4) : nullptr;
    if (second_ && controls == nullptr) return false;
    for (std::size_t c = 0; c < stride_ / 4; ++c) {
      std::array<Deltas, 4> deltas;
      for (std::size_t byte = 0; byte < 4; ++byte)
        if (!read_byte(second_ ? controls[c] >> byte * 2 & 3u : 0, elements, deltas[byte])) return false;
      add_up(c, elements, deltas, out.subspan(4 * c));
    }
    return true;
  }

  void add_up(std::size_t index, std::size_t elements, const std::array<Deltas, 4>& deltas, Out out) {
    const unsigned mode = channel(index) & 15, rotation = channel(index) >> 4;
    std::uint8_t* const last = &previous_[4 * index];
    for (std::size_t i = 0; i < elements; ++i) {
      const std::array<std::uint8_t, 4> delta{deltas[0][i], deltas[1][i], deltas[2][i], deltas[3][i]};
      if (mode == 0) {
        for (std::size_t b = 0; b < 4; ++b) last[b] = static_cast<std::uint8_t>(last[b] + from_zigzag(delta[b]));
      } else if (mode == 1) {
        add_pair(delta.data(), last);
        add_pair(delta.data() + 2, last + 2);
      } else {
        const std::uint32_t word = std::rotr(little_endian(delta.data(), 4), static_cast<int>(rotation));
        for (unsigned b = 0; b < 4; ++b) last[b] = static_cast<std::uint8_t>(last[b] ^ word >> 8 * b);
      }
      std::copy_n(last, 4, &out[i * stride_]);
    }
  }

  static void add_pair(const std::uint8_t* delta, std::uint8_t* last) {
    const auto sum = little_endian(last, 2) + from_zigzag(static_cast<std::uint16_t>(little_endian(delta, 2)));
    last[0] = static_cast<std::uint8_t>(sum);
    last[1] = static_cast<std::uint8_t>(sum >> 8);
  }

  static std::uint32_t little_endian(const std::uint8_t* bytes, unsigned size) {
    std::uint32_t word = 0;
    for (unsigned b = 0; b < size; ++b) word |= std::uint32_t{bytes[b]} << 8 * b;
    return word;
  }

  bool second_;
  std::size_t stride_;
  In tail_, data_;
  std::array<std::uint8_t, 256> previous_{};  // the element before
};

}  // namespace

std::uint64_t least_bytes(Mode mode, std::uint64_t count, std::uint64_t stride) {
  if (mode == Mode::triangles) return 1 + count / 3 + 16;
  if (mode == Mode::indices) return 1 + count + 4;
  // Every block has a control byte for each four bytes of an element; the first version has more.
  return 1 + (count + most_block_elements - 1) / most_block_elements * (stride / 4) + 24;
}

bool decode_attributes(In stream, std::size_t stride, Out out) {
  if (stream.empty()) return false;
  const bool second = stream.front() == attributes_version_1;
  if (!second && stream.front() != attributes_version_0) return false;
  if (stream.size() < 1 + padded_tail_size(second, stride)) return false;
  return AttributeReader(stream, stride).read(out);
}

}  // namespace sheaf::meshopt
