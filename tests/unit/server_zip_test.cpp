// SPDX-License-Identifier: MIT
// Archives made while they are sent, past the sizes that plain zip fields can hold.
#include <gtest/gtest.h>

#include <string>

#include "routes/zip_stream.hpp"
#include "util/ids.hpp"

namespace sheaf::server {
namespace {

std::uint64_t number(const std::string& bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i)
    value |= std::uint64_t{static_cast<unsigned char>(bytes.at(at + i))} << (8 * i);
  return value;
}

/// The archive with its entries' contents left out but counted.
struct Sent {
  std::string headers;
  std::uint64_t bytes = 0;
};

Sent send(const ZipStream& zip, const std::vector<ZipEntry>& entries) {
  Sent sent;
  const std::string block(std::size_t{1} << 20, 'x');
  const Writer count = [&](std::string_view bytes) {
    sent.bytes += bytes.size();
    if (bytes.data() != block.data()) sent.headers += bytes;
    return true;
  };
  EXPECT_TRUE(zip.write(count, [&](std::size_t i, const Writer& write) {
    for (std::uint64_t left = entries[i].bytes; left > 0;) {
      const std::uint64_t n = std::min<std::uint64_t>(left, block.size());
      if (!write(std::string_view(block).substr(0, static_cast<std::size_t>(n)))) return false;
      left -= n;
    }
    return true;
  }));
  return sent;
}

TEST(ZipStream, KnowsItsLengthBeforehand) {
  for (const std::uint64_t size : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{70'000}}) {
    const std::vector<ZipEntry> entries{{"a", size, 1}, {"bb", 3, 2}};
    const ZipStream zip(entries);
    EXPECT_EQ(send(zip, entries).bytes, zip.length());
  }
  const ZipStream none({});
  EXPECT_EQ(none.length(), 22u);
}

TEST(ZipStream, SwitchesToZip64WhereANumberNeedsIt) {
  const std::uint64_t big = std::uint64_t{5} << 30;
  const std::vector<ZipEntry> entries{{"a", big, 7}, {"b", 1, 8}};
  const ZipStream zip(entries);
  const Sent sent = send(zip, entries);
  EXPECT_EQ(sent.bytes, zip.length());
  const std::string& h = sent.headers;

  // Local header of the large entry: version 4.5, sizes in the extra field.
  EXPECT_EQ(number(h, 0, 4), 0x04034b50u);
  EXPECT_EQ(number(h, 4, 2), 45u);
  EXPECT_EQ(number(h, 18, 4), 0xffffffffu);
  EXPECT_EQ(number(h, 31, 2), 1u);
  EXPECT_EQ(number(h, 35, 8), big);
  EXPECT_EQ(number(h, 43, 8), big);

  // The small entry lies past 4 GiB: its offset alone is in its central extra field.
  const auto first = h.find("PK\x01\x02"), second = h.find("PK\x01\x02", first + 4);
  ASSERT_NE(second, std::string::npos);
  EXPECT_EQ(number(h, second + 24, 4), 1u);
  EXPECT_EQ(number(h, second + 42, 4), 0xffffffffu);
  EXPECT_EQ(number(h, second + 47 + 2, 2), 8u);
  EXPECT_EQ(number(h, second + 47 + 4, 8), 51 + big);

  // The directory lies past 4 GiB too: the end record points to the Zip64 one through its locator.
  const auto end = h.size() - 22, locator = end - 20, end64 = locator - 56;
  EXPECT_EQ(number(h, end, 4), 0x06054b50u);
  EXPECT_EQ(number(h, end + 10, 2), 2u);
  EXPECT_EQ(number(h, end + 16, 4), 0xffffffffu);
  EXPECT_EQ(number(h, locator, 4), 0x07064b50u);
  EXPECT_EQ(number(h, locator + 8, 8), zip.length() - 22 - 20 - 56);
  EXPECT_EQ(number(h, end64, 4), 0x06064b50u);
  EXPECT_EQ(number(h, end64 + 32, 8), 2u);
  EXPECT_EQ(number(h, end64 + 48, 8) + number(h, end64 + 40, 8), zip.length() - 22 - 20 - 56);
}

TEST(ZipStream, CountsMoreEntriesThanAPlainFieldHolds) {
  const std::vector<ZipEntry> entries(70'000, ZipEntry{"x", 0, 0});
  const ZipStream zip(entries);
  const Sent sent = send(zip, entries);
  EXPECT_EQ(sent.bytes, zip.length());
  const auto end = sent.headers.size() - 22;
  EXPECT_EQ(number(sent.headers, end + 10, 2), 0xffffu);
  EXPECT_EQ(number(sent.headers, end - 20 - 56 + 32, 8), 70'000u);
}

TEST(ZipStream, StopsWhereAWriterOrAContentStops) {
  const std::vector<ZipEntry> entries{{"a", 1, 1}, {"b", 1, 1}};
  const ZipStream zip(entries);
  int calls = 0;
  EXPECT_FALSE(
      zip.write([&](std::string_view) { return ++calls < 2; }, [](std::size_t, const Writer&) { return true; }));
  EXPECT_EQ(calls, 2);
  EXPECT_FALSE(zip.write([](std::string_view) { return true; }, [](std::size_t i, const Writer&) { return i == 0; }));
}

TEST(Ids, AreLongAndDistinct) {
  const std::string id = random_id();
  EXPECT_TRUE(is_id(id));
  EXPECT_NE(id, random_id());
  EXPECT_FALSE(is_id(""));
  EXPECT_FALSE(is_id(id + "a"));
  EXPECT_FALSE(is_id(std::string(25, 'a') + "/"));
}

}  // namespace
}  // namespace sheaf::server
