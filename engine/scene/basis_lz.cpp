// SPDX-License-Identifier: MIT
#include "scene/basis_lz.hpp"

#include <algorithm>

#include "scene/bit_reader.hpp"

namespace sheaf {
namespace {

std::uint32_t word(std::span<const std::uint8_t> data, std::size_t at, unsigned size) {
  std::uint32_t value = 0;
  for (unsigned b = 0; b < size; ++b) value |= std::uint32_t{data[at + b]} << 8 * b;
  return value;
}

// A reader whose data may be damaged: what cannot be read is 0, and `fine` says so in the end.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : in_(bytes) {}

  [[nodiscard]] std::uint32_t bits(unsigned count) { return in_.bits(count); }

  [[nodiscard]] std::uint32_t symbol(const HuffmanTable& table) {
    std::uint32_t code = 0, first = 0, index = 0;
    for (std::size_t length = 1; length < table.counts.size(); ++length) {
      code |= in_.bit();
      const std::uint32_t count = table.counts[length];
      if (code - first < count) return table.symbols[index + (code - first)];
      index += count;
      first = (first + count) << 1;
      code <<= 1;
    }
    fail();
    return 0;
  }

  // Chunks of `size` bits, the lowest first; another bit above each says whether one follows.
  [[nodiscard]] std::uint32_t number(unsigned size) {
    std::uint32_t value = 0;
    for (unsigned shift = 0; shift < 32; shift += size) {
      const std::uint32_t chunk = in_.bits(size + 1);
      value |= (chunk & ((1u << size) - 1)) << shift;
      if (chunk >> size == 0) return value;
    }
    fail();
    return 0;
  }

  [[nodiscard]] HuffmanTable table() {
    static constexpr std::array<std::uint8_t, 21> order{17, 18, 19, 20, 0,  8, 7,  9, 6,  10, 5,
                                                        11, 4,  12, 3,  13, 2, 14, 1, 15, 16};
    const std::uint32_t count = in_.bits(14);
    if (count == 0) return {};
    const std::uint32_t length_codes = in_.bits(5);
    if (length_codes == 0 || length_codes > order.size()) return fail(), HuffmanTable{};
    std::vector<std::uint8_t> lengths(order.size());
    for (std::uint32_t i = 0; i < length_codes; ++i) lengths[order[i]] = static_cast<std::uint8_t>(in_.bits(3));
    return made(code_lengths(made(lengths), count));
  }

  void fail() { fine_ = false; }
  [[nodiscard]] bool fine() const { return fine_ && !in_.ran_over(); }

 private:
  [[nodiscard]] std::vector<std::uint8_t> code_lengths(const HuffmanTable& coded, std::uint32_t count) {
    std::vector<std::uint8_t> lengths;
    while (lengths.size() < count && fine()) {
      const std::uint32_t next = symbol(coded);
      if (next < 17) {
        lengths.push_back(static_cast<std::uint8_t>(next));
        continue;
      }
      const bool zeros = next < 19;
      if (!zeros && (lengths.empty() || lengths.back() == 0)) return fail(), lengths;
      const std::uint32_t run = next == 17   ? 3 + in_.bits(3)
                                : next == 18 ? 11 + in_.bits(7)
                                : next == 19 ? 3 + in_.bits(2)
                                             : 7 + in_.bits(7);
      lengths.resize(lengths.size() + run, zeros ? std::uint8_t{0} : std::uint8_t{lengths.back()});
    }
    if (lengths.size() != count) fail();
    return lengths;
  }

  [[nodiscard]] HuffmanTable made(const std::vector<std::uint8_t>& lengths) {
    HuffmanTable table;
    for (const std::uint8_t length : lengths) ++table.counts[length];
    table.counts[0] = 0;
    std::uint32_t free = 1;  // codes of the length at hand that no shorter one begins
    for (std::size_t length = 1; length < table.counts.size(); ++length) {
      free <<= 1;
      if (table.counts[length] > free) return fail(), HuffmanTable{};
      free -= table.counts[length];
    }
    for (std::uint8_t length = 1; length < table.counts.size(); ++length)
      for (std::size_t s = 0; s < lengths.size(); ++s)
        if (lengths[s] == length) table.symbols.push_back(static_cast<std::uint16_t>(s));
    return table;
  }

