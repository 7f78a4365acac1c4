// SPDX-License-Identifier: MIT
#include "upload/multipart.hpp"

#include <map>

#include "core/quote.hpp"
#include "http/message.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

constexpr std::size_t max_part_header = 8192;

[[noreturn]] void malformed(const std::string& why) { throw Problem(ProblemKind::malformed_multipart, why); }

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
  return out;
}

/// A quoted string from its opening quote on; moves `text` behind it. A backslash quotes only '"' and itself: some
/// clients send Windows paths with bare ones.
std::string take_quoted(std::string_view& text) {
  std::string out;
  for (std::size_t i = 1; i < text.size(); ++i) {
    if (text[i] == '"') {
      text.remove_prefix(i + 1);
      return out;
    }
    if (text[i] == '\\' && i + 1 < text.size() && (text[i + 1] == '"' || text[i + 1] == '\\')) ++i;
    out += text[i];
  }
  malformed("a quoted parameter does not end");
}

/// Browsers and most HTTP libraries write a '"' in a name as %22 and leave every other '%' as it is (WHATWG HTML,
/// "multipart/form-data encoding algorithm").
std::string with_quotes(std::string text) {
  for (auto at = text.find("%22"); at != std::string::npos; at = text.find("%22", at + 1)) text.replace(at, 3, "\"");
  return text;
}

