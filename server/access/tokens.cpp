// SPDX-License-Identifier: MIT
#include "access/tokens.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <sstream>

#include "core/error.hpp"
#include "core/sha256.hpp"
#include "util/ids.hpp"
#include "util/log.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

constexpr const char* realm = "Bearer realm=\"sheaf\"";
constexpr std::size_t max_token = 512;
constexpr std::string_view hash_mark = "sha256:";

/// Takes as long for a hash that differs in its first digit as for an equal one.
bool equal_in_constant_time(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  volatile unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference =
        difference | static_cast<unsigned>(static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
  return difference == 0;
}

std::optional<unsigned> scopes_of(const std::string& text) {
  unsigned scopes = 0;
  std::istringstream list(text);
  for (std::string name; std::getline(list, name, ',');) {
    if (name == "read")
      scopes |= static_cast<unsigned>(Scope::read);
    else if (name == "submit")
      scopes |= static_cast<unsigned>(Scope::submit);
    else
      return std::nullopt;
  }
  return scopes ? std::optional(scopes) : std::nullopt;
}

bool is_hash(std::string_view text) {
  return text.size() == 64 &&
         std::ranges::all_of(text, [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

bool is_name(const std::string& text) {
  return !text.empty() && text.size() <= 64 && std::ranges::all_of(text, [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_' ||
           c == '.' || c == '@';
  });
}

[[noreturn]] void unauthorized(const std::string& why, const std::string& challenge) {
  throw Problem(ProblemKind::unauthorized, why).header("WWW-Authenticate", realm + challenge);
}

}  // namespace

Tokens::Tokens(const std::string& path) : path_(path) {
  if (path.empty()) return;
  version_ = version_of(path);
  entries_ = std::make_shared<const Entries>(read(path));
}

Tokens::Version Tokens::version_of(const std::string& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return {};
  return {info.st_dev, info.st_ino, static_cast<std::uint64_t>(info.st_size),
          std::int64_t{info.st_ctim.tv_sec} * 1'000'000'000 + info.st_ctim.tv_nsec};
}

std::shared_ptr<const Tokens::Entries> Tokens::current() const {
  const std::lock_guard lock(mutex_);
  const Version now = version_of(path_);  // taken before reading: a change in between is noticed the next time
  if (now == version_) return entries_;
  version_ = now;
  try {
    entries_ = std::make_shared<const Entries>(read(path_));
    write_log(LogLevel::info, "token file read again", {{"file", path_}, {"tokens", entries_->size()}});
  } catch (const Error& error) {
    write_log(LogLevel::error, "token file is bad: the earlier tokens stay valid", {{"reason", error.what()}});
  }
  return entries_;
}

Tokens::Entries Tokens::read(const std::string& path) {
  Entries entries;
  std::ifstream file(path);
  if (!file) throw io_error(path, "cannot be read");
  struct stat info {};
  if (::stat(path.c_str(), &info) == 0 && (info.st_mode & S_IWOTH) != 0)
    throw input_error(path, "everybody may write to it: chmod o-w");
  std::string line;
  for (std::size_t number = 1; std::getline(file, line); ++number) read_line(path, number, line, entries);
  if (entries.empty()) throw input_error(path, "holds no token");
  return entries;
}

void Tokens::read_line(const std::string& path, std::size_t number, const std::string& line, Entries& entries) {
  std::istringstream words(line.substr(0, line.find('#')));
  std::string name, scopes, hash, more;
  if (!(words >> name)) return;
  words >> scopes >> hash;
  const auto refuse = [&](const std::string& why) {
    throw input_error(path, "line " + std::to_string(number) + ": " + why);
  };
  const std::optional<unsigned> known = scopes_of(scopes);
  if (!is_name(name)) refuse("'" + name + "' is not a name of up to 64 letters, digits and -_.@");
  if (!known) refuse("'" + scopes + "' is neither read nor submit nor both with a comma");
  if (!hash.starts_with(hash_mark) || !is_hash(hash.substr(hash_mark.size())) || words >> more)
    refuse("the third and last word must be sha256: and 64 hexadecimal digits in lower case");
  entries.push_back({name, hash.substr(hash_mark.size()), *known});
}

std::string Tokens::authorize(const Request& request, Scope scope) const {
  if (!required()) return {};
  const std::string header = request.header("Authorization").value_or("");
  if (header.empty()) unauthorized("a bearer token is needed", "");
  const auto space = header.find(' ');
  const std::string_view token = space == std::string::npos ? "" : trimmed(std::string_view(header).substr(space));
  if (!equal_ignoring_case(header.substr(0, space), "Bearer") || token.empty() || token.size() > max_token)
    unauthorized("Authorization must be Bearer and a token", ", error=\"invalid_request\"");
  const std::string hash = sha256_of(token);
  const auto entries = current();
  const Entry* found = nullptr;
  for (const Entry& entry : *entries)  // all of them, so that the time does not depend on which one matches
    if (equal_in_constant_time(entry.hash, hash)) found = &entry;
  if (!found) unauthorized("the token is not known", ", error=\"invalid_token\"");
  if ((found->scopes & static_cast<unsigned>(scope)) == 0) {
    const std::string name = scope == Scope::read ? "read" : "submit";
    throw Problem(ProblemKind::insufficient_scope, "the token '" + found->name + "' lacks the scope " + name)
        .header("WWW-Authenticate", std::string(realm) + ", error=\"insufficient_scope\", scope=\"" + name + "\"");
  }
  return found->name;
}

NewToken make_token(const std::string& text) {
  const auto equals = text.find('=');
  const std::string name = text.substr(0, equals);
  const std::string scopes = equals == std::string::npos ? "" : text.substr(equals + 1);
  if (!is_name(name) || !scopes_of(scopes))
    throw Error(ErrorKind::usage, "--new-token '" + text + "': must be NAME=read, NAME=submit or NAME=read,submit");
  NewToken made;
  made.token = "sheaf_" + random_id() + random_id();
  made.line = name + " " + scopes + " " + std::string(hash_mark) + sha256_of(made.token);
  return made;
}

}  // namespace sheaf::server