  BitReader in_;
  bool fine_ = true;
};

bool read_endpoints(std::span<const std::uint8_t> data, std::uint32_t count, BasisCodebooks& out) {
  Reader in(data);
  std::array<HuffmanTable, 3> deltas;  // by the value before: to 9, to 21, beyond
  for (HuffmanTable& table : deltas) table = in.table();
  const HuffmanTable intensity_delta = in.table();
  const bool grey = in.bits(1) != 0;
  std::array<std::uint32_t, 3> before{16, 16, 16};
  std::uint32_t intensity = 0;
  for (std::uint32_t i = 0; i < count && in.fine(); ++i) {
    BasisCodebooks::Endpoint& endpoint = out.endpoints.emplace_back();
    intensity = (intensity + in.symbol(intensity_delta)) & 7;
    endpoint.intensity = static_cast<std::uint8_t>(intensity);
    for (std::size_t c = 0; c < 3; ++c) {
      if (!grey || c == 0) {
        const HuffmanTable& table = deltas[before[c] < 10 ? 0 : before[c] < 22 ? 1 : 2];
        before[c] = (before[c] + in.symbol(table)) & 31;
      }
      endpoint.color[c] = static_cast<std::uint8_t>(before[grey ? 0 : c]);
    }
  }
  return in.fine();
}

bool read_selectors(std::span<const std::uint8_t> data, std::uint32_t count, BasisCodebooks& out) {
  Reader in(data);
  if (in.bits(2) != 0) return false;
  const bool plain = in.bits(1) != 0;
  const HuffmanTable deltas = plain ? HuffmanTable{} : in.table();
  for (std::uint32_t i = 0; i < count && in.fine(); ++i) {
    std::array<std::uint8_t, 4> rows{};
    for (std::size_t y = 0; y < 4; ++y)
      rows[y] = static_cast<std::uint8_t>(plain || i == 0 ? in.bits(8) : in.symbol(deltas) ^ out.selectors.back()[y]);
    out.selectors.push_back(rows);
  }
  return in.fine();
}

bool read_tables(std::span<const std::uint8_t> data, BasisCodebooks& out) {
  Reader in(data);
  for (HuffmanTable* table : {&out.endpoint_prediction, &out.endpoint_delta, &out.selector, &out.selector_run})
    *table = in.table();
  out.history_size = in.bits(13);
  return in.fine();
}

// What was used lately, the more often the nearer to the front.
class History {
 public:
  explicit History(std::size_t size) : values_(size), rover_(size / 2) {}
  void add(std::uint32_t value) {
    if (values_.empty()) return;
    values_[rover_++] = value;
    if (rover_ == values_.size()) rover_ = values_.size() / 2;
  }
  [[nodiscard]] std::uint32_t use(std::size_t index) {
    const std::uint32_t value = values_[index];
    std::swap(values_[index / 2], values_[index]);
    return value;
  }
  [[nodiscard]] std::size_t size() const { return values_.size(); }

 private:
  std::vector<std::uint32_t> values_;
  std::size_t rover_;
};

class SliceReader {
 public:
  SliceReader(const BasisCodebooks& books, std::span<const std::uint8_t> slice, std::uint32_t blocks_wide)
      : books_(books),
        in_(slice),
        history_(books.history_size),
        above_(blocks_wide),
        predictions_(blocks_wide / 2 + 1) {}

  struct Block {
    std::uint32_t endpoint = 0, selector = 0;
  };
  // Blocks are asked for row by row.
  [[nodiscard]] Block read(std::uint32_t x, std::uint32_t y) {
    if (x % 2 == 0) bits_ = y % 2 == 0 ? prediction_of_four(x) : predictions_[x / 2];
    const std::uint32_t prediction = bits_ & 3;
    bits_ >>= 2;
    const std::uint32_t up = above_[x];
    before_ = endpoint(prediction, x, y);
    above_left_ = up;
    above_[x] = before_;
    const Block block{before_, selector()};
    if (block.endpoint >= books_.endpoints.size() || block.selector >= books_.selectors.size()) in_.fail();
    return block;
  }
  [[nodiscard]] bool fine() const { return in_.fine(); }

 private:
  [[nodiscard]] std::uint32_t prediction_of_four(std::uint32_t x) {
    constexpr std::uint32_t repeat = 256;
    std::uint32_t four = last_four_;
    if (repeated_ > 0) {
      --repeated_;
    } else if ((four = in_.symbol(books_.endpoint_prediction)) == repeat) {
      repeated_ = in_.number(4) + 2;
      four = last_four_;
    } else {
      last_four_ = four;
    }
    predictions_[x / 2] = static_cast<std::uint8_t>(four >> 4);
    return four;
  }

  [[nodiscard]] std::uint32_t endpoint(std::uint32_t prediction, std::uint32_t x, std::uint32_t y) {
    if ((prediction % 2 == 0 && prediction < 3 && x == 0) || (prediction > 0 && prediction < 3 && y == 0))
      return in_.fail(), 0u;
    if (prediction == 0) return before_;
    if (prediction == 1) return above_[x];
    if (prediction == 2) return above_left_;
    const std::uint32_t sum = before_ + in_.symbol(books_.endpoint_delta);
    const auto count = static_cast<std::uint32_t>(books_.endpoints.size());
    return sum >= count ? sum - count : sum;
  }

