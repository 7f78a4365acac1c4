// SPDX-License-Identifier: MIT
#include "routes/file_reply.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <memory>
#include <vector>

#include "util/fd.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

struct Part {
  std::uint64_t offset = 0, length = 0;
};

std::optional<std::uint64_t> number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// The one range asked for. Nothing for several ranges and malformed ones: then the whole file is sent.
/// Throws Problem (416) if the file has no byte of it.
std::optional<Part> range_of(std::string_view header, std::uint64_t size) {
  if (!header.starts_with("bytes=") || header.find(',') != std::string_view::npos) return std::nullopt;
  const std::string_view range = trimmed(header.substr(6));
  const auto dash = range.find('-');
  if (dash == std::string_view::npos) return std::nullopt;
  const auto first = number(range.substr(0, dash));
  const auto last = number(range.substr(dash + 1));
  if ((!first && dash > 0) || (!last && dash + 1 < range.size()) || (!first && !last)) return std::nullopt;
  if (first && last && *first > *last) return std::nullopt;
  if (first ? *first >= size : *last == 0)
    throw Problem(ProblemKind::range_not_satisfiable, "the file has " + std::to_string(size) + " bytes")
        .header("Content-Range", "bytes */" + std::to_string(size));
  if (!first) return Part{size - std::min(*last, size), std::min(*last, size)};
  const std::uint64_t end = last ? std::min(*last, size - 1) : size - 1;
  return Part{*first, end - *first + 1};
}

/// The file's name; characters that a header cannot carry become '_'.
std::string header_name(const std::string& name) {
  std::string out = name;
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126 || c == '"' || c == '\\') c = '_';
  return out;
}

}  // namespace

std::string etag_of(const std::string& sha256) { return "\"" + sha256.substr(0, 32) + "\""; }

bool client_has(const Request& request, const std::string& etag) {
  const std::optional<std::string> header = request.header("If-None-Match");
  if (!header) return false;
  if (trimmed(*header) == "*") return true;
  std::string_view rest = *header;
  while (!rest.empty()) {
    const auto comma = std::min(rest.find(','), rest.size());
    std::string_view tag = trimmed(rest.substr(0, comma));
    if (tag.starts_with("W/")) tag.remove_prefix(2);  // compared weakly (RFC 9110, 13.1.2)
    if (tag == etag) return true;
    rest.remove_prefix(std::min(comma + 1, rest.size()));
  }
  return false;
}

Reply not_modified(const std::string& etag) {
  Reply reply;
  reply.status = 304;
  return reply.header("ETag", etag).header("Cache-Control", "private, no-cache");
}

bool send_file(int fd, std::uint64_t offset, std::uint64_t length, const Writer& write) {
  std::vector<char> block(static_cast<std::size_t>(std::min<std::uint64_t>(length, std::uint64_t{1} << 18)));
  while (length > 0) {
    const auto want = static_cast<std::size_t>(std::min<std::uint64_t>(length, block.size()));
    const ssize_t n = ::pread(fd, block.data(), want, static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0 || !write({block.data(), static_cast<std::size_t>(n)})) return false;
    offset += static_cast<std::uint64_t>(n);
    length -= static_cast<std::uint64_t>(n);
  }
  return true;
}

Reply file_reply(const Request& request, const std::filesystem::path& path, const StoredFile& file,
                 const std::string& content_type) {
  const std::string etag = etag_of(file.sha256);
  if (client_has(request, etag)) return not_modified(etag);

  auto fd = std::make_shared<Fd>(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  struct stat info {};
  if (!fd->valid() || ::fstat(fd->get(), &info) != 0 || static_cast<std::uint64_t>(info.st_size) != file.bytes)
    throw Problem(ProblemKind::internal, "the stored file " + file.name + " has changed");

  Reply reply;
  reply.content_type = content_type;
  reply.header("ETag", etag)
      .header("Accept-Ranges", "bytes")
      .header("Cache-Control", "private, no-cache")
      .header("Content-Disposition", "inline; filename=\"" + header_name(file.name) + "\"");
  Part part{0, file.bytes};
  const std::optional<std::string> range = request.method == "GET" ? request.header("Range") : std::nullopt;
  const bool current = request.header("If-Range").value_or(etag) == etag;
  if (const auto asked = range && current ? range_of(*range, file.bytes) : std::nullopt) {
    part = *asked;
    reply.status = 206;
    reply.header("Content-Range", "bytes " + std::to_string(part.offset) + "-" +
                                      std::to_string(part.offset + part.length - 1) + "/" + std::to_string(file.bytes));
  }
  reply.stream = StreamBody{
      part.length, [fd, part](const Writer& write) { return send_file(fd->get(), part.offset, part.length, write); }};
  return reply;
}

}  // namespace sheaf::server