/// `; name=value` pairs behind a header's first word. Names in lower case.
std::map<std::string, std::string> parameters_of(std::string_view text) {
  std::map<std::string, std::string> parameters;
  while (true) {
    text = trimmed(text);
    if (text.empty()) return parameters;
    if (text.front() != ';') malformed("parameters are not separated by ';'");
    text = trimmed(text.substr(1));
    if (text.empty()) return parameters;
    const auto equals = text.find('=');
    if (equals == std::string_view::npos) malformed("a parameter has no value");
    const std::string name = lower(trimmed(text.substr(0, equals)));
    text = trimmed(text.substr(equals + 1));
    std::string value;
    if (!text.empty() && text.front() == '"') {
      value = take_quoted(text);
    } else {
      const auto end = std::min(text.find(';'), text.size());
      value = trimmed(text.substr(0, end));
      text.remove_prefix(end);
    }
    if (!parameters.emplace(name, value).second) malformed("parameter " + quote(name) + " is given twice");
  }
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/// RFC 8187: UTF-8'language'percent-encoded.
std::string decoded_filename(const std::string& text) {
  const auto first = text.find('\'');
  const auto second = first == std::string::npos ? first : text.find('\'', first + 1);
  if (second == std::string::npos || lower(text.substr(0, first)) != "utf-8") malformed("filename* is not UTF-8''…");
  std::string out;
  for (std::size_t i = second + 1; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    const int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
    const int low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
    if (high < 0 || low < 0) malformed("filename* holds a '%' without two hexadecimal digits");
    out += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return out;
}

}  // namespace

std::optional<std::string> multipart_boundary(std::string_view content_type) {
  const auto end = std::min(content_type.find(';'), content_type.size());
  if (lower(trimmed(content_type.substr(0, end))) != "multipart/form-data") return std::nullopt;
  const auto parameters = parameters_of(content_type.substr(end));
  const auto found = parameters.find("boundary");
  if (found == parameters.end() || found->second.empty() || found->second.size() > 70)
    malformed("the content type has no boundary of 1 to 70 characters");
  return found->second;
}

PartHeader parse_part_header(std::string_view lines) {
  PartHeader part;
  bool disposed = false;
  while (!lines.empty()) {
    const auto end = std::min(lines.find("\r\n"), lines.size());
    const std::string_view line = lines.substr(0, end);
    lines.remove_prefix(std::min(end + 2, lines.size()));
    const auto colon = line.find(':');
    if (colon == std::string_view::npos) malformed("a part's header line is not NAME: VALUE");
    const std::string name = lower(trimmed(line.substr(0, colon)));
    const std::string_view value = trimmed(line.substr(colon + 1));
    if (name == "content-type") part.content_type = lower(trimmed(value.substr(0, value.find(';'))));
    if (name != "content-disposition") continue;
    if (disposed) malformed("a part has two Content-Disposition headers");
    disposed = true;
    const auto word = std::min(value.find(';'), value.size());
    if (lower(trimmed(value.substr(0, word))) != "form-data") malformed("a part is not form-data");
    auto parameters = parameters_of(value.substr(word));
    part.name = parameters["name"];
    if (parameters.contains("filename*"))
      part.filename = decoded_filename(parameters["filename*"]);
    else if (parameters.contains("filename"))
      part.filename = with_quotes(parameters["filename"]);
  }
  if (part.name.empty()) malformed("a part has no name");
  return part;
}

MultipartParser::MultipartParser(const std::string& boundary, std::uint64_t max_parts, PartHandler handler)
    : delimiter_("\r\n--" + boundary), parts_left_(max_parts), max_parts_(max_parts), handler_(std::move(handler)) {}

void MultipartParser::feed(std::string_view bytes) {
  buffer_.append(bytes);
  while (step()) {
  }
}

void MultipartParser::finish() const {
  if (state_ != State::epilogue) malformed("the body ends before its closing delimiter");
}

bool MultipartParser::step() {
  switch (state_) {
    case State::preamble:
      return skip_to_delimiter();
    case State::delimiter:
      return read_delimiter();
    case State::headers:
      return read_headers();
    case State::body:
      return read_body();
    case State::epilogue:
      break;
  }
  buffer_.clear();
  return false;
}

bool MultipartParser::skip_to_delimiter() {
  const auto at = buffer_.find(delimiter_);
  if (at == std::string::npos) {
    if (buffer_.size() >= delimiter_.size()) buffer_.erase(0, buffer_.size() - delimiter_.size() + 1);
    return false;
  }
  buffer_.erase(0, at + delimiter_.size());
  state_ = State::delimiter;
  return true;
}

/// Behind the boundary: "--" ends the body, a line end starts a part.
bool MultipartParser::read_delimiter() {
  if (buffer_.size() < 2) return false;
  if (buffer_.starts_with("--")) {
    state_ = State::epilogue;
    return true;
  }
  const auto padding = buffer_.find_first_not_of(" \t");
  if (padding == std::string::npos || padding + 2 > buffer_.size()) {
    if (buffer_.size() > max_part_header) malformed("a delimiter line does not end");
    return false;
  }
  if (buffer_.compare(padding, 2, "\r\n") != 0) malformed("a delimiter is followed by other text");
  if (parts_left_-- == 0)
    throw Problem(ProblemKind::too_large, "the body has more than " + std::to_string(max_parts_) + " parts")
        .exceeded("max-parts", max_parts_, max_parts_ + 1);
  buffer_.erase(0, padding + 2);
  state_ = State::headers;
  return true;
}

bool MultipartParser::read_headers() {
  const auto end = buffer_.find("\r\n\r\n");
  if (end == std::string::npos || end > max_part_header) {
    if (buffer_.size() > max_part_header) malformed("a part's headers have more than 8192 bytes");
    return false;
  }
  handler_.begin(parse_part_header(std::string_view(buffer_).substr(0, end)));
  buffer_.erase(0, end + 4);
  state_ = State::body;
  return true;
}

bool MultipartParser::read_body() {
  const auto at = buffer_.find(delimiter_);
  if (at == std::string::npos) {
    // The last bytes may be the start of a delimiter.
    if (buffer_.size() < delimiter_.size()) return false;
    const std::size_t sure = buffer_.size() - delimiter_.size() + 1;
    handler_.data(std::string_view(buffer_).substr(0, sure));
    buffer_.erase(0, sure);
    return false;
  }
  if (at > 0) handler_.data(std::string_view(buffer_).substr(0, at));
  handler_.end();
  buffer_.erase(0, at + delimiter_.size());
  state_ = State::delimiter;
  return true;
}

}  // namespace sheaf::server