  [[nodiscard]] std::uint32_t selector() {
    const auto count = static_cast<std::uint32_t>(books_.selectors.size());
    std::uint32_t symbol = count;
    if (run_ > 0) {
      --run_;
    } else if ((symbol = in_.symbol(books_.selector)) == count + books_.history_size) {
      const std::uint32_t length = in_.symbol(books_.selector_run);
      run_ = (length == 63 ? in_.number(7) : length) + 2;
      symbol = count;
    }
    if (symbol < count) return history_.add(symbol), symbol;
    if (symbol - count >= history_.size()) return in_.fail(), 0u;
    return history_.use(symbol - count);
  }

  const BasisCodebooks& books_;
  Reader in_;
  History history_;
  std::vector<std::uint32_t> above_;  // endpoints of the row above, and of this one as far as it was read
  std::vector<std::uint8_t> predictions_;
  std::uint32_t bits_ = 0, last_four_ = 0, repeated_ = 0, before_ = 0, above_left_ = 0, run_ = 0;
};

void write_block(const BasisCodebooks::Endpoint& endpoint, const std::array<std::uint8_t, 4>& selector,
                 std::uint32_t bx, std::uint32_t by, unsigned channels, unsigned source, Image& image) {
  static constexpr std::array<std::array<int, 2>, 8> modifiers{
      {{2, 8}, {5, 17}, {9, 29}, {13, 42}, {18, 60}, {24, 80}, {33, 106}, {47, 183}}};
  const auto [a, b] = modifiers[endpoint.intensity];
  const std::array<int, 4> steps{-b, -a, a, b};
  for (std::uint32_t y = by * 4; y < std::min(by * 4 + 4, image.height); ++y) {
    for (std::uint32_t x = bx * 4; x < std::min(bx * 4 + 4, image.width); ++x) {
      const int step = steps[selector[y % 4] >> x % 4 * 2 & 3u];
      std::uint8_t* const texel = &image.rgba[(std::size_t{y} * image.width + x) * 4];
      for (unsigned c = 0; c < 4; ++c) {
        if ((channels >> c & 1) == 0) continue;
        const int five = endpoint.color[source < 3 ? source : c];
        texel[c] = static_cast<std::uint8_t>(std::clamp((five << 3 | five >> 2) + step, 0, 255));
      }
    }
  }
}

}  // namespace

std::optional<BasisGlobal> read_basis_global(std::span<const std::uint8_t> data, std::uint64_t image_count) {
  constexpr std::uint64_t head = 20, image_size = 20;
  if (image_count == 0 || image_count > data.size() / image_size || data.size() < head + image_count * image_size)
    return std::nullopt;
  const std::uint32_t endpoints = word(data, 0, 2), selectors = word(data, 2, 2);
  const std::array<std::uint32_t, 3> lengths{word(data, 4, 4), word(data, 8, 4), word(data, 12, 4)};
  BasisGlobal out;
  std::uint32_t* const fields[] = {&out.first.flags, &out.first.color_offset, &out.first.color_length,
                                   &out.first.alpha_offset, &out.first.alpha_length};
  for (std::size_t f = 0; f < 5; ++f) *fields[f] = word(data, head + 4 * f, 4);
  std::span<const std::uint8_t> rest = data.subspan(head + image_count * image_size);
  std::array<std::span<const std::uint8_t>, 3> parts;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (lengths[p] > rest.size()) return std::nullopt;
    parts[p] = rest.first(lengths[p]);
    rest = rest.subspan(lengths[p]);
  }
  if (!read_endpoints(parts[0], endpoints, out.codebooks) || !read_selectors(parts[1], selectors, out.codebooks) ||
      !read_tables(parts[2], out.codebooks))
    return std::nullopt;
  return out;
}

bool decode_basis_slice(const BasisCodebooks& codebooks, std::span<const std::uint8_t> slice, unsigned channels,
                        unsigned source, Image& image) {
  const std::uint32_t wide = (image.width + 3) / 4, high = (image.height + 3) / 4;
  SliceReader reader(codebooks, slice, wide);
  for (std::uint32_t y = 0; y < high; ++y) {
    for (std::uint32_t x = 0; x < wide; ++x) {
      const SliceReader::Block block = reader.read(x, y);
      if (!reader.fine()) return false;
      write_block(codebooks.endpoints[block.endpoint], codebooks.selectors[block.selector], x, y, channels, source,
                  image);
    }
  }
  return true;
}

}  // namespace sheaf
